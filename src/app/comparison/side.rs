//! One of two surfaces that are compared: where it is, where contacts support it, what its uncertainty is.

use palpate_geometry::contact::Frame;
use palpate_geometry::surface::{AlongAxes, Heights, Jet, Parametric, Surface};
use palpate_numeric::bspline::linspace;

use super::Quantities;

/// Points each way from which the extent of a surface is taken.
const EXTENT: usize = 9;

/// Cosine between axes that count as the same: rounding of a rotation, and nothing that could be seen.
const SAME_AXES: f64 = 1e-12;

/// A surface of either kind, input units.
#[derive(Clone, Copy, Debug)]
pub(crate) enum ComparedSurface<'a> {
    /// Along the frame's axes.
    Height(&'a dyn Heights, &'a Frame),
    /// A map into space.
    Space(&'a Parametric),
}

/// A surface with what is known of it.
#[derive(Clone, Copy)]
pub(crate) struct Side<'a> {
    pub(crate) surface: ComparedSurface<'a>,
    /// Whether contacts support a place of its chart.
    pub(crate) supported: &'a dyn Fn([f64; 2]) -> bool,
    /// Standard uncertainties at a place of its chart: along the normal, of the normal (degrees), of S, of R.
    pub(crate) uncertainty: &'a dyn Fn([f64; 2]) -> Quantities,
    /// Degrees of freedom behind them; `None` where noise was declared or nothing is known.
    pub(crate) dof: Option<f64>,
}

/// One point of a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Here {
    pub(super) point: [f64; 3],
    pub(super) normal: [f64; 3],
    pub(super) shape_index: Option<f64>,
    pub(super) curvedness: Option<f64>,
    pub(super) u: Quantities,
}

impl Side<'_> {
    /// The surface as a map into space, input axes.
    fn map<A>(&self, ask: impl FnOnce(&dyn Surface) -> A) -> A {
        match self.surface {
            ComparedSurface::Height(surface, frame) => ask(&AlongAxes { surface, frame }),
            ComparedSurface::Space(map) => ask(map),
        }
    }

    /// Ranges of the chart.
    pub(super) fn domain(&self) -> [[f64; 2]; 2] {
        self.map(|map| map.domain())
    }

    /// Directions that close.
    pub(super) fn closed(&self) -> [bool; 2] {
        self.map(|map| map.closed())
    }

    pub(super) fn unknowns(&self) -> usize {
        self.map(|map| map.unknowns())
    }

    /// Direction of the heights, input axes.
    pub(super) fn up(&self) -> [f64; 3] {
        match self.surface {
            ComparedSurface::Height(_, frame) => frame.axes[2],
            ComparedSurface::Space(_) => [0.0, 0.0, 1.0],
        }
    }

    /// Whether both are height fields along the same axes.
    pub(super) fn shares_axes_with(&self, other: &Side) -> bool {
        let (ComparedSurface::Height(_, a), ComparedSurface::Height(_, b)) = (self.surface, other.surface) else {
            return false;
        };
        a.axes.iter().flatten().zip(b.axes.iter().flatten()).all(|(a, b)| (a - b).abs() <= SAME_AXES)
    }

    /// The rectangle that both charts cover; `None` where it is empty.
    pub(super) fn common_domain(&self, other: &Side) -> Option<[[f64; 2]; 2]> {
        let (a, b) = (self.domain(), other.domain());
        let common = [0, 1].map(|k| [a[k][0].max(b[k][0]), a[k][1].min(b[k][1])]);
        common.iter().all(|[lo, hi]| lo < hi).then_some(common)
    }

    /// Point and derivatives, whether supported or not.
    pub(super) fn jet(&self, place: [f64; 2]) -> Jet {
        self.map(|map| map.jet(place))
    }

    /// What the surface is at a place of its chart; `None` outside, where no contact supports it, and without a normal.
    pub(super) fn at(&self, place: [f64; 2]) -> Option<Here> {
        if !(self.supported)(place) {
            return None;
        }
        let jet = self.jet(place);
        let principal = jet.principal()?;
        Some(Here {
            point: jet.point,
            normal: principal.normal,
            shape_index: principal.shape_index(),
            curvedness: Some(principal.curvedness()),
            u: (self.uncertainty)(place),
        })
    }

    /// Least and largest coordinates.
    pub(super) fn bounds(&self) -> [[f64; 3]; 2] {
        let [u, v] = self.domain().map(|[lo, hi]| linspace(lo, hi, EXTENT));
        let all = u.iter().flat_map(|u| v.iter().map(move |v| [*u, *v]));
        all.map(|place| self.jet(place).point).fold([[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]], |[lo, hi], p| {
            [[0, 1, 2].map(|k| lo[k].min(p[k])), [0, 1, 2].map(|k| hi[k].max(p[k]))]
        })
    }
}
