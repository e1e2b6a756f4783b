//! The third frontier: where the interval of S and R comes from, how far its ends are off, and how often it holds the truth.
//!
//! ```text
//! reference     quantiles q of many replicates:   [y - (q_hi - y0), y - (q_lo - y0)]     y of a replicate, y0 without noise
//! linear        the interval that a fit prints (delta method)
//! recognised    the interval that is printed where no model is named
//! Monte Carlo   the reference's formula with N replicates, or with as many as a stopping rule takes
//! error         root mean square over replicates, S and R, of the farther end's error over the reference's half width
//! ```
//!
//! The recognised surface is another estimator: its interval counts doubt that the reference does not know, and its error
//! says how much wider or narrower it is, not how wrong.

use crate::montecarlo::{Path, Study, StudyOptions, Tolerance};
use palpate_fitting::fit::FitOptions;
use palpate_fitting::parametric::FittedSurface;
use palpate_inference::recognition::{Recognition, RecognitionOptions};
use palpate_numeric::threads;
use palpate_world::scene::World;

use super::FrontierError;
use super::clock::{Call, Limits, Watch, rounds};
use super::errors::share;
use super::pareto;
use super::point::Point;
use super::replicates::{REPLICATES, Touches, is_random};

/// Replicates of the reference, by what one costs.
const MANY_REPLICATES: u64 = 200_000;
const FEW_REPLICATES: u64 = 2_000;
/// Numbers of replicates that are tried.
const NUMBERS: [u64; 4] = [100, 1_000, 10_000, 100_000];
/// The studies have a seed of their own, far from the scene's, and every call of one has replicates of its own.
const OTHER_SEEDS: u64 = 1 << 40;
const APART: u64 = 1 << 22;
/// Rounds of the methods: from tens of microseconds to tens of milliseconds.
const LIMITS: Limits = Limits { least: 4, most: 40, seconds: 12.0, each: 0.6 };

/// What a method gives: an interval of one replicate, or two quantiles of all.
#[derive(Clone, Copy, Debug)]
pub enum StatedInterval {
    /// Of one replicate.
    OfReplicate([Option<[f64; 2]>; 2]),
    /// Of the scene.
    OfScene([Option<[f64; 2]>; 2]),
    /// Nothing.
    Nothing,
}

/// Methods, the replicates that they are tried on, and the reference.
#[derive(Debug)]
pub struct IntervalSubject<'a> {
    touches: Touches,
    options: &'a FitOptions,
    studies: Vec<(String, Study)>,
    /// Values of every replicate and the truths behind them.
    values: Vec<[Option<f64>; 2]>,
    truths: Vec<[Option<f64>; 2]>,
    nominal: [Option<f64>; 2],
    reference: [Option<[f64; 2]>; 2],
}

