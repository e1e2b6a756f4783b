//! A cell's part of the equations over its own B-splines, from sums over its contacts or from integrals over the cell.
//!
//! ```text
//! A_(ab)(cd) = sum_t f_t sum_ik X_t,ac,i G_t,ik Y_t,bd,k          X_t,ac = N_a^(m) N_c^(n), and the same of Y
//! heights   (0 0)(0 0)        slopes   xx (1 1)(0 0)   xy (1 0)(0 1) + (0 1)(1 0)   yy (0 0)(1 1)
//! roughness of order m        sum_j binomial(m, j) integral (d^m S / dx^j dy^(m-j))^2
//! ```

use super::polynomials::{AxisPolynomials, Products, SegmentTable};
use super::sums::CellSum;
use palpate_fitting::observation::RoughnessOrder;

/// Weights of both kinds of rows, squared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockWeights {
    /// Of the height rows.
    pub heights: f64,
    /// Of the slope or normal rows.
    pub slopes: f64,
}

/// A symmetric matrix over the B-splines of a cell, y runs fastest, and a right-hand side.
#[derive(Clone, Debug)]
pub(crate) struct LocalEquations {
    pub matrix: Vec<f64>,
    pub load: Vec<f64>,
    widths: [usize; 2],
}

impl LocalEquations {
    pub(crate) fn zeros(widths: [usize; 2]) -> LocalEquations {
        let count = widths[0] * widths[1];
        LocalEquations { matrix: vec![0.0; count * count], load: vec![0.0; count], widths }
    }

    pub(crate) fn clear(&mut self) {
        self.matrix.fill(0.0);
        self.load.fill(0.0);
    }

    /// Adds the rows of a cell's contacts.
    pub(crate) fn add_contacts(&mut self, [x, y]: [&SegmentTable; 2], sums: &CellSum, weights: BlockWeights) {
        if let Some(g) = sums.moments(0) {
            self.add_products([&x.squares[0], &y.squares[0]], g, weights.heights);
        }
        let axes = [&x.functions, &y.functions];
        self.add_load(axes, [0, 0], sums.loads(0), weights.heights);
        if weights.slopes > 0.0 {
            self.add_slopes([x, y], sums, weights.slopes);
            self.add_load(axes, [1, 0], sums.loads(1), weights.slopes);
            self.add_load(axes, [0, 1], sums.loads(2), weights.slopes);
        }
        self.mirror();
    }

    fn add_slopes(&mut self, [x, y]: [&SegmentTable; 2], sums: &CellSum, weight: f64) {
        if let Some(g) = sums.moments(1) {
            self.add_products([&x.squares[1], &y.squares[0]], g, weight);
        }
        if let Some(g) = sums.moments(2) {
            self.add_products([&x.mixed[0], &y.mixed[1]], g, weight);
            self.add_products([&x.mixed[1], &y.mixed[0]], g, weight);
        }
        if let Some(g) = sums.moments(3) {
            self.add_products([&x.squares[0], &y.squares[1]], g, weight);
        }
    }

    /// Adds the roughness of this order over a cell with these half sides.
    pub(crate) fn add_roughness(&mut self, [x, y]: [&SegmentTable; 2], half: [f64; 2], order: RoughnessOrder) {
        let powers = self.widths.map(|width| 2 * width - 1);
        // the integral of u^i over [-1, 1]
        let integral = |i: usize| if i.is_multiple_of(2) { 2.0 / (i + 1) as f64 } else { 0.0 };
        let area = half[0] * half[1];
        let g: Vec<f64> =
            (0..powers[0] * powers[1]).map(|k| area * integral(k / powers[1]) * integral(k % powers[1])).collect();
        for (binomial, by_x, by_y) in order.terms() {
            self.add_products([&x.squares[*by_x], &y.squares[*by_y]], &g, *binomial);
        }
        self.mirror();
    }

    /// Adds to the blocks on and above the diagonal; [`LocalEquations::mirror`] makes the others.
    fn add_products(&mut self, products: [&Products; 2], g: &[f64], factor: f64) {
        // the number of powers is a literal, so that the inner loops have no counters
        match self.widths[1] {
            3 => self.add_products_of::<5>(products, g, factor),
            4 => self.add_products_of::<7>(products, g, factor),
            5 => self.add_products_of::<9>(products, g, factor),
            _ => self.add_products_of::<11>(products, g, factor),
        }
    }

    fn add_products_of<const COUNT: usize>(&mut self, [x, y]: [&Products; 2], g: &[f64], factor: f64) {
        let [wide, high] = self.widths;
        let count = wide * high;
        let (rows, _) = g.as_chunks::<COUNT>();
        for a in 0..wide {
            for c in a..wide {
                let mut along = [0.0; COUNT];
                for (share, row) in x[a][c].iter().zip(rows) {
                    along.iter_mut().zip(row).for_each(|(sum, v)| *sum += factor * share * v);
                }
                for b in 0..high {
                    let row = (a * high + b) * count + c * high;
                    for (d, target) in self.matrix[row..row + high].iter_mut().enumerate() {
                        let mut sum = 0.0;
                        for k in 0..COUNT {
                            sum += y[b][d][k] * along[k];
                        }
                        *target += sum;
                    }
                }
            }
        }
    }

    /// The blocks below the diagonal from those above it.
    fn mirror(&mut self) {
        let count = self.load.len();
        for row in 0..count {
            for column in 0..row {
                // blocks on the diagonal were written whole, and are symmetric
                self.matrix[row * count + column] = self.matrix[column * count + row];
            }
        }
    }

    fn add_load(&mut self, [x, y]: [&AxisPolynomials; 2], orders: [usize; 2], f: &[f64], factor: f64) {
        let [wide, high] = self.widths;
        for a in 0..wide {
            for b in 0..high {
                let (along, across) = (x.of(orders[0], a), y.of(orders[1], b));
                let rows = f.chunks_exact(high).zip(along);
                let sum: f64 =
                    rows.map(|(row, share)| share * row.iter().zip(across).map(|(v, s)| v * s).sum::<f64>()).sum();
                self.load[a * high + b] += factor * sum;
            }
        }
    }
}
