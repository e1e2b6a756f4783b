//! How far to trust a parametric surface.
//!
//! ```text
//! Jacobian  |Q_u x Q_v| over contacts and supported grid points, smallest over mean
//! against     Q_u x Q_v . n_r <= 0
//! bending   largest curvature there over the largest that neighbouring contacts can have felt        (bending)
//! gradient  max |g_k| / sqrt(A_kk F)
//! ```

use super::bending::{MOST_BENDING, MeasuredCurvature};
use super::cells::Jet;
use super::descent::{Descent, Solver, State};
use super::problem::{Parts, Problem};
use super::vector::{Vector, cross, dot, norm};
use crate::fit::FitError;
use palpate_geometry::curvature::Derivatives;
use palpate_geometry::shape::{ShapeGrid, UvSupport};

/// A Jacobian below this share of the mean one counts as a fold.
const FOLD: f64 = 1e-3;
/// Least and most grid points in each direction; four per segment and five more are taken between these bounds.
const POINTS: [usize; 2] = [9, 65];

/// How far to trust a parametric surface.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ParametricCertificate {
    /// How the contacts were flattened, and why in this way.
    pub parametrisation: String,
    /// Scalar rows: one for each position, two for each normal.
    pub equations: usize,
    /// Unknowns: three for each coefficient.
    pub unknowns: usize,
    /// Steps of all descents together.
    pub iterations: usize,
    /// Whether the last descent ended at a minimum.
    pub settled: bool,
    /// Steps that were refused because they folded the surface.
    pub folds_refused: usize,
    /// Smallest `Q_u x Q_v . n` over contacts and supported grid points, over the mean.
    pub smallest_jacobian: f64,
    /// Whether the surface has no fold at contacts and supported grid points.
    pub fold_free: bool,
    /// Whether the feet of every finger come in the order of the stations, steps within their noise excepted; `None` without
    /// labels.
    pub fingers_monotone: Option<bool>,
    /// Contacts whose normal points to the other side of the surface.
    pub against: usize,
    /// Largest curvature at contacts and supported grid points, over the largest that the normals of neighbouring contacts
    /// allow there; a fit whose bending is above 2.5 is refused.
    pub bending: f64,
    /// How often fairness was raised tenfold because the bending was above that.
    pub fairness_raised: usize,
    /// Condition of the equilibrated Gauss-Newton rows.
    pub condition: f64,
    /// Largest equilibrated gradient left over the largest of its terms' sizes.
    pub gradient: f64,
}

/// Folds, sides and bending of the surface, from its coefficients alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct GeometryCheck {
    /// Smallest Jacobian over the mean one.
    pub smallest_jacobian: f64,
    /// Whether the surface has no fold, and the fingers keep their order.
    pub fold_free: bool,
    /// Whether feet come in the order of their stations; `None` without labels.
    pub fingers_monotone: Option<bool>,
    /// Contacts whose normal points to the other side of the surface.
    pub against: usize,
    /// Largest curvature over the largest that can have been felt.
    pub bending: f64,
}

/// Condition of the last factor, and the gradient that is left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FinalFactor {
    /// Condition of the equilibrated Gauss-Newton rows.
    pub condition: f64,
    /// Largest equilibrated gradient over the root of the objective.
    pub gradient: f64,
}

impl ParametricCertificate {
    /// The entries that come from the descent, the surface and the factor; the others are empty.
    pub(super) fn of(reached: &Descent, geometry: &GeometryCheck, last: FinalFactor) -> ParametricCertificate {
        ParametricCertificate {
            parametrisation: String::new(),
            equations: 0,
            unknowns: 0,
            iterations: reached.steps,
            settled: reached.settled,
            folds_refused: reached.folds_refused,
            smallest_jacobian: geometry.smallest_jacobian,
            fold_free: geometry.fold_free,
            fingers_monotone: geometry.fingers_monotone,
            against: geometry.against,
            bending: geometry.bending,
            fairness_raised: 0,
            condition: last.condition,
            gradient: last.gradient,
        }
    }
}

impl GeometryCheck {
    /// Whether the surface bends no more than its contacts can have felt.
    pub(super) fn bends_within_limit(&self) -> bool {
        self.bending <= MOST_BENDING
    }
}

