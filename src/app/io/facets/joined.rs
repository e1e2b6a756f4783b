//! Corners that stand at one place but for the digits of the file are one vertex, so that facets have neighbours.
//!
//! ```text
//! |p - q| < 1e-6 size        six digits of text, and more than the rounding of 32-bit numbers
//! ```
//!
//! Cells of four times that size are looked through: a corner meets its twin in its own cell or beyond the nearest of the cell's walls.

use std::collections::HashMap;

use palpate_numeric::vector::{Vector, minus, norm};

use super::Facets;

/// Distance in units of the size of the whole below which corners are one.
pub(super) const FILE_STEP: f64 = 1e-6;

/// The same facets with corners at one place joined; facets that this leaves without three corners are gone.
pub(super) fn joined(facets: Facets) -> Facets {
    let step = FILE_STEP * facets.size;
    let mut cells: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
    let mut kept: Vec<Vector> = Vec::new();
    let cell = |p: Vector, shift: Vector| [0, 1, 2].map(|k| ((p[k] + shift[k]) / (4.0 * step)).floor() as i64);
    let mut number = Vec::with_capacity(facets.places.len());
    for &place in &facets.places {
        let corners = (0..8).map(|bits| [0, 1, 2].map(|k| if bits >> k & 1 == 0 { -step } else { step }));
        let mut around: Vec<[i64; 3]> = corners.map(|shift| cell(place, shift)).collect();
        around.sort_unstable();
        around.dedup();
        let near = |v: &usize| norm(minus(kept[*v], place)) <= step;
        let twin = around.iter().filter_map(|key| cells.get(key)).flatten().copied().find(near);
        number.push(twin.unwrap_or_else(|| {
            kept.push(place);
            cells.entry(cell(place, [0.0; 3])).or_default().push(kept.len() - 1);
            kept.len() - 1
        }));
    }
    let renamed = facets.corners.iter().map(|corners| corners.map(|v| number[v]));
    let whole: Vec<[usize; 3]> = renamed.filter(|[a, b, c]| a != b && b != c && c != a).collect();
    Facets::of(kept, &whole)
}
