//! S, R and both curvatures of eight displaced surfaces at once: surfaces that were drawn at random, at the same points of one chart.
//!
//! ```text
//! f(u, v) = sum_ab c_ab N_a(u) M_b(v) + (A u^2 + C v^2)/2 + B u v      jet: f, f_u, f_v, f_uu, f_uv, f_vv
//! Q(u, v) = point at arc lengths (u, v) of the surface of constant curvatures k1, k2, moved by f along its normal
//! m, g = (larger + smaller)/2, (larger - smaller)/2           from both fundamental forms of Q, taken at v = 0
//! S = -(2/pi) atan2(m, g)       R = sqrt(m^2 + g^2)
//! ```
//!
//! A turn about the axis of v changes no curvature, so Q is taken at v = 0. Where Q has no tangent plane the curvatures are NaN and
//! S and R are 0; S is 0 where both curvatures are.

use super::arctangent::{angle, reduced};
use super::lanes::Lanes;
use super::sine::sine_and_cosine;
use super::{Isa, dispatch};

/// Surfaces that are looked at together.
pub const SURFACES: usize = 8;

/// Basis functions each way that do not vanish at a point: splines of degree 4.
const WIDTH: usize = 5;

/// Curvatures below which the chart's formulas are replaced by their limits.
const FLAT: f64 = 1e-9;

/// Angles up to which the kernel's own sine holds; larger ones are the library's.
const LARGEST: f64 = 8.0;

/// Points that go through each step together.
const BATCH: usize = 16;

/// Change of S for one radian.
const UNIT: f64 = std::f64::consts::FRAC_2_PI;

/// Eight surfaces.
#[derive(Debug)]
pub struct EightSurfaces {
    /// Curvatures k1 and k2 of the surface that is displaced.
    pub curvatures: [[f64; SURFACES]; 2],
    /// A, C, B.
    pub quadratic: [[f64; SURFACES]; 3],
    /// The coefficients c, those of all surfaces together.
    pub coefficients: Vec<[f64; SURFACES]>,
}

/// A point of the chart with the basis functions there.
#[derive(Clone, Debug, Copy)]
pub struct ChartBasis<'a> {
    /// (u, v).
    pub chart: [f64; 2],
    /// First basis function each way.
    pub first: [usize; 2],
    /// Number of basis functions in v.
    pub across: usize,
    /// Values and first two derivatives, each way.
    pub values: &'a [[[f64; WIDTH]; 3]; 2],
}

/// Eight surfaces at a point.
#[derive(Clone, Debug, Copy, Default)]
pub struct EightShapes {
    pub shape_index: [f64; SURFACES],
    pub curvedness: [f64; SURFACES],
    /// The larger curvature, then the smaller.
    pub curvatures: [[f64; SURFACES]; 2],
}

/// Jet of the displacement.
#[inline(always)]
fn jet<V: Lanes>(surfaces: &EightSurfaces, point: &ChartBasis, from: usize) -> [V; 6] {
    let [us, vs] = point.values;
    let zero = V::splat(0.0);
    let mut out = [zero; 6];
    for a in 0..WIDTH {
        let start = (point.first[0] + a) * point.across + point.first[1];
        let row = &surfaces.coefficients[start..start + WIDTH];
        let mut along_v = [zero; 3];
        for (b, c) in row.iter().enumerate() {
            let c = V::load(&c[from..]);
            for k in 0..3 {
                along_v[k] = c.mul_add(V::splat(vs[k][b]), along_v[k]);
            }
        }
        for (i, (d, e)) in [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)].into_iter().enumerate() {
            out[i] = along_v[e].mul_add(V::splat(us[d][a]), out[i]);
        }
    }
    let [u, v] = point.chart.map(V::splat);
    let [a, c, b] = surfaces.quadratic.each_ref().map(|of| V::load(&of[from..]));
    let [f, fu, fv, fuu, fuv, fvv] = out;
    let half = V::splat(0.5);
    let f = (half * a).mul_add(u * u, (half * c).mul_add(v * v, b.mul_add(u * v, f)));
    let (fu, fv) = (a.mul_add(u, b.mul_add(v, fu)), c.mul_add(v, b.mul_add(u, fv)));
    [f, fu, fv, fuu + a, fuv + b, fvv + c]
}

