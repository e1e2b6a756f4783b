//! The next touches by each strategy.
//!
//! ```text
//! lattice       argmax over candidates of the distance to the nearest touch
//! random        each candidate with the same probability
//! second-sweep  middle + t (cos a, sin a), a: direction of k1, then of k2;  t = +-1, +-1/2, 0, +-1/4, ... of half the reach
//! variance      argmax Var z      shape  argmax of the fall of u(S), u(R)      both with the covariance updated in between:
//!               that of a spline, or for shape that of the recognition's draws where no model was named
//! probe-model   argmax |z_rich - z_simple|, away from the touches of the same round; those of shape below 12 contacts, too
//! ```

use palpate_geometry::contact::Contacts;
use palpate_numeric::draws::EffectDraws;

use super::ExploreError;
use super::answer::Answer;
use super::planner::{Criterion, TouchPlanner};
use super::predictive_planner::PredictivePlanner;
use super::simulated_sensor::Hand;
use super::strategy::Strategy;

/// Stations of a finger's line, where whole lines are planned.
const STATIONS: usize = 5;

/// Contacts below which touches ask what kind of surface it is, before others ask for its S and R: those after a first sweep of 3 x 3. Of 120
/// objects `shape` then has half right after 15 contacts instead of 18 (`benches/runs/explore.md`). Twice or four times as many such touches
/// settle fewer in the end, and after a sweep of 27 contacts they are wasted.
const OPEN: usize = 12;

/// What a choice is made from.
pub(super) struct Situation<'a> {
    pub(super) hand: &'a Hand,
    /// Where the scene's sweeps touched.
    pub(super) swept: &'a [[f64; 2]],
    pub(super) contacts: &'a Contacts,
    pub(super) answer: &'a Answer,
    /// Direction of k1 at the middle of the patch after the first sweep, radians from x towards y.
    pub(super) direction: f64,
    /// Units of S and of R, where goals are given.
    pub(super) units: Option<[f64; 2]>,
    pub(super) seed: u64,
}

