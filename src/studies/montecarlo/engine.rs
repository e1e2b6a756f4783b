//! The path from a replicate's number to its S and R, chosen by the scene.
//!
//! ```text
//! fixed sites    sites stand still, rows are linear (or linearised): one factor for all replicates       LinearRows
//! refit          sites move, rows are linear with known weights: one small fit a replicate               Refit
//! whole          robust losses, weights or noise sds found with the fit, parametric surfaces:            FittedSurface::of
//! ```
//!
//! Numbers come in blocks of [`REPLICATES`] replicates that begin at multiples of it; a replicate's own do not depend on which of
//! its neighbours are asked for, nor on the number of threads.

use super::control::LinearControl;
use super::error::StudyError;
use super::evaluator::Evaluator;
use super::full_refit::Whole;
use super::linear_rows::{LinearRows, direct_lane};
use super::noise_free_draws::AtRest;
use super::problem::Problem;
use super::quantity::Quantity;
use super::refit::Refit;
use super::strategy::{Path, choose, row_noise};
use palpate_fitting::fit::{Fit, FitOptions, OutsideDomain, SurfaceKind};
use palpate_fitting::fit::{FitError, fit_contacts};
use palpate_geometry::contact::Contacts;
use palpate_geometry::shape::ShapeGrid;
use palpate_numeric::draws::EffectDraws;
use palpate_numeric::simd::{Isa, REPLICATES};
use palpate_numeric::threads;
use palpate_world::scene::{ContactBatch, Simulator};

/// Where the random numbers of each stage come from: its addressed draws unless told otherwise.
pub(super) type Draws<'a> = &'a (dyn Fn(usize) -> EffectDraws + Sync);

/// Values of some replicates.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Values {
    /// Number of the first replicate.
    pub first: u64,
    /// `columns[quantity][replicate]`; NaN where undefined.
    pub columns: Vec<Vec<f64>>,
    /// Replicates whose fit failed, and why.
    pub failed: Vec<(u64, String)>,
    /// Replicates whose contacts a whole fit could not tell from a plane.
    pub planes: u64,
    /// The linear law of S and of R in each replicate, in standard deviations, where it was asked for.
    pub control: Vec<Vec<f64>>,
}

/// A scene's replicates, ready to be computed.
#[derive(Debug)]
pub struct Engine {
    simulator: Simulator,
    path: Path,
    why: String,
    quantities: Vec<Quantity>,
    kind: Kind,
    /// Values without noise.
    nominal: Vec<f64>,
    domain: [f64; 4],
    surface_fit: Option<Fit>,
}

#[derive(Debug)]
enum Kind {
    Linear { problem: Problem, rows: Box<LinearRows>, evaluator: Evaluator },
    Refit { problem: Problem, evaluator: Evaluator },
    Whole(Box<Whole>),
}

/// Output of one block.
struct Computed {
    /// Quantities, and behind them the control's where it was asked for.
    values: Vec<[f64; REPLICATES]>,
    failed: Vec<(usize, String)>,
    planes: [bool; REPLICATES],
}

impl Engine {
    /// Chooses the path for this scene; `only` forces one, where it can be had.
    ///
    /// # Errors
    /// A path that cannot be had, and every error of a fit that the nominal contacts have already.
    pub fn new(
        simulator: Simulator,
        options: &FitOptions,
        others: &[Quantity],
        only: Option<Path>,
    ) -> Result<Engine, StudyError> {
        options.check()?;
        let mut quantities = vec![Quantity::ShapeIndex, Quantity::Curvedness];
        quantities.extend(others.iter().filter(|q| !matches!(q, Quantity::ShapeIndex | Quantity::Curvedness)));
        let contacts = nominal_contacts(&simulator);
        let mut options = options.clone();
        let domain = options.domain.unwrap_or_else(|| extent(&contacts));
        if options.surface == SurfaceKind::Height {
            options.domain = Some(domain);
            options.outside = OutsideDomain::Extend;
        }
        let (mut wanted, mut why) = choose(&simulator, &options);
        let nominal =
            if options.surface == SurfaceKind::Height { fit_contacts(&contacts, &options).ok() } else { None };
        let problem = match (&nominal, wanted) {
            (_, Path::Whole) => None,
            (Some(fit), _) => match Problem::new(fit, &contacts) {
                Ok(problem) => Some(problem),
                Err(reason) => {
                    (wanted, why) = (Path::Whole, reason.to_string());
                    None
                }
            },
            (None, _) => {
                (wanted, why) = (Path::Whole, "the nominal contacts cannot be fitted".into());
                None
            }
        };
        if let Some(only) = only.filter(|only| *only != wanted) {
            let allowed = only == Path::Whole || (only == Path::Refit && wanted == Path::FixedSites);
            if !allowed {
                return Err(StudyError::Path { asked: only.name(), why });
            }
            (wanted, why) = (only, "asked for".into());
        }
        let kind = match (wanted, problem) {
            (Path::FixedSites | Path::Linearised, Some(problem)) => {
                let rows = LinearRows::new(&problem, row_noise(&simulator, &problem))?;
                let evaluator = evaluator(&problem, &options, &quantities, rows.nominal(), nominal.as_ref());
                Kind::Linear { problem, rows: Box::new(rows), evaluator }
            }
            (Path::Refit, Some(problem)) => {
                let (.., c) = problem.factored()?;
                let evaluator = evaluator(&problem, &options, &quantities, &c, nominal.as_ref());
                Kind::Refit { problem, evaluator }
            }
            _ => Kind::Whole(Box::new(Whole::new(options.clone(), quantities.clone()))),
        };
        let mut engine = Engine {
            simulator,
            path: wanted,
            why,
            quantities,
            kind,
            nominal: Vec::new(),
            domain,
            surface_fit: nominal,
        };
        let rest = AtRest::shared(&engine.simulator);
        let at_rest = engine.values_from(&|stage| EffectDraws::from_source(rest[stage].clone()), 0, 1);
        if let (Some((_, reason)), true) = (at_rest.failed.first(), engine.simulator.stages().is_empty()) {
            // without any effect every replicate is this one
            return Err(StudyError::Nominal { reason: reason.clone() });
        }
        engine.nominal = at_rest.columns.iter().map(|column| column[0]).collect();
        Ok(engine)
    }

