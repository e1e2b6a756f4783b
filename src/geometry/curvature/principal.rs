//! `k1`, `k2` and their directions from the first and second derivatives of `Q(u, v)`.

use palpate_numeric::vector::{cross, dot, norm_hypot};

/// First and second derivatives of a surface map `Q(u, v)` into space.
///
/// A height field is `Q = (x, y, S(x, y))`: see [`Derivatives::of_height`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Derivatives {
    /// dQ/du.
    pub u: [f64; 3],
    /// dQ/dv.
    pub v: [f64; 3],
    /// d2Q/du2.
    pub uu: [f64; 3],
    /// d2Q/dudv.
    pub uv: [f64; 3],
    /// d2Q/dv2.
    pub vv: [f64; 3],
}

impl Derivatives {
    /// Derivatives of `(x, y, S(x, y))` from those of S.
    pub fn of_height(sx: f64, sy: f64, sxx: f64, sxy: f64, syy: f64) -> Derivatives {
        Derivatives {
            u: [1.0, 0.0, sx],
            v: [0.0, 1.0, sy],
            uu: [0.0, 0.0, sxx],
            uv: [0.0, 0.0, sxy],
            vv: [0.0, 0.0, syy],
        }
    }
}

/// Principal curvatures with their directions, `k1 >= k2`, in 1/length of the input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Principal {
    /// Larger curvature.
    pub k1: f64,
    /// Smaller curvature.
    pub k2: f64,
    /// `k1 - k2`, formed without cancellation.
    pub difference: f64,
    /// Unit direction of k1 in space.
    pub direction1: [f64; 3],
    /// Unit direction of k2 in space.
    pub direction2: [f64; 3],
    /// Unit normal `Q_u x Q_v / |Q_u x Q_v|`.
    pub normal: [f64; 3],
}

impl Principal {
    /// Shape index in [-1, 1]; `None` where both curvatures are zero.
    pub fn shape_index(&self) -> Option<f64> {
        shape_index(self.k1 + self.k2, self.difference)
    }

    /// Curvedness in 1/length.
    pub fn curvedness(&self) -> f64 {
        curvedness(self.k1, self.k2)
    }
}

/// `S = -(2/pi) atan2(k1 + k2, k1 - k2)`; `None` where both are zero. `difference >= 0`.
pub fn shape_index(sum: f64, difference: f64) -> Option<f64> {
    if sum == 0.0 && difference == 0.0 {
        return None;
    }
    Some(-std::f64::consts::FRAC_2_PI * sum.atan2(difference))
}

/// `R = sqrt((k1^2 + k2^2) / 2)`, without overflow or underflow.
pub fn curvedness(k1: f64, k2: f64) -> f64 {
    k1.hypot(k2) * std::f64::consts::FRAC_1_SQRT_2
}

/// `k1, k2 = R (+-cos a - sin a)`, a = pi S / 2: the larger and the smaller curvature of S and R.
pub fn principal_curvatures([shape_index, curvedness]: [f64; 2]) -> [f64; 2] {
    let (sin, cos) = (std::f64::consts::FRAC_PI_2 * shape_index).sin_cos();
    [curvedness * (cos - sin), curvedness * (-cos - sin)]
}

