//! Arithmetic of three-vectors, `[f64; 3]`: the one place for dot and cross products, lengths and unit vectors.
//!
//! ```text
//! a . b = sum_k a_k b_k        |a| = sqrt(a . a)        unit(a) = a / |a|
//! ```
//!
//! Lengths and unit vectors come in variants, because the plain formulas square their arguments: components above
//! 1e154 overflow and components below 1e-154 vanish. The plain variants are the fastest and serve where the caller
//! knows the scale; the guarded ones serve where the numbers come straight from a user or from derivatives. The variants
//! round differently, so a caller cannot change from one to another without moving last digits.

/// A point or a direction.
pub type Vector = [f64; 3];

/// `a . b`.
#[inline]
pub fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// `a x b`.
#[inline]
pub fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// `a - b`.
#[inline]
pub fn minus(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `s a`.
#[inline]
pub fn scaled(s: f64, a: Vector) -> Vector {
    [s * a[0], s * a[1], s * a[2]]
}

/// `a + s b`.
#[inline]
pub fn along(a: Vector, s: f64, b: Vector) -> Vector {
    [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]]
}

/// `|a|` by the plain formula.
#[inline]
pub fn norm(a: Vector) -> f64 {
    dot(a, a).sqrt()
}

/// `|a|` by two calls of `hypot`, which neither overflow nor underflow.
#[inline]
pub fn norm_hypot(a: Vector) -> f64 {
    a[0].hypot(a[1]).hypot(a[2])
}

/// `a / |a|` by the plain formula; not a number when `a` is zero.
#[inline]
pub fn unit(a: Vector) -> Vector {
    let length = norm(a);
    a.map(|v| v / length)
}

/// `a / |a|` by the plain formula; zero stays zero.
#[inline]
pub fn unit_or_zero(a: Vector) -> Vector {
    let length = norm(a);
    if length > 0.0 { a.map(|v| v / length) } else { a }
}

/// `a / |a|`, first divided by the largest component so that neither tiny nor huge components lose the length.
#[inline]
pub fn unit_rescaled(a: Vector) -> Vector {
    let largest = a[0].abs().max(a[1].abs()).max(a[2].abs());
    unit(a.map(|v| v / largest))
}

/// The part of `a` perpendicular to the unit vector `n`: `a - (a . n) n`.
#[inline]
pub fn reject(a: Vector, n: Vector) -> Vector {
    let component = dot(a, n);
    [0, 1, 2].map(|k| a[k] - component * n[k])
}

/// Two unit vectors that complete the unit vector `a` to right-handed axes.
pub fn axes_along(a: Vector) -> [Vector; 3] {
    let least = (0..3).fold(0, |least, k| if a[k].abs() < a[least].abs() { k } else { least });
    let mut start = [0.0; 3];
    start[least] = 1.0;
    let e1 = unit(reject(start, a));
    [e1, cross(a, e1), a]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_agree_with_the_hand() {
        let (a, b) = ([1.0, -2.0, 3.0], [4.0, 0.5, -1.0]);
        assert_eq!(dot(a, b), 0.0);
        assert_eq!(cross(a, b), [0.5, 13.0, 8.5]);
        assert_eq!(minus(a, b), [-3.0, -2.5, 4.0]);
        assert_eq!(scaled(2.0, a), [2.0, -4.0, 6.0]);
        assert_eq!(along(a, 2.0, b), [9.0, -1.0, 1.0]);
        assert_eq!(reject(a, [0.0, 0.0, 1.0]), [1.0, -2.0, 0.0]);
    }

    #[test]
    fn lengths_and_unit_vectors_agree_at_ordinary_scales() {
        let a = [2.0, -3.0, 6.0];
        assert_eq!((norm(a), norm_hypot(a)), (7.0, 7.0));
        for unit in [unit(a), unit_or_zero(a), unit_rescaled(a)] {
            assert!((0..3).all(|k| (unit[k] - a[k] / 7.0).abs() < 2e-16));
        }
    }

    #[test]
    fn guarded_variants_hold_at_extreme_scales_and_at_zero() {
        for scale in [1e-300, 1e300] {
            let a = scaled(scale, [2.0, -3.0, 6.0]);
            assert!((norm_hypot(a) / scale - 7.0).abs() < 1e-14);
            assert!((unit_rescaled(a)[2] - 6.0 / 7.0).abs() < 2e-16);
            assert!(norm(a) == 0.0 || norm(a) == f64::INFINITY);
        }
        assert_eq!(unit_or_zero([0.0; 3]), [0.0; 3]);
        assert!(unit([0.0; 3])[0].is_nan());
    }
}
