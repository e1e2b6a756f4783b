//! A finished parametric fit and what can be asked of it.

use std::sync::OnceLock;

use super::certificate::ParametricCertificate;
use super::describe::{ParametricShape, describe};
use super::fit_data::FitData;
use crate::fit::{FitError, FitOptions};
use palpate_geometry::contact::Frame;
use palpate_geometry::shape::UvSupport;
use palpate_geometry::surface::Parametric;

/// Noise sds and the weight of fairness.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct ParametricNoise {
    /// Sd of the distance to the surface, input units.
    pub position: f64,
    /// Sd of the normal per tangent axis, degrees.
    pub normal_deg: f64,
    /// lambda of E, patch units.
    pub fairness: f64,
    /// Whether any of the three was estimated rather than declared.
    pub estimated: bool,
}

/// A fitted parametric surface, from [`ParametricFit::new`] or [`FittedSurface::of`](super::FittedSurface::of).
///
/// ```
/// # use palpate_fitting::facade as palpate;
/// use palpate::Contacts;
/// use palpate::fit::{FitOptions, SurfaceKind};
/// use palpate::parametric::ParametricFit;
///
/// // a half ball of radius 2, touched by five fingers at nine stations
/// let (mut points, mut normals) = (Vec::new(), Vec::new());
/// for finger in 0..5 {
///     for station in 0..9 {
///         let (a, b) = (f64::from(finger - 2) * 0.3, f64::from(station - 4) * 0.3);
///         let n = [a.sin() * b.cos(), b.sin(), a.cos() * b.cos()];
///         points.push(n.map(|v| 2.0 * v));
///         normals.push(n);
///     }
/// }
/// let contacts = Contacts::from_points(&points).with_normal_vectors(&normals);
/// let mut options = FitOptions::default();
/// options.surface = SurfaceKind::Parametric;
/// options.degree = [3, 3];
/// let fit = ParametricFit::new(&contacts, &options)?;
/// let shape = fit.shape();
/// assert!(shape.curvedness.mean.is_some_and(|r| (r - 0.5).abs() < 0.02));
/// assert!(fit.certificate().fold_free);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct ParametricFit {
    pub(super) data: FitData,
    pub(super) certificate: ParametricCertificate,
    pub(super) noise: ParametricNoise,
    pub(super) shape: OnceLock<ParametricShape>,
}

impl ParametricFit {
    /// The frame that the fit worked in: the axes of the input, with another origin and unit.
    pub fn frame(&self) -> &Frame {
        &self.data.frame
    }

    /// The options of the fit.
    pub fn options(&self) -> &FitOptions {
        &self.data.options
    }

    /// The surface in patch coordinates.
    pub fn surface(&self) -> &Parametric {
        &self.data.surface
    }

    /// The surface in input units; u and v are lengths in input units too.
    ///
    /// # Errors
    /// Knots that are no longer distinct once they are rounded in input units.
    pub fn input_surface(&self) -> Result<Parametric, FitError> {
        Ok(self.data.surface.placed(self.data.frame.origin, self.data.frame.scale)?)
    }

    /// Where contacts reach in (u, v), input units.
    pub fn input_support(&self) -> UvSupport {
        self.data.support.scaled(self.data.frame.scale)
    }

    /// How far to trust the fit.
    pub fn certificate(&self) -> &ParametricCertificate {
        &self.certificate
    }

    /// Sd of the distance of contacts to the surface, input units.
    pub fn position_sd(&self) -> f64 {
        self.noise.position
    }

    /// Sd of normals per tangent axis, degrees.
    pub fn normal_sd_deg(&self) -> f64 {
        self.noise.normal_deg
    }

    /// Weight of fairness, lambda, in patch units.
    pub fn fairness(&self) -> f64 {
        self.noise.fairness
    }

    /// Whether either sd or the weight of fairness was estimated rather than declared.
    pub fn noise_is_estimated(&self) -> bool {
        self.noise.estimated
    }

    /// Number of contacts that stood for all until near the minimum; `None` where all took part in every step.
    pub fn standing(&self) -> Option<usize> {
        self.data.standing
    }

    /// (u, v) of the feet of the contacts, input units.
    pub fn feet(&self) -> Vec<[f64; 2]> {
        self.data.feet.places.iter().map(|p| p.map(|t| t * self.data.frame.scale)).collect()
    }

    /// Root mean square distance (input units) and root mean square angle between normals (radians).
    pub fn rms(&self) -> [f64; 2] {
        let count = self.data.residuals.len().max(1) as f64;
        let rms = |k: usize| (self.data.residuals.iter().map(|r| r[k] * r[k]).sum::<f64>() / count).sqrt();
        [rms(0) * self.data.frame.scale, rms(1)]
    }

    /// Standard uncertainties at `points` places each way of (u, v), input units; computed at every call.
    pub fn pointwise(&self, points: usize) -> Option<Vec<Option<palpate_geometry::shape::PointSds>>> {
        super::pointwise::pointwise(&self.data, points)
    }

    /// S, R and the rest over the grid of the options, where contacts reach; computed on first access.
    pub fn shape(&self) -> &ParametricShape {
        self.shape.get_or_init(|| describe(&self.data))
    }
}
