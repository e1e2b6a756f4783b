//! The surface over an even grid of the input's x and y, where it stands nowhere steep over them.
//!
//! ```text
//! wanted (x, y):   chart of p += chart of q - chart of p      q: place over (x, y) in the surface's tangent plane at p
//! ```
//!
//! Where the chart is that of p's base these are Newton's steps, on however steep a slope.
//!
//! A fit that names its model takes its means over such a grid, and so does whoever reads `maps.csv`. A recognition does
//! the same wherever it can. Steeper patches keep the grid of their chart.

use crate::recognition::discrepancy::ChartPoint;
use palpate_numeric::bspline::linspace;
use palpate_numeric::threads;
use palpate_numeric::vector::Vector;

use super::surface::PatchSurface;

/// Least third component of the unit normals of a height field: they lean at most 75 degrees from the z axis.
const STEEP: f64 = 0.25;

/// Points of the chart each way at which the normals are looked at, and from which places are sought.
const LOOKED_AT: usize = 17;

/// Places of one task of a thread: each takes about a microsecond.
const PLACES: usize = 256;

/// Steps at most; two or three are usual.
const STEPS: usize = 20;

/// A point that misses its place by less than this share of the patch's size is there.
const THERE: f64 = 1e-10;

/// The surface at an even lattice of chart positions, from edge to edge of what contacts cover.
pub(super) struct LookedAt {
    points: Vec<ChartPoint>,
    /// Places and unit normals, in the input's coordinates.
    seen: Vec<(Vector, Vector)>,
    /// x and y of the places.
    over: Vec<[f64; 2]>,
}

impl LookedAt {
    pub(super) fn new(surface: &PatchSurface) -> LookedAt {
        let [u, v] = [surface.u, surface.v].map(|[lo, hi]| linspace(lo, hi, LOOKED_AT));
        let at = |a: &f64| v.iter().map(|b| surface.chart_point(*a, *b)).collect::<Vec<_>>();
        let points: Vec<ChartPoint> = u.iter().flat_map(at).collect();
        let seen: Vec<(Vector, Vector)> = points.iter().map(|point| surface.place_and_normal(point)).collect();
        let over = seen.iter().map(|([x, y, _], _)| [*x, *y]).collect();
        LookedAt { points, seen, over }
    }

    /// Whether the part of the surface that contacts support is nowhere steep over x and y.
    pub(super) fn is_level(&self, surface: &PatchSurface) -> bool {
        let (mut supported, mut all) = (None, true);
        for (point, (_, normal)) in self.points.iter().zip(&self.seen) {
            let level = normal[2] >= STEEP;
            all &= level;
            if surface.holds(point) {
                supported = Some(supported.unwrap_or(true) && level);
            }
        }
        supported.unwrap_or(all)
    }

    /// The chart position whose point lies nearest over a place.
    fn nearest(&self, place: [f64; 2]) -> [f64; 2] {
        // of equally near ones the first, and none that is no number; asked at every point of a map
        let (mut least, mut nearest) = (f64::INFINITY, None);
        for (k, [x, y]) in self.over.iter().enumerate() {
            let away = (x - place[0]) * (x - place[0]) + (y - place[1]) * (y - place[1]);
            if away < least {
                (least, nearest) = (away, Some(k));
            }
        }
        nearest.map_or([0.0; 2], |k| self.points[k].chart)
    }

    /// Points of the surface over places of the input's x and y, and whether the surface reaches each.
    pub(super) fn at_places(&self, surface: &PatchSurface, places: &[[f64; 2]]) -> Vec<(ChartPoint, bool)> {
        threads::map(places.len(), PLACES, |k| above(surface, places[k], self.nearest(places[k])))
    }

    /// Points of the surface over the even grid of a box, y running fastest, and whether the surface reaches each place. Where
    /// it does not, the point is the last that was tried.
    pub(super) fn product(
        &self,
        surface: &PatchSurface,
        over: [[f64; 2]; 2],
        points: [usize; 2],
    ) -> Vec<(ChartPoint, bool)> {
        let [x, y] = [0, 1].map(|k| linspace(over[k][0], over[k][1], points[k]));
        let places: Vec<[f64; 2]> = x.iter().flat_map(|x| y.iter().map(|y| [*x, *y])).collect();
        self.at_places(surface, &places)
    }
}

/// Smallest box of x and y around points of the input.
pub(super) fn bounds(points: impl Iterator<Item = Vector>) -> [[f64; 2]; 2] {
    points.fold([[f64::INFINITY, f64::NEG_INFINITY]; 2], |found, p| {
        [0, 1].map(|k| [found[k][0].min(p[k]), found[k][1].max(p[k])])
    })
}

/// The surface's point over a place, from a chart position near it, and whether the surface reaches so far.
fn above(surface: &PatchSurface, wanted: [f64; 2], mut chart: [f64; 2]) -> (ChartPoint, bool) {
    for _ in 0..STEPS {
        let here = surface.chart_point(chart[0], chart[1]);
        let (point, normal) = surface.place_and_normal(&here);
        let missed = [wanted[0] - point[0], wanted[1] - point[1]];
        if missed[0].hypot(missed[1]) <= THERE * surface.frame.scale {
            return (here, true);
        }
        // a tangent plane that stands upright leads nowhere, and neither does a point that is no number
        if normal[2].is_nan() || normal[2] <= 0.1 * STEEP {
            break;
        }
        let z = point[2] - (normal[0] * missed[0] + normal[1] * missed[1]) / normal[2];
        let [from, to] = [point, [wanted[0], wanted[1], z]].map(|place| surface.chart_of(place));
        chart = [0, 1].map(|k| chart[k] + to[k] - from[k]);
    }
    (surface.chart_point(chart[0], chart[1]), false)
}
