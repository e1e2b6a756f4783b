//! The coefficients that a least squares problem has, to twice the digits of a double.
//!
//! ```text
//! c <- c + (E'E)^-1 E'(b - E c)        b - E c and its product with E' in double-double, c as well
//! ```
//!
//! It converges to the minimiser of the problem whose E and b are the doubles at hand, as long as the factor keeps a digit.

use palpate_fitting::fit::Equations;
use palpate_fitting::observation::to_csr;
use palpate_numeric::linalg::DoubleDouble;
use palpate_numeric::solve::Cholesky;

/// Steps at most; each gains as many digits as the factor has.
const MOST_STEPS: usize = 40;

/// The coefficients, or why there is no reference.
///
/// # Errors
/// Where Cholesky breaks down or the corrections do not shrink.
pub(super) fn reference(equations: &Equations) -> Result<Vec<f64>, String> {
    let rows = to_csr(&equations.sites, &equations.row_weights);
    let matrix = equations.normal_matrix();
    let mut factor = Cholesky::plan(matrix.shape()).map_err(|e| e.to_string())?;
    factor.factor(&matrix).map_err(|e| e.to_string())?;
    let mut c = vec![DoubleDouble::ZERO; equations.unknowns()];
    let mut last = f64::INFINITY;
    for _ in 0..MOST_STEPS {
        let mut gradient = vec![DoubleDouble::ZERO; c.len()];
        for (number, row) in rows.row_iter().enumerate() {
            let target = equations.targets[number / 3][number % 3];
            let entries = || row.col_indices().iter().zip(row.values());
            let residual = entries().fold(DoubleDouble::new(target), |sum, (j, v)| sum - DoubleDouble::new(*v) * c[*j]);
            entries().for_each(|(j, v)| gradient[*j] = gradient[*j] + DoubleDouble::new(*v) * residual);
        }
        let mut correction: Vec<f64> = gradient.iter().map(|g| g.to_f64()).collect();
        factor.solve(&mut correction);
        let size = correction.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        c.iter_mut().zip(&correction).for_each(|(c, d)| *c = *c + DoubleDouble::new(*d));
        let largest = c.iter().fold(0.0_f64, |m, v| m.max(v.to_f64().abs()));
        if size <= 1e-24 * largest {
            return Ok(c.iter().map(|v| v.to_f64()).collect());
        }
        if !size.is_finite() || size > last {
            break;
        }
        last = size;
    }
    Err("no reference: the corrections in double-double do not shrink".into())
}