    /// The path taken.
    pub fn path(&self) -> Path {
        self.path
    }

    /// Why that one.
    pub fn why(&self) -> &str {
        &self.why
    }

    /// What is asked of every replicate, S and R first.
    pub fn quantities(&self) -> &[Quantity] {
        &self.quantities
    }

    /// The values without noise, quantity by quantity.
    pub fn nominal(&self) -> &[f64] {
        &self.nominal
    }

    /// The simulated world.
    pub fn simulator(&self) -> &Simulator {
        &self.simulator
    }

    /// The fit of the contacts without noise, where there is one as a height field.
    pub fn nominal_fit(&self) -> Option<&Fit> {
        self.surface_fit.as_ref()
    }

    /// The domain that stands still, input units.
    pub fn domain(&self) -> [f64; 4] {
        self.domain
    }

    /// The linear law as a control of S and R, where it is known exactly.
    pub fn control(&self) -> Option<LinearControl> {
        let Kind::Linear { rows, evaluator, .. } = &self.kind else { return None };
        LinearControl::new(rows, evaluator)
    }

    /// Values of `count` replicates from `first` on, under `seed`.
    pub fn values(&self, seed: u64, first: u64, count: usize) -> Values {
        self.values_beside(None, seed, first, count)
    }

    /// The same, with the control's values beside them where there is a control of this engine.
    pub fn values_beside(&self, control: Option<&LinearControl>, seed: u64, first: u64, count: usize) -> Values {
        let draws = |stage: usize| self.simulator.draws(stage, seed);
        let Kind::Linear { rows, evaluator, .. } = &self.kind else { return self.values_from(&draws, first, count) };
        if !rows.is_direct() {
            return self.values_from(&draws, first, count);
        }
        let isa = Isa::active();
        let own = draws(0);
        self.blocks(first, count, Vec::new, |start, c: &mut Vec<[f64; REPLICATES]>| {
            c.resize(rows.nominal().len(), [0.0; REPLICATES]);
            rows.direct(isa, &own, start, c);
            let mut values = vec![[f64::NAN; REPLICATES]; self.quantities.len()];
            evaluator.block(isa, c, &mut values);
            values.extend(control.into_iter().flat_map(|control| control.block(c)));
            for row in &mut values {
                let lanes = *row;
                (0..REPLICATES).for_each(|k| row[k] = lanes[direct_lane(k)]);
            }
            Computed { values, failed: Vec::new(), planes: [false; REPLICATES] }
        })
    }

