//! Rotations and tangent frames, as much of them as the simulated world needs.

use palpate_numeric::vector::{Vector, dot};

pub(super) type Matrix = [[f64; 3]; 3];

pub(super) const UP: Vector = [0.0, 0.0, 1.0];

/// Two unit tangents that make a right-handed frame with the unit vector `n`; continuous away from n = -z.
///
/// T. Duff et al., *Building an orthonormal basis, revisited*, J. Comput. Graphics Techniques 6 (2017) 1.
#[inline]
pub(super) fn tangents(n: Vector) -> (Vector, Vector) {
    let sign = 1.0_f64.copysign(n[2]);
    let a = -1.0 / (sign + n[2]);
    let b = n[0] * n[1] * a;
    ([1.0 + sign * n[0] * n[0] * a, sign * b, -sign * n[0]], [b, sign + n[1] * n[1] * a, -n[1]])
}

/// The matrix times `v`.
#[inline]
pub(super) fn rotated(m: &Matrix, v: Vector) -> Vector {
    [dot(m[0], v), dot(m[1], v), dot(m[2], v)]
}

/// The transposed (for a rotation: inverse) matrix times `v`.
#[inline]
pub(super) fn rotated_back(m: &Matrix, v: Vector) -> Vector {
    [0, 1, 2].map(|k| m[0][k] * v[0] + m[1][k] * v[1] + m[2][k] * v[2])
}

/// The product of two matrices.
pub(super) fn product(a: &Matrix, b: &Matrix) -> Matrix {
    a.map(|row| rotated_back(b, row))
}

/// `(sin, cos)` of degrees, exact at multiples of 90 and symmetric about 45: a cylinder rotated by 90 degrees has
/// slopes of exactly zero along its generators.
pub(super) fn sin_cos_deg(degrees: f64) -> (f64, f64) {
    let angle = degrees.rem_euclid(360.0);
    let quarter = (angle / 90.0).floor();
    let rest = angle - 90.0 * quarter;
    let (s, c) = if rest <= 45.0 {
        rest.to_radians().sin_cos()
    } else {
        let (c, s) = (90.0 - rest).to_radians().sin_cos();
        (s, c)
    };
    match quarter as u8 % 4 {
        0 => (s, c),
        1 => (c, -s),
        2 => (-s, -c),
        _ => (-c, s),
    }
}

/// `Rz(c) Ry(b) Rx(a)` for degrees `[a, b, c]`: first about x, then y, then z, all fixed axes.
pub(super) fn rotation(degrees: Vector) -> Matrix {
    let [(sx, cx), (sy, cy), (sz, cz)] = degrees.map(sin_cos_deg);
    let about_x = [[1.0, 0.0, 0.0], [0.0, cx, -sx], [0.0, sx, cx]];
    let about_y = [[cy, 0.0, sy], [0.0, 1.0, 0.0], [-sy, 0.0, cy]];
    let about_z = [[cz, -sz, 0.0], [sz, cz, 0.0], [0.0, 0.0, 1.0]];
    product(&about_z, &product(&about_y, &about_x))
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_numeric::vector::{cross, unit};

    #[test]
    fn quarter_turns_are_exact() {
        for (degrees, expected) in [(0.0, (0.0, 1.0)), (90.0, (1.0, 0.0)), (180.0, (0.0, -1.0)), (-90.0, (-1.0, 0.0))] {
            let (s, c) = sin_cos_deg(degrees);
            assert_eq!((s + 0.0, c + 0.0), expected);
        }
        let (s, c) = sin_cos_deg(45.0);
        assert_eq!(s.max(c) - s.min(c), (s - c).abs());
        assert!((sin_cos_deg(30.0).0 - 0.5).abs() < 1e-16 && (sin_cos_deg(150.0).0 - 0.5).abs() < 1e-16);
    }

    #[test]
    fn tangents_are_orthonormal() {
        for n in [[0.0, 0.0, 1.0], unit([1.0, -2.0, 0.5]), unit([0.3, 0.1, -0.9])] {
            let (a, b) = tangents(n);
            let c = cross(a, b);
            assert!(dot(a, n).abs() < 1e-15 && dot(b, n).abs() < 1e-15 && dot(a, b).abs() < 1e-15);
            assert!((0..3).all(|k| (c[k] - n[k]).abs() < 1e-15));
        }
    }
}
