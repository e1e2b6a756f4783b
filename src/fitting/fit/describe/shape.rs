//! The shape of a patch as numbers: S and R over a grid, their means, class, radius, and what noise makes of them.
//!
//! ```text
//! sd    spread over the grid points, variation over the patch        u    standard uncertainty of the mean, from noise
//! ```

use palpate_geometry::curvature::ShapeClass;
use palpate_geometry::shape::{GridGradients, Interval, ShapeMaps, Spread};

/// Mean over the patch with spread (variation over the patch) and uncertainty (of the mean, from noise).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Statistic {
    /// Mean over supported points.
    pub mean: Option<f64>,
    /// Sample sd over them.
    pub sd: Option<f64>,
    /// Standard uncertainty of the mean in all, `u^2 = u_noise^2 + u_model^2`.
    pub u: Option<f64>,
    /// Interval for the mean at the options' confidence level.
    pub interval: Option<Interval>,
    /// The part of `u` that comes from noise.
    pub u_noise: Option<f64>,
    /// The part of `u` that comes from doubt about the kind of surface; `None` where no other kind was asked.
    pub u_model: Option<f64>,
    /// Degrees of freedom of `u_noise`, infinite where the noise was declared.
    pub dof: Option<f64>,
    /// Factor by which `u` reaches the farther end of the interval.
    pub coverage_factor: Option<f64>,
}

/// The shape of a patch, in input units.
#[derive(Clone, Debug)]
pub struct Shape {
    /// Maps over the shape grid: x, y along the frame's axes in input units, heights, k1, k2, S, R.
    pub maps: ShapeMaps,
    /// Shape index S; all `None` for a plane.
    pub shape_index: Statistic,
    /// Curvedness R, 1/length.
    pub curvedness: Statistic,
    /// Class of the mean S, or plane.
    pub class: ShapeClass,
    /// Probability of each curved class by the delta method; empty for a plane.
    pub class_probability: Vec<(ShapeClass, f64)>,
    /// Radius of the cap, cup, ridge or rut.
    pub radius: Option<f64>,
    /// Larger principal curvature over the patch.
    pub k1: Spread,
    /// Smaller principal curvature over the patch.
    pub k2: Spread,
    /// Direction of k1 at the patch centre projected to the input's x, y, degrees in [0, 180).
    pub direction_deg: Option<f64>,
    /// The same of the axis: the direction along a ridge or rut, or the longer way of a dome or trough; `None` for the
    /// other classes.
    pub axis_deg: Option<f64>,
    /// Points used / grid points.
    pub support: f64,
    /// p-value of the best plane against the fit.
    pub plane_p: Option<f64>,
    /// Gradients of S and R by the coefficients, for the certificate.
    pub(in crate::fit) gradients: GridGradients,
}
