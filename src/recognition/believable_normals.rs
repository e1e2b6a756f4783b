//! Whether a file's normals are measurements, or were computed from its positions and carry no news.
//!
//! ```text
//! a = n - n_surface      b = (normal of the plane through 13 nearest contacts) - n_surface      (tangential parts)
//! correlation = sum a.b / sqrt(sum a.a sum b.b)          above 0.3: computed from the positions
//! ```

use faer::{Mat, Side};

use crate::vector::{Vector, dot, minus, norm, reject, scaled};

use super::model::Model;
use super::neighbours::Neighbours;

/// Contacts from which on the test is made. Fewer are touches, whose normals a sensor gave.
const DENSE: usize = 200;

/// Contacts in the plane through a neighbourhood, its own included.
const NEAREST: usize = 13;

/// Correlation above which normals were computed from positions. Scans have 0.7 to 0.9, measured normals below 0.3.
const DERIVED: f64 = 0.3;

/// A difference as large as this is a blunder, and left out.
const BLUNDER: f64 = 0.5;

/// Cosine below which a normal contradicts the surface: 60 degrees off.
pub(super) const AGAINST: f64 = 0.5;

/// Whether the normals of these contacts follow from the positions.
pub(super) fn derived_from_positions(
    points: &[Vector],
    normals: &[Vector],
    surface: &Model,
    sample: impl Iterator<Item = usize>,
) -> bool {
    if points.len() <= DENSE {
        return false;
    }
    let tree = Neighbours::new(points);
    let (mut ab, mut aa, mut bb) = (0.0, 0.0, 0.0);
    for i in sample {
        let (_, n) = surface.distance_and_normal(points[i]);
        let Some(local) = plane_normal(&tree, points, points[i]) else { continue };
        if dot(normals[i], n) < AGAINST {
            continue;
        }
        let local = if dot(local, normals[i]) < 0.0 { scaled(-1.0, local) } else { local };
        let (a, b) = (reject(minus(normals[i], n), n), reject(minus(local, n), n));
        if norm(a) < BLUNDER && norm(b) < BLUNDER {
            (ab, aa, bb) = (ab + dot(a, b), aa + dot(a, a), bb + dot(b, b));
        }
    }
    aa > 0.0 && bb > 0.0 && ab > DERIVED * (aa * bb).sqrt()
}

/// Normal of the plane through the nearest contacts.
fn plane_normal(tree: &Neighbours, points: &[Vector], place: Vector) -> Option<Vector> {
    let near = tree.nearest(place, NEAREST);
    let mut mean = [0.0; 3];
    for (_, i) in &near {
        (0..3).for_each(|k| mean[k] += points[*i as usize][k] / near.len() as f64);
    }
    let mut covariance = Mat::<f64>::zeros(3, 3);
    for (_, i) in &near {
        let d = minus(points[*i as usize], mean);
        for r in 0..3 {
            (0..=r).for_each(|c| covariance[(r, c)] += d[r] * d[c]);
        }
    }
    let eigen = covariance.self_adjoint_eigen(Side::Lower).ok()?;
    Some([0, 1, 2].map(|r| eigen.U()[(r, 0)]))
}
