//! Vectors of space.

pub(super) use palpate_numeric::vector::{Vector, cross, dot, minus, norm, unit_or_zero as unit};

/// Length of the arc between two points whose normals turn by t: the chord times `(t/2) / sin(t/2)`, exact on circles.
pub(super) fn arc(from: Vector, to: Vector, normal_from: Vector, normal_to: Vector) -> f64 {
    let chord = norm(minus(to, from));
    let half = 0.5 * norm(cross(normal_from, normal_to)).atan2(dot(normal_from, normal_to));
    if half > 1e-6 { chord * half / half.sin() } else { chord }
}
