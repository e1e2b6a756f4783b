//! The linear law as a control: what is known exactly of a close relative of S is taken off the chance in S.
//!
//! ```text
//! L = g'(c - c0)              g: gradient of mean S (or R) by the coefficients, scaled so that L has sd 1
//! n = number of L <= z_p      p M are expected
//! y_p = value of rank  p M + beta (n - p M)        beta = cov(1{y <= y_p}, 1{L <= z_p})/(p (1 - p))
//! mean = mean(y) - b mean(L)      u^2 = s^2 - b^2 (mean(L^2) - 1)      b = cov(y, L)
//! ```
//!
//! It is used where L is standard normal exactly, whatever g: normal row noise at fixed sites, where c is linear in the
//! draws. A quantile so found varies as if there were 1/(1 - beta^2) times as many replicates (T. C. Hesterberg and B. L.
//! Nelson, *Management Science* 44 (1998) 1295). Each coefficient is the mean over the batches of the first stage, so that
//! a control that is worth nothing has beta near 0 and costs nothing.

use statrs::function::erf;

use super::evaluator::Evaluator;
use super::linear_rows::LinearRows;
use super::order_statistics::{Ranked, Sorted, symmetric_ranks};
use super::stopping::BatchEstimate;
use palpate_numeric::simd::{Isa, REPLICATES};

/// Step of the gradient in standard deviations of a coefficient. L is normal with any step; a better gradient follows S
/// more closely, and a step of the noise's size follows it best where S bends.
const STEP_OF_GRADIENT: f64 = 0.5;

/// The rows that make L of S and of R from coefficients.
#[derive(Clone, Debug)]
pub struct LinearControl {
    nominal: Vec<f64>,
    rows: [Vec<f64>; 2],
}

impl LinearControl {
    /// `None` where S or R does not vary to first order.
    pub(super) fn new(rows: &LinearRows, evaluator: &Evaluator) -> Option<LinearControl> {
        let draws = rows.of_draws()?;
        let nominal = rows.nominal().to_vec();
        let steps: Vec<f64> = (0..nominal.len())
            .map(|u| STEP_OF_GRADIENT * draws.iter().flat_map(|own| own[u]).map(|p| p * p).sum::<f64>().sqrt())
            .collect();
        let mut gradient = [vec![0.0; nominal.len()], vec![0.0; nominal.len()]];
        for first in (0..nominal.len()).step_by(REPLICATES / 2) {
            let last = (first + REPLICATES / 2).min(nominal.len());
            let mut c: Vec<[f64; REPLICATES]> = nominal.iter().map(|value| [*value; REPLICATES]).collect();
            for (k, u) in (first..last).enumerate() {
                c[u][2 * k] += steps[u];
                c[u][2 * k + 1] -= steps[u];
            }
            let mut means = [[f64::NAN; REPLICATES]; 2];
            evaluator.means_of_lanes(Isa::active(), &c, &mut means);
            for (k, u) in (first..last).enumerate().filter(|(_, u)| steps[*u] > 0.0) {
                (0..2).for_each(|q| gradient[q][u] = (means[q][2 * k] - means[q][2 * k + 1]) / (2.0 * steps[u]));
            }
        }
        let mut scaled = [Vec::new(), Vec::new()];
        for (row, own) in gradient.iter().zip(&mut scaled) {
            let along = |contact: &Vec<[f64; 3]>, k: usize| row.iter().zip(contact).map(|(g, p)| g * p[k]).sum::<f64>();
            let variance: f64 = draws.iter().flat_map(|own| [0, 1, 2].map(|k| along(own, k).powi(2))).sum();
            let sd = variance.sqrt();
            if !(sd > 0.0 && sd.is_finite()) {
                return None;
            }
            own.extend(row.iter().map(|g| g / sd));
        }
        Some(LinearControl { nominal, rows: scaled })
    }

    /// L of S and of R for every lane's coefficients.
    pub fn block(&self, c: &[[f64; REPLICATES]]) -> [[f64; REPLICATES]; 2] {
        let mut out = [[0.0; REPLICATES]; 2];
        for (row, own) in self.rows.iter().zip(&mut out) {
            for ((g, lanes), nominal) in row.iter().zip(c).zip(&self.nominal) {
                own.iter_mut().zip(lanes).for_each(|(l, c)| *l += g * (c - nominal));
            }
        }
        out
    }
}

