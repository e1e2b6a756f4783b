//! At most 200 averaged contacts: means over voxels, with the curvature inside a voxel taken out.
//!
//! ```text
//! C = mean P + (mean d - d(mean P)) n         the mean distance, at the foot of the mean place
//! D = diag(mean count / count)                variance of a mean relative to that of an average cell
//! ```
//!
//! There are at most 200, because work with dense matrices grows with the cube of their number; 300 gave the same
//! answers.

use std::collections::HashMap;

use crate::vector::{Vector, along, cross, unit};

use super::descent::median;
use super::model::Model;

/// Cells at most.
const MOST: usize = 200;

/// Range of voxel sizes, in units of the patch's size, and the halvings of its logarithm.
const SIZES: [f64; 2] = [1e-3, 8.0];
const HALVINGS: usize = 20;

/// Measured normals of the cells.
#[derive(Clone, Debug)]
pub(super) struct CellNormals {
    pub(super) measured: Vec<Vector>,
    /// Variance relative to that of an average cell.
    pub(super) variance: Vec<f64>,
}

/// The averaged contacts.
#[derive(Clone, Debug)]
pub(super) struct Cells {
    pub(super) points: Vec<Vector>,
    /// Variance relative to that of an average cell.
    pub(super) variance: Vec<f64>,
    /// Weights of the plain refits: the counts, limited so that a crowded cell does not outvote the others.
    pub(super) weights: Vec<f64>,
    /// Two tangents of the robust surface.
    pub(super) tangents: [Vec<Vector>; 2],
    pub(super) normals: Option<CellNormals>,
}

/// Averages contacts; `errors` are measured minus model normals, `None` where a normal is not used.
pub(super) fn cells(points: &[Vector], surface: &Model, errors: Option<&[Option<Vector>]>) -> Cells {
    let (of, count) = membership(points);
    let mut counts = vec![0.0; count];
    let mut sums = vec![[0.0; 3]; count];
    let mut distances = vec![0.0; count];
    for (&cell, p) in of.iter().zip(points) {
        counts[cell] += 1.0;
        sums[cell] = along(sums[cell], 1.0, *p);
        distances[cell] += surface.distance(*p);
    }
    let mut centres = Vec::with_capacity(count);
    let mut surface_normals = Vec::with_capacity(count);
    for cell in 0..count {
        let mean = sums[cell].map(|v| v / counts[cell]);
        let (d, normal) = surface.distance_and_normal(mean);
        centres.push(along(mean, distances[cell] / counts[cell] - d, normal));
        surface_normals.push(normal);
    }
    let middle = median(counts.clone());
    let mean_count = points.len() as f64 / count as f64;
    let first: Vec<Vector> = surface_normals.iter().map(|n| tangent(*n)).collect();
    let second = surface_normals.iter().zip(&first).map(|(n, t)| cross(*n, *t)).collect();
    Cells {
        normals: errors.map(|errors| cell_normals(&of, &centres, surface, errors)),
        variance: counts.iter().map(|c| mean_count / c).collect(),
        weights: counts.iter().map(|c| c.min(4.0 * middle) / middle).collect(),
        tangents: [first, second],
        points: centres,
    }
}

fn tangent(n: Vector) -> Vector {
    let axis = if n[1].abs() < 0.9 { [0.0, 1.0, 0.0] } else { [1.0, 0.0, 0.0] };
    unit(cross(n, axis))
}

fn cell_normals(of: &[usize], centres: &[Vector], surface: &Model, errors: &[Option<Vector>]) -> CellNormals {
    let mut counts = vec![0.0_f64; centres.len()];
    let mut sums = vec![[0.0; 3]; centres.len()];
    for (&cell, error) in of.iter().zip(errors) {
        if let Some(error) = error {
            counts[cell] += 1.0;
            sums[cell] = along(sums[cell], 1.0, *error);
        }
    }
    let measured = (0..centres.len())
        .map(|c| along(surface.distance_and_normal(centres[c]).1, 1.0 / counts[c].max(1.0), sums[c]))
        .collect();
    // a cell without normals counts as a hundredth of a normal, so that it has hardly any weight
    counts.iter_mut().for_each(|c| *c = c.max(0.01));
    let mean = counts.iter().sum::<f64>() / counts.len() as f64;
    CellNormals { measured, variance: counts.iter().map(|c| mean / c).collect() }
}

/// Cell of every point, and the number of cells.
fn membership(points: &[Vector]) -> (Vec<usize>, usize) {
    if points.len() <= MOST {
        return ((0..points.len()).collect(), points.len());
    }
    let [mut lo, mut hi] = SIZES;
    for _ in 0..HALVINGS {
        let size = (lo * hi).sqrt();
        if voxels(points, size, MOST).is_none() {
            lo = size;
        } else {
            hi = size;
        }
    }
    voxels(points, hi, usize::MAX).unwrap_or((vec![0; points.len()], 1))
}

/// The voxel of every point, voxels numbered in the order of their first points; `None` when there are more than
/// `most`.
fn voxels(points: &[Vector], size: f64, most: usize) -> Option<(Vec<usize>, usize)> {
    let mut numbers: HashMap<[i64; 3], usize> = HashMap::new();
    let mut of = Vec::with_capacity(points.len());
    for p in points {
        let next = numbers.len();
        of.push(*numbers.entry(p.map(|v| (v / size + 0.5).floor() as i64)).or_insert(next));
        if numbers.len() > most {
            return None;
        }
    }
    Some((of, numbers.len()))
}
