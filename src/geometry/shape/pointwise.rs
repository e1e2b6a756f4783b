//! Uncertainty of position, normal, S, R, k1 and k2 at one point of a surface, by the delta method.
//!
//! ```text
//! position   n . dQ
//! normal     t_k . dn = (dQ_u . (Q_v x t_k) + dQ_v . (t_k x Q_u)) / |Q_u x Q_v|,  t_1, t_2 tangents of length 1
//! S, R       their gradients by Q_u, Q_v, Q_uu, Q_uv, Q_vv
//! k1, k2     R (+-cos a - sin a),  a = pi S / 2:  (+-cos a - sin a) dR - R (+-sin a + cos a) da
//! u^2 = g' C g,   g the functional's gradient by the coefficients, C their covariance
//! ```
//!
//! The normal's is the root mean square of the angle by which noise turns it. What C is, and how `g' C g` is formed, each kind of fit
//! knows for itself.

use std::f64::consts::FRAC_PI_2;

use super::PointSds;
use super::jet_gradient::jet_gradient;
use crate::surface::Jet;
use palpate_numeric::vector::{Vector, cross, norm, scaled, unit};

/// Derivatives of a functional by Q, Q_u, Q_v, Q_uu, Q_uv, Q_vv.
pub type ByJet = [Vector; 6];

/// Standard uncertainties of S, R, k1 and k2.
pub type ShapeSds = [Option<f64>; 4];

/// Gradients of k1 and k2 from those of S and R, at these values.
pub fn principal_gradients<const N: usize>([s, r]: [f64; 2], of_s: &[f64; N], of_r: &[f64; N]) -> [[f64; N]; 2] {
    let (sin, cos) = (FRAC_PI_2 * s).sin_cos();
    [1.0, -1.0].map(|sign| {
        let (by_r, by_s) = (sign * cos - sin, -FRAC_PI_2 * r * (sign * sin + cos));
        std::array::from_fn(|k| by_r * of_r[k] + by_s * of_s[k])
    })
}

/// A surface with the covariance of its coefficients.
pub trait Uncertain {
    /// Position and derivatives at a place.
    fn jet(&self, at: [f64; 2]) -> Jet;

    /// Standard uncertainty of a functional of the surface at a place; `None` where nothing tells the noise.
    fn functional_sd(&self, at: [f64; 2], by: &ByJet) -> Option<f64>;

    /// Standard uncertainties of S, R, k1 and k2.
    fn shape_sds(&self, at: [f64; 2], jet: &Jet) -> ShapeSds {
        let Some((of_s, of_r)) = jet_gradient(&jet.derivatives) else { return [None; 4] };
        let here = jet.derivatives.principal().and_then(|p| Some([p.shape_index()?, p.curvedness()]));
        let Some(here) = here else { return [None; 4] };
        let [of_k1, of_k2] = principal_gradients(here, &of_s, &of_r);
        [of_s, of_r, of_k1, of_k2].map(|g| {
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
    let [shape_index, curvedness, k1, k2] = surface.shape_sds(at, &jet);
    Some(PointSds {
        position: surface.functional_sd(at, &[n, NOT, NOT, NOT, NOT, NOT])?,
        normal: (one * one + two * two).sqrt(),
        shape_index,
        curvedness,
        curvatures: k1.zip(k2).map(<[f64; 2]>::from),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curvature::{curvedness, shape_index};

    #[test]
    fn gradients_of_curvatures_undo_those_of_shape_index_and_curvedness() {
        for [k1, k2] in [[0.3, 0.1], [0.2, -0.5], [-0.1, -0.4], [0.2, 0.0]] {
            // S and R as functions of k1 and k2
            let shape = |k1: f64, k2: f64| [shape_index(k1 + k2, k1 - k2).unwrap(), curvedness(k1, k2)];
            let step = 1e-6;
            let by = |which: usize| -> [f64; 2] {
                let up = shape(k1 + step, k2)[which] - shape(k1 - step, k2)[which];
                let over = shape(k1, k2 + step)[which] - shape(k1, k2 - step)[which];
                [up, over].map(|difference| difference / (2.0 * step))
            };
            let [one, two] = principal_gradients(shape(k1, k2), &by(0), &by(1));
            for (found, expected) in [(one, [1.0, 0.0]), (two, [0.0, 1.0])] {
                assert!((0..2).all(|k| (found[k] - expected[k]).abs() < 1e-6), "{k1} {k2}: {found:?}");
            }
        }
    }
}