impl Situation<'_> {
    /// At most `n` places to touch next; empty where there is none left.
    pub(super) fn next(&self, strategy: Strategy, n: usize, lines: bool) -> Result<Vec<[f64; 2]>, ExploreError> {
        let left = self.left();
        if strategy == Strategy::SecondSweep {
            return Ok(self.second_sweep(n));
        }
        if left.is_empty() {
            return Ok(Vec::new());
        }
        let places: Vec<[f64; 2]> = left.iter().map(|&k| self.hand.candidates[k]).collect();
        match strategy {
            Strategy::Random => Ok(self.random(&places, n)),
            Strategy::Lattice | Strategy::SecondSweep => Ok(self.farthest(&places, n)),
            Strategy::ProbeModel => Ok(self.probed(&places, n).unwrap_or_else(|| self.farthest(&places, n))),
            Strategy::Variance => self.planned(&left, &places, n, Criterion::Height, lines),
            Strategy::Shape if self.asks_for_kind(lines) => self.next(Strategy::ProbeModel, n, lines),
            Strategy::Shape => match self.answer.predictive_planner(self.units) {
                Some(planner) => Ok(self.predicted(planner, &left, n, lines)),
                None => self.planned(&left, &places, n, Criterion::Shape, lines),
            },
        }
    }

    /// Whether so few contacts were recognised that the kind of surface is more in doubt than the draws of the likely kinds say: the
    /// touches that tell most are those that tell kinds apart.
    fn asks_for_kind(&self, lines: bool) -> bool {
        !lines && self.contacts.len() < OPEN && matches!(self.answer, Answer::Recognised(_))
    }

    /// The touches by which S and R would be known best, as the recognition sees them.
    fn predicted(&self, mut planner: PredictivePlanner, left: &[usize], n: usize, lines: bool) -> Vec<[f64; 2]> {
        let chosen = if lines {
            let of_left = |line: Vec<usize>| line.into_iter().map(|k| left[k]).collect();
            let groups: Vec<Vec<usize>> = self.lines(left).into_iter().map(of_left).collect();
            let best = planner.best_group(&groups);
            best.map_or(Vec::new(), |g| groups[g].iter().copied().take(n).collect())
        } else {
            planner.choose(left, n)
        };
        chosen.into_iter().map(|k| self.hand.candidates[k]).collect()
    }

    /// Numbers of the candidates that were not touched yet: a place touched twice tells of noise and not of shape.
    fn left(&self) -> Vec<usize> {
        let near = 1e-6 * self.hand.diagonal();
        let is_new = |place: &[f64; 2]| self.touched().all(|touch| distance(touch, *place) > near);
        (0..self.hand.candidates.len()).filter(|&k| is_new(&self.hand.candidates[k])).collect()
    }

    fn touched(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.swept.iter().chain(&self.hand.touches).copied()
    }

    fn planner(&self) -> Option<TouchPlanner> {
        let planner = TouchPlanner::new(&self.answer.planning_fit(self.contacts)?).ok()?;
        Some(match self.units {
            Some([s, r]) => planner.with_units(s, r),
            None => planner,
        })
    }

    fn planned(
        &self,
        left: &[usize],
        places: &[[f64; 2]],
        n: usize,
        criterion: Criterion,
        lines: bool,
    ) -> Result<Vec<[f64; 2]>, ExploreError> {
        // without a fit nothing is known of what a touch would tell
        let Some(mut planner) = self.planner() else { return Ok(self.farthest(places, n)) };
        if lines {
            let groups = self.lines(left);
            let best = planner.best_group(places, &groups, criterion)?;
            return Ok(best.map_or(Vec::new(), |g| groups[g].iter().take(n).map(|&k| places[k]).collect()));
        }
        Ok(planner.choose(places, n, criterion)?.iter().map(|&k| places[k]).collect())
    }

    /// What u(S) and u(R) would fall to, as shares of what they are, if `n` touches more were made where they help most.
    pub(super) fn attainable(&self, n: usize) -> Option<[f64; 2]> {
        let places: Vec<[f64; 2]> = self.left().iter().map(|&k| self.hand.candidates[k]).collect();
        let mut planner = self.planner()?;
        planner.next_touches(&places, n).ok()?;
        let (after, before) = (planner.expected_u(), planner.u());
        Some([0, 1].map(|q| if before[q] > 0.0 { after[q] / before[q] } else { 1.0 }))
    }

    /// Lines of fingers over the candidates left, both ways: every lattice line, thinned to a few stations.
    fn lines(&self, left: &[usize]) -> Vec<Vec<usize>> {
        let mut lines = Vec::new();
        for way in 0..2 {
            let last = self.hand.lattice.iter().map(|at| at[way]).max().unwrap_or(0);
            for line in 0..=last {
                let on = (0..left.len()).filter(|&k| self.hand.lattice[left[k]][way] == line);
                let on: Vec<usize> = on.collect();
                let stations = STATIONS.min(on.len());
                let at = |s: usize| on[s * (on.len() - 1) / (stations - 1).max(1)];
                lines.push((0..stations).map(at).collect());
            }
        }
        lines
    }

    fn random(&self, places: &[[f64; 2]], n: usize) -> Vec<[f64; 2]> {
        let draws = EffectDraws::new(self.seed, "explore");
        let mut left = places.to_vec();
        let first = self.hand.touches.len() as u64;
        let mut chosen = Vec::new();
        for touch in (first..).take(n.min(places.len())) {
            let mut u = [0.0];
            draws.uniforms(touch, 0, 1, &mut u);
            let k = ((u[0] * left.len() as f64) as usize).min(left.len() - 1);
            chosen.push(left.swap_remove(k));
        }
        chosen
    }

    /// The places farthest from all touches, one after the other.
    fn farthest(&self, places: &[[f64; 2]], n: usize) -> Vec<[f64; 2]> {
        let mut nearest: Vec<f64> = places
            .iter()
            .map(|place| self.touched().map(|touch| distance(touch, *place)).fold(f64::INFINITY, f64::min))
            .collect();
        let mut chosen = Vec::new();
        for _ in 0..n.min(places.len()) {
            let Some(best) = first_largest(&nearest) else { break };
            chosen.push(places[best]);
            nearest.iter_mut().zip(places).for_each(|(d, place)| *d = d.min(distance(places[best], *place)));
        }
        chosen
    }

    /// Along both principal directions, coarse first, then in between.
    fn second_sweep(&self, n: usize) -> Vec<[f64; 2]> {
        /// Halvings of the spacing: 2 x 129 stations.
        const HALVINGS: u32 = 7;
        let middle = self.hand.middle();
        let directions = [self.direction, self.direction + std::f64::consts::FRAC_PI_2];
        let reach = directions.map(|angle| self.chord(middle, angle));
        let near = 1e-3 * self.hand.diagonal();
        let mut chosen: Vec<[f64; 2]> = Vec::new();
        for step in (0..HALVINGS).map(|k| 1_i32 << k) {
            for (k, share) in (-step..=step).map(|k| (k, f64::from(k) / f64::from(step))) {
                if step > 1 && k % 2 == 0 {
                    continue;
                }
                for (angle, [back, forth]) in directions.iter().zip(reach) {
                    let t = if share < 0.0 { -share * back } else { share * forth };
                    let place = [middle[0] + t * angle.cos(), middle[1] + t * angle.sin()];
                    let is_new =
                        self.touched().chain(chosen.iter().copied()).all(|touch| distance(touch, place) > near);
                    if chosen.len() < n && is_new && self.hand.can_touch(place) {
                        chosen.push(place);
                    }
                }
            }
        }
        chosen
    }

    /// How far the reach goes from the middle, backwards (negative) and forwards.
    fn chord(&self, middle: [f64; 2], angle: f64) -> [f64; 2] {
        [-1.0, 1.0].map(|side| {
            let (mut inside, mut outside) = (0.0, self.hand.diagonal());
            for _ in 0..40 {
                let t = 0.5 * (inside + outside);
                let place = [middle[0] + side * t * angle.cos(), middle[1] + side * t * angle.sin()];
                if self.hand.can_touch(place) { inside = t } else { outside = t }
            }
            // a hair inside, where rounding cannot put it beyond the edge
            side * inside * (1.0 - 1e-6)
        })
    }

    /// Where a richer patch differs most from a simple one.
    fn probed(&self, places: &[[f64; 2]], n: usize) -> Option<Vec<[f64; 2]>> {
        let [simple, rich] = self.answer.simple_and_rich(self.contacts)?.map(|fit| fit.input_surface().ok());
        let [simple, rich] = [simple?, rich?];
        let mut differs: Vec<f64> =
            places.iter().map(|[x, y]| (rich.at(*x, *y).z - simple.at(*x, *y).z).abs()).collect();
        // the spacing that as many touches as there are would have if they lay evenly
        let all = self.swept.len() + self.hand.touches.len() + n;
        let apart = 0.5 * self.hand.diagonal() / (all as f64).sqrt();
        let mut chosen = Vec::new();
        for _ in 0..n.min(places.len()) {
            let Some(best) = first_largest(&differs) else { break };
            chosen.push(places[best]);
            let near = |place: &[f64; 2]| distance(places[best], *place) < apart;
            differs.iter_mut().zip(places).filter(|(_, place)| near(place)).for_each(|(d, _)| *d = -1.0);
        }
        Some(chosen)
    }
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

fn first_largest(values: &[f64]) -> Option<usize> {
    let mut best: Option<usize> = None;
    for (k, value) in values.iter().enumerate() {
        if best.is_none_or(|b| *value > values[b]) {
            best = Some(k);
        }
    }
    best
}
