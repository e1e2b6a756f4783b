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
use crate::vector::Vector;

use super::state::ChartPoint;
use super::surface::RecognisedSurface;

/// Least third component of the unit normals of a height field: they lean at most 75 degrees from the z axis.
const STEEP: f64 = 0.25;

/// Points of the chart each way at which the normals are looked at.
const LOOKED_AT: usize = 17;

/// Steps at most; two or three are usual.
const STEPS: usize = 20;

/// A point that misses its place by less than this share of the patch's size is there.
const THERE: f64 = 1e-10;

/// Whether the part of the surface that contacts support is nowhere steep over x and y.
pub(super) fn is_level(surface: &RecognisedSurface) -> bool {
    let [u, v] = [surface.u, surface.v].map(|[lo, hi]| linspace(lo, hi, LOOKED_AT));
    let places = u.iter().flat_map(|a| v.iter().map(|b| (*a, *b)));
    let up = |(a, b): (f64, f64)| surface.at(a, b).1[2] >= STEEP;
    let (mut supported, mut all) = (None, true);
    for (a, b) in places {
        let level = up((a, b));
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
    let mut z = surface.frame.origin[2];
    let mut found = Vec::with_capacity(x.len() * y.len());
    for x in &x {
        for y in &y {
            let (point, height) = above(surface, [*x, *y], z);
            // the next place is near, and its height with it
            z = height.unwrap_or(surface.frame.origin[2]);
            found.push((point, height.is_some()));
        }
    }
    found
}

/// The surface's point over a place, and its height; no height where the surface does not reach so far.
fn above(surface: &RecognisedSurface, wanted: [f64; 2], mut z: f64) -> (ChartPoint, Option<f64>) {
    let mut asked = wanted;
    let mut chart = surface.chart_of([asked[0], asked[1], z]);
    for _ in 0..STEPS {
        let (point, normal) = surface.at(chart[0], chart[1]);
        let missed = [wanted[0] - point[0], wanted[1] - point[1]];
        if missed[0].hypot(missed[1]) <= THERE * surface.frame.scale {
            return (surface.chart_point(chart[0], chart[1]), Some(point[2]));
        }
        // a tangent plane that stands upright leads nowhere, and so does a point that is no number
        if !(normal[2] > 0.1 * STEEP) {
            break;
        }
        asked = [0, 1].map(|k| asked[k] + missed[k]);
        z = point[2] - (normal[0] * missed[0] + normal[1] * missed[1]) / normal[2];
        chart = surface.chart_of([asked[0], asked[1], z]);
    }
    (surface.chart_point(chart[0], chart[1]), None)
}