/// Checks the surface at contacts and supported grid points.
pub(super) fn check_geometry(problem: &Problem, state: &State, support: &UvSupport) -> GeometryCheck {
    let (cells, contacts, c) = (problem.cells, problem.contacts, &state.coefficients);
    let measured = MeasuredCurvature::new(cells, contacts, &state.feet, problem.weights.normal);
    let (mut sizes, mut bending, mut against) = (Vec::new(), 0.0_f64, 0);
    let domain = [0, 1].map(|k| cells.knots()[k].domain());
    // beyond an open end the end polynomial is extended, and no S or R is taken there
    let within =
        |place: [f64; 2]| (0..2).all(|k| cells.shape().closed[k] || (domain[k][0]..=domain[k][1]).contains(&place[k]));
    let mut look = |place: [f64; 2]| {
        let jet = cells.jet::<2>(&cells.row(place[0], place[1], 2), c);
        let area = cross(jet[1][0], jet[0][1]);
        sizes.push(norm(area));
        let bent = if within(place) { measured.bending(place, largest_curvature(&jet)) } else { 0.0 };
        // a curvature that is NaN counts as unbounded
        bending = if bent.is_nan() { f64::INFINITY } else { bending.max(bent) };
        area
    };
    for (place, normal) in state.feet.places.iter().zip(&contacts.normals) {
        against += usize::from(dot(look(*place), *normal) <= 0.0);
    }
    let count = [0, 1].map(|k| (4 * cells.knots()[k].n_segments() + 5).clamp(POINTS[0], POINTS[1]));
    let grid = ShapeGrid::over(domain, count, 0.0);
    let mut folded = false;
    for &u in &grid.x {
        let mut before: Option<Vector> = None;
        for &v in &grid.y {
            let area = support.holds(u, v).then(|| look([u, v]));
            folded |= before.zip(area).is_some_and(|(a, b)| dot(a, b) <= 0.0);
            before = area;
        }
    }
    let mean = sizes.iter().sum::<f64>() / sizes.len() as f64;
    let smallest_jacobian = sizes.iter().fold(f64::INFINITY, |m, s| m.min(*s)) / mean;
    let fingers_monotone = monotone(problem, state);
    let fold_free = !folded && smallest_jacobian > FOLD && against == 0 && fingers_monotone != Some(false);
    GeometryCheck { smallest_jacobian, fold_free, fingers_monotone, against, bending }
}

fn largest_curvature(jet: &Jet) -> f64 {
    let [u, v, uu, uv, vv] = [jet[1][0], jet[0][1], jet[2][0], jet[1][1], jet[0][2]];
    let principal = Derivatives { u, v, uu, uv, vv }.principal();
    principal.map_or(f64::INFINITY, |p| p.k1.abs().max(p.k2.abs()))
}

/// Whether the feet of every finger follow its stations, steps within six sds of a position excepted.
fn monotone(problem: &Problem, state: &State) -> Option<bool> {
    let labels = problem.contacts.labels.as_ref()?;
    let mut order: Vec<usize> = (0..labels.len()).collect();
    order.sort_by_key(|r| labels[*r]);
    let mut forward = [true; 2];
    for pair in order.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        if labels[a][0] != labels[b][0] || labels[a][1] == labels[b][1] {
            continue;
        }
        let [from, to] = [state.feet.places[a], state.feet.places[b]];
        let row = problem.cells.row(from[0], from[1], 1);
        let speed = norm(problem.cells.jet::<1>(&row, &state.coefficients)[0][1]);
        let step = (to[1] - from[1]) * speed;
        forward[0] &= step > -6.0 * problem.weights.position;
        forward[1] &= step < 6.0 * problem.weights.position;
    }
    Some(forward[0] || forward[1])
}

/// Leaves the undamped factor at the minimum in `solver`.
///
/// # Errors
/// The normal matrix has no factor.
pub(super) fn final_factor(problem: &Problem, solver: &mut Solver, state: &State) -> Result<FinalFactor, FitError> {
    let mut rhs = vec![0.0; solver.matrix.order()];
    solver.matrix.clear();
    problem.assemble(&state.coefficients, &state.feet, Parts::ALL, &mut solver.matrix, &mut rhs);
    solver.factor.factor(&solver.matrix, 1e-14).map_err(|source| FitError::Solve { source })?;
    let value = problem.value(&state.coefficients, &state.feet).map_or(0.0, |(value, _)| value);
    let diagonal = solver.matrix.diagonal();
    let scaled = rhs.iter().zip(&diagonal).map(|(g, d)| g.abs() / d.sqrt());
    let gradient = scaled.fold(0.0, f64::max) / value.sqrt().max(f64::MIN_POSITIVE);
    Ok(FinalFactor { condition: solver.factor.condition(), gradient })
}