/// Sine and cosine of any angles.
#[inline(always)]
fn of_angle<V: Lanes>(x: V) -> [V; 2] {
    let mut angles = [0.0; SURFACES];
    x.store(&mut angles);
    if angles[..V::N].iter().all(|angle| angle.abs() <= LARGEST) {
        return sine_and_cosine(x);
    }
    [V::load(&angles.map(f64::sin)), V::load(&angles.map(f64::cos))]
}

/// Mean m and half difference g of both curvatures; NaN where there is no tangent plane. `turn` holds sine and cosine of k1 u/2.
#[inline(always)]
fn bending<V: Lanes>(k1: V, k2: V, u: f64, turn: [V; 2], [f, fu, fv, fuu, fuv, fvv]: [V; 6]) -> [V; 2] {
    let (zero, one, two) = (V::splat(0.0), V::splat(1.0), V::splat(2.0));
    let (half, u) = (V::splat(0.5), V::splat(u));
    let [half_sin, half_cos] = turn;
    let sin = two * half_sin * half_cos;
    let square = two * half_sin * half_sin;
    let cos = one - square;
    let stretch = k1.neg_mul_add(f, one);
    let flat = k1.abs().less(V::splat(FLAT));
    let arc = V::select(flat, half * k1 * u * u, square.div(V::select(flat, one, k1)));
    let width = k2.neg_mul_add(f.mul_add(cos, arc), one);
    let (wu, wv) = (stretch.mul_add(sin, fu * cos), fv * cos);
    let bent = two * k1 * fu;
    let wuu = bent.neg_mul_add(sin, (k1 * stretch).mul_add(cos, fuu * cos));
    let (wuv, wvv) = ((k1 * fv).neg_mul_add(sin, fuv * cos), fvv * cos);
    // components of Q_u, Q_v and the second derivatives; the second one is zero but for Q_v, Q_uv and Q_vv
    let (qu, qv) = (fu.neg_mul_add(sin, stretch * cos), zero - fv * sin);
    let quu = zero - (bent * cos + k1 * stretch * sin + fuu * sin);
    let quv = zero - (k1 * fv * cos + fuv * sin);
    let turned = zero - k2 * wu;
    let (qvv, qvv_across) = (zero - fvv * sin, zero - two * k2 * wv);
    let qvv_up = k2.mul_add(width, wvv);
    let [x, y, z] = [zero - wu * width, wu.mul_add(qv, zero - qu * wv), qu * width];
    let ee = qu.mul_add(qu, wu * wu);
    let ff = qu.mul_add(qv, wu * wv);
    let squared = x.mul_add(x, y.mul_add(y, z * z));
    let (by_area, by_ee) = (one.div(squared.sqrt()), one.div(ee));
    let e = quu.mul_add(x, wuu * z) * by_area;
    let m = quv.mul_add(x, turned.mul_add(y, wuv * z)) * by_area;
    let g = qvv.mul_add(x, qvv_across.mul_add(y, qvv_up * z)) * by_area;
    let shear = ff * by_ee;
    let skew = shear.neg_mul_add(e, m);
    let (a, b) = (e * by_ee, skew * by_area);
    let c = shear.neg_mul_add(m + skew, g) * ee * by_area * by_area;
    let apart = half * (a - c);
    let gap = apart.mul_add(apart, b * b).sqrt();
    let nan = V::splat(f64::NAN);
    let held = |value: V| V::select(zero.less(squared), V::select(zero.less(ee), value, nan), nan);
    [held(half * (a + c)), held(gap)]
}

