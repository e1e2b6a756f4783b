//! What is asked about one place of a surface.

use palpate_numeric::vector::Vector;

/// What a drawn surface says about a place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SurfaceReading {
    /// Signed distance, positive on the free side.
    pub(crate) distance: f64,
    /// Normal at its foot, towards the free side.
    pub(crate) normal: Vector,
    /// Principal curvatures there, `k1 >= k2`.
    pub(crate) curvatures: [f64; 2],
}
