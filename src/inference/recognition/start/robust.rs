//! The robust start: where the surface lies, and which contacts do not belong to it.
//!
//! ```text
//! height quadric z = z0 + gx x + gy y + (A x^2 + 2 B x y + C y^2)/2    ->  starts of sphere, cylinder and general
//! best general fit = least sum of min(|d|, 3 s)^2         outliers: |d| > 6 mad(d) sqrt(n/(n - 6))
//!                                                       and off a smooth departure from it, too (outlier_reinstatement.rs)
//! ```
//!
//! The factor is 6, because errors of real scans are correlated and large ones are more frequent than among gaussians.
//! A weight that vanishes beyond 4.7 took contacts of the true shape for outliers.
//!
//! Positions in one ring or in two rows lie on many surfaces, and the one that is found says nothing. Where normals contradict it, and
//! another surface explains both, normals take part in the fits ([`super::directions`]).

use std::f64::consts::FRAC_PI_2;

use crate::bodies::Tuning;
use crate::recognition::contacts::Floors;
use crate::recognition::kinds::{Kind, Model};
use palpate_numeric::linalg::small::solve_leading;
use palpate_numeric::statistics::{mad, median};

use super::descent::{Fitted, distances_of, robust};
use super::directions::Directions;
use super::outlier_reinstatement::take_back;

use palpate_numeric::vector::Vector;

/// Largest number of contacts that the start looks at. More would move it by less than the later steps correct.
const SAMPLE: usize = 3000;

/// Result of the robust start.
#[derive(Clone, Debug)]
pub(super) struct Start {
    pub(super) general: Model,
    pub(super) sphere: Model,
    pub(super) cylinder: Model,
    /// Signed distances of all contacts from `general`.
    pub(crate) distances: Vec<f64>,
    /// Whether a contact belongs to the surface.
    pub(super) belongs: Vec<bool>,
    /// Numbers of the contacts that the start looked at.
    pub(super) sample: Vec<usize>,
    /// Whether normals took part.
    pub(super) with_normals: bool,
}

