//! What few contacts leave open about the noise, and what a finger's touches share: everything is averaged over both.
//!
//! ```text
//! ratios.rs     the ratio of the sds of heights and of slopes or normals
//! fingers.rs    errors that touches of one finger share: rho of neighbours, of heights alone or of normals, too
//! P(rho | data) ~ prior(rho) integral of p(data | rho, t) dt        prior: 2/3 on rho = 0, the rest shared equally
//! ```
//!
//! One set of sds is not enough below some 30 contacts: with 9 contacts and 9 unknowns the likeliest height sd is often
//! zero, and the surface would seem to be known exactly. Errors that a finger shares are bent into the surface, so that its
//! residuals are small where its own error is large; only the likelihood of all of them together tells.

use crate::fit::linear::equations::Equations;
use crate::fit::linear::solution::Solution;
use crate::fit::noise::fingers::Fingers;
use crate::fit::noise::ratios::{Known, Ratios};
use crate::fit::noise::row_sums::{DenseRows, independent};
use palpate_numeric::linalg::{RowWeights, SiteWeights, Sites, Targets};

/// Sites up to which the ratio is averaged over. With more the sds are known to some 5 %, and their own degrees of freedom
/// say enough.
const FEW_SITES: usize = 200;
/// Neighbouring residuals of more sites must correlate by this many standard deviations before errors are thought shared.
const EVIDENT: f64 = 2.5;
/// Sites times squared unknowns up to which that is looked into: a tenth of a second.
const MOST_WORK: usize = 20_000_000;
/// Unknowns up to which the matrices are diagonalised; 100 of them take a millisecond.
const FEW_UNKNOWNS: usize = 100;
/// Fewest degrees of freedom: a variance needs more than 4 for its own variance to exist.
const FEWEST_FREEDOM: f64 = 5.0;
/// Expected ratio of a height's sd, in half sides of the patch, to that of a slope or normal. The prior of its logarithm is
/// 1/cosh: a ratio ten times larger or smaller is 5 times less likely, and no ratio is excluded.
const USUAL_RATIO: f64 = 0.1;
/// Correlations of neighbouring touches that are tried, beside none: the typical one first, and then those on either side.
const TYPICAL: f64 = 0.8;
const STRONGER: &[f64] = &[0.9, 0.95, 0.98];
const WEAKER: &[f64] = &[0.6, 0.3];
const CORRELATIONS: usize = 1 + STRONGER.len() + WEAKER.len();
/// Log evidence by which the typical correlation may be behind none before the others are not tried. Of independent errors that
/// leaves out more than half of the searches, of errors that correlate by 0.9 along 27 touches hardly any; with 1 instead of 2
/// true planes under such errors are rejected in 9 of 100, not in 6.
const UNLIKELY: f64 = 2.0;
/// Prior probability that touches of a finger share errors at all. In 27 touches even a correlation of 0.9 hardly shows: with
/// a half, intervals of independent errors hold the truth in 98 of 100, and are a fifth too wide.
const SHARED: f64 = 1.0 / 3.0;
/// Log evidence below the best at which stronger correlations are not tried once it falls.
const HOPELESS: f64 = 6.0;

/// The ratios under one correlation.
#[derive(Clone, Debug)]
struct Set {
    /// Of neighbouring errors of heights and of slopes or normals.
    correlations: [f64; 2],
    share: f64,
    ratios: Ratios,
}

/// The posterior of correlation and ratio.
#[derive(Clone, Debug)]
pub(crate) struct Levels {
    sets: Vec<Set>,
    fingers: Option<Fingers>,
    /// Factors by which the squares of the fit's rows were multiplied first, so that `t = 0` is the usual ratio.
    units: [f64; 2],
    /// Degrees of freedom.
    pub(crate) freedom: f64,
}

/// One way in which the errors may be: a correlation along the fingers, and a ratio of the sds.
pub(crate) struct Way<'a> {
    /// Fingers and correlations of neighbouring errors of heights and slopes; `None` where errors are independent.
    pub shared: Option<(&'a Fingers, [f64; 2])>,
    /// Factors for the squares of the fit's rows.
    pub factors: [f64; 2],
    /// What the fit leaves.
    pub rss: f64,
}

