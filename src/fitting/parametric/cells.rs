//! The cell of a place (u, v), the coefficients that are nonzero there, and the basis with its derivatives.
//!
//! ```text
//! Q_kl = sum_ab c_(first_u + a, first_v + b) N_a^(k) M_b^(l)
//! ```

use super::vector::{Vector, cross};
use palpate_numeric::bspline::{Knots, MAX_DEGREE};
use palpate_numeric::linalg::MapShape;

/// Most basis functions that are nonzero at a place, in one direction.
const WIDTH: usize = MAX_DEGREE + 1;
/// Orders of derivatives: 0 to 3.
const ORDERS: usize = 4;

/// Derivatives of a parametric surface by their orders `[k][l]`.
pub(super) type Jet = [[Vector; ORDERS]; ORDERS];

/// Knots of a parametric surface and the numbering of its distinct coefficients.
#[derive(Clone, Debug)]
pub(super) struct Cells {
    knots: [Knots; 2],
    shape: MapShape,
}

/// The basis at one (u, v).
#[derive(Clone, Debug)]
pub(super) struct Row {
    /// Number of the cell.
    pub cell: usize,
    first: [usize; 2],
    values: [[f64; ORDERS * WIDTH]; 2],
    width: [usize; 2],
}

impl Cells {
    /// The cells of these knots.
    pub(super) fn new(knots: [Knots; 2]) -> Cells {
        let shape = MapShape {
            free: [knots[0].free(), knots[1].free()],
            degree: [knots[0].degree(), knots[1].degree()],
            closed: [knots[0].is_closed(), knots[1].is_closed()],
        };
        Cells { knots, shape }
    }

    /// Knots in u and v.
    pub(super) fn knots(&self) -> &[Knots; 2] {
        &self.knots
    }

    /// Numbering of the distinct coefficients.
    pub(super) fn shape(&self) -> MapShape {
        self.shape
    }

    /// Number of coefficients that are nonzero in one cell.
    pub(super) fn local(&self) -> usize {
        (self.shape.degree[0] + 1) * (self.shape.degree[1] + 1)
    }

    /// Number of cells.
    pub(super) fn count(&self) -> usize {
        self.knots[0].n_segments() * self.knots[1].n_segments()
    }

    /// The cell of (u, v).
    pub(super) fn cell_of(&self, [u, v]: [f64; 2]) -> usize {
        let segment = |k: usize, t: f64| self.knots[k].segment_of(self.knots[k].wrapped(t));
        segment(0, u) * self.knots[1].n_segments() + segment(1, v)
    }

    /// The basis at (u, v) with derivatives up to `order`; closed directions wrap.
    pub(super) fn row(&self, u: f64, v: f64, order: usize) -> Row {
        let mut row = Row { cell: 0, first: [0; 2], values: [[0.0; ORDERS * WIDTH]; 2], width: [0; 2] };
        for (k, t) in [u, v].into_iter().enumerate() {
            let knots = &self.knots[k];
            let t = knots.wrapped(t);
            let width = knots.degree() + 1;
            let segment = knots.segment_of(t);
            knots.derivatives_on(segment, t, order, &mut row.values[k][..(order + 1) * width]);
            row.first[k] = knots.first_basis(segment);
            row.width[k] = width;
            row.cell = row.cell * knots.n_segments() + segment;
        }
        row
    }

    /// The basis at the u of one row and the v of another.
    pub(super) fn joined(&self, of_u: &Row, of_v: &Row) -> Row {
        let segments = self.knots[1].n_segments();
        Row {
            cell: of_u.cell / segments * segments + of_v.cell % segments,
            first: [of_u.first[0], of_v.first[1]],
            values: [of_u.values[0], of_v.values[1]],
            width: of_u.width,
        }
    }

    /// Numbers of the coefficients that are nonzero in the cell of `row`, in the order of [`Row::products`].
    pub(super) fn alive(&self, row: &Row, out: &mut Vec<usize>) {
        let [n, m] = self.shape.free;
        out.clear();
        for a in 0..row.width[0] {
            let i = (row.first[0] + a) % n;
            out.extend((0..row.width[1]).map(|b| i * m + (row.first[1] + b) % m));
        }
    }

    /// Derivatives `[k][l]` of the surface with these coefficients, `k + l <= ORDER`.
    #[inline]
    pub(super) fn jet<const ORDER: usize>(&self, row: &Row, c: &[Vector]) -> Jet {
        let mut out = [[[0.0; 3]; ORDERS]; ORDERS];
        let [n, m] = self.shape.free;
        let [wide_u, wide_v] = row.width;
        for a in 0..wide_u {
            // a closed direction has more than p + 1 coefficients, so the index wraps at most once
            let i = row.first[0] + a;
            let line = &c[if i < n { i } else { i - n } * m..][..m];
            let mut along = [[0.0; 3]; ORDERS];
            for b in 0..wide_v {
                let j = row.first[1] + b;
                let point = &line[if j < m { j } else { j - m }];
                for (l, sum) in along.iter_mut().enumerate().take(ORDER + 1) {
                    let weight = row.values[1][l * wide_v + b];
                    (0..3).for_each(|d| sum[d] += weight * point[d]);
                }
            }
            for (k, line) in out.iter_mut().enumerate().take(ORDER + 1) {
                let weight = row.values[0][k * wide_u + a];
                for (sum, along) in line.iter_mut().zip(&along).take(ORDER + 1 - k) {
                    (0..3).for_each(|d| sum[d] += weight * along[d]);
                }
            }
        }
        out
    }

    /// `Q_u x Q_v` at a row.
    pub(super) fn area(&self, row: &Row, c: &[Vector]) -> Vector {
        let jet = self.jet::<1>(row, c);
        cross(jet[1][0], jet[0][1])
    }
}

impl Row {
    /// Products `N_a^(k) M_b^(l)` in the order of a, then b.
    #[inline]
    pub(super) fn products(&self, (k, l): (usize, usize), out: &mut [f64]) {
        let inner = &self.values[1][l * self.width[1]..(l + 1) * self.width[1]];
        for (line, outer) in out.chunks_exact_mut(self.width[1]).zip(&self.values[0][k * self.width[0]..]) {
            line.iter_mut().zip(inner).for_each(|(o, i)| *o = outer * i);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_is_joined_of_two() {
        let knots = [Knots::closed(3, 8, 0.0, 8.0).unwrap(), Knots::uniform(2, 3, 0.0, 1.0).unwrap()];
        let cells = Cells::new(knots);
        let (whole, joined) = (cells.row(6.3, 0.7, 2), cells.joined(&cells.row(6.3, 0.1, 2), &cells.row(0.2, 0.7, 2)));
        assert_eq!((whole.cell, whole.first, whole.width), (joined.cell, joined.first, joined.width));
        assert_eq!(whole.values, joined.values);
    }
}
