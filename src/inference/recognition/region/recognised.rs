//! The recognised surface, a patch or a body, as a map `Q(u, v)` into space over a rectangle of its chart.

use palpate_geometry::contact::Frame;

use super::projected_grid::LookedAt;
use super::surface::PatchSurface;
use crate::bodies::BodyChart;
use crate::recognition::discrepancy::ChartPoint;

/// The surface that was recognised, of whichever kind, in the input's coordinates.
#[derive(Clone, Debug)]
pub struct RecognisedSurface {
    /// Frame of the contacts; its length is the unit of u and v.
    pub frame: Frame,
    /// Range of the first chart coordinate that the contacts cover, in units of the frame's length.
    pub u: [f64; 2],
    /// Range of the second chart coordinate.
    pub v: [f64; 2],
    form: SurfaceForm,
}

/// What answers for the surface.
#[derive(Clone, Debug)]
enum SurfaceForm {
    Patch(Box<PatchSurface>),
    Body(Box<BodyChart>),
}

impl From<PatchSurface> for RecognisedSurface {
    fn from(patch: PatchSurface) -> RecognisedSurface {
        let PatchSurface { frame, u, v, .. } = patch;
        RecognisedSurface { frame, u, v, form: SurfaceForm::Patch(Box::new(patch)) }
    }
}

impl RecognisedSurface {
    /// A body, under a frame of the same length.
    pub(crate) fn of_body(frame: Frame, body: BodyChart) -> RecognisedSurface {
        RecognisedSurface { frame, u: body.u, v: body.v, form: SurfaceForm::Body(Box::new(body)) }
    }

    /// The body, where it is one.
    pub(crate) fn body(&self) -> Option<&BodyChart> {
        match &self.form {
            SurfaceForm::Patch(_) => None,
            SurfaceForm::Body(body) => Some(body),
        }
    }

    /// Point and unit normal at chart coordinates, in the input's coordinates.
    pub fn at(&self, u: f64, v: f64) -> ([f64; 3], [f64; 3]) {
        match &self.form {
            SurfaceForm::Patch(patch) => patch.at(u, v),
            SurfaceForm::Body(body) => body.at(u, v),
        }
    }

    /// Principal curvatures k1 >= k2 at chart coordinates, 1/length of the input; `None` where the chart folds.
    pub fn curvatures_at(&self, u: f64, v: f64) -> Option<[f64; 2]> {
        match &self.form {
            SurfaceForm::Patch(patch) => patch.curvatures_at(u, v),
            SurfaceForm::Body(body) => body.curvatures_at(u, v),
        }
    }

    /// Points of the surface over an even grid of the input's x and y, `None` where it does not reach, with their unit normals, and
    /// whether contacts surround them; y runs fastest.
    pub(crate) fn over(&self, over: [[f64; 2]; 2], points: [usize; 2]) -> Vec<(Option<[f64; 3]>, [f64; 3], bool)> {
        let SurfaceForm::Patch(patch) = &self.form else { return Vec::new() };
        let one = |(here, reached): (ChartPoint, bool)| {
            let (place, normal) = patch.place_and_normal(&here);
            (reached.then_some(place), normal, reached && patch.holds(&here))
        };
        LookedAt::new(patch).product(patch, over, points).into_iter().map(one).collect()
    }

    /// Whether contacts surround the surface at chart coordinates.
    pub fn supported_at(&self, u: f64, v: f64) -> bool {
        match &self.form {
            SurfaceForm::Patch(patch) => patch.supported_at(u, v),
            SurfaceForm::Body(body) => body.supported_at(u, v),
        }
    }

    /// Chart coordinates of the surface's point nearest to a place in the input's coordinates.
    pub fn chart_of(&self, place: [f64; 3]) -> [f64; 2] {
        match &self.form {
            SurfaceForm::Patch(patch) => patch.chart_of(place),
            SurfaceForm::Body(body) => body.chart_of(place),
        }
    }

    /// Signed distance of a place from the surface, positive on the free side. Input units.
    pub fn distance(&self, place: [f64; 3]) -> f64 {
        match &self.form {
            SurfaceForm::Patch(patch) => patch.distance(place),
            SurfaceForm::Body(body) => body.distance(place),
        }
    }
}
