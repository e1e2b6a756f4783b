//! The surface of two constant curvatures: a patch of a torus, with plane, cylinder and sphere as exact special cases.
//!
//! ```text
//! theta = (h, a, b, k1, k2, phi)      Y = exp([(a, b, 0)]x) X,   u = Y1 cos phi + Y2 sin phi,  v = Y2 cos phi - Y1 sin phi,  w = Y3 - h
//! w1 = (2 w  - k2 (w^2  + v^2)) / (1 + q2)    q2 = sqrt((1 - k2 w )^2 + (k2 v)^2)     height over the circle of curvature k2
//! d  = (2 w1 - k1 (w1^2 + u^2)) / (1 + q1)    q1 = sqrt((1 - k1 w1)^2 + (k1 u)^2)     signed distance, positive on the free side
//! ```
//!
//! No branch and no division by a curvature: `d` and its derivatives are smooth through k = 0. k > 0 bends towards the
//! normal. The chart is `(u, v)` as arc lengths; a displacement f along the normal is `Q(u, v, f)`.
//! Distances of this kind: G. Lukacs, R. Martin, D. Marshall, *Faithful least-squares fitting of spheres, cylinders,
//! cones and tori*, ECCV 1998, 671.

use palpate_geometry::curvature::Derivatives;
use palpate_numeric::vector::{Vector, cross, dot};

/// Curvatures times lengths below which the chart's formulas are replaced by their limits.
const FLAT: f64 = 1e-9;

/// A displacement along the normal with its derivatives: f, f_u, f_v, f_uu, f_uv, f_vv.
pub(in crate::recognition) type Jet = [f64; 6];

/// One surface, with its rotation worked out.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::recognition) struct ConstantCurvature {
    pub(in crate::recognition) theta: [f64; 6],
    /// Rows of `exp([(a, b, 0)]x)` rotated by phi: X to (u, v, w + h).
    axes: [Vector; 3],
    /// Derivatives of the axes by a and by b.
    by_a: [Vector; 3],
    by_b: [Vector; 3],
}

/// Intermediate values of the distance formula.
struct Profile {
    w1: f64,
    d: f64,
    q1: f64,
    q2: f64,
}

impl ConstantCurvature {
    pub(in crate::recognition) fn new(theta: [f64; 6]) -> ConstantCurvature {
        let [_, a, b, _, _, phi] = theta;
        let [rotation, by_a, by_b] = rotation(a, b);
        let (sin, cos) = phi.sin_cos();
        let turned = |m: [Vector; 3]| {
            let mix = |p: f64, q: f64| [0, 1, 2].map(|k| p * m[0][k] + q * m[1][k]);
            [mix(cos, sin), mix(-sin, cos), m[2]]
        };
        ConstantCurvature { theta, axes: turned(rotation), by_a: turned(by_a), by_b: turned(by_b) }
    }

    /// Coordinates (u, v, w) of a point in the axes of the surface; u and v are not arc lengths yet.
    fn local(&self, x: Vector) -> Vector {
        let y = apply(&self.axes, x);
        [y[0], y[1], y[2] - self.theta[0]]
    }

    fn profile(&self, [u, v, w]: Vector) -> Profile {
        let [_, _, _, k1, k2, _] = self.theta;
        // both are near 1 in the units of the patch: nothing overflows
        let length = |a: f64, b: f64| (a * a + b * b).sqrt();
        let q2 = length(1.0 - k2 * w, k2 * v);
        let w1 = (2.0 * w - k2 * (w * w + v * v)) / (1.0 + q2);
        let q1 = length(1.0 - k1 * w1, k1 * u);
        Profile { w1, d: (2.0 * w1 - k1 * (w1 * w1 + u * u)) / (1.0 + q1), q1, q2 }
    }

    /// Signed distance of a point.
    #[cfg(test)]
    fn distance(&self, x: Vector) -> f64 {
        self.profile(self.local(x)).d
    }

    /// Derivatives of the distance by (u, v, w).
    fn by_local(&self, [u, v, w]: Vector, p: &Profile) -> Vector {
        let [_, _, _, k1, k2, _] = self.theta;
        let by_w1 = (1.0 - k1 * p.w1) / p.q1;
        [-k1 * u / p.q1, -by_w1 * k2 * v / p.q2, by_w1 * (1.0 - k2 * w) / p.q2]
    }

    /// Signed distance and its gradient, the unit normal at the foot point.
    pub(in crate::recognition) fn distance_and_normal(&self, x: Vector) -> (f64, Vector) {
        let local = self.local(x);
        let p = self.profile(local);
        (p.d, transposed(&self.axes, self.by_local(local, &p)))
    }

