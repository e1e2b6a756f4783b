//! The room that an interval leaves for doubt: weights in which what the evidence speaks against keeps a share.
//!
//! ```text
//! v = w, but departures never below max(least e^-(gap - unseen)/fading, departed e^-(gap - alike)/fading), no e^ above 1
//!                             gap: log evidence by which they are behind
//! departures of the interval: natural ones; rough splines, and half of the smooth ones, with a prior ten times as loose, unless f may
//!                             be an error;  departures that are free in form never below half, rough splines never below
//!                             e^-(gap - alike)/fading / 2 of these
//! torus of both: its share goes to natural departures and bodies, where no simple shape is far ahead, and no departure is an error;
//!                where one may be an error, the torus of the interval's other reading does so, too
//! ```
//!
//! No shape is ever exactly a cylinder, so the displaced reading keeps a share even where the evidence is against it.
//! The likeliest smoothness follows the evidence, which weighs bias and noise alike; an interval that is centred on a
//! biased value misses the truth, so the interval's displaced surfaces are smoothed ten times less. P. Hall, *Ann.
//! Statist.* 20 (1992) 675.

use crate::bodies::Tuning;
use crate::recognition::discrepancy::is_free;
use crate::recognition::evidence::{GROUPS, Node};
use crate::recognition::kinds::Kind;

use super::normalised_weights::{best, raise, shares, total};

/// How much room is left for what the evidence speaks against.
#[derive(Clone, Copy)]
pub(super) struct Doubt<'a> {
    /// Log evidence by which the share of the worse of two readings falls to 1/e.
    fading: f64,
    /// Least share of general and of displaced surfaces.
    least: f64,
    tuning: &'a Tuning,
}

