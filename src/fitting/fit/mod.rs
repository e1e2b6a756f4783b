//! The paper's five steps, top to bottom.
//!
//! ```text
//! 1  contacts with normals (or a grid with slopes), checked             FitOptions::check; io reads them
//! 2  patch frame: p = A (P - origin)/scale, one length                  placing::place_contacts, place_grid
//! 3  minimise |W(E c - b)|^2, E = [N o M; N' o M; N o M']               objective::fit_rows: slope rows or normal rows
//! 4  k1, k2, S, R over a grid                                           describe::shape_over_grid
//! 5  means, class, radius, plane or not, and how far to trust them      describe::classify, certificate::certify
//! ```
//!
//! Steps 4 and 5 wait until they are asked for: [`Fit::shape`], [`Fit::certificate`].
//!
//! ```
//! # use palpate_fitting::facade as palpate;
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
mod degree_elevation_test;
mod describe;
mod error;
mod linear;
mod model_reading;
mod noise;
mod notes;
mod objective;
mod options;
mod placing;
mod solved;
pub mod stages;

pub use certificate::Certificate;
pub use degree_elevation_test::richer_reading;
pub use describe::Shape;
pub use describe::residuals::Rms;
pub use error::FitError;
#[doc(hidden)]
pub use linear::equations::{Equations, RowKind};
pub use linear::free_unknowns::Free;
pub use linear::reasons::Reason;
#[doc(hidden)]
pub use linear::solution::Solution;
pub use model_reading::{ModelReading, Reading};
pub use noise::hutchinson::Signs;
pub use noise::sds::{NoiseSds, NoiseSource};
pub use notes::Note;
pub use options::method::MethodUsed;
pub use options::{
    FitOptions, FrameChoice, Method, NormalSigma, Objective, OutsideDomain, Robust, SlopeWeights, Smooth, SurfaceKind,
};
pub use palpate_geometry::shape::Statistic;
#[doc(hidden)]
pub use palpate_numeric::solve::Factor;
#[doc(hidden)]
pub use placing::Patch;
pub use placing::axes::{STEEP, steepness};
#[doc(hidden)]
pub use placing::sites::DataSites;

use std::sync::OnceLock;

use ndarray::Array2;

use crate::observation::Data;
use palpate_geometry::contact::{Contacts, Frame, Grid};
use palpate_geometry::shape::GridGradients;
use palpate_geometry::surface::HeightField;
use solved::Solved;

/// A fitted patch: the surface, the equations it solves, and what is computed from them on demand.
#[derive(Clone, Debug)]
pub struct Fit {
    solved: Solved,
    /// With the gradients that its digits are guaranteed by.
    shape: OnceLock<(Shape, GridGradients)>,
    bare_shape: OnceLock<Shape>,
    certificate: OnceLock<Certificate>,
    model_reading: ModelReading,
}

/// Fits a height field to scattered contacts; `SurfaceKind::Auto` is a height field here.
///
/// # Errors
/// Every [`FitError`]; nothing panics on what a user can hand in.
pub fn fit_contacts(contacts: &Contacts, options: &FitOptions) -> Result<Fit, FitError> {
    options.check()?;
    options.check_height_field()?;
    let (patch, data) = placing::place_contacts(contacts, options)?;
    fit_placed(patch, data, options)
}

/// The same over these axes (rows x, y, z in the input's frame) instead of those that the options choose.
///
/// # Errors
/// Every [`FitError`].
pub fn fit_contacts_over(contacts: &Contacts, axes: [[f64; 3]; 3], options: &FitOptions) -> Result<Fit, FitError> {
    options.check()?;
    options.check_height_field()?;
    let (patch, data) = placing::place_contacts_over(contacts, axes, options)?;
    fit_placed(patch, data, options)
}

/// Fits a height field to a grid of heights with optional slopes and weight maps; NaN entries are missing.
///
/// # Errors
/// Every [`FitError`].
pub fn fit_grid(grid: &Grid, options: &FitOptions) -> Result<Fit, FitError> {
    options.check()?;
    options.check_height_field()?;
    let (patch, data) = placing::place_grid(grid, options)?;
    fit_placed(patch, data, options)
}

