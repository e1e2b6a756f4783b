//! `palpate` tells the shape of a curved surface from a few touches, and says how far to trust the answer.
//!
//! A tensor-product B-spline `S(x, y) = sum_ij c_ij N_i(x) M_j(y)` is fitted to contact positions and surface
//! normals at once, by weighted least squares on the stacked observation matrix
//!
//! ```text
//! E = [ N  o M  ]   heights      z  = S          g rows
//!     [ N' o M  ]   slopes in x  zx = S_x        g rows      E c = b,  c = vec(c_ij), n m unknowns
//!     [ N  o M' ]   slopes in y  zy = S_y        g rows
//! ```
//!
//! and from the surface come the principal curvatures `k1 >= k2`, Koenderink's shape index `S` and curvedness `R`.
//!
//! The rooms, lowest floor first; a room imports only from the floors below it (held by `tests/house/floors.rs`):
//! [`contact`], [`bspline`], [`linalg`], [`curvature`], [`draws`]; [`scene`], [`observation`], [`solve`],
//! [`surface`]; [`shape`]; [`fit`]; and above them the rooms that repeat a fit, read and write files, and talk.
#![warn(missing_docs)]

pub mod bspline;
pub mod cases;
#[cfg(feature = "cli")]
pub mod cli;
pub mod contact;
pub mod curvature;
pub mod draws;
pub mod fit;
#[cfg(feature = "cli")]
pub mod io;
pub mod linalg;
pub mod montecarlo;
pub mod observation;
pub mod parametric;
pub mod plans;
pub mod recognition;
#[cfg(feature = "cli")]
pub mod report;
pub mod scene;
pub mod shape;
pub mod simd;
pub mod solve;
pub mod surface;
mod threads;
mod vector;

pub use contact::{Contacts, Grid};
pub use fit::{Fit, FitOptions, fit_contacts, fit_grid};
pub use nalgebra_sparse;
pub use ndarray;

/// The project's longer documents, as part of the reference. Their Rust code is compiled and run with its tests.
#[cfg(any(doc, doctest))]
pub mod documents {
    #[doc = include_str!("../README.md")]
    pub mod readme {}
    #[doc = include_str!("../DESIGN.md")]
    pub mod design {}
    #[doc = include_str!("../COMPARE.md")]
    pub mod compare {}
}
