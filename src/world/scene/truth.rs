//! What is true of each contact, so that a report can give the error beside the spread.

use super::surface::{Local, Surface, SurfacePoint};
use palpate_numeric::vector::{dot, norm};

/// The truth behind contacts: for each of them, what the surface is where it was made.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth {
    /// The touched points with their normals and curvatures.
    pub points: Vec<SurfacePoint>,
    surface: Surface,
    /// Half of the largest extent of the points: a surface that is farther off is another one.
    reach: f64,
}

impl Truth {
    pub(crate) fn new(points: Vec<SurfacePoint>, surface: Surface) -> Truth {
        let extent = (0..3).map(|k| {
            let range = points.iter().map(|p| p.point[k]);
            let (lo, hi) = range.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
            hi - lo
        });
        let reach = 0.5 * extent.fold(0.0, f64::max);
        Truth { points, surface, reach }
    }

    /// True shape index of contact `r`; `None` where both curvatures are zero.
    pub fn shape_index(&self, r: usize) -> Option<f64> {
        self.points[r].local.shape_index()
    }

    /// True curvedness of contact `r`, 1/length.
    pub fn curvedness(&self, r: usize) -> f64 {
        self.points[r].local.curvedness()
    }

    /// The true surface over any (x, y), input units; `None` where it does not reach.
    pub fn at(&self, x: f64, y: f64) -> Option<SurfacePoint> {
        self.surface.at(x, y)
    }

    /// Mean S and R of the true surface over the given (x, y); `None` where it has none.
    pub fn mean_over(&self, at: impl IntoIterator<Item = [f64; 2]>) -> [Option<f64>; 2] {
        let (mut s, mut s_count, mut r, mut r_count) = (0.0, 0.0, 0.0, 0.0);
        for [x, y] in at {
            let Some(found) = self.at(x, y) else { continue };
            r += found.local.curvedness();
            r_count += 1.0;
            if let Some(shape_index) = found.local.shape_index() {
                s += shape_index;
                s_count += 1.0;
            }
        }
        [(s_count > 0.0).then(|| s / s_count), (r_count > 0.0).then(|| r / r_count)]
    }

    /// The true surface where a line through `point` along `normal` meets it (cylinder, torus: its nearest point), if
    /// within half of the touched extent.
    pub fn near(&self, point: [f64; 3], normal: [f64; 3]) -> Option<Local> {
        if let Some(nearest) = self.surface.nearest_around(point) {
            // round a torus the line would meet the far side of the ring first
            let off = [0, 1, 2].map(|k| point[k] - nearest.point[k]);
            let there = norm(off) <= self.reach && dot(nearest.local.normal, normal) > 0.0;
            return there.then_some(nearest.local);
        }
        let along = self.surface.hit(point, normal).filter(|t| t.abs() <= self.reach)?;
        self.surface.local([0, 1, 2].map(|k| point[k] + along * normal[k]))
    }

    /// Which face of a body of solids each point lies on; `None` for other bodies.
    #[doc(hidden)]
    pub fn faces(&self) -> Option<Vec<usize>> {
        self.points.iter().map(|touch| self.surface.face_at(touch.point)).collect()
    }

    /// The kinds of those faces: `plane`, `sphere`, `cylinder`, `cone`, `torus`.
    pub fn face_kinds(&self) -> Vec<&'static str> {
        match &self.surface.body {
            super::surface::Body::Solids(solids) => solids.face_kinds(),
            _ => Vec::new(),
        }
    }

    /// The true surface.
    pub fn surface(&self) -> &Surface {
        &self.surface
    }

    /// Label of an imported surface: results on it are an inverse crime and say so.
    pub fn inverse_crime(&self) -> Option<&str> {
        self.surface.inverse_crime()
    }
}
