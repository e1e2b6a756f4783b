//! Whether a file's normals are measurements, or were computed from its positions and tell nothing new.
//!
//! ```text
//! a = n - n_surface      b = (normal of the plane through 13 nearest contacts) - n_surface      (tangential parts)
//! A = a_i - (a_j + a_k)/2      B alike          j a neighbourhood away from i, k opposite of it
//! correlation = sum A.B / sqrt(sum A.A sum B.B)          above 0.25: computed from the positions
//! ```
//!
//! Where the true shape departs from the surface, it rotates both normals alike although neither was computed from the other: a and
//! b of a bump correlate by 0.6. In second differences such a departure cancels, but for its own bend.

use crate::recognition::kinds::Model;

use palpate_geometry::neighbours::{NEAREST, Neighbours, plane_normal};
use palpate_numeric::vector::{Vector, along, dot, minus, norm, reject, scaled};

/// Contacts from which on the test is made. Fewer are touches, whose normals a sensor gave.
const DENSE: usize = 200;

/// Correlation above which normals were computed from positions. Seven scans have 0.34 to 0.86; measured normals have 0.06 and
/// less, with a scatter of 0.07 where 200 contacts are asked.
const DERIVED: f64 = 0.25;

/// Share of the distance to its partner by which a contact may miss the opposite place.
const OPPOSITE: f64 = 0.5;

/// A difference as large as this is a blunder, and left out.
const BLUNDER: f64 = 0.5;

/// Cosine below which a normal contradicts the surface: 60 degrees off.
pub(crate) const AGAINST: f64 = 0.5;

/// Whether the normals of these contacts follow from the positions.
pub(crate) fn derived_from_positions(
    points: &[Vector],
    normals: &[Vector],
    surface: &Model,
    sample: impl Iterator<Item = usize>,
) -> bool {
    if points.len() <= DENSE {
        return false;
    }
    let tree = Neighbours::new(points);
    let of = |j: usize| both(&tree, points, normals, surface, j);
    let mut rough = Correlation::default();
    for i in sample {
        let Some([j, k]) = opposite_pair(&tree, points, i) else { continue };
        if let (Some((a, b)), Some((c, d)), Some((e, f))) = (of(i), of(j), of(k)) {
            let middle = |p: Vector, q: Vector| scaled(0.5, along(p, 1.0, q));
            rough.add(minus(a, middle(c, e)), minus(b, middle(d, f)));
        }
    }
    rough.exceeds(DERIVED)
}

/// The contact a neighbourhood away from contact i, and the one opposite of it; `None` where nothing lies opposite.
fn opposite_pair(tree: &Neighbours, points: &[Vector], i: usize) -> Option<[usize; 2]> {
    let j = tree.nearest(points[i], NEAREST).last()?.1 as usize;
    let apart = minus(points[i], points[j]);
    let opposite = along(points[i], 1.0, apart);
    let k = tree.nearest(opposite, 1).first()?.1 as usize;
    (norm(minus(points[k], opposite)) < OPPOSITE * norm(apart)).then_some([j, k])
}

/// Sums of a correlation between vectors.
#[derive(Default)]
struct Correlation {
    ab: f64,
    aa: f64,
    bb: f64,
}

impl Correlation {
    fn add(&mut self, a: Vector, b: Vector) {
        self.ab += dot(a, b);
        self.aa += dot(a, a);
        self.bb += dot(b, b);
    }

    fn exceeds(&self, limit: f64) -> bool {
        self.aa > 0.0 && self.bb > 0.0 && self.ab > limit * (self.aa * self.bb).sqrt()
    }
}

/// Tangential differences of the file's normal and of the neighbourhood's from the surface's; `None` of blunders.
fn both(
    tree: &Neighbours,
    points: &[Vector],
    normals: &[Vector],
    surface: &Model,
    i: usize,
) -> Option<(Vector, Vector)> {
    let (_, n) = surface.distance_and_normal(points[i]);
    if dot(normals[i], n) < AGAINST {
        return None;
    }
    let local = plane_normal(tree, points, points[i])?;
    let local = if dot(local, normals[i]) < 0.0 { scaled(-1.0, local) } else { local };
    let (a, b) = (reject(minus(normals[i], n), n), reject(minus(local, n), n));
    (norm(a) < BLUNDER && norm(b) < BLUNDER).then_some((a, b))
}
