//! The B-splines of a cell as polynomials across it, and the products that the equations are sums of.
//!
//! ```text
//! N_a^(k)(x) = sum_i V^k_ai u^i,   u = (x - centre)/half in [-1, 1]        N_a^(k) N_b^(m) = sum_i P_ab,i u^i,  i <= 2p
//! ```

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::mesh::CellId;
use palpate_numeric::bspline::Knots;

/// Largest degree of a hierarchy.
pub(super) const DEGREE: usize = 5;
/// Functions on a cell in one direction.
pub(super) const WIDTH: usize = DEGREE + 1;
/// Powers of a product of two.
pub(super) const POWERS: usize = 2 * DEGREE + 1;
/// Derivatives from 0 to 3: the roughness asks for the third.
const ORDERS: usize = 4;

/// Functions of one direction on one segment, and their derivatives, by powers of u.
#[derive(Clone, Debug)]
pub(crate) struct AxisPolynomials {
    pub degree: usize,
    values: [[[f64; WIDTH]; WIDTH]; ORDERS],
}

/// All products of two derivatives.
pub(super) type Products = [[[f64; POWERS]; WIDTH]; WIDTH];

impl AxisPolynomials {
    /// Those of a segment, from Taylor's series about its centre, which a polynomial equals.
    pub(crate) fn new(knots: &Knots, segment: usize) -> AxisPolynomials {
        let p = knots.degree();
        let [lo, hi] = knots.segment(segment);
        let half = 0.5 * (hi - lo);
        let mut taylor = [0.0; WIDTH * WIDTH];
        knots.derivatives_on(segment, lo + half, p, &mut taylor[..(p + 1) * (p + 1)]);
        let mut values = [[[0.0; WIDTH]; WIDTH]; ORDERS];
        let mut scale = 1.0;
        for i in 0..=p {
            (0..=p).for_each(|a| values[0][a][i] = taylor[i * (p + 1) + a] * scale);
            scale *= half / (i + 1) as f64;
        }
        for order in 1..ORDERS {
            for a in 0..=p {
                for i in 0..p {
                    values[order][a][i] = values[order - 1][a][i + 1] * (i + 1) as f64 / half;
                }
            }
        }
        AxisPolynomials { degree: p, values }
    }

    /// Derivative of this order of function a, by powers of u.
    pub(super) fn of(&self, order: usize, a: usize) -> &[f64; WIDTH] {
        &self.values[order][a]
    }

    /// Products of derivatives of these orders.
    fn products(&self, orders: [usize; 2]) -> Products {
        let mut products = [[[0.0; POWERS]; WIDTH]; WIDTH];
        for a in 0..=self.degree {
            for b in 0..=self.degree {
                for i in 0..=self.degree {
                    let left = self.values[orders[0]][a][i];
                    for k in 0..=self.degree {
                        products[a][b][i + k] += left * self.values[orders[1]][b][k];
                    }
                }
            }
        }
        products
    }
}

/// Functions of one segment with the products that equations and roughness ask for.
#[derive(Clone, Debug)]
pub(crate) struct SegmentTable {
    pub functions: AxisPolynomials,
    /// Of equal derivatives, orders 0 to 3.
    pub(super) squares: [Products; ORDERS],
    /// Of first derivatives with values, and of values with first derivatives.
    pub(super) mixed: [Products; 2],
}

impl SegmentTable {
    fn new(knots: &Knots, segment: usize) -> SegmentTable {
        let functions = AxisPolynomials::new(knots, segment);
        let squares = std::array::from_fn(|order| functions.products([order, order]));
        let mixed = [functions.products([1, 0]), functions.products([0, 1])];
        SegmentTable { functions, squares, mixed }
    }
}

/// Tables of the segments met before: cells that lie near each other share them.
#[derive(Debug, Default)]
pub(crate) struct SegmentTables {
    known: BTreeMap<[u32; 3], Arc<SegmentTable>>,
}

/// Tables kept at once, each about 20 kB: more would leave the caches.
const MOST_TABLES: usize = 256;

impl SegmentTables {
    /// Both tables of a cell.
    pub(crate) fn of(&mut self, cell: CellId, knots: [&Knots; 2]) -> [Arc<SegmentTable>; 2] {
        if self.known.len() > MOST_TABLES {
            self.known.clear();
        }
        [0, 1].map(|axis| {
            let key = [axis as u32, cell.level.into(), cell.place[axis]];
            let make = || Arc::new(SegmentTable::new(knots[axis], cell.place[axis] as usize));
            self.known.entry(key).or_insert_with(make).clone()
        })
    }
}

