//! What few contacts leave open about the two noise sds: everything is averaged over their ratio.
//!
//! ```text
//! rows of heights and slopes   e, f with variances s^2 exp(t), s^2 exp(-t)        A(t) = exp(-t) A_z + exp(t) A_n
//! V'(A_z + A_n)V = 1,  V'A_z V = diag(l)      d_i(t) = exp(-t) l_i + exp(t) (1 - l_i)       any t costs O(unknowns)
//! log p(t | data) = -1/2 [ sum log d_i + (rows_z - rows_n) t + nu log rss(t) ] + log prior(t),    nu = rows - unknowns
//! variance of g'c about the estimate = sum_t p(t) [ rss(t)/(nu - 2) sum (V'g)_i^2/d_i + (g'c(t) - estimate)^2 ]
//! ```
//!
//! The likelihood is the restricted one, s integrated out under 1/s (D. A. Harville, *Biometrika* 61 (1974) 383). One set
//! of sds is not enough below some 30 contacts: with 9 contacts and 9 unknowns the likeliest height sd is often zero,
//! and the surface would seem to be known exactly.

use crate::fit::linear::equations::{Equations, RowKind, data_normal_matrix, only};
use crate::fit::linear::solution::Solution;
use crate::linalg::{RowWeights, SiteWeights, Sites, StencilMatrix, Targets, normal_rhs};
use crate::solve::simultaneous;

/// Sites up to which the ratio is averaged over. With more the sds are known to some 5 %, and their own degrees of freedom
/// say enough.
const FEW_SITES: usize = 200;
/// Unknowns up to which the matrices are diagonalised; 100 of them take a millisecond.
const FEW_UNKNOWNS: usize = 100;
/// Fewest degrees of freedom: a variance needs more than 4 for its own variance to exist.
const FEWEST: f64 = 5.0;
/// Expected ratio of a height's sd, in half sides of the patch, to that of a slope or normal. The prior of its logarithm is
/// 1/cosh: a ratio ten times larger or smaller is 5 times less likely, and no ratio is excluded.
const USUAL_RATIO: f64 = 0.1;
/// Range and steps of t. A step is half the posterior's sd at 200 sites.
const RANGE: f64 = 8.0;
const STEP: f64 = 0.05;
/// Shares of the posterior below this are left out.
const NEGLIGIBLE: f64 = 1e-4;

/// One ratio of the sds.
#[derive(Clone, Copy, Debug)]
struct Node {
    /// `exp(-t)` and `exp(t)`, by which squares of height and of slope rows are multiplied.
    factors: [f64; 2],
    /// Posterior probability.
    share: f64,
    /// Sum of squares that the fit at this ratio leaves.
    rss: f64,
}

/// The posterior of the ratio.
#[derive(Clone, Debug)]
pub(crate) struct Levels {
    nodes: Vec<Node>,
    /// `l`.
    of_heights: Vec<f64>,
    /// V.
    columns: Vec<Vec<f64>>,
    /// `V'E'r` of either kind, r the residuals of the fit.
    right: [Vec<f64>; 2],
    /// Factors by which the squares of the fit's rows were multiplied first, so that `t = 0` is the usual ratio.
    units: [f64; 2],
    /// Degrees of freedom.
    pub(crate) freedom: f64,
}

impl Levels {
    /// Of a fit with heights and slopes or normals; `None` for many contacts or unknowns, for a penalised fit, for one whose
    /// unknowns are not all determined, and where fewer than five degrees of freedom are left.
    pub(crate) fn new(equations: &Equations, solution: &Solution) -> Option<Levels> {
        let (sites, unknowns) = (equations.sites.len(), equations.unknowns());
        let rows = equations.row_weights.row_counts(sites).map(|r| r as f64);
        let freedom = rows[0] + rows[1] - unknowns as f64;
        let is_small = sites <= FEW_SITES && unknowns <= FEW_UNKNOWNS;
        let is_whole = solution.rank == unknowns && equations.roughness.is_none();
        if !is_small || !is_whole || rows.contains(&0.0) || freedom < FEWEST {
            return None;
        }
        let units = units(&equations.row_weights, sites);
        let residuals: Targets = equations.residuals(&solution.coefficients);
        let kinds = [RowKind::Heights, RowKind::Slopes].map(|kind| only(&equations.row_weights, kind));
        let [heights, slopes] = [0, 1].map(|b| {
            let matrix = data_normal_matrix(&equations.sites, &kinds[b]);
            lower_bands(&matrix, units[b])
        });
        let both: Vec<Vec<f64>> =
            heights.iter().zip(&slopes).map(|(h, s)| h.iter().zip(s).map(|(h, s)| h + s).collect()).collect();
        let (of_heights, columns) = simultaneous(&both, &heights).ok()?;
        let right = [0, 1].map(|b| {
            let mut out = vec![0.0; unknowns];
            normal_rhs(&equations.sites, &kinds[b], &residuals, &mut out);
            columns.iter().map(|v| units[b] * dot(v, &out)).collect::<Vec<f64>>()
        });
        let square = |r: &[f64; 3]| [r[0] * r[0], r[1] * r[1] + r[2] * r[2]];
        let squares = residuals.iter().map(square).fold([0.0; 2], |s, r| [s[0] + r[0], s[1] + r[1]]);
        let squares = [0, 1].map(|b| units[b] * squares[b]);
        let mut levels = Levels { nodes: Vec::new(), of_heights, columns, right, units, freedom };
        levels.nodes = levels.posterior(squares, rows);
        (!levels.nodes.is_empty()).then_some(levels)
    }

