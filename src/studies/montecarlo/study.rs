//! A study from its first replicate to its last: range, stopping, and a caller who watches.

use super::attribution::{self, Attribution, attribute};
use super::control::{ControlTally, LinearControl};
use super::engine::Engine;
use super::engine::Values;
use super::error::StudyError;
use super::linear_law::{self, LinearLaw, linear_law};
use super::options::{StudyOptions, Tolerance};
use super::state::StudyState;
use super::stopping::{batch_size, batches_wanted};
use super::summary::{Summary, class_shares, summarise};
use palpate_fitting::fit::FitOptions;
use palpate_geometry::curvature::ShapeClass;
use palpate_world::scene::Simulator;

/// Points of the grid of a study. A replicate over so many takes as long as a whole fit, and its means have four digits of those of
/// any finer grid.
const MOST_GRID_POINTS: usize = 100_000;

/// Why a study ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stopped {
    /// All replicates asked for are done.
    Replicates,
    /// Both ends of both intervals have the digits asked for.
    Tolerance,
    /// Whoever watches said so: the time is up.
    Budget,
}

impl Stopped {
    /// The word in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Stopped::Replicates => "replicates",
            Stopped::Tolerance => "tolerance",
            Stopped::Budget => "budget",
        }
    }
}

/// What is shown to whoever watches, after every chunk of replicates.
#[derive(Debug)]
pub struct Progress<'a> {
    /// All that is known by now.
    pub state: &'a StudyState,
    /// `columns[quantity][replicate]` of the replicates just done, S and R first; NaN where undefined.
    pub columns: &'a [Vec<f64>],
    /// One past the last replicate there will be, as far as is known.
    pub end: u64,
    /// The replicates just done, with their numbers and failures.
    pub values: &'a Values,
}

/// A scene, its fit, and how often.
#[derive(Debug)]
pub struct Study {
    engine: Engine,
    options: StudyOptions,
    seed: u64,
    truth: [Option<f64>; 2],
    /// The control, where Stein's rule may count on it.
    control: Option<LinearControl>,
}

/// Everything a study says.
#[derive(Clone, Debug, PartialEq)]
pub struct StudyResult {
    /// One summary a quantity, S and R first.
    pub quantities: Vec<Summary>,
    /// Share of each curved class among all replicates, in the order of S.
    pub classes: Vec<(ShapeClass, f64)>,
    /// Share of replicates without a class: S undefined, or the fit failed.
    pub no_class: f64,
    /// The class whose share reaches the level; `None`: no class does, and none is named.
    pub verdict: Option<ShapeClass>,
    /// The linear law and whether it holds.
    pub linear: LinearLaw,
    /// Shares of the effects; `None` where none was asked for.
    pub attribution: Option<Attribution>,
}

impl Study {
    /// Prepares a study of this world under these options.
    ///
    /// # Errors
    /// Every [`StudyError`] but those of joining parts.
    pub fn new(simulator: Simulator, fit: &FitOptions, options: StudyOptions, seed: u64) -> Result<Study, StudyError> {
        options.check()?;
        check_grid(fit.grid)?;
        let engine = Engine::new(simulator, fit, &options.quantities, options.path)?;
        let truth = truth(&engine);
        // the Guide's own rule is left as the Guide has it
        let stein = matches!(options.tolerance, Some(Tolerance::Stein(_)));
        let control = if stein { engine.control() } else { None };
        Ok(Study { engine, options, seed, truth, control })
    }

    /// The engine.
    pub fn engine(&self) -> &Engine {
        &self.engine
    }

    /// The options.
    pub fn options(&self) -> &StudyOptions {
        &self.options
    }

    /// The seed.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// True mean S and R over the shape grid, where the surface has them.
    pub fn truth(&self) -> [Option<f64>; 2] {
        self.truth
    }

    /// A state in which nothing was seen, from replicate `from` on.
    pub fn start(&self, from: u64) -> StudyState {
        let mut state = StudyState::new(&self.engine, self.seed, &self.options, from);
        state.control = self.control.as_ref().map(|_| ControlTally::default());
        state
    }

