//! Repeated fits of images with slopes: planned once, then fitted frame by frame.
//!
//! ```text
//! every pixel counts alike      c by fast diagonalisation                    complete_plan.rs
//! pixels have weights, or none  c by a matrix that is factored once          masked_plan.rs
//! ```
//!
//! No fit after the first allocates memory.

use ndarray::ArrayView2;

use super::complete_plan::CompletePlan;
use super::error::PlanError;
use super::masked_plan::MaskedPlan;
use super::pixel::Pixel;
use palpate_numeric::bspline::Knots;

/// A stream of images with slopes under fixed axes, knots and weights.
///
/// ```
/// # use palpate_fitting::facade as palpate;
/// use ndarray::Array2;
/// use palpate::spline::{Knots, linspace};
/// use palpate::plans::ImagePlan;
///
/// let axis = Knots::uniform(2, 1, -1.0, 1.0)?;
/// let pixels = linspace(-1.0, 1.0, 5);
/// let mut plan = ImagePlan::new([axis.clone(), axis], &pixels, &pixels, [1.0; 3])?;
/// // z = x^2 as single-precision pixels, indexed [x, y]
/// let z = Array2::from_shape_fn((5, 5), |(i, _)| (pixels[i] * pixels[i]) as f32);
/// let zx = Array2::from_shape_fn((5, 5), |(i, _)| (2.0 * pixels[i]) as f32);
/// let zy = Array2::zeros((5, 5));
/// let coefficients = plan.fit_views(z.view(), zx.view(), zy.view())?;
/// assert!((coefficients[0] - 1.0).abs() < 1e-6 && (coefficients[3] + 1.0).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct ImagePlan(Kind);

#[derive(Clone, Debug)]
enum Kind {
    Complete(Box<CompletePlan>),
    Masked(Box<MaskedPlan>),
}

impl ImagePlan {
    /// Plans for complete images with pixels at `x` by `y`, both increasing, these knots and the block weights
    /// `[wz, wx, wy]`, which multiply residuals.
    ///
    /// # Errors
    /// [`PlanError::Axis`] and [`PlanError::Weight`]; an axis with too few pixels for its knots.
    pub fn new(knots: [Knots; 2], x: &[f64], y: &[f64], weights: [f64; 3]) -> Result<ImagePlan, PlanError> {
        CompletePlan::new(knots, x, y, weights).map(|plan| ImagePlan(Kind::Complete(Box::new(plan))))
    }

    /// The same for images with a mask or weight maps that stay: the weights of heights, x slopes and y slopes, indexed
    /// [x, y], multiply residuals, and a weight of 0 masks a pixel.
    ///
    /// ```
    /// # use palpate_fitting::facade as palpate;
    /// use ndarray::Array2;
    /// use palpate::plans::ImagePlan;
    /// use palpate::spline::{Knots, linspace};
    ///
    /// let axis = Knots::uniform(2, 1, -1.0, 1.0)?;
    /// let pixels = linspace(-1.0, 1.0, 9);
    /// // one pixel is dead
    /// let weights = Array2::from_shape_fn((9, 9), |at| if at == (4, 4) { 0.0 } else { 1.0 });
    /// let maps = [weights.view(), weights.view(), weights.view()];
    /// let mut plan = ImagePlan::masked([axis.clone(), axis], &pixels, &pixels, maps)?;
    /// // z = x^2 as single-precision pixels, indexed [x, y]
    /// let mut z = Array2::from_shape_fn((9, 9), |(i, _)| (pixels[i] * pixels[i]) as f32);
    /// z[[4, 4]] = f32::NAN;
    /// let zx = Array2::from_shape_fn((9, 9), |(i, _)| (2.0 * pixels[i]) as f32);
    /// let zy = Array2::zeros((9, 9));
    /// let coefficients = plan.fit_views(z.view(), zx.view(), zy.view())?;
    /// assert!((coefficients[0] - 1.0).abs() < 1e-6 && (coefficients[3] + 1.0).abs() < 1e-6);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`PlanError::Axis`], [`PlanError::Weight`], [`PlanError::Shape`] of a map; [`PlanError::Solve`] where the pixels
    /// that are left determine no surface.
    pub fn masked(
        knots: [Knots; 2],
        x: &[f64],
        y: &[f64],
        weights: [ArrayView2<'_, f64>; 3],
    ) -> Result<ImagePlan, PlanError> {
        MaskedPlan::new(knots, x, y, weights).map(|plan| ImagePlan(Kind::Masked(Box::new(plan))))
    }

    /// Numbers of the coefficients that a mask leaves without data, or nearly so; they take the values of least roughness.
    pub fn unsupported(&self) -> &[usize] {
        match &self.0 {
            Kind::Complete(_) => &[],
            Kind::Masked(plan) => plan.unsupported(),
        }
    }

    /// Fits one frame and returns the coefficients, n x m, row-major. Heights and slopes are row-major pixels [x, y]; those
    /// of weight 0 are not looked at and may be NaN.
    ///
    /// # Errors
    /// [`PlanError::Length`] for an image that is not as large as the axes say; [`PlanError::Pixel`] for a NaN or
    /// infinite pixel under a weight; [`PlanError::Overflow`].
    pub fn fit_frame(&mut self, z: &[f64], zx: &[f64], zy: &[f64]) -> Result<&[f64], PlanError> {
        match &mut self.0 {
            Kind::Complete(plan) => plan.fit_frame(z, zx, zy),
            Kind::Masked(plan) => plan.fit_frame(z, zx, zy),
        }
    }

    /// Fits one frame given as views of `f64` or `f32` pixels, indexed [x, y], in any memory order.
    ///
    /// Row-major `f64` views are read where they lie; of others one row at a time is converted.
    ///
    /// # Errors
    /// [`PlanError::Shape`] for an image that is not as large as the axes say; [`PlanError::Pixel`];
    /// [`PlanError::Overflow`].
    pub fn fit_views<T: Pixel>(
        &mut self,
        z: ArrayView2<'_, T>,
        zx: ArrayView2<'_, T>,
        zy: ArrayView2<'_, T>,
    ) -> Result<&[f64], PlanError> {
        match &mut self.0 {
            Kind::Complete(plan) => plan.fit_views(z, zx, zy),
            Kind::Masked(plan) => plan.fit_views(z, zx, zy),
        }
    }
}
