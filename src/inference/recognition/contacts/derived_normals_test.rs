//! Whether a file's normals are measurements, or were computed from its positions and tell nothing new.
//!
//! ```text
//! a = n - n_surface      b = (normal of the plane through 13 nearest contacts) - n_surface      (tangential parts)
//! A = a_i - (a_j + a_k)/2      B alike          j a neighbourhood away from i, k opposite of it
//! correlation = sum A.B / sqrt(sum A.A sum B.B)          above the first of `Tuning::normals_derived`, and
//! share = sum E(B.B of the positions' errors) / sum B.B  above the second: computed from the positions
//! ```
//!
//! Where the true shape departs from the surface, it rotates both normals alike although neither was computed from the other: a and
//! b of a bump correlate by 0.6. In second differences such a departure cancels, but for its own bend. What is left of that bend in contacts
//! that lie far apart correlates as errors would; the errors of the positions, which a local quadratic tells, then explain little of B.

use crate::bodies::Tuning;
use crate::recognition::kinds::Model;

use palpate_geometry::neighbours::{NEAREST, Neighbours, plane_normal};
use palpate_numeric::linalg::small::{cholesky, solve};
use palpate_numeric::vector::{Vector, along, axes_along, dot, minus, norm, reject, scaled};

/// Share of the distance to its partner by which a contact may miss the opposite place.
const OPPOSITE: f64 = 0.5;

/// A difference as large as this is a blunder, and left out.
const BLUNDER: f64 = 0.5;

/// Coefficients of a quadratic height.
const TERMS: usize = 6;

/// Whether the normals of these contacts follow from the positions.
pub(crate) fn derived_from_positions(
    points: &[Vector],
    normals: &[Vector],
    surface: &Model,
    sample: impl Iterator<Item = usize>,
    tuning: &Tuning,
) -> bool {
    if points.len() <= tuning.derived_from {
        return false;
    }
    let tree = Neighbours::new(points);
    let of = |j: usize| both(&tree, points, normals, surface, j, tuning.normal_against);
    let mut rough = Correlation::default();
    for i in sample {
        let Some([j, k]) = opposite_pair(&tree, points, i) else { continue };
        if let (Some(here), Some(there), Some(opposite)) = (of(i), of(j), of(k)) {
            let difference =
                |of: fn(&TurnPair) -> Vector| minus(of(&here), scaled(0.5, along(of(&there), 1.0, of(&opposite))));
            let of_errors = here.variance + 0.25 * (there.variance + opposite.variance);
            rough.add(difference(|turns| turns.given), difference(|turns| turns.local), of_errors);
        }
    }
    let [correlation, share] = tuning.normals_derived;
    rough.exceeds(correlation, share)
}

/// The contact a neighbourhood away from contact i, and the one opposite of it; `None` where nothing lies opposite.
fn opposite_pair(tree: &Neighbours, points: &[Vector], i: usize) -> Option<[usize; 2]> {
    let j = tree.nearest(points[i], NEAREST).last()?.1 as usize;
    let apart = minus(points[i], points[j]);
    let opposite = along(points[i], 1.0, apart);
    let k = tree.nearest(opposite, 1).first()?.1 as usize;
    (norm(minus(points[k], opposite)) < OPPOSITE * norm(apart)).then_some([j, k])
}

/// Sums of a correlation between vectors, and of what errors make of the second.
#[derive(Default)]
struct Correlation {
    ab: f64,
    aa: f64,
    bb: f64,
    of_errors: f64,
}

impl Correlation {
    fn add(&mut self, a: Vector, b: Vector, of_errors: f64) {
        self.ab += dot(a, b);
        self.aa += dot(a, a);
        self.bb += dot(b, b);
        self.of_errors += of_errors;
    }

    fn exceeds(&self, limit: f64, share: f64) -> bool {
        let correlates = self.aa > 0.0 && self.bb > 0.0 && self.ab > limit * (self.aa * self.bb).sqrt();
        correlates && self.of_errors > share * self.bb
    }
}

/// Tangential differences of two normals from the surface's.
struct TurnPair {
    /// Of the file's.
    given: Vector,
    /// Of the neighbourhood's plane.
    local: Vector,
    /// Variance of the latter by errors of the positions, both directions together.
    variance: f64,
}

/// The turns at one contact; `None` of blunders, and of a normal whose cosine with the surface's is below `against`.
fn both(
    tree: &Neighbours,
    points: &[Vector],
    normals: &[Vector],
    surface: &Model,
    i: usize,
    against: f64,
) -> Option<TurnPair> {
    let (_, n) = surface.distance_and_normal(points[i]);
    if dot(normals[i], n) < against {
        return None;
    }
    let local = plane_normal(tree, points, points[i])?;
    let local = if dot(local, normals[i]) < 0.0 { scaled(-1.0, local) } else { local };
    let (a, b) = (reject(minus(normals[i], n), n), reject(minus(local, n), n));
    let variance = variance_of_plane(tree, points, points[i], local)?;
    (norm(a) < BLUNDER && norm(b) < BLUNDER).then_some(TurnPair { given: a, local: b, variance })
}

/// Variance of the normal of the plane through a neighbourhood by errors of its places: those that a quadratic height leaves.
///
/// `s^2 (1/sum x^2 + 1/sum y^2)` over places about their mean, x and y along the plane's main axes.
fn variance_of_plane(tree: &Neighbours, points: &[Vector], place: Vector, normal: Vector) -> Option<f64> {
    let near: Vec<Vector> = tree.nearest(place, NEAREST).iter().map(|(_, i)| points[*i as usize]).collect();
    let count = near.len() as f64;
    let mean = near.iter().fold([0.0; 3], |sum, p| along(sum, 1.0 / count, *p));
    let [first, second, _] = axes_along(normal);
    let local: Vec<Vector> =
        near.iter().map(|p| minus(*p, mean)).map(|d| [dot(d, first), dot(d, second), dot(d, normal)]).collect();
    let size = local.iter().map(|[x, y, _]| x * x + y * y).sum::<f64>().sqrt().max(f64::MIN_POSITIVE);
    let row = |[x, y, _]: &Vector| {
        let [x, y] = [x / size, y / size];
        [1.0, x, y, x * x, x * y, y * y]
    };
    let (mut matrix, mut right) = ([[0.0; TERMS]; TERMS], [0.0; TERMS]);
    for place in &local {
        let row = row(place);
        for a in 0..TERMS {
            right[a] += row[a] * place[2];
            (0..TERMS).for_each(|b| matrix[a][b] += row[a] * row[b]);
        }
    }
    let coefficients = solve(&cholesky(&matrix)?, right);
    let left = |place: &Vector| place[2] - row(place).iter().zip(&coefficients).map(|(r, c)| r * c).sum::<f64>();
    let variance = local.iter().map(|p| left(p).powi(2)).sum::<f64>() / (count - TERMS as f64).max(1.0);
    let sum = |a: usize, b: usize| local.iter().map(|p| p[a] * p[b]).sum::<f64>();
    let (xx, xy, yy) = (sum(0, 0), sum(0, 1), sum(1, 1));
    let determinant = xx * yy - xy * xy;
    (determinant > 0.0).then(|| variance * (xx + yy) / determinant)
}