    /// Runs from where `state` stands up to replicate `to`, or until the tolerance is met where there is one. `watch` is
    /// shown every chunk and ends the run by saying `false`.
    ///
    /// # Errors
    /// [`StudyError::Tolerance`] when the first stage says that more replicates are needed than are allowed.
    pub fn run(
        &self,
        mut state: StudyState,
        to: u64,
        watch: &mut dyn FnMut(&Progress<'_>) -> bool,
    ) -> Result<(StudyState, Stopped), StudyError> {
        let batch = batch_size(self.options.level, self.control.is_some());
        loop {
            let mut end = to;
            if let Some(tolerance) = self.options.tolerance {
                let wanted = batches_wanted(tolerance, &state.batches);
                end = state.from + wanted * batch;
                if state.to >= end {
                    return Ok((state, Stopped::Tolerance));
                }
                if end > to {
                    return Err(StudyError::Tolerance {
                        digits: tolerance.digits(),
                        needed: end - state.from,
                        allowed: to - state.from,
                        raise: "--replicates",
                    });
                }
            } else if state.to >= to {
                return Ok((state, Stopped::Replicates));
            }
            let left = end - state.to;
            // estimates are made of whole batches, as long as the rule looks at them
            let looks = self.options.tolerance.is_some_and(|t| batches_wanted(t, &state.batches) <= 10 || t.looks_on());
            let count = if looks { batch.min(left) } else { self.engine.path().chunk().min(left) };
            let control = self.control.as_ref().filter(|_| state.control.is_some());
            let values = self.engine.values_beside(control, self.seed, state.to, count as usize);
            if looks {
                state.look(&values, self.options.level);
            }
            state.take(&values, self.options.level);
            let progress = Progress { state: &state, columns: &values.columns, end, values: &values };
            if !watch(&progress) {
                return Ok((state, Stopped::Budget));
            }
        }
    }

    /// Everything that can be said; `attribution` is the number of replicates for the shares of the effects, 0 for none.
    pub fn result(&self, state: &StudyState, attribution: usize) -> StudyResult {
        let mut result = self.replicates_alone(state);
        result.linear = linear_law(&self.engine, self.options.level, &result.quantities);
        result.attribution = (attribution > 0).then(|| attribute(&self.engine, self.seed, attribution, &result.linear));
        result
    }

    /// Replicates that the linear law takes beside those of the study.
    pub fn replicates_of_law(&self) -> usize {
        linear_law::replicates_taken(self.engine.simulator())
    }

    /// Replicates that the shares of the effects take at least.
    pub fn replicates_of_shares(&self) -> usize {
        attribution::least_replicates(self.engine.simulator())
    }

    /// Replicates of each design for the shares of the effects that can be had with so many in all.
    pub fn attribution_within(&self, replicates: u64) -> usize {
        attribution::affordable(self.engine.simulator(), replicates)
    }

    /// What the replicates say, without any further fit: no linear law and no shares of the effects.
    pub fn replicates_alone(&self, state: &StudyState) -> StudyResult {
        let (level, quantiles) = (self.options.level, &self.options.quantiles);
        let truths = self.truth.into_iter().chain(std::iter::repeat(None));
        let control = |q: usize| {
            let control = state.control.as_ref().filter(|control| q < 2 && control.seen() == state.done())?;
            Some(control.correction(q, level, state.tallies[q].sd()?.powi(2)))
        };
        let quantities: Vec<Summary> = state
            .tallies
            .iter()
            .zip(truths)
            .zip(self.engine.nominal())
            .enumerate()
            .map(|(q, ((tally, truth), nominal))| summarise(tally, level, quantiles, truth, *nominal, control(q)))
            .collect();
        let (classes, no_class) = class_shares(state);
        let verdict = classes.iter().find(|(_, share)| *share >= level).map(|(class, _)| *class);
        StudyResult { quantities, classes, no_class, verdict, linear: LinearLaw::default(), attribution: None }
    }
}

/// True means over the grid of the patch that stands still; where its axes are not the input's, the mean over the touched
/// points, if the surface is everywhere the same.
fn truth(engine: &Engine) -> [Option<f64>; 2] {
    let truth = engine.simulator().truth();
    if let Some(fit) = engine.nominal_fit().filter(|fit| fit.frame().keeps_axes()) {
        let grid = &fit.shape().maps.grid;
        let points = grid.x.iter().flat_map(|x| grid.y.iter().map(move |y| [*x, *y]));
        let mean = truth.mean_over(points);
        return mean;
    }
    let constant = |values: Vec<Option<f64>>| {
        let first = values.first().copied().flatten()?;
        values.iter().all(|v| v.is_some_and(|v| (v - first).abs() <= 1e-9 * first.abs())).then_some(first)
    };
    let points = 0..truth.points.len();
    [
        constant(points.clone().map(|r| truth.shape_index(r)).collect()),
        constant(points.map(|r| Some(truth.curvedness(r))).collect()),
    ]
}
/// Refuses a grid that every replicate would be taken over for nothing.
fn check_grid([x, y]: [usize; 2]) -> Result<(), StudyError> {
    if x.saturating_mul(y) <= MOST_GRID_POINTS {
        return Ok(());
    }
    let expected = "at most 10^5 points in a study, which takes means over them in every replicate: those of a finer grid hardly differ";
    Err(StudyError::Option { option: "grid", value: format!("{x}x{y}"), expected: expected.into() })
}