impl Levels {
    /// Of a fit with heights and slopes or normals, or with fingers that may share errors; `are_known` says that the rows'
    /// weights are inverse sds. `None` for many contacts or unknowns, for a penalised fit, for one whose unknowns are not all
    /// determined, and where fewer than five degrees of freedom are left.
    pub(crate) fn new(
        equations: &Equations,
        solution: &Solution,
        fingers: Option<Fingers>,
        are_known: bool,
    ) -> Option<Levels> {
        let (sites, unknowns) = (equations.sites.len(), equations.unknowns());
        let rows = equations.row_weights.row_counts(sites).map(|r| r as f64);
        let freedom = rows[0] + rows[1] - unknowns as f64;
        let is_whole = solution.rank == unknowns && equations.roughness.is_none();
        if unknowns > FEW_UNKNOWNS || !is_whole || freedom < FEWEST_FREEDOM {
            return None;
        }
        let residuals: Targets = equations.residuals(&solution.coefficients);
        let fingers = fingers.filter(|f| {
            let heights = || residuals.iter().map(|r| r[0]).collect::<Vec<f64>>();
            let fits = sites.saturating_mul(unknowns * unknowns) <= MOST_WORK;
            rows[0] > 0.0 && fits && (sites <= FEW_SITES || f.evident(&heights()) > EVIDENT)
        });
        let few_of_both = sites <= FEW_SITES && !rows.contains(&0.0);
        if fingers.is_none() && (!few_of_both || are_known) {
            return None;
        }
        let units = units(&equations.row_weights, sites);
        let known = match (are_known, rows.contains(&0.0)) {
            (true, _) => Known::Both(units.map(|u| 1.0 / u)),
            (false, true) => Known::Ratio,
            (false, false) => Known::Nothing,
        };
        let white = Ratios::new(&independent(equations, &residuals, units, rows), freedom, known, stride(sites))?;
        let mut levels =
            Levels { sets: vec![Set { correlations: [0.0; 2], share: 1.0, ratios: white }], fingers, units, freedom };
        levels.add_shared(equations, &residuals, rows, known);
        levels.share_out();
        Some(levels)
    }

    fn add_shared(&mut self, equations: &Equations, residuals: &Targets, rows: [f64; 2], known: Known) {
        let Some(fingers) = &self.fingers else { return };
        let dense = DenseRows::new(equations, residuals);
        let white = self.sets[0].ratios.log_evidence;
        let mut best = white;
        let stride = stride(equations.sites.len());
        let mut found = Vec::new();
        for has_slopes in [false, true] {
            if has_slopes && rows[1] == 0.0 {
                break;
            }
            let mut under = |rho: f64| {
                let correlations = [rho, if has_slopes { rho } else { 0.0 }];
                let sums = dense.sums(fingers, correlations, self.units, rows);
                let ratios = Ratios::new(&sums, self.freedom, known, stride)?;
                let here = ratios.log_evidence;
                found.push(Set { correlations, share: 0.0, ratios });
                Some(here)
            };
            let Some(first) = under(TYPICAL) else { continue };
            if first < white - UNLIKELY {
                continue;
            }
            best = best.max(first);
            for further in [STRONGER, WEAKER] {
                let mut last = first;
                for &rho in further {
                    let Some(here) = under(rho) else { continue };
                    if here < best - HOPELESS && here < last {
                        break;
                    }
                    (last, best) = (here, best.max(here));
                }
            }
        }
        self.sets.extend(found);
    }

    fn share_out(&mut self) {
        let each = SHARED / (2 * CORRELATIONS) as f64;
        let prior = |set: &Set| if set.correlations == [0.0; 2] { 1.0 - SHARED } else { each };
        let most = self.sets.iter().map(|s| s.ratios.log_evidence).fold(f64::NEG_INFINITY, f64::max);
        let shares: Vec<f64> = self.sets.iter().map(|s| prior(s) * (s.ratios.log_evidence - most).exp()).collect();
        let total: f64 = shares.iter().sum();
        self.sets.iter_mut().zip(shares).for_each(|(set, share)| set.share = share / total);
    }

    /// Standard uncertainty of `g'c` about the fit's own value, and the degrees of freedom of Student's law with the same
    /// variance and kurtosis.
    pub(crate) fn uncertainty(&self, gradient: &[f64]) -> [f64; 2] {
        student(self.moments(gradient, |_| true), self.freedom)
    }

