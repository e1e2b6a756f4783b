//! The paper's five steps, top to bottom.
//!
//! ```text
//! 1  contacts with normals (or a grid with slopes)                          crate::contact, read by the caller
//! 2  patch frame: p = A (P - origin)/scale, one length                      place_contacts, place_grid
//! 3  minimise |W(E c - b)|^2, E = [N o M; N' o M; N o M']                   slope rows, or normal rows by Gauss-Newton
//! 4  k1, k2, S, R over a grid; their means and spread                       Fit::shape
//! 5  class, radius, plane or not, and how far to trust it                   Fit::shape, Fit::certificate
//! ```
//!
//! ```
//! use palpate::{Contacts, fit};
//!
//! // a convex sphere of radius 10 touched at 25 places
//! let (mut x, mut y, mut z) = (vec![], vec![], vec![]);
//! for i in 0..25 {
//!     let (u, v) = ((i % 5) as f64 - 2.0, (i / 5) as f64 - 2.0);
//!     x.push(u);
//!     y.push(v);
//!     z.push((100.0 - u * u - v * v).sqrt() - 10.0);
//! }
//! let nz = z.iter().map(|h| h + 10.0).collect();
//! let contacts = Contacts::from_positions(x.clone(), y.clone(), z).with_normals(x, y, nz);
//! let found = fit::fit_contacts(&contacts, &fit::FitOptions::default())?;
//! let shape = found.shape();
//! assert_eq!(shape.class.name(), "cap");
//! assert!((shape.radius.unwrap() - 10.0).abs() < 0.3);
//! # Ok::<(), fit::FitError>(())
//! ```

mod certificate;
mod describe;
mod error;
mod linear;
mod noise;
mod notes;
mod objective;
mod options;
mod placing;

pub use certificate::Certificate;
pub use certificate::guaranteed_digits::Promise;
pub use describe::{Shape, Statistic};
pub use error::FitError;
pub use linear::reasons::{MethodUsed, Reason};
pub use linear::{Factor, Solution};
pub(crate) use noise::probes::Signs;
pub use notes::Note;
pub use objective::equations::{Block, Equations};
pub use objective::{Declared, NoiseLevels, Rms};
pub use options::{
    FitOptions, FrameChoice, Method, NormalSigma, Objective, OutsideDomain, Robust, SlopeWeights, Smooth, SurfaceKind,
};
pub use placing::{Observed, Patch};

use std::sync::OnceLock;

use ndarray::Array2;

use crate::contact::{Contacts, Frame, Grid};
use crate::surface::HeightField;
use objective::data::Data;

/// A fitted patch: the surface, the equations it solves, and all that is asked of it later.
#[derive(Debug)]
pub struct Fit {
    pub(crate) options: FitOptions,
    pub(crate) patch: Patch,
    pub(crate) surface: HeightField,
    pub(crate) fitted: objective::Fitted,
    pub(crate) data: Data,
    noise: OnceLock<NoiseLevels>,
    condition: OnceLock<f64>,
    certificate: OnceLock<Certificate>,
    shape: OnceLock<Shape>,
}

/// Fits scattered contacts.
///
/// # Errors
/// Every [`FitError`]; nothing panics on what a user can hand in.
pub fn fit_contacts(contacts: &Contacts, options: &FitOptions) -> Result<Fit, FitError> {
    options.check()?;
    let (patch, local) = placing::place_contacts(contacts, options)?;
    let data = Data::scattered(local, &patch);
    fit_data(patch, data, options)
}

/// Fits a grid of heights with optional slopes and weight maps; NaN entries are missing.
///
/// # Errors
/// Every [`FitError`].
pub fn fit_grid(grid: &Grid, options: &FitOptions) -> Result<Fit, FitError> {
    options.check()?;
    let patch = placing::place_grid(grid, options)?;
    let (origin, scale) = (patch.frame.origin[2], patch.frame.scale);
    fit_data(patch, Data::Gridded { grid: grid.clone(), origin, scale }, options)
}

fn fit_data(patch: Patch, data: Data, options: &FitOptions) -> Result<Fit, FitError> {
    let fitted = objective::fit_rows(&patch, &data, options)?;
    let shape = [patch.knots[0].n_basis(), patch.knots[1].n_basis()];
    let coefficients = Array2::from_shape_fn(shape, |(i, j)| fitted.solution.coefficients[i * shape[1] + j]);
    let surface = HeightField::new(patch.knots.clone(), coefficients)?;
    Ok(Fit {
        options: options.clone(),
        patch,
        surface,
        fitted,
        data,
        noise: OnceLock::new(),
        condition: OnceLock::new(),
        certificate: OnceLock::new(),
        shape: OnceLock::new(),
    })
}

impl Fit {
    /// The frame the fit worked in.
    pub fn frame(&self) -> &Frame {
        &self.patch.frame
    }

    /// The patch: frame and knots.
    pub fn patch(&self) -> &Patch {
        &self.patch
    }

    /// The options it was asked with.
    pub fn options(&self) -> &FitOptions {
        &self.options
    }

    /// The surface in patch coordinates (origin at the patch, unit [`Frame::scale`]).
    pub fn surface(&self) -> &HeightField {
        &self.surface
    }

    /// The surface in input units along the frame's axes: over the user's x and y when axes are kept.
    ///
    /// # Errors
    /// When the input's own rounding leaves no distinct knots.
    pub fn input_surface(&self) -> Result<HeightField, FitError> {
        let frame = &self.patch.frame;
        let height = if frame.keeps_axes() { frame.origin[2] } else { frame.rotate(frame.origin)[2] };
        let coefficients = self.surface.coefficients().mapv(|c| height + frame.scale * c);
        Ok(HeightField::new(self.patch.input_knots.clone(), coefficients)?)
    }

    /// The linear problem whose solution the coefficients are (with normal rows: the last Gauss-Newton step's).
    pub fn equations(&self) -> &Equations {
        &self.fitted.equations
    }

    /// lambda of the roughness penalty as it was asked for or found; 0 without.
    pub fn smoothing(&self) -> f64 {
        // extreme weights are divided by a power of two, and the penalty with them
        let unit = match self.fitted.levels {
            objective::Levelled::Weights { unit, .. } => unit,
            objective::Levelled::Known(_) => 1.0,
        };
        self.equations().roughness.as_ref().map_or(0.0, |(lambda, _)| lambda / unit / unit)
    }

    /// Method, reasons, rank, refinement.
    pub fn solution(&self) -> &Solution {
        &self.fitted.solution
    }

    /// What the noise levels or weights were, declared or found; under weights they come from the residuals on first access.
    pub fn noise(&self) -> &NoiseLevels {
        self.noise.get_or_init(|| objective::noise_levels(&self.fitted))
    }

    /// Root mean square residuals, input units.
    pub fn rms(&self) -> Rms {
        objective::rms(self)
    }

    /// Remarks that a user should see.
    pub fn notes(&self) -> &[Note] {
        &self.fitted.notes
    }

    /// 1-norm condition estimate of the equilibrated weighted rows; computed on first access.
    pub fn condition(&self) -> f64 {
        *self.condition.get_or_init(|| self.fitted.solution.factor.condition())
    }

    /// How far to trust the numbers; computed on first access (with the shape, whose digits it promises).
    pub fn certificate(&self) -> &Certificate {
        self.certificate.get_or_init(|| certificate::certify(self))
    }

    /// Steps 4 and 5: S, R, class, radius and their uncertainty over the options' grid; computed on first access.
    pub fn shape(&self) -> &Shape {
        self.shape.get_or_init(|| describe::describe(self))
    }
}
