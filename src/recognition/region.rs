//! The part of the chart that the answer is about: the map's points, and the lattice that means are taken over.
//!
//! ```text
//! map      nu x nv points from edge to edge of the box of the contacts' chart positions
//! lattice  at most 16 x 16 points over the same box, those that contacts support: means are taken over them
//! ```
//!
//! The map's outermost points lie on the edges of the box. Where the contacts do not fill their box, some of these
//! points are not supported. Of a map of up to 16 x 16 points, the lattice is the supported part.

use std::sync::Arc;

use crate::bspline::linspace;
use crate::vector::Vector;

use super::RecognitionOptions;
use super::constant_curvature::ConstantCurvature;
use super::displacement::Displacement;
use super::evidence::Evidence;
use super::patch::Patch;
use super::state::{ChartPoint, State};
use super::support::Support;
use super::surface::RecognisedSurface;

/// Points of the lattice each way at most: means over a finer map hardly differ, and every draw is taken at all of
/// them.
const LATTICE: usize = 16;

/// The reported surface with its points.
pub(super) struct Region {
    pub(super) surface: RecognisedSurface,
    pub(super) map: Vec<ChartPoint>,
    /// Whether contacts support a point of the map.
    pub(super) supported: Vec<bool>,
    pub(super) lattice: Vec<ChartPoint>,
    /// Numbers of the lattice's points within the map, where they are a part of it.
    pub(super) within_map: Option<Vec<usize>>,
}

impl Region {
    pub(super) fn new(
        patch: &Patch,
        evidence: &Evidence,
        base: &ConstantCurvature,
        state: State,
        places: Option<&[Vector]>,
        options: &RecognitionOptions,
    ) -> Region {
        let charts: Vec<[f64; 2]> = patch.points.iter().map(|p| base.chart(*p)).collect();
        let support = Support::new(&patch.points, &charts, evidence.cells);
        let [u, v] = [support.range(0), support.range(1)];
        let displacement: Option<Displacement> = evidence.displacement.cloned();
        let support = Arc::new(support.into_owned());
        let surface = RecognisedSurface {
            frame: patch.frame,
            u,
            v,
            base: base.clone(),
            displacement,
            state,
            support: support.clone(),
        };
        let holds = |p: &ChartPoint| support.holds(p.chart, p.place);
        let [along_u, along_v] = [linspace(u[0], u[1], options.grid[0]), linspace(v[0], v[1], options.grid[1])];
        let map = product(&surface, &along_u, &along_v);
        let mut supported: Vec<bool> = map.iter().map(holds).collect();
        if !supported.contains(&true) {
            // a map so coarse that none of its points lies inside is shown as it is
            supported.fill(true);
        }
        if let Some(places) = places {
            let at = |place: &Vector| base.chart(patch.frame.to_patch(*place));
            let lattice = places.iter().map(at).map(|[u, v]| surface.chart_point(u, v)).collect();
            return Region { surface, map, supported, lattice, within_map: None };
        }
        let [n, m] = options.grid.map(|n| n.min(LATTICE));
        let all = product(&surface, &linspace(u[0], u[1], n), &linspace(v[0], v[1], m));
        let held: Vec<usize> = (0..all.len()).filter(|&i| holds(&all[i])).collect();
        let numbers = if held.is_empty() { (0..all.len()).collect() } else { held };
        let lattice = numbers.iter().map(|&i| all[i].clone()).collect();
        let within_map = (options.grid == [n, m]).then_some(numbers);
        Region { surface, map, supported, lattice, within_map }
    }
}

/// Chart points of the product of two axes, the second running fastest.
fn product(surface: &RecognisedSurface, u: &[f64], v: &[f64]) -> Vec<ChartPoint> {
    u.iter().flat_map(|&a| v.iter().map(move |&b| (a, b))).map(|(a, b)| surface.chart_point(a, b)).collect()
}