    /// The same where an uncertainty with its degrees of freedom is right for independent errors; `above` is a factor by
    /// which the sds are larger than the rows' weights say.
    pub(crate) fn beside_independent(&self, gradient: &[f64], [u, dof]: [f64; 2], above: f64) -> [f64; 2] {
        let shared = self.probability_shared();
        // a law of fewer than five degrees of freedom has no fourth moment
        let dof = dof.max(FEWEST_FREEDOM);
        let (second, kurtosis) =
            if dof.is_finite() { (u * u * dof / (dof - 2.0), 3.0 * (dof - 2.0) / (dof - 4.0)) } else { (u * u, 3.0) };
        let [of_shared, fourth_of_shared] = self.moments(gradient, |set| set.correlations != [0.0; 2]);
        let own = 1.0 - shared;
        student(
            [
                own * second + above * above * of_shared,
                own * kurtosis * second * second + above.powi(4) * fourth_of_shared,
            ],
            if dof.is_finite() { self.freedom } else { f64::INFINITY },
        )
    }

    fn moments(&self, gradient: &[f64], counts: impl Fn(&Set) -> bool) -> [f64; 2] {
        let mut sums = [0.0; 2];
        for set in self.sets.iter().filter(|set| counts(set)) {
            let moments = set.ratios.moments(gradient);
            (0..2).for_each(|k| sums[k] += set.share * moments[k]);
        }
        sums
    }

    /// Probability that touches of a finger share errors.
    pub(crate) fn probability_shared(&self) -> f64 {
        self.sets.iter().filter(|set| set.correlations != [0.0; 2]).map(|set| set.share).sum()
    }

    /// Mean correlation of neighbouring heights' errors, if they share any.
    pub(crate) fn correlation(&self) -> f64 {
        let shared = self.probability_shared();
        let sum: f64 = self.sets.iter().map(|set| set.share * set.correlations[0]).sum();
        if shared > 0.0 { sum / shared } else { 0.0 }
    }

    /// The mean of something over all ways in which the errors may be.
    pub(crate) fn mean(&self, mut of: impl FnMut(&Way) -> Option<f64>) -> Option<f64> {
        let mut sum = 0.0;
        for set in &self.sets {
            let shared = self.fingers.as_ref().filter(|_| set.correlations != [0.0; 2]);
            for node in &set.ratios.nodes {
                let way = Way {
                    shared: shared.map(|fingers| (fingers, set.correlations)),
                    factors: [0, 1].map(|b| node.factors[b] * self.units[b]),
                    rss: node.rss,
                };
                sum += set.share * node.share * of(&way)?;
            }
        }
        Some(sum)
    }
}

/// Scale and degrees of freedom, as many as the data have at most, of Student's law with this variance and fourth moment.
fn student([second, fourth]: [f64; 2], most: f64) -> [f64; 2] {
    let excess = fourth / (second * second) - 3.0;
    let dof = if excess > 0.0 { (4.0 + 6.0 / excess).min(most) } else { most };
    let scale = if dof.is_finite() { (dof - 2.0) / dof } else { 1.0 };
    [(second * scale).max(0.0).sqrt(), if second > 0.0 { dof } else { f64::INFINITY }]
}

/// Steps of the ratio's grid that are taken at once: three quarters of the posterior's sd, at which a sum over a bell is exact to
/// eight digits. The longest are a quarter of pi/2, within which no posterior of the ratio has a singularity.
fn stride(sites: usize) -> i32 {
    let steps = 1.5 * (FEW_SITES as f64 / sites.max(1) as f64).sqrt();
    (steps as i32).clamp(1, 8)
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
    // a kind without rows keeps the weights it does not have
    let [heights, slopes] = [0, 1].map(|k| if sums[k] > 0.0 { counts[k] / sums[k] } else { 1.0 });
    [heights / (USUAL_RATIO * USUAL_RATIO), slopes]
}

