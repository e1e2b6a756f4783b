//! A patch as a map `Q(u, v)` into space, over a rectangle of its chart.
//!
//! ```text
//! general, displaced   Q(u, v) = point at arc lengths (u, v), moved by f(u, v) along the normal
//! all others           Q(u, v) = foot, on the reported surface, of the general surface's point
//! ```

use std::sync::Arc;

use crate::recognition::discrepancy::{ChartPoint, Displacement, State};
use crate::recognition::kinds::{ConstantCurvature, Kind};
use palpate_geometry::contact::Frame;

use super::support::Support;

/// A patch of whichever kind, in the input's coordinates.
#[derive(Clone, Debug)]
pub(crate) struct PatchSurface {
    /// Frame in which the surface is written.
    pub(crate) frame: Frame,
    /// Range of the first chart coordinate that the contacts cover, in units of the frame's length.
    pub(crate) u: [f64; 2],
    /// Range of the second chart coordinate.
    pub(crate) v: [f64; 2],
    pub(super) base: ConstantCurvature,
    pub(super) displacement: Option<Displacement>,
    pub(crate) state: State,
    pub(super) support: Arc<Support<'static>>,
}

impl PatchSurface {
    /// Point and unit normal at chart coordinates, in the input's coordinates.
    pub(crate) fn at(&self, u: f64, v: f64) -> ([f64; 3], [f64; 3]) {
        self.place_and_normal(&self.chart_point(u, v))
    }

    /// The same at a chart point.
    pub(super) fn place_and_normal(&self, point: &ChartPoint) -> ([f64; 3], [f64; 3]) {
        let (place, normal) = self.state.place_and_normal(point);
        (self.frame.to_input(place), self.frame.rotate_back(normal))
    }

    /// Principal curvatures k1 >= k2 at chart coordinates, 1/length of the input; `None` where the chart folds.
    pub(crate) fn curvatures_at(&self, u: f64, v: f64) -> Option<[f64; 2]> {
        let curvatures = self.state.curvatures(&self.chart_point(u, v))?;
        Some(curvatures.map(|k| k / self.frame.scale))
    }

    /// Whether contacts surround the surface at chart coordinates.
    pub(crate) fn supported_at(&self, u: f64, v: f64) -> bool {
        self.holds(&self.chart_point(u, v))
    }

    /// The same at a chart point. Contacts surround the surface and not the plane that it stands over; a curved base lies near enough.
    pub(super) fn holds(&self, point: &ChartPoint) -> bool {
        let place = if self.base.is_flat() { self.state.place_and_normal(point).0 } else { point.place };
        self.support.holds(point.chart, place)
    }

    /// Chart coordinates of the surface's point nearest to a place in the input's coordinates.
    pub(crate) fn chart_of(&self, place: [f64; 3]) -> [f64; 2] {
        self.base.chart(self.frame.to_patch(place))
    }

    /// Signed distance of a place from the surface, positive on the free side. Input units.
    pub(crate) fn distance(&self, place: [f64; 3]) -> f64 {
        let local = self.frame.to_patch(place);
        let displaced = match self.state.model().kind() {
            Kind::General if self.displacement.is_some() => {
                let [u, v] = self.base.chart(local);
                self.state.at(&self.chart_point(u, v)).displacement
            }
            _ => 0.0,
        };
        self.frame.scale * (self.state.model().distance(local) - displaced)
    }

    pub(crate) fn chart_point(&self, u: f64, v: f64) -> ChartPoint {
        chart_point(&self.base, self.displacement.as_ref(), [u, v])
    }
}

/// A chart point of the general surface with what the displacement needs there.
pub(crate) fn chart_point(
    base: &ConstantCurvature,
    displacement: Option<&Displacement>,
    chart: [f64; 2],
) -> ChartPoint {
    ChartPoint { chart, place: base.point(chart[0], chart[1], 0.0), row: displacement.map(|d| d.at(chart)) }
}
