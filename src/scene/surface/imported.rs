//! A surface from elsewhere, `z = h(x, y)`: a fit of real contacts, say.
//!
//! Touching a spline to test a spline is an inverse crime: the model error is zero by construction. Whatever is
//! reported of such a scene says so (see [`super::Surface::inverse_crime`]).

/// A height field that another room supplies.
pub trait ImportedSurface: std::fmt::Debug + Send + Sync {
    /// Where it came from; appears in every output.
    fn label(&self) -> &str;

    /// Whether it is itself a fit, of the same kind as what will be fitted to it. A formula of the caller's own is none:
    /// contacts on it are no inverse crime.
    fn is_fit(&self) -> bool {
        true
    }

    /// `[h, h_x, h_y, h_xx, h_xy, h_yy]` at a point, input units; `None` outside its domain.
    fn jet(&self, x: f64, y: f64) -> Option<[f64; 6]>;
}
