//! Axes for a height field over a patch that may lie in any way: they rotate with the contacts.
//!
//! ```text
//! z = mean unit normal, or the direction of least spread        x, y = sides of the rectangle of least area about the outline
//! ```
//!
//! A spline over the box of the contacts has no coefficients without data where the box has no empty corners. A side of the
//! rectangle of least area lies along a side of the convex hull (H. Freeman and R. Shapira, *Commun. ACM* 18 (1975) 409).

use crate::recognition::RecognitionOptions;
use crate::recognition::contacts::patch_frame;
use palpate_geometry::contact::{Contacts, Orientation};
use palpate_geometry::convex_hull::convex_hull;
use palpate_numeric::vector::{Vector, along, cross, dot, minus};

/// A later side of the hull counts as better when its rectangle is smaller by more than this share, so that rounding does
/// not choose between the sides of a lattice.
const SMALLER: f64 = 1e-9;

/// Rows are x, y and z; `None` where the contacts are on one line.
pub fn own_axes(contacts: &Contacts, options: &RecognitionOptions) -> Option<[Vector; 3]> {
    let points: Vec<Vector> = (0..contacts.len()).map(|r| [contacts.x[r], contacts.y[r], contacts.z[r]]).collect();
    let normals: Option<Vec<Vector>> = match contacts.orientation {
        Orientation::Normals { .. } => Some((0..contacts.len()).map(|r| known(contacts.unit_normal(r))).collect()),
        _ => None,
    };
    let frame = patch_frame(&points, normals.as_deref(), options).ok()?;
    let flat: Vec<[f64; 2]> = points
        .iter()
        .map(|p| minus(*p, frame.origin))
        .map(|d| [dot(d, frame.axes[0]), dot(d, frame.axes[1])])
        .collect();
    let [a, b] = side_of_least_rectangle(&convex_hull(&flat))?;
    let z = frame.axes[2];
    let x = along(frame.axes[0].map(|v| a * v), b, frame.axes[1]);
    Some([x, cross(z, x), z])
}

/// Normals of length zero are unknown.
fn known(normal: Option<Vector>) -> Vector {
    normal.filter(|n| n.iter().all(|v| v.is_finite())).unwrap_or([0.0; 3])
}

/// Unit vector along one side of the rectangle of least area about a convex outline.
fn side_of_least_rectangle(hull: &[[f64; 2]]) -> Option<[f64; 2]> {
    let mut best: Option<(f64, [f64; 2])> = None;
    for (k, [x, y]) in hull.iter().enumerate() {
        let [to_x, to_y] = hull[(k + 1) % hull.len()];
        let length = (to_x - x).hypot(to_y - y);
        if length == 0.0 {
            continue;
        }
        let side = [(to_x - x) / length, (to_y - y) / length];
        let width = |[a, b]: [f64; 2]| {
            let places = hull.iter().map(|[x, y]| a * x + b * y);
            let (lo, hi) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
            hi - lo
        };
        let area = width(side) * width([-side[1], side[0]]);
        if best.is_none_or(|(least, _)| area < (1.0 - SMALLER) * least) {
            best = Some((area, side));
        }
    }
    best.map(|(_, side)| side)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bar of 8 by 2 that is rotated in its plane and then stood up.
    #[test]
    fn axes_follow_the_sides_of_a_bar_that_stands() {
        let angle = 0.4_f64;
        let points: Vec<Vector> = (0..180)
            .map(|k| [0.2 * (k % 36) as f64, 0.5 * (k / 36) as f64])
            .map(|[u, v]| [u * angle.cos() - v * angle.sin(), 3.0, u * angle.sin() + v * angle.cos()])
            .collect();
        let options = RecognitionOptions { viewpoint: Some([0.0, 9.0, 0.0]), ..RecognitionOptions::default() };
        let [x, y, z] = own_axes(&Contacts::from_points(&points), &options).unwrap();
        let expected = [angle.cos(), 0.0, angle.sin()];
        assert!(dot(x, expected).abs().max(dot(y, expected).abs()) > 1.0 - 1e-12, "{x:?} {y:?}");
        assert!(z[1] > 1.0 - 1e-12, "{z:?}");
    }
}
