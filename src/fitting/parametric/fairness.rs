//! Penalties that determine the surface where contacts do not: E penalises changes of curvature along the surface, T
//! uneven parametrisation.
//!
//! ```text
//! E = integral |grad h|^2 dA            h the second fundamental form, h_ij = n . Q_ij
//! grad_k h_ij = n . Q_ijk - G^l_ij h_lk - G^l_jk h_li - G^l_ki h_lj          G^l_ij = g^lm Q_m . Q_ij
//! T = integral |Q_uu^t|^2 + 2 |Q_uv^t|^2 + |Q_vv^t|^2 du dv                 ^t: tangential part
//! ```
//!
//! E does not depend on the parametrisation and vanishes exactly on planes, spheres and cylinders, whose h is parallel, so
//! that it does not flatten a ball as a thin plate would. It is the covariant relative of the minimum variation surface of
//! H. P. Moreton and C. H. Séquin, *Computer Graphics* 26 (1992) 167. T determines how the coefficients lie along the
//! surface, on which neither E nor the distances of the contacts depend.
//!
//! Both depend on the jet through sixteen numbers of the frame e1 = Q_u/l, e2 = n x e1, n:
//!
//! ```text
//! Q_u = l e1,  Q_v = s e1 + t e2,  Q_ij = x e1 + y e2 + h n,  n . Q_ijk = z
//! de1 = A e2 + C n,  dn = -C e1 + B e2,  de2 = -A e1 - B n,    A = dQ_u.e2/l,  C = dQ_u.n/l,  B = (s C - dQ_v.n)/t
//! ```

use super::vector::{Vector, cross, dot, norm};

/// Q_u, Q_v, Q_uu, Q_uv, Q_vv, Q_uuu, Q_uuv, Q_uvv, Q_vvv.
pub(super) type ThirdJet = [Vector; 9];
/// Residuals at a point: four of E, six of T.
pub(super) const RESIDUALS: usize = 10;

/// Orders of the derivatives of a [`ThirdJet`].
pub(super) const ORDERS: [(usize, usize); 9] = [(1, 0), (0, 1), (2, 0), (1, 1), (0, 2), (3, 0), (2, 1), (1, 2), (0, 3)];

/// Weights that make the squares of the residuals the integrands: a mixed component of a symmetric tensor counts
/// as often as it occurs.
const SHARES: [f64; 3] = [1.0, std::f64::consts::SQRT_2, 1.0];
const ROOT_3: f64 = 1.732_050_807_568_877_2;

/// The sixteen numbers, and the frame that they belong to.
struct JetInFrame {
    frame: [Vector; 3],
    l: f64,
    s: f64,
    t: f64,
    /// x, y, h of Q_uu, Q_uv, Q_vv.
    second: [Vector; 3],
    /// The same of Q_uuu .. Q_vvv; their third is z.
    third: [Vector; 4],
}

/// Derivatives of a residual by the sixteen numbers.
#[derive(Default)]
struct ByFrame {
    l: f64,
    s: f64,
    t: f64,
    second: [Vector; 3],
    z: [f64; 4],
}

/// `grad h` along (u, v), and the factors that it is made of.
struct CurvatureChange {
    /// D_111, D_112, D_122, D_222.
    along: [f64; 4],
    /// h(e1, k), h(e2, k).
    p: [f64; 2],
    q: [f64; 2],
    /// e1 = a Q_u, e2 = b Q_u + d Q_v; root of the Jacobian.
    a: f64,
    b: f64,
    d: f64,
    root: f64,
}

/// The jet in its own frame; `None` where the surface has no tangent plane.
fn in_own_frame(jet: &ThirdJet) -> Option<JetInFrame> {
    let area = cross(jet[0], jet[1]);
    let (jacobian, l) = (norm(area), norm(jet[0]));
    if !(jacobian > 0.0 && jacobian.is_finite() && l > 0.0) {
        return None;
    }
    let (n, e1) = (area.map(|a| a / jacobian), jet[0].map(|a| a / l));
    let frame = [e1, cross(n, e1), n];
    let within = |w: Vector| frame.map(|e| dot(e, w));
    Some(JetInFrame {
        frame,
        l,
        s: dot(jet[1], e1),
        t: jacobian / l,
        second: [within(jet[2]), within(jet[3]), within(jet[4])],
        third: [within(jet[5]), within(jet[6]), within(jet[7]), within(jet[8])],
    })
}

