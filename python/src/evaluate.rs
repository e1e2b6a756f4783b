//! Splines at many places, any pair of derivatives, on several threads where there are many.
//!
//! ```text
//! on a grid      D(x_i, y_j) = sum_b M_b^(dy)(y_j) (sum_a N_a^(dx)(x_i) c_ab)       the inner sums once a row
//! at places      D(x_r, y_r), r = 0 .. g
//! ```
//!
//! Outside the domain the end polynomials go on; a place that is not finite gives NaN. A height has one component, a
//! point in space three.

use palpate::spline::Knots;
use rayon::prelude::*;

/// Degrees are 9 at most.
const WIDTH: usize = 10;
/// Places for one thread at a time: a few tens of microseconds of work.
const PIECE: usize = 2048;

/// Knots and coefficients `c[(i m + j) components + k]`.
#[derive(Clone)]
pub(crate) struct Tensor {
    pub(crate) knots: [Knots; 2],
    pub(crate) coefficients: Vec<f64>,
    pub(crate) components: usize,
}

/// One row of basis functions or of a derivative of them.
struct Row {
    first: usize,
    values: [f64; WIDTH],
}

impl Row {
    fn of(knots: &Knots, at: f64, order: usize) -> Row {
        let width = knots.degree() + 1;
        if !at.is_finite() {
            return Row { first: 0, values: [f64::NAN; WIDTH] };
        }
        let mut values = [0.0; WIDTH];
        if order > knots.degree() {
            return Row { first: 0, values };
        }
        let at = knots.wrapped(at);
        if order == 0 {
            let first = knots.derivatives(at, 0, &mut values[..width]);
            return Row { first, values };
        }
        let mut flat = [0.0; WIDTH * WIDTH];
        let first = knots.derivatives(at, order, &mut flat[..(order + 1) * width]);
        values[..width].copy_from_slice(&flat[order * width..(order + 1) * width]);
        Row { first, values }
    }
}

impl Tensor {
    /// Values at the places that `place` names, one after the other.
    pub(crate) fn at_places(
        &self,
        count: usize,
        order: [usize; 2],
        place: impl Fn(usize) -> [f64; 2] + Sync,
    ) -> Vec<f64> {
        let c = self.components;
        let mut out = vec![0.0; count * c];
        let one = |(r, out): (usize, &mut [f64])| {
            let [x, y] = place(r);
            let [bx, by] = [Row::of(&self.knots[0], x, order[0]), Row::of(&self.knots[1], y, order[1])];
            self.point(&bx, &by, out);
        };
        if count <= PIECE {
            out.chunks_exact_mut(c).enumerate().for_each(one);
        } else {
            out.par_chunks_exact_mut(c).with_min_len(PIECE).enumerate().for_each(one);
        }
        out
    }

    fn point(&self, bx: &Row, by: &Row, out: &mut [f64]) {
        let [p, q] = self.knots.each_ref().map(Knots::degree);
        let (m, c) = (self.knots[1].n_basis(), self.components);
        if let [out] = out {
            for a in 0..=p {
                let start = (bx.first + a) * m + by.first;
                let row = &self.coefficients[start..=start + q];
                *out += bx.values[a] * row.iter().zip(&by.values).map(|(c, w)| c * w).sum::<f64>();
            }
            return;
        }
        for a in 0..=p {
            let row = &self.coefficients[((bx.first + a) * m + by.first) * c..];
            for b in 0..=q {
                let weight = bx.values[a] * by.values[b];
                for (k, sum) in out.iter_mut().enumerate() {
                    *sum += weight * row[b * c + k];
                }
            }
        }
    }

    /// Values on the product of two axes, `out[(i len(y) + j) components + k]`.
    pub(crate) fn on_grid(&self, x: &[f64], y: &[f64], order: [usize; 2]) -> Vec<f64> {
        let c = self.components;
        let [p, q] = self.knots.each_ref().map(Knots::degree);
        let m = self.knots[1].n_basis();
        let rows: Vec<Row> = y.iter().map(|at| Row::of(&self.knots[1], *at, order[1])).collect();
        let mut out = vec![0.0; x.len() * y.len() * c];
        if out.is_empty() {
            return out;
        }
        let one = |(i, out): (usize, &mut [f64])| {
            let bx = Row::of(&self.knots[0], x[i], order[0]);
            let mut along = vec![0.0; m * c];
            for a in 0..=p {
                let row = &self.coefficients[(bx.first + a) * m * c..(bx.first + a + 1) * m * c];
                along.iter_mut().zip(row).for_each(|(sum, value)| *sum += bx.values[a] * value);
            }
            for (out, by) in out.chunks_exact_mut(c).zip(&rows) {
                for b in 0..=q {
                    let here = &along[(by.first + b) * c..(by.first + b + 1) * c];
                    out.iter_mut().zip(here).for_each(|(sum, value)| *sum += by.values[b] * value);
                }
            }
        };
        let least = PIECE.div_ceil(y.len());
        out.par_chunks_exact_mut(y.len() * c).with_min_len(least).enumerate().for_each(one);
        out
    }
}
