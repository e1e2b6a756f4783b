//! How many neighbours a jet takes, with the noise and the bend that they show: from the smallest neighbourhood on, the next
//! larger one as long as it misfits no more and knows the curvature better.
//!
//! ```text
//! sizes of `PartsTuning::jet_sizes`        noise(size) <= jet_misfit noise(before)        median u(k)^2 least
//! noise, bend: fixed point of the jets of at most `jet_asked` points, every m-th by distance from the centre
//! ```
//!
//! This is O. V. Lepskii's comparison of bandwidths (*Theory of Probability and its Applications* 35, 1991) with one answer for the
//! cloud, so that it does not jump from point to point; within a neighbourhood, the prior of the jet weighs bend against noise.

use super::jet::{Jet, Law};
use super::jet_neighbourhood::{Neighbourhood, Touched};
use super::local::{Noise, ROUNDING};
use super::tuning::PartsTuning;
use palpate_numeric::statistics::{self, Rank};
use palpate_numeric::threads;
use palpate_numeric::vector::dot;

/// Rounds of the fixed point at most. It starts from bends that bind nothing, and halves what is wrong in each.
const ROUNDS: usize = 6;

/// Share of a noise by which it moves in the last round: less than what the number of points leaves open.
const SETTLED: f64 = 0.01;

/// Smallest mean square of a derivative, in units of the cloud's size: that of a plane.
const FLAT: f64 = 1e-12;

/// Points that are asked, in an order which neither rotation nor numbering changes, unless distances are equal.
pub(super) fn asked(touched: &Touched, at_most: usize) -> Vec<usize> {
    let count = touched.points.len();
    let mut order: Vec<(f64, usize)> = (0..count).map(|i| (dot(touched.points[i], touched.points[i]), i)).collect();
    order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let step = count.div_ceil(at_most.max(1));
    order.into_iter().step_by(step).map(|(_, i)| i).collect()
}

/// The law of the size that knows curvature best; `None` where no point has a jet.
pub(super) fn law(touched: &Touched, asked: &[usize], spacing: f64, tuning: &PartsTuning) -> Option<Law> {
    let mut best: Option<(f64, Law)> = None;
    let least = tuning.jet_sizes[0];
    for size in tuning.jet_sizes.into_iter().filter(|size| *size == least || size + 1 < touched.points.len() / 4) {
        let Some((score, law)) = settled(touched, asked, spacing, (size, tuning)) else { break };
        let misfits = best.is_some_and(|(_, last)| {
            let grows = |of: fn(&Noise) -> f64| of(&law.noise) > tuning.jet_misfit * of(&last.noise);
            grows(|noise| noise.distance) || grows(|noise| noise.normal)
        });
        if misfits || best.is_some_and(|(best, _)| score >= best) {
            break;
        }
        best = Some((score, law));
    }
    best.map(|(_, law)| law)
}

/// Noise and bend as neighbourhoods of one size show them, and the median variance of curvature.
fn settled(
    touched: &Touched,
    asked: &[usize],
    spacing: f64,
    (size, tuning): (usize, &PartsTuning),
) -> Option<(f64, Law)> {
    let reach = spacing * (size as f64 / std::f64::consts::PI).sqrt();
    let noise = Noise { distance: 0.1 * spacing, normal: 0.05 };
    let mut law = Law { size, noise, bend: [reach.powi(-4), reach.powi(-6)], belief: tuning.jet_belief };
    // the same neighbours in every round: noises and bends alone are others
    let near: Vec<Neighbourhood> =
        threads::map(asked.len(), 16, |k| Neighbourhood::of(touched, asked[k], size)).into_iter().flatten().collect();
    let mut score = f64::INFINITY;
    for _ in 0..ROUNDS {
        let shown = |k: usize| near[k].jet(&law).map(|jet| JetMisfit::by(&jet));
        let shown: Vec<JetMisfit> = threads::map(near.len(), 16, shown).into_iter().flatten().collect();
        if shown.is_empty() {
            return None;
        }
        let last = law;
        let [distance, normal] = [0, 1].map(|block| noise_of(&shown, block, tuning.smooth));
        law.noise = Noise { distance, normal };
        law.bend = [0, 1].map(|k| quantile(shown.iter().map(|of| of.bend[k]), 0.5).max(FLAT));
        score = quantile(shown.iter().map(|of| of.score), 0.5);
        if is_settled(&last, &law) {
            break;
        }
    }
    Some((score, law))
}

/// What a jet shows of the cloud.
struct JetMisfit {
    variance: [f64; 2],
    freedom: [f64; 2],
    bend: [f64; 2],
    score: f64,
}

impl JetMisfit {
    fn by(jet: &Jet) -> JetMisfit {
        JetMisfit { variance: jet.variance, freedom: jet.freedom, bend: jet.bend, score: jet.variance_of_second() }
    }
}

/// Whether a round moved neither noise, nor the sd of a third or a fourth derivative, by more than a share of it.
fn is_settled(last: &Law, law: &Law) -> bool {
    let near = |old: f64, new: f64| (new - old).abs() <= SETTLED * new;
    let roots = |law: &Law| law.bend.map(f64::sqrt);
    let bends = roots(last).into_iter().zip(roots(law)).all(|(old, new)| near(old, new));
    bends && near(last.noise.distance, law.noise.distance) && near(last.noise.normal, law.noise.normal)
}

/// Wilson and Hilferty's quantile of a mean of so many squares.
fn noise_of(shown: &[JetMisfit], block: usize, [share, gaussian]: [f64; 2]) -> f64 {
    let value = quantile(shown.iter().map(|of| of.variance[block]), share);
    let freedom = quantile(shown.iter().map(|of| of.freedom[block]), 0.5);
    let ninth = 2.0 / (9.0 * freedom);
    (value / (1.0 - ninth + gaussian * ninth.sqrt()).max(0.1).powi(3)).sqrt().max(ROUNDING)
}

fn quantile(values: impl Iterator<Item = f64>, share: f64) -> f64 {
    statistics::quantile(values.collect::<Vec<f64>>(), share, Rank::Floor).unwrap_or(0.0)
}
