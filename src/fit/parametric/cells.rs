//! Where a contact stands under the spline: its cell, the coefficients alive there, and the basis with derivatives.
//!
//! ```text
//! Q_kl = sum_ab c_(first_u + a, first_v + b) N_a^(k) M_b^(l)
//! ```

use crate::bspline::{Knots, MAX_DEGREE};
use crate::linalg::MapShape;

/// Basis functions alive in one direction, at most.
const WIDTH: usize = MAX_DEGREE + 1;
/// Orders of derivatives that are kept: 0 to 3.
const ORDERS: usize = 4;

/// Knots of a map and the numbering of its distinct coefficients.
#[derive(Clone, Debug)]
pub struct Cells {
    knots: [Knots; 2],
    shape: MapShape,
}

/// The basis at one (u, v).
#[derive(Clone, Debug)]
pub struct Row {
    /// Number of the cell.
    pub cell: usize,
    first: [usize; 2],
    values: [[f64; ORDERS * WIDTH]; 2],
    width: [usize; 2],
}

impl Cells {
    /// The cells of these knots.
    pub fn new(knots: [Knots; 2]) -> Cells {
        let shape = MapShape {
            free: [knots[0].free(), knots[1].free()],
            degree: [knots[0].degree(), knots[1].degree()],
            closed: [knots[0].is_closed(), knots[1].is_closed()],
        };
        Cells { knots, shape }
    }

    /// Knots in u and v.
    pub fn knots(&self) -> &[Knots; 2] {
        &self.knots
    }

    /// Numbering of the distinct coefficients.
    pub fn shape(&self) -> MapShape {
        self.shape
    }

    /// Coefficients alive in one cell.
    pub fn local(&self) -> usize {
        (self.shape.degree[0] + 1) * (self.shape.degree[1] + 1)
    }

    /// The basis at (u, v); closed directions wrap.
    pub fn row(&self, u: f64, v: f64) -> Row {
        let mut row = Row { cell: 0, first: [0; 2], values: [[0.0; ORDERS * WIDTH]; 2], width: [0; 2] };
        for (k, t) in [u, v].into_iter().enumerate() {
            let knots = &self.knots[k];
            let t = knots.wrapped(t);
            let width = knots.degree() + 1;
            let segment = knots.segment_of(t);
            knots.derivatives_on(segment, t, ORDERS - 1, &mut row.values[k][..ORDERS * width]);
            row.first[k] = knots.first_basis(segment);
            row.width[k] = width;
            row.cell = row.cell * knots.n_segments() + segment;
        }
        row
    }

    /// Numbers of the coefficients alive in the cell of `row`, in the order of [`Row::products`].
    pub fn alive(&self, row: &Row, out: &mut Vec<usize>) {
        let [n, m] = self.shape.free;
        out.clear();
        for a in 0..row.width[0] {
            let i = (row.first[0] + a) % n;
            out.extend((0..row.width[1]).map(|b| i * m + (row.first[1] + b) % m));
        }
    }

    /// Derivative `(k, l)` of the map with these coefficients.
    pub fn derivative(&self, row: &Row, c: &[[f64; 3]], (k, l): (usize, usize)) -> [f64; 3] {
        let [n, m] = self.shape.free;
        let mut sum = [0.0; 3];
        for a in 0..row.width[0] {
            let i = (row.first[0] + a) % n;
            let mut along = [0.0; 3];
            for b in 0..row.width[1] {
                let weight = row.values[1][l * row.width[1] + b];
                let c = &c[i * m + (row.first[1] + b) % m];
                (0..3).for_each(|d| along[d] += weight * c[d]);
            }
            let weight = row.values[0][k * row.width[0] + a];
            (0..3).for_each(|d| sum[d] += weight * along[d]);
        }
        sum
    }
}

impl Row {
    /// Products `N_a^(k) M_b^(l)`, a-major.
    pub fn products(&self, (k, l): (usize, usize), out: &mut Vec<f64>) {
        out.clear();
        for a in 0..self.width[0] {
            let outer = self.values[0][k * self.width[0] + a];
            out.extend((0..self.width[1]).map(|b| outer * self.values[1][l * self.width[1] + b]));
        }
    }
}