/// Regression coefficients of one quantity: of the lower end, of the upper end, of the mean.
type Coefficients = [f64; 3];

/// What a run keeps of L: counts below both thresholds and moments, for S and for R.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ControlTally {
    seen: u64,
    below: [[u64; 2]; 2],
    sums: [[f64; 2]; 2],
    batches: u64,
    coefficients: [Coefficients; 2],
}

/// How one quantity's estimates are put right.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Correction {
    /// Ranks to be added to those of the lower and the upper end.
    pub ranks: [f64; 2],
    /// Beta of both ends.
    pub beta: [f64; 2],
    /// To be added to the mean.
    pub mean: f64,
    /// To be added to the variance.
    pub variance: f64,
    /// Share of the mean's variance that is left.
    pub left: f64,
}

impl ControlTally {
    /// Words of a file.
    pub const WORDS: usize = 16;

    /// Takes L of the next replicates in.
    pub fn take(&mut self, control: &[Vec<f64>], level: f64) {
        let z = threshold(level);
        for ((column, below), [sum, squares]) in control.iter().zip(&mut self.below).zip(&mut self.sums) {
            for l in column {
                below[0] += u64::from(*l <= -z);
                below[1] += u64::from(*l <= z);
                *sum += l;
                *squares += l * l;
            }
        }
        self.seen += control.first().map_or(0, |column| column.len() as u64);
    }

    /// Replicates seen.
    pub fn seen(&self) -> u64 {
        self.seen
    }

    /// Estimates of one batch of the first stage, whose coefficients are kept.
    pub fn look(&mut self, columns: &[Vec<f64>], control: &[Vec<f64>], level: f64) -> BatchEstimate {
        let mut found = [[f64::NAN; 4]; 2];
        let mut own = ControlTally { batches: 1, ..ControlTally::default() };
        own.take(control, level);
        for (q, (y, l)) in columns.iter().zip(control).take(2).enumerate() {
            let mut sorted = y.clone();
            sorted.sort_unstable_by(f64::total_cmp);
            let ranked = Ranked::Sorted(Sorted::new(sorted));
            let m = y.len() as f64;
            let mean = y.iter().sum::<f64>() / m;
            let variance = y.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (m - 1.0);
            let slope = y.iter().zip(l).map(|(y, l)| (y - mean) * l).sum::<f64>() / own.sums[q][1];
            let betas = betas(y, l, &ranked, level);
            own.coefficients[q] = [betas[0], betas[1], slope];
            (0..3).for_each(|k| self.coefficients[q][k] += own.coefficients[q][k]);
            let by = own.correction(q, level, variance);
            let [lo, hi] = symmetric_ranks(level, y.len() as u64);
            let ends = [ranked.at(lo + by.ranks[0]), ranked.at(hi + by.ranks[1])];
            found[q] = [mean + by.mean, (variance + by.variance).sqrt(), ends[0], ends[1]];
        }
        self.batches += 1;
        found
    }

    /// What puts quantity `q` right, whose sample variance this is.
    pub fn correction(&self, q: usize, level: f64, variance: f64) -> Correction {
        let batches = self.batches.max(1) as f64;
        let [lower, upper, slope] = self.coefficients[q].map(|sum| sum / batches);
        let (m, tail) = (self.seen as f64, 0.5 * (1.0 - level));
        let off = |k: usize, share: f64| self.below[q][k] as f64 - share * m;
        let more = -slope * slope * (self.sums[q][1] / m - 1.0);
        Correction {
            ranks: [lower * off(0, tail), upper * off(1, 1.0 - tail)],
            beta: [lower, upper],
            mean: -slope * self.sums[q][0] / m,
            variance: if variance + more > 0.0 { more } else { 0.0 },
            left: (1.0 - slope * slope / variance).clamp(0.0, 1.0),
        }
    }

    /// The words of a file.
    pub fn to_words(&self) -> Vec<u64> {
        let floats = self.sums.iter().flatten().chain(self.coefficients.iter().flatten()).map(|v| v.to_bits());
        let counts = [self.seen, self.batches].into_iter().chain(self.below.iter().flatten().copied());
        counts.chain(floats).collect()
    }

