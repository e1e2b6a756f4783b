//! Derivatives of S and R by the derivatives of the surface, and of their grid means by the coefficients.
//!
//! ```text
//! l^2 = 1 + p^2, w^2 = 1 + p^2 + q^2, s = p q / l^2          a = r/(l^2 w)
//! S = -(2/pi) atan2(a + c, d)                                b = (t - s r)/w^2
//! R = sqrt((a^2 + c^2)/2 + b^2)                              c = l^2 (u - 2 s t + s^2 r)/w^3
//! d = sqrt((a - c)^2 + 4 b^2)                                p, q, r, t, u = S_x, S_y, S_xx, S_xy, S_yy
//! ```
//!
//! S has a kink at an umbilic (d = 0): the derivative of d is dropped there, so that only the mean curvature enters the
//! delta method.

use super::{GridGradients, ShapeMaps};
use crate::surface::{HeightField, SurfacePoint};
use palpate_numeric::bspline::BasisRow;
use palpate_numeric::simd::POINTS;

/// The shape operator `[a b; b c]` and the derivatives of its entries.
struct Operator {
    a: f64,
    b: f64,
    c: f64,
    da: [f64; 5],
    db: [f64; 5],
    dc: [f64; 5],
}

fn operator(point: &SurfacePoint) -> Operator {
    let SurfacePoint { zx: p, zy: q, zxx: r, zxy: t, zyy: u, .. } = *point;
    let l2 = 1.0 + p * p;
    let w2 = l2 + q * q;
    let w = w2.sqrt();
    let s = p * q / l2;
    let (a, b) = (r / (l2 * w), (t - s * r) / w2);
    let bend = u - 2.0 * s * t + s * s * r;
    let c = l2 * bend / (w2 * w);
    let (s_p, s_q) = (q * (1.0 - p * p) / (l2 * l2), p / l2);
    let bend_s = -2.0 * t + 2.0 * s * r;
    let da = [-a * (2.0 * p / l2 + p / w2), -a * q / w2, 1.0 / (l2 * w), 0.0, 0.0];
    let db = [-s_p * r / w2 - 2.0 * b * p / w2, -s_q * r / w2 - 2.0 * b * q / w2, -s / w2, 1.0 / w2, 0.0];
    let outer = l2 / (w2 * w);
    let dc = [
        c * (2.0 * p / l2 - 3.0 * p / w2) + outer * bend_s * s_p,
        -3.0 * c * q / w2 + outer * bend_s * s_q,
        outer * s * s,
        -2.0 * outer * s,
        outer,
    ];
    Operator { a, b, c, da, db, dc }
}

/// Gradient of `k1 - k2` at `(x, y)` by the coefficients; zero at an umbilic.
pub fn gap_gradient(surface: &HeightField, x: f64, y: f64) -> Vec<f64> {
    let (bx, by) = (surface.knots()[0].basis(x), surface.knots()[1].basis(y));
    let Operator { a, b, c, da, db, dc } = operator(&surface.with_rows(&bx, &by));
    let gap = (a - c).hypot(2.0 * b);
    let mut out = vec![0.0; surface.coefficients().len()];
    if gap > 0.0 {
        let g = [0, 1, 2, 3, 4].map(|k| ((a - c) * (da[k] - dc[k]) + 4.0 * b * db[k]) / gap);
        let columns = surface.coefficients().ncols();
        by_coefficients(&g, &bx, &by, |a, b, value| out[(bx.first + a) * columns + by.first + b] = value);
    }
    out
}

/// What vanishes at an umbilic, `(a - c)/2` and `b` at `(x, y)`, with their gradients by the coefficients. Both are smooth
/// there, and k1 - k2 is twice the length of the two.
pub fn umbilic_gradients(surface: &HeightField, x: f64, y: f64) -> [(f64, Vec<f64>); 2] {
    let (bx, by) = (surface.knots()[0].basis(x), surface.knots()[1].basis(y));
    let Operator { a, b, c, da, db, dc } = operator(&surface.with_rows(&bx, &by));
    let columns = surface.coefficients().ncols();
    let half = [0, 1, 2, 3, 4].map(|k| 0.5 * (da[k] - dc[k]));
    [(0.5 * (a - c), half), (b, db)].map(|(value, g)| {
        let mut out = vec![0.0; surface.coefficients().len()];
        by_coefficients(&g, &bx, &by, |a, b, value| out[(bx.first + a) * columns + by.first + b] = value);
        (value, out)
    })
}

/// Chain rule: from derivatives `g` by `(S_x, S_y, S_xx, S_xy, S_yy)` to those by the coefficients that are nonzero at a
/// point, `visit(a, b, sum_k g_k d_k(N_a M_b))`.
#[inline]
pub fn by_coefficients(g: &[f64; 5], bx: &BasisRow, by: &BasisRow, mut visit: impl FnMut(usize, usize, f64)) {
    let [n, dn, ddn] = [0, 1, 2].map(|k| bx.derivative(k));
    let [m, dm, ddm] = [0, 1, 2].map(|k| by.derivative(k));
    for a in 0..n.len() {
        let of_m = g[0] * dn[a] + g[2] * ddn[a];
        let of_dm = g[1] * n[a] + g[3] * dn[a];
        let of_ddm = g[4] * n[a];
        for b in 0..m.len() {
            visit(a, b, of_m * m[b] + of_dm * dm[b] + of_ddm * ddm[b]);
        }
    }
}

