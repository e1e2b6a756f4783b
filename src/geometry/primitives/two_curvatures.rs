//! The surface of two constant curvatures from one of its own points: a patch of a torus, with plane, cylinder and sphere as exact
//! special cases.
//!
//! ```text
//! q = (u, v, w)       u, v along the directions of k1 and k2 at the origin, w along the normal there
//! w1 = (2 w  - k2 (w^2  + v^2)) / (1 + q2)    q2 = sqrt((1 - k2 w )^2 + (k2 v)^2)     height over the circle of curvature k2
//! d  = (2 w1 - k1 (w1^2 + u^2)) / (1 + q1)    q1 = sqrt((1 - k1 w1)^2 + (k1 u)^2)     signed distance, positive on the free side
//! ```
//!
//! No branch and no division by a curvature: `d` and its derivatives are smooth through k = 0. k > 0 bends towards the
//! normal. The chart is `(u, v)` as arc lengths; a displacement f along the normal is `Q(u, v, f)`.

use crate::curvature::{Derivatives, curvatures};
use palpate_numeric::vector::Vector;

/// Curvatures times lengths below which the chart's formulas are replaced by their limits.
const FLAT: f64 = 1e-9;

/// A displacement along the normal with its derivatives by the chart: f, f_u, f_v, f_uu, f_uv, f_vv.
pub type NormalJet = [f64; 6];

/// Two constant curvatures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoCurvatures {
    /// Along u.
    pub k1: f64,
    /// Along v.
    pub k2: f64,
}

/// Height over a circle through the origin, tangent to `across` there, of curvature `k`, and the distance from its middle in radii,
/// which is 1 for a line. `length` is that of the two legs of a right triangle: it may be `hypot`, or faster where nothing overflows.
#[inline]
pub fn over_circle(k: f64, across: f64, height: f64, length: impl Fn(f64, f64) -> f64) -> (f64, f64) {
    let q = length(1.0 - k * height, k * across);
    ((2.0 * height - k * (height * height + across * across)) / (1.0 + q), q)
}

/// Intermediate values of the distance formula.
struct Profile {
    w1: f64,
    d: f64,
    q1: f64,
    q2: f64,
}

impl TwoCurvatures {
    #[inline]
    fn profile(self, [u, v, w]: Vector) -> Profile {
        // both legs are near 1 in the units of a patch
        let length = |a: f64, b: f64| (a * a + b * b).sqrt();
        let (w1, q2) = over_circle(self.k2, v, w, length);
        let (d, q1) = over_circle(self.k1, u, w1, length);
        Profile { w1, d, q1, q2 }
    }

    /// Derivatives of the distance by (u, v, w).
    #[inline]
    fn gradient(self, [u, v, w]: Vector, p: &Profile) -> Vector {
        let by_w1 = (1.0 - self.k1 * p.w1) / p.q1;
        [-self.k1 * u / p.q1, -by_w1 * self.k2 * v / p.q2, by_w1 * (1.0 - self.k2 * w) / p.q2]
    }

    /// Signed distance and its gradient, the unit normal at the foot point.
    #[inline]
    pub fn distance(self, q: Vector) -> (f64, Vector) {
        let p = self.profile(q);
        (p.d, self.gradient(q, &p))
    }

    /// Signed distance, its gradient, and its derivatives by the two curvatures.
    #[inline]
    pub fn distance_by_curvatures(self, q: Vector) -> (f64, Vector, [f64; 2]) {
        let ([u, v, w], p) = (q, self.profile(q));
        let by_k1 = (p.d * p.d - p.w1 * p.w1 - u * u) / (2.0 * p.q1);
        let by_k2 = (1.0 - self.k1 * p.w1) / p.q1 * (p.w1 * p.w1 - w * w - v * v) / (2.0 * p.q2);
        (p.d, self.gradient(q, &p), [by_k1, by_k2])
    }

    /// Arc lengths (u, v) of the foot point.
    #[inline]
    pub fn chart(self, q: Vector) -> [f64; 2] {
        let ([u, v, w], p) = (q, self.profile(q));
        let arc = |k: f64, across: f64, height: f64| {
            if k.abs() < FLAT { across } else { (k * across).atan2(1.0 - k * height) / k }
        };
        [arc(self.k1, u, p.w1), arc(self.k2, v, w)]
    }

    /// Point at chart coordinates, `f` above the surface.
    #[inline]
    pub fn point(self, u: f64, v: f64, f: f64) -> Vector {
        let (s1, c1) = arc_end(self.k1, u);
        let (s2, c2) = arc_end(self.k2, v);
        let across = s1 - f * (self.k1 * u).sin();
        let height = c1 + f * (self.k1 * u).cos();
        [across, s2 - height * (self.k2 * v).sin(), c2 + height * (self.k2 * v).cos()]
    }

    /// `|Q_v|` at chart coordinate u: 0 at a pole of the chart.
    #[inline]
    pub fn width(self, u: f64) -> f64 {
        1.0 - self.k2 * arc_end(self.k1, u).1
    }

