//! Whether normals that contradict the places agree with them once their columns are exchanged or reversed.
//!
//! ```text
//! n' = (+-n_a, +-n_b, +-n_c) for every order a, b, c        agreement = median of |n' . g|, g the surface's normal
//! exchanged where that of n is below, and that of the best n' above `Tuning::normals_order`
//! ```

use crate::bodies::{BodySample, Tuning};
use palpate_geometry::contact::Contacts;
use palpate_numeric::statistics::median;
use palpate_numeric::vector::{Vector, dot};

const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];

/// The same beside the normals of planes through neighbours, for contacts that are no one surface; `None` where some normals are unknown.
pub(super) fn agreeing_order_by_neighbours(sample: &BodySample, tuning: &Tuning) -> Option<String> {
    let of_places = Contacts::from_points(&sample.points).with_estimated_normals(None).ok()?;
    let pair = |i: usize| Some((sample.normal(i)?, of_places.unit_normal(i)?));
    agreeing_order(&(0..sample.len()).map(pair).collect::<Option<Vec<(Vector, Vector)>>>()?, tuning)
}

/// The order of columns in which the normals agree with those of the surface, where they contradict it as they stand.
pub(super) fn agreeing_order(pairs: &[(Vector, Vector)], tuning: &Tuning) -> Option<String> {
    let [contradicts, agrees] = tuning.normals_order;
    let agreement = |order: [usize; 3], signs: [f64; 3]| {
        let cosine = |(given, of_surface): &(Vector, Vector)| {
            dot([0, 1, 2].map(|k| signs[k] * given[order[k]]), *of_surface).abs()
        };
        median(pairs.iter().map(cosine).collect::<Vec<f64>>()).unwrap_or(1.0)
    };
    if agreement(ORDERS[0], [1.0; 3]) > contradicts {
        return None;
    }
    // the sign of all three together changes nothing
    let signs = [[1.0, 1.0, 1.0], [-1.0, 1.0, 1.0], [1.0, -1.0, 1.0], [1.0, 1.0, -1.0]];
    let tried = ORDERS.iter().flat_map(|order| signs.iter().map(|signs| (*order, *signs)));
    let (order, signs) = tried.max_by(|a, b| agreement(a.0, a.1).total_cmp(&agreement(b.0, b.1)))?;
    let name = |k: usize| format!("{}{}", if signs[k] < 0.0 { "-" } else { "" }, ["nx", "ny", "nz"][order[k]]);
    (agreement(order, signs) > agrees).then(|| [name(0), name(1), name(2)].join(", "))
}