    fn posterior(&self, squares: [f64; 2], rows: [f64; 2]) -> Vec<Node> {
        let count = (RANGE / STEP) as i32;
        let mut found: Vec<(f64, Node)> = Vec::new();
        for k in -count..=count {
            let t = f64::from(k) * STEP;
            let factors = [(-t).exp(), t.exp()];
            let (mut log_det, mut taken) = (0.0, 0.0);
            for i in 0..self.of_heights.len() {
                let d = self.divisor(i, factors);
                log_det += d.ln();
                taken += self.right_at(i, factors).powi(2) / d;
            }
            let all = factors[0] * squares[0] + factors[1] * squares[1];
            // the fit at another ratio leaves less only by rounding
            let rss = (all - taken).max(1e-14 * all);
            let log = -0.5 * (log_det + (rows[0] - rows[1]) * t + self.freedom * rss.ln()) - t.cosh().ln();
            if log.is_finite() {
                found.push((log, Node { factors, share: 0.0, rss }));
            }
        }
        let most = found.iter().map(|(log, _)| *log).fold(f64::NEG_INFINITY, f64::max);
        let total: f64 = found.iter().map(|(log, _)| (log - most).exp()).sum();
        let shared = found.into_iter().map(|(log, node)| Node { share: (log - most).exp() / total, ..node });
        let mut nodes: Vec<Node> = shared.filter(|node| node.share > NEGLIGIBLE).collect();
        let kept: f64 = nodes.iter().map(|node| node.share).sum();
        nodes.iter_mut().for_each(|node| node.share /= kept);
        nodes
    }

    fn divisor(&self, i: usize, factors: [f64; 2]) -> f64 {
        // rounding may leave a share of 1 + 1e-16
        let share = self.of_heights[i].clamp(0.0, 1.0);
        (factors[0] * share + factors[1] * (1.0 - share)).max(f64::MIN_POSITIVE)
    }

    fn right_at(&self, i: usize, factors: [f64; 2]) -> f64 {
        factors[0] * self.right[0][i] + factors[1] * self.right[1][i]
    }

    /// Standard uncertainty of `g'c` about the fit's own value, and the degrees of freedom of Student's law with the same
    /// variance and kurtosis.
    pub(crate) fn uncertainty(&self, gradient: &[f64]) -> [f64; 2] {
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
            // moments of Student's law with nu degrees of freedom about a centre that is `off` the fit's value
            let (v, square) = (spread * node.rss / (nu - 2.0), off * off);
            second += node.share * (v + square);
            fourth += node.share * (3.0 * v * v * (nu - 2.0) / (nu - 4.0) + 6.0 * v * square + square * square);
        }
        let excess = fourth / (second * second) - 3.0;
        let dof = if excess > 0.0 { 4.0 + 6.0 / excess } else { f64::INFINITY };
        let scale = if dof.is_finite() { (dof - 2.0) / dof } else { 1.0 };
        [(second * scale).max(0.0).sqrt(), if second > 0.0 { dof } else { f64::INFINITY }]
    }

    /// The mean of something over the ratios; it is given the factors for the squares of the fit's rows, and what the fit
    /// leaves.
    pub(crate) fn mean(&self, mut of: impl FnMut([f64; 2], f64) -> Option<f64>) -> Option<f64> {
        let mut sum = 0.0;
        for node in &self.nodes {
            sum += node.share * of([0, 1].map(|b| node.factors[b] * self.units[b]), node.rss)?;
        }
        Some(sum)
    }
}

