//! The second frontier: ways of solving one and the same least squares problem, digits against time.
//!
//! ```text
//! cholesky          E'E = L L'                          c = L'^-1 L^-1 E'b
//! refined           c <- c + (E'E)^-1 E'(b - E c)       residuals from the rows
//! f32 refined       the same with L in single precision
//! qr [refined]      E = Q R                             c = R^-1 Q'b
//! kronecker         a complete grid through its two small eigenproblems
//! pcg t             conjugate gradients on E'E with its diagonal, until the residual is t of the first
//! ```
//!
//! Every call starts from the rows: what a method has to form, E'E or R, is part of its time. Digits are those of the
//! coefficients, `-log10(max |c - c_ref|/max |c_ref|)`.

use palpate_fitting::fit::{DataSites, Equations};
use palpate_numeric::linalg::{Sites, StencilMatrix, dot};
use palpate_numeric::solve::{Cholesky, FastDiagonalisation, GridSolver, TriangularFactor};

use super::single_precision::SingleFactor;

/// Refinement stops when a correction is no longer half as large as the one before; more steps than these never help.
const MOST_REFINEMENTS: usize = 30;
/// Residuals at which conjugate gradients stop, relative to the first.
const TOLERANCES: [f64; 4] = [1e-4, 1e-8, 1e-12, 1e-15];
/// Steps of conjugate gradients at most, for each unknown.
const STEPS_PER_UNKNOWN: usize = 20;
/// Most unknowns for the dense factor in single precision.
const MOST_SINGLE: usize = 600;

/// A way of solving.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Solver {
    /// Cholesky and nothing else.
    Cholesky,
    /// Cholesky and refinement.
    Refined,
    /// Single precision and refinement.
    SingleRefined,
    /// QR of the rows.
    Qr,
    /// QR and refinement.
    QrRefined,
    /// Fast diagonalisation.
    Kronecker,
    /// Conjugate gradients until the residual is this fraction of the first.
    Pcg(f64),
}

impl Solver {
    /// Every way there is.
    pub(crate) fn all() -> Vec<Solver> {
        let direct = [Solver::Cholesky, Solver::Refined, Solver::SingleRefined, Solver::Qr, Solver::QrRefined];
        direct.into_iter().chain([Solver::Kronecker]).chain(TOLERANCES.map(Solver::Pcg)).collect()
    }

    /// Words.
    pub(crate) fn name(self) -> String {
        match self {
            Solver::Cholesky => "cholesky".into(),
            Solver::Refined => "cholesky refined".into(),
            Solver::SingleRefined => "f32 cholesky refined".into(),
            Solver::Qr => "qr".into(),
            Solver::QrRefined => "qr refined".into(),
            Solver::Kronecker => "kronecker".into(),
            Solver::Pcg(tolerance) => format!("pcg {tolerance:.0e}"),
        }
    }

    /// The coefficients.
    ///
    /// # Errors
    /// Why there are none, in words.
    pub(crate) fn solve(self, equations: &Equations) -> Result<Vec<f64>, String> {
        match self {
            Solver::Cholesky | Solver::Refined => {
                let matrix = equations.normal_matrix();
                let mut factor = Cholesky::plan(matrix.shape()).map_err(|e| e.to_string())?;
                factor.factor(&matrix).map_err(|e| e.to_string())?;
                let solve = |v: &mut [f64]| factor.solve(v);
                Ok(solved(equations, solve, self == Solver::Refined))
            }
            Solver::SingleRefined => {
                let matrix = equations.normal_matrix();
                if matrix.order() > MOST_SINGLE {
                    return Err(format!("the dense factor is for {MOST_SINGLE} unknowns at most"));
                }
                let factor = SingleFactor::new(&matrix)?;
                Ok(solved(equations, |v: &mut [f64]| factor.solve(v), true))
            }
            Solver::Qr | Solver::QrRefined => qr(equations, self == Solver::QrRefined),
            Solver::Kronecker => kronecker(equations),
            Solver::Pcg(tolerance) => pcg(&equations.normal_matrix(), &equations.right_side(), tolerance),
        }
    }
}