/// Steps 3 to 5 of data in their patch: the rows solved, the surface of their coefficients; the shape waits until asked.
fn fit_placed(patch: Patch, data: Data, options: &FitOptions) -> Result<Fit, FitError> {
    let fitted = objective::fit_rows(&patch, &data, options)?;
    let [n, m] = [0, 1].map(|axis| patch.knots[axis].n_basis());
    let coefficients = Array2::from_shape_fn((n, m), |(i, j)| fitted.solution.coefficients[i * m + j]);
    let surface = HeightField::new(patch.knots.clone(), coefficients)?;
    Ok(Fit::new(Solved::new(patch, data, fitted, surface, options.clone())))
}

impl Fit {
    fn new(solved: Solved) -> Fit {
        let (shape, bare_shape, certificate) = (OnceLock::new(), OnceLock::new(), OnceLock::new());
        Fit { solved, shape, bare_shape, certificate, model_reading: ModelReading::NotAsked }
    }

    /// The same fit, with this said of its points by another kind of surface.
    pub fn with_model_reading(self, model_reading: ModelReading) -> Fit {
        Fit { model_reading, shape: OnceLock::new(), certificate: OnceLock::new(), ..self }
    }

    /// What another kind of surface said of the fit's points.
    pub fn model_reading(&self) -> &ModelReading {
        &self.model_reading
    }

    /// The contacts whose heights count in patch coordinates, `most` of them or a few more; `None` without heights.
    pub fn contacts_in_patch(&self, most: usize) -> Option<Contacts> {
        self.solved.data.contacts_in_patch(&self.solved.patch, most)
    }

    /// Supported points of the shape grid in patch coordinates, `most` each way at most, spread evenly.
    pub fn shape_places(&self, most: usize) -> Vec<[f64; 3]> {
        describe::places(&describe::shape_over_grid(&self.solved), most)
    }

    /// S, R, class, radius and their uncertainty over the options' grid; computed on first access.
    pub fn shape(&self) -> &Shape {
        &self.shape_with_gradients().0
    }

    fn shape_with_gradients(&self) -> &(Shape, GridGradients) {
        self.shape.get_or_init(|| {
            let maps = describe::shape_over_grid(&self.solved);
            describe::classify(&self.solved, &maps, Some(&self.model_reading))
        })
    }

    /// The same without uncertainties, intervals, probabilities and direction, which may take longer than the fit;
    /// computed on first access.
    pub fn bare_shape(&self) -> &Shape {
        self.bare_shape.get_or_init(|| {
            let maps = describe::shape_over_grid(&self.solved);
            describe::classify(&self.solved, &maps, None).0
        })
    }

    /// Covariance of the noise in mean S and mean R, 1/length; computed at every call.
    pub fn covariance_of_means(&self) -> Option<f64> {
        describe::covariance_of_means(&self.solved)
    }

    /// Standard uncertainties at `points` places each way of the domain, input units; computed at every call. `None` where
    /// nothing tells the noise, and where there are too many unknowns for so many places.
    pub fn pointwise(&self, points: usize) -> Option<Vec<palpate_geometry::shape::PointSds>> {
        describe::pointwise::pointwise(&self.solved, points)
    }

    /// Whether contacts support a place along the frame's axes, input units.
    pub fn supported(&self) -> impl Fn(f64, f64) -> bool {
        describe::pointwise::supported(&self.solved)
    }

    /// How far to trust the numbers; computed on first access, with the shape whose digits it guarantees.
    pub fn certificate(&self) -> &Certificate {
        self.certificate.get_or_init(|| {
            let (shape, gradients) = self.shape_with_gradients();
            certificate::certify(&self.solved, &shape.maps, gradients)
        })
    }

    /// The frame the fit worked in.
    pub fn frame(&self) -> &Frame {
        &self.solved.patch.frame
    }

