//! How many neighbours a jet takes, with the noise and the bend that they show: from the smallest neighbourhood on, the next
//! larger one as long as it misfits no more and knows the curvature better.
//!
//! ```text
//! 24, 48, 96, 192 neighbours        noise(size) <= 1.1 noise(before)        median u(k)^2 least
//! noise, bend: fixed point of the jets of at most 1024 points, every m-th by distance from the centre
//! ```
//!
//! This is O. V. Lepskii's comparison of bandwidths (*Theory of Probability and its Applications* 35, 1991) with one answer for the
//! cloud, so that it does not jump from point to point; within a neighbourhood, the prior of the jet weighs bend against noise.

use super::jet::{Jet, Law, Touched, jet};
use super::local::{Noise, ROUNDING};
use palpate_numeric::statistics::{self, Rank};
use palpate_numeric::threads;
use palpate_numeric::vector::dot;

/// Neighbours: the first leaves a few degrees of freedom to heights alone.
const SIZES: [usize; 4] = [24, 48, 96, 192];

/// Points that are asked. Noise and bend are then known to some 3 %, which moves no answer by a tenth of its u.
const ASKED: usize = 1024;

/// Rounds of the fixed point. It starts from bends that bind nothing, and halves what is wrong in each.
const ROUNDS: usize = 6;

/// Misfit over that of the size before, beyond which the neighbourhood reaches too far.
const MISFIT: f64 = 1.1;

/// The quantile that is thought to lie away from edges, and the same of a gaussian.
const SMOOTH: (f64, f64) = (0.3, -0.5244);

/// Smallest mean square of a derivative, in units of the cloud's size: that of a plane.
const FLAT: f64 = 1e-12;

/// Points that are asked, in an order which neither rotation nor numbering changes, unless distances are equal.
pub(super) fn asked(touched: &Touched) -> Vec<usize> {
    let count = touched.points.len();
    let mut order: Vec<(f64, usize)> = (0..count).map(|i| (dot(touched.points[i], touched.points[i]), i)).collect();
    order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let step = count.div_ceil(ASKED);
    order.into_iter().step_by(step).map(|(_, i)| i).collect()
}

/// The law of the size that knows curvature best; `None` where no point has a jet.
pub(super) fn law(touched: &Touched, asked: &[usize], spacing: f64) -> Option<Law> {
    let mut best: Option<(f64, Law)> = None;
    for size in SIZES.into_iter().filter(|size| *size == SIZES[0] || size + 1 < touched.points.len() / 4) {
        let Some((score, law)) = settled(touched, asked, spacing, size) else { break };
        let misfits = best.is_some_and(|(_, last)| {
            law.noise.distance > MISFIT * last.noise.distance || law.noise.normal > MISFIT * last.noise.normal
        });
        if misfits || best.is_some_and(|(least, _)| score >= least) {
            break;
        }
        best = Some((score, law));
    }
    best.map(|(_, law)| law)
}

/// Noise and bend as neighbourhoods of one size show them, and the median variance of curvature.
fn settled(touched: &Touched, asked: &[usize], spacing: f64, size: usize) -> Option<(f64, Law)> {
    let reach = spacing * (size as f64 / std::f64::consts::PI).sqrt();
    let noise = Noise { distance: 0.1 * spacing, normal: 0.05 };
    let mut law = Law { size, noise, bend: [reach.powi(-4), reach.powi(-6)] };
    let mut score = f64::INFINITY;
    for _ in 0..ROUNDS {
        let jets: Vec<Jet> =
            threads::map(asked.len(), 16, |k| jet(touched, asked[k], &law)).into_iter().flatten().collect();
        if jets.is_empty() {
            return None;
        }
        law.noise = Noise { distance: noise_of(&jets, 0), normal: noise_of(&jets, 1) };
        law.bend = [0, 1].map(|k| quantile(jets.iter().map(|j| j.bend[k]), 0.5).max(FLAT));
        score = quantile(jets.iter().map(|j| (3..6).map(|k| j.covariance[k][k]).sum()), 0.5);
    }
    Some((score, law))
}

/// Wilson and Hilferty's quantile of a mean of so many squares.
fn noise_of(jets: &[Jet], block: usize) -> f64 {
    let (share, gaussian) = SMOOTH;
    let value = quantile(jets.iter().map(|j| j.variance[block]), share);
    let freedom = quantile(jets.iter().map(|j| j.freedom[block]), 0.5);
    let ninth = 2.0 / (9.0 * freedom);
    (value / (1.0 - ninth + gaussian * ninth.sqrt()).max(0.1).powi(3)).sqrt().max(ROUNDING)
}

fn quantile(values: impl Iterator<Item = f64>, share: f64) -> f64 {
    statistics::quantile(values.collect::<Vec<f64>>(), share, Rank::Floor).unwrap_or(0.0)
}
