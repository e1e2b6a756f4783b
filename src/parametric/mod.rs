//! A surface in space, `Q(u, v) = sum_ij c_ij N_i(u) M_j(v)`, from contacts that no height field can hold.
//!
//! ```text
//! 1  flatten: (u, v) of every contact from lanes, or from the contacts alone      lanes, flattening
//! 2  start: linear rows, full 3 x 3 blocks                                       start
//! 3  minimise  sum (n^.(P - Q(u)))^2/Z^2 + |n - n^|^2/sigma^2 + lambda E + tau T   descent, problem, foot, fairness
//! 4  Z, sigma, lambda by their variance components                               levels
//! 5  S, R, directions where contacts reach                                       describe, support
//! ```
//!
//! Everything is made of scalar products, so S and R do not change when the contacts are turned in space.

mod bending;
mod cells;
mod certificate;
mod choice;
mod descent;
mod describe;
mod dual;
mod fairness;
mod fingers;
mod fitted;
mod flattening;
mod foot;
mod gather;
mod gradient;

mod levels;
mod parallel;
mod problem;
mod quadrature;
mod robust;
mod start;
mod touches;
mod vector;

use std::sync::OnceLock;

use certificate::Findings;
pub use certificate::ParametricCertificate;
pub use choice::choose_surface;
pub use describe::ParametricShape;
pub use fitted::{FittedSurface, fit_surface};

use crate::bspline::Knots;
use crate::contact::{Contacts, Frame};
use crate::fit::{FitError, FitOptions};
use crate::shape::UvSupport;
use crate::surface::Parametric;
use cells::Cells;
use descent::{Descent, Solver, State};
use fingers::Flat;
use foot::Feet;
use levels::Unknown;
use problem::{Problem, Weights};
use touches::Touches;

/// tau of T: Christoffel symbols of 0.2 over the patch cost as much as one contact at one sigma. The parametrisation
/// follows; 1 lets the corners of noisy patches fold together, 1000 begins to hold back small balls.
const SLACK: f64 = 30.0;
/// alpha of the ties: 0.01 off the flattened place, rms over the contacts, costs as much as one contact at one sigma.
/// With 100 the descent takes hundreds of steps where it takes 20, and a replicate in thirty of noisy balls runs away.
const TIE: f64 = 1e4;
/// Share of the contacts whose normals may be against the surface that was fitted.
const MOST_AGAINST: f64 = 0.1;
/// Times that an estimated fairness is raised tenfold when the surface bends more than was felt.
const MOST_RAISES: usize = 6;
/// Segments of a closed direction where none are asked for: a cubic's curvature of a circle is then off by 2 % at worst.
const ROUND: usize = 12;

/// Noise levels and the weight of fairness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParametricLevels {
    /// Sd of the distance to the surface, input units.
    pub position: f64,
    /// Sd of the normal per tangent axis, degrees.
    pub normal_deg: f64,
    /// lambda of E, patch units.
    pub fairness: f64,
    /// They were found and not declared.
    pub estimated: bool,
}

/// A fitted surface in space.
#[derive(Debug)]
pub struct ParametricFit {
    options: FitOptions,
    frame: Frame,
    surface: Parametric,
    cells: Cells,
    touches: Touches,
    feet: Feet,
    weights: Weights,
    solver: Solver,
    support: UvSupport,
    certificate: ParametricCertificate,
    levels: ParametricLevels,
    residuals: Vec<[f64; 2]>,
    shape: OnceLock<ParametricShape>,
}