    /// The patch: frame and knots.
    pub fn patch(&self) -> &Patch {
        &self.solved.patch
    }

    /// The options it was fitted with.
    pub fn options(&self) -> &FitOptions {
        &self.solved.options
    }

    /// The surface in patch coordinates (origin at the patch, unit [`Frame::scale`]).
    pub fn surface(&self) -> &HeightField {
        &self.solved.surface
    }

    /// The surface in input units along the frame's axes: over the user's x and y when axes are kept.
    ///
    /// # Errors
    /// Where rounding of the input's own coordinates leaves no distinct knots.
    pub fn input_surface(&self) -> Result<HeightField, FitError> {
        let (height, scale) = (self.solved.origin_height(), self.frame().scale);
        let coefficients = self.surface().coefficients().mapv(|c| height + scale * c);
        Ok(HeightField::new(self.patch().input_knots.clone(), coefficients)?)
    }

    /// The linear problem whose solution the coefficients are (with normal rows: the last Gauss-Newton step's).
    pub fn equations(&self) -> &Equations {
        &self.solved.fitted.equations
    }

    /// Roots of the weights that a robust loss gave every contact, `[heights, slopes]`; `None` without one.
    pub(crate) fn loss_weights(&self) -> Option<&[Vec<f64>; 2]> {
        self.solved.fitted.loss_weights.as_ref()
    }

    /// Coefficients of which the data say nothing or next to nothing, whether or not a roughness penalty told them.
    pub fn without_data(&self) -> Vec<usize> {
        Free::find(&self.equations().data_matrix(), false).list()
    }

    /// lambda of the roughness penalty as it was asked for or found; 0 without.
    pub fn smoothing(&self) -> f64 {
        // extreme weights were multiplied by a power of two, and the penalty by its square
        let unit = self.solved.fitted.noise.unit();
        self.equations().roughness.as_ref().map_or(0.0, |rough| rough.lambda / unit / unit)
    }

    /// The method that gave the coefficients; [`Fit::certificate`] says why.
    pub fn method(&self) -> MethodUsed {
        self.solution().method
    }

    /// Coefficients, factor, reasons, rank, refinement.
    #[doc(hidden)]
    pub fn solution(&self) -> &Solution {
        &self.solved.fitted.solution
    }

    /// Noise sds or weights, declared or found; under weights the sds are computed from the residuals on first access.
    pub fn noise(&self) -> &NoiseSds {
        self.solved.noise()
    }

    /// Where the weights of the rows come from, and the noise sds where the fit itself needed them.
    pub fn noise_at_hand(&self) -> (NoiseSource, Option<NoiseSds>) {
        let record = &self.solved.fitted.noise;
        let known = match record {
            noise::record::NoiseRecord::Known(sds) => Some(*sds),
            noise::record::NoiseRecord::Weighted { .. } => None,
        };
        (record.source(), known)
    }

    /// Root mean square residuals, input units.
    pub fn rms(&self) -> Rms {
        describe::residuals::rms(&self.solved)
    }

    /// Remarks that a user should see.
    pub fn notes(&self) -> &[Note] {
        &self.solved.fitted.notes
    }

    /// Where sds were declared: factors by which the residuals of heights and of normals exceed them, `Some` where they
    /// differ from 1 for certain (p < 0.001 by chi-square) and by more than a quarter.
    pub fn declared_sigma_off(&self) -> [Option<f64>; 2] {
        noise::declared::declared_off(&self.solved)
    }

    /// Probability that touches of a finger share errors, and the correlation of neighbouring ones if they do; `None` where
    /// contacts do not say which finger made them.
    pub fn shared_along_fingers(&self) -> Option<[f64; 2]> {
        let levels = self.solved.levels()?;
        let probability = levels.probability_shared();
        (probability > 0.0).then(|| [probability, levels.correlation()])
    }

    /// 1-norm condition estimate of the equilibrated weighted rows; computed on first access.
    pub fn condition(&self) -> f64 {
        self.solved.condition()
    }
}
