//! Does the interval that a fit prints hold the truth as often as it says?
//!
//! ```text
//! for each replicate: simulate, fit as `palpate fit` would, ask       inside/asked with its binomial interval
//! linear        noise alone: the interval of the fit itself (delta method)
//! named         the interval that is printed when the model is named: noise, and what other kinds of surface say
//! Monte Carlo   [y - (q_hi - y0), y - (q_lo - y0)]     y the fit's value; y0 and the quantiles q the study's of this scene
//! chosen        the interval that the fit prints when no model is named, the contacts being recognised
//! ```
//!
//! The Monte Carlo's interval carries the errors of the study to the fit at hand. Neither it nor the linear one knows of the
//! error of the model itself: where a spline is no sphere, both miss, and the bias beside the noise says why. C. J. Clopper, E. S.
//! Pearson, *Biometrika* 26 (1934) 404.

use statrs::distribution::{Beta, ContinuousCDF};

use super::study::Study;
use super::summary::Summary;
use palpate_fitting::fit::{Fit, FitOptions};
use palpate_fitting::parametric::{FittedSurface, ParametricShape};
use palpate_geometry::curvature::ShapeClass;
use palpate_geometry::shape::{Interval, compare_with_truth, spread};
use palpate_inference::recognition::{Recognition, RecognitionOptions};
use palpate_numeric::statistics::upper_median;
use palpate_world::scene::Truth;

/// How often one kind of interval of one quantity held the truth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Held {
    /// Intervals that held it.
    pub inside: u64,
    /// Intervals that were printed where there is a truth.
    pub asked: u64,
    /// 95 % binomial interval of the share; `None` where nothing was asked.
    pub interval: Option<Interval>,
}

impl Held {
    fn new(inside: u64, asked: u64) -> Held {
        Held { inside, asked, interval: (asked > 0).then(|| clopper_pearson(inside, asked)) }
    }

    /// Share of the intervals that held the truth.
    pub fn share(&self) -> Option<f64> {
        (self.asked > 0).then(|| self.inside as f64 / self.asked as f64)
    }
}

/// The coverage of one scene's intervals.
#[derive(Clone, Debug, PartialEq)]
pub struct Coverages {
    /// Replicates that were fitted.
    pub fitted: u64,
    /// Replicates whose fit failed.
    pub failed: u64,
    /// Fits that could not be told from a plane, and print no interval of S.
    pub planes: u64,
    /// Of the linear intervals of S and of R.
    pub linear: [Held; 2],
    /// Of the Monte Carlo's.
    pub monte_carlo: [Held; 2],
    /// Of the intervals that are printed when the model is named.
    pub named: [Held; 2],
    /// Median half width of those intervals.
    pub named_half_width: [Option<f64>; 2],
    /// Of the intervals that are printed when no model is named.
    pub chosen: [Held; 2],
    /// Median half width of those intervals over 1.96 sd of their values, for S and R.
    pub chosen_width: [Option<f64>; 2],
    /// Median half width of those intervals.
    pub chosen_half_width: [Option<f64>; 2],
    /// Errors of their values: value - truth of S, (value - truth)/truth of R.
    pub chosen_errors: [Vec<f64>; 2],
    /// Mean probability that the reported class was given, and the share in which it is the true one.
    pub class_forecast: Option<[f64; 2]>,
    /// (noise-free value - truth)/sd of S and of R: how far the model's own error stands out of the noise.
    pub bias: [Option<f64>; 2],
    /// Median u that the fit states over the sd of its values, for S and R.
    pub u_ratio: [Option<f64>; 2],
}

/// Of `n` trials `k` came true: the shares that are not refuted at 5 %.
fn clopper_pearson(k: u64, n: u64) -> Interval {
    let (k, n) = (k as f64, n as f64);
    let quantile = |a: f64, b: f64, p: f64| Beta::new(a, b).map_or(f64::NAN, |law| law.inverse_cdf(p));
    let lo = if k == 0.0 { 0.0 } else { quantile(k, n - k + 1.0, 0.025) };
    let hi = if k == n { 1.0 } else { quantile(k + 1.0, n - k, 0.975) };
    Interval { lo, hi }
}

/// One fit: truth, value, stated interval and u of S and of R; the interval that counts other kinds of surface, too.
#[derive(Clone, Copy, Debug, Default)]
struct FitOutcome {
    truth: [Option<f64>; 2],
    value: [Option<f64>; 2],
    interval: [Option<Interval>; 2],
    total: [Option<Interval>; 2],
    u: [Option<f64>; 2],
    plane: bool,
}

/// What the replicates so far came to, in their order.
#[derive(Clone, Debug, Default)]
pub struct CoverageTally {
    /// A fit that failed is `None`.
    fits: Vec<Option<FitOutcome>>,
    recognised: Vec<Option<RecognitionOutcome>>,
}

impl CoverageTally {
    /// Replicates that are in it.
    pub fn replicates(&self) -> u64 {
        self.fits.len() as u64
    }