/// The solution by this factor, refined from the rows where that is asked for.
fn solved(equations: &Equations, solve: impl Fn(&mut [f64]), refined: bool) -> Vec<f64> {
    let mut c = equations.right_side();
    solve(&mut c);
    if refined {
        refine(equations, solve, &mut c);
    }
    c
}

fn refine(equations: &Equations, solve: impl Fn(&mut [f64]), c: &mut [f64]) {
    let mut last = f64::INFINITY;
    for _ in 0..MOST_REFINEMENTS {
        let mut correction = equations.descent(c);
        solve(&mut correction);
        let size = correction.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        if !size.is_finite() || size >= 0.5 * last {
            return;
        }
        c.iter_mut().zip(&correction).for_each(|(c, d)| *c += d);
        last = size;
        let largest = c.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        if size <= f64::EPSILON / 64.0 * largest {
            return;
        }
    }
}

fn qr(equations: &Equations, refined: bool) -> Result<Vec<f64>, String> {
    // the diagonal of E'E, by which the rows are scaled, is all that is needed of it
    let diagonal = equations.normal_matrix().diagonal();
    let factor = TriangularFactor::of_rows(&equations.sites, &equations.row_weights, &equations.targets, &diagonal)
        .map_err(|e| e.to_string())?;
    if factor.rank() < equations.unknowns() {
        return Err(format!("the rank is {} of {}", factor.rank(), equations.unknowns()));
    }
    let mut c = factor.coefficients();
    if refined {
        refine(equations, |v: &mut [f64]| factor.solve(v), &mut c);
    }
    Ok(c)
}

fn kronecker(equations: &Equations) -> Result<Vec<f64>, String> {
    let DataSites::Gridded(sites) = &equations.sites else { return Err("needs a complete grid".into()) };
    let palpate_numeric::linalg::RowWeights::Uniform(weights) = &equations.row_weights else {
        return Err("needs one weight for each kind of rows".into());
    };
    let [x, y] = sites.axes().each_ref().map(|axis| [axis.gram(0, None), axis.gram(1, None)]);
    let found = FastDiagonalisation::new([&x[0], &x[1]], [&y[0], &y[1]], [weights.z, weights.a, weights.d]);
    let solver = GridSolver::direct(StencilMatrix::zeros(equations.sites.shape()), found.map_err(|e| e.to_string())?);
    let mut c = equations.right_side();
    solver.solve(&mut c);
    Ok(c)
}

/// Conjugate gradients preconditioned by the diagonal.
fn pcg(matrix: &StencilMatrix, rhs: &[f64], tolerance: f64) -> Result<Vec<f64>, String> {
    let diagonal = matrix.diagonal();
    if diagonal.iter().any(|d| d.is_nan() || *d <= 0.0) {
        return Err("an unknown has no data".into());
    }
    let conditioned = |r: &[f64]| -> Vec<f64> { r.iter().zip(&diagonal).map(|(r, d)| r / d).collect() };
    let (mut x, mut r) = (vec![0.0; rhs.len()], rhs.to_vec());
    let mut z = conditioned(&r);
    let (mut direction, mut image) = (z.clone(), vec![0.0; rhs.len()]);
    let mut rz = dot(&r, &z);
    let first = rz;
    for _ in 0..STEPS_PER_UNKNOWN * rhs.len() {
        if rz <= tolerance * tolerance * first {
            return Ok(x);
        }
        matrix.multiply(&direction, &mut image);
        let alpha = rz / dot(&direction, &image);
        for k in 0..x.len() {
            x[k] += alpha * direction[k];
            r[k] -= alpha * image[k];
        }
        z = conditioned(&r);
        let next = dot(&r, &z);
        let beta = next / rz;
        direction.iter_mut().zip(&z).for_each(|(d, z)| *d = z + beta * *d);
        rz = next;
    }
    Err(format!("not converged to {tolerance:.0e} in {} steps", STEPS_PER_UNKNOWN * rhs.len()))
}
