//! Bytes that the arrays of one fit hold, counted from their sizes.
//!
//! ```text
//! contacts (9 numbers)  +  rows (6 weights, 3 targets, 4 basis rows of p + 1)  +  normal matrix  +  factor  +  maps (10)
//! ```
//!
//! It is what the fit keeps, not what the allocator gave: the latter cannot be asked without a part of its own in every
//! program that uses the crate.

use palpate_fitting::fit::Fit;
use palpate_fitting::parametric::FittedSurface;
use palpate_numeric::linalg::{Sites, TensorShape};
use palpate_numeric::solve::Cholesky;

use super::found_surface::FoundSurface;

const NUMBER: u64 = 8;

/// Bytes of this answer; `None` of what was recognised, whose working memory is far more than what it keeps.
pub(super) fn bytes(found: &FoundSurface, contacts: usize) -> Option<u64> {
    match found {
        FoundSurface::Named(found) => Some(of_fit(found, contacts)),
        FoundSurface::Recognised(_) => None,
    }
}

fn of_fit(found: &FittedSurface, contacts: usize) -> u64 {
    match found {
        FittedSurface::Height(fit) => of_height(fit, contacts),
        FittedSurface::Parametric(fit) => {
            let surface = fit.surface();
            let shape = TensorShape {
                basis: [0, 1].map(|k| surface.knots()[k].n_basis()),
                degree: [0, 1].map(|k| surface.knots()[k].degree()),
            };
            // blocks of 3 x 3 in matrix and factor
            let map = fit.options().grid.iter().product::<usize>() as u64;
            NUMBER * (9 * contacts as u64 + rows(shape, contacts) + 9 * equations(shape) + 10 * map)
        }
    }
}

fn of_height(fit: &Fit, contacts: usize) -> u64 {
    let shape = fit.equations().sites.shape();
    let map = fit.options().grid.iter().product::<usize>() as u64;
    NUMBER * (9 * contacts as u64 + rows(shape, contacts) + equations(shape) + 10 * map)
}

fn rows(shape: TensorShape, contacts: usize) -> u64 {
    let basis: usize = shape.degree.iter().map(|p| 2 * (p + 1)).sum();
    ((9 + basis) * contacts) as u64
}

fn equations(shape: TensorShape) -> u64 {
    let stencil: usize = shape.degree.iter().map(|p| 2 * p + 1).product();
    let factor = Cholesky::plan(shape).map_or(0, |plan| plan.factor_entries());
    (shape.unknowns() * (stencil + 1) + factor) as u64
}