impl Derivatives {
    /// Principal curvatures from the symmetric shape operator in an orthonormal tangent frame.
    ///
    /// With `e1 = Q_u/|Q_u|`, `e2` its in-plane complement, `Q_u = l e1`, `Q_v = s e1 + t e2` the operator is
    /// `a = e/l^2`, `b = (f - (s/l) e)/(l t)`, `c = (g - 2 (s/l) f + (s/l)^2 e)/t^2` with `e, f, g` of Eq. 9.
    /// Returns `None` where `Q_u` and `Q_v` are parallel or zero: there is no tangent plane.
    ///
    /// ```
    /// # use palpate_geometry::facade as palpate;
    /// use palpate::geometry::Derivatives;
    ///
    /// // the top of a ball of radius 7: the surface falls away on all sides, so both curvatures are negative
    /// let ball = Derivatives::of_height(0.0, 0.0, -1.0 / 7.0, 0.0, -1.0 / 7.0).principal().unwrap();
    /// assert!(ball.k1 < 0.0 && ball.k1 == ball.k2);
    /// assert_eq!(ball.shape_index(), Some(1.0)); // a cap
    /// assert!((ball.curvedness() - 1.0 / 7.0).abs() < 1e-15);
    /// ```
    pub fn principal(&self) -> Option<Principal> {
        let q = self;
        let normal_scaled = cross(q.u, q.v);
        let area = norm_hypot(normal_scaled);
        let length = norm_hypot(q.u);
        if area == 0.0 || length == 0.0 || !area.is_finite() {
            return None;
        }
        let normal = normal_scaled.map(|w| w / area);
        let e1 = q.u.map(|w| w / length);
        let e2 = cross(normal, e1);
        let shear = dot(q.v, e1) / length;
        let height = area / length;
        let (e, f, g) = (dot(q.uu, normal), dot(q.uv, normal), dot(q.vv, normal));
        let a = e / (length * length);
        let b = (f - shear * e) / (length * height);
        let c = (g - shear * (2.0 * f - shear * e)) / (height * height);
        let half_gap = (0.5 * (a - c)).hypot(b);
        let mean = 0.5 * (a + c);
        // eigenvector of the larger eigenvalue: half the angle of (a - c, 2 b)
        let angle = 0.5 * b.atan2(0.5 * (a - c));
        let (sin, cos) = angle.sin_cos();
        let combine = |p: f64, r: f64| [0, 1, 2].map(|k| p * e1[k] + r * e2[k]);
        Some(Principal {
            k1: mean + half_gap,
            k2: mean - half_gap,
            difference: 2.0 * half_gap,
            direction1: combine(cos, sin),
            direction2: combine(-sin, cos),
            normal,
        })
    }
}

/// Both principal curvatures, the larger first, without their directions; `None` where there is no tangent plane. It costs a
/// third of [`Derivatives::principal`], without its care for lengths near overflow.
#[inline]
pub fn curvatures(q: &Derivatives) -> Option<[f64; 2]> {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curvatures_come_back_from_shape_index_and_curvedness() {
        for [k1, k2] in [[0.3, 0.1], [0.2, -0.5], [-0.1, -0.4], [0.2, 0.0], [0.25, 0.25]] {
            let found = principal_curvatures([shape_index(k1 + k2, k1 - k2).unwrap(), curvedness(k1, k2)]);
            assert!((found[0] - k1).abs() < 1e-14 && (found[1] - k2).abs() < 1e-14, "{k1} {k2}: {found:?}");
        }
    }

    #[test]
    fn convex_sphere_is_a_cap_and_the_umbilic_is_exact() {
        let radius = 7.0;
        let p = Derivatives::of_height(0.0, 0.0, -1.0 / radius, 0.0, -1.0 / radius).principal().unwrap();
        assert_eq!(p.difference, 0.0);
        assert_eq!(p.shape_index(), Some(1.0));
        assert!((p.curvedness() - 1.0 / radius).abs() < 1e-16);
    }

    #[test]
    fn plane_has_no_shape_index() {
        let p = Derivatives::of_height(0.3, -2.0, 0.0, 0.0, 0.0).principal().unwrap();
        assert_eq!(p.shape_index(), None);
        assert_eq!(p.curvedness(), 0.0);
    }

    #[test]
    fn parameters_do_not_matter() {
        // cylinder of radius r by angle and length, sheared parameters: u = angle + s * t
        let (radius, angle, shear) = (2.5_f64, 0.4_f64, 0.8);
        let du = [radius * angle.cos(), 0.0, -radius * angle.sin()];
        let duu = [-radius * angle.sin(), 0.0, -radius * angle.cos()];
        let q = Derivatives {
            u: du,
            v: [shear * du[0], 1.0, shear * du[2]],
            uu: duu,
            uv: duu.map(|w| shear * w),
            vv: duu.map(|w| shear * shear * w),
        };
        let p = q.principal().unwrap();
        assert!((p.k1).abs() < 1e-15 && (p.k2 + 1.0 / radius).abs() < 1e-15);
        assert!((p.shape_index().unwrap() - 0.5).abs() < 1e-15);
        assert!((p.direction1[1].abs() - 1.0).abs() < 1e-15);
    }
}
