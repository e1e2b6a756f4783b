//! The posterior of the noise levels from its definition, to hold `levels.rs` and `ratios.rs` to: dense covariances, a Cholesky
//! factor at every pair of sds, and both sds summed over a grid.
//!
//! ```text
//! p(s, t | data) ~ |C|^-1/2 var_z^-n_z/2 var_n^-n_n/2 |A|^-1/2 exp(-rss/2) / cosh t        over ln s and t
//! var_z = s^2 exp(t)/unit_z,  var_n = s^2 exp(-t)/unit_n,   A = E'(var C)^-1 E
//! moments of the error of g'c about the fit: those of N(g'A^-1 b, g'A^-1 g), averaged over both sds
//! ```

use crate::fit::noise::fingers::Fingers;
use crate::fit::noise::variance_ratio_posterior::Levels;
use crate::fit::{Fit, FitOptions, Objective, SlopeWeights, fit_contacts};
use palpate_geometry::contact::{Contacts, Orientation};
use palpate_numeric::draws::EffectDraws;
use palpate_numeric::linalg::dot;
use palpate_numeric::statistics::upper_median;

type Matrix = Vec<Vec<f64>>;

/// Lower factor of a positive definite matrix.
fn cholesky(a: &Matrix) -> Matrix {
    let mut l = vec![vec![0.0; a.len()]; a.len()];
    for i in 0..a.len() {
        for j in 0..=i {
            let sum = a[i][j] - (0..j).map(|k| l[i][k] * l[j][k]).sum::<f64>();
            l[i][j] = if i == j { sum.sqrt() } else { sum / l[j][j] };
        }
    }
    l
}

/// `L^-1 b`.
fn forward(l: &Matrix, b: &[f64]) -> Vec<f64> {
    let mut out = b.to_vec();
    for i in 0..b.len() {
        out[i] = (out[i] - (0..i).map(|k| l[i][k] * out[k]).sum::<f64>()) / l[i][i];
    }
    out
}

fn log_det(l: &Matrix) -> f64 {
    (0..l.len()).map(|i| 2.0 * l[i][i].ln()).sum()
}

/// Rows of one kind made independent: their normal matrix, `E'r`, `r'r`, their number, and log |C|.
struct Kind {
    matrix: Matrix,
    right: Vec<f64>,
    square: f64,
    rows: f64,
    log_det: f64,
}

/// What one pair of sds says: log of the density, and mean and variance of `g'c - fit`.
struct BruteForceAnswer {
    log: f64,
    off: f64,
    spread: f64,
}

/// Sums over pairs of sds: log of the mass, and second and fourth moment.
#[derive(Clone, Copy)]
struct Sum {
    log: f64,
    moments: [f64; 2],
}

struct BruteForce {
    kinds: [Kind; 2],
    /// Factors of squares that make weights those of the usual ratio.
    units: [f64; 2],
    gradient: Vec<f64>,
    freedom: f64,
}

