//! Primitives drawn from the posterior, and what they say of a number.
//!
//! ```text
//! number of draws of a node ~ its weight, taken in turn at even steps of the cumulated weights
//! theta = likeliest + s sqrt(nu / chi^2_nu) L^-T z         z gaussian, L the factor of the precision: Student's law of s unknown
//! ```

use std::sync::Arc;

use rand_distr::{ChiSquared, Distribution, StandardNormal};

use super::departure::DepartureProcess;
use super::evidence::{BodyHypothesis, moved};
use super::inference::BodyPosterior;
use super::mode::is_possible;
use super::tuning::Tuning;
use crate::dense;
use crate::primitives::placed::{Primitive, axes_along};
use palpate_numeric::draws::EffectDraws;
use palpate_numeric::statistics::weighted_quantile;
use palpate_numeric::vector::{Vector, along, dot, unit};

/// The golden section less one: its multiples fall evenly into 0 to 1, so that draws of every node are read both ways.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// One drawn surface, in units of the sample.
#[derive(Clone, Debug)]
pub(crate) struct DrawnBase {
    pub(crate) primitive: Primitive,
    /// Its departure with the weights that were drawn, where that is read as shape; as an error of the sensor it bends nothing.
    departure: Option<(Arc<DepartureProcess>, Vec<f64>)>,
    /// Its share of all; they sum to 1.
    pub(crate) share: f64,
}

impl DrawnBase {
    /// A primitive alone.
    pub(crate) fn of_primitive(primitive: Primitive) -> DrawnBase {
        DrawnBase { primitive, departure: None, share: 1.0 }
    }

    /// The likeliest primitive of a node with its departure.
    pub(crate) fn likeliest(primitive: Primitive, node: &BodyHypothesis) -> DrawnBase {
        let departure = node.process.clone().map(|process| {
            let weights = node.solution[..process.len()].to_vec();
            (process, weights)
        });
        DrawnBase { primitive, departure, share: 1.0 }
    }

    /// The same departure from this primitive: the same one in other axes.
    pub(crate) fn with_primitive(self, primitive: Primitive) -> DrawnBase {
        DrawnBase { primitive, ..self }
    }

    /// Height of the departure over a place of the primitive, outwards, and its slope there.
    fn height(&self, foot: Vector, outwards: Vector) -> (f64, Vector) {
        let Some((process, weights)) = &self.departure else { return (0.0, [0.0; 3]) };
        let sum = |row: Vec<f64>| row.iter().zip(weights).map(|(phi, w)| phi * w).sum::<f64>();
        let [first, second, _] = axes_along(outwards);
        let [a, b] = [first, second].map(|tangent| sum(process.slopes(foot, tangent)));
        (sum(process.values(foot)), along(first.map(|t| t * a), b, second))
    }

    /// Place and unit normal of the surface over a place of the primitive.
    pub(crate) fn over(&self, foot: Vector) -> (Vector, Vector) {
        let (_, normal) = self.primitive.nearest(foot);
        let outwards = normal.map(|n| n * self.primitive.side);
        let (height, slope) = self.height(foot, outwards);
        let leaning = unit(along(outwards, -1.0, slope));
        (along(foot, height, outwards), leaning.map(|n| n * self.primitive.side))
    }

    /// Signed distance of a place, positive on the free side.
    pub(crate) fn distance(&self, place: Vector) -> f64 {
        let (d, normal) = self.primitive.nearest(place);
        let outwards = normal.map(|n| n * self.primitive.side);
        d - self.primitive.side * self.height(along(place, -d, normal), outwards).0
    }

    /// Whether it departs from its primitive.
    pub(crate) fn departs(&self) -> bool {
        self.departure.is_some()
    }

