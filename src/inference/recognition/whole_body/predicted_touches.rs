//! What touches would measure if each of the drawn bodies were the true one.
//!
//! ```text
//! touch at P with normal n, tangents t1, t2, on the reported body        measured of draw d:  ((P_d - P).n, n_d.t1, n_d.t2)
//! P over given x and y: the point of the body under or over the contact next to them
//! ```

use crate::bodies::BodyChart;
use crate::recognition::{PredictiveDraw, Recognition};
use palpate_numeric::vector::Vector;

/// Draws that touches are predicted on: as many as of a patch.
const PREDICTED: usize = 128;

/// Of touches over these places of the input's x and y. A place that the body does not reach tells nothing: there all draws agree.
pub(super) fn predicted_over(
    chart: &BodyChart,
    shapes: &[Option<[f64; 2]>],
    touches: &[[f64; 2]],
    contacts: &[Vector],
) -> Vec<PredictiveDraw> {
    let above = |place: &[f64; 2]| {
        let apart = |p: &Vector| (p[0] - place[0]).hypot(p[1] - place[1]);
        let next = contacts.iter().min_by(|a, b| apart(a).total_cmp(&apart(b)))?;
        chart.point_over(*place, next[2])
    };
    predicted(chart, shapes, &touches.iter().map(above).collect::<Vec<Option<Vector>>>())
}

fn predicted(chart: &BodyChart, shapes: &[Option<[f64; 2]>], places: &[Option<Vector>]) -> Vec<PredictiveDraw> {
    if places.is_empty() {
        return Vec::new();
    }
    let step = chart.draws.len().div_ceil(PREDICTED).max(1);
    let kept: Vec<usize> = (0..chart.draws.len()).step_by(step).filter(|&d| shapes[d].is_some()).collect();
    let all: f64 = kept.iter().map(|&d| chart.draws[d].share).sum();
    let measured: Vec<Option<Vec<[f64; 3]>>> =
        places.iter().map(|place| Some(chart.measured_at((*place)?, &kept))).collect();
    let one = |(k, &d): (usize, &usize)| {
        let [s, r] = shapes[d]?;
        let touches = measured.iter().map(|at| at.as_ref().map_or([0.0; 3], |of| of[k])).collect();
        Some(PredictiveDraw { share: chart.draws[d].share / all, shape: [s, r / chart.frame.scale], touches })
    };
    kept.iter().enumerate().filter_map(one).collect()
}

impl Recognition {
    /// What touches at the points of its map would measure, if it is a body; empty for a patch, which is asked about places of the
    /// input's x and y by [`Recognition::with_predictions`].
    pub fn predicted_over_map(&self) -> Vec<PredictiveDraw> {
        let Some(chart) = self.surface.body() else { return Vec::new() };
        let mut sums = vec![[0.0; 2]; chart.draws.len()];
        let supported: Vec<Vector> = self.map.iter().filter(|p| p.supported).map(|p| p.position).collect();
        for place in &supported {
            let readings = chart.readings_at(*place);
            sums.iter_mut().zip(&readings).for_each(|(sum, [_, _, s, r, ..])| *sum = [sum[0] + s, sum[1] + r]);
        }
        let mean =
            |sum: [f64; 2]| Some(sum.map(|v| v / supported.len() as f64)).filter(|m| m.iter().all(|v| v.is_finite()));
        let shapes: Vec<Option<[f64; 2]>> = sums.into_iter().map(mean).collect();
        predicted(chart, &shapes, &self.map.iter().map(|p| Some(p.position)).collect::<Vec<Option<Vector>>>())
    }
}

#[cfg(test)]
mod tests {
    use crate::recognition::{PredictiveDraw, Recognition, RecognitionOptions};
    use palpate_geometry::contact::Contacts;
    use palpate_numeric::draws::EffectDraws;
    use palpate_numeric::vector::Vector;

    /// A bar of radius 10 along y, touched at 40 places of its upper side, to 80 degrees from the top, with errors of 0.05.
    fn bar(seed: u64) -> Contacts {
        let draws = EffectDraws::new(seed, "predicted");
        let point = |k: u64| {
            let mut error = [0.0; 3];
            draws.gaussians(k, 0, 3, &mut error);
            let (angle, y) = (0.35 * (k % 9) as f64 - 1.4, (k / 9) as f64 * 4.0 - 8.0);
            let place = [10.0 * angle.sin(), y, 10.0 * angle.cos()];
            [0, 1, 2].map(|k| place[k] + 0.05 * error[k])
        };
        Contacts::from_points(&(0..45).map(point).collect::<Vec<Vector>>())
    }

    fn sd(draws: &[PredictiveDraw], k: usize, number: usize) -> f64 {
        let mean: f64 = draws.iter().map(|d| d.share * d.touches[k][number]).sum();
        draws.iter().map(|d| d.share * (d.touches[k][number] - mean).powi(2)).sum::<f64>().sqrt()
    }

    #[test]
    fn touches_over_a_body_are_predicted_and_beyond_its_edge_nothing() {
        let options = RecognitionOptions::default().with_up([0.0, 0.0, 1.0]);
        let places = [[0.0, 0.0], [6.0, 3.0], [0.0, 30.0], [40.0, 0.0]];
        let found = Recognition::with_predictions(&bar(9), &options, &places).unwrap();
        assert!(found.surface.body().is_some());
        let draws = &found.predictive;
        assert!(draws.len() >= 64 && (draws.iter().map(|d| d.share).sum::<f64>() - 1.0).abs() < 1e-12);
        let heights: Vec<f64> = (0..places.len()).map(|k| sd(draws, k, 0)).collect();
        // far along the bar less is known, and beside it there is none
        assert!(
            heights[0] > 0.0 && heights[0] < 0.05 && heights[2] > 2.0 * heights[0] && heights[3] == 0.0,
            "{heights:?}"
        );
    }

    /// The draws of one body scatter by a tenth otherwise than all of them would, and alike over the map: bodies are averaged.
    #[test]
    fn over_the_map_the_predictions_scatter_as_its_uncertainties_say() {
        let of_body = |seed: u64| {
            let options = RecognitionOptions::default().with_up([0.0, 0.0, 1.0]);
            let found = Recognition::of(&bar(seed), &options).unwrap();
            let (draws, body) = (found.predicted_over_map(), found.surface.body().unwrap());
            let supported = found.map.iter().enumerate().filter(|(_, p)| p.supported);
            let ratios: Vec<f64> =
                supported.map(|(k, point)| sd(&draws, k, 0) / body.sds_at(point.position)[0]).collect();
            assert!(ratios.iter().all(|ratio| (0.5..2.0).contains(ratio)), "{seed}: {ratios:?}");
            ratios.iter().map(|ratio| ratio * ratio).sum::<f64>() / ratios.len() as f64
        };
        const BODIES: u64 = 12;
        let mean = (0..BODIES).map(of_body).sum::<f64>() / BODIES as f64;
        assert!((0.85..1.15).contains(&mean), "{mean}");
    }
}
