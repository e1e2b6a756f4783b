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
//! comes back. [`recognition`] finds the kind of surface where no model is named, and moves its answer with each touch
//! more, [`parametric`] fits surfaces that no height field can hold, [`plans`] repeats a fit without allocation,
//! [`scene`] simulates contacts and [`montecarlo`] repeats a fit for noise; [`spline`] and [`geometry`] are the words
//! they share. `tests/house/public_names.txt` lists every public name.
//!
//! # Features
//!
//! - `cli` (default): the program `palpate`, file formats and pictures; it brings `serde`.
//! - `threads` (default): work on several threads, with the same bits as on one.
//! - `serde`: `Serialize` and `Deserialize` for inputs, options, scenes, surfaces and results.
#![warn(missing_docs)]

pub use nalgebra_sparse;
pub use ndarray;
#[cfg(feature = "cli")]
#[doc(hidden)]
pub use palpate_app::cli;
pub use palpate_fitting::fit::{Fit, FitOptions, fit_contacts, fit_grid};
pub use palpate_fitting::observation::stacked_csr;
pub use palpate_geometry::contact::{ContactError, ContactWeights, Contacts, Frame, Grid, Orientation};

/// Splines: knots, height fields `z = S(x, y)` and parametric surfaces `Q(u, v)`, evaluated with their derivatives.
pub mod spline {
    pub use palpate_geometry::surface::{CurvatureGrid, HeightField, Parametric, ParametricPoint, SurfacePoint};
    pub use palpate_numeric::bspline::{Knots, SplineError};
}

/// Principal curvatures, shape index S, curvedness R and class, at a point and over a grid.
pub mod geometry {
    pub use palpate_geometry::curvature::{Derivatives, Principal, ShapeClass};
    pub use palpate_geometry::shape::{Interval, ParametricMaps, ShapeGrid, ShapeMaps};
}

/// What to touch next: the places that tell most about S and R.
pub mod explore {
    pub use palpate_studies::explore::{ExploreError, TouchPlanner};
}

/// The paper's five steps: contacts, patch frame, least squares, curvature over a grid, and how far to trust the means.
pub mod fit {
    pub use palpate_fitting::fit::{
        Certificate, Fit, FitError, FitOptions, FrameChoice, Method, MethodUsed, NoiseSds, NoiseSource, NormalSigma,
        Note, Objective, OutsideDomain, Reason, Rms, Robust, Shape, SlopeWeights, Smooth, Statistic, SurfaceKind,
        fit_contacts, fit_grid,
    };
}

/// What accuracy costs in time: the cheapest configuration that keeps an error, or the most accurate within a time.
pub mod frontier {
    pub use palpate_studies::frontier::{Choice, FrontierError, Request};
}

/// Repeated fits with simulated noise: intervals of S and R over replicates of a scene.
pub mod montecarlo {
    pub use palpate_studies::montecarlo::{
        Attribution, Coverage, EffectShare, FixedSites, LinearLaw, Path, Progress, Quantity, Share, Stopped, Study,
        StudyError, StudyOptions, StudyResult, StudyState, Summary, Tolerance,
    };
}

/// Surfaces `Q(u, v)` that no height field can hold: steep, round, closed.
pub mod parametric {
    pub use palpate_fitting::parametric::{FittedSurface, ParametricCertificate, ParametricFit, ParametricShape};
}

/// What a body is made of: planes, spheres, cylinders, cones and tori, and how they adjoin.
pub mod parts {
    pub use palpate_inference::parts::{
        Joint, JointKind, Part, PartGeometry, PartKind, PartUncertainty, Parts, PartsError, PartsOptions, PointShapes,
    };
    // settings of which a user of the defaults needs no name
    #[doc(hidden)]
    pub use palpate_inference::parts::PartsTuning;
}

/// Fits that are planned once and then repeated without allocation: scattered contacts, images, touches one by one.
pub mod plans {
    pub use palpate_fitting::plans::{ImagePlan, PlanError, SlopeColumns, SlopePlan, TouchStream};
}

/// Which kind of surface contacts show when no model is named, with S, R and their intervals.
pub mod recognition {
    pub use palpate_inference::recognition::{
        Estimate, Hypothesis, MapPoint, NoiseFound, NormalsUse, RecognisedSpline, Recognition, RecognitionError,
        RecognitionOptions, SequentialPosterior, Tried, Tuning,
    };
    // what is read where it stands, or a setting of which a user of the defaults needs no name
    #[doc(hidden)]
    pub use palpate_inference::recognition::{Misfit, Remark, SequentialOptions, TouchUpdate};
}

/// The simulated world: bodies, sweeping fingers, the effects that a scene calls for, and the truth.
pub mod scene {
    pub use palpate_world::scene::{
        ContactBatch, Effect, EffectDraws, ImportedSurface, NoiseLaw, SceneError, Simulator, Solid, Stage, Surface,
        Sweep, Truth, World,
    };
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