    /// Signed distance and its derivatives by theta.
    pub(super) fn distance_by_theta(&self, x: Vector) -> (f64, [f64; 6]) {
        let [_, _, _, k1, _, _] = self.theta;
        let local @ [u, v, w] = self.local(x);
        let p = self.profile(local);
        let slope = self.by_local(local, &p);
        let along = |m: &[Vector; 3]| {
            let moved = apply(m, x);
            slope[0] * moved[0] + slope[1] * moved[1] + slope[2] * moved[2]
        };
        let by_k1 = (p.d * p.d - p.w1 * p.w1 - u * u) / (2.0 * p.q1);
        let by_k2 = (1.0 - k1 * p.w1) / p.q1 * (p.w1 * p.w1 - w * w - v * v) / (2.0 * p.q2);
        let by_phi = slope[0] * v - slope[1] * u;
        (p.d, [-slope[2], along(&self.by_a), along(&self.by_b), by_k1, by_k2, by_phi])
    }

    /// Arc lengths (u, v) of the foot point.
    pub(in crate::recognition) fn chart(&self, x: Vector) -> [f64; 2] {
        let [_, _, _, k1, k2, _] = self.theta;
        let local @ [u, v, w] = self.local(x);
        let arc = |k: f64, across: f64, height: f64| {
            if k.abs() < FLAT { across } else { (k * across).atan2(1.0 - k * height) / k }
        };
        [arc(k1, u, self.profile(local).w1), arc(k2, v, w)]
    }

    /// Point at chart coordinates, `f` above the surface.
    pub(in crate::recognition) fn point(&self, u: f64, v: f64, f: f64) -> Vector {
        let [across, along, height] = self.local_point(u, v, f);
        transposed(&self.axes, [across, along, height + self.theta[0]])
    }

    /// The same in the axes (u, v, w) of the surface at the origin of its chart.
    pub(in crate::recognition) fn local_point(&self, u: f64, v: f64, f: f64) -> Vector {
        let [_, _, _, k1, k2, _] = self.theta;
        let (s1, c1) = arc_end(k1, u);
        let (s2, c2) = arc_end(k2, v);
        let across = s1 - f * (k1 * u).sin();
        let height = c1 + f * (k1 * u).cos();
        [across, s2 - height * (k2 * v).sin(), c2 + height * (k2 * v).cos()]
    }

    /// Whether it is a plane.
    pub(in crate::recognition) fn is_flat(&self) -> bool {
        self.theta[3..5] == [0.0; 2]
    }

    /// `|Q_v|` at chart coordinate u: 0 at a pole of the chart.
    pub(in crate::recognition) fn width(&self, u: f64) -> f64 {
        1.0 - self.theta[4] * arc_end(self.theta[3], u).1
    }

    /// A direction in the chart's axes (u, v, normal) at the origin of the chart, in the axes of X.
    pub(in crate::recognition) fn rotate_back(&self, direction: Vector) -> Vector {
        transposed(&self.axes, direction)
    }
}

/// First and second derivatives of `Q(u, v, f(u, v))` in the local axes.
pub(in crate::recognition) fn derivatives(k1: f64, k2: f64, [u, v]: [f64; 2], jet: &Jet) -> Derivatives {
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
        vv: [-fvv * sin1, -bent * cos2 - k2 * width * sin2 - wvv * sin2, -bent * sin2 + k2 * width * cos2 + wvv * cos2],
    }
}

/// Both principal curvatures, the larger first, of `Q(u, v, f(u, v))`; `None` where the chart folds.
///
/// A turn about the ring's axis changes no curvature, so they are taken at v = 0: there the derivatives lie in the
/// planes of the axes, and one sine is enough.
pub(in crate::recognition) fn bending(k1: f64, k2: f64, u: f64, jet: &Jet) -> Option<[f64; 2]> {
    let [f, fu, fv, fuu, fuv, fvv] = *jet;
    let (half_sin, half_cos) = (0.5 * k1 * u).sin_cos();
    let (sin, cos) = (2.0 * half_sin * half_cos, 1.0 - 2.0 * half_sin * half_sin);
    let stretch = 1.0 - k1 * f;
    let arc = if k1.abs() < FLAT { 0.5 * k1 * u * u } else { 2.0 * half_sin * half_sin / k1 };
    let width = 1.0 - k2 * (arc + f * cos);
    let (wu, wv) = (stretch * sin + fu * cos, fv * cos);
    let wuu = -2.0 * k1 * fu * sin + k1 * stretch * cos + fuu * cos;
    let (wuv, wvv) = (-k1 * fv * sin + fuv * cos, fvv * cos);
    let of = |u: f64, v: f64, w: f64| [u, v, w];
    let (qu, qv) = (of(stretch * cos - fu * sin, 0.0, wu), of(-fv * sin, width, wv));
    let quu = of(-2.0 * k1 * fu * cos - k1 * stretch * sin - fuu * sin, 0.0, wuu);
    let quv = of(-k1 * fv * cos - fuv * sin, -k2 * wu, wuv);
    let qvv = of(-fvv * sin, -2.0 * k2 * wv, k2 * width + wvv);
    curvatures_of(&Derivatives { u: qu, v: qv, uu: quu, uv: quv, vv: qvv })
}

