//! Vectors of space.

/// A point or direction.
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

/// `|a|`.
#[inline]
pub fn norm(a: Vector) -> f64 {
    dot(a, a).sqrt()
}

/// `a - b`.
#[inline]
pub fn minus(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `a / |a|`; zero stays zero.
pub fn unit(a: Vector) -> Vector {
    let length = norm(a);
    if length > 0.0 { a.map(|v| v / length) } else { a }
}

/// Length of the arc between two points whose normals turn by t: the chord times `(t/2) / sin(t/2)`, exact on circles.
pub fn arc(from: Vector, to: Vector, normal_from: Vector, normal_to: Vector) -> f64 {
    let chord = norm(minus(to, from));
    let half = 0.5 * norm(cross(normal_from, normal_to)).atan2(dot(normal_from, normal_to));
    if half > 1e-6 { chord * half / half.sin() } else { chord }
}
