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
//! ```
//! use palpate::{Contacts, FitOptions, fit_contacts};
//!
//! // a hollow z = (x^2 + y^2) / 8 touched at 25 places
//! let (x, y): (Vec<f64>, Vec<f64>) = (0..25).map(|r| ((r % 5) as f64 - 2.0, (r / 5) as f64 - 2.0)).unzip();
//! let z = x.iter().zip(&y).map(|(x, y)| (x * x + y * y) / 8.0).collect();
//! let fit = fit_contacts(&Contacts::from_positions(x, y, z), &FitOptions::default())?;
//! assert_eq!(fit.shape().class.name(), "cup");
//! # Ok::<(), palpate::fit::FitError>(())
//! ```
//!
//! What a user meets: [`Contacts`] or a [`Grid`] go with [`FitOptions`] into [`fit_contacts`] or [`fit_grid`], and a [`Fit`]
//! comes back. [`recognition`] finds the kind of surface where no model is named, [`parametric`] fits surfaces that no
//! height field can hold, [`plans`] repeats a fit without allocation, [`scene`] simulates contacts and [`montecarlo`]
//! repeats a fit for noise; [`spline`] and [`geometry`] are the words they share. `tests/house/public_names.txt` lists
//! every public name.
//!
//! # Features
//!
//! - `cli` (default): the program `palpate`, file formats and pictures; it brings `serde`.
//! - `threads` (default): work on several threads, with the same bits as on one.
//! - `serde`: `Serialize` and `Deserialize` for inputs, options, scenes, surfaces and results.
//! - `hard-cases`: the library of numerically hard cases as a public module.
#![warn(missing_docs)]

mod bspline;
mod cases;
#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod cli;
#[cfg(feature = "cli")]
mod comparison;
mod contact;
mod curvature;
mod draws;
pub mod explore;
pub mod fit;
pub mod frontier;
#[doc(hidden)]
pub mod internals;
#[cfg(feature = "cli")]
mod io;
mod linalg;
pub mod montecarlo;
mod observation;
pub mod parametric;
pub mod parts;
pub mod plans;
pub mod recognition;
#[cfg(feature = "cli")]
mod report;
pub mod scene;
mod shape;
mod simd;
mod solve;
mod surface;
mod threads;
mod vector;

pub use contact::{ContactError, ContactWeights, Contacts, Frame, Grid, Orientation};
pub use fit::{Fit, FitOptions, fit_contacts, fit_grid};
pub use nalgebra_sparse;
pub use ndarray;
pub use observation::stacked_csr;

/// Splines: knots, height fields `z = S(x, y)` and parametric surfaces `Q(u, v)`, evaluated with their derivatives.
pub mod spline {
    pub use crate::bspline::{Knots, SplineError, linspace};
    pub use crate::surface::{CurvatureGrid, HeightField, Parametric, ParametricPoint, SurfacePoint};
}

/// Principal curvatures, shape index S, curvedness R and class, at a point and over a grid.
pub mod geometry {
    pub use crate::curvature::{Derivatives, Principal, ShapeClass};
    pub use crate::shape::{Interval, ParametricMaps, ShapeGrid, ShapeMaps};
}

/// The library of numerically hard cases, each with what makes it hard and what is expected of an answer.
#[cfg(feature = "hard-cases")]
pub mod hard_cases {
    pub use crate::cases::{CaseData, Expectation, HardCase};
}

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