impl BruteForce {
    /// Of a fit with weights `[wz, ws]`, patch units, whose errors correlate by `correlations` over a median step of fingers.
    fn new(fit: &Fit, contacts: &Contacts, weights: [f64; 2], correlations: [f64; 2]) -> BruteForce {
        let equations = fit.equations();
        let unknowns = equations.unknowns();
        let residuals = equations.residuals(&fit.solution().coefficients);
        let bare = equations.residuals(&vec![0.0; unknowns]);
        let columns: Vec<Vec<[f64; 3]>> = (0..unknowns)
            .map(|j| {
                let unit: Vec<f64> = (0..unknowns).map(|k| f64::from(u8::from(k == j))).collect();
                let with = equations.residuals(&unit);
                with.iter().zip(&bare).map(|(w, b)| [0, 1, 2].map(|k| b[k] - w[k])).collect()
            })
            .collect();
        let kinds = [0..1, 1..3].map(|blocks| {
            let b = blocks.start;
            let factor = cholesky(&covariance(contacts, correlations[b]));
            let mut kind = Kind {
                matrix: vec![vec![0.0; unknowns]; unknowns],
                right: vec![0.0; unknowns],
                square: 0.0,
                rows: 0.0,
                log_det: 0.0,
            };
            for block in blocks.filter(|_| weights[b] > 0.0) {
                let white = |of: &[[f64; 3]]| forward(&factor, &of.iter().map(|row| row[block]).collect::<Vec<f64>>());
                let r = white(&residuals);
                let e: Vec<Vec<f64>> = columns.iter().map(|column| white(column)).collect();
                for i in 0..unknowns {
                    (0..unknowns).for_each(|j| kind.matrix[i][j] += dot(&e[i], &e[j]));
                    kind.right[i] += dot(&e[i], &r);
                }
                kind.square += dot(&r, &r);
                kind.rows += r.len() as f64;
                kind.log_det += log_det(&factor);
            }
            kind
        });
        // a height's sd is expected to be a tenth of a slope's
        let units = [1.0 / (0.1 * weights[0]).powi(2), if weights[1] > 0.0 { 1.0 / weights[1].powi(2) } else { 1.0 }];
        let freedom = kinds[0].rows + kinds[1].rows - unknowns as f64;
        let gradient = (0..unknowns).map(|k| 0.3 + (k as f64).sin()).collect();
        BruteForce { kinds, units, gradient, freedom }
    }

    fn at_variances(&self, variances: [f64; 2]) -> (BruteForceAnswer, f64) {
        let unknowns = self.gradient.len();
        let sum = |of: &dyn Fn(&Kind) -> f64| of(&self.kinds[0]) / variances[0] + of(&self.kinds[1]) / variances[1];
        let a: Matrix = (0..unknowns).map(|i| (0..unknowns).map(|j| sum(&|k| k.matrix[i][j])).collect()).collect();
        let b: Vec<f64> = (0..unknowns).map(|i| sum(&|k| k.right[i])).collect();
        let l = cholesky(&a);
        let (g, b) = (forward(&l, &self.gradient), forward(&l, &b));
        let rss = sum(&|k| k.square) - dot(&b, &b);
        let logs: f64 = (0..2).map(|k| self.kinds[k].rows * variances[k].ln() + self.kinds[k].log_det).sum();
        let log = -0.5 * (logs + log_det(&l) + rss);
        (BruteForceAnswer { log, off: dot(&g, &b), spread: dot(&g, &g) }, rss)
    }

    /// At `s` and `t`, without the prior of t.
    fn at(&self, s: f64, t: f64) -> (BruteForceAnswer, f64) {
        self.at_variances([s * s * t.exp() / self.units[0], s * s * (-t).exp() / self.units[1]])
    }

    /// Summed over ln s. Its law has an sd of 1/sqrt(2 nu), of which a step is half, and tails of s^-nu, whose fourth moments
    /// vanish to 1e-15 within 36/(nu - 4).
    fn over_scales(&self, t: f64) -> Sum {
        let nu = self.freedom;
        let middle = 0.5 * (self.at(1.0, t).1 / nu).ln();
        let step = 0.5 / (2.0 * nu).sqrt();
        let (from, to) = ((-1.5 / step) as i32, (36.0 / (nu - 4.0) / step) as i32);
        let said: Vec<BruteForceAnswer> =
            (from..=to).map(|k| self.at((middle + f64::from(k) * step).exp(), t).0).collect();
        let Sum { log, moments } = summed(said.iter().map(BruteForceAnswer::alone));
        Sum { log: log + step.ln(), moments }
    }

    /// The posterior over these t, equally spaced.
    fn over_ratios(&self, ts: &[f64]) -> Vec<Sum> {
        let with_prior = |t: f64, sum: Sum| Sum { log: sum.log - t.cosh().ln(), ..sum };
        ts.iter().map(|&t| with_prior(t, self.over_scales(t))).collect()
    }
}

impl BruteForceAnswer {
    /// The moments of a normal law about a centre that is `off`.
    fn alone(&self) -> Sum {
        let (v, d) = (self.spread, self.off * self.off);
        Sum { log: self.log, moments: [v + d, 3.0 * v * v + 6.0 * v * d + d * d] }
    }
}