/// A surface on a cell by powers of u and v, with the factors that make derivatives in x and y of those in u and v.
#[derive(Clone, Debug)]
pub(crate) struct CellPolynomial {
    degree: [usize; 2],
    powers: [[f64; WIDTH]; WIDTH],
    pub centre: [f64; 2],
    pub inverse_half: [f64; 2],
}

impl CellPolynomial {
    /// From the coefficients of the cell's B-splines.
    pub(crate) fn new(axes: &[AxisPolynomials; 2], ends: [[f64; 2]; 2], table: &[f64]) -> CellPolynomial {
        let [x, y] = axes;
        let mut powers = [[0.0; WIDTH]; WIDTH];
        for (a, row) in table.chunks_exact(y.degree + 1).enumerate() {
            let mut along = [0.0; WIDTH];
            for (b, c) in row.iter().enumerate() {
                along.iter_mut().zip(y.of(0, b)).for_each(|(sum, v)| *sum += c * v);
            }
            for (target, share) in powers.iter_mut().zip(x.of(0, a)) {
                target.iter_mut().zip(&along).for_each(|(sum, v)| *sum += share * v);
            }
        }
        let [centre, half] = ends;
        CellPolynomial { degree: [x.degree, y.degree], powers, centre, inverse_half: half.map(|h| 1.0 / h) }
    }

    /// Place across the cell.
    #[inline]
    pub(crate) fn local(&self, x: f64, y: f64) -> [f64; 2] {
        [(x - self.centre[0]) * self.inverse_half[0], (y - self.centre[1]) * self.inverse_half[1]]
    }

    /// Height at `(u, v)`.
    #[inline]
    pub(crate) fn height(&self, [u, v]: [f64; 2]) -> f64 {
        let mut sum = 0.0;
        for row in self.powers[..=self.degree[0]].iter().rev() {
            let along = row[..=self.degree[1]].iter().rev().fold(0.0, |sum, c| sum * v + c);
            sum = sum * u + along;
        }
        sum
    }

    /// Height and slopes in x and y at `(u, v)`.
    #[inline]
    pub(crate) fn height_and_slopes(&self, [u, v]: [f64; 2]) -> [f64; 3] {
        let (mut sum, mut by_u, mut by_v) = (0.0, 0.0, 0.0);
        for row in self.powers[..=self.degree[0]].iter().rev() {
            let (mut along, mut slope) = (0.0, 0.0);
            for c in row[..=self.degree[1]].iter().rev() {
                slope = slope * v + along;
                along = along * v + c;
            }
            by_u = by_u * u + sum;
            sum = sum * u + along;
            by_v = by_v * u + slope;
        }
        [sum, by_u * self.inverse_half[0], by_v * self.inverse_half[1]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_give_the_spline() {
        let knots = [Knots::uniform(5, 4, -1.0, 3.0).unwrap(), Knots::uniform(2, 3, 0.0, 1.0).unwrap()];
        for segments in [[0, 0], [2, 1], [3, 2]] {
            let axes = [0, 1].map(|k| AxisPolynomials::new(&knots[k], segments[k]));
            let ends = [0, 1].map(|k| knots[k].segment(segments[k]));
            let (centre, half) = (ends.map(|[a, b]| 0.5 * (a + b)), ends.map(|[a, b]| 0.5 * (b - a)));
            let table: Vec<f64> = (0..18).map(|k| (1.3 * k as f64).cos()).collect();
            let cell = CellPolynomial::new(&axes, [centre, half], &table);
            let at = [ends[0][0] + 0.3, ends[1][0] + 0.1];
            let rows = [0, 1].map(|k| knots[k].basis(at[k]));
            let sum = |dx: usize, dy: usize| -> f64 {
                let [x, y] = [rows[0].derivative(dx), rows[1].derivative(dy)];
                (0..18).map(|k| table[k] * x[k / 3] * y[k % 3]).sum()
            };
            let found = cell.height_and_slopes(cell.local(at[0], at[1]));
            assert!((cell.height(cell.local(at[0], at[1])) - found[0]).abs() < 1e-15);
            for (k, exact) in [sum(0, 0), sum(1, 0), sum(0, 1)].into_iter().enumerate() {
                assert!((found[k] - exact).abs() < 1e-13, "{k}");
            }
        }
    }
}