/// Fits a surface in space to contacts with normals.
///
/// # Errors
/// Every [`FitError`]: contacts on one curve or of several sheets, normals that change sides, too few of them, a surface
/// that bends more than neighbouring contacts can have felt.
pub fn fit_parametric(contacts: &Contacts, options: &FitOptions) -> Result<ParametricFit, FitError> {
    options.check()?;
    let mut touches = Touches::new(contacts)?;
    let (mut flat, reason) = flatten(&touches, options)?;
    let (frame, knots) = lay_out(&touches, &mut flat, options)?;
    touches.place(frame.origin, frame.scale);
    let cells = Cells::new(knots);
    check_rows(&touches, &cells)?;
    let gauss = quadrature::gauss_points(&cells);
    let (weights, unknown) = levels::first(options.objective, options.smooth, [SLACK, TIE], frame.scale);
    let mut problem = Problem::new(&cells, &touches, &flat.places, &gauss, weights);
    let mut solver = Solver::new(&problem)?;
    let (mut state, mut reached) = descend(&mut problem, &mut solver, &flat, unknown)?;
    let weights = problem.weights;
    let mut weighted = touches.clone();
    if options.robust != crate::fit::Robust::None {
        robust::reweigh(options.robust, &problem, &mut weighted, &mut solver, &mut state, &mut reached)?;
    }
    let mut problem = Problem::new(&cells, &weighted, &flat.places, &gauss, weights);
    let (found, fairness_raised) = felt(&mut problem, &mut solver, &flat, unknown, &mut state, &mut reached)?;
    let weights = problem.weights;
    let (condition, gradient) = certificate::final_factor(&problem, &mut solver, &state)?;
    let residuals = problem.residuals(&state.coefficients, &state.feet);
    let certificate = ParametricCertificate {
        parametrisation: format!("{}{reason}", flat.method),
        equations: equations(&touches),
        unknowns: 3 * cells.shape().coefficients(),
        iterations: reached.steps,
        settled: reached.settled,
        folds_refused: reached.folds_refused,
        smallest_jacobian: found.smallest_jacobian,
        fold_free: found.fold_free,
        lanes_monotone: found.lanes_monotone,
        against: found.against,
        bending: found.bending,
        fairness_raised,
        condition,
        gradient,
    };
    let levels = ParametricLevels {
        position: weights.position * frame.scale,
        normal_deg: weights.normal.to_degrees(),
        fairness: weights.fairness,
        estimated: unknown != Unknown { both: false, common: false, fairness: false },
    };
    let surface = Parametric::from_free(cells.knots().clone(), &state.coefficients)?;
    let support = support(&flat, &state.feet.places, cells.knots());
    Ok(ParametricFit {
        options: options.clone(),
        frame,
        surface,
        feet: state.feet,
        weights,
        solver,
        support,
        certificate,
        levels,
        residuals,
        cells,
        touches: weighted,
        shape: OnceLock::new(),
    })
}

/// What the map tells, its fairness raised until it bends no more than was felt, and how often that was.
///
/// # Errors
/// Normals against the surface; bending that a declared fairness, or none, does not hold back.
fn felt(
    problem: &mut Problem,
    solver: &mut Solver,
    flat: &Flat,
    unknown: Unknown,
    state: &mut State,
    reached: &mut Descent,
) -> Result<(Findings, usize), FitError> {
    let cells = problem.cells;
    let look = |problem: &Problem, state: &State| {
        certificate::findings(problem, state, &support(flat, &state.feet.places, cells.knots()))
    };
    let (mut found, mut raised) = (look(problem, state), 0);
    while !found.is_felt() && unknown.fairness && raised < MOST_RAISES {
        problem.weights.fairness = (10.0 * problem.weights.fairness).max(1.0);
        raised += 1;
        let declared = Unknown { both: false, common: false, fairness: false };
        let (again, descent) = descend(problem, solver, flat, declared)?;
        *state = again;
        *reached = Descent { steps: reached.steps + descent.steps, ..descent };
        found = look(problem, state);
    }
    let contacts = problem.touches.len();
    if found.against as f64 > MOST_AGAINST * contacts as f64 {
        return Err(FitError::Against { against: found.against, contacts });
    }
    if !found.is_felt() {
        return Err(FitError::Runaway { bending: found.bending, most: bending::MOST_BENDING });
    }
    Ok((found, raised))
}

/// From the linear rows down to the minimum, levels and fairness estimated on the way; all steps are counted.
fn descend(
    problem: &mut Problem,
    solver: &mut Solver,
    flat: &Flat,
    unknown: Unknown,
) -> Result<(State, Descent), FitError> {
    let coefficients = start::start(problem, solver, &flat.places)?;
    let mut state = State { coefficients, feet: Feet { places: flat.places.clone() } };
    let weights = problem.weights;
    let mut before = 0;
    if unknown.any() || weights.fairness < levels::FAIRNESS {
        // fairness first, levels after: from a rough start a long way down is a way into a fold
        problem.weights.fairness = weights.fairness.max(levels::FAIRNESS);
        before = solver.descend(problem, &mut state, descent::ON_THE_WAY)?.steps;
        problem.weights = weights;
    }
    let (mut reached, steps) = levels::descend_with_levels(problem, solver, &mut state, unknown)?;
    reached.steps = before + steps;
    Ok((state, reached))
}

/// Lanes where they are known and make a net, else the contacts alone.
fn flatten(touches: &Touches, options: &FitOptions) -> Result<(Flat, String), FitError> {
    let refused = |why: &'static str| FitError::Sheet { contacts: touches.len(), why };
    match fingers::flatten_by_fingers(touches, options.closed) {
        Ok(flat) => Ok((flat, String::new())),
        Err(why) if options.closed != [false; 2] => Err(FitError::Closed { why }),
        Err(why) if touches.labels.is_none() => {
            flattening::flatten_scattered(touches).map(|flat| (flat, format!(": {why}"))).map_err(refused)
        }
        Err(why) => flattening::flatten_scattered(touches)
            .map(|flat| (flat, format!(": {why}")))
            // what the labels say of the lanes is the nearer cause
            .map_err(|_| refused(why)),
    }
}

