//! The covariance of errors: independent ones, and ones that neighbours share.
//!
//! ```text
//! Sigma = s^2 (D + rho exp(-r_ij/l))       r between feet;  rho in {0} u 10^{-1..4},  l in {0.12, 0.3, 0.75, 2}
//! prior: half on rho = 0, the rest shared equally;   times exp(-(tau/limit)^2/2),  tau = s sqrt(rho)
//! limit = max(r relief, m e),  e = mad(d_i - d_nearest) / sqrt 2,  [r, m] = `Tuning::shared_up_to`
//! ```
//!
//! The exponential kernel is a rough one on purpose: a smooth kernel of long range looks like curvature and would take
//! the shape for an error. An error as large as the relief would explain anything, so tau is limited.
//! C. E. Rasmussen, C. K. I. Williams, *Gaussian Processes for Machine Learning*, MIT Press 2006, section 4.2.

use std::borrow::Borrow;
use std::sync::OnceLock;

use faer::Mat;

use crate::bodies::Tuning;
use crate::dense;
use crate::recognition::contacts::{Cells, Floors};
use palpate_numeric::statistics::{ExponentialCorrelation, mad};
use palpate_numeric::vector::{minus, norm};

const LENGTHS: [f64; 4] = [0.12, 0.3, 0.75, 2.0];
const RATIOS: [f64; 6] = [0.1, 1.0, 10.0, 100.0, 1e3, 1e4];

/// One node of the grid over rho and l.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Kernel {
    pub(crate) ratio: f64,
    /// Correlation length; without meaning when the ratio is 0.
    pub(crate) length: f64,
    /// Log of its prior probability.
    pub(crate) log_prior: f64,
}

impl Kernel {
    /// Lengths that are tried, each with errors of every size.
    pub(crate) const CHAINS: usize = LENGTHS.len();

    /// Numbers of the kernels of one length, the smallest shared error first.
    pub(crate) fn chain(length: usize) -> std::ops::Range<usize> {
        1 + length * RATIOS.len()..1 + (length + 1) * RATIOS.len()
    }

    /// The whole grid, the node without correlation first.
    pub(crate) fn all() -> Vec<Kernel> {
        let share = (2.0 * (RATIOS.len() * LENGTHS.len()) as f64).ln();
        let white = Kernel { ratio: 0.0, length: 1.0, log_prior: -std::f64::consts::LN_2 };
        let others = LENGTHS.iter().flat_map(|&length| RATIOS.map(|ratio| Kernel { ratio, length, log_prior: -share }));
        std::iter::once(white).chain(others).collect()
    }

    /// Lower factor of `diag(variance) + rho exp(-r/l)`.
    pub(crate) fn factor(&self, variance: &[f64], distances: &Mat<f64>) -> Option<Mat<f64>> {
        self.factor_of(variance, || correlation(self.length, distances))
    }

    /// The same from the lower triangle of `exp(-r/l)`, which errors of every size have in common.
    fn factor_of<M: Borrow<Mat<f64>>>(&self, variance: &[f64], correlation: impl FnOnce() -> M) -> Option<Mat<f64>> {
        let n = variance.len();
        if self.ratio == 0.0 {
            return Some(Mat::from_fn(n, n, |i, j| if i == j { variance[i].sqrt() } else { 0.0 }));
        }
        let mut covariance = Mat::zeros(n, n);
        let correlation = correlation();
        for (j, own) in variance.iter().enumerate() {
            let column = &mut covariance.col_as_slice_mut(j)[j..];
            let along = &correlation.borrow().col_as_slice(j)[j..];
            column.iter_mut().zip(along).for_each(|(entry, along)| *entry = self.ratio * along);
            column[0] += own;
        }
        dense::cholesky(&covariance)
    }
}

/// Lower triangle of `exp(-r/l)`.
fn correlation(length: f64, distances: &Mat<f64>) -> Mat<f64> {
    let along = ExponentialCorrelation::Length(length);
    let of = |i: usize, j: usize| if i < j { 0.0 } else { along.at(distances[(i, j)]) };
    Mat::from_fn(distances.nrows(), distances.nrows(), of)
}

/// Factors of the covariance under every kernel, each computed when it is first asked for.
pub(crate) struct Factors<'a> {
    variance: &'a [f64],
    distances: &'a Mat<f64>,
    /// Floors of the errors of a cell.
    pub(super) floors: Floors,
    kernels: Vec<Kernel>,
    /// Of every length.
    correlations: [OnceLock<Mat<f64>>; LENGTHS.len()],
    found: Vec<OnceLock<Option<Mat<f64>>>>,
}

impl<'a> Factors<'a> {
    pub(crate) fn new(variance: &'a [f64], distances: &'a Mat<f64>, floors: Floors) -> Factors<'a> {
        let kernels = Kernel::all();
        let found = kernels.iter().map(|_| OnceLock::new()).collect();
        Factors { variance, distances, floors, kernels, correlations: Default::default(), found }
    }

    /// Relative variances on the diagonal.
    pub(crate) fn variance(&self) -> &[f64] {
        self.variance
    }

    /// Between the cells.
    pub(crate) fn distances(&self) -> &Mat<f64> {
        self.distances
    }

    /// Lower factor under a kernel.
    pub(crate) fn of(&self, kernel: usize) -> Option<&Mat<f64>> {
        let chain = kernel.saturating_sub(1) / RATIOS.len();
        let along = || self.correlations[chain].get_or_init(|| correlation(LENGTHS[chain], self.distances));
        self.found[kernel].get_or_init(|| self.kernels[kernel].factor_of(self.variance, along)).as_ref()
    }
}

/// Distances in space between the cells' feet.
pub(crate) fn distances_between(cells: &Cells) -> Mat<f64> {
    let p = &cells.feet;
    Mat::from_fn(p.len(), p.len(), |i, j| norm(minus(p[i], p[j])))
}

/// How large a shared error may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Limit {
    pub(crate) limit: f64,
    /// Multiple of it beyond which an error is not considered.
    most: f64,
}

impl Limit {
    /// From the relief and the differences of residuals between contacts with the nearest feet.
    pub(crate) fn new(pairs: &[[usize; 2]], residuals: &[f64], relief: f64, tuning: &Tuning) -> Limit {
        let differences = pairs.iter().map(|&[i, j]| residuals[i] - residuals[j]);
        let nearest = mad(differences) / std::f64::consts::SQRT_2;
        let [of_relief, of_differences] = tuning.shared_up_to;
        Limit { limit: (of_relief * relief).max(of_differences * nearest), most: tuning.shared_beyond }
    }

    /// Log of the prior of a shared error's size; `None` where the error is too large to be considered.
    pub(crate) fn log_prior(&self, tau: f64) -> Option<f64> {
        let size = tau / self.limit;
        (size <= self.most).then_some(-0.5 * size * size)
    }
}
