//! Which candidates to touch next by the recognition's own posterior: surfaces of all kinds that the contacts leave possible.
//!
//! ```text
//! draws d with shares w_d          x_d = sqrt(w_d) (quantity of d - its mean)         quantities: S, R, three for each touch
//! touch a, divided by its noise    fall of Var q = b' M^-1 b      b = x_a x_q'      M = 1 + x_a x_a'
//! greedy                           take the largest fall of Var S / unit_S^2 + Var R / unit_R^2
//!                                  x <- x - (x a') a / (v + sqrt(v)),   v = 1 + a a',  for each of its three rows in turn
//! ```
//!
//! A spline has a covariance, too, but a spline's doubts are not those of the answer: what the recognition does not know is often
//! whether a ball is a ring, and that is told by other places than those that hold a spline still.
//! The update is J. E. Potter's square root of a Kalman filter's (J. L. Anderson 2001 for ensembles).

use palpate_inference::recognition::{PredictiveDraw, Recognition};
use palpate_numeric::linalg::dot;

use super::covariance::finished;
use super::model::touch_sds;
use super::planner::inverse;

/// The point of a body's map whose touch lets the uncertainties of S and R fall most; `None` of a patch, and where nothing is in doubt.
pub fn best_of_map(found: &Recognition) -> Option<usize> {
    let planner = PredictivePlanner::of(&found.predicted_over_map(), found, None)?;
    let falls = (0..found.map.len()).map(|k| (k, planner.fall(k))).filter(|(_, fall)| *fall > 0.0);
    falls.reduce(|a, b| if b.1 > a.1 { b } else { a }).map(|(best, _)| best)
}

/// The posterior's draws as rows of numbers.
#[derive(Clone, Debug)]
pub(super) struct PredictivePlanner {
    /// Draws.
    width: usize,
    /// Rows of S and of R.
    followed: [Vec<f64>; 2],
    /// Three rows for each touch.
    touches: Vec<f64>,
    /// 1/unit^2 of S and of R.
    units: [f64; 2],
}

impl PredictivePlanner {
    /// Of a recognition that predicted the touches; `units` are those of S and R, or their own uncertainties.
    pub(super) fn new(found: &Recognition, units: Option<[f64; 2]>) -> Option<PredictivePlanner> {
        PredictivePlanner::of(&found.predictive, found, units)
    }

    fn of(draws: &[PredictiveDraw], found: &Recognition, units: Option<[f64; 2]>) -> Option<PredictivePlanner> {
        let places = draws.first()?.touches.len();
        let [height, normal_deg] = touch_sds(found);
        let sd = [height, normal_deg.to_radians(), normal_deg.to_radians()];
        let followed = [0, 1].map(|q| row(draws, |d| d.shape[q], 1.0));
        let touches = (0..places).flat_map(|k| (0..3).map(move |m| (k, m)));
        let touches = touches.flat_map(|(k, m)| row(draws, |d| d.touches[k][m], sd[m])).collect();
        let own = [0, 1].map(|q| dot(&followed[q], &followed[q]).sqrt());
        let units = units.unwrap_or(own).map(|unit| inverse(unit * unit));
        Some(PredictivePlanner { width: draws.len(), followed, touches, units })
    }

    /// At most `n` of these candidates, the best first; each at most once.
    pub(super) fn choose(&mut self, left: &[usize], n: usize) -> Vec<usize> {
        let mut chosen: Vec<usize> = Vec::new();
        while chosen.len() < n {
            let free = left.iter().copied().filter(|k| !chosen.contains(k));
            let scored = free.map(|k| (k, self.fall(k)));
            let best = scored.reduce(|a, b| if b.1 > a.1 { b } else { a });
            let Some((best, _)) = best else { break };
            self.take(best);
            chosen.push(best);
        }
        chosen
    }

    /// The group whose touches lower the criterion most, for each touch.
    pub(super) fn best_group(&self, groups: &[Vec<usize>]) -> Option<usize> {
        let score = |group: &Vec<usize>| {
            let mut planner = self.only(group);
            let mut fall = 0.0;
            for k in 0..group.len() {
                fall += planner.fall(k);
                planner.take(k);
            }
            fall / group.len() as f64
        };
        let scored =
            groups.iter().enumerate().filter(|(_, group)| !group.is_empty()).map(|(g, group)| (g, score(group)));
        scored.reduce(|a, b| if b.1 > a.1 { b } else { a }).map(|(g, _)| g)
    }

