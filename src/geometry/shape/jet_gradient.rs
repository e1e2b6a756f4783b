//! Derivatives of S and R at a point of any surface by its first and second derivatives.
//!
//! ```text
//! S = -(2/pi) atan2(a + c, d),  R = sqrt(a^2 + c^2 + 2 b^2)/sqrt 2,  d = sqrt((a - c)^2 + 4 b^2)
//! [a b; b c]  the shape operator along e1 = Q_u/|Q_u|, e2 = n x e1
//! ```
//!
//! At an umbilic d has a kink; the derivative of d is dropped there, as for height fields.

use super::dual::{Dual, DualVector, cross, dot};
use crate::curvature::Derivatives;

/// Numbers that S depends on: Q_u, Q_v, Q_uu, Q_uv, Q_vv.
pub const INPUTS: usize = 15;

type D = Dual<INPUTS>;

/// `(dS, dR)` by the fifteen numbers; `None` without a tangent plane or without bending.
pub fn jet_gradient(q: &Derivatives) -> Option<([f64; INPUTS], [f64; INPUTS])> {
    let values = [q.u, q.v, q.uu, q.uv, q.vv];
    let [u, v, uu, uv, vv]: [DualVector<INPUTS>; 5] =
        std::array::from_fn(|k| std::array::from_fn(|d| D::variable(values[k][d], 3 * k + d)));
    let area = cross(&u, &v);
    let square = dot(&area, &area);
    if square.value.is_nan() || square.value <= 0.0 {
        return None;
    }
    let jacobian = square.sqrt();
    let inverse = jacobian.recip();
    let n = area.map(|x| x * inverse);
    let (e, f) = (dot(&u, &u), dot(&u, &v));
    let [h11, h12, h22] = [&uu, &uv, &vv].map(|w| dot(w, &n));
    // Q_v - s Q_u is perpendicular to Q_u; its length is |area|/sqrt e
    let s = f * e.recip();
    let a = h11 * e.recip();
    let b = (h12 - s * h11) * inverse;
    let c = (h22 - (s * h12).times(2.0) + s * s * h11) * e * inverse * inverse;
    let (sum, gap) = (a + c, a - c);
    let squared = gap * gap + (b * b).times(4.0);
    let d = if squared.value > 0.0 { squared.sqrt() } else { D::constant(0.0) };
    let size = sum.value * sum.value + d.value * d.value;
    if size.is_nan() || size <= 0.0 {
        return None;
    }
    let curvedness = (a * a + c * c + (b * b).times(2.0)).times(0.5).sqrt();
    let by_s = std::array::from_fn(|k| {
        -std::f64::consts::FRAC_2_PI * (d.value * sum.slope[k] - sum.value * d.slope[k]) / size
    });
    Some((by_s, curvedness.slope))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gradients_match_differences() {
        let at = |v: [f64; INPUTS]| {
            let part = |k: usize| [v[3 * k], v[3 * k + 1], v[3 * k + 2]];
            Derivatives { u: part(0), v: part(1), uu: part(2), uv: part(3), vv: part(4) }
        };
        let v: [f64; INPUTS] = std::array::from_fn(|k| ((k * k) as f64 * 0.7 + 0.3).sin());
        let (ds, dr) = jet_gradient(&at(v)).unwrap();
        let shape = |v| {
            let p = at(v).principal().unwrap();
            [p.shape_index().unwrap(), p.curvedness()]
        };
        for k in 0..INPUTS {
            let (mut up, mut down) = (v, v);
            up[k] += 1e-6;
            down[k] -= 1e-6;
            let (hi, lo) = (shape(up), shape(down));
            assert!((ds[k] - (hi[0] - lo[0]) / 2e-6).abs() < 1e-6 * (1.0 + ds[k].abs()), "S {k}");
            assert!((dr[k] - (hi[1] - lo[1]) / 2e-6).abs() < 1e-6 * (1.0 + dr[k].abs()), "R {k}");
        }
    }
}