#[inline(always)]
fn generic<V: Lanes>(surfaces: &EightSurfaces, points: &[ChartBasis], out: &mut [EightShapes]) {
    let zero = V::splat(0.0);
    // each step for many points before the next one: a point alone is a chain of some hundred instructions that wait for each other
    for (points, out) in points.chunks(BATCH).zip(out.chunks_mut(BATCH)) {
        for from in (0..SURFACES).step_by(V::N) {
            let [k1, k2] = surfaces.curvatures.each_ref().map(|k| V::load(&k[from..]));
            let (mut turns, mut bends) = ([[zero; 2]; BATCH], [[zero; 2]; BATCH]);
            for (turn, point) in turns.iter_mut().zip(points) {
                *turn = of_angle(k1 * V::splat(0.5 * point.chart[0]));
            }
            for ((bent, turn), point) in bends.iter_mut().zip(turns).zip(points) {
                *bent = bending(k1, k2, point.chart[0], turn, jet::<V>(surfaces, point, from));
            }
            for ([mean, gap], out) in bends.into_iter().zip(out.iter_mut()) {
                let (quotient, offset) = reduced(mean, gap, UNIT);
                let s = zero - angle(quotient, offset, mean, UNIT);
                let r = mean.mul_add(mean, gap * gap).sqrt();
                // NaN is not less than anything: S and R are 0 where nothing bends or there is no surface
                let is_bent = zero.less(r);
                V::select(is_bent, s, zero).store(&mut out.shape_index[from..]);
                V::select(is_bent, r, zero).store(&mut out.curvedness[from..]);
                (mean + gap).store(&mut out.curvatures[0][from..]);
                (mean - gap).store(&mut out.curvatures[1][from..]);
            }
        }
    }
}

/// Eight surfaces at every point; `out` has as many places as there are points.
///
/// # Panics
/// When a point's basis functions reach beyond the coefficients.
pub fn displaced_shapes(isa: Isa, surfaces: &EightSurfaces, points: &[ChartBasis], out: &mut [EightShapes]) {
    dispatch!(isa, generic [](surfaces: &EightSurfaces, points: &[ChartBasis], out: &mut [EightShapes]));
}

#[cfg(test)]
mod tests {
    use super::super::Twins;
    use super::*;

    const ACROSS: usize = 7;

    fn value(seed: usize) -> f64 {
        (seed as f64 * 0.73 + 0.2).sin()
    }

    fn surfaces(small: f64) -> EightSurfaces {
        let of = |k: usize| std::array::from_fn(|lane| 0.8 * value(17 * k + lane));
        let mut curvatures = [of(1), of(2)];
        // a cylinder, a plane, and curvatures that are nearly zero
        (curvatures[1][3], curvatures[0][4], curvatures[1][4], curvatures[0][5]) = (0.0, 0.0, 0.0, 1e-10);
        let coefficients = (0..ACROSS * ACROSS).map(|i| std::array::from_fn(|lane| small * value(31 * i + 5 * lane)));
        EightSurfaces {
            curvatures,
            quadratic: [of(3), of(4), of(5)].map(|of: [f64; SURFACES]| of.map(|v| small * v)),
            coefficients: coefficients.collect(),
        }
    }

    type Values = [[[f64; WIDTH]; 3]; 2];

    fn values(point: usize) -> Values {
        std::array::from_fn(|side| {
            std::array::from_fn(|d| std::array::from_fn(|a| 0.5 * value(point * 41 + side * 19 + d * 7 + a)))
        })
    }

