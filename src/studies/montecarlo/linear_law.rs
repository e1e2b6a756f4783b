//! The law of propagation of uncertainty beside the Monte Carlo: what a delta method says, and whether it holds.
//!
//! ```text
//! u^2 = sum_e sum_k (dy/dn_ek)^2        n_ek the random numbers of effect e, each of mean 0 and sd 1
//! dy/dn = (y(h) - y(-h))/(2 h)          y by the whole path: contacts, fit, curvatures, mean over the grid
//! h = 0.05; 1 where that gives another variance: readings that come in steps have a derivative of 0 or of a spike
//! valid where both ends of y +- k u lie within delta of the Monte Carlo's              JCGM 101:2008, clause 8
//! ```
//!
//! The scene's own covariance enters by the effects themselves: errors that hold on along a finger, errors that move a
//! site and the normal with it. delta is that of one significant digit of u.

use std::sync::Arc;

use statrs::function::erf;

use super::engine::Engine;
use super::noise_free_draws::{AtRest, Poked};
use super::stopping::numerical_tolerance;
use super::summary::Summary;
use palpate_geometry::shape::Interval;
use palpate_numeric::draws::{DrawSource, EffectDraws};
use palpate_world::scene::Simulator;

/// Half the step of a difference in standard deviations: its error is that share squared of a third derivative.
const SHORT_STEP: f64 = 0.05;
/// Half the step over readings that come in steps of their own: the noise's own size, which crosses as many of them as the
/// noise does.
const LONG_STEP: f64 = 1.0;
/// A variance that differs by more between both steps is one of stepped readings: a smooth effect of so many numbers, each a
/// small part of the whole, hardly bends over one standard deviation.
const BEND: f64 = 1.25;
/// Most random numbers that are differentiated: each costs two replicates.
const MOST_NUMBERS: usize = 200_000;

/// The linear law of S and of R.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LinearLaw {
    /// Standard uncertainty of S and of R; `None` where it could not be had.
    pub sd: [Option<f64>; 2],
    /// Interval of S and of R.
    pub interval: [Option<Interval>; 2],
    /// Variance of S and of R from each random stage.
    pub by_stage: Vec<(&'static str, [f64; 2])>,
    /// It agrees with the Monte Carlo, quantity by quantity.
    pub valid_parts: [bool; 2],
    /// Why, or why not.
    pub why: String,
}

impl LinearLaw {
    /// Both quantities agree.
    pub fn valid(&self) -> bool {
        self.valid_parts == [true; 2]
    }
}

/// Replicates that the law of this scene takes: a pair for each random number at either step.
pub(super) fn replicates_taken(simulator: &Simulator) -> usize {
    let contacts = simulator.sites().len();
    let numbers =
        simulator.stages().iter().filter(|stage| !stage.jumps()).map(|stage| contacts * stage.draws_per_contact());
    numbers.filter(|numbers| *numbers <= MOST_NUMBERS).map(|numbers| 2 * 2 * numbers).sum()
}

/// Differentiates the replicates of `engine` and holds the law against the Monte Carlo's summaries.
pub fn linear_law(engine: &Engine, level: f64, monte_carlo: &[Summary]) -> LinearLaw {
    let mut law = LinearLaw::default();
    let mut reasons: Vec<String> = Vec::new();
    let contacts = engine.simulator().sites().len();
    let rest = AtRest::shared(engine.simulator());
    let mut stepped = Vec::new();
    for (number, stage) in engine.simulator().stages().iter().enumerate() {
        let per = stage.draws_per_contact();
        if per == 0 {
            continue;
        }
        if stage.jumps() {
            reasons.push(format!("{} has no derivative", stage.name()));
            continue;
        }
        if contacts * per > MOST_NUMBERS {
            reasons.push(format!("{} draws {} numbers, too many to differentiate", stage.name(), contacts * per));
            continue;
        }
        let variances = |h: f64| {
            let poked: Arc<dyn DrawSource> = Arc::new(Poked { per, h, rest: stage.rest(), tilts: stage.tilts() });
            let draws =
                |own: usize| EffectDraws::from_source(if own == number { poked.clone() } else { rest[own].clone() });
            let values = engine.values_from(&draws, 0, 2 * contacts * per);
            [0, 1].map(|q| variance(&values.columns[q], h))
        };
        let (short, long) = (variances(SHORT_STEP), variances(LONG_STEP));
        let bends = (0..2).any(|q| short[q] > BEND * long[q] || long[q] > BEND * short[q]);
        if bends {
            stepped.push(stage.name());
        }
        law.by_stage.push((stage.name(), if bends { long } else { short }));
    }
    let complete = reasons.is_empty();
    let k = std::f64::consts::SQRT_2 * erf::erf_inv(level);
    for (q, (name, floor, ceiling)) in [("S", -1.0, 1.0), ("R", 0.0, f64::INFINITY)].into_iter().enumerate() {
        let nominal = engine.nominal().get(q).copied().unwrap_or(f64::NAN);
        let sd = law.by_stage.iter().map(|(_, v)| v[q]).sum::<f64>().sqrt();
        if !(nominal.is_finite() && sd.is_finite()) {
            reasons.push(format!("{name} is undefined without noise"));
            continue;
        }
        let (lo, hi) = ((nominal - k * sd).max(floor), (nominal + k * sd).min(ceiling));
        (law.sd[q], law.interval[q]) = (Some(sd), Some(Interval { lo, hi }));
        // the law itself knows of no bounds, and is judged as it is
        match compare(monte_carlo.get(q), [nominal - k * sd, nominal + k * sd], sd) {
            Ok(()) => law.valid_parts[q] = complete,
            Err(why) => reasons.push(format!("{name}: {why}")),
        }
    }
    law.why = if reasons.is_empty() {
        "both ends of S and of R agree with the Monte Carlo to one digit of u".into()
    } else {
        reasons.join("; ")
    };
    if !stepped.is_empty() {
        law.why += &format!("; {} differenced over one sd, its readings come in steps", stepped.join(", "));
    }
    law
}

/// Sum of the squared derivatives of pairs `+h`, `-h`.
fn variance(column: &[f64], h: f64) -> f64 {
    let (pairs, _) = column.as_chunks::<2>();
    pairs.iter().map(|[up, down]| ((up - down) / (2.0 * h)).powi(2)).sum()
}

fn compare(summary: Option<&Summary>, [lo, hi]: [f64; 2], sd: f64) -> Result<(), String> {
    let Some((summary, coverage, u)) = summary.and_then(|s| Some((s, s.symmetric?, s.sd?))) else {
        return Err("the Monte Carlo has no interval".into());
    };
    if summary.undefined > 0 {
        return Err(format!("undefined in {} replicates", summary.undefined));
    }
    let Some(delta) = numerical_tolerance(u, 1) else {
        return if sd == 0.0 { Ok(()) } else { Err("the Monte Carlo does not vary".into()) };
    };
    let off = [(lo - coverage.interval.lo).abs(), (hi - coverage.interval.hi).abs()];
    if off[0] <= delta && off[1] <= delta {
        return Ok(());
    }
    // JCGM 101, 8.2: the judge must be five times finer than what is judged
    let [a, b] = coverage.standard_error.map(|se| 2.0 * se > delta);
    let coarse = if a || b { " (the Monte Carlo's own ends are not converged to delta)" } else { "" };
    Err(format!("its ends are {:.2e} and {:.2e} off, delta is {delta:.0e}{coarse}", off[0], off[1]))
}
