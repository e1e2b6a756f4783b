//! Whether what contacts lie off a simple shape runs along a line, as a scratch, a seam or a ridge does, and errors of a sensor do not.
//!
//! ```text
//! r_i          signed distances of contacts from the simple shape, at places (x, y) of the patch's plane
//! error        cov r = s^2 (I + rho exp(-d / l))                       what neighbours share in every direction
//! detail       cov r = s^2 (I + g exp(-(t - t')^2 / (2 w^2)))          t = x cos a + y sin a: a profile that is drawn along a line
//! it is shape  where ln p(detail) > ln p(error) + `Tuning::clearly`, each at its likeliest s, rho, l; g, w, a
//! ```
//!
//! The profile is taken as even over bins, so that its likelihood is that of their means. It must go on from bin to bin: fingers whose
//! strokes each err by an amount of their own are bins apart, and no profile is as narrow as what lies between two of them.
//! C. E. Rasmussen, C. K. I. Williams, *Gaussian Processes for Machine Learning*, MIT Press 2006, section 5.4.

use faer::Mat;

use crate::dense;
use palpate_numeric::threads;

/// Contacts that are asked, evenly among all: a scratch of three times the noise is clearly ahead among so many.
pub(super) const ASKED: usize = 400;

/// Directions of the line that are tried over half a turn.
const DIRECTIONS: usize = 36;

/// Bins across the patch.
const BINS: usize = 64;

/// Widths of a profile, in bins: from what two bins tell to a seventh of the patch, beyond which it is the patch that bends.
const WIDTHS: [f64; 3] = [2.0, 4.0, 8.0];

/// Variances of a profile and of shared errors over those of a single contact.
const RATIOS: [f64; 5] = [0.1, 0.3, 1.0, 3.0, 10.0];

/// Lengths of shared errors, in the length that recognition found.
const LENGTHS: [f64; 4] = [0.5, 1.0, 2.0, 4.0];

/// Width of a profile over the widest gap between bins that hold contacts: a width with fewer than two of them tells no profile.
const GOES_ON: f64 = 2.0;

/// Directions to either side, 15 degrees, in which that gap is looked for.
const BESIDE: usize = 3;

/// Places with what they lie off a simple shape, and the distance over which that looks like errors that neighbours share.
pub(super) struct Offsets {
    pub(super) places: Vec<[f64; 2]>,
    pub(super) off: Vec<f64>,
    pub(super) length: f64,
}

impl Offsets {
    /// Log likelihood by which a detail along a line is ahead of errors that neighbours share.
    pub(super) fn detail_ahead(&self) -> f64 {
        self.log_likelihood_of_detail() - self.log_likelihood_of_errors()
    }

    fn log_likelihood_of_errors(&self) -> f64 {
        let n = self.off.len();
        let square: f64 = self.off.iter().map(|r| r * r).sum();
        let of = |k: usize| {
            let (length, ratio) = (self.length * LENGTHS[k / RATIOS.len()], RATIOS[k % RATIOS.len()]);
            let covariance = |i: usize, j: usize| {
                let [a, b] = [self.places[i], self.places[j]];
                let shared = ratio * (-(a[0] - b[0]).hypot(a[1] - b[1]) / length).exp();
                if i == j { 1.0 + shared } else { shared }
            };
            let Some(lower) = dense::cholesky(&Mat::from_fn(n, n, covariance)) else { return f64::NEG_INFINITY };
            let mut whitened = self.off.clone();
            dense::forward(&lower, &mut whitened);
            log_likelihood(n, whitened.iter().map(|v| v * v).sum(), dense::log_det(&lower))
        };
        let alone = log_likelihood(n, square, 0.0);
        threads::map(LENGTHS.len() * RATIOS.len(), 1, of).into_iter().fold(alone, f64::max)
    }

    fn log_likelihood_of_detail(&self) -> f64 {
        let binned = threads::map(DIRECTIONS, 1, |k| self.binned(std::f64::consts::PI * k as f64 / DIRECTIONS as f64));
        let gaps: Vec<f64> = binned.iter().map(|bins| widest_gap(bins)).collect();
        // a stroke that is seen a little from its side fills the gap beside it
        let gap =
            |k: usize| (0..=2 * BESIDE).map(|j| gaps[(k + DIRECTIONS + j - BESIDE) % DIRECTIONS]).fold(0.0, f64::max);
        let square: f64 = self.off.iter().map(|r| r * r).sum();
        let of = |k: usize| {
            let widths = WIDTHS.into_iter().filter(|width| *width >= GOES_ON * gap(k));
            let each = widths.flat_map(|width| RATIOS.map(|ratio| (width, ratio)));
            each.filter_map(|(width, ratio)| of_profile(&binned[k], width, ratio, square, self.off.len()))
                .fold(f64::NEG_INFINITY, f64::max)
        };
        threads::map(DIRECTIONS, 1, of).into_iter().fold(f64::NEG_INFINITY, f64::max)
    }