    /// The planner of these touches alone, numbered as they stand here: a line's own touches decide what it tells.
    fn only(&self, group: &[usize]) -> PredictivePlanner {
        let touches = group.iter().flat_map(|&k| self.rows(k)).flatten().copied().collect();
        PredictivePlanner { width: self.width, followed: self.followed.clone(), touches, units: self.units }
    }

    fn rows(&self, k: usize) -> [&[f64]; 3] {
        let rows = &self.touches[3 * k * self.width..3 * (k + 1) * self.width];
        [0, 1, 2].map(|m| &rows[m * self.width..(m + 1) * self.width])
    }

    /// By how much touch `k` lets the criterion fall.
    fn fall(&self, k: usize) -> f64 {
        let rows = self.rows(k);
        let [s, r] = finished(rows, rows, self.followed.each_ref().map(Vec::as_slice)).falls();
        s * self.units[0] + r * self.units[1]
    }

    /// Goes on as if touch `k` had been made.
    fn take(&mut self, k: usize) {
        for m in 0..3 {
            let a = self.rows(k)[m].to_vec();
            let v = 1.0 + dot(&a, &a);
            let gain = 1.0 / (v + v.sqrt());
            let [s, r] = &mut self.followed;
            for x in [s.as_mut_slice(), r.as_mut_slice()].into_iter().chain(self.touches.chunks_exact_mut(self.width)) {
                let along = gain * dot(x, &a);
                x.iter_mut().zip(&a).for_each(|(x, a)| *x -= along * a);
            }
        }
    }
}

/// `sqrt(share) (value - mean) / unit` of every draw.
fn row(draws: &[PredictiveDraw], of: impl Fn(&PredictiveDraw) -> f64, unit: f64) -> Vec<f64> {
    let mean: f64 = draws.iter().map(|d| d.share * of(d)).sum();
    draws.iter().map(|d| d.share.sqrt() * (of(d) - mean) / unit).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_numeric::draws::EffectDraws;

    /// Draws without order: 40 of them at five places.
    fn planner() -> PredictivePlanner {
        let (width, places) = (40, 5);
        let row = |number: u64| {
            let mut row = vec![0.0; width];
            EffectDraws::new(3, "planner").gaussians(number, 0, width, &mut row);
            row.iter().map(|v| v / (width as f64).sqrt()).collect::<Vec<f64>>()
        };
        let touches = (2..2 + 3 * places).flat_map(row).collect();
        PredictivePlanner { width, followed: [row(0), row(1)], touches, units: [1.0, 4.0] }
    }

    fn criterion(planner: &PredictivePlanner) -> f64 {
        (0..2).map(|q| planner.units[q] * dot(&planner.followed[q], &planner.followed[q])).sum()
    }

    #[test]
    fn what_a_touch_takes_is_what_it_was_said_to_take() {
        let mut planner = planner();
        for k in [3, 0, 4] {
            let (before, fall) = (criterion(&planner), planner.fall(k));
            planner.take(k);
            assert!((before - fall - criterion(&planner)).abs() < 1e-14, "{k}: {before} - {fall}");
        }
    }

    #[test]
    fn the_same_touch_once_more_tells_what_a_touch_of_half_the_variance_tells() {
        let mut twice = planner();
        let mut better = planner();
        let width = twice.width;
        better.touches[3 * width..6 * width].iter_mut().for_each(|v| *v *= std::f64::consts::SQRT_2);
        twice.take(1);
        twice.take(1);
        better.take(1);
        assert!((criterion(&twice) - criterion(&better)).abs() < 1e-14);
    }

    #[test]
    fn the_first_choice_is_the_best_and_none_is_chosen_twice() {
        let chosen = planner().choose(&[0, 1, 2, 3, 4], 9);
        let best = (0..5).max_by(|a, b| planner().fall(*a).total_cmp(&planner().fall(*b)));
        assert_eq!(Some(chosen[0]), best);
        let mut sorted = chosen.clone();
        sorted.sort_unstable();
        assert_eq!(sorted, [0, 1, 2, 3, 4]);
        assert_eq!(planner().best_group(&[vec![], vec![chosen[4]], vec![chosen[0]]]), Some(2));
    }
}
