//! The planes in which contacts with normals lie: contacts are merged one by one, the nearest first.
//!
//! ```text
//! cost = sum_i (m . p_i - c)^2 + a^2 |n_i - m|^2      m, c: the plane of some contacts, a: `Tuning::log_ratio`
//! merged next         the two whose cost together is least more than that of both
//! ```
//!
//! J. Ward, *J. Am. Stat. Assoc.* 58 (1963) 236. A search for one plane after another needs a face with a fair share of all contacts; a few
//! touches all over a box leave no face such a share.

use super::sample::BodySample;
use super::tuning::Tuning;
use palpate_numeric::linalg::small::{Square, cholesky, solve};
use palpate_numeric::vector::{Vector, dot, norm, scaled, unit_or_zero};

/// Contacts of one plane.
#[derive(Clone, Debug)]
pub(super) struct FlatFace {
    pub(super) members: Vec<usize>,
    /// Sums of places, of normals, and of the products of places.
    places: Vector,
    normals: Vector,
    products: Square<3>,
    cost: f64,
}

impl FlatFace {
    fn of(contact: usize, place: Vector, normal: Vector) -> FlatFace {
        let products = [0, 1, 2].map(|i| [0, 1, 2].map(|j| place[i] * place[j]));
        FlatFace { members: vec![contact], places: place, normals: normal, products, cost: 0.0 }
    }

    /// A place of its plane and the unit normal there.
    pub(super) fn plane(&self, arm: f64) -> (Vector, Vector) {
        let count = self.members.len() as f64;
        let middle = scaled(1.0 / count, self.places);
        let held = arm * arm * norm(self.normals).max(1e-9);
        let scatter = [0, 1, 2].map(|i| {
            [0, 1, 2].map(|j| self.products[i][j] - count * middle[i] * middle[j] + if i == j { held } else { 0.0 })
        });
        let across = cholesky(&scatter).map_or(self.normals, |factor| solve(&factor, self.normals));
        (middle, unit_or_zero(across))
    }

    fn with(&self, other: &FlatFace, arm: f64) -> FlatFace {
        let sum = |a: Vector, b: Vector| [0, 1, 2].map(|k| a[k] + b[k]);
        let mut both = FlatFace {
            members: [&self.members[..], &other.members[..]].concat(),
            places: sum(self.places, other.places),
            normals: sum(self.normals, other.normals),
            products: [0, 1, 2].map(|i| sum(self.products[i], other.products[i])),
            cost: 0.0,
        };
        let (middle, across) = both.plane(arm);
        let count = both.members.len() as f64;
        let off = (0..3).map(|i| across[i] * dot(both.products[i], across)).sum::<f64>()
            - count * dot(middle, across).powi(2);
        both.cost = off.max(0.0) + 2.0 * arm * arm * (count - dot(across, both.normals)).max(0.0);
        both
    }
}

/// Faces of all contacts in every number from the most that are told apart down to one, the largest face first; none where a normal is unknown.
pub(super) fn faces(sample: &BodySample, tuning: &Tuning) -> Vec<Vec<FlatFace>> {
    let normals: Option<Vec<Vector>> = (0..sample.len()).map(|i| sample.normal(i)).collect();
    let Some(normals) = normals else { return Vec::new() };
    let arm = tuning.log_ratio[0].exp();
    let mut known: Vec<FlatFace> = (0..sample.len()).map(|i| FlatFace::of(i, sample.points[i], normals[i])).collect();
    let mut nearest: Vec<(f64, usize)> = (0..known.len()).map(|i| next_to(&known, i, arm)).collect();
    let mut found = Vec::new();
    while known.len() > 1 {
        merge_nearest(&mut known, &mut nearest, arm);
        if known.len() <= tuning.most_things {
            let mut by_size = known.clone();
            by_size.sort_by_key(|face| std::cmp::Reverse(face.members.len()));
            found.push(by_size);
        }
    }
    found
}

/// Merges the two faces that cost least together; of every face the one nearest to it is kept up to date.
fn merge_nearest(known: &mut Vec<FlatFace>, nearest: &mut Vec<(f64, usize)>, arm: f64) {
    let Some(first) = (0..known.len()).min_by(|a, b| nearest[*a].0.total_cmp(&nearest[*b].0)) else { return };
    let second = nearest[first].1;
    let (kept, gone) = (first.min(second), first.max(second));
    known[kept] = known[kept].with(&known[gone], arm);
    known.swap_remove(gone);
    nearest.swap_remove(gone);
    let moved = known.len();
    for i in 0..known.len() {
        let of = nearest[i].1;
        if i == kept || of == kept || of == gone {
            nearest[i] = next_to(known, i, arm);
            continue;
        }
        if of == moved {
            nearest[i].1 = gone;
        }
        let by = together(known, i, kept, arm);
        if by < nearest[i].0 {
            nearest[i] = (by, kept);
        }
    }
}

/// By how much two faces cost more together than each by itself.
fn together(known: &[FlatFace], one: usize, other: usize, arm: f64) -> f64 {
    known[one].with(&known[other], arm).cost - known[one].cost - known[other].cost
}

/// The face that costs least together with one.
fn next_to(known: &[FlatFace], of: usize, arm: f64) -> (f64, usize) {
    let others = (0..known.len()).filter(|i| *i != of).map(|i| (together(known, of, i, arm), i));
    others.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((f64::INFINITY, of))
}
