//! What one surface shows over the region that contacts support: mean S and R, both at the points of the map, and its directions.
//!
//! ```text
//! mean S = (1/n) sum S(k1, k2 at point i)        R alike        S = 0 where it is undefined
//! ```

use crate::recognition::discrepancy::{ChartPoint, State, Together};
use crate::recognition::region::Place;
use palpate_geometry::curvature::shape_index;
use palpate_geometry::shape::spread;
use palpate_numeric::simd::EightShapes;
use palpate_numeric::vector::Vector;

/// Means over the region of one surface, and S and R at the points asked for.
pub(super) struct Field {
    pub(super) s: f64,
    pub(super) r: f64,
    pub(super) k: [f64; 2],
    pub(crate) at: Vec<[f64; 2]>,
    /// Directions of k1 and k2 in the middle, where they are defined and asked for.
    pub(super) directions: Option<[Vector; 2]>,
}

/// Points at which surfaces are evaluated.
pub(super) struct Points<'a> {
    /// Those that means are taken over.
    pub(crate) all: &'a [ChartPoint],
    /// Those whose own uncertainty is asked for.
    pub(super) map: &'a [ChartPoint],
    /// Numbers within the map of those that means are taken over, where they are a part of it.
    pub(super) within: Option<&'a [usize]>,
    /// Where the directions of k1 and k2 are asked for.
    pub(super) middle: Option<ChartPoint>,
    /// Where touches are predicted.
    pub(super) touched: &'a [Place],
}

/// Sums over the points of S, R, k1, k2 and of their number.
#[derive(Default)]
struct Sums([f64; 5]);

impl Sums {
    fn add(&mut self, [s, r]: [f64; 2], [k1, k2]: [f64; 2]) {
        self.0.iter_mut().zip([s, r, k1, k2, 1.0]).for_each(|(sum, v)| *sum += v);
    }

    fn field(self, at: Vec<[f64; 2]>, directions: Option<[Vector; 2]>) -> Field {
        let count = f64::max(self.0[4], 1.0);
        let [s, r, k1, k2, _] = self.0.map(|sum| sum / count);
        Field { s, r, k: [k1, k2], at, directions }
    }
}

impl Points<'_> {
    /// Surfaces at these points, displaced ones eight at a time.
    pub(super) fn fields(&self, states: &[State]) -> Vec<Field> {
        self.displaced_fields(states).unwrap_or_else(|| states.iter().map(|state| self.field(state)).collect())
    }

    /// `None` unless all surfaces are displaced.
    fn displaced_fields(&self, states: &[State]) -> Option<Vec<Field>> {
        let beyond = if self.within.is_some() { &[][..] } else { self.all };
        let together = Together::at(self.map.iter().chain(beyond))?;
        let mut out = Vec::with_capacity(states.len());
        together.look(states, |pack, found| {
            out.extend(pack.iter().enumerate().map(|(lane, state)| self.field_of_lane(found, lane, state)));
        })?;
        Some(out)
    }

    /// What one of eight surfaces shows at the points of the map and, where means are not taken over those, at the others.
    fn field_of_lane(&self, found: &[EightShapes], lane: usize, state: &State) -> Field {
        let (over_map, others) = found.split_at(self.map.len());
        let shape = |p: &EightShapes| [p.shape_index[lane], p.curvedness[lane]];
        let curvatures = |p: &EightShapes| [p.curvatures[0][lane], p.curvatures[1][lane]];
        let mut sums = Sums::default();
        let mut add = |p: &EightShapes| {
            if !curvatures(p)[0].is_nan() {
                sums.add(shape(p), curvatures(p));
            }
        };
        match self.within {
            Some(numbers) => numbers.iter().for_each(|&i| add(&over_map[i])),
            None => others.iter().for_each(add),
        }
        sums.field(over_map.iter().map(shape).collect(), self.directions(state))
    }

    /// A surface at these points.
    pub(super) fn field(&self, state: &State) -> Field {
        if let Some(k) = state.constant_curvatures() {
            let [s, r] = shape(k);
            return Field { s, r, k, at: vec![[s, r]; self.map.len()], directions: self.directions(state) };
        }
        let over_map: Vec<Option<[f64; 2]>> = self.map.iter().map(|p| state.curvatures(p)).collect();
        let at: Vec<[f64; 2]> = over_map.iter().map(|k| shape(k.unwrap_or([0.0; 2]))).collect();
        let mut sums = Sums::default();
        match self.within {
            Some(numbers) => {
                numbers.iter().filter_map(|&i| Some((at[i], over_map[i]?))).for_each(|(shape, k)| sums.add(shape, k));
            }
            None => self.all.iter().filter_map(|p| state.curvatures(p)).for_each(|k| sums.add(shape(k), k)),
        }
        sums.field(at, self.directions(state))
    }

    fn directions(&self, state: &State) -> Option<[Vector; 2]> {
        state.directions(self.middle.as_ref()?)
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
