//! What touches would measure if each of the drawn surfaces were the true one: the posterior, asked about contacts not made yet.
//!
//! ```text
//! touch at (x, y), reported surface P, n, t1, t2 there      measured of draw d:  ((P_d - P).n, n_d.t1, n_d.t2)
//! ```
//!
//! Draws of all kinds of surface stand side by side, so that a touch is known to tell also which kind it is (the posterior
//! predictive distribution of A. Gelman et al., *Bayesian Data Analysis*, 1.3).

use crate::recognition::discrepancy::{ChartPoint, State};
use palpate_numeric::vector::{Vector, cross, dot, minus, unit};

use super::projected_grid::LookedAt;
use super::surface::PatchSurface;

/// Draws of a node at least.
const FEWEST_DRAWS: usize = 2;

/// A place that may be touched, with the axes along which a touch there is measured.
pub(crate) struct Place {
    point: ChartPoint,
    foot: Vector,
    normal: Vector,
    tangents: [Vector; 2],
}

/// One drawn surface.
#[derive(Clone, Debug)]
pub struct PredictiveDraw {
    /// Its share of all draws; they sum to 1.
    pub share: f64,
    /// Mean shape index and mean curvedness, the latter in 1/length of the input.
    pub shape: [f64; 2],
    /// What a touch would measure at every place: a height over the reported surface in input units, and two slopes.
    pub touches: Vec<[f64; 3]>,
}

impl Place {
    /// Where this surface lies at a chart point.
    pub(crate) fn on(state: &State, point: ChartPoint) -> Place {
        let (foot, normal) = state.place_and_normal(&point);
        let across = if normal[0].abs() < 0.7 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
        let first = unit(cross(normal, across));
        Place { point, foot, normal, tangents: [first, cross(normal, first)] }
    }

    /// The axes along which a touch there is measured.
    pub(crate) fn tangents(&self) -> [Vector; 2] {
        self.tangents
    }
}

impl PredictiveDraw {
    /// From the patch's unit of length to the input's.
    pub(crate) fn scaled(self, scale: f64) -> PredictiveDraw {
        let touches = self.touches.into_iter().map(|[height, first, second]| [height * scale, first, second]).collect();
        PredictiveDraw { shape: [self.shape[0], self.shape[1] / scale], touches, ..self }
    }
}

/// How many of a node's draws touches are predicted on, of which they are this share.
pub(crate) fn predicted(draws: usize, share: f64) -> usize {
    ((share * draws as f64).ceil() as usize).max(FEWEST_DRAWS).min(draws)
}

/// The reported surface at places of the input's x and y.
pub(crate) fn places(surface: &PatchSurface, asked: &[[f64; 2]]) -> Vec<Place> {
    if asked.is_empty() {
        return Vec::new();
    }
    LookedAt::new(surface)
        .at_places(surface, asked)
        .into_iter()
        .map(|(point, _)| Place::on(&surface.state, point))
        .collect()
}

/// What touches at these places would measure on a surface, in the patch's unit of length.
pub(crate) fn measured(state: &State, places: &[Place]) -> Vec<[f64; 3]> {
    let one = |place: &Place| {
        let (there, normal) = state.place_and_normal(&place.point);
        let [first, second] = place.tangents.map(|tangent| dot(normal, tangent));
        [dot(minus(there, place.foot), place.normal), first, second]
    };
    places.iter().map(one).collect()
}

#[cfg(test)]
mod tests {
    use crate::recognition::{Recognition, RecognitionOptions};
    use palpate_geometry::contact::Contacts;
    use palpate_numeric::draws::EffectDraws;
    use palpate_numeric::vector::Vector;

    fn ball(x: f64, y: f64) -> f64 {
        (100.0 - x * x - y * y).sqrt() - 10.0
    }

    /// A ball of radius 10, touched at 6 x 6 places.
    fn contacts() -> Contacts {
        let draws = EffectDraws::new(5, "predictive");
        let at = |i: u64| 1.6 * i as f64 - 4.0;
        let point = |k: u64| {
            let mut error = [0.0];
            draws.gaussians(k, 0, 1, &mut error);
            let (x, y) = (at(k % 6), at(k / 6));
            [x, y, ball(x, y) + 0.02 * error[0]]
        };
        Contacts::from_points(&(0..36).map(point).collect::<Vec<Vector>>())
    }

    #[test]
    fn touches_are_predicted_about_where_they_come_out_and_nothing_else_changes() {
        let places = [[0.3, -0.4], [3.9, 3.9], [-2.0, 3.0]];
        let found = Recognition::with_predictions(&contacts(), &RecognitionOptions::default(), &places).unwrap();
        let plain = Recognition::of(&contacts(), &RecognitionOptions::default()).unwrap();
        assert!(plain.predictive.is_empty());
        assert_eq!(
            (plain.shape_index, plain.curvedness, plain.map),
            (found.shape_index, found.curvedness, found.map.clone())
        );
        let draws = &found.predictive;
        assert!((draws.iter().map(|d| d.share).sum::<f64>() - 1.0).abs() < 1e-12);
        let sd = |place: usize| {
            let mean: f64 = draws.iter().map(|d| d.share * d.touches[place][0]).sum();
            let variance: f64 = draws.iter().map(|d| d.share * (d.touches[place][0] - mean).powi(2)).sum();
            (mean, variance.sqrt())
        };
        for (k, [x, y]) in places.into_iter().enumerate() {
            // over the reported surface, along its normal
            let [u, v] = found.chart_of([x, y, ball(x, y)]);
            let (foot, normal) = found.at(u, v);
            let truth = (0..3).map(|i| ([x, y, ball(x, y)][i] - foot[i]) * normal[i]).sum::<f64>();
            let (mean, sd) = sd(k);
            assert!((truth - mean).abs() < 4.0 * sd, "{k}: {truth} for {mean} +- {sd}");
        }
        assert!(sd(1).1 > 1.2 * sd(0).1, "the corner is less certain than the middle: {:?} {:?}", sd(1), sd(0));
    }
}