fn change(f: &JetInFrame) -> CurvatureChange {
    let (a, d) = (1.0 / f.l, 1.0 / f.t);
    let [[x1, y1, h1], [x2, y2, h2], [x3, y3, h3]] = f.second;
    let p = [h1 * a, h2 * a];
    let q = [(h2 - f.s * p[0]) * d, (h3 - f.s * p[1]) * d];
    let z = f.third.map(|w| w[2]);
    let along = [
        z[0] - 3.0 * (x1 * p[0] + y1 * q[0]),
        z[1] - (x1 * p[1] + y1 * q[1]) - 2.0 * (x2 * p[0] + y2 * q[0]),
        z[2] - (x3 * p[0] + y3 * q[0]) - 2.0 * (x2 * p[1] + y2 * q[1]),
        z[3] - 3.0 * (x3 * p[1] + y3 * q[1]),
    ];
    CurvatureChange { along, p, q, a, b: -f.s * a * d, d, root: (f.l * f.t).sqrt() }
}

/// Rows that transform D along (u, v) to its components along e1, e2, without the root of the Jacobian.
fn frame_rows(c: &CurvatureChange) -> [[f64; 4]; 4] {
    let CurvatureChange { a, b, d, .. } = *c;
    [
        [a * a * a, 0.0, 0.0, 0.0],
        [ROOT_3 * a * a * b, ROOT_3 * a * a * d, 0.0, 0.0],
        [ROOT_3 * a * b * b, 2.0 * ROOT_3 * a * b * d, ROOT_3 * a * d * d, 0.0],
        [b * b * b, 3.0 * b * b * d, 3.0 * b * d * d, d * d * d],
    ]
}

/// Derivatives of the four components by a, b, d.
fn by_frame_factors(c: &CurvatureChange) -> [[f64; 3]; 4] {
    let CurvatureChange { along: [d0, d1, d2, d3], a, b, d, .. } = *c;
    [
        [3.0 * a * a * d0, 0.0, 0.0],
        [2.0 * ROOT_3 * a * (b * d0 + d * d1), ROOT_3 * a * a * d0, ROOT_3 * a * a * d1],
        [
            ROOT_3 * (b * b * d0 + 2.0 * b * d * d1 + d * d * d2),
            2.0 * ROOT_3 * a * (b * d0 + d * d1),
            2.0 * ROOT_3 * a * (b * d1 + d * d2),
        ],
        [0.0, 3.0 * (b * b * d0 + 2.0 * b * d * d1 + d * d * d2), 3.0 * (b * b * d1 + 2.0 * b * d * d2 + d * d * d3)],
    ]
}

fn values_of(f: &JetInFrame, c: &CurvatureChange) -> [f64; RESIDUALS] {
    let mut out = [0.0; RESIDUALS];
    for (value, row) in out.iter_mut().zip(frame_rows(c)) {
        *value = c.root * (0..4).map(|k| row[k] * c.along[k]).sum::<f64>();
    }
    for (k, share) in SHARES.into_iter().enumerate() {
        (out[4 + 2 * k], out[5 + 2 * k]) = (share * f.second[k][0], share * f.second[k][1]);
    }
    out
}

/// Square roots of the integrands of E (per du dv) and T; `None` where the surface has no tangent plane.
pub(super) fn values(jet: &ThirdJet) -> Option<[f64; RESIDUALS]> {
    let f = in_own_frame(jet)?;
    let c = change(&f);
    Some(values_of(&f, &c))
}

/// The same with their derivatives by the vectors of the jet.
pub(super) fn residuals(jet: &ThirdJet) -> Option<([f64; RESIDUALS], [ThirdJet; RESIDUALS])> {
    let f = in_own_frame(jet)?;
    let c = change(&f);
    let values = values_of(&f, &c);
    let mut slopes = [[[0.0; 3]; 9]; RESIDUALS];
    let (rows, factors) = (frame_rows(&c), by_frame_factors(&c));
    for k in 0..4 {
        slopes[k] = f.pulled_back(&by_change(&f, &c, &rows[k], &factors[k], values[k]));
    }
    for (k, share) in SHARES.into_iter().enumerate() {
        for along in 0..2 {
            let mut by = ByFrame::default();
            by.second[k][along] = share;
            slopes[4 + 2 * k + along] = f.pulled_back(&by);
        }
    }
    Some((values, slopes))
}