#[cfg(test)]
mod by_brute_force;
#[cfg(test)]
mod limits;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::{Fit, FitOptions, Objective, SlopeWeights, fit_contacts};
    use palpate_geometry::contact::Contacts;
    use palpate_numeric::draws::EffectDraws;

    fn drawn(seed: u64, replicate: u64, errors: &mut [f64]) {
        let draws = EffectDraws::new(seed, "levels");
        for (block, part) in errors.chunks_mut(48).enumerate() {
            draws.gaussians(replicate, block as u64, part.len(), part);
        }
    }

    /// A saddle touched at `n` x `n` places of [-1, 1]^2, with errors of heights and slopes.
    fn saddle(n: usize, sds: [f64; 2], replicate: u64) -> Contacts {
        let mut errors = vec![0.0; 3 * n * n];
        drawn(7, replicate, &mut errors);
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
        let levels = Levels::new(fit.equations(), fit.solution(), None, false).unwrap();
        let mut checked = 0;
        levels
            .mean(|Way { factors, rss, .. }| {
                let [z, slope] = [factors[0].sqrt(), 10.0 * factors[1].sqrt()];
                let again = fitted(&contacts, SlopeWeights::Explicit([z, slope, slope]));
                let squares: f64 = again.equations().residual_squares(&again.solution().coefficients).iter().sum();
                assert!((rss / squares - 1.0).abs() < 1e-9, "{factors:?}: {rss} {squares}");
                checked += 1;
                Some(1.0)
            })
            .unwrap();
        assert!(checked > 5, "{checked}");
        let total: f64 = levels.sets[0].ratios.nodes.iter().map(|node| node.share).sum();
        assert!((total - 1.0).abs() < 1e-12);
    }

    /// Sums at the longer steps agree with those at every step, but for the shares that are left out as negligible and, with
    /// nine contacts, for the end of the range, where one level has vanished.
    #[test]
    fn longer_steps_of_the_ratio_give_the_same_moments() {
        for (n, replicate) in [(3, 0), (3, 1), (4, 2), (6, 3), (10, 4)] {
            let contacts = saddle(n, [0.01, 0.03], replicate);
            let fit = fitted(&contacts, SlopeWeights::Auto);
            let (equations, solution) = (fit.equations(), fit.solution());
            let (sites, residuals) = (n * n, equations.residuals(&solution.coefficients));
            let rows = equations.row_weights.row_counts(sites).map(|r| r as f64);
            let freedom = rows[0] + rows[1] - equations.unknowns() as f64;
            let sums = independent(equations, &residuals, units(&equations.row_weights, sites), rows);
            let at = |stride| Ratios::new(&sums, freedom, Known::Nothing, stride).unwrap();
            let (short, long) = (at(1), at(stride(sites)));
            let apart = (short.log_evidence - long.log_evidence).abs();
            assert!(apart < if n == 3 { 1e-4 } else { 1e-6 }, "{n}: {apart}");
            let gradient = vec![1.0; equations.unknowns()];
            for (a, b) in short.moments(&gradient).into_iter().zip(long.moments(&gradient)) {
                assert!((a / b - 1.0).abs() < if n == 3 { 5e-2 } else { 1e-2 }, "{n}: {a} {b}");
            }
        }
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

    /// Errors that correlate by 0.9 from touch to touch are bent into the surface: the residuals alone promise several
    /// times too much.
    #[test]
    fn errors_shared_along_fingers_widen_the_intervals() {
        let truth = fitted(&saddle(5, [0.0, 0.0], 0), SlopeWeights::Equal).shape().curvedness.mean.unwrap();
        let drifting = |replicate: u64| {
            let mut contacts = saddle(5, [0.0, 0.035], replicate);
            let mut draws = vec![0.0; 25];
            drawn(8, replicate, &mut draws);
            let mut error = 0.0;
            for r in 0..25 {
                error = if r % 5 == 0 { draws[r] } else { 0.9 * error + 0.19_f64.sqrt() * draws[r] };
                contacts.z[r] += 0.005 * error;
            }
            contacts
        };
        let mut held = [0, 0];
        for replicate in 0..100 {
            let contacts = drifting(replicate);
            let named = Contacts { finger: Some((0..25).map(|r| r / 5).collect()), ..contacts.clone() };
            for (held, contacts) in held.iter_mut().zip([contacts, named]) {
                let interval = fitted(&contacts, SlopeWeights::Auto).shape().curvedness.interval.unwrap();
                *held += u64::from(interval.lo <= truth && truth <= interval.hi);
            }
        }
        assert!(held[1] >= held[0] + 15 && held[1] >= 60, "{held:?}");
    }
}