impl<'a> Doubt<'a> {
    pub(super) fn of_interval(tuning: &'a Tuning) -> Doubt<'a> {
        let [fading, least] = tuning.doubt_of_interval;
        Doubt { fading, least, tuning }
    }

    pub(super) fn of_class(tuning: &'a Tuning) -> Doubt<'a> {
        let [fading, least] = tuning.doubt_of_class;
        Doubt { fading, least, tuning }
    }

    /// Share of a reading whose log evidence lies `gap` below the best: `most` where it is as good, fading slowly, because
    /// no prior of shapes is known that well.
    fn share(self, most: f64, gap: f64) -> f64 {
        most * self.faded(gap - self.tuning.alike)
    }

    /// Least share of departures whose log evidence lies `gap` below the best.
    fn least_of_departures(self, gap: f64) -> f64 {
        self.least * self.faded(gap - self.tuning.unseen)
    }

    /// What so much log evidence leaves of a share.
    fn faded(self, evidence: f64) -> f64 {
        (-evidence.max(0.0) / self.fading).exp()
    }
}

/// Gives sphere and cylinder, where they misfit little more than the general surface, their least share of the interval.
pub(super) fn keep_simple(interval: &mut [f64], nodes: &[Node], doubt: Doubt, misfit: impl Fn(Kind) -> f64) {
    for kind in [Kind::Sphere, Kind::Cylinder] {
        let here = |n: &Node| n.kind == kind;
        if misfit(kind) <= doubt.tuning.simple_misfit * misfit(Kind::General)
            && total(interval, nodes, here) < doubt.least
        {
            raise(interval, nodes, here, |_| true, doubt.least);
        }
    }
}

/// Shares of the displaced nodes, passed on to the node of the same kernel whose prior is ten times as loose.
fn undersmoothed(nodes: &[Node], tuning: &Tuning) -> Vec<f64> {
    let plain = shares(nodes, |n| n.group() == 2);
    let mut out = plain.clone();
    for (i, node) in nodes.iter().enumerate().filter(|(_, n)| n.group() == 2) {
        // the sizes of a prior follow each other
        let next = nodes.get(i + 1).filter(|next| next.kernel == node.kernel && next.departure.is_like(node.departure));
        if next.is_some() {
            let passed = plain[i] * if node.departure.process().is_some_and(is_free) { tuning.looser } else { 1.0 };
            out[i] -= passed;
            out[i + 1] += passed;
        }
    }
    out
}

/// Gives departures that are free in form half of what displacements have: no body is exactly a profile that was drawn or turned.
fn with_free(mut shares: Vec<f64>, nodes: &[Node], either: f64) -> Vec<f64> {
    let displaced = |n: &Node| n.group() == 2;
    let free = |n: &Node| displaced(n) && n.departure.process().is_none_or(is_free);
    if total(&shares, nodes, free) < either * total(&shares, nodes, displaced) {
        raise(&mut shares, nodes, free, displaced, either);
    }
    shares
}

/// Gives rough splines their least share of what displacements have: a surface need not be smooth in all its derivatives.
fn with_rough(mut shares: Vec<f64>, nodes: &[Node], doubt: Doubt) -> Vec<f64> {
    let displaced = |n: &Node| n.group() == 2;
    let is_rough = |n: &Node| displaced(n) && !n.departure.is_smooth();
    let least = doubt.share(doubt.tuning.either_reading, best(nodes, displaced) - best(nodes, is_rough));
    if total(&shares, nodes, is_rough) < least {
        raise(&mut shares, nodes, is_rough, displaced, least);
    }
    shares
}

/// Weights with this doubt; `error` says that a displacement was read as the sensor's error.
pub(super) fn with_doubt(
    nodes: &[Node],
    estimate: &[f64],
    error: bool,
    doubt: Doubt,
    misfit: impl Fn(Kind) -> f64,
) -> Vec<f64> {
    let tuning = doubt.tuning;
    let groups: [Vec<f64>; GROUPS] = std::array::from_fn(|j| shares(nodes, |n| n.group() == j));
    let looser = if error { groups[2].clone() } else { undersmoothed(nodes, tuning) };
    let rougher = with_rough(with_free(looser, nodes, tuning.either_reading), nodes, doubt);
    let wanted = group_shares(nodes, estimate, error, doubt);
    let mut out = vec![0.0; nodes.len()];
    for (wanted, fresh) in wanted.into_iter().zip([&groups[0], &groups[1], &rougher, &groups[3], &groups[4]]) {
        out.iter_mut().zip(fresh).for_each(|(out, fresh)| *out += wanted * fresh);
    }
    let all: f64 = out.iter().sum();
    if all > 0.0 {
        out.iter_mut().for_each(|v| *v /= all);
    }
    let (torus, paraboloid) = (misfit(Kind::General), misfit(Kind::Paraboloid));
    for (kind, own, other) in [(Kind::General, torus, paraboloid), (Kind::Paraboloid, paraboloid, torus)] {
        let within = |n: &Node| n.group() == 1;
        let here = |n: &Node| within(n) && n.kind == kind;
        let least = doubt.share(tuning.reference, best(nodes, within) - best(nodes, here));
        if own <= tuning.reference_misfit * other && total(&out, nodes, here) < least * total(&out, nodes, within) {
            raise(&mut out, nodes, here, within, least);
        }
    }
    if !error {
        departed(nodes, &mut out, tuning);
    }
    out
}

/// Shares of the groups in the interval.
fn group_shares(nodes: &[Node], estimate: &[f64], error: bool, doubt: Doubt) -> [f64; GROUPS] {
    let sums: [f64; GROUPS] = std::array::from_fn(|j| total(estimate, nodes, |n| n.group() == j));
    let best_of = |j: usize| best(nodes, |n| n.group() == j);
    let any = sums[2] + sums[3];
    let best_of_any = best_of(2).max(best_of(3));
    let gap = best(nodes, |_| true) - best_of_any;
    let both = any
        .max(if error { doubt.tuning.either_reading } else { doubt.share(doubt.tuning.departed, gap) })
        .max(doubt.least_of_departures(gap));
    let general =
        if any + sums[4] < 0.5 { (sums[1] + any - both).max(doubt.least) } else { sums[1].min((1.0 - both).max(0.0)) };
    let exact = sums[0] + sums[4];
    let rest = if exact > 0.0 { (1.0 - general - both).max(0.0) / exact } else { 0.0 };
    // either kind of displacement keeps a part of what both have
    let share = if any > 0.0 { sums[3] / any } else { 0.0 };
    let [other, natural] = [2, 3].map(|j| doubt.share(doubt.tuning.other_departures, best_of_any - best_of(j)));
    let natural = both * share.max(natural).min(1.0 - other);
    [rest * sums[0], general, both - natural, natural, rest * sums[4]]
}

/// Passes the torus's share to natural departures and bodies, because no surface has two constant curvatures that differ, but for
/// cylinders. Where a simple shape explains the contacts far better, the torus keeps it: it then repeats that shape.
pub(super) fn departed(nodes: &[Node], weights: &mut [f64], tuning: &Tuning) {
    let is_torus = |n: &Node| n.kind == Kind::General && n.group() == 1;
    let is_other = |n: &Node| n.is_natural() || n.is_body();
    let (torus, fresh) = (total(weights, nodes, is_torus), shares(nodes, is_other));
    if torus == 0.0 || fresh.iter().sum::<f64>() == 0.0 {
        return;
    }
    let gap = best(nodes, |n| n.group() == 0) - best(nodes, is_other);
    let passed = (-(gap - tuning.alike).max(0.0) / tuning.simpler).exp();
    for ((w, node), fresh) in weights.iter_mut().zip(nodes).zip(fresh) {
        if is_torus(node) {
            *w *= 1.0 - passed;
        }
        *w += passed * torus * fresh;
    }
}
