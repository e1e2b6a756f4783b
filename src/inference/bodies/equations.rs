//! The equations of one hypothesis, and the logarithm of its probability as far as they tell it.
//!
//! ```text
//! A = G_d + v G_n + diag(precision of w, s0^2 / width^2) + (s0 / delta)^2 G_s      G_s: of rows of steepness
//! ln p = N_n/2 ln v - nu/2 ln(pi RSS) + ln Gamma(nu/2) - ln|A| / 2 + ln|P| / 2 - (steepness left - P's own) / 2 s0^2
//! P = diag(precision of w) + (s0 / delta)^2 G_s          what is known of w before any contact is measured
//! ```
//!
//! Where no steepness is asked ln|P| / 2 is -M ln rho, and what follows it is nothing. s0 is the scatter of the step before: the scale of
//! steepness and of a broad departure is that of the body, and not the sensor's, which w is counted in.

use std::f64::consts::PI;

use faer::Mat;
use statrs::function::gamma::ln_gamma;

use super::evidence::LinearisedBase;
use super::rows::RowGrams;
use crate::dense;

/// Equations of one hypothesis.
pub(super) struct FactoredEquations {
    pub(super) log: f64,
    /// Lower factor of A.
    pub(super) lower: Mat<f64>,
    /// The right hand side solved by it.
    pub(super) reduced: Vec<f64>,
    /// Sum of squares that is left.
    pub(super) sum: f64,
}

/// Equations of hypotheses that differ by the ratio v alone.
pub(super) struct EquationsBySize<'a> {
    base: &'a LinearisedBase<'a>,
    grams: &'a RowGrams,
    size: Option<f64>,
    /// One over the variances of the weights, in units of one over the scatter's.
    precision: Vec<f64>,
    steepness: Option<Steepness<'a>>,
}

/// Rows of steepness with their weight, and what is known of the weights by them beforehand.
struct Steepness<'a> {
    rows: &'a Mat<f64>,
    weight: f64,
    prior: PriorOfDistance,
}

impl<'a> LinearisedBase<'a> {
    /// ln p and the equations that it is taken from, for a departure of some size and a ratio v.
    pub(super) fn factored(&self, grams: &RowGrams, size: Option<f64>, v: f64) -> Option<FactoredEquations> {
        self.by_size(grams, size)?.factored(v)
    }

    /// The equations of a departure of some size, for any ratio.
    pub(super) fn by_size<'b>(&'b self, grams: &'b RowGrams, size: Option<f64>) -> Option<EquationsBySize<'b>>
    where
        'a: 'b,
    {
        let precision = self.precision_of(grams, size.unwrap_or(1.0));
        let steepness = match &grams.steepness {
            Some(rows) => {
                let weight = (self.sd[0] / self.steep).powi(2);
                Some(Steepness { rows, weight, prior: PriorOfDistance::new(rows, weight, &precision)? })
            }
            None => None,
        };
        Some(EquationsBySize { base: self, grams, size, precision, steepness })
    }

    /// One over the variances of the weights, in units of one over the scatter's.
    fn precision_of(&self, grams: &RowGrams, ratio: f64) -> Vec<f64> {
        let own = grams.process.as_ref().map_or(grams.places, |process| process.own_len());
        let broad = (self.sd[0] / self.broad).powi(2);
        (0..grams.places).map(|i| if i < own { 1.0 / (ratio * ratio) } else { broad }).collect()
    }
}