/// Both principal curvatures, the larger first, without their directions; `None` where there is no tangent plane.
pub(in crate::recognition) fn curvatures_of(q: &Derivatives) -> Option<[f64; 2]> {
    let across = cross(q.u, q.v);
    let (ee, ff) = (dot(q.u, q.u), dot(q.u, q.v));
    let squared = dot(across, across);
    if squared.is_nan() || squared <= 0.0 || ee <= 0.0 {
        return None;
    }
    let area = squared.sqrt();
    let (e, f, g) = (dot(q.uu, across) / area, dot(q.uv, across) / area, dot(q.vv, across) / area);
    let shear = ff / ee;
    let (a, b) = (e / ee, (f - shear * e) / area);
    let c = (g - shear * (2.0 * f - shear * e)) * ee / squared;
    let half = 0.5 * (a - c);
    let gap = (half * half + b * b).sqrt();
    let mean = 0.5 * (a + c);
    Some([mean + gap, mean - gap])
}

/// `(sin(k s)/k, (1 - cos(k s))/k)`: the end of an arc of length s.
fn arc_end(k: f64, s: f64) -> (f64, f64) {
    if k.abs() < FLAT {
        return (s, 0.5 * k * s * s);
    }
    let half = (0.5 * k * s).sin();
    ((k * s).sin() / k, 2.0 * half * half / k)
}

/// `exp([(a, b, 0)]x)` and its derivatives by a and b: `I + A K + B K^2` with `A = sin t/t`, `B = (1 - cos t)/t^2`,
/// `t = |(a, b)|`.
fn rotation(a: f64, b: f64) -> [[Vector; 3]; 3] {
    let t2 = a * a + b * b;
    let t = t2.sqrt();
    // A, B and their derivatives over t, by series where the quotients cancel
    let (first, second, first_slope, second_slope) = if t < 1e-2 {
        (
            1.0 - t2 / 6.0 + t2 * t2 / 120.0,
            0.5 - t2 / 24.0 + t2 * t2 / 720.0,
            -1.0 / 3.0 + t2 / 30.0,
            -1.0 / 12.0 + t2 / 180.0,
        )
    } else {
        let (sin, cos) = t.sin_cos();
        (sin / t, (1.0 - cos) / t2, (t * cos - sin) / (t2 * t), (t * sin - 2.0 * (1.0 - cos)) / (t2 * t2))
    };
    let k = [[0.0, 0.0, b], [0.0, 0.0, -a], [-b, a, 0.0]];
    let kk = [[-b * b, a * b, 0.0], [a * b, -a * a, 0.0], [0.0, 0.0, -t2]];
    let ka = [[0.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]];
    let kb = [[0.0, 0.0, 1.0], [0.0; 3], [-1.0, 0.0, 0.0]];
    let kka = [[0.0, b, 0.0], [b, -2.0 * a, 0.0], [0.0, 0.0, -2.0 * a]];
    let kkb = [[-2.0 * b, a, 0.0], [a, 0.0, 0.0], [0.0, 0.0, -2.0 * b]];
    let mut out = [[[0.0; 3]; 3]; 3];
    for i in 0..3 {
        for j in 0..3 {
            out[0][i][j] = f64::from(u8::from(i == j)) + first * k[i][j] + second * kk[i][j];
            let slope = first_slope * k[i][j] + second_slope * kk[i][j];
            out[1][i][j] = a * slope + first * ka[i][j] + second * kka[i][j];
            out[2][i][j] = b * slope + first * kb[i][j] + second * kkb[i][j];
        }
    }
    out
}

fn apply(m: &[Vector; 3], x: Vector) -> Vector {
    [0, 1, 2].map(|i| m[i][0] * x[0] + m[i][1] * x[1] + m[i][2] * x[2])
}

