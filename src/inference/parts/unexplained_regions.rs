//! Points that no primitive explains: connected regions of one class, by their own S and how sure it is.
//!
//! ```text
//! cost(p, class) = ((S_p - S_class) / hypot(u(S_p), 1/8))^2 / 2 + agree (neighbours of another class)
//! classes: cup -1, rut -1/2, saddle 0, ridge 1/2, cap 1
//! ```
//!
//! Neighbours of different classes cost what neighbours in different primitives do. A class's own width is half a bin, so that a region
//! whose S drifts across an edge is not cut by noise.

use super::cloud::Cloud;
use super::hypothesis::Walk;
use super::local::{LocalShape, LocalShapes};
use super::partition::{NONE, unlabelled};
use super::sheet::SheetLimit;
use super::tuning::PartsTuning;

/// Sweeps over all labels.
const SWEEPS: usize = 8;

/// Labels the points without a part: regions get numbers from `first` on, and the points of regions that are too small keep
/// none. Gives back how many regions there are.
pub(super) fn label_leftover(
    cloud: &Cloud,
    shapes: &LocalShapes,
    labels: &mut [u32],
    first: u32,
    (limit, tuning): (&SheetLimit, &PartsTuning),
) -> u32 {
    let left = unlabelled(labels);
    let shapes_left = shapes.of(cloud, &left);
    let free: Vec<bool> = labels.iter().map(|l| *l == NONE).collect();
    let mut classes: Vec<u8> = vec![0; cloud.len()];
    let data = |shape: &LocalShape, class: u8| {
        let Some(s) = shape.principal.and_then(|p| p.shape_index()) else { return 0.0 };
        let centre = 0.5 * f64::from(class) - 1.0;
        0.5 * ((s - centre) / shape.u_shape_index.hypot(0.125)).powi(2)
    };
    let least = |energy: &dyn Fn(u8) -> f64| {
        (1..5).fold((0, energy(0)), |best, class| {
            let new = energy(class);
            if new < best.1 { (class, new) } else { best }
        })
    };
    let each = || left.iter().map(|i| *i as usize).zip(&shapes_left);
    each().for_each(|(i, shape)| classes[i] = least(&|class| data(shape, class)).0);
    for _ in 0..SWEEPS {
        let agreeing = |(i, shape): (usize, &&LocalShape)| {
            let linked = cloud.linked(i).iter().filter(|&&j| free[j as usize]);
            let others: Vec<u8> = linked.map(|&j| classes[j as usize]).collect();
            let differing = |class: u8| others.iter().filter(|other| **other != class).count() as f64;
            least(&|class| data(shape, class) + tuning.agree * differing(class)).0
        };
        let chosen: Vec<u8> = each().map(agreeing).collect();
        each().zip(chosen).for_each(|((i, _), class)| classes[i] = class);
    }
    let mut walk = Walk::new(cloud.len());
    let mut next = first;
    for &seed in &left {
        let i = seed as usize;
        if labels[i] != NONE {
            continue;
        }
        let region = walk.reach(cloud, &[seed], usize::MAX, |j| labels[j] == NONE && classes[j] == classes[i]);
        region.iter().for_each(|&j| labels[j as usize] = next);
        if limit.holds_region(cloud, shapes, labels, &region) {
            next += 1;
        } else {
            region.iter().for_each(|&j| labels[j as usize] = NONE);
        }
    }
    next - first
}
