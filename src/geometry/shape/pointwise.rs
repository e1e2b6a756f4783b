//! Uncertainty of position, normal, S and R at one point of a surface, by the delta method.
//!
//! ```text
//! position   n . dQ
//! normal     t_k . dn = (dQ_u . (Q_v x t_k) + dQ_v . (t_k x Q_u)) / |Q_u x Q_v|,  t_1, t_2 tangents of length 1
//! S, R       their gradients by Q_u, Q_v, Q_uu, Q_uv, Q_vv
//! u^2 = g' C g,   g the functional's gradient by the coefficients, C their covariance
//! ```
//!
//! The normal's is the root mean square of the angle by which noise turns it. What C is, and how `g' C g` is formed, each kind of fit
//! knows for itself.

use super::PointSds;
use super::jet_gradient::jet_gradient;
use crate::surface::Jet;
use palpate_numeric::vector::{Vector, cross, norm, scaled, unit};

/// Derivatives of a functional by Q, Q_u, Q_v, Q_uu, Q_uv, Q_vv.
pub type ByJet = [Vector; 6];

/// A surface with the covariance of its coefficients.
pub trait Uncertain {
    /// Position and derivatives at a place.
    fn jet(&self, at: [f64; 2]) -> Jet;

    /// Standard uncertainty of a functional of the surface at a place; `None` where nothing tells the noise.
    fn functional_sd(&self, at: [f64; 2], by: &ByJet) -> Option<f64>;

    /// Standard uncertainties of S and of R.
    fn shape_sds(&self, at: [f64; 2], jet: &Jet) -> [Option<f64>; 2] {
        let Some((of_s, of_r)) = jet_gradient(&jet.derivatives) else { return [None; 2] };
        [of_s, of_r].map(|g| {
            let by = |k: usize| if k == 0 { [0.0; 3] } else { std::array::from_fn(|d| g[3 * (k - 1) + d]) };
            self.functional_sd(at, &std::array::from_fn(by))
        })
    }
}

/// Standard uncertainties at one place, in the units of the surface; `None` without a tangent plane, and where nothing tells the noise.
pub fn point_sds(surface: &impl Uncertain, at: [f64; 2]) -> Option<PointSds> {
    const NOT: Vector = [0.0; 3];
    let jet = surface.jet(at);
    let here = &jet.derivatives;
    let area = cross(here.u, here.v);
    let jacobian = norm(area);
    let n = unit(area);
    if !n.iter().all(|v| v.is_finite()) {
        return None;
    }
    let first = unit(here.u);
    let tilt = |t: Vector| {
        let by = |a, b| scaled(1.0 / jacobian, cross(a, b));
        surface.functional_sd(at, &[NOT, by(here.v, t), by(t, here.u), NOT, NOT, NOT])
    };
    let [one, two] = [tilt(first)?, tilt(cross(n, first))?];
    let [shape_index, curvedness] = surface.shape_sds(at, &jet);
    Some(PointSds {
        position: surface.functional_sd(at, &[n, NOT, NOT, NOT, NOT, NOT])?,
        normal: (one * one + two * two).sqrt(),
        shape_index,
        curvedness,
    })
}
