//! The posterior of the ratio of two noise sds, and what fits at every ratio leave, at the cost of one diagonalisation.
//!
//! ```text
//! rows of heights and slopes   e, f with variances s^2 exp(t), s^2 exp(-t)        A(t) = exp(-t) A_z + exp(t) A_n
//! V'(A_z + A_n)V = 1,  V'A_z V = diag(l)      d_i(t) = exp(-t) l_i + exp(t) (1 - l_i)       any t costs O(unknowns)
//! log p(t | data) = -1/2 [ sum log d_i + (rows_z - rows_n) t + nu log rss(t) ] + log prior(t),    nu = rows - unknowns
//! variance of g'c about the estimate = sum_t p(t) [ rss(t)/(nu - 2) sum (V'g)_i^2/d_i + (g'c(t) - estimate)^2 ]
//! ```
//!
//! The likelihood is the restricted one, s integrated out under 1/s (D. A. Harville, *Biometrika* 61 (1974) 383).

use crate::fit::noise::row_sums::Sums;
use palpate_numeric::linalg::dot;
use palpate_numeric::solve::{Simultaneous, simultaneous};

/// Range and steps of t. A step is half the posterior's sd at 200 sites.
const RANGE: f64 = 8.0;
const STEP_OF_T: f64 = 0.05;
/// Shares of the posterior below this are left out.
const NEGLIGIBLE: f64 = 1e-4;

/// What is known of the two sds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Known {
    /// Neither sd. The prior of the logarithm of their ratio is 1/cosh.
    Nothing,
    /// Their ratio, because there are rows of one kind alone.
    Ratio,
    /// Both, by weights that are inverse sds; these are their factors.
    Both([f64; 2]),
}

/// One ratio of the sds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    /// `exp(-t)` and `exp(t)`, by which squares of height and of slope rows are multiplied.
    pub factors: [f64; 2],
    /// Posterior probability.
    pub share: f64,
    /// Sum of squares that the fit at this ratio leaves.
    pub rss: f64,
}

/// The posterior of the ratio.
#[derive(Clone, Debug)]
pub(super) struct Ratios {
    pub nodes: Vec<Node>,
    /// Log of the probability of the residuals, up to a constant of the fit.
    pub log_evidence: f64,
    /// `l`.
    of_heights: Vec<f64>,
    /// V.
    columns: Vec<Vec<f64>>,
    /// `V'E'r` of either kind, r the residuals of the fit.
    right: [Vec<f64>; 2],
    freedom: f64,
    known: Known,
}

impl Ratios {
    /// At every `stride`-th step of the ratio. `None` where the rows do not determine all unknowns.
    pub(super) fn new(sums: &Sums, freedom: f64, known: Known, stride: i32) -> Option<Ratios> {
        let [heights, slopes] = &sums.matrices;
        let both: Vec<Vec<f64>> =
            heights.iter().zip(slopes).map(|(h, s)| h.iter().zip(s).map(|(h, s)| h + s).collect()).collect();
        let Simultaneous { lambda: of_heights, columns, log_det } = simultaneous(&both, heights).ok()?;
        let right = [0, 1].map(|b| columns.iter().map(|v| dot(v, &sums.right[b])).collect::<Vec<f64>>());
        let constant = -0.5 * (sums.log_det + log_det);
        let mut ratios =
            Ratios { nodes: Vec::new(), log_evidence: constant, of_heights, columns, right, freedom, known };
        ratios.find_nodes(sums, stride);
        (!ratios.nodes.is_empty() && ratios.log_evidence.is_finite()).then_some(ratios)
    }

    fn find_nodes(&mut self, sums: &Sums, stride: i32) {
        let taken = STEP_OF_T * f64::from(stride);
        let count = (RANGE / taken) as i32;
        let tried: Vec<(f64, [f64; 2])> = match self.known {
            Known::Nothing => {
                (-count..=count).map(|k| f64::from(k) * taken).map(|t| (t, [(-t).exp(), t.exp()])).collect()
            }
            Known::Ratio => vec![(0.0, [1.0; 2])],
            Known::Both(factors) => vec![(0.0, factors)],
        };
        let found = tried.into_iter().map(|(t, factors)| self.node(sums, t, factors));
        let found: Vec<(f64, Node)> = found.filter(|(log, _)| log.is_finite()).collect();
        let most = found.iter().map(|(log, _)| *log).fold(f64::NEG_INFINITY, f64::max);
        let total: f64 = found.iter().map(|(log, _)| (log - most).exp()).sum();
        let step = if self.known == Known::Nothing { taken } else { 1.0 };
        self.log_evidence += most + (total * step).ln();
        let shared = found.into_iter().map(|(log, node)| Node { share: (log - most).exp() / total, ..node });
        self.nodes = shared.filter(|node| node.share > NEGLIGIBLE).collect();
        let kept: f64 = self.nodes.iter().map(|node| node.share).sum();
        self.nodes.iter_mut().for_each(|node| node.share /= kept);
    }

    fn node(&self, sums: &Sums, t: f64, factors: [f64; 2]) -> (f64, Node) {
        let (mut log_det, mut taken) = (0.0, 0.0);
        for i in 0..self.of_heights.len() {
            let d = self.divisor(i, factors);
            log_det += d.ln();
            taken += self.right_at(i, factors).powi(2) / d;
        }
        let all = factors[0] * sums.squares[0] + factors[1] * sums.squares[1];
        // the fit at another ratio leaves less only by rounding
        let rss = (all - taken).max(1e-14 * all);
        let misfit = match self.known {
            Known::Both(_) => rss,
            Known::Nothing | Known::Ratio => self.freedom * rss.ln(),
        };
        let log = -0.5 * (log_det + (sums.rows[0] - sums.rows[1]) * t + misfit) - t.cosh().ln();
        (log, Node { factors, share: 0.0, rss })
    }

    fn divisor(&self, i: usize, factors: [f64; 2]) -> f64 {
        // rounding may leave a share of 1 + 1e-16
        let share = self.of_heights[i].clamp(0.0, 1.0);
        (factors[0] * share + factors[1] * (1.0 - share)).max(f64::MIN_POSITIVE)
    }

    fn right_at(&self, i: usize, factors: [f64; 2]) -> f64 {
        factors[0] * self.right[0][i] + factors[1] * self.right[1][i]
    }

    /// Second and fourth moment of the error of `g'c` about the fit's own value.
    pub(super) fn moments(&self, gradient: &[f64]) -> [f64; 2] {
        let turned: Vec<f64> = self.columns.iter().map(|v| dot(v, gradient)).collect();
        let nu = self.freedom;
        let (mut second, mut fourth) = (0.0, 0.0);
        for node in &self.nodes {
            let (mut spread, mut off) = (0.0, 0.0);
            for (i, g) in turned.iter().enumerate() {
                let d = self.divisor(i, node.factors);
                spread += g * g / d;
                off += g * self.right_at(i, node.factors) / d;
            }
            // moments of Student's law with nu degrees of freedom about a centre that is `off` the fit's value; of the
            // normal law where the sds are known
            let square = off * off;
            let (v, kurtosis) = match self.known {
                Known::Both(_) => (spread, 3.0),
                Known::Nothing | Known::Ratio => (spread * node.rss / (nu - 2.0), 3.0 * (nu - 2.0) / (nu - 4.0)),
            };
            second += node.share * (v + square);
            fourth += node.share * (kurtosis * v * v + 6.0 * v * square + square * square);
        }
        [second, fourth]
    }
}