/// Factors for the squares of the rows of either kind that make their weights those of the usual ratio.
fn units(row_weights: &RowWeights, sites: usize) -> [f64; 2] {
    let (mut sums, mut counts) = ([0.0; 2], [0.0; 2]);
    for r in 0..sites {
        let SiteWeights { z, a, b, d } = row_weights.at(r);
        for (k, square) in [z * z, 0.5 * (a * a + b * b + d * d)].into_iter().enumerate() {
            sums[k] += square;
            counts[k] += f64::from(u8::from(square > 0.0));
        }
    }
    let [heights, slopes] = [0, 1].map(|k| counts[k] / sums[k]);
    [heights / (USUAL_RATIO * USUAL_RATIO), slopes]
}

/// Row i of the lower half as `[a_ii, a_i,i-1, ..]`, times `factor`.
fn lower_bands(matrix: &StencilMatrix, factor: f64) -> Vec<Vec<f64>> {
    let mut bands: Vec<Vec<f64>> = (0..matrix.order()).map(|i| vec![0.0; i + 1]).collect();
    matrix.for_each_lower(|row, column, at| bands[row][row - column] = factor * matrix.values()[at]);
    bands
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::Contacts;
    use crate::draws::EffectDraws;
    use crate::fit::{Fit, FitOptions, Objective, SlopeWeights, fit_contacts};

    /// A saddle touched at `n` x `n` places of [-1, 1]^2, with errors of heights and slopes.
    fn saddle(n: usize, sds: [f64; 2], replicate: u64) -> Contacts {
        let mut errors = vec![0.0; 3 * n * n];
        EffectDraws::new(7, "levels").gaussians(replicate, 0, 3 * n * n, &mut errors);
        let place = |k: usize| 2.0 * k as f64 / (n as f64 - 1.0) - 1.0;
        let (x, y): (Vec<f64>, Vec<f64>) = (0..n * n).map(|r| (place(r % n), place(r / n))).unzip();
        let with = |value: f64, k: usize, sd: f64| value + sd * errors[k];
        let z = (0..n * n).map(|r| with(0.1 * (x[r] * x[r] - y[r] * y[r]), r, sds[0])).collect();
        let zx = (0..n * n).map(|r| with(0.2 * x[r], n * n + r, sds[1])).collect();
        let zy = (0..n * n).map(|r| with(-0.2 * y[r], 2 * n * n + r, sds[1])).collect();
        Contacts::from_positions(x, y, z).with_slopes(zx, zy)
    }

    fn fitted(contacts: &Contacts, weights: SlopeWeights) -> Fit {
        fit_contacts(contacts, &FitOptions::default().with_objective(Objective::Slopes(weights))).unwrap()
    }

    #[test]
    fn what_a_ratio_leaves_is_what_a_fit_at_that_ratio_leaves() {
        let contacts = saddle(4, [0.01, 0.03], 0);
        let fit = fitted(&contacts, SlopeWeights::Tangent);
        let levels = Levels::new(fit.equations(), fit.solution()).unwrap();
        let mut checked = 0;
        levels
            .mean(|factors, rss| {
                let [z, slope] = [factors[0].sqrt(), 10.0 * factors[1].sqrt()];
                let again = fitted(&contacts, SlopeWeights::Explicit([z, slope, slope]));
                let squares: f64 = again.equations().residual_squares(&again.solution().coefficients).iter().sum();
                assert!((rss / squares - 1.0).abs() < 1e-9, "{factors:?}: {rss} {squares}");
                checked += 1;
                Some(1.0)
            })
            .unwrap();
        assert!(checked > 10, "{checked}");
        let total: f64 = levels.nodes.iter().map(|node| node.share).sum();
        assert!((total - 1.0).abs() < 1e-12);
    }

    /// With 9 contacts the likeliest height sd vanishes in a third of the fits, and an interval at that sd alone holds the
    /// truth in half of them.
    #[test]
    fn the_intervals_of_nine_contacts_hold_the_truth() {
        let (mut held, mut collapsed, count) = (0, 0, 300);
        for replicate in 0..count {
            let fit = fitted(&saddle(3, [0.005, 0.035], replicate), SlopeWeights::Auto);
            collapsed += u64::from(!fit.notes().is_empty());
            let interval = fit.shape().curvedness.interval.unwrap();
            // mean R of the saddle over the 8 x 8 grid, from its own coefficients
            let truth = fitted(&saddle(3, [0.0, 0.0], 0), SlopeWeights::Equal).shape().curvedness.mean.unwrap();
            held += u64::from(interval.lo <= truth && truth <= interval.hi);
        }
        assert!(collapsed * 5 > count, "{collapsed}");
        assert!(held * 100 >= 89 * count, "{held} of {count}");
    }
}