fn transposed(m: &[Vector; 3], x: Vector) -> Vector {
    [0, 1, 2].map(|j| m[0][j] * x[0] + m[1][j] * x[1] + m[2][j] * x[2])
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_numeric::vector::{minus, norm};

    fn places() -> Vec<Vector> {
        (0..40).map(|i| [0.9 * (i as f64 * 0.7).sin(), 0.8 * (i as f64 * 1.3).cos(), 0.1 * (i as f64).sin()]).collect()
    }

    #[test]
    fn spheres_cylinders_planes_and_tori_have_their_exact_distances() {
        for x in places() {
            for k in [0.4, -0.4, 1.0, -1.0] {
                let r: f64 = 1.0 / k;
                let sphere = ConstantCurvature::new([0.0, 0.0, 0.0, k, k, 0.3]).distance(x);
                let centre = [0.0, 0.0, r];
                assert!((sphere - r.signum() * (r.abs() - norm(minus(x, centre)))).abs() < 1e-12);
                let cylinder = ConstantCurvature::new([0.0, 0.0, 0.0, k, 0.0, 0.0]).distance(x);
                assert!((cylinder - r.signum() * (r.abs() - x[0].hypot(x[2] - r))).abs() < 1e-12);
            }
            // outer side of a torus: tube of radius 1 along u, ring of radius 3 along v
            let torus = ConstantCurvature::new([0.0, 0.0, 0.0, -1.0, -1.0 / 3.0, 0.0]).distance(x);
            let ring = x[1].hypot(x[2] + 3.0) - 2.0;
            assert!((torus - (x[0].hypot(ring) - 1.0)).abs() < 1e-12);
            let plane = ConstantCurvature::new([0.05, 0.0, 0.0, 0.0, 0.0, 1.0]).distance(x);
            assert!((plane - (x[2] - 0.05)).abs() < 1e-15);
        }
    }

    #[test]
    fn derivatives_agree_with_differences() {
        let theta = [0.1, 0.2, -0.15, 0.7, -0.3, 0.6];
        let surface = ConstantCurvature::new(theta);
        for x in places() {
            let (d, by) = surface.distance_by_theta(x);
            let (same, normal) = surface.distance_and_normal(x);
            assert!(d == same && (norm(normal) - 1.0).abs() < 1e-13);
            for i in 0..6 {
                let at = |e: f64| {
                    let mut moved = theta;
                    moved[i] += e;
                    ConstantCurvature::new(moved).distance(x)
                };
                assert!((by[i] - (at(1e-5) - at(-1e-5)) / 2e-5).abs() < 1e-9, "parameter {i}");
            }
            for i in 0..3 {
                let at = |e: f64| {
                    let mut moved = x;
                    moved[i] += e;
                    surface.distance(moved)
                };
                assert!((normal[i] - (at(1e-5) - at(-1e-5)) / 2e-5).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn the_chart_and_its_inverse_agree() {
        for theta in
            [[0.1, 0.2, -0.15, 0.7, -0.3, 0.6], [0.0, 0.1, 0.0, 0.8, 0.8, 0.0], [0.0, 0.0, 0.3, 0.0, -0.9, 0.2]]
        {
            let surface = ConstantCurvature::new(theta);
            for x in places() {
                let [u, v] = surface.chart(x);
                assert!(norm(minus(surface.point(u, v, surface.distance(x)), x)) < 1e-12);
            }
        }
    }

    #[test]
    fn curvatures_of_the_undisplaced_surface_are_constant_and_displacement_adds_its_hessian() {
        let p = derivatives(0.7, -0.3, [0.0, 0.9], &[0.0; 6]).principal().unwrap();
        assert!((p.k1 - 0.7).abs() < 1e-13 && (p.k2 + 0.3).abs() < 1e-13);
        let p = derivatives(0.7, -0.3, [0.0, 0.0], &[0.0, 0.0, 0.0, 0.2, 0.0, -0.1]).principal().unwrap();
        assert!((p.k1 - 0.9).abs() < 1e-13 && (p.k2 + 0.4).abs() < 1e-13);
        for (k1, k2) in [(0.7, -0.3), (0.0, 0.4), (-0.5, -0.5), (1e-12, 0.0)] {
            let jet = [0.05, 0.1, -0.2, 0.3, 0.15, -0.1];
            let p = derivatives(k1, k2, [0.6, -0.4], &jet).principal().unwrap();
            let [a, b] = bending(k1, k2, 0.6, &jet).unwrap();
            assert!((p.k1 - a).abs() < 1e-12 && (p.k2 - b).abs() < 1e-12);
        }
    }
}
