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

mod cells;
mod choice;
mod descent;
mod describe;
mod dual;
mod fairness;
mod fitted;
mod flattening;
mod foot;
mod gradient;
mod lanes;
mod levels;
mod problem;
mod quadrature;
mod start;
mod touches;
mod vector;

use std::sync::OnceLock;

pub use choice::{SurfaceKind, choose_surface};
pub use describe::ParametricShape;
pub use fitted::{FittedSurface, fit_surface};

use super::{FitError, FitOptions};
use crate::bspline::Knots;
use crate::contact::{Contacts, Frame};
use crate::shape::UvSupport;
use crate::surface::Parametric;
use cells::Cells;
use descent::{Solver, State};
use foot::Feet;
use lanes::Flat;
use levels::Unknown;
use problem::{Problem, Weights};
use touches::Touches;
use vector::Vector;

/// tau of T: Christoffel symbols of 0.2 over the patch cost as much as one contact at one sigma. The parametrisation
/// follows; 1 lets the corners of noisy patches fold together, 1000 begins to hold back small balls.
const SLACK: f64 = 30.0;
/// alpha of the ties: 0.01 off the flattened place, rms over the contacts, costs as much as one contact at one sigma.
/// With 100 the descent takes hundreds of steps where it takes 20, and a replicate in thirty of noisy balls runs away.
const TIE: f64 = 1e4;
/// Share of the contacts whose normals may be against the surface that was fitted.
const MOST_AGAINST: f64 = 0.1;
/// A Jacobian below this share of the mean one is a fold about to happen.
const FOLD: f64 = 1e-3;
/// Segments of a closed direction where none are asked for: a cubic's curvature of a circle is then off by 2 % at worst.
const ROUND: usize = 12;
/// Reweightings of a robust fit.
const REWEIGHTINGS: usize = 20;

/// How far to trust a surface in space.
#[derive(Clone, Debug, PartialEq)]
pub struct ParametricCertificate {
    /// How the contacts were flattened, and why so.
    pub parametrisation: String,
    /// Scalar rows: one a position, two a normal.
    pub equations: usize,
    /// Unknowns, three a coefficient.
    pub unknowns: usize,
    /// Steps of the descent, all levels together.
    pub iterations: usize,
    /// The last descent ended at a minimum.
    pub settled: bool,
    /// Steps that were refused because they folded the map.
    pub folds_refused: usize,
    /// Smallest `Q_u x Q_v . n` over contacts and supported grid points, over the mean.
    pub smallest_jacobian: f64,
    /// The map turns over nowhere among contacts and supported grid points.
    pub fold_free: bool,
    /// Along every lane the feet come in the order of the stations, but for steps within their noise.
    pub lanes_monotone: Option<bool>,
    /// Contacts whose normal is against the surface.
    pub against: usize,
    /// Condition of the equilibrated Gauss-Newton rows.
    pub condition: f64,
    /// Largest equilibrated gradient left over the largest of its terms' sizes.
    pub gradient: f64,
}

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
/// Every [`FitError`]: contacts on one curve or of several sheets, normals that change sides, too few of them.
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
    let mut problem = Problem { cells: &cells, touches: &touches, flattened: &flat.places, gauss: &gauss, weights };
    let mut solver = Solver::new(&problem)?;
    let coefficients = start::start(&problem, &mut solver, &flat.places)?;
    let mut state = State { coefficients, feet: Feet { places: flat.places.clone() } };
    // fairness first, levels after: from a rough start a long way down is a way into a fold
    problem.weights.fairness = weights.fairness.max(levels::FAIRNESS);
    let mut iterations = solver.descend(&problem, &mut state)?.steps;
    problem.weights = weights;
    let (mut reached, steps) = levels::descend_with_levels(&mut problem, &mut solver, &mut state, unknown)?;
    iterations += steps;
    let mut weighted = touches.clone();
    let mut weights = problem.weights;
    if options.robust != super::Robust::None {
        for _ in 0..REWEIGHTINGS {
            let again = Problem { cells: &cells, touches: &touches, flattened: &flat.places, gauss: &gauss, weights };
            let Some([p, n]) = levels::robust_weights(options.robust, &again, &state) else { break };
            weighted = touches.clone();
            weighted.position_weight.iter_mut().zip(p).for_each(|(w, v)| *w *= v);
            weighted.normal_weight.iter_mut().zip(n).for_each(|(w, v)| *w *= v);
            let before = state.coefficients.clone();
            let again = Problem { cells: &cells, touches: &weighted, flattened: &flat.places, gauss: &gauss, weights };
            reached = solver.descend(&again, &mut state)?;
            iterations += reached.steps;
            let moved = before.iter().zip(&state.coefficients).map(|(a, b)| vector::norm(vector::minus(*a, *b)));
            if moved.fold(0.0, f64::max) < 1e-9 {
                break;
            }
        }
    }
    let problem = Problem { cells: &cells, touches: &weighted, flattened: &flat.places, gauss: &gauss, weights };
    let (condition, gradient) = final_factor(&problem, &mut solver, &state)?;
    let residuals = problem.residuals(&state.coefficients, &state.feet);
    weights = problem.weights;
    let surface = Parametric::from_free(cells.knots().clone(), &state.coefficients)?;
    let support = support(&flat, &state.feet.places, cells.knots());
    let mut certificate = ParametricCertificate {
        parametrisation: format!("{}{reason}", flat.method),
        equations: equations(&touches),
        unknowns: 3 * cells.shape().coefficients(),
        iterations,
        settled: reached.settled,
        folds_refused: reached.folds_refused,
        smallest_jacobian: f64::NAN,
        fold_free: false,
        lanes_monotone: None,
        against: 0,
        condition,
        gradient,
    };
    certify(&mut certificate, &cells, &touches, &state, &support, &weights);
    if certificate.against as f64 > MOST_AGAINST * touches.len() as f64 {
        return Err(FitError::Against { against: certificate.against, contacts: touches.len() });
    }
    let levels = ParametricLevels {
        position: weights.position * frame.scale,
        normal_deg: weights.normal.to_degrees(),
        fairness: weights.fairness,
        estimated: unknown != Unknown { both: false, common: false, fairness: false },
    };
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