/// Masses added, moments averaged.
fn summed(all: impl Iterator<Item = Sum> + Clone) -> Sum {
    let most = all.clone().map(|s| s.log).fold(f64::NEG_INFINITY, f64::max);
    let (mut total, mut moments) = (0.0, [0.0; 2]);
    for s in all {
        let mass = (s.log - most).exp();
        total += mass;
        (0..2).for_each(|k| moments[k] += mass * s.moments[k]);
    }
    Sum { log: most + total.ln(), moments: moments.map(|m| m / total) }
}

/// `rho^(way/median step)` between the touches of a finger, along the way that it took.
fn covariance(contacts: &Contacts, rho: f64) -> Matrix {
    let n = contacts.len();
    let mut out: Matrix = (0..n).map(|i| (0..n).map(|j| f64::from(u8::from(i == j))).collect()).collect();
    let Some(finger) = contacts.finger.as_ref().filter(|_| rho > 0.0) else { return out };
    let step = |r: usize| {
        let along = |v: &[f64]| v[r] - v[r - 1];
        along(&contacts.x).hypot(along(&contacts.y)).hypot(along(&contacts.z))
    };
    let steps: Vec<f64> = (1..n).filter(|&r| finger[r] == finger[r - 1]).map(step).collect();
    let median = upper_median(steps).unwrap();
    for i in 0..n {
        for j in (0..i).filter(|&j| finger[i] == finger[j]) {
            let way: f64 = (j + 1..=i).map(step).sum();
            out[i][j] = rho.powf(way / median);
            out[j][i] = out[i][j];
        }
    }
    out
}

/// A bowl touched by `n` fingers at `n` places each, uneven steps apart; errors of heights drift along a finger.
pub(super) fn bowl(n: usize, sds: [f64; 2], drift: f64, seed: u64) -> Contacts {
    let mut errors = vec![0.0; 3 * n * n];
    for (block, part) in errors.chunks_mut(48).enumerate() {
        EffectDraws::new(seed, "levels").gaussians(0, block as u64, part.len(), part);
    }
    let place = |k: usize| 2.0 * k as f64 / (n as f64 - 1.0) - 1.0;
    let (x, y): (Vec<f64>, Vec<f64>) = (0..n * n).map(|r| (place(r % n), place(r / n))).unzip();
    let x: Vec<f64> = x.iter().map(|x| x + 0.1 * (1.0 - x * x)).collect();
    let mut error = 0.0;
    let mut z = Vec::new();
    for r in 0..n * n {
        let fresh = errors[r];
        error = if r % n == 0 { fresh } else { drift * error + (1.0 - drift * drift).sqrt() * fresh };
        z.push(0.2 * x[r] * x[r] + 0.1 * y[r] * y[r] + sds[0] * error);
    }
    let zx = (0..n * n).map(|r| 0.4 * x[r] + sds[1] * errors[n * n + r]).collect();
    let zy = (0..n * n).map(|r| 0.2 * y[r] + sds[1] * errors[2 * n * n + r]).collect();
    let finger = Some((0..n * n).map(|r| (r / n) as u32).collect());
    Contacts { finger, ..Contacts::from_positions(x, y, z) }.with_slopes(zx, zy)
}

fn fitted(contacts: &Contacts, objective: Objective) -> Fit {
    fit_contacts(contacts, &FitOptions::default().with_objective(objective)).unwrap()
}

fn near(found: f64, expected: f64, relative: f64, what: &str) {
    assert!((found - expected).abs() <= relative * expected.abs(), "{what}: {found} instead of {expected}");
}

/// The law of Student with these moments, unless it has more degrees of freedom than the data.
fn holds_moments([u, dof]: [f64; 2], [second, fourth]: [f64; 2], most: f64, relative: f64) {
    near(u * u * dof / (dof - 2.0), second, relative, "second moment");
    let (kurtosis, least) = (fourth / (second * second), if most.is_finite() { 3.0 + 6.0 / (most - 4.0) } else { 3.0 });
    near(3.0 * (dof - 2.0) / (dof - 4.0), kurtosis.max(least), 2.0 * relative, "kurtosis");
    assert!(dof <= most, "{dof} of {most}");
}