/// At most `most` numbers of points, evenly spread over their lexicographic order.
pub(crate) fn thinned(points: &[Vector], most: usize) -> Vec<usize> {
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

/// Fits the start. `normals` are unit vectors, zero where unknown.
pub(super) fn start(points: &[Vector], normals: Option<&[Vector]>, floors: &Floors, tuning: &Tuning) -> Start {
    let sample = thinned(points, SAMPLE);
    let of_sample = |all: &[Vector]| sample.iter().map(|&i| all[i]).collect::<Vec<Vector>>();
    let some = of_sample(points);
    let alone = Fits::of(&some, None, floors, tuning);
    let told = normals.and_then(|normals| told_by_normals(&alone, &some, &of_sample(normals), floors, tuning));
    let with_normals = told.is_some();
    let Fits { sphere, cylinder, general } = told.unwrap_or(alone);
    let general = general.model;
    let distances = distances_of(&general, points);
    let n = points.len() as f64;
    let scale = mad(distances.iter().copied()).max(floors.position);
    let limit = (6.0 * scale * (n / (n - 6.0).max(1.0)).sqrt()).max(1e-9);
    let are_few = points.len() < tuning.outliers_from;
    let mut belongs: Vec<bool> = distances.iter().map(|d| d.abs() < limit || are_few).collect();
    if let Model::Constant(_, surface) = &general {
        take_back(surface, points, &distances, &sample, (limit, floors.position), &mut belongs, tuning);
    }
    Start { general, sphere, cylinder, distances, belongs, sample, with_normals }
}

/// Robust fits of three kinds.
struct Fits {
    sphere: Model,
    cylinder: Model,
    general: Fitted,
}

impl Fits {
    /// To positions, or to positions and normals.
    fn of(points: &[Vector], normals: Option<&[Vector]>, floors: &Floors, tuning: &Tuning) -> Fits {
        let directions = normals.map(|normals| Directions::new(normals, floors.normal, tuning));
        let fitted = |kind, theta| robust(points, directions.clone(), kind, theta, floors.position);
        let [sphere, cylinder, along, across] = quadric_starts(quadric(points, normals, tuning));
        let sphere = fitted(Kind::Sphere, sphere).model;
        let cylinder = fitted(Kind::Cylinder, cylinder).model;
        let mut best: Option<Fitted> = None;
        for theta in [along, across, sphere.theta(), cylinder.theta()] {
            let found = fitted(Kind::General, theta);
            let limit = best.as_ref().map_or(found.scale, |best| best.scale);
            let cost = |fit: &Fitted| {
                let of_positions = fit.distances.iter().map(|d| d.abs().min(3.0 * limit).powi(2)).sum::<f64>();
                of_positions + directions.as_ref().map_or(0.0, |directions| directions.cost(&fit.model, points))
            };
            if best.as_ref().is_none_or(|best| cost(&found) < cost(best) * (1.0 - 1e-3)) {
                best = Some(found);
            }
        }
        let general = best.unwrap_or_else(|| fitted(Kind::General, along));
        Fits { sphere, cylinder, general }
    }
}

/// Fits to positions and normals, where positions alone have led to a surface that the normals contradict, and another one explains
/// both: contacts in a ring or in two rows have no one surface. `None` elsewhere.
fn told_by_normals(
    alone: &Fits,
    points: &[Vector],
    normals: &[Vector],
    floors: &Floors,
    tuning: &Tuning,
) -> Option<Fits> {
    let Tuning { normals_lean: [leaning, contradicted], place_over_normal: of_normal, .. } = *tuning;
    let directions = Directions::new(normals, floors.normal, tuning);
    let off = |model: &Model| median(directions.errors(model, points)).unwrap_or(0.0);
    let of_alone = off(&alone.general.model);
    // a look at a height quadric is cheap, and most contacts need no more
    let [z0, gx, gy, a, b, c] = quadric(points, Some(normals), tuning);
    if of_alone < leaning || of_alone < contradicted * off(&Model::new(Kind::Paraboloid, [z0, gx, gy, a, c, b])) {
        return None;
    }
    let told = Fits::of(points, Some(normals), floors, tuning);
    let of_told = off(&told.general.model);
    let near = told.general.scale <= (tuning.told_as_near * alone.general.scale).max(of_normal * of_told);
    (near && of_alone > contradicted * of_told).then_some(told)
}

/// Starts of sphere, cylinder, and general with the larger curvature first and second.
fn quadric_starts([z0, gx, gy, a, b, c]: [f64; 6]) -> [[f64; 6]; 4] {
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

/// Coefficients z0, gx, gy, A, B, C of the height quadric, by slopes, too, where there are normals; the last ones are 0 where the
/// contacts cannot tell them.
fn quadric(points: &[Vector], normals: Option<&[Vector]>, tuning: &Tuning) -> [f64; 6] {
    let Tuning { place_over_normal: of_normal, start_upright, .. } = *tuning;
    let mut normal = [[0.0; 6]; 6];
    let mut rhs = [0.0; 6];
    let mut add = |row: [f64; 6], value: f64, weight: f64| {
        for i in 0..6 {
            rhs[i] += weight * row[i] * value;
            (0..=i).for_each(|j| normal[i][j] += weight * row[i] * row[j]);
        }
    };
    for (i, &[x, y, z]) in points.iter().enumerate() {
        add([1.0, x, y, 0.5 * x * x, x * y, 0.5 * y * y], z, 1.0);
        if let Some([nx, ny, nz]) = normals.map(|n| n[i]).filter(|n| n[2] > start_upright) {
            let weight = of_normal * of_normal;
            add([0.0, 1.0, 0.0, x, y, 0.0], -nx / nz, weight);
            add([0.0, 0.0, 1.0, 0.0, x, y], -ny / nz, weight);
        }
    }
    (0..6).for_each(|i| normal[i][i] *= 1.0 + 1e-9);
    solve_leading(normal, rhs, 6).unwrap_or([0.0; 6])
}
