//! Primitives drawn from the posterior, and what they say of a number.
//!
//! ```text
//! number of draws of a node ~ its weight, taken in turn at even steps of the cumulated weights
//! theta = likeliest + s sqrt(nu / chi^2_nu) L^-T z         z gaussian, L the factor of the precision: Student's law of s unknown
//! ```

use rand_distr::{ChiSquared, Distribution, StandardNormal};

use super::evidence::moved;
use super::inference::BodyPosterior;
use super::mode::is_possible;
use crate::dense;
use crate::primitives::placed::Primitive;
use palpate_numeric::draws::EffectDraws;
use palpate_numeric::statistics::weighted_quantile;

/// One drawn primitive, in units of the sample.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct DrawnBase {
    pub(crate) primitive: Primitive,
    /// Number of its kind.
    pub(crate) of: usize,
    /// Its share of all; they sum to 1.
    pub(crate) share: f64,
}

/// Draws of all kinds by their weights.
pub(crate) fn draws(posterior: &BodyPosterior, count: usize, seed: u64) -> Vec<DrawnBase> {
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
            let mut step: Vec<f64> = (0..node.step.len()).map(|_| StandardNormal.sample(&mut generator)).collect();
            dense::backward(&node.lower, &mut step);
            step.iter_mut().zip(&node.step).for_each(|(s, mean)| *s = mean + wide * *s);
            let base = posterior.primitives[node.of];
            let drawn = moved(&base, &step);
            // a radius below zero is no body: the likeliest stands for it
            let primitive = if is_possible(&drawn) { drawn } else { moved(&base, &node.step) };
            found.push(DrawnBase { primitive, of: node.of, share: 0.0 });
        }
        taken = until.min(count).max(taken);
    }
    let share = 1.0 / found.len().max(1) as f64;
    found.iter_mut().for_each(|d| d.share = share);
    found
}

/// Mean, standard deviation and the two ends of an interval of a number over the draws.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spread {
    pub(crate) mean: f64,
    pub(crate) sd: f64,
    pub(crate) interval: [f64; 2],
}

/// Of values with shares; `None` where there is none.
pub(crate) fn spread(values: &[(f64, f64)], level: f64) -> Option<Spread> {
    let all: f64 = values.iter().map(|(_, share)| share).sum();
    let about = values.first()?.0;
    let mean = about + values.iter().map(|(v, share)| share * (v - about)).sum::<f64>() / all;
    let square = values.iter().map(|(v, share)| share * (v - mean).powi(2)).sum::<f64>() / all;
    let mut ordered = values.to_vec();
    ordered.sort_by(|a, b| a.0.total_cmp(&b.0));
    let tail = 0.5 * (1.0 - level);
    let interval = [weighted_quantile(&ordered, tail)?, weighted_quantile(&ordered, 1.0 - tail)?];
    Some(Spread { mean: mean.clamp(interval[0], interval[1]), sd: square.max(0.0).sqrt(), interval })
}
