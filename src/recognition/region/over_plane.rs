//! The surface over an even grid of the input's x and y, where it stands nowhere steep over them.
//!
//! ```text
//! wanted (x, y):   p = nearest point of the surface to (x + dx, y + dy, z)
//!                  dx += x - p_x      dy += y - p_y      z = height of p's tangent plane over (x, y)
//! ```
//!
//! A fit that names its model takes its means over such a grid, and so does whoever reads `maps.csv`. A recognition does
//! the same wherever it can. Steeper patches keep the grid of their chart.

use crate::bspline::linspace;
use crate::recognition::departures::ChartPoint;
use crate::vector::Vector;

use super::surface::RecognisedSurface;

/// Least third component of the unit normals of a height field: they lean at most 75 degrees from the z axis.
const STEEP: f64 = 0.25;

/// Points of the chart each way at which the normals are looked at, and from which places are sought.
const LOOKED_AT: usize = 17;

/// Steps at most; two or three are usual.
const STEPS: usize = 20;

/// A point that misses its place by less than this share of the patch's size is there.
const THERE: f64 = 1e-10;

/// Whether the part of the surface that contacts support is nowhere steep over x and y.
pub(super) fn is_level(surface: &RecognisedSurface) -> bool {
    let [u, v] = [surface.u, surface.v].map(|[lo, hi]| linspace(lo, hi, LOOKED_AT));
    let up = |a: f64, b: f64| surface.at(a, b).1[2] >= STEEP;
    let (mut supported, mut all) = (None, true);
    for (a, b) in u.iter().flat_map(|a| v.iter().map(|b| (*a, *b))) {
        let level = up(a, b);
        all &= level;
        if surface.supported_at(a, b) {
            supported = Some(supported.unwrap_or(true) && level);
        }
    }
    supported.unwrap_or(all)
}

/// Smallest box of x and y around points of the input.
pub(super) fn bounds(points: impl Iterator<Item = Vector>) -> [[f64; 2]; 2] {
    points.fold([[f64::INFINITY, f64::NEG_INFINITY]; 2], |found, p| {
        [0, 1].map(|k| [found[k][0].min(p[k]), found[k][1].max(p[k])])
    })
}

/// Points of the surface over the even grid of a box, y running fastest, and whether the surface reaches each place. Where
/// it does not, the point is the last that was tried.
pub(super) fn product(surface: &RecognisedSurface, over: [[f64; 2]; 2], points: [usize; 2]) -> Vec<(ChartPoint, bool)> {
    let [x, y] = [0, 1].map(|k| linspace(over[k][0], over[k][1], points[k]));
    let places: Vec<[f64; 2]> = x.iter().flat_map(|x| y.iter().map(|y| [*x, *y])).collect();
    at_places(surface, &places)
}

/// Points of the surface over places of the input's x and y, and whether the surface reaches each.
pub(super) fn at_places(surface: &RecognisedSurface, places: &[[f64; 2]]) -> Vec<(ChartPoint, bool)> {
    if places.is_empty() {
        return Vec::new();
    }
    let known = lattice(surface);
    places.iter().map(|place| above(surface, *place, nearest(&known, *place))).collect()
}

/// Chart positions from edge to edge of what contacts cover, and their points.
fn lattice(surface: &RecognisedSurface) -> Vec<([f64; 2], Vector)> {
    let [u, v] = [surface.u, surface.v].map(|[lo, hi]| linspace(lo, hi, LOOKED_AT));
    let charts = u.iter().flat_map(|a| v.iter().map(|b| [*a, *b]));
    charts.map(|chart| (chart, surface.at(chart[0], chart[1]).0)).collect()
}

/// The known chart position whose point lies nearest over a place.
fn nearest(known: &[([f64; 2], Vector)], place: [f64; 2]) -> [f64; 2] {
    let away = |p: &Vector| (p[0] - place[0]).powi(2) + (p[1] - place[1]).powi(2);
    let least = known.iter().min_by(|a, b| away(&a.1).total_cmp(&away(&b.1)));
    least.map_or([0.0; 2], |(chart, _)| *chart)
}

/// The surface's point over a place, from a chart position near it, and whether the surface reaches so far.
fn above(surface: &RecognisedSurface, wanted: [f64; 2], mut chart: [f64; 2]) -> (ChartPoint, bool) {
    let mut asked: Option<[f64; 2]> = None;
    for _ in 0..STEPS {
        let (point, normal) = surface.at(chart[0], chart[1]);
        let missed = [wanted[0] - point[0], wanted[1] - point[1]];
        if missed[0].hypot(missed[1]) <= THERE * surface.frame.scale {
            return (surface.chart_point(chart[0], chart[1]), true);
        }
        // a tangent plane that stands upright leads nowhere, and neither does a point that is no number
        if normal[2].is_nan() || normal[2] <= 0.1 * STEEP {
            break;
        }
        let from = asked.unwrap_or([point[0], point[1]]);
        let next = [0, 1].map(|k| from[k] + missed[k]);
        asked = Some(next);
        let z = point[2] - (normal[0] * missed[0] + normal[1] * missed[1]) / normal[2];
        chart = surface.chart_of([next[0], next[1], z]);
    }
    (surface.chart_point(chart[0], chart[1]), false)
}