    /// The same with the random numbers of each stage from wherever `draws` says.
    pub fn values_from(&self, draws: Draws<'_>, first: u64, count: usize) -> Values {
        let isa = Isa::active();
        let none = || vec![[f64::NAN; REPLICATES]; self.quantities.len()];
        match &self.kind {
            Kind::Linear { problem, rows, evaluator } => self.blocks(
                first,
                count,
                || (ContactBatch::default(), vec![[0.0; REPLICATES]; rows.nominal().len()]),
                |start, (batch, c)| {
                    self.simulator.simulate_batch_from(draws, start, REPLICATES, batch);
                    rows.coefficients(isa, problem, batch, c);
                    let mut values = none();
                    evaluator.block(isa, c, &mut values);
                    Computed { values, failed: Vec::new(), planes: [false; REPLICATES] }
                },
            ),
            Kind::Refit { problem, evaluator } => {
                let unknowns = problem.knots()[0].n_basis() * problem.knots()[1].n_basis();
                self.blocks(
                    first,
                    count,
                    || {
                        (
                            ContactBatch::default(),
                            Refit::new(problem),
                            vec![0.0; unknowns],
                            vec![[0.0; REPLICATES]; unknowns],
                        )
                    },
                    |start, (batch, refit, own, c)| {
                        self.simulator.simulate_batch_from(draws, start, REPLICATES, batch);
                        let mut failed = Vec::new();
                        for lane in 0..REPLICATES {
                            let done = match refit {
                                Ok(refit) => refit.coefficients(problem, batch, lane, own),
                                Err(error) => Err(error.clone()),
                            };
                            if let Err(error) = done {
                                failed.push((lane, error.to_string()));
                                own.fill(0.0);
                            }
                            c.iter_mut().zip(own.iter()).for_each(|(lanes, value)| lanes[lane] = *value);
                        }
                        let mut values = none();
                        evaluator.block(isa, c, &mut values);
                        for (lane, _) in &failed {
                            values.iter_mut().for_each(|row| row[*lane] = f64::NAN);
                        }
                        Computed { values, failed, planes: [false; REPLICATES] }
                    },
                )
            }
            Kind::Whole(whole) => {
                // a block of whole fits is a second's work: they are shared among the threads one by one
                let start = first - first % REPLICATES as u64;
                let mut values = self.empty(first, count);
                let end = first + count as u64;
                for start in (start..end).step_by(REPLICATES) {
                    let mut batch = ContactBatch::default();
                    self.simulator.simulate_batch_from(draws, start, REPLICATES, &mut batch);
                    let skipped = first.saturating_sub(start) as usize;
                    let wanted = (end - start).min(REPLICATES as u64) as usize - skipped;
                    let found = threads::map(wanted, 1, |k| {
                        let lane = skipped + k;
                        (lane, whole.values(self.simulator.contacts_of(&batch, lane)))
                    });
                    for (lane, outcome) in found {
                        match outcome {
                            Ok((own, plane)) => {
                                values.planes += u64::from(plane);
                                values.columns.iter_mut().zip(own).for_each(|(column, value)| column.push(value));
                            }
                            Err(error) => {
                                values.failed.push((start + lane as u64, error.to_string()));
                                values.columns.iter_mut().for_each(|column| column.push(f64::NAN));
                            }
                        }
                    }
                }
                values
            }
        }
    }

    fn empty(&self, first: u64, count: usize) -> Values {
        let columns = self.quantities.iter().map(|_| Vec::with_capacity(count)).collect();
        Values { first, columns, ..Values::default() }
    }

    /// Blocks on all threads, put together in their order.
    fn blocks<T: Send>(
        &self,
        first: u64,
        count: usize,
        scratch: impl Fn() -> T + Sync + Send,
        compute: impl Fn(u64, &mut T) -> Computed + Sync + Send,
    ) -> Values {
        let lanes = REPLICATES as u64;
        let (from, end) = (first / lanes, (first + count as u64).div_ceil(lanes));
        let computed = threads::map_with((end - from) as usize, 8, scratch, |own, block| {
            compute((from + block as u64) * lanes, own)
        });
        let mut out = self.empty(first, count);
        for (k, block) in computed.into_iter().enumerate() {
            let start = (from + k as u64) * lanes;
            let lo = first.saturating_sub(start) as usize;
            let hi = (first + count as u64 - start).min(lanes) as usize;
            let rows = block.values.iter().map(|row| &row[lo..hi]);
            out.control.resize_with(block.values.len() - out.columns.len(), || Vec::with_capacity(count));
            let columns = out.columns.iter_mut().chain(&mut out.control);
            columns.zip(rows).for_each(|(column, row)| column.extend_from_slice(row));
            let failed = block.failed.into_iter().filter(|(lane, _)| (lo..hi).contains(lane));
            out.failed.extend(failed.map(|(lane, why)| (start + lane as u64, why)));
            out.planes += block.planes[lo..hi].iter().filter(|plane| **plane).count() as u64;
        }
        out
    }
}

/// The contacts with every effect at rest: what is wrong with them is wrong in every replicate.
pub(super) fn nominal_contacts(simulator: &Simulator) -> Contacts {
    let rest = AtRest::shared(simulator);
    let mut batch = ContactBatch::default();
    simulator.simulate_batch_from(&|stage| EffectDraws::from_source(rest[stage].clone()), 0, 1, &mut batch);
    simulator.contacts_of(&batch, 0).0
}

fn extent(contacts: &Contacts) -> [f64; 4] {
    let ends =
        |values: &[f64]| values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(*v), hi.max(*v)));
    let ((x0, x1), (y0, y1)) = (ends(&contacts.x), ends(&contacts.y));
    [x0, x1, y0, y1]
}

fn evaluator(
    problem: &Problem,
    options: &FitOptions,
    quantities: &[Quantity],
    nominal: &[f64],
    fit: Option<&Fit>,
) -> Evaluator {
    let knots = problem.knots().clone();
    let domain = [knots[0].domain(), knots[1].domain()];
    let grid = ShapeGrid::over(domain, options.grid, options.inset);
    let frame = fit.map_or(palpate_geometry::contact::Frame::IDENTITY, |fit| *fit.frame());
    Evaluator::new(knots, frame, &grid, quantities.to_vec(), nominal)
}

impl From<FitError> for StudyError {
    fn from(error: FitError) -> StudyError {
        StudyError::Nominal { reason: error.to_string() }
    }
}