    /// First and second derivatives of `Q(u, v, f(u, v))`.
    #[inline]
    pub fn derivatives(self, [u, v]: [f64; 2], jet: &NormalJet) -> Derivatives {
        let TwoCurvatures { k1, k2 } = self;
        let [f, fu, fv, fuu, fuv, fvv] = *jet;
        let (sin1, cos1) = (k1 * u).sin_cos();
        let (sin2, cos2) = (k2 * v).sin_cos();
        let stretch = 1.0 - k1 * f;
        let height = arc_end(k1, u).1 + f * cos1;
        let (wu, wv) = (stretch * sin1 + fu * cos1, fv * cos1);
        let wuu = -2.0 * k1 * fu * sin1 + k1 * stretch * cos1 + fuu * cos1;
        let (wuv, wvv) = (-k1 * fv * sin1 + fuv * cos1, fvv * cos1);
        let width = 1.0 - k2 * height;
        let bent = 2.0 * k2 * wv;
        Derivatives {
            u: [stretch * cos1 - fu * sin1, -wu * sin2, wu * cos2],
            v: [-fv * sin1, width * cos2 - wv * sin2, width * sin2 + wv * cos2],
            uu: [-2.0 * k1 * fu * cos1 - k1 * stretch * sin1 - fuu * sin1, -wuu * sin2, wuu * cos2],
            uv: [-k1 * fv * cos1 - fuv * sin1, -wuv * sin2 - k2 * wu * cos2, wuv * cos2 - k2 * wu * sin2],
            vv: [
                -fvv * sin1,
                -bent * cos2 - k2 * width * sin2 - wvv * sin2,
                -bent * sin2 + k2 * width * cos2 + wvv * cos2,
            ],
        }
    }

    /// Both principal curvatures, the larger first, of `Q(u, v, f(u, v))`; `None` where the chart folds.
    ///
    /// A turn about the ring's axis changes no curvature, so they are taken at v = 0: there the derivatives lie in the
    /// planes of the axes, and one sine is enough.
    #[inline]
    pub fn bending(self, u: f64, jet: &NormalJet) -> Option<[f64; 2]> {
        let TwoCurvatures { k1, k2 } = self;
        let [f, fu, fv, fuu, fuv, fvv] = *jet;
        let (half_sin, half_cos) = (0.5 * k1 * u).sin_cos();
        let (sin, cos) = (2.0 * half_sin * half_cos, 1.0 - 2.0 * half_sin * half_sin);
        let stretch = 1.0 - k1 * f;
        let arc = if k1.abs() < FLAT { 0.5 * k1 * u * u } else { 2.0 * half_sin * half_sin / k1 };
        let width = 1.0 - k2 * (arc + f * cos);
        let (wu, wv) = (stretch * sin + fu * cos, fv * cos);
        let wuu = -2.0 * k1 * fu * sin + k1 * stretch * cos + fuu * cos;
        let (wuv, wvv) = (-k1 * fv * sin + fuv * cos, fvv * cos);
        curvatures(&Derivatives {
            u: [stretch * cos - fu * sin, 0.0, wu],
            v: [-fv * sin, width, wv],
            uu: [-2.0 * k1 * fu * cos - k1 * stretch * sin - fuu * sin, 0.0, wuu],
            uv: [-k1 * fv * cos - fuv * sin, -k2 * wu, wuv],
            vv: [-fvv * sin, -2.0 * k2 * wv, k2 * width + wvv],
        })
    }
}

/// `(sin(k s)/k, (1 - cos(k s))/k)`: the end of an arc of length s.
#[inline]
fn arc_end(k: f64, s: f64) -> (f64, f64) {
    if k.abs() < FLAT {
        return (s, 0.5 * k * s * s);
    }
    let half = (0.5 * k * s).sin();
    ((k * s).sin() / k, 2.0 * half * half / k)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::primitives::{Primitive, Torus};

    #[test]
    fn curvatures_of_the_undisplaced_surface_are_constant_and_displacement_adds_its_hessian() {
        let saddle = TwoCurvatures { k1: 0.7, k2: -0.3 };
        let p = saddle.derivatives([0.0, 0.9], &[0.0; 6]).principal().unwrap();
        assert!((p.k1 - 0.7).abs() < 1e-13 && (p.k2 + 0.3).abs() < 1e-13);
        let p = saddle.derivatives([0.0, 0.0], &[0.0, 0.0, 0.0, 0.2, 0.0, -0.1]).principal().unwrap();
        assert!((p.k1 - 0.9).abs() < 1e-13 && (p.k2 + 0.4).abs() < 1e-13);
        for (k1, k2) in [(0.7, -0.3), (0.0, 0.4), (-0.5, -0.5), (1e-12, 0.0)] {
            let jet = [0.05, 0.1, -0.2, 0.3, 0.15, -0.1];
            let surface = TwoCurvatures { k1, k2 };
            let p = surface.derivatives([0.6, -0.4], &jet).principal().unwrap();
            let [a, b] = surface.bending(0.6, &jet).unwrap();
            assert!((p.k1 - a).abs() < 1e-12 && (p.k2 - b).abs() < 1e-12);
        }
    }

    #[test]
    fn it_is_the_torus_of_these_radii() {
        let (ring, tube) = (3.0_f64, 0.8_f64);
        // from the outermost circle: u runs round the tube, v round the ring, and both bend away from the normal
        let here = TwoCurvatures { k1: -1.0 / tube, k2: -1.0 / (ring + tube) };
        let torus = Torus { ring, tube };
        for i in 0..30 {
            let q = [0.4 * (1.3 * f64::from(i)).sin(), 0.9 * f64::from(i).cos(), 0.2 * (0.7 * f64::from(i)).sin()];
            let (d, n) = here.distance(q);
            let (same, normal) = torus.distance([ring + tube + q[2], q[1], q[0]]);
            assert!((d - same).abs() < 1e-14, "{q:?}");
            assert!([n[2] - normal[0], n[1] - normal[1], n[0] - normal[2]].iter().all(|e| e.abs() < 1e-14));
        }
    }
}
