//! The part of the surface that the answer is about: the map's points, and the lattice that means are taken over.
//!
//! ```text
//! map      nx x ny points from edge to edge of the box of the contacts' x and y, where the surface is nowhere steep over
//!          them; otherwise of the box of the contacts' chart positions; less the inset
//! lattice  at most 16 x 16 points over the same box, those that contacts support: means are taken over them
//! ```
//!
//! The map's outermost points lie on the edges of the box. Where the contacts do not fill their box, some of these
//! points are not supported. Of a map of up to 16 x 16 points the lattice is the supported part; of a finer one, whose
//! mean differs a little, the means are moved by what the reported surface shows of the difference.

use std::sync::Arc;

use crate::recognition::RecognitionOptions;
use crate::recognition::discrepancy::{ChartPoint, Displacement, State};
use crate::recognition::evidence::Evidence;
use crate::recognition::kinds::ConstantCurvature;
use crate::recognition::start::Patch;
use palpate_numeric::bspline::linspace;
use palpate_numeric::vector::Vector;

use super::projected_grid::{LookedAt, bounds};
use super::support::Support;
use super::surface::PatchSurface;

/// Points of the lattice each way at most: means over a finer map hardly differ, and every draw is taken at all of
/// them.
const LATTICE: usize = 16;

/// A narrow strip that runs aslant leaves few points of a grid over x and y. With fewer than this the chart's grid, where
/// it has more, says more of the patch.
const FEWEST_POINTS: usize = 8;

/// The reported surface with its points.
pub(crate) struct Region {
    pub(crate) surface: PatchSurface,
    pub(crate) map: Vec<ChartPoint>,
    /// Whether contacts support a point of the map.
    pub(crate) supported: Vec<bool>,
    pub(crate) lattice: Vec<ChartPoint>,
    /// Numbers of the lattice's points within the map, where they are a part of it.
    pub(crate) within_map: Option<Vec<usize>>,
    /// The box of the input's x and y over which the map is even; `None` where it is even over the chart.
    pub(crate) over: Option<[[f64; 2]; 2]>,
}

impl Region {
    pub(crate) fn new(
        patch: &Patch,
        evidence: &Evidence,
        base: &ConstantCurvature,
        state: State,
        places: Option<&[Vector]>,
        options: &RecognitionOptions,
    ) -> Region {
        let charts: Vec<[f64; 2]> = patch.points.iter().map(|p| base.chart(*p)).collect();
        let support = Support::new(&patch.feet, &charts, evidence.cells, &options.tuning);
        let [u, v] = [support.range(0), support.range(1)];
        let displacement: Option<Displacement> = evidence.displacement.cloned();
        let support = Arc::new(support.into_owned());
        let surface = PatchSurface {
            frame: patch.frame,
            u,
            v,
            base: base.clone(),
            displacement,
            state,
            support: support.clone(),
        };
        let looked_at = LookedAt::new(&surface);
        let within = [u, v].map(|range| less(range, options.inset));
        let box_of =
            || bounds(patch.points.iter().map(|p| patch.frame.to_input(*p))).map(|side| less(side, options.inset));
        let mut over = looked_at.is_level(&surface).then(box_of);
        let even = |over: Option<[[f64; 2]; 2]>, points| match over {
            Some(over) => over_box(&surface, &looked_at, over, points),
            None => over_chart(&surface, within, points),
        };
        let (mut map, mut supported) = even(over, options.grid);
        if over.is_some() && count(&supported) < FEWEST_POINTS {
            let (of_chart, there) = even(None, options.grid);
            if count(&there) > count(&supported) {
                (over, map, supported) = (None, of_chart, there);
            }
        }
        if !supported.contains(&true) {
            // a map so coarse that none of its points lies inside is shown as it is
            supported.fill(true);
        }
        if let Some(places) = places {
            let at = |place: &Vector| base.chart(patch.frame.to_patch(*place));
            let lattice = places.iter().map(at).map(|[u, v]| surface.chart_point(u, v)).collect();
            return Region { surface, map, supported, lattice, within_map: None, over };
        }
        let held = |supported: &[bool]| (0..supported.len()).filter(|&i| supported[i]).collect::<Vec<usize>>();
        let points = options.grid.map(|n| n.min(LATTICE));
        if points == options.grid {
            let numbers = held(&supported);
            let lattice = numbers.iter().map(|&i| map[i].clone()).collect();
            return Region { surface, map, supported, lattice, within_map: Some(numbers), over };
        }
        let (all, coarse) = even(over, points);
        let numbers = held(&coarse);
        let numbers = if numbers.is_empty() { (0..all.len()).collect() } else { numbers };
        let lattice = numbers.iter().map(|&i| all[i].clone()).collect();
        Region { surface, map, supported, lattice, within_map: None, over }
    }
}

fn count(supported: &[bool]) -> usize {
    supported.iter().filter(|s| **s).count()
}

/// A range less the fraction `inset` of it at each end.
fn less([lo, hi]: [f64; 2], inset: f64) -> [f64; 2] {
    let cut = inset * (hi - lo);
    [lo + cut, hi - cut]
}

/// Points of the even grid of a box of the input's x and y, y running fastest, and whether contacts support each.
fn over_box(
    surface: &PatchSurface,
    looked_at: &LookedAt,
    over: [[f64; 2]; 2],
    points: [usize; 2],
) -> (Vec<ChartPoint>, Vec<bool>) {
    let found = looked_at.product(surface, over, points);
    let supported = found.iter().map(|(p, reached)| *reached && surface.holds(p)).collect();
    (found.into_iter().map(|(p, _)| p).collect(), supported)
}

/// The same of an even grid of the chart.
fn over_chart(surface: &PatchSurface, [u, v]: [[f64; 2]; 2], points: [usize; 2]) -> (Vec<ChartPoint>, Vec<bool>) {
    let found = product(surface, &linspace(u[0], u[1], points[0]), &linspace(v[0], v[1], points[1]));
    let supported = found.iter().map(|p| surface.holds(p)).collect();
    (found, supported)
}

/// Chart points of the product of two axes, the second running fastest.
fn product(surface: &PatchSurface, u: &[f64], v: &[f64]) -> Vec<ChartPoint> {
    u.iter().flat_map(|&a| v.iter().map(move |&b| (a, b))).map(|(a, b)| surface.chart_point(a, b)).collect()
}
