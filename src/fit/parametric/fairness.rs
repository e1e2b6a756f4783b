//! What holds the surface where contacts do not: bending may be any, its change along the surface is paid for.
//!
//! ```text
//! E = integral |grad h|^2 dA            h the second fundamental form, h_ij = n . Q_ij
//! grad_k h_ij = n . Q_ijk - G^l_ij h_lk - G^l_jk h_li - G^l_ki h_lj          G^l_ij = g^lm Q_m . Q_ij
//! T = integral |Q_uu^t|^2 + 2 |Q_uv^t|^2 + |Q_vv^t|^2 du dv                 ^t: tangential part
//! ```
//!
//! E does not see how the surface is parametrised and vanishes exactly on planes, spheres and cylinders, whose h is
//! parallel: nothing pulls a ball flat, as a thin plate would. It is the covariant relative of the minimum variation
//! surface of H. P. Moreton and C. H. Séquin, *Computer Graphics* 26 (1992) 167. T moves the coefficients only along the
//! surface: without it nothing would, since neither E nor the distance of the contacts does.

use super::dual::{Dual, DualVector, cross, dot};

/// Q_u, Q_v, Q_uu, Q_uv, Q_vv, Q_uuu, Q_uuv, Q_uvv, Q_vvv.
pub type ThirdJet = [[f64; 3]; 9];
/// Residuals at a point: four of E, six of T.
pub const RESIDUALS: usize = 10;
/// Numbers in a [`ThirdJet`].
pub const INPUTS: usize = 27;

type D = Dual<INPUTS>;

/// Orders of the derivatives of a [`ThirdJet`].
pub const ORDERS: [(usize, usize); 9] = [(1, 0), (0, 1), (2, 0), (1, 1), (0, 2), (3, 0), (2, 1), (1, 2), (0, 3)];

/// Square roots of the integrands of E (per du dv) and T, with derivatives; `None` where the map has no tangent plane.
pub fn residuals(jet: &ThirdJet) -> Option<[D; RESIDUALS]> {
    let q: [DualVector<INPUTS>; 9] =
        std::array::from_fn(|k| std::array::from_fn(|d| D::variable(jet[k][d], 3 * k + d)));
    let [q1, q2, q11, q12, q22, ..] = &q;
    let (e, f, area) = (dot(q1, q1), dot(q1, q2), cross(q1, q2));
    let square = dot(&area, &area);
    if !(square.value > 0.0 && square.value.is_finite()) {
        return None;
    }
    let jacobian = square.sqrt();
    let inverse = jacobian.recip();
    let n = area.map(|a| a * inverse);
    // e1 = a q1, e2 = b q1 + d q2
    let length = e.sqrt();
    let a = length.recip();
    let d = length * inverse;
    let b = -(f * a * inverse);
    let e1: DualVector<INPUTS> = q1.map(|x| x * a);
    let e2: DualVector<INPUTS> = std::array::from_fn(|k| q1[k] * b + q2[k] * d);
    // components of Q_ij along e1, e2: with them G^l_ij h_lk = t1 h(e1, k) + t2 h(e2, k)
    let tangential = [q11, q12, q22].map(|w| [dot(w, &e1), dot(w, &e2)]);
    let h = [q11, q12, q22].map(|w| dot(w, &n));
    let h_frame = |k: usize| [h[k] * a, h[k] * b + h[k + 1] * d];
    let h_along = [h_frame(0), h_frame(1)];
    let bend = |ij: usize, k: usize| tangential[ij][0] * h_along[k][0] + tangential[ij][1] * h_along[k][1];
    let t = [
        dot(&q[5], &n) - bend(0, 0).times(3.0),
        dot(&q[6], &n) - bend(0, 1) - bend(1, 0).times(2.0),
        dot(&q[7], &n) - bend(2, 0) - bend(1, 1).times(2.0),
        dot(&q[8], &n) - bend(2, 1).times(3.0),
    ];
    let frame = in_frame(&t, a, b, d);
    let root = jacobian.sqrt();
    let r2 = std::f64::consts::SQRT_2;
    let [uu, uv, vv] = tangential;
    Some([
        frame[0] * root,
        frame[1] * root,
        frame[2] * root,
        frame[3] * root,
        uu[0],
        uu[1],
        uv[0].times(r2),
        uv[1].times(r2),
        vv[0],
        vv[1],
    ])
}

/// Components of the symmetric tensor `t` along e1, e2, weighted so that their squares sum to its norm.
fn in_frame(t: &[D; 4], a: D, b: D, d: D) -> [D; 4] {
    let r3 = 3.0_f64.sqrt();
    let (a2, b2, d2) = (a * a, b * b, d * d);
    [
        a2 * a * t[0],
        (a2 * (b * t[0] + d * t[1])).times(r3),
        (a * (b2 * t[0] + (b * d * t[1]).times(2.0) + d2 * t[2])).times(r3),
        b2 * b * t[0] + (b2 * d * t[1]).times(3.0) + (b * d2 * t[2]).times(3.0) + d2 * d * t[3],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sphere of radius 2 in a skew parametrisation, derivatives by differences of exact lower ones.
    fn jet(f: impl Fn(f64, f64) -> [f64; 3], u: f64, v: f64) -> ThirdJet {
        let h = 2e-3;
        // central differences of order k along u and l along v, error h^4
        let first = [(-2.0, 1.0 / 12.0), (-1.0, -8.0 / 12.0), (1.0, 8.0 / 12.0), (2.0, -1.0 / 12.0)];
        let apply = |k: usize, l: usize| -> [f64; 3] {
            let mut terms = vec![(0.0, 0.0, 1.0)];
            for axis in (0..k).map(|_| 0).chain((0..l).map(|_| 1)) {
                terms = terms
                    .iter()
                    .flat_map(|&(x, y, w): &(f64, f64, f64)| {
                        first.map(|(s, c)| if axis == 0 { (x + s, y, w * c / h) } else { (x, y + s, w * c / h) })
                    })
                    .collect();
            }
            let mut sum = [0.0; 3];
            for (x, y, w) in terms {
                let p = f(u + x * h, v + y * h);
                (0..3).for_each(|d| sum[d] += w * p[d]);
            }
            sum
        };
        ORDERS.map(|(k, l)| apply(k, l))
    }

    #[test]
    fn spheres_and_cylinders_cost_nothing_and_paraboloids_do() {
        let sphere = |u: f64, v: f64| {
            let (x, y) = (0.4 * u + 0.1 * v * v, 0.3 * v - 0.1 * u);
            [2.0 * x.cos() * y.sin(), 2.0 * x.sin(), 2.0 * x.cos() * y.cos()]
        };
        let cylinder = |u: f64, v: f64| [(u + 0.2 * v).sin(), (u + 0.2 * v).cos(), v + 0.1 * u * v];
        let dish = |u: f64, v: f64| [u, v, u * u + 0.5 * v * v];
        let size = |f: &dyn Fn(f64, f64) -> [f64; 3]| {
            let r = residuals(&jet(f, 0.3, 0.4)).unwrap();
            r[..4].iter().map(|d| d.value * d.value).sum::<f64>().sqrt()
        };
        assert!(size(&sphere) < 1e-5, "{}", size(&sphere));
        assert!(size(&cylinder) < 1e-5, "{}", size(&cylinder));
        assert!(size(&dish) > 0.1, "{}", size(&dish));
    }

    #[test]
    fn a_map_without_a_tangent_plane_is_no_number() {
        assert!(residuals(&[[1.0, 2.0, 3.0]; 9]).is_none());
    }
}