/// Derivatives of one component of grad h: through D, through a, b, d, and through the root of the Jacobian.
fn by_change(f: &JetInFrame, c: &CurvatureChange, row: &[f64; 4], by: &[f64; 3], value: f64) -> ByFrame {
    let [w0, w1, w2, w3] = row.map(|w| c.root * w);
    let [[x1, y1, _], [x2, y2, _], [x3, y3, _]] = f.second;
    let (p, q) = (c.p, c.q);
    let by_x = |pq: [f64; 2]| {
        [-3.0 * w0 * pq[0] - w1 * pq[1], -2.0 * (w1 * pq[0] + w2 * pq[1]), -w2 * pq[0] - 3.0 * w3 * pq[1]]
    };
    let (gx, gy) = (by_x(p), by_x(q));
    let by_p = |one: f64, two: f64, three: f64| {
        [-3.0 * w0 * one - 2.0 * w1 * two - w2 * three, -w1 * one - 2.0 * w2 * two - 3.0 * w3 * three]
    };
    let (mut gp, gq) = (by_p(x1, x2, x3), by_p(y1, y2, y3));
    let mut out = ByFrame { z: [w0, w1, w2, w3], ..ByFrame::default() };
    let mut gh = [0.0; 3];
    for k in 0..2 {
        // q_k = (h_2k - s p_k)/t, p_k = h_1k/l
        gh[k + 1] += gq[k] * c.d;
        out.s -= gq[k] * p[k] * c.d;
        out.t -= gq[k] * q[k] * c.d;
        gp[k] -= gq[k] * f.s * c.d;
        gh[k] += gp[k] * c.a;
        out.l -= gp[k] * p[k] * c.a;
    }
    for k in 0..3 {
        out.second[k] = [gx[k], gy[k], gh[k]];
    }
    let [by_a, by_b, by_d] = by.map(|v| c.root * v);
    out.l += -by_a * c.a * c.a - by_b * c.a * c.b + 0.5 * value * c.a;
    out.s -= by_b * c.a * c.d;
    out.t += -by_b * c.b * c.d - by_d * c.d * c.d + 0.5 * value * c.d;
    out
}

impl JetInFrame {
    /// Derivatives by the vectors of the jet, from those by the sixteen numbers.
    fn pulled_back(&self, by: &ByFrame) -> ThirdJet {
        let (mut spin_a, mut spin_b, mut spin_c) = (by.s * self.t - by.t * self.s, 0.0, 0.0);
        for (g, w) in by.second.iter().zip(&self.second) {
            spin_a += g[0] * w[1] - g[1] * w[0];
            spin_b += g[2] * w[1] - g[1] * w[2];
            spin_c += g[0] * w[2] - g[2] * w[0];
        }
        for (g, w) in by.z.iter().zip(&self.third) {
            spin_b += g * w[1];
            spin_c -= g * w[0];
        }
        let [e1, e2, n] = self.frame;
        let space = |[a, b, c]: Vector| [0, 1, 2].map(|k| a * e1[k] + b * e2[k] + c * n[k]);
        let along_n = |c: f64| n.map(|v| c * v);
        let by_u = [by.l, spin_a / self.l, (spin_c + spin_b * self.s / self.t) / self.l];
        [
            space(by_u),
            space([by.s, by.t, -spin_b / self.t]),
            space(by.second[0]),
            space(by.second[1]),
            space(by.second[2]),
            along_n(by.z[0]),
            along_n(by.z[1]),
            along_n(by.z[2]),
            along_n(by.z[3]),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::shape::dual::{Dual, DualVector, cross, dot};

    const INPUTS: usize = 27;
    type D = Dual<INPUTS>;

    /// The residuals as their formulas stand, differentiated by dual numbers, to check the closed forms.
    fn by_duals(jet: &ThirdJet) -> Option<[D; RESIDUALS]> {
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
            let r = values(&jet(f, 0.3, 0.4)).unwrap();
            r[..4].iter().map(|v| v * v).sum::<f64>().sqrt()
        };
        assert!(size(&sphere) < 1e-5, "{}", size(&sphere));
        assert!(size(&cylinder) < 1e-5, "{}", size(&cylinder));
        assert!(size(&dish) > 0.1, "{}", size(&dish));
    }

    #[test]
    fn closed_forms_match_dual_numbers() {
        for seed in 0..20 {
            let jet: ThirdJet = std::array::from_fn(|k| {
                std::array::from_fn(|d| ((seed * 27 + 3 * k + d) as f64 * 0.717 + 0.3).sin() * 1.5)
            });
            let (found, slopes) = residuals(&jet).unwrap();
            assert_eq!(found, values(&jet).unwrap());
            for (k, expected) in by_duals(&jet).unwrap().iter().enumerate() {
                let size = expected.slope.iter().fold(expected.value.abs(), |m, s| m.max(s.abs()));
                assert!((found[k] - expected.value).abs() < 1e-13 * size, "value {k}");
                for (a, b) in slopes[k].as_flattened().iter().zip(&expected.slope) {
                    assert!((a - b).abs() < 1e-12 * size, "slope of {k}: {a} is not {b}");
                }
            }
        }
    }

    #[test]
    fn a_surface_without_a_tangent_plane_has_no_residuals() {
        assert!(residuals(&[[1.0, 2.0, 3.0]; 9]).is_none());
    }
}