/// Derivatives of S and of R by `(S_x, S_y, S_xx, S_xy, S_yy)` at one point, and the curvatures they belong to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeGradient {
    /// Of S.
    pub shape_index: [f64; 5],
    /// Of R.
    pub curvedness: [f64; 5],
    /// `k1 + k2`.
    pub sum: f64,
    /// `k1 - k2`.
    pub difference: f64,
}

/// Gradients of S and R at one point.
pub fn shape_gradient(point: &SurfacePoint) -> ShapeGradient {
    let Operator { a, b, c, da, db, dc } = operator(point);
    let difference = (a - c).hypot(2.0 * b);
    let sum = a + c;
    let size2 = sum * sum + difference * difference;
    let mut gradient = ShapeGradient { shape_index: [0.0; 5], curvedness: [0.0; 5], sum, difference };
    if size2 > 0.0 {
        let inverse_gap = if difference > 0.0 { 1.0 / difference } else { 0.0 };
        let (by_sum, by_gap) = (difference / size2, sum / size2);
        let inverse_size = 1.0 / size2.sqrt();
        for k in 0..5 {
            let d_gap = ((a - c) * (da[k] - dc[k]) + 4.0 * b * db[k]) * inverse_gap;
            let d_sum = da[k] + dc[k];
            gradient.shape_index[k] = -std::f64::consts::FRAC_2_PI * (by_sum * d_sum - by_gap * d_gap);
            gradient.curvedness[k] = (a * da[k] + c * dc[k] + 2.0 * b * db[k]) * inverse_size;
        }
    }
    gradient
}

/// Gradients of the grid means by the coefficients, number `i m + j`.
#[derive(Clone, Debug, PartialEq)]
pub struct MeanGradients {
    /// Of mean S.
    pub shape_index: Vec<f64>,
    /// Of mean R.
    pub curvedness: Vec<f64>,
}

/// d(mean S)/dc and d(mean R)/dc over the supported points where S is defined; `gradients` are those over the maps' grid.
pub fn mean_gradients(surface: &HeightField, maps: &ShapeMaps, gradients: &GridGradients) -> MeanGradients {
    let (unknowns, columns) = (surface.coefficients().len(), surface.coefficients().ncols());
    let mut sums = MeanGradients { shape_index: vec![0.0; unknowns], curvedness: vec![0.0; unknowns] };
    let mut counts = [0usize; 2];
    gradients.visit(surface, &maps.rows, |eight| {
        let ([i, start], width) = (eight.at, surface.knots()[1].degree() + 1);
        let counted: [[bool; 2]; POINTS] = std::array::from_fn(|l| {
            let j = start + l.min(eight.count - 1);
            let is_there = l < eight.count;
            [is_there && maps.shape_index_at(i, j).is_some(), is_there && maps.supported[[i, j]]]
        });
        for (kind, sums) in [&mut sums.shape_index, &mut sums.curvedness].into_iter().enumerate() {
            counts[kind] += counted.iter().filter(|counted| counted[kind]).count();
            for (a, entries) in eight.entries[kind].chunks_exact(width).enumerate() {
                let home = &mut sums[(eight.first[0] + a) * columns + eight.first[1]..][..width];
                for (home, lanes) in home.iter_mut().zip(entries) {
                    let values = lanes.iter().zip(&counted).map(|(v, counted)| if counted[kind] { *v } else { 0.0 });
                    *home += values.sum::<f64>();
                }
            }
        }
    });
    sums.shape_index.iter_mut().for_each(|v| *v /= counts[0].max(1) as f64);
    sums.curvedness.iter_mut().for_each(|v| *v /= counts[1].max(1) as f64);
    sums
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gradients_match_differences() {
        let at = |v: [f64; 5]| SurfacePoint { z: 0.0, zx: v[0], zy: v[1], zxx: v[2], zxy: v[3], zyy: v[4] };
        let shape = |v: [f64; 5]| {
            let p = at(v).derivatives().principal().unwrap();
            [p.shape_index().unwrap(), p.curvedness()]
        };
        for v in [[0.3, -0.7, 0.5, 0.2, -0.9], [0.0, 0.0, -1.0, 0.3, -2.0], [4.0, 3.0, 0.1, -0.2, 0.4]] {
            let ShapeGradient { shape_index: ds, curvedness: dr, .. } = shape_gradient(&at(v));
            for k in 0..5 {
                let h = 1e-6;
                let (mut up, mut down) = (v, v);
                up[k] += h;
                down[k] -= h;
                let (hi, lo) = (shape(up), shape(down));
                assert!((ds[k] - (hi[0] - lo[0]) / (2.0 * h)).abs() < 1e-8, "S {k} {v:?}");
                assert!((dr[k] - (hi[1] - lo[1]) / (2.0 * h)).abs() < 1e-8, "R {k} {v:?}");
            }
        }
    }
}
