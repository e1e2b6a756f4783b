//! The errors of one answer against the truth, and of many replicates together.
//!
//! ```text
//! one answer        rms and worst over the supported grid points;  shift = mean over them, with its sign
//! many replicates   rms = root of the mean square;  worst = the largest;  bias, sd = mean and sd of the shifts
//!                   upper = value below which 95 % of fresh replicates lie, with 95 % confidence (`kept`)
//! ```

use palpate_numeric::draws::Lcg;
use palpate_numeric::statistics::{Rank, quantile};

use super::kept::kept;

/// Quantities that are judged, in the order of every array of six here; the normal's error is an angle in degrees.
pub const QUANTITIES: [&str; 6] = ["S", "R", "k1", "height", "slope", "normal_deg"];

/// Their places.
pub(super) const S: usize = 0;
pub(super) const R: usize = 1;
pub(super) const K1: usize = 2;
pub(super) const HEIGHT: usize = 3;
pub(super) const SLOPE: usize = 4;
pub(super) const NORMAL: usize = 5;
const _: () = assert!(QUANTITIES.len() == 6);

/// Samples of the bootstrap of an rms.
const SAMPLES: usize = 200;

/// One quantity of one answer over the grid.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Deviation {
    squares: f64,
    sum: f64,
    worst: f64,
    count: f64,
}

impl Deviation {
    /// Takes in the error at one more point.
    pub(crate) fn add(&mut self, error: f64) {
        self.squares += error * error;
        self.sum += error;
        self.worst = self.worst.max(error.abs());
        self.count += 1.0;
    }

    /// Root mean square over the points; `None` without any.
    pub(crate) fn rms(&self) -> Option<f64> {
        (self.count > 0.0).then(|| (self.squares / self.count).sqrt()).filter(|v| v.is_finite())
    }

    /// Mean error over the points, with its sign.
    pub(crate) fn shift(&self) -> Option<f64> {
        (self.count > 0.0).then(|| self.sum / self.count)
    }
}

/// What is judged of one answer.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Judged {
    /// Errors of the six quantities.
    pub deviations: [Deviation; 6],
    /// Whether the intervals of S and of R hold the truth; `None` where there is no interval or no truth.
    pub held: [Option<bool>; 2],
    /// Points used over points of the grid.
    pub support: f64,
    /// Why there is no answer.
    pub failed: Option<String>,
}

/// The errors of one quantity over all replicates.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Errors {
    /// Root mean square over points and replicates.
    pub rms: f64,
    /// Its interval of 95 % over the replicates drawn again; both ends are `rms` where nothing is random.
    pub interval: [f64; 2],
    /// Largest error at any point of any replicate.
    pub worst: f64,
    /// Mean shift: what stays when replicates are averaged.
    pub bias: f64,
    /// Sd of the shifts: what noise does.
    pub sd: f64,
    /// At most this large in 95 of 100 fresh replicates, with 95 % confidence; `None` where too few were judged to say so.
    pub upper: Option<f64>,
}

/// The errors of one quantity; `None` where no replicate has one, or where one of them failed to have it. Replicates that are `fixed`
/// are all the same.
pub(super) fn errors_of(replicates: &[Judged], quantity: usize, fixed: bool) -> Option<Errors> {
    let all: Option<Vec<(Deviation, f64)>> = replicates
        .iter()
        .map(|judged| Some((judged.deviations[quantity], judged.deviations[quantity].rms()?)))
        .collect();
    let all = all.filter(|all| !all.is_empty())?;
    let squares: Vec<f64> = all.iter().map(|(_, rms)| rms * rms).collect();
    let count = all.len() as f64;
    let shifts: Vec<f64> = all.iter().map(|(d, _)| d.sum / d.count).collect();
    let bias = shifts.iter().sum::<f64>() / count;
    let variance = shifts.iter().map(|s| (s - bias).powi(2)).sum::<f64>() / (count - 1.0).max(1.0);
    Some(Errors {
        rms: (squares.iter().sum::<f64>() / count).sqrt(),
        interval: interval(&squares),
        worst: all.iter().map(|(d, _)| d.worst).fold(0.0, f64::max),
        bias,
        sd: variance.sqrt(),
        upper: kept(all.iter().map(|(_, rms)| *rms).collect(), fixed),
    })
}

/// Interval of 95 % of the root mean of `squares`, by drawing them again.
fn interval(squares: &[f64]) -> [f64; 2] {
    let mut draws = Lcg::new(squares.len() as u64);
    let count = squares.len();
    let mut means: Vec<f64> = (0..SAMPLES)
        .map(|_| {
            let drawn = (0..count).map(|_| squares[((draws.uniform() * count as f64) as usize).min(count - 1)]);
            (drawn.sum::<f64>() / count as f64).sqrt()
        })
        .collect();
    [0.025, 0.975].map(|share| quantile(&mut means, share, Rank::NearestStep).unwrap_or(f64::NAN))
}

/// Share of true ones with its interval of 95 % (E. B. Wilson, *J. Am. Stat. Assoc.* 22 (1927) 209) and how many there were.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Share {
    /// Share.
    pub share: f64,
    /// Lower end.
    pub lo: f64,
    /// Upper end.
    pub hi: f64,
    /// Number asked.
    pub asked: u64,
}

/// The share of what is true; `None` where nothing was asked.
pub(super) fn share(answers: impl Iterator<Item = bool>) -> Option<Share> {
    let (asked, held) = answers.fold((0_u64, 0_u64), |(n, k), held| (n + 1, k + u64::from(held)));
    if asked == 0 {
        return None;
    }
    const Z: f64 = 1.959_963_984_540_054;
    let (n, share) = (asked as f64, held as f64 / asked as f64);
    let middle = (share + Z * Z / (2.0 * n)) / (1.0 + Z * Z / n);
    let half = Z / (1.0 + Z * Z / n) * (share * (1.0 - share) / n + Z * Z / (4.0 * n * n)).sqrt();
    Some(Share { share, lo: (middle - half).max(0.0), hi: (middle + half).min(1.0), asked })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bias_and_spread_are_apart() {
        let one = |errors: [f64; 2]| {
            let mut judged = Judged::default();
            errors.iter().for_each(|e| judged.deviations[0].add(*e));
            judged
        };
        let found = errors_of(&[one([1.0, 3.0]), one([3.0, 5.0])], 0, false).unwrap();
        assert_eq!((found.bias, found.worst, found.rms), (3.0, 5.0, 11.0_f64.sqrt()));
        assert!((found.sd - 2.0_f64.sqrt()).abs() < 1e-15);
        assert!(found.upper.is_none() && errors_of(&[one([1.0, 3.0])], 0, true).unwrap().upper.is_some());
        assert!(errors_of(&[one([1.0, 3.0]), Judged::default()], 0, false).is_none());
    }

    #[test]
    fn shares_have_intervals() {
        let found = share((0..100).map(|k| k < 95)).unwrap();
        assert!(found.asked == 100 && found.lo < 0.95 && found.hi > 0.95 && found.lo > 0.88, "{found:?}");
        assert!(share(std::iter::empty()).is_none());
    }
}
