//! What a study says: means, intervals, class shares, each with how far it is converged.

use super::control::Correction;
use super::order_statistics::{Coverage, Ranked};
use super::state::StudyState;
use super::tally::{Store, Tally};
use palpate_geometry::curvature::ShapeClass;

/// One quantity over the replicates.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Summary {
    /// Mean; `None` where the quantity was defined in no replicate.
    pub mean: Option<f64>,
    /// Sample sd.
    pub sd: Option<f64>,
    /// Mean less truth.
    pub bias: Option<f64>,
    /// The truth.
    pub truth: Option<f64>,
    /// The value without noise.
    pub nominal: Option<f64>,
    /// Probabilistically symmetric interval.
    pub symmetric: Option<Coverage>,
    /// Shortest interval.
    pub shortest: Option<Coverage>,
    /// Standard error of the mean.
    pub standard_error: Option<f64>,
    /// Quantiles asked for: share, value, standard error.
    pub quantiles: Vec<[f64; 3]>,
    /// Replicates in which it was undefined.
    pub undefined: u64,
    /// Beta of both ends where the linear law stood by as a control: each end is known as if there were 1/(1 - beta^2) times
    /// as many replicates.
    pub control: Option<[f64; 2]>,
    /// Width of the bins that the values lie in at the interval's ends; 0 where all values are kept.
    pub resolution: f64,
}

/// Summarises a tally.
pub fn summarise(
    tally: &Tally,
    level: f64,
    quantiles: &[f64],
    truth: Option<f64>,
    nominal: f64,
    control: Option<Correction>,
) -> Summary {
    let ranked = tally.ranked();
    let mean = tally.mean().map(|mean| mean + control.map_or(0.0, |c| c.mean));
    let plain_sd = tally.sd();
    let sd = plain_sd.map(|sd| control.map_or(sd, |c| (sd * sd + c.variance).sqrt()));
    let left = control.map_or(1.0, |c| c.left.sqrt());
    let symmetric = match control.filter(|_| ranked.len() > 1) {
        Some(control) => Some(ranked.corrected(level, control.ranks, control.beta)),
        None => ranked.symmetric(level),
    };
    Summary {
        mean,
        sd,
        bias: mean.zip(truth).map(|(mean, truth)| mean - truth),
        truth,
        nominal: Some(nominal).filter(|v| v.is_finite()),
        symmetric,
        shortest: ranked.shortest(level),
        standard_error: plain_sd.map(|sd| left * sd / (tally.count as f64).sqrt()),
        quantiles: quantiles.iter().filter_map(|share| quantile(&ranked, *share)).collect(),
        undefined: tally.undefined,
        control: control.map(|c| c.beta),
        resolution: resolution(tally, symmetric),
    }
}

fn quantile(ranked: &Ranked<'_>, share: f64) -> Option<[f64; 3]> {
    let value = ranked.quantile(share)?;
    Some([share, value, ranked.standard_error(share * ranked.len() as f64 + 0.5)])
}

fn resolution(tally: &Tally, coverage: Option<Coverage>) -> f64 {
    let (Store::Counts(histogram), Some(coverage)) = (&tally.store, coverage) else { return 0.0 };
    let width = |value: f64| {
        let [lo, hi] = histogram.bins.ends(histogram.bins.bin(value));
        hi - lo
    };
    width(coverage.interval.lo).max(width(coverage.interval.hi))
}

/// Shares of the curved classes, and of the replicates without a class.
pub fn class_shares(state: &StudyState) -> (Vec<(ShapeClass, f64)>, f64) {
    let total = state.done() as f64;
    if total == 0.0 {
        return (Vec::new(), 0.0);
    }
    let counts = ShapeClass::CURVED.into_iter().zip(&state.classes);
    let shares = counts.map(|(class, count)| (class, *count as f64 / total)).collect();
    (shares, (state.done() - state.classes.iter().sum::<u64>()) as f64 / total)
}