    /// Of replicates `range` of the study's scene, fitted with `options` as they stand, no domain held.
    pub fn of(study: &Study, options: &FitOptions, range: [u64; 2]) -> CoverageTally {
        let simulator = study.engine().simulator();
        let (seed, count) = (study.seed(), range[1].saturating_sub(range[0]) as usize);
        let simulated = |b: usize| simulator.simulate(seed, range[0] + b as u64);
        let fits = palpate_numeric::threads::map(count, 1, |b| {
            let (contacts, truth) = simulated(b);
            match FittedSurface::of(&contacts, options).ok()?.0 {
                FittedSurface::Height(fit) => Some(asked(*fit, &truth)),
                FittedSurface::Parametric(fit) => Some(asked_of_map(fit.shape(), &truth)),
            }
        });
        let recognised = palpate_numeric::threads::map(count, 1, |b| {
            let (contacts, truth) = simulated(b);
            let options = RecognitionOptions {
                level: options.level,
                sigma_xy: options.sigma_xy,
                up: Some([0.0, 0.0, 1.0]),
                ..RecognitionOptions::default()
            };
            Some(told(&Recognition::of(&contacts, &options).ok()?, &truth))
        });
        CoverageTally { fits, recognised }
    }

    /// Takes in the replicates that come next.
    pub fn append(&mut self, mut next: CoverageTally) {
        self.fits.append(&mut next.fits);
        self.recognised.append(&mut next.recognised);
    }

    /// How often the intervals held the truth; `summaries` are those of the study, for S and R.
    pub fn coverages(&self, summaries: &[Summary]) -> Coverages {
        let fitted: Vec<FitOutcome> = self.fits.iter().flatten().copied().collect();
        let recognised: Vec<RecognitionOutcome> = self.recognised.iter().flatten().copied().collect();
        let held = |q: usize, interval: &dyn Fn(&FitOutcome) -> Option<Interval>| {
            let pairs = fitted.iter().filter_map(|fit| Some((fit.truth[q]?, interval(fit)?)));
            let (inside, asked) = pairs.fold((0, 0), |(inside, asked), (truth, i)| {
                (inside + u64::from(i.lo <= truth && truth <= i.hi), asked + 1)
            });
            Held::new(inside, asked)
        };
        let wide = |i: Interval| Interval { lo: i.lo - ROUNDING, hi: i.hi + ROUNDING };
        let both = [0, 1];
        Coverages {
            chosen: both.map(|q| chosen(&recognised, q)),
            chosen_width: both.map(|q| width(&recognised, q)),
            chosen_half_width: both.map(|q| half_width(&recognised, q)),
            chosen_errors: both.map(|q| recognised.iter().filter_map(|t| t.error(q)).collect()),
            class_forecast: forecast(&recognised),
            fitted: fitted.len() as u64,
            failed: self.replicates() - fitted.len() as u64,
            planes: fitted.iter().filter(|fit| fit.plane).count() as u64,
            linear: both.map(|q| held(q, &|fit| fit.interval[q])),
            named: both.map(|q| held(q, &|fit| fit.total[q].map(wide))),
            named_half_width: both
                .map(|q| middle(fitted.iter().filter_map(|fit| fit.total[q].map(|i| 0.5 * (i.hi - i.lo))))),
            monte_carlo: both.map(|q| held(q, &|fit| carried(summaries.get(q)?, fit.value[q]?, q))),
            bias: both.map(|q| {
                let summary = summaries.get(q)?;
                let sd = summary.sd.filter(|sd| *sd > 0.0)?;
                Some((summary.nominal? - summary.truth?) / sd)
            }),
            u_ratio: both.map(|q| {
                let sd = summaries.get(q)?.sd.filter(|sd| *sd > 0.0)?;
                Some(middle(fitted.iter().filter_map(|fit| fit.u[q]))? / sd)
            }),
        }
    }
}

/// Fits `replicates` replicates of the study's scene with `options` as they stand, no domain held.
pub fn coverage(study: &Study, options: &FitOptions, replicates: u64, summaries: &[Summary]) -> Coverages {
    CoverageTally::of(study, options, [0, replicates]).coverages(summaries)
}

/// One recognition: truth, value and interval of S and of R; the probability of its class and whether that is the true one.
#[derive(Clone, Copy, Debug, Default)]
struct RecognitionOutcome {
    truth: [Option<f64>; 2],
    value: [Option<f64>; 2],
    interval: [Option<[f64; 2]>; 2],
    class: (f64, bool),
}

impl RecognitionOutcome {
    /// The error of S, or the relative one of R; `None` where there is no truth, or R is 0.
    fn error(&self, q: usize) -> Option<f64> {
        let (value, truth) = (self.value[q]?, self.truth[q]?);
        let unit = if q == 0 { 1.0 } else { truth };
        (unit > 0.0).then(|| (value - truth) / unit)
    }
}