/// Frame and knots: origin at the mean contact, the larger side of (u, v) two units.
fn lay_out(touches: &Touches, flat: &mut Flat, options: &FitOptions) -> Result<(Frame, [Knots; 2]), FitError> {
    let ends = [0, 1].map(|k| {
        let range = flat.places.iter().map(|p| p[k]);
        let (lo, hi) = range.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
        flat.period[k].map_or([lo, hi], |period| [0.0, period])
    });
    let side = (ends[0][1] - ends[0][0]).max(ends[1][1] - ends[1][0]);
    if !(side > 0.0 && side.is_finite()) || ends.iter().any(|e| e[1] - e[0] <= 1e-6 * side) {
        return Err(FitError::Sheet { contacts: touches.len(), why: "all contacts lie on one curve" });
    }
    let scale = 0.5 * side;
    flat.places.iter_mut().for_each(|p| *p = p.map(|t| t / scale));
    let make = |k: usize, axis: &'static str| {
        let [lo, hi] = ends[k].map(|t| t / scale);
        let (degree, segments) = (options.degree[k], options.segments[k]);
        let made = if options.closed[k] {
            // one segment is the default of open directions and cannot close
            Knots::closed(degree, if segments == 1 { ROUND.max(degree + 1) } else { segments }, lo, hi)
        } else {
            Knots::uniform(degree, segments, lo, hi)
        };
        made.map_err(|source| FitError::Knots { axis, source })
    };
    let knots = [make(0, "u")?, make(1, "v")?];
    Ok((Frame { origin: touches.centre(), scale, ..Frame::IDENTITY }, knots))
}

fn equations(touches: &Touches) -> usize {
    let count = |w: &[f64]| w.iter().filter(|w| **w > 0.0).count();
    count(&touches.position_weight) + 2 * count(&touches.normal_weight)
}

/// Triangles of the feet: cells of the lanes, or the hull.
fn support(flat: &Flat, places: &[[f64; 2]], knots: &[Knots; 2]) -> UvSupport {
    let corners = if flat.triangles.is_empty() {
        let rim = flattening::hull(places);
        (1..rim.len().saturating_sub(1)).map(|k| [rim[0], rim[k], rim[k + 1]]).collect()
    } else {
        flat.triangles.clone()
    };
    let period = [0, 1].map(|k| {
        let [lo, hi] = knots[k].domain();
        knots[k].is_closed().then_some(hi - lo)
    });
    UvSupport::new(corners.iter().map(|t| t.map(|r| places[r])).collect(), period)
}

/// A coefficient has one direction in which contacts feel it.
fn check_rows(touches: &Touches, cells: &Cells) -> Result<(), FitError> {
    let (equations, unknowns) = (equations(touches), cells.shape().coefficients());
    if equations < unknowns {
        return Err(FitError::TooFew { contacts: touches.len(), equations, unknowns });
    }
    Ok(())
}

impl ParametricFit {
    /// The frame the fit worked in: the input's axes, its own origin and unit.
    pub fn frame(&self) -> &Frame {
        &self.frame
    }

    /// The options it was asked with.
    pub fn options(&self) -> &FitOptions {
        &self.options
    }

    /// The surface in patch coordinates.
    pub fn surface(&self) -> &Parametric {
        &self.surface
    }

    /// The surface in input units; u and v are lengths of the input too.
    ///
    /// # Errors
    /// When the input's own rounding leaves no distinct knots.
    pub fn input_surface(&self) -> Result<Parametric, FitError> {
        Ok(self.surface.placed(self.frame.origin, self.frame.scale)?)
    }

    /// Where contacts reach in (u, v), input units.
    pub fn input_support(&self) -> UvSupport {
        self.support.scaled(self.frame.scale)
    }

    /// How far to trust it.
    pub fn certificate(&self) -> &ParametricCertificate {
        &self.certificate
    }

    /// Noise levels and fairness.
    pub fn levels(&self) -> &ParametricLevels {
        &self.levels
    }

    /// (u, v) of the feet of the contacts, input units.
    pub fn feet(&self) -> Vec<[f64; 2]> {
        self.feet.places.iter().map(|p| p.map(|t| t * self.frame.scale)).collect()
    }

    /// Root mean square distance (input units) and turn of the normals (radians).
    pub fn rms(&self) -> [f64; 2] {
        let count = self.residuals.len().max(1) as f64;
        let rms = |k: usize| (self.residuals.iter().map(|r| r[k] * r[k]).sum::<f64>() / count).sqrt();
        [rms(0) * self.frame.scale, rms(1)]
    }

    /// S, R and the rest over the grid of the options, where contacts reach; computed on first access.
    pub fn shape(&self) -> &ParametricShape {
        self.shape.get_or_init(|| describe::describe(self))
    }
}