/// Lanes where they are known and make a net, else the contacts alone.
fn flatten(touches: &Touches, options: &FitOptions) -> Result<(Flat, String), FitError> {
    let refused = |why: &'static str| FitError::Sheet { contacts: touches.len(), why };
    match lanes::flatten_lanes(touches, options.closed) {
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

/// Leaves the undamped factor at the minimum in `solver`; condition and the gradient that is left.
fn final_factor(problem: &Problem, solver: &mut Solver, state: &State) -> Result<(f64, f64), FitError> {
    let mut rhs = vec![0.0; solver.matrix.order()];
    solver.matrix.clear();
    problem.assemble(&state.coefficients, &state.feet, problem::Parts::ALL, &mut solver.matrix, &mut rhs);
    solver.factor.factor(&solver.matrix, 1e-14).map_err(|source| FitError::Solve { source })?;
    let value = problem.value(&state.coefficients, &state.feet).map_or(0.0, |(value, _)| value);
    let diagonal = solver.matrix.diagonal();
    let scaled = rhs.iter().zip(&diagonal).map(|(g, d)| g.abs() / d.sqrt());
    let gradient = scaled.fold(0.0, f64::max) / value.sqrt().max(f64::MIN_POSITIVE);
    Ok((solver.factor.condition(), gradient))
}

fn certify(
    certificate: &mut ParametricCertificate,
    cells: &Cells,
    touches: &Touches,
    state: &State,
    support: &UvSupport,
    weights: &Weights,
) {
    let c = &state.coefficients;
    let jacobian = |u: f64, v: f64| {
        let row = cells.row(u, v);
        vector::cross(cells.derivative(&row, c, (1, 0)), cells.derivative(&row, c, (0, 1)))
    };
    let mut sizes = Vec::new();
    for (place, normal) in state.feet.places.iter().zip(&touches.normals) {
        let area = jacobian(place[0], place[1]);
        certificate.against += usize::from(vector::dot(area, *normal) <= 0.0);
        sizes.push(vector::norm(area));
    }
    let [u, v] = [0, 1].map(|k| cells.knots()[k].domain());
    let grid = crate::shape::ShapeGrid::over([u, v], [17, 17], 0.0);
    let mut turned = false;
    for pair in grid.x.iter().flat_map(|u| grid.y.windows(2).map(move |v| (*u, [v[0], v[1]]))) {
        let (u, v) = pair;
        if support.holds(u, v[0]) && support.holds(u, v[1]) {
            let (a, b) = (jacobian(u, v[0]), jacobian(u, v[1]));
            sizes.extend([vector::norm(a), vector::norm(b)]);
            turned |= vector::dot(a, b) <= 0.0;
        }
    }
    let mean = sizes.iter().sum::<f64>() / sizes.len() as f64;
    certificate.smallest_jacobian = sizes.iter().fold(f64::INFINITY, |m, s| m.min(*s)) / mean;
    certificate.lanes_monotone = monotone(touches, state, weights, c, cells);
    certificate.fold_free = !turned
        && certificate.smallest_jacobian > FOLD
        && certificate.against == 0
        && certificate.lanes_monotone != Some(false);
}

/// Feet follow the stations along every lane, but for steps within six sd of a position.
fn monotone(touches: &Touches, state: &State, weights: &Weights, c: &[Vector], cells: &Cells) -> Option<bool> {
    let labels = touches.labels.as_ref()?;
    let mut order: Vec<usize> = (0..labels.len()).collect();
    order.sort_by_key(|r| labels[*r]);
    let mut forward = [true; 2];
    for pair in order.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        if labels[a][0] != labels[b][0] || labels[a][1] == labels[b][1] {
            continue;
        }
        let [from, to] = [state.feet.places[a], state.feet.places[b]];
        let row = cells.row(from[0], from[1]);
        let speed = vector::norm(cells.derivative(&row, c, (0, 1)));
        let step = (to[1] - from[1]) * speed;
        forward[0] &= step > -6.0 * weights.position;
        forward[1] &= step < 6.0 * weights.position;
    }
    Some(forward[0] || forward[1])
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
