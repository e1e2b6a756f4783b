//! The robust start: where the surface lies, and which contacts do not belong to it.
//!
//! ```text
//! height quadric z = z0 + gx x + gy y + (A x^2 + 2 B x y + C y^2)/2    ->  starts of sphere, cylinder and general
//! best general fit = least sum of min(|d|, 3 s)^2         outliers: |d| > 6 * 1.4826 median |d| sqrt(n/(n - 6))
//!                                                       and off a smooth departure from it, too (taken_back.rs)
//! ```
//!
//! The factor is 6, because errors of real scans are correlated and large ones are more frequent than among gaussians.
//! A weight that vanishes beyond 4.7 took contacts of the true shape for outliers.

use std::f64::consts::FRAC_PI_2;

use crate::recognition::dense;
use crate::recognition::kinds::{Kind, Model};
use crate::recognition::statistics::median;

use super::descent::{Fitted, distances_of, robust};
use super::taken_back::take_back;

use crate::vector::Vector;

/// Largest number of contacts that the start looks at. More would move it by less than the later steps correct.
const SAMPLE: usize = 3000;

/// Result of the robust start.
#[derive(Clone, Debug)]
pub(super) struct Start {
    pub(super) general: Model,
    pub(super) sphere: Model,
    pub(super) cylinder: Model,
    /// Signed distances of all contacts from `general`.
    pub(in crate::recognition) distances: Vec<f64>,
    /// Whether a contact belongs to the surface.
    pub(super) belongs: Vec<bool>,
    /// Numbers of the contacts that the start looked at.
    pub(super) sample: Vec<usize>,
}

/// At most `most` numbers of points, evenly spread over their lexicographic order.
pub(in crate::recognition) fn thinned(points: &[Vector], most: usize) -> Vec<usize> {
    if points.len() <= most {
        return (0..points.len()).collect();
    }
    // z stands beside the number, so that most points are compared without a jump through memory
    let mut order: Vec<(f64, u32)> = points.iter().zip(0..).map(|(p, i)| (p[2], i)).collect();
    let compare_rest = |i: u32, j: u32| {
        let (a, b) = (points[i as usize], points[j as usize]);
        a[1].total_cmp(&b[1]).then(a[0].total_cmp(&b[0])).then(i.cmp(&j))
    };
    order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then_with(|| compare_rest(a.1, b.1)));
    (0..most).map(|k| order[k * (points.len() - 1) / (most - 1)].1 as usize).collect()
}

/// Fits the start.
pub(super) fn start(points: &[Vector]) -> Start {
    let sample = thinned(points, SAMPLE);
    let some: Vec<Vector> = sample.iter().map(|&i| points[i]).collect();
    let [sphere, cylinder, along, across] = quadric_starts(&some);
    let sphere = robust(&some, Kind::Sphere, sphere).model;
    let cylinder = robust(&some, Kind::Cylinder, cylinder).model;
    let mut best: Option<Fitted> = None;
    for theta in [along, across, sphere.theta(), cylinder.theta()] {
        let found = robust(&some, Kind::General, theta);
        let limit = best.as_ref().map_or(found.scale, |best| best.scale);
        let cost = |fit: &Fitted| fit.distances.iter().map(|d| d.abs().min(3.0 * limit).powi(2)).sum::<f64>();
        if best.as_ref().is_none_or(|best| cost(&found) < cost(best) * (1.0 - 1e-3)) {
            best = Some(found);
        }
    }
    let general = best.map_or_else(|| sphere.clone(), |best| best.model);
    let distances = distances_of(&general, points);
    let n = points.len() as f64;
    let scale = 1.4826 * median(distances.iter().map(|d| d.abs()).collect());
    let limit = (6.0 * scale * (n / (n - 6.0).max(1.0)).sqrt()).max(1e-9);
    let mut belongs: Vec<bool> = distances.iter().map(|d| d.abs() < limit).collect();
    if let Model::Constant(_, surface) = &general {
        take_back(surface, points, &distances, &sample, limit, &mut belongs);
    }
    Start { general, sphere, cylinder, distances, belongs, sample }
}

/// Starts of sphere, cylinder, and general with the larger curvature first and second.
fn quadric_starts(points: &[Vector]) -> [[f64; 6]; 4] {
    let [z0, gx, gy, a, b, c] = quadric(points);
    let (mean, half) = (0.5 * (a + c), (0.5 * (a - c)).hypot(b));
    let angle = 0.5 * (2.0 * b).atan2(a - c);
    let (large, small, phi) =
        if mean >= 0.0 { (mean + half, mean - half, angle) } else { (mean - half, mean + half, angle + FRAC_PI_2) };
    [
        [z0, gy, -gx, mean, mean, 0.0],
        [z0, gy, -gx, large, 0.0, phi],
        [z0, gy, -gx, large, small, phi],
        [z0, gy, -gx, small, large, phi + FRAC_PI_2],
    ]
}

/// Coefficients z0, gx, gy, A, B, C of the height quadric; the last ones are 0 where the points cannot tell them.
fn quadric(points: &[Vector]) -> [f64; 6] {
    let mut normal = [[0.0; 6]; 6];
    let mut rhs = [0.0; 6];
    for &[x, y, z] in points {
        let row = [1.0, x, y, 0.5 * x * x, x * y, 0.5 * y * y];
        for i in 0..6 {
            rhs[i] += row[i] * z;
            (0..=i).for_each(|j| normal[i][j] += row[i] * row[j]);
        }
    }
    (0..6).for_each(|i| normal[i][i] *= 1.0 + 1e-9);
    dense::solve_small(normal, rhs, 6).unwrap_or([0.0; 6])
}