    /// Bins across lines of one direction that hold contacts: their numbers, their contacts, and the sum of what these lie off.
    fn binned(&self, angle: f64) -> Vec<(f64, f64, f64)> {
        let (sin, cos) = angle.sin_cos();
        let across: Vec<f64> = self.places.iter().map(|[x, y]| x * cos + y * sin).collect();
        let lo = across.iter().copied().fold(f64::INFINITY, f64::min);
        let hi = across.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let mut bins: Vec<(f64, f64, f64)> = (0..BINS).map(|k| (k as f64, 0.0, 0.0)).collect();
        for (t, r) in across.iter().zip(&self.off) {
            let bin = &mut bins[((BINS as f64 * (t - lo) / (hi - lo)) as usize).min(BINS - 1)];
            (bin.1, bin.2) = (bin.1 + 1.0, bin.2 + r);
        }
        bins.retain(|bin| bin.1 > 0.0);
        bins
    }
}

/// Between bins that hold contacts.
fn widest_gap(bins: &[(f64, f64, f64)]) -> f64 {
    bins.windows(2).map(|two| two[1].0 - two[0].0).fold(0.0, f64::max)
}

/// Of a profile over bins, each with its number, its contacts and the sum of what they lie off.
///
/// ```text
/// r' V^-1 r = sum r^2 - y'y + y' M^-1 y,   y_k = sum_k r / sqrt(n_k),   M = I + g sqrt(n_k n_l) exp(-(k - l)^2 / (2 w^2)),   det V = det M
/// ```
fn of_profile(bins: &[(f64, f64, f64)], width: f64, ratio: f64, square: f64, count: usize) -> Option<f64> {
    let n = bins.len();
    let of = |i: usize, j: usize| {
        let ((a, n_a, _), (b, n_b, _)) = (bins[i], bins[j]);
        let shared = ratio * (n_a * n_b).sqrt() * (-0.5 * ((a - b) / width).powi(2)).exp();
        if i == j { 1.0 + shared } else { shared }
    };
    let lower = dense::cholesky(&Mat::from_fn(n, n, of))?;
    let mut y: Vec<f64> = bins.iter().map(|(_, count, sum)| sum / count.sqrt()).collect();
    let before: f64 = y.iter().map(|v| v * v).sum();
    dense::forward(&lower, &mut y);
    let after: f64 = y.iter().map(|v| v * v).sum();
    Some(log_likelihood(count, square - before + after, dense::log_det(&lower)))
}

/// `-(n ln(r' V^-1 r) + log det V) / 2`: at the likeliest variance, but for a constant.
fn log_likelihood(count: usize, square: f64, log_det: f64) -> f64 {
    -0.5 * (count as f64 * square.ln() + log_det)
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_numeric::draws::Lcg;

    /// Places all over a square of side 12.
    fn touched(generator: &mut Lcg) -> Vec<[f64; 2]> {
        (0..ASKED).map(|_| [0, 1].map(|_| 12.0 * generator.uniform() - 6.0)).collect()
    }

    fn ahead(places: Vec<[f64; 2]>, off: Vec<f64>) -> f64 {
        Offsets { places, off, length: 1.5 }.detail_ahead()
    }

    #[test]
    fn a_scratch_is_ahead_of_errors_that_neighbours_share() {
        let mut generator = Lcg::new(5);
        let places = touched(&mut generator);
        let depth = |[x, y]: [f64; 2]| -0.1 * (-((0.8 * x - 0.6 * y - 1.0) / 0.6).powi(2) / 2.0).exp();
        let off = places.iter().map(|p| depth(*p) + 0.03 * generator.normal()).collect();
        let found = ahead(places, off);
        assert!(found > 10.0, "{found}");
    }

    /// Waves of every direction are errors as a sensor's; bumps are no line either.
    #[test]
    fn errors_of_a_sensor_are_no_line() {
        for seed in 0..6 {
            let mut generator = Lcg::new(20 + seed);
            let places = touched(&mut generator);
            let waves: Vec<[f64; 3]> = (0..60)
                .map(|_| {
                    [generator.normal() / 1.5, generator.normal() / 1.5, std::f64::consts::TAU * generator.uniform()]
                })
                .collect();
            let shared = |[x, y]: [f64; 2]| -> f64 {
                waves.iter().map(|[u, v, phase]| (u * x + v * y + phase).cos()).sum::<f64>() / 30.0_f64.sqrt()
            };
            let off: Vec<f64> = places.iter().map(|p| 0.03 * shared(*p) + 0.03 * generator.normal()).collect();
            let found = ahead(places, off);
            assert!(found < 5.0, "{found}");
        }
    }

    /// Each of eight strokes is off by an amount of its own.
    #[test]
    fn strokes_that_err_each_by_itself_are_no_line() {
        let mut generator = Lcg::new(7);
        let own: Vec<f64> = (0..8).map(|_| 0.05 * generator.normal()).collect();
        let one = |i: usize| {
            let stroke = i % 8;
            ([stroke as f64 * 1.7 - 6.0, 12.0 * generator.uniform() - 6.0], own[stroke] + 0.02 * generator.normal())
        };
        let (places, off): (Vec<[f64; 2]>, Vec<f64>) = (0..ASKED).map(one).unzip();
        let found = ahead(places, off);
        assert!(found < 5.0, "{found}");
    }
}