    /// From the words of a file; `None` where they are none.
    pub fn from_words(words: &[u64]) -> Option<ControlTally> {
        let words: &[u64; Self::WORDS] = words.try_into().ok()?;
        let float = |k: usize| f64::from_bits(words[k]);
        Some(ControlTally {
            seen: words[0],
            batches: words[1],
            below: [[words[2], words[3]], [words[4], words[5]]],
            sums: [[float(6), float(7)], [float(8), float(9)]],
            coefficients: [[float(10), float(11), float(12)], [float(13), float(14), float(15)]],
        })
    }
}

/// z of the upper end: half of `1 - level` lies above it.
fn threshold(level: f64) -> f64 {
    std::f64::consts::SQRT_2 * erf::erf_inv(level)
}

/// How closely "beyond the end" of y and of L go together.
fn betas(y: &[f64], l: &[f64], ranked: &Ranked<'_>, level: f64) -> [f64; 2] {
    let (m, z) = (y.len() as f64, threshold(level));
    let ranks = symmetric_ranks(level, y.len() as u64);
    [0, 1].map(|k| {
        let (end, cut) = (ranked.at(ranks[k]), [-z, z][k]);
        let (mut both, mut below, mut under) = (0.0, 0.0, 0.0);
        for (y, l) in y.iter().zip(l) {
            let (a, b) = (f64::from(u8::from(*y <= end)), f64::from(u8::from(*l <= cut)));
            (both, below, under) = (both + a * b, below + a, under + b);
        }
        let (below, under) = (below / m, under / m);
        ((both / m - below * under) / (under * (1.0 - under)).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0)
    })
}

#[cfg(test)]
mod tests {
    use super::super::stopping::batch_estimate;
    use super::*;
    use palpate_numeric::draws::EffectDraws;

    /// Mean squares of what mean, u, lower and upper end are off, with the control and without, over 200 batches of `y(l, n)`.
    fn errors(y: impl Fn(f64, f64) -> f64, truth: [f64; 4]) -> [[f64; 4]; 2] {
        let mut errors = [[0.0; 4]; 2];
        for seed in 0..200 {
            let (mut l, mut n) = (vec![0.0; 2048], vec![0.0; 2048]);
            EffectDraws::new(seed, "control").gaussians(0, 0, 1, &mut l);
            EffectDraws::new(seed, "rest").gaussians(0, 0, 1, &mut n);
            let values: Vec<f64> = l.iter().zip(&n).map(|(l, n)| y(*l, *n)).collect();
            let columns = [values.clone(), values];
            let with = ControlTally::default().look(&columns, &[l.clone(), l], 0.9)[0];
            let without = batch_estimate(&columns, 0.9)[0];
            for (sums, found) in errors.iter_mut().zip([with, without]) {
                (0..4).for_each(|k| sums[k] += (found[k] - truth[k]).powi(2) / 200.0);
            }
        }
        errors
    }

    #[test]
    fn a_close_relative_takes_the_chance_off_and_a_stranger_does_no_harm() {
        let z = 1.644_853_626_951_472_2;
        let u = 1.01_f64.sqrt();
        let [with, without] = errors(|l, n| l + 0.1 * n, [0.0, u, -z * u, z * u]);
        for (k, least) in [20.0, 20.0, 3.0, 3.0].into_iter().enumerate() {
            assert!(without[k] > least * with[k], "{k}: {} with, {} without", with[k], without[k]);
        }
        let [with, without] = errors(|_, n| n, [0.0, 1.0, -z, z]);
        (0..4).for_each(|k| assert!(with[k] < 1.1 * without[k], "{k}: {} with, {} without", with[k], without[k]));
    }

    #[test]
    fn a_tally_goes_through_a_file() {
        let mut tally = ControlTally::default();
        let l = vec![vec![-2.5, 0.1, 3.0], vec![0.0, 1.0, -0.5]];
        tally.take(&l, 0.95);
        tally.look(&l.clone(), &l, 0.95);
        assert_eq!(ControlTally::from_words(&tally.to_words()).as_ref(), Some(&tally));
        assert_eq!(ControlTally::from_words(&[1, 2]), None);
    }
}
