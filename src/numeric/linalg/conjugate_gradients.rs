//! Preconditioned conjugate gradients for a symmetric positive definite matrix that is known by its products alone (G. Golub and C. Van
//! Loan, *Matrix Computations*, 11.5).
//!
//! ```text
//! r = b - A x,   z = M^-1 r        ends where r'z has fallen to tolerance^2 times its first value
//! ```

use super::dot;

/// When iterations end.
#[derive(Clone, Copy, Debug)]
pub struct GradientLimits {
    /// Share to which the residual falls, in the norm of the preconditioner.
    pub tolerance: f64,
    /// Iterations at most; the solution is then what was reached.
    pub steps: usize,
}

/// `A^-1 b` and the number of iterations; `multiply(v, out)` is `out = A v`, `precondition(v)` is `v <- M^-1 v`.
pub fn conjugate_gradients(
    multiply: impl Fn(&[f64], &mut [f64]),
    precondition: impl Fn(&mut [f64]),
    b: &[f64],
    limits: GradientLimits,
) -> (Vec<f64>, usize) {
    let mut x = vec![0.0; b.len()];
    let mut r = b.to_vec();
    let mut z = r.clone();
    precondition(&mut z);
    let mut direction = z.clone();
    let mut image = vec![0.0; b.len()];
    let mut rz = dot(&r, &z);
    let first = rz;
    for step in 0..limits.steps {
        if rz <= limits.tolerance * limits.tolerance * first {
            return (x, step);
        }
        multiply(&direction, &mut image);
        let alpha = rz / dot(&direction, &image);
        if !alpha.is_finite() {
            return (x, step);
        }
        for k in 0..x.len() {
            x[k] += alpha * direction[k];
            r[k] -= alpha * image[k];
        }
        z.copy_from_slice(&r);
        precondition(&mut z);
        let next = dot(&r, &z);
        let beta = next / rz;
        direction.iter_mut().zip(&z).for_each(|(d, z)| *d = z + beta * *d);
        rz = next;
    }
    (x, limits.steps)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As many steps as the matrix has different eigenvalues.
    #[test]
    fn a_diagonal_matrix_takes_a_step_for_every_value() {
        let values = [1.0, 2.0, 2.0, 5.0, 5.0, 5.0];
        let multiply = |v: &[f64], out: &mut [f64]| (0..6).for_each(|k| out[k] = values[k] * v[k]);
        let limits = GradientLimits { tolerance: 1e-13, steps: 20 };
        let (x, steps) = conjugate_gradients(multiply, |_| (), &[1.0; 6], limits);
        assert!(steps <= 4 && (0..6).all(|k| (x[k] * values[k] - 1.0).abs() < 1e-12), "{x:?} after {steps}");
        let (x, steps) = conjugate_gradients(multiply, |_| (), &[0.0; 6], limits);
        assert_eq!((x, steps), (vec![0.0; 6], 0));
    }
}
