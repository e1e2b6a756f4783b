//! Surfaces drawn from the posterior, kept so that a touch that comes later can be held against each of them.
//!
//! ```text
//! height of draw d over the reported surface, and its normal less the reported one, on a lattice of the map,
//! cubic in both numbers between its points
//! ```

use crate::recognition::Hypothesis;
use palpate_geometry::contact::Frame;
use palpate_numeric::vector::Vector;

/// Scales both shares so that either sum to 1 over all.
pub(crate) fn normalise(shares: &mut [&mut [f64; 2]]) {
    for k in [0, 1] {
        let sum: f64 = shares.iter().map(|own| own[k]).sum();
        shares.iter_mut().filter(|_| sum > 0.0).for_each(|own| own[k] /= sum);
    }
}

/// What one drawn surface says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DrawnShape {
    /// Its shares of all draws in estimates and in intervals; either sum to 1.
    pub(crate) shares: [f64; 2],
    pub(crate) hypothesis: Hypothesis,
    /// Draws of the same number were drawn from one gaussian, or nearly one.
    pub(crate) component: usize,
    /// Mean shape index; `None` of a plane.
    pub(crate) shape_index: Option<f64>,
    /// Mean curvedness, 1/length of the input.
    pub(crate) curvedness: f64,
    /// Radius of a ball or a bar in space, input units.
    pub(crate) radius: Option<f64>,
}

/// Height of a draw over the reported surface, and what its unit normal differs by.
pub(crate) type DrawnOffset = [f64; 4];

/// Draws of all kinds.
#[derive(Clone, Debug, Default)]
pub(crate) struct PosteriorDraws {
    pub(crate) shapes: Vec<DrawnShape>,
    /// Where the draws of a patch lie; those of a body tell it themselves.
    pub(crate) lattice: Option<DrawnLattice>,
}

/// Offsets of every draw at the points of a lattice.
#[derive(Clone, Debug, Default)]
pub(crate) struct DrawnLattice {
    /// Where its rows and columns lie in the map, 0 to 1.
    pub(crate) lines: [Vec<f64>; 2],
    /// Of every draw, row after row.
    pub(crate) offsets: Vec<Vec<DrawnOffset>>,
}

impl DrawnLattice {
    /// Numbers of the points about a place of the map, row after row, with their shares of what is said there: Lagrange's cubics
    /// through the four nearest lines of either direction.
    pub(crate) fn around(&self, place: [f64; 2]) -> Vec<(usize, f64)> {
        let [rows, columns] = [0, 1].map(|k| cubics(&self.lines[k], place[k]));
        let width = self.lines[1].len();
        rows.iter().flat_map(|(i, s)| columns.iter().map(move |(j, t)| (i * width + j, s * t))).collect()
    }

    /// From the patch's unit of length and axes to the input's.
    pub(crate) fn in_input(self, frame: &Frame) -> DrawnLattice {
        let one = |[height, normal @ ..]: DrawnOffset| {
            let [x, y, z]: Vector = frame.rotate_back(normal);
            [height * frame.scale, x, y, z]
        };
        let offsets = self.offsets.into_iter().map(|draw| draw.into_iter().map(one).collect()).collect();
        DrawnLattice { offsets, ..self }
    }
}

/// Values of Lagrange's polynomials through the lines next to a place, as many as there are up to four.
fn cubics(lines: &[f64], place: f64) -> Vec<(usize, f64)> {
    let count = lines.len().min(4);
    let first = lines.partition_point(|line| *line <= place).saturating_sub(2).min(lines.len() - count);
    let near = first..first + count;
    let one = |i: usize| {
        let others = near.clone().filter(|j| *j != i);
        (i, others.map(|j| (place - lines[j]) / (lines[i] - lines[j])).product::<f64>())
    };
    near.clone().map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn offsets_are_cubic_in_both_numbers_and_go_on_beyond_the_edges() {
        let lines = [vec![0.0, 0.3, 0.5, 0.8, 1.0], vec![0.0, 0.2, 0.6, 1.0]];
        let of = |u: f64, v: f64| 2.0 + 3.0 * u * u * u - v * u + v * v * (v - 0.5 * u * u);
        let offsets: Vec<f64> = lines[0].iter().flat_map(|u| lines[1].iter().map(|v| of(*u, *v))).collect();
        let lattice = DrawnLattice { lines, offsets: Vec::new() };
        for [u, v] in [[0.1, 0.2], [0.3, 0.9], [0.99, 0.0], [-0.05, 0.5], [1.05, 1.02]] {
            let found: f64 = lattice.around([u, v]).iter().map(|(at, share)| share * offsets[*at]).sum();
            assert!((found - of(u, v)).abs() < 1e-12, "{u} {v}");
        }
    }

    #[test]
    fn a_lattice_of_one_point_says_the_same_everywhere_and_none_says_nothing() {
        let lattice = DrawnLattice { lines: [vec![0.0], vec![0.0]], offsets: Vec::new() };
        assert_eq!(lattice.around([0.7, 0.2]), [(0, 1.0)]);
        assert!(DrawnLattice::default().around([0.5, 0.5]).is_empty());
    }
}