    /// Twin: the jet as a double sum, Q's derivatives at v = 0 as vectors, the textbook's fundamental forms, the library's functions.
    fn twin(surfaces: &EightSurfaces, point: &ChartBasis, lane: usize) -> [f64; 4] {
        let ([u, v], [a, c, b]) = (point.chart, surfaces.quadratic.map(|of| of[lane]));
        let mut jet = [0.5 * (a * u * u + c * v * v) + b * u * v, a * u + b * v, c * v + b * u, a, b, c];
        for (i, (d, e)) in [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)].into_iter().enumerate() {
            for a in 0..WIDTH {
                for c in 0..WIDTH {
                    let at = (point.first[0] + a) * point.across + point.first[1] + c;
                    jet[i] += surfaces.coefficients[at][lane] * point.values[0][d][a] * point.values[1][e][c];
                }
            }
        }
        let [f, fu, fv, fuu, fuv, fvv] = jet;
        let [k1, k2] = [0, 1].map(|k| surfaces.curvatures[k][lane]);
        let (s, c) = (k1 * u).sin_cos();
        let arc = if k1.abs() < FLAT { 0.5 * k1 * u * u } else { (1.0 - c) / k1 };
        let (stretch, height) = (1.0 - k1 * f, arc + f * c);
        let (wu, wv) = (stretch * s + fu * c, fv * c);
        let width = 1.0 - k2 * height;
        let qu = [stretch * c - fu * s, 0.0, wu];
        let qv = [-fv * s, width, wv];
        let quu =
            [-2.0 * k1 * fu * c - k1 * stretch * s - fuu * s, 0.0, -2.0 * k1 * fu * s + k1 * stretch * c + fuu * c];
        let quv = [-k1 * fv * c - fuv * s, -k2 * wu, -k1 * fv * s + fuv * c];
        let qvv = [-fvv * s, -2.0 * k2 * wv, k2 * width + fvv * c];
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let n = [qu[1] * qv[2] - qu[2] * qv[1], qu[2] * qv[0] - qu[0] * qv[2], qu[0] * qv[1] - qu[1] * qv[0]];
        let length = dot(n, n).sqrt();
        let n = n.map(|v| v / length);
        let (ee, ff, gg) = (dot(qu, qu), dot(qu, qv), dot(qv, qv));
        let (l, m, o) = (dot(quu, n), dot(quv, n), dot(qvv, n));
        let det = ee * gg - ff * ff;
        let mean = (ee * o - 2.0 * ff * m + gg * l) / (2.0 * det);
        let gap = (mean * mean - (l * o - m * m) / det).max(0.0).sqrt();
        [-UNIT * mean.atan2(gap), mean.hypot(gap), mean + gap, mean - gap]
    }

    #[test]
    fn every_isa_agrees_with_its_twin() {
        let surfaces = surfaces(0.1);
        let all: Vec<Values> = (0..23).map(values).collect();
        let point = |(k, values): (usize, &'static Values)| ChartBasis {
            chart: [1.3 * value(k), 1.1 * value(k + 50)],
            first: [k % 3, k % 2],
            across: ACROSS,
            values,
        };
        let all: &'static Vec<Values> = Box::leak(Box::new(all));
        let points: Vec<ChartBasis> = all.iter().enumerate().map(point).collect();
        for isa in Isa::available() {
            let mut out = vec![EightShapes::default(); points.len()];
            displaced_shapes(isa, &surfaces, &points, &mut out);
            let [mut of_s, mut of_r, mut of_k] =
                ["displaced S", "displaced R", "displaced k"].map(|kernel| Twins::new(kernel, isa));
            for (point, found) in points.iter().zip(&out) {
                for lane in 0..SURFACES {
                    let [s, r, k1, k2] = twin(&surfaces, point, lane);
                    of_s.compare(found.shape_index[lane], s);
                    of_r.compare(found.curvedness[lane] / r, 1.0);
                    of_k.compare(found.curvatures[0][lane], k1);
                    of_k.compare(found.curvatures[1][lane], k2);
                }
            }
            [of_s, of_r, of_k].iter().for_each(|twins| twins.hold(64.0));
        }
    }

    #[test]
    fn what_is_flat_has_zeros_and_what_folds_has_no_curvature() {
        let values = [[[0.2; WIDTH]; 3]; 2];
        let point = ChartBasis { chart: [0.4, 0.3], first: [0, 0], across: ACROSS, values: &values };
        let flat = EightSurfaces {
            curvatures: [[0.0; SURFACES]; 2],
            quadratic: [[0.0; SURFACES]; 3],
            coefficients: vec![[0.0; SURFACES]; ACROSS * ACROSS],
        };
        let folded = EightSurfaces {
            curvatures: [[f64::INFINITY; SURFACES]; 2],
            coefficients: flat.coefficients.clone(),
            ..flat
        };
        for isa in Isa::available() {
            let mut out = [EightShapes::default()];
            displaced_shapes(isa, &flat, &[point], &mut out);
            assert_eq!(out[0].shape_index, [0.0; SURFACES]);
            assert_eq!(out[0].curvatures, [[0.0; SURFACES]; 2]);
            displaced_shapes(isa, &folded, &[point], &mut out);
            assert_eq!(out[0].curvedness, [0.0; SURFACES]);
            assert!(out[0].curvatures[0].iter().all(|k| k.is_nan()));
        }
    }
}