impl<'a> IntervalSubject<'a> {
    /// Prepares the methods of a scene; `Ok(Err(why))` where nothing in it is random. Without a reference where `counted`.
    ///
    /// # Errors
    /// A scene that cannot be simulated.
    pub fn new(
        world: &World,
        options: &'a FitOptions,
        seed: u64,
        counted: bool,
    ) -> Result<Result<IntervalSubject<'a>, String>, FrontierError> {
        let simulator = world.compile()?;
        if !is_random(&simulator) {
            return Ok(
                Err("nothing in this scene is random, so that no interval has a width to be right about".into()),
            );
        }
        let study = |options_of: StudyOptions| -> Result<Study, String> {
            let simulator = world.compile().map_err(|e| e.to_string())?;
            Study::new(simulator, options, options_of, seed + OTHER_SEEDS).map_err(|e| e.to_string())
        };
        let plain = StudyOptions { level: options.level, ..StudyOptions::default() };
        let first = match study(plain.clone()) {
            Ok(first) => first,
            Err(why) => return Ok(Err(why)),
        };
        let whole = first.engine().path() == Path::Whole;
        let mut studies = Vec::new();
        let most = match first.engine().path() {
            Path::FixedSites | Path::Linearised => 100_000,
            Path::Refit => 10_000,
            Path::Whole => 1_000,
        };
        for count in NUMBERS.into_iter().filter(|count| *count <= most) {
            let options = StudyOptions { replicates: count, replicates_given: true, ..plain.clone() };
            studies.extend(study(options).map(|study| (format!("Monte Carlo {count}"), study)));
        }
        let rules = [(Tolerance::Stein(1), "Stein's rule"), (Tolerance::Adaptive(1), "adaptive")];
        for (tolerance, name) in rules.into_iter().filter(|_| !whole) {
            let options = StudyOptions { tolerance: Some(tolerance), ..plain.clone() };
            studies.extend(study(options).map(|study| (format!("Monte Carlo, {name}, 1 digit"), study)));
        }
        let touches = Touches::new(world, None, seed, if counted { 1 } else { REPLICATES })?;
        let nominal = [0, 1].map(|q| first.engine().nominal().get(q).copied().filter(|v| v.is_finite()));
        let mut subject = IntervalSubject {
            touches,
            options,
            studies,
            values: Vec::new(),
            truths: Vec::new(),
            nominal,
            reference: [None; 2],
        };
        if !counted {
            let count = if whole { FEW_REPLICATES } else { MANY_REPLICATES };
            subject.reference = quantiles(&first, 0, count);
            subject.fit_all();
        }
        Ok(Ok(subject))
    }

    /// Values and truths of every replicate.
    fn fit_all(&mut self) {
        for (contacts, truth) in &self.touches.replicates {
            let fitted = FittedSurface::of(contacts, self.options).ok().map(|(found, _)| found);
            let (value, grid) = match &fitted {
                Some(FittedSurface::Height(fit)) => {
                    let shape = fit.bare_shape();
                    let maps = &shape.maps;
                    let held = maps.supported.indexed_iter().filter(|(_, held)| **held);
                    let grid: Vec<[f64; 2]> = held.map(|((i, j), _)| [maps.grid.x[i], maps.grid.y[j]]).collect();
                    ([shape.shape_index.mean, shape.curvedness.mean], grid)
                }
                _ => ([None; 2], Vec::new()),
            };
            self.values.push(value);
            self.truths.push(truth.mean_over(grid));
        }
    }

    /// Every call: linear, recognised, and the studies.
    pub fn calls(&self) -> Vec<Call<'_, StatedInterval>> {
        let replicates = &self.touches.replicates;
        let contacts = move |number: u64| &replicates[(number % replicates.len() as u64) as usize].0;
        let mut calls: Vec<Call<'_, StatedInterval>> = vec![
            Box::new(move |number| match FittedSurface::of(contacts(number), self.options) {
                Ok((FittedSurface::Height(fit), _)) => {
                    let shape = fit.shape();
                    let both = [shape.shape_index.interval, shape.curvedness.interval];
                    StatedInterval::OfReplicate(both.map(|interval| interval.map(|i| [i.lo, i.hi])))
                }
                _ => StatedInterval::Nothing,
            }),
            Box::new(move |number| {
                let options = RecognitionOptions {
                    level: self.options.level,
                    up: Some([0.0, 0.0, 1.0]),
                    ..RecognitionOptions::default()
                };
                let found = Recognition::of(contacts(number), &options).ok();
                found.map_or(StatedInterval::Nothing, |found| {
                    let s = found.shape_index.map(|estimate| estimate.interval);
                    StatedInterval::OfReplicate([s, Some(found.curvedness.interval)])
                })
            }),
        ];
        for (_, study) in &self.studies {
            calls.push(Box::new(move |number| {
                StatedInterval::OfScene(quantiles(study, (number + 1) * APART, study.options().most()))
            }));
        }
        calls
    }

    fn labels(&self) -> Vec<String> {
        let first = ["linear", "recognised"].map(String::from);
        first.into_iter().chain(self.studies.iter().map(|(label, _)| label.clone())).collect()
    }

    /// Measures every method, on one thread and in at most about so many seconds; those that are not reached are left out.
    pub fn measure(&self, seconds: f64, watch: Watch<'_>) -> Vec<Point> {
        threads::alone(|| self.measure_here(Limits { seconds: seconds.min(LIMITS.seconds), ..LIMITS }, watch))
    }

    fn measure_here(&self, limits: Limits, watch: Watch<'_>) -> Vec<Point> {
        let labels = self.labels();
        let mut found: Vec<Vec<(usize, StatedInterval)>> = vec![Vec::new(); labels.len()];
        let times = rounds(&mut self.calls(), limits, watch, |k, number, given| {
            let replicate = number as usize % self.values.len().max(1);
            if k >= 2 || (number as usize) < self.values.len() {
                found[k].push((replicate, given));
            }
        });
        let reached = (0..labels.len()).filter(|k| times[*k].median.is_finite());
        let mut points: Vec<Point> =
            reached.map(|k| Point { seconds: Some(times[k]), ..self.point(&labels[k], &found[k]) }).collect();
        pareto::mark(&mut points.iter_mut().collect::<Vec<_>>());
        points
    }

    fn point(&self, label: &str, found: &[(usize, StatedInterval)]) -> Point {
        let mut point = Point {
            label: label.into(),
            method: label.into(),
            surface: self.options.surface.name(),
            degree: self.options.degree,
            segments: self.options.segments,
            contacts: self.touches.contacts(),
            replicates: found.len() as u64,
            ..Point::default()
        };
        let errors: Vec<f64> = found.iter().filter_map(|(b, given)| self.error(*b, given)).collect();
        if errors.is_empty() {
            point.failed = Some("no interval of S and R came out".into());
            return point;
        }
        let rms = |values: &mut dyn Iterator<Item = f64>| {
            let (sum, count) = values.fold((0.0, 0.0), |(s, n), v| (s + v * v, n + 1.0));
            (sum / count).sqrt()
        };
        let mean = rms(&mut errors.iter().copied());
        point.error = Some(mean);
        // the rms of n errors is known to 1/sqrt(2 n) of itself, were they gaussian
        let part = 1.96 / (2.0 * errors.len() as f64).sqrt();
        point.error_interval = Some([mean * (1.0 - part).max(0.0), mean * (1.0 + part)]);
        point.coverage = [0, 1].map(|q| share(self.held(found, q).into_iter()));
        point
    }

    /// The reference's or a study's quantiles as an interval of replicate `b`.
    fn carried(&self, b: usize, quantiles: Option<[f64; 2]>, q: usize) -> Option<[f64; 2]> {
        let ([lo, hi], nominal, value) = (quantiles?, self.nominal[q]?, self.values.get(b)?[q]?);
        Some([value - (hi - nominal), value - (lo - nominal)])
    }

    fn interval(&self, b: usize, given: &StatedInterval, q: usize) -> Option<[f64; 2]> {
        match given {
            StatedInterval::OfReplicate(both) => both[q],
            StatedInterval::OfScene(both) => self.carried(b, both[q], q),
            StatedInterval::Nothing => None,
        }
    }

    /// The error of the farther end in units of the reference's half width, root mean square of S and R.
    fn error(&self, b: usize, given: &StatedInterval) -> Option<f64> {
        let of = |q: usize| {
            let (own, right) = (self.interval(b, given, q)?, self.carried(b, self.reference[q], q)?);
            let half = 0.5 * (right[1] - right[0]);
            (half > 0.0).then(|| (own[0] - right[0]).abs().max((own[1] - right[1]).abs()) / half)
        };
        let both: Vec<f64> = [0, 1].into_iter().filter_map(of).collect();
        (!both.is_empty()).then(|| (both.iter().map(|e| e * e).sum::<f64>() / both.len() as f64).sqrt())
    }

    /// Whether intervals hold the truth: of each replicate its own, of the scene's the last one carried to every replicate.
    fn held(&self, found: &[(usize, StatedInterval)], q: usize) -> Vec<bool> {
        let holds = |b: usize, given: &StatedInterval| {
            let ([lo, hi], truth) = (self.interval(b, given, q)?, self.truths.get(b)?[q]?);
            Some(lo <= truth && truth <= hi)
        };
        match found.last() {
            Some((_, given @ StatedInterval::OfScene(_))) => {
                (0..self.values.len()).filter_map(|b| holds(b, given)).collect()
            }
            _ => found.iter().filter_map(|(b, given)| holds(*b, given)).collect(),
        }
    }
}

/// Ends of the symmetric intervals of S and R of the study's replicates from `from` on.
fn quantiles(study: &Study, from: u64, count: u64) -> [Option<[f64; 2]>; 2] {
    let Ok((state, _)) = study.run(study.start(from), from + count, &mut |_| true) else { return [None; 2] };
    let result = study.replicates_alone(&state);
    let ends = |q: usize| result.quantities.get(q)?.symmetric.map(|coverage| coverage.interval);
    [0, 1].map(|q| ends(q).map(|interval| [interval.lo, interval.hi]))
}
