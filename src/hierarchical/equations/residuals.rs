//! What the contacts say beyond a surface: residuals of heights, and of slopes or normals as the rows of their objective.
//!
//! ```text
//! heights  r = z - S        slopes  zx - S_x, zy - S_y        normals  the two rows of a Gauss-Newton step, |n - n^|^2 to first order
//! ```

use std::ops::Range;

use super::sorted_contacts::SortedContacts;
use super::surface_cells::SurfaceCells;
use palpate_fitting::observation::linearise_normals;
use palpate_geometry::contact::Orientation;
use palpate_numeric::linalg::SiteWeights;
use palpate_numeric::threads;

/// Residuals in the order of the sorted contacts.
#[derive(Clone, Debug, Default)]
pub struct ContactResiduals {
    /// `z - S`, patch units.
    pub heights: Vec<f64>,
    /// Two numbers for each contact with a slope or a normal; empty without.
    pub slopes: Vec<[f64; 2]>,
}

/// Cells that one thread takes at a time.
const PIECE: usize = 16;

/// Slope rows of contact r about the slopes `(p, q)`: the triangle of their weights, and what they leave.
#[inline]
pub(crate) fn slope_residual(contacts: &SortedContacts, r: usize, p: f64, q: f64) -> (SiteWeights, [f64; 2]) {
    const EQUAL: SiteWeights = SiteWeights { z: 0.0, a: 1.0, b: 0.0, d: 1.0 };
    let contacts = contacts.contacts();
    match &contacts.orientation {
        Orientation::None => (SiteWeights { a: 0.0, d: 0.0, ..EQUAL }, [0.0; 2]),
        Orientation::Slopes { zx, zy } => {
            let [x, y] = [&contacts.weights.x, &contacts.weights.y].map(|w| w.as_ref().map_or(1.0, |w| w[r]));
            (SiteWeights { z: 0.0, a: x, b: 0.0, d: y }, [x * (zx[r] - p), y * (zy[r] - q)])
        }
        Orientation::Normals { .. } => {
            let weight = contacts.weights.x.as_ref().map_or(1.0, |w| w[r]);
            let Some(normal) = contacts.unit_normal(r) else { return (EQUAL, [0.0; 2]) };
            let (m, target) = linearise_normals(normal, p, q);
            let left = [target[0] - (m.a * p + m.b * q), target[1] - m.d * q].map(|v| weight * v);
            (SiteWeights { z: 0.0, a: weight * m.a, b: weight * m.b, d: weight * m.d }, left)
        }
    }
}

impl ContactResiduals {
    /// Those of all contacts about a surface whose cells hold them all, on all threads.
    pub fn of(contacts: &SortedContacts, surface: SurfaceCells<'_>) -> ContactResiduals {
        let SurfaceCells { mesh, cells, .. } = surface;
        let mut made = ContactResiduals {
            heights: vec![0.0; contacts.len()],
            slopes: if contacts.oriented() { vec![[0.0; 2]; contacts.len()] } else { Vec::new() },
        };
        let mut pieces = Vec::new();
        let (mut heights, mut slopes) = (&mut made.heights[..], &mut made.slopes[..]);
        for from in (0..cells.len()).step_by(PIECE) {
            let to = cells.len().min(from + PIECE);
            let start = contacts.of_cell(mesh, cells[from]).start;
            let count = contacts.of_cell(mesh, cells[to - 1]).end - start;
            let (piece, rest) = heights.split_at_mut(count);
            let (oriented, others) = slopes.split_at_mut(if slopes.is_empty() { 0 } else { count });
            (heights, slopes) = (rest, others);
            pieces.push((from..to, start, piece, oriented));
        }
        threads::each(&mut pieces, |_, (numbers, start, heights, slopes)| {
            for number in numbers.clone() {
                let range = contacts.of_cell(mesh, cells[number]);
                let inside = range.start - *start..range.end - *start;
                let slopes = if slopes.is_empty() { &mut [][..] } else { &mut slopes[inside.clone()] };
                cell_residuals(contacts, surface, number, range, &mut heights[inside], slopes);
            }
        });
        made
    }
}

fn cell_residuals(
    contacts: &SortedContacts,
    surface: SurfaceCells<'_>,
    number: usize,
    range: Range<usize>,
    heights: &mut [f64],
    slopes: &mut [[f64; 2]],
) {
    if range.is_empty() {
        return;
    }
    let polynomial = surface.polynomial(number);
    let columns = contacts.contacts();
    for (k, r) in range.enumerate() {
        let at = polynomial.local(columns.x[r], columns.y[r]);
        if slopes.is_empty() {
            heights[k] = columns.z[r] - polynomial.height(at);
        } else {
            let [z, p, q] = polynomial.height_and_slopes(at);
            heights[k] = columns.z[r] - z;
            slopes[k] = slope_residual(contacts, r, p, q).1;
        }
    }
}