/// The truth is taken at the places that the means were taken over.
fn told(found: &Recognition, truth: &Truth) -> RecognitionOutcome {
    let [s, r] = true_means(truth, found.averaged.iter().copied());
    let class = s.map_or(ShapeClass::Plane, ShapeClass::of_shape_index);
    let given = found.class_probability.iter().find(|(c, _)| *c == found.class).map_or(0.0, |(_, p)| *p);
    RecognitionOutcome {
        truth: [s, r],
        value: [found.shape_index.map(|e| e.mean), Some(found.curvedness.mean)],
        interval: [found.shape_index.map(|e| e.interval), Some(found.curvedness.interval)],
        class: (given, class == found.class),
    }
}

/// Mean S and R of the true surface at these places.
fn true_means(truth: &Truth, places: impl Iterator<Item = ([f64; 3], [f64; 3])>) -> [Option<f64>; 2] {
    let local: Vec<_> = places.filter_map(|(point, normal)| truth.near(point, normal)).collect();
    let mean = |values: Vec<f64>| (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64);
    [mean(local.iter().filter_map(|l| l.shape_index()).collect()), mean(local.iter().map(|l| l.curvedness()).collect())]
}

/// Rounding of a truth that an interval ends at.
const ROUNDING: f64 = 1e-9;

fn chosen(told: &[RecognitionOutcome], q: usize) -> Held {
    let pairs = told.iter().filter_map(|t| Some((t.truth[q]?, t.interval[q]?)));
    let (inside, asked) = pairs.fold((0, 0), |(inside, asked), (truth, [lo, hi])| {
        (inside + u64::from(lo - ROUNDING <= truth && truth <= hi + ROUNDING), asked + 1)
    });
    Held::new(inside, asked)
}

/// Median half width over 1.96 sd of the values.
fn width(told: &[RecognitionOutcome], q: usize) -> Option<f64> {
    let values: Vec<f64> = told.iter().filter_map(|t| t.value[q]).collect();
    let sd = spread(values.iter().copied()).sd.filter(|sd| *sd > 0.0)?;
    Some(half_width(told, q)? / (1.96 * sd))
}

/// Median half width.
fn half_width(told: &[RecognitionOutcome], q: usize) -> Option<f64> {
    middle(told.iter().filter_map(|t| t.interval[q].map(|[lo, hi]| 0.5 * (hi - lo))))
}

fn middle(values: impl Iterator<Item = f64>) -> Option<f64> {
    upper_median(values.collect::<Vec<f64>>())
}

fn forecast(told: &[RecognitionOutcome]) -> Option<[f64; 2]> {
    let n = told.len() as f64;
    let given = told.iter().map(|t| t.class.0).sum::<f64>() / n;
    (n > 0.0).then(|| [given, told.iter().filter(|t| t.class.1).count() as f64 / n])
}

/// The study's errors about the value of one fit.
fn carried(summary: &Summary, value: f64, quantity: usize) -> Option<Interval> {
    let (ends, nominal) = (summary.symmetric?.interval, summary.nominal?);
    let (floor, ceiling) = if quantity == 0 { (-1.0, 1.0) } else { (0.0, f64::INFINITY) };
    Some(Interval { lo: (value - (ends.hi - nominal)).max(floor), hi: (value - (ends.lo - nominal)).min(ceiling) })
}

fn asked(fit: Fit, truth: &Truth) -> FitOutcome {
    let shape = fit.shape();
    let compared = compare_with_truth(&shape.maps, |[x, y, _]| {
        let local = truth.at(x, y)?.local;
        Some((local.shape_index(), local.curvedness()))
    });
    let statistics = [&shape.shape_index, &shape.curvedness];
    let by_noise = FitOutcome {
        truth: [compared.shape_index, compared.curvedness],
        value: statistics.map(|s| s.mean),
        interval: statistics.map(|s| s.interval),
        total: [None; 2],
        u: statistics.map(|s| s.u),
        plane: shape.class == ShapeClass::Plane,
    };
    let counted = Recognition::beside(fit);
    let shape = counted.shape();
    FitOutcome { total: [shape.shape_index.interval, shape.curvedness.interval], ..by_noise }
}

/// The same of a parametric surface, whose printed interval is the one by noise.
fn asked_of_map(shape: &ParametricShape, truth: &Truth) -> FitOutcome {
    let maps = &shape.maps;
    let supported = maps.supported.indexed_iter().filter(|(_, supported)| **supported);
    let statistics = [&shape.shape_index, &shape.curvedness];
    let interval = statistics.map(|s| s.interval);
    FitOutcome {
        truth: true_means(truth, supported.map(|(at, _)| (maps.points[at], maps.normals[at]))),
        value: statistics.map(|s| s.mean),
        interval,
        total: interval,
        u: statistics.map(|s| s.u),
        plane: shape.class == ShapeClass::Plane,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn binomial_intervals_are_the_published_ones() {
        // Clopper and Pearson's example: 4 of 30
        let i = clopper_pearson(4, 30);
        assert!((i.lo - 0.0376).abs() < 5e-4 && (i.hi - 0.3072).abs() < 5e-4, "{i:?}");
        assert_eq!((clopper_pearson(0, 10).lo, clopper_pearson(10, 10).hi), (0.0, 1.0));
    }
}