const TANGENT: Objective = Objective::Slopes(SlopeWeights::Tangent);

/// Node for node to rounding, and against ten times as fine a sum over the whole range to what the shares that are left out
/// can carry.
#[test]
fn the_posterior_of_the_ratio_and_its_moments_are_those_of_brute_force() {
    for (n, sds, seed) in [(3, [0.01, 0.03], 1), (4, [0.002, 0.05], 2), (4, [0.03, 0.01], 3)] {
        let contacts = bowl(n, sds, 0.0, seed);
        let fit = fitted(&contacts, TANGENT);
        let brute = BruteForce::new(&fit, &contacts, [1.0, 10.0], [0.0; 2]);
        let levels = Levels::new(fit.equations(), fit.solution(), None, false).unwrap();
        assert_eq!(levels.freedom, brute.freedom);
        let mut nodes = Vec::new();
        let whole = levels.mean(|way| {
            // the factors are those of the rows, and exp(-t) and exp(t) but for the units
            nodes.push((0.5 * (way.factors[1] / brute.units[1] * brute.units[0] / way.factors[0]).ln(), way.rss));
            Some(1.0)
        });
        near(whole.unwrap(), 1.0, 1e-12, "all shares");
        let ts: Vec<f64> = nodes.iter().map(|node| node.0).collect();
        assert!(ts.len() > 5 && ts.windows(2).all(|t| t[1] > t[0]), "{ts:?}");
        for (t, rss) in &nodes {
            // a difference of sums of squares, in which one kind of rows counts exp(|t|) times as much
            near(*rss, brute.at(1.0, *t).1, 1e-9 * t.abs().exp(), "rss");
        }
        let sums = brute.over_ratios(&ts);
        let all = summed(sums.iter().copied());
        let mut at = 0;
        for (k, sum) in sums.iter().enumerate() {
            at = 0;
            let share = levels.mean(|_| {
                at += 1;
                Some(f64::from(u8::from(at == k + 1)))
            });
            near(share.unwrap(), (sum.log - all.log).exp(), 1e-6, "share");
        }
        assert_eq!(at, ts.len());
        holds_moments(levels.uncertainty(&brute.gradient), all.moments, levels.freedom, 1e-6);
        // what is left out is what has a share below 1e-4 of all steps in the range
        let step = (1..ts.len()).map(|k| ts[k] - ts[k - 1]).fold(f64::INFINITY, f64::min);
        let count = (8.0 / step + 1e-9) as i32;
        let steps: Vec<f64> = (-count..=count).map(|k| step * f64::from(k)).collect();
        let sums = brute.over_ratios(&steps);
        let all = summed(sums.iter().copied());
        assert_eq!(sums.iter().filter(|sum| (sum.log - all.log).exp() > 1e-4).count(), ts.len());
        // nothing that matters is left out, and nothing but the range ends the sum
        let fine: Vec<f64> = (-160..=160).map(|k| 0.05 * f64::from(k)).collect();
        let whole = summed(brute.over_ratios(&fine).into_iter());
        let [u, dof] = levels.uncertainty(&brute.gradient);
        near(u * u * dof / (dof - 2.0), whole.moments[0], 1e-2, "second moment over the whole range");
    }
}

