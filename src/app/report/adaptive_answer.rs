//! A surface with knots where the contacts asked for them, with its shape and where contacts support it.

use crate::io::{PointUncertainty, SupportMap, UncertaintyMap};
use palpate_geometry::shape::{Outline, PointSds, ShapeGrid, ShapeMaps, ShapeReport};
use palpate_geometry::surface::Surface;
use palpate_hierarchical::adaptive::{AdaptiveFit, ShapeQuestion};
use palpate_numeric::bspline::linspace;

use super::document::ShapePart;
use super::uncertainty;

/// Points each way at which its uncertainty is saved: it rises where cells are small.
const UNCERTAINTY_SIDE: usize = 33;

/// The fit, its shape over the grid that was asked for, and the outline of its contacts where no domain was named.
#[derive(Debug)]
pub(crate) struct AdaptiveAnswer {
    pub(crate) fit: AdaptiveFit,
    pub(crate) shape: ShapeReport<ShapeMaps>,
    pub(crate) asked: ShapeQuestion,
    support: Option<Outline>,
}

impl AdaptiveAnswer {
    /// Takes the shape of a fit.
    pub(crate) fn new(fit: AdaptiveFit, support: Option<Outline>, asked: ShapeQuestion) -> AdaptiveAnswer {
        let shape = fit.shape(&asked, support.as_ref());
        AdaptiveAnswer { fit, shape, asked, support }
    }

    /// Maps over the whole domain at so many points each way.
    pub(super) fn maps_over(&self, points: [usize; 2]) -> ShapeMaps {
        self.fit.maps(ShapeGrid::over(self.fit.domain(), points, 0.0), self.support.as_ref())
    }

    /// Standard uncertainties at a place.
    pub(super) fn uncertainty_at(&self, at: [f64; 2]) -> PointUncertainty {
        let Some(sds) = self.sds_at(at) else { return PointUncertainty::default() };
        PointUncertainty {
            position: Some(sds.position),
            normal_deg: Some(sds.normal.to_degrees()),
            shape_index: sds.shape_index,
            curvedness: sds.curvedness,
            k1: sds.curvatures.map(|[u, _]| u),
            k2: sds.curvatures.map(|[_, u]| u),
        }
    }

    fn sds_at(&self, at: [f64; 2]) -> Option<PointSds> {
        // lengths are those of the input already; what is cut is what no direction and no S can exceed
        self.fit.point_sds(at).map(|sds| sds.scaled(1.0))
    }

    /// Support and uncertainty as they are saved.
    pub(super) fn pointwise(&self, shape: &ShapePart) -> (Option<SupportMap>, Option<UncertaintyMap>) {
        let domain = self.fit.domain();
        let support = self.support.as_ref().and_then(|outline| SupportMap::of(domain, |x, y| outline.holds(x, y)));
        let at = domain.map(|[lo, hi]| linspace(lo, hi, UNCERTAINTY_SIDE));
        let places = at[0].iter().flat_map(|x| at[1].iter().map(move |y| [*x, *y]));
        let sds: Vec<Option<PointSds>> = places.map(|place| self.sds_at(place)).collect();
        (support, uncertainty::map(at, &sds, shape))
    }

    /// Whether a contact was left out, by its number.
    pub(super) fn left_out(&self, contact: usize) -> bool {
        self.fit.report().outliers.binary_search(&contact).is_ok()
    }
}
