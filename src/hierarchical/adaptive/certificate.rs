//! How far to trust the arithmetic of an adaptive fit.
//!
//! ```text
//! omega = max_i |b - (A + P) c|_i / ((|A| + |P|) |c| + |b|)_i        b - A c = g, the load of the last residuals
//! ```
//!
//! The coefficients solve equations whose numbers differ from the written ones by a share omega at most (W. Oettli, W. Prager, *Numer.
//! Math.* 6 (1964) 405). The residuals are those of the contacts themselves, so that what was lost on the way from the contacts to the
//! equations is part of it, and of normals what is not linear about the last step.

use super::refinement::MeshRefinement;
use super::system::System;
use crate::equations::CellSums;

/// Backward error of the coefficients in the equations of the last fit; the sums are those of its residuals.
pub(super) fn backward_error(refinement: &MeshRefinement<'_>, system: &System, sums: &CellSums) -> f64 {
    let (matrix, load) = system.pattern.assemble(&system.space, sums, refinement.weights);
    let rough = system.rough(&refinement.lambdas);
    let c = refinement.field.coefficients();
    let product = |values: &[f64], c: &[f64]| {
        let mut out = vec![0.0; c.len()];
        system.pattern.multiply(values, c, &mut out);
        out
    };
    let sizes: Vec<f64> = matrix.iter().zip(&rough).map(|(a, p)| a.abs() + p.abs()).collect();
    let of_c: Vec<f64> = c.iter().map(|c| c.abs()).collect();
    let (fitted, bent, scale) = (product(&matrix, c), product(&rough, c), product(&sizes, &of_c));
    let share = |i: usize| {
        let size = scale[i] + (fitted[i] + load[i]).abs();
        if size > 0.0 { (load[i] - bent[i]).abs() / size } else { 0.0 }
    };
    (0..c.len()).map(share).fold(0.0, f64::max)
}