/// Without slopes, with slopes, and with declared sds; every correlation that was tried has the share that its likelihood and
/// the prior give it.
#[test]
fn the_posterior_of_shared_errors_is_that_of_brute_force() {
    let mut most = 0.0_f64;
    for (n, drift, with_slopes) in [(5, 0.9, true), (5, 0.0, true), (5, 0.9, false), (6, 0.95, false)] {
        let mut contacts = bowl(n, [0.01, 0.03], drift, 4 + n as u64);
        if !with_slopes {
            contacts.orientation = Orientation::None;
        }
        let fingers = Fingers::of(&contacts, None);
        for are_known in [false, true] {
            let weights = if are_known { [80.0, 40.0] } else { [1.0, 10.0] };
            let fit =
                fitted(&contacts, Objective::Slopes(SlopeWeights::Explicit([weights[0], weights[1], weights[1]])));
            let weights = [weights[0], if with_slopes { weights[1] } else { 0.0 }];
            let levels = Levels::new(fit.equations(), fit.solution(), fingers.clone(), are_known).unwrap();
            let ways: Vec<[f64; 2]> = levels.sets.iter().map(|set| set.correlations).collect();
            assert_eq!(ways[0], [0.0; 2]);
            let sums: Vec<Sum> = ways
                .iter()
                .map(|&correlations| {
                    let brute = BruteForce::new(&fit, &contacts, weights, correlations);
                    let t_step = 0.05 * ((1.5 * (200.0 / contacts.len() as f64).sqrt()) as i32).min(8) as f64;
                    let ts: Vec<f64> =
                        (-60..=60).map(f64::from).map(|k| k * t_step).filter(|t| t.abs() <= 8.0).collect();
                    let sum = match (are_known, with_slopes) {
                        (true, _) => brute.at_variances([1.0; 2]).0.alone(),
                        (false, true) => {
                            let of = summed(brute.over_ratios(&ts).into_iter());
                            Sum { log: of.log + t_step.ln(), ..of }
                        }
                        (false, false) => brute.over_scales(0.0),
                    };
                    let prior = if correlations == [0.0; 2] { 2.0 / 3.0 } else { 1.0 / 36.0 };
                    Sum { log: sum.log + f64::ln(prior), ..sum }
                })
                .collect();
            let (all, shared) = (summed(sums.iter().copied()), summed(sums[1..].iter().copied()));
            let probability = if ways.len() > 1 { (shared.log - all.log).exp() } else { 0.0 };
            near(levels.probability_shared(), probability, 1e-6, "probability that errors are shared");
            most = most.max(probability);
            let gradient = &BruteForce::new(&fit, &contacts, weights, [0.0; 2]).gradient;
            // the shares that are left out are 1e-4 each
            let relative = if with_slopes && !are_known { 1e-2 } else { 1e-7 };
            let freedom = levels.freedom;
            holds_moments(levels.uncertainty(gradient), all.moments, freedom, relative);
            if ways.len() > 1 {
                let mean: f64 = (1..ways.len()).map(|k| (sums[k].log - shared.log).exp() * ways[k][0]).sum();
                near(levels.correlation(), mean, 1e-6, "mean correlation");
            }
            // an uncertainty of independent errors of its own, beside them; once of a known sd
            for (own, above) in [([0.02, 9.0], 1.0), ([0.01, f64::INFINITY], 1.5), ([0.02, 3.0], 1.0)] {
                let dof = f64::max(own[1], 5.0);
                let student =
                    if dof.is_finite() { [dof / (dof - 2.0), 3.0 * (dof - 2.0) / (dof - 4.0)] } else { [1.0, 3.0] };
                let second = own[0] * own[0] * student[0];
                let mixed = |own: f64, other: f64| (1.0 - probability) * own + probability * other;
                let moments = if probability > 0.0 { shared.moments } else { [0.0; 2] };
                let expected = [
                    mixed(second, above * above * moments[0]),
                    mixed(student[1] * second * second, above.powi(4) * moments[1]),
                ];
                let [u, found] = levels.beside_independent(gradient, own, above);
                let most = if own[1].is_finite() { freedom } else { f64::INFINITY };
                if most.is_finite() || found.is_finite() {
                    holds_moments([u, found], expected, most, relative);
                } else {
                    near(u * u, expected[0], relative, "second moment beside");
                    // a fit far from the middle of the law has lighter tails than any of Student's
                    assert!(expected[1] <= 3.0 * expected[0] * expected[0] * (1.0 + relative));
                }
            }
        }
    }
    assert!(most > 0.9, "{most}");
}