    /// Principal curvatures `k1 >= k2` at the foot of a place, the normal towards the free side.
    pub(crate) fn curvatures(&self, place: Vector) -> [f64; 2] {
        let (d, normal) = self.primitive.nearest(place);
        let foot = along(place, -d, normal);
        let Some((process, weights)) = &self.departure else { return self.primitive.curvatures(foot) };
        let outwards = normal.map(|n| n * self.primitive.side);
        let [first, second, _] = axes_along(outwards);
        let hessian = self.primitive.at(self.primitive.own(foot)).hessian;
        let own = [first, second].map(|t| self.primitive.axes.map(|axis| dot(axis, t)));
        let of_base = |a: usize, b: usize| -(0..3).map(|i| own[a][i] * dot(hessian[i], own[b])).sum::<f64>();
        let bent = process.bending(weights, foot, [first, second]);
        let [a, b, c] = [of_base(0, 0) + bent[0], of_base(0, 1) + bent[1], of_base(1, 1) + bent[2]];
        let (mean, half) = (0.5 * (a + c), (0.5 * (a - c)).hypot(b));
        let [k, l] = [mean + half, mean - half].map(|k| k * self.primitive.side);
        [k.max(l), k.min(l)]
    }
}

/// Draws of all kinds by their weights.
pub(crate) fn draws(posterior: &BodyPosterior, tuning: &Tuning, seed: u64) -> Vec<DrawnBase> {
    let (count, as_error) = (tuning.draws, tuning.departure_is_error);
    let source = EffectDraws::new(seed, "bodies");
    let mut found = Vec::with_capacity(count);
    let (mut cumulated, mut taken) = (0.0, 0);
    for (number, (node, weight)) in posterior.nodes.iter().zip(&posterior.weights).enumerate() {
        cumulated += weight;
        let until = (cumulated * count as f64 + 0.5).floor() as usize;
        for _ in taken..until.min(count) {
            let mut generator = source.generator(found.len() as u64, number as u64);
            let chi = ChiSquared::new(node.freedom).map_or(node.freedom, |law| law.sample(&mut generator));
            let wide = node.sd[0] * (node.freedom / chi).sqrt();
            let mut step: Vec<f64> = (0..node.solution.len()).map(|_| StandardNormal.sample(&mut generator)).collect();
            dense::backward(&node.lower, &mut step);
            step.iter_mut().zip(&node.solution).for_each(|(s, mean)| *s = mean + wide * *s);
            let base = posterior.primitives[node.of];
            let weights = node.process.as_ref().map_or(0, |process| process.len());
            let drawn = moved(&base, &step[weights..]);
            // a radius below zero is no body: the likeliest stands for it
            let primitive = if is_possible(&drawn) { drawn } else { moved(&base, node.step()) };
            let is_error = found.len() as f64 * GOLDEN % 1.0 < as_error;
            let process = node.process.clone().filter(|_| !is_error);
            let departure = process.map(|process| (process, step[..weights].to_vec()));
            found.push(DrawnBase { primitive, departure, share: 0.0 });
        }
        taken = until.min(count).max(taken);
    }
    let share = 1.0 / found.len().max(1) as f64;
    found.iter_mut().for_each(|d| d.share = share);
    found
}

/// Mean, standard deviation and the two ends of an interval of a number over the draws.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PosteriorSpread {
    pub(crate) mean: f64,
    pub(crate) sd: f64,
    pub(crate) interval: [f64; 2],
}

/// Of values with shares; `None` where there is none.
pub(crate) fn spread(values: &[(f64, f64)], level: f64) -> Option<PosteriorSpread> {
    let all: f64 = values.iter().map(|(_, share)| share).sum();
    let about = values.first()?.0;
    let mean = about + values.iter().map(|(v, share)| share * (v - about)).sum::<f64>() / all;
    let square = values.iter().map(|(v, share)| share * (v - mean).powi(2)).sum::<f64>() / all;
    let mut ordered = values.to_vec();
    ordered.sort_by(|a, b| a.0.total_cmp(&b.0));
    let tail = 0.5 * (1.0 - level);
    let interval = [weighted_quantile(&ordered, tail)?, weighted_quantile(&ordered, 1.0 - tail)?];
    Some(PosteriorSpread { mean: mean.clamp(interval[0], interval[1]), sd: square.max(0.0).sqrt(), interval })
}
