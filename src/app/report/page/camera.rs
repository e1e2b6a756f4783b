//! The eye that still pictures are seen from; the turning view (`assets/stage.js`) begins with the same eye, box and margin,
//! so that it takes a picture's place without a jump.
//!
//! ```text
//! p = point - middle of the box        w = D - p.e        (x, y) = (p.r, p.u) / (w tan 15 deg)        D = 2.2 diagonals
//! ```
//!
//! `e` points to the camera, `r` across, `u` up.

use std::fmt::Write as _;

use palpate_numeric::vector::{Vector, cross, dot, minus, unit};

use super::html::text;

/// Where the eye stands: front, left, above.
const EYE: Vector = [-0.47, -0.7, 0.54];
/// Its distance in diagonals of the box.
const AWAY: f64 = 2.2;
/// Half of the picture's height at distance 1: the tangent of 15 degrees.
const OPENING: f64 = 0.267_949_192_431_122_7;
/// Part of the picture that the box may fill.
const FILLED: f64 = 0.86;
/// Units of the viewing box along its longer side: half a pixel of a wide screen.
const SIDE: f64 = 2000.0;

/// The camera, and the box that it looks at.
pub(super) struct Camera {
    low: Vector,
    high: Vector,
    distance: f64,
    /// Across, up, towards the camera.
    axes: [Vector; 3],
}

impl Camera {
    pub(super) fn new(points: &[Vector]) -> Camera {
        let ends = [0, 1, 2].map(|k| {
            let finite = points.iter().map(|p| p[k]).filter(|v| v.is_finite());
            let (lo, hi) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
            if lo <= hi { (lo, hi) } else { (0.0, 0.0) }
        });
        let (low, high) = (ends.map(|(lo, _)| lo), ends.map(|(_, hi)| hi));
        let diagonal = dot(minus(high, low), minus(high, low)).sqrt();
        let towards = unit(EYE);
        let across = unit(cross([0.0, 0.0, 1.0], towards));
        let distance = AWAY * dot(EYE, EYE).sqrt() * if diagonal > 0.0 { diagonal } else { 1.0 };
        Camera { low, high, distance, axes: [across, cross(towards, across), towards] }
    }

    /// The middle of the box.
    pub(super) fn centre(&self) -> Vector {
        [0, 1, 2].map(|k| 0.5 * (self.low[k] + self.high[k]))
    }

    /// Whether a surface at a point shows this side.
    pub(super) fn faces(&self, p: Vector, normal: Vector) -> bool {
        let camera = [0, 1, 2].map(|k| self.centre()[k] + self.distance * self.axes[2][k]);
        dot(minus(camera, p), normal) > 0.0
    }

    /// The paper that just holds the box.
    pub(super) fn canvas(&self) -> Canvas {
        let reach = self.reach();
        let scale = 0.5 * FILLED * SIDE / reach[0].max(reach[1]);
        Canvas { scale, size: reach.map(|reach| 2.0 * scale * reach / FILLED) }
    }

    /// Across, up, and towards the camera, in lengths.
    pub(super) fn turned(&self, p: Vector) -> Vector {
        let p = minus(p, self.centre());
        self.axes.map(|axis| dot(p, axis))
    }

    /// Where a point is seen; the picture is 2 high for a camera of 30 degrees.
    fn seen(&self, p: Vector) -> [f64; 2] {
        let [x, y, near] = self.turned(p);
        let scale = OPENING * (self.distance - near);
        [x / scale, y / scale]
    }

    fn corner(&self, bits: usize) -> Vector {
        [0, 1, 2].map(|k| if bits >> k & 1 == 1 { self.high[k] } else { self.low[k] })
    }

    /// How far the box reaches across and up.
    fn reach(&self) -> [f64; 2] {
        let seen = (0..8).map(|bits| self.seen(self.corner(bits)));
        seen.fold([1e-12_f64; 2], |most, p| [0, 1].map(|k| most[k].max(p[k].abs())))
    }

    /// Edges of the box behind the surface (which end at the corner farthest away), or the others.
    fn edges(&self, behind: bool) -> Vec<[Vector; 2]> {
        let far = (0..8).min_by(|a, b| {
            let near = |bits: usize| self.turned(self.corner(bits))[2];
            near(*a).total_cmp(&near(*b))
        });
        let pairs = (0..8_usize).flat_map(|bits| [1, 2, 4].map(|axis| (bits, bits | axis)));
        let chosen = pairs.filter(|(a, b)| a != b && (Some(*a) == far || Some(*b) == far) == behind);
        chosen.map(|(a, b)| [self.corner(a), self.corner(b)]).collect()
    }
}

/// A picture with its viewing box.
pub(super) struct Canvas {
    scale: f64,
    size: [f64; 2],
}

impl Canvas {
    /// The first tag.
    pub(super) fn begin(&self, label: &str) -> String {
        let ([width, height], label) = (self.size, text(label));
        format!(
            "<svg class=\"perspective\" viewBox=\"0 0 {width:.0} {height:.0}\" role=\"img\" aria-label=\"{label}\">\n"
        )
    }

    /// Where a point stands, as paths have it.
    pub(super) fn place(&self, camera: &Camera, p: Vector) -> String {
        let ([x, y], [width, height]) = (camera.seen(p), self.size);
        format!("{:.0} {:.0}", 0.5 * width + self.scale * x, 0.5 * height - self.scale * y)
    }

    /// How wide a length in the middle of the box is drawn.
    pub(super) fn width(&self, camera: &Camera, length: f64) -> f64 {
        self.scale * length / (OPENING * camera.distance)
    }

    /// Edges of the box, behind what stands in it or before it.
    pub(super) fn edges(&self, camera: &Camera, behind: bool) -> String {
        let mut path = String::new();
        for [a, b] in camera.edges(behind) {
            let _ = write!(path, "M{}L{}", self.place(camera, a), self.place(camera, b));
        }
        format!("<path class=\"box\" d=\"{path}\"/>\n")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_box_stands_in_the_middle_and_its_farthest_corner_behind() {
        let camera = Camera::new(&[[-1.0, -2.0, 0.0], [3.0, 2.0, 1.0], [f64::NAN, 0.0, 0.0]]);
        assert_eq!(camera.centre(), [1.0, 0.0, 0.5]);
        assert_eq!(camera.seen(camera.centre()), [0.0, 0.0]);
        let reach = camera.reach();
        assert!(reach.iter().all(|v| (0.1..1.0).contains(v)), "{reach:?}");
        assert_eq!((camera.edges(true).len(), camera.edges(false).len()), (3, 9));
        assert!(camera.edges(true).iter().flatten().filter(|p| **p == [3.0, 2.0, 0.0]).count() == 3);
        assert!(camera.faces([1.0, 0.0, 1.0], [0.0, 0.0, 1.0]) && !camera.faces([1.0, 0.0, 1.0], [0.0, 1.0, 0.0]));
    }
}
