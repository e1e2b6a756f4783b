//! How far to trust a surface in space.
//!
//! ```text
//! Jacobian  |Q_u x Q_v| over contacts and supported grid points, smallest over mean;  against   Q_u x Q_v . n_r <= 0
//! bending   largest curvature there over the largest that neighbouring contacts can have felt        (bending)
//! gradient  max |g_k| / sqrt(A_kk F)
//! ```

use super::bending::{Felt, MOST_BENDING};
use super::cells::Jet;
use super::descent::{Solver, State};
use super::problem::{Parts, Problem};
use super::vector::{Vector, cross, dot, norm};
use crate::curvature::{Derivatives, principal_curvatures};
use crate::fit::FitError;
use crate::shape::{ShapeGrid, UvSupport};

/// A Jacobian below this share of the mean one is a fold about to happen.
const FOLD: f64 = 1e-3;
/// Points a direction that the certificate looks at: four a segment and some, a bound on its share of the fit's time.
const POINTS: [usize; 2] = [9, 65];

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
    /// Largest curvature at contacts and supported grid points, over the largest that the turn of the normals of
    /// neighbouring contacts allows there; a fit whose bending is beyond 2.5 is refused.
    pub bending: f64,
    /// How often fairness was raised tenfold because the bending was beyond that.
    pub fairness_raised: usize,
    /// Condition of the equilibrated Gauss-Newton rows.
    pub condition: f64,
    /// Largest equilibrated gradient left over the largest of its terms' sizes.
    pub gradient: f64,
}

/// What the map itself tells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Findings {
    /// Smallest Jacobian over the mean one.
    pub smallest_jacobian: f64,
    /// It turns over nowhere, and lanes keep their order.
    pub fold_free: bool,
    /// Feet follow the stations; `None` without labels.
    pub lanes_monotone: Option<bool>,
    /// Contacts whose normal is against the surface.
    pub against: usize,
    /// Largest curvature over what was felt.
    pub bending: f64,
}

impl Findings {
    /// The surface does not bend more than its contacts felt.
    pub fn is_felt(&self) -> bool {
        self.bending <= MOST_BENDING
    }
}

/// Looks at contacts and supported grid points.
pub fn findings(problem: &Problem, state: &State, support: &UvSupport) -> Findings {
    let (cells, touches, c) = (problem.cells, problem.touches, &state.coefficients);
    let felt = Felt::new(cells, touches, &state.feet, problem.weights.normal);
    let (mut sizes, mut bending, mut against) = (Vec::new(), 0.0_f64, 0);
    let domain = [0, 1].map(|k| cells.knots()[k].domain());
    // a foot beyond an open end is where the end polynomial went on: no S and R are taken there
    let within =
        |place: [f64; 2]| (0..2).all(|k| cells.shape().closed[k] || (domain[k][0]..=domain[k][1]).contains(&place[k]));
    let mut look = |place: [f64; 2]| {
        let jet = cells.jet::<2>(&cells.row(place[0], place[1], 2), c);
        let area = cross(jet[1][0], jet[0][1]);
        sizes.push(norm(area));
        let bent = if within(place) { felt.bending(place, largest_curvature(&jet)) } else { 0.0 };
        // NaN is no curvature that was felt
        bending = if bent.is_nan() { f64::INFINITY } else { bending.max(bent) };
        area
    };
    for (place, normal) in state.feet.places.iter().zip(&touches.normals) {
        against += usize::from(dot(look(*place), *normal) <= 0.0);
    }
    let count = [0, 1].map(|k| (4 * cells.knots()[k].n_segments() + 5).clamp(POINTS[0], POINTS[1]));
    let grid = ShapeGrid::over(domain, count, 0.0);
    let mut turned = false;
    for &u in &grid.x {
        let mut before: Option<Vector> = None;
        for &v in &grid.y {
            let area = support.holds(u, v).then(|| look([u, v]));
            turned |= before.zip(area).is_some_and(|(a, b)| dot(a, b) <= 0.0);
            before = area;
        }
    }
    let mean = sizes.iter().sum::<f64>() / sizes.len() as f64;
    let smallest_jacobian = sizes.iter().fold(f64::INFINITY, |m, s| m.min(*s)) / mean;
    let lanes_monotone = monotone(problem, state);
    let fold_free = !turned && smallest_jacobian > FOLD && against == 0 && lanes_monotone != Some(false);
    Findings { smallest_jacobian, fold_free, lanes_monotone, against, bending }
}

fn largest_curvature(jet: &Jet) -> f64 {
    let [u, v, uu, uv, vv] = [jet[1][0], jet[0][1], jet[2][0], jet[1][1], jet[0][2]];
    let principal = principal_curvatures(&Derivatives { u, v, uu, uv, vv });
    principal.map_or(f64::INFINITY, |p| p.k1.abs().max(p.k2.abs()))
}

/// Feet follow the stations along every lane, but for steps within six sd of a position.
fn monotone(problem: &Problem, state: &State) -> Option<bool> {
    let labels = problem.touches.labels.as_ref()?;
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

/// Leaves the undamped factor at the minimum in `solver`; condition and the gradient that is left.
///
/// # Errors
/// A matrix without a factor.
pub fn final_factor(problem: &Problem, solver: &mut Solver, state: &State) -> Result<(f64, f64), FitError> {
    let mut rhs = vec![0.0; solver.matrix.order()];
    solver.matrix.clear();
    problem.assemble(&state.coefficients, &state.feet, Parts::ALL, &mut solver.matrix, &mut rhs);
    solver.factor.factor(&solver.matrix, 1e-14).map_err(|source| FitError::Solve { source })?;
    let value = problem.value(&state.coefficients, &state.feet).map_or(0.0, |(value, _)| value);
    let diagonal = solver.matrix.diagonal();
    let scaled = rhs.iter().zip(&diagonal).map(|(g, d)| g.abs() / d.sqrt());
    let gradient = scaled.fold(0.0, f64::max) / value.sqrt().max(f64::MIN_POSITIVE);
    Ok((solver.factor.condition(), gradient))
}
