//! The surface of two constant curvatures, placed in the patch.
//!
//! ```text
//! theta = (h, a, b, k1, k2, phi)      Y = exp([(a, b, 0)]x) X,   u = Y1 cos phi + Y2 sin phi,  v = Y2 cos phi - Y1 sin phi,  w = Y3 - h
//! ```
//!
//! Its distance, chart and derivatives in these axes are those of [`TwoCurvatures`].

use palpate_geometry::primitives::TwoCurvatures;
use palpate_numeric::vector::Vector;

/// One surface, with its rotation worked out.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ConstantCurvature {
    pub(crate) theta: [f64; 6],
    /// Rows of `exp([(a, b, 0)]x)` rotated by phi: X to (u, v, w + h).
    axes: [Vector; 3],
    /// Derivatives of the axes by a and by b.
    by_a: [Vector; 3],
    by_b: [Vector; 3],
}

impl ConstantCurvature {
    pub(crate) fn new(theta: [f64; 6]) -> ConstantCurvature {
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

    /// The same surface in its own axes.
    pub(crate) fn form(&self) -> TwoCurvatures {
        TwoCurvatures { k1: self.theta[3], k2: self.theta[4] }
    }

    /// Signed distance of a point.
    #[cfg(test)]
    fn distance(&self, x: Vector) -> f64 {
        self.distance_and_normal(x).0
    }

    /// Signed distance and its gradient, the unit normal at the foot point.
    pub(crate) fn distance_and_normal(&self, x: Vector) -> (f64, Vector) {
        let (d, normal) = self.form().distance(self.local(x));
        (d, transposed(&self.axes, normal))
    }

    /// Signed distance and its derivatives by theta.
    pub(super) fn distance_by_theta(&self, x: Vector) -> (f64, [f64; 6]) {
        let local @ [u, v, _] = self.local(x);
        let (d, slope, [by_k1, by_k2]) = self.form().distance_by_curvatures(local);
        let along = |m: &[Vector; 3]| {
            let moved = apply(m, x);
            slope[0] * moved[0] + slope[1] * moved[1] + slope[2] * moved[2]
        };
        let by_phi = slope[0] * v - slope[1] * u;
        (d, [-slope[2], along(&self.by_a), along(&self.by_b), by_k1, by_k2, by_phi])
    }

    /// Arc lengths (u, v) of the foot point.
    pub(crate) fn chart(&self, x: Vector) -> [f64; 2] {
        self.form().chart(self.local(x))
    }

    /// Point at chart coordinates, `f` above the surface.
    pub(crate) fn point(&self, u: f64, v: f64, f: f64) -> Vector {
        let [across, along, height] = self.form().point(u, v, f);
        transposed(&self.axes, [across, along, height + self.theta[0]])
    }

    /// Whether it is a plane.
    pub(crate) fn is_flat(&self) -> bool {
        self.theta[3..5] == [0.0; 2]
    }

    /// A direction in the chart's axes (u, v, normal) at the origin of the chart, in the axes of X.
    pub(crate) fn rotate_back(&self, direction: Vector) -> Vector {
        transposed(&self.axes, direction)
    }
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
}
