//! What one surface shows over the region that contacts support: mean S and R, both at the points of the map, and its directions.
//!
//! ```text
//! mean S = (1/n) sum S(k1, k2 at point i)        R alike        S = 0 where it is undefined
//! ```

use crate::curvature::shape_index;
use crate::recognition::departures::{ChartPoint, State};
use crate::recognition::region::Place;
use crate::shape::spread;
use crate::vector::{Vector, cross};

/// Means over the region of one surface, and S and R at the points asked for.
pub(super) struct Field {
    pub(super) s: f64,
    pub(super) r: f64,
    pub(super) k: [f64; 2],
    pub(in crate::recognition) at: Vec<[f64; 2]>,
    /// Directions of k1 and k2 in the middle, where they are defined and asked for.
    pub(super) directions: Option<[Vector; 2]>,
}

/// Points at which surfaces are evaluated.
pub(super) struct Points<'a> {
    /// Those that means are taken over.
    pub(in crate::recognition) all: &'a [ChartPoint],
    /// Those whose own uncertainty is asked for.
    pub(super) map: &'a [ChartPoint],
    /// Numbers within the map of those that means are taken over, where they are a part of it.
    pub(super) within: Option<&'a [usize]>,
    /// Where the directions of k1 and k2 are asked for.
    pub(super) middle: Option<ChartPoint>,
    /// Where touches are predicted.
    pub(super) touched: &'a [Place],
}

impl Points<'_> {
    /// A surface at these points.
    pub(super) fn field(&self, state: &State) -> Field {
        if let Some(k) = state.constant_curvatures() {
            let [s, r] = shape(k);
            return Field { s, r, k, at: vec![[s, r]; self.map.len()], directions: self.directions(state) };
        }
        let over_map: Vec<Option<[f64; 2]>> = self.map.iter().map(|p| state.curvatures(p)).collect();
        let at: Vec<[f64; 2]> = over_map.iter().map(|k| shape(k.unwrap_or([0.0; 2]))).collect();
        let mut sums = [0.0; 5];
        let mut add = |[s, r]: [f64; 2], k: [f64; 2]| {
            sums.iter_mut().zip([s, r, k[0], k[1], 1.0]).for_each(|(sum, v)| *sum += v);
        };
        match self.within {
            Some(numbers) => numbers.iter().filter_map(|&i| Some((at[i], over_map[i]?))).for_each(|(s, k)| add(s, k)),
            None => self.all.iter().filter_map(|p| state.curvatures(p)).for_each(|k| add(shape(k), k)),
        }
        let count = f64::max(sums[4], 1.0);
        let [s, r, k1, k2, _] = sums.map(|sum| sum / count);
        Field { s, r, k: [k1, k2], at, directions: self.directions(state) }
    }

    fn directions(&self, state: &State) -> Option<[Vector; 2]> {
        let bent = state.at(self.middle.as_ref()?);
        let k1 = bent.direction?;
        Some([k1, cross(bent.normal, k1)])
    }

    /// Standard deviations of S and of R over the region.
    pub(super) fn variation(&self, state: &State) -> [f64; 2] {
        let shapes: Vec<[f64; 2]> = self.all.iter().filter_map(|p| state.curvatures(p)).map(shape).collect();
        [0, 1].map(|k| spread(shapes.iter().map(|v| v[k])).sd.unwrap_or(0.0))
    }
}

/// S, 0 where it is undefined, and R of two curvatures.
fn shape([k1, k2]: [f64; 2]) -> [f64; 2] {
    [shape_index(k1 + k2, k1 - k2).unwrap_or(0.0), (0.5 * (k1 * k1 + k2 * k2)).sqrt()]
}
