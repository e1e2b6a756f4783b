//! Each part fitted to all its inner points, with the noise that they show, uncertainties, and whether the data reject it.
//!
//! ```text
//! u_d^2 = sum d^2 / (n - t),  u_n^2 = sum |n - n_i|^2 / (2 n - unknowns + t)       t = trace of the distances' hat matrix
//! covariance = (J' W J)^-1 n / n_e         n_e: independent residuals, n unless neighbours share errors (`evidence.rs`)
//! F = (between / (cells - t)) / (within / (points - cells))
//!     between = sum_c n_c mean_c(d)^2,  within = sum_c sum_i (d_i - mean_c)^2          cells of some 12 neighbouring points
//! ```
//!
//! Points of one cell are near-replicates: whatever the true surface is, it hardly varies within a cell, so that the scatter
//! there is noise and the means beyond noise are lack of fit. A scanner's error that neighbours share is lack of fit, too, and
//! the parameters are then as uncertain as so few independent residuals leave them. N. R. Draper and H. Smith, *Applied
//! Regression Analysis*, section 2.1.

use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use super::cloud::{Cloud, FEWEST, LINKED};
use super::descent::{Descended, Sample, share_of_distances};
use super::evidence::Cells;
use super::hypothesis::{CAP, cost, sampled};
use super::local::{Noise, ROUNDING};
use super::partition::exact;
use super::primitive::Primitive;
use crate::vector::{dot, minus};

/// Points of a cell besides its first.
const CELL: usize = 11;

/// Below this probability the data reject the primitive. One true primitive in a hundred is then rejected by chance.
pub(super) const REJECTED: f64 = 0.01;

/// A part's primitive at the end.
#[derive(Clone, Copy, Debug)]
pub(super) struct Exact {
    pub(super) descended: Descended,
    /// The noise that its inner points show.
    pub(super) noise: Noise,
    /// Probability of so large a lack of fit by chance; `None` with too few cells.
    pub(super) p: Option<f64>,
    /// Root mean square of what noise does not explain, along the normal.
    pub(super) departure: f64,
    /// Contacts for every independent residual.
    pub(super) shared: f64,
}

/// Fits until the noise has settled, to the points that the primitive explains.
pub(super) fn fitted(cloud: &Cloud, inner: &[u32], start: &Primitive, coarse: &Noise, cells: &Cells) -> Option<Exact> {
    let mut noise = *coarse;
    let mut kept = explained(cloud, inner, start, coarse);
    let mut descended = exact(cloud, &kept, start, &noise)?;
    for _ in 0..4 {
        kept = explained(cloud, inner, &descended.primitive, coarse);
        let next = noise_of(cloud, &kept, &descended, &noise);
        let settled = (next.distance / noise.distance - 1.0).abs().max((next.normal / noise.normal - 1.0).abs()) < 1e-4;
        noise = next;
        descended = exact(cloud, &kept, &descended.primitive, &noise)?;
        if settled {
            break;
        }
    }
    let inner = &kept;
    let share = share(cloud, inner, &descended, &noise);
    let (p, departure) = lack_of_fit(cloud, inner, &descended.primitive, share);
    let distance = |i: u32| descended.primitive.nearest(cloud.points[i as usize]).0;
    let residuals: Vec<(u32, f64)> = inner.iter().map(|&i| (i, distance(i))).collect();
    let shared = cells.shared(&residuals);
    Some(Exact { descended, noise, p, departure, shared })
}

/// The points that cost less than the most: a face too small to be a part has its neighbour's label, and a dozen points of a
/// cone's top turn its half angle by five uncertainties.
fn explained(cloud: &Cloud, inner: &[u32], primitive: &Primitive, coarse: &Noise) -> Vec<u32> {
    let is_explained = |i: &u32| cost(primitive, cloud.points[*i as usize], cloud.normals[*i as usize], coarse) < CAP;
    let kept: Vec<u32> = inner.iter().copied().filter(is_explained).collect();
    if kept.len() >= FEWEST { kept } else { inner.to_vec() }
}

/// The unknowns that the distances determine.
fn share(cloud: &Cloud, inner: &[u32], descended: &Descended, noise: &Noise) -> f64 {
    let (points, normals) = sampled(cloud, inner, usize::MAX);
    let sample = Sample { points: &points, normals: &normals, u_distance: noise.distance, u_normal: noise.normal };
    share_of_distances(descended, &sample).unwrap_or(descended.primitive.kind.free().len() as f64)
}

/// Two variance components; the unknowns are shared out as the rows determine them under the noise `before`.
fn noise_of(cloud: &Cloud, inner: &[u32], descended: &Descended, before: &Noise) -> Noise {
    let primitive = &descended.primitive;
    let (mut distances, mut normals) = (0.0, 0.0);
    for &i in inner {
        let (d, normal) = primitive.nearest(cloud.points[i as usize]);
        let off = minus(normal, cloud.normals[i as usize]);
        distances += d * d;
        normals += dot(off, off);
    }
    let unknowns = primitive.kind.free().len() as f64;
    let count = inner.len() as f64;
    let share = share(cloud, inner, descended, before);
    // a normal has two rows: the third is along the normal itself
    Noise {
        distance: (distances / (count - share).max(1.0)).sqrt().max(ROUNDING),
        normal: (normals / (2.0 * count - unknowns + share).max(1.0)).sqrt().max(ROUNDING),
    }
}

/// The probability of F, and the departure.
fn lack_of_fit(cloud: &Cloud, inner: &[u32], primitive: &Primitive, share: f64) -> (Option<f64>, f64) {
    let distance = |i: u32| primitive.nearest(cloud.points[i as usize]).0;
    let (mut between, mut within, mut cells, mut points) = (0.0, 0.0, 0.0, 0.0);
    for cell in cells_of(cloud, inner) {
        let values: Vec<f64> = cell.iter().map(|&i| distance(i)).collect();
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        between += count * mean * mean;
        within += values.iter().map(|v| (v - mean).powi(2)).sum::<f64>();
        cells += 1.0;
        points += count;
    }
    let (upper, lower) = (cells - share, points - cells);
    if upper < 3.0 || lower < 3.0 {
        return (None, 0.0);
    }
    let (mean_between, mean_within) = (between / upper, within / lower);
    if mean_within.sqrt() <= ROUNDING {
        // no noise at all: whatever is left is rounding, or a misfit that needs no statistics
        let rejected = mean_between.sqrt() > 100.0 * ROUNDING;
        return (Some(if rejected { 0.0 } else { 1.0 }), (between / points).sqrt());
    }
    let p = FisherSnedecor::new(upper, lower).map(|law| law.sf(mean_between / mean_within)).ok();
    (p.filter(|p| p.is_finite()), ((between - upper * mean_within).max(0.0) / points).sqrt())
}

/// Neighbouring points in cells, every inner point in one; cells of fewer than 4 are left out.
fn cells_of(cloud: &Cloud, inner: &[u32]) -> Vec<Vec<u32>> {
    let mut free = vec![false; cloud.len()];
    inner.iter().for_each(|&i| free[i as usize] = true);
    let mut cells = Vec::new();
    // along the axes the walk is even, whatever the order of the file
    for &first in inner {
        if !free[first as usize] {
            continue;
        }
        free[first as usize] = false;
        let mut cell = vec![first];
        for &j in cloud.near(first as usize).iter().take(LINKED + CELL) {
            if free[j as usize] && cell.len() <= CELL {
                free[j as usize] = false;
                cell.push(j);
            }
        }
        if cell.len() >= 4 {
            cells.push(cell);
        }
    }
    cells
}
