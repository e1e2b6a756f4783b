//! The questions that every body answers in closed form, or by a search along a line.

use super::SurfacePoint;
use super::local::Local;
use crate::scene::error::SceneError;

/// What a body must be able to tell. Its apex is at the origin, its free side upwards.
///
/// The table of [`Body`](super::Body) passes every question on to the file of the body, so a new body is: its file, its module in
/// `mod.rs`, its line in the table, and its keys in `io/scene_file/surface.rs`.
pub trait Geometry {
    /// Checks that every size is in its range.
    fn check(&self) -> Result<(), SceneError>;

    /// Height over (x, y); `None` where the body does not reach.
    fn height(&self, x: f64, y: f64) -> Option<f64>;

    /// Normal and curvatures at a point of the body; `None` where there are none.
    fn local(&self, p: [f64; 3]) -> Option<Local>;

    /// Parameter t of the uppermost point of the body along `o + t d`; `None` where the line misses it.
    fn hit(&self, o: [f64; 3], d: [f64; 3]) -> Option<f64>;

    /// The point at `across` (length along a bar, degrees round a ring) and `angle` (radians round it, from its top);
    /// `None` for bodies that fingers cannot go round.
    fn around(&self, _across: f64, _angle: f64) -> Option<[f64; 3]> {
        None
    }

    /// `across` and `angle` of the point nearest to `p`, as [`Geometry::around`] takes them.
    fn nearest(&self, _p: [f64; 3]) -> Option<[f64; 2]> {
        None
    }

    /// Points `spacing` apart all over the body, those that `eye` sees where there is one; `None` for bodies that are not
    /// scanned.
    fn scan(&self, _spacing: f64, _eye: Option<[f64; 3]>) -> Option<Vec<SurfacePoint>> {
        None
    }

    /// Name of the size that limits how far the body reaches, and what it would have to be to reach (x, y).
    fn needed(&self, _x: f64, _y: f64) -> Option<(&'static str, f64)> {
        None
    }
}