impl EquationsBySize<'_> {
    /// ln p and the equations that it is taken from.
    pub(super) fn factored(&self, v: f64) -> Option<FactoredEquations> {
        let (base, [distances, normals]) = (self.base, &self.grams.of);
        let all = self.grams.places + base.moving.len();
        let full = |i: usize, j: usize| distances[(i, j)] + v * normals[(i, j)];
        let lower = dense::cholesky(&self.matrix(v))?;
        let mut right: Vec<f64> = (0..all).map(|i| -full(i, all)).collect();
        if let Some(Steepness { rows, weight, .. }) = &self.steepness {
            right.iter_mut().zip(rows.col_as_slice(all)).for_each(|(right, row)| *right -= weight * row);
        }
        dense::forward_in_columns(&lower, &mut right);
        let left = full(all, all) - right.iter().map(|b| b * b).sum::<f64>();
        let (sum, of_prior) = match &self.steepness {
            Some(steepness) => {
                let (own, of_prior) = steepness.left((&lower, &right), base.sd[0]);
                (left + steepness.weight * steepness.rows[(all, all)] - own, of_prior)
            }
            None => (left, -(self.grams.places as f64) * self.size.unwrap_or(1.0).ln()),
        };
        let freedom = base.freedom();
        let floor = base.sample.floor[0].max(base.sample.floor[1] * v.sqrt());
        let sum = sum.max(freedom * floor * floor);
        let log = 0.5 * base.rows[1] * v.ln() - 0.5 * freedom * PI.ln() + ln_gamma(0.5 * freedom)
            - 0.5 * freedom * sum.ln()
            - 0.5 * dense::log_det(&lower)
            + of_prior;
        Some(FactoredEquations { log, lower, reduced: right, sum })
    }

    /// A, its lower triangle.
    fn matrix(&self, v: f64) -> Mat<f64> {
        let (base, [distances, normals], places) = (self.base, &self.grams.of, self.grams.places);
        let all = places + base.moving.len();
        let mut matrix = Mat::zeros(all, all);
        for j in 0..all {
            let of_rows = distances.col_as_slice(j).iter().zip(normals.col_as_slice(j)).skip(j);
            let column = &mut matrix.col_as_slice_mut(j)[j..];
            column.iter_mut().zip(of_rows).for_each(|(entry, (d, n))| *entry = d + v * n);
            column[0] += match j.checked_sub(places) {
                None => self.precision[j],
                Some(unknown) => (base.sd[0] / base.widths[base.moving[unknown]]).powi(2),
            };
            if let Some(Steepness { rows, weight, .. }) = &self.steepness {
                column.iter_mut().zip(&rows.col_as_slice(j)[j..]).for_each(|(entry, row)| *entry += weight * row);
            }
        }
        matrix
    }
}

impl Steepness<'_> {
    /// What steepness has of the sum of squares at the minimum, which is no scatter, and ln p by what is known of the weights beforehand.
    fn left(&self, (lower, reduced): (&Mat<f64>, &[f64]), scatter: f64) -> (f64, f64) {
        let mut solution = reduced.to_vec();
        dense::backward(lower, &mut solution);
        let own = self.weight * square_of(self.rows, &solution);
        let lost = (own - self.prior.sum).max(0.0) / scatter.powi(2);
        (own, 0.5 * self.prior.log_det - 0.5 * lost)
    }
}

/// Sum of squares of rows whose Gram matrix with their right-hand side is given.
fn square_of(gram: &Mat<f64>, solution: &[f64]) -> f64 {
    let last = solution.len();
    let of_column = |j: usize| {
        let column = gram.col_as_slice(j);
        column[..last].iter().zip(solution).map(|(g, w)| g * w).sum::<f64>()
    };
    let quadratic: f64 = solution.iter().enumerate().map(|(j, w)| w * of_column(j)).sum();
    quadratic + 2.0 * of_column(last) + gram[(last, last)]
}

/// What is known of a departure's weights before any contact is measured: their size, and that the surface is where a distance is 0.
struct PriorOfDistance {
    log_det: f64,
    /// Sum of squares of weights and steepness where it is most probable.
    sum: f64,
}

impl PriorOfDistance {
    fn new(steepness: &Mat<f64>, weight: f64, precision: &[f64]) -> Option<PriorOfDistance> {
        let (last, places) = (steepness.ncols() - 1, precision.len());
        let own = |i: usize, j: usize| weight * steepness[(i, j)] + if i == j { precision[i] } else { 0.0 };
        let lower = dense::cholesky(&Mat::from_fn(places, places, own))?;
        let mut right: Vec<f64> = (0..places).map(|i| weight * steepness[(i, last)]).collect();
        dense::forward_in_columns(&lower, &mut right);
        let sum = weight * steepness[(last, last)] - right.iter().map(|b| b * b).sum::<f64>();
        Some(PriorOfDistance { log_det: dense::log_det(&lower), sum: sum.max(0.0) })
    }
}
