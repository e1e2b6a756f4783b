//! Weights of the hypotheses: those of the estimate follow from the evidence, those of the interval leave room for
//! doubt.
//!
//! ```text
//! w ~ exp(log evidence)                                   the estimate
//! v = w, but displaced never below max(0.1, 0.8 e^-(gap - 2)/8)        gap: log evidence by which it is behind
//! displaced nodes of the interval: natural departures; rough splines, and half of the smooth departures, with a prior ten times as
//!                                  loose, unless f may be an error;  departures that are free in form never below half, rough
//!                                  splines never below e^-(gap - 2)/8 / 2 of these
//! torus of both: its share goes to natural departures, where no simple shape is far ahead, and no departure is an error;
//!                where one may be an error, the torus of the interval's other reading does so, too
//! 1/40 < rms f / relief < 1/8, or < 1/2 where rms f < 2 x the scatter of single contacts,
//! P(neighbours share errors > rms f / 20) > 0.1,
//! and no measured normals that follow f:                  f is read as the sensor's systematic error, not as shape
//! ```
//!
//! So read, it is left out of the estimate where the rest is a simple shape, or where f is unlike natural departures. What
//! is neither plane, ball nor cylinder departs from two constant curvatures anyway, and f then is the likelier part of it.
//!
//! Below 1/40 a displacement cannot move R by more than some 5 %, so nothing is lost by reading it as shape. A sensor
//! whose single readings scatter may err as a whole by about as much; where a patch bends little, that is much of its
//! relief. Above both bounds a displacement is shape. It is shape too where many contacts show that neighbours share no
//! errors: a sensor that errs as a whole errs from contact to contact. Otherwise the contacts cannot tell shape from a
//! sensor's error, and the interval gives half to either reading; from 1/8 to 1/4 of the relief the share without
//! displacement fades to nothing. That a model's departure and an error cannot be told apart without knowledge from
//! elsewhere: J. Brynjarsdottir, A. O'Hagan, *Inverse Problems* 30 (2014) 114007.
//!
//! No shape is ever exactly a cylinder, so the displaced reading keeps a share even where the evidence is against it.
//! The likeliest smoothness follows the evidence, which weighs bias and noise alike; an interval that is centred on a
//! biased value misses the truth, so the interval's displaced surfaces are smoothed ten times less. P. Hall, *Ann.
//! Statist.* 20 (1992) 675.

use faer::Mat;

use crate::recognition::contacts::Neighbours;
use crate::recognition::dense;
use crate::recognition::departures::is_free;
use crate::recognition::equations::{Rows, column_of, first_of_displacement};
use crate::recognition::evidence::{Evidence, GROUPS, Node, highest, likeliest};
use crate::recognition::kinds::Kind;
use crate::recognition::statistics::{median, standard_deviation};

/// Sizes of f, relative to the relief, that are read as the sensor's error.
const SENSOR: [f64; 2] = [1.0 / 40.0, 1.0 / 8.0];

/// Multiple of the scatter of single contacts up to which a sensor may err as a whole, and the share of the relief
/// below which such an error must stay.
const OF_SCATTER: f64 = 2.0;
const MOST: f64 = 0.5;

/// A sensor that errs smoothly over the whole patch errs from contact to contact too: neighbours share errors of at
/// least this share of the smooth one. Where that has less than the second number in probability, a displacement is
/// shape, whatever its size.
const OF_DEPARTURE: f64 = 0.05;
const REFUTED: f64 = 0.1;

/// Share of either reading in the interval where the contacts cannot tell shape from a sensor's error.
const EITHER: f64 = 0.5;

/// Share of departures in the interval where they explain the contacts as well as any surface: most bodies are no plane, ball or bar. With
/// a half, shallow bumps and the crests of long waves, which 40 contacts cannot tell from a ball and a bar, have R inside in 42 and 33 of
/// 100 fits in place of 60 and 58; with 0.8 intervals of bars of 27 and 200 contacts are 5 and 13 % wider, 1.5 times the oracle's at most,
/// and 1.6 with 2,000.
const DEPARTED: f64 = 0.8;

/// Log evidence within which two readings count as equally good, and by which the share of the worse one falls to 1/e.
const ALIKE: f64 = 2.0;
const FADING: f64 = 8.0;

/// Log evidence by which a simple shape may be ahead of natural departures until their share of general's part falls to 1/e.
const SIMPLER: f64 = 4.0;

/// Least share of other displacements and of natural departures, where they are as likely, in what both have. Natural departures of
/// shallow patches are too small to be seen, so half of the share would be a doubt about nothing.
const OTHER: f64 = 0.25;

/// Share of a free smooth departure that counts with a prior ten times as loose. Its bias is smaller than a rough spline's, and draws
/// of either half miss the truth on either side: with all or none of it, S of a bump is inside in 5 to 10 of 100 fits fewer. Profiles
/// have few ways to bend, so that a loose prior costs them little width.
const LOOSER: f64 = 0.5;

/// Log likelihood of the normals for every cell, and log evidence of everything, by which a displaced surface has to be ahead
/// of the plain ones before it is shape whatever its size: a sensor that errs in its positions does not tilt normals that
/// were measured on their own. A sensor may tilt all normals by as large a multiple of their scatter as it may displace
/// positions ([`OF_SCATTER`]); half the square of that is 2. The normals of a tactile image are slopes of its own heights,
/// so they follow its errors: 1 for each of 29 normals of a touched ball. Normals with a scatter of 0.5 degrees are ahead by
/// 10 to 31 on tori and bumps, and by 0.2 to 1.5 with 3 degrees.
///
/// A tactile image displaces its contacts by many times what neighbours differ by (22 times on that ball). A departure below
/// [`OF_SCATTER`] is no such error, and normals that are ahead by the second number all together show that it is shape. Of 120
/// objects that were touched at 441 places each, 91 had S and R right without that, and 101 with it
/// (`benches/runs/explore.md`).
const BY_NORMALS: f64 = 0.5 * OF_SCATTER * OF_SCATTER;
const BY_ALL: f64 = 8.0;

/// Least share of general and of displaced in the interval.
const DOUBT: f64 = 0.1;

/// Least share of torus and of paraboloid within general's part of the interval, when they fit equally well.
const REFERENCE: f64 = 0.25;

/// Factor of misfit within which the two references count as equally good.
const AS_GOOD: f64 = 1.5;

/// Factor of misfit within which a simple shape cannot be excluded when the misfit is the sensor's.
const SIMPLE: f64 = 2.0;

/// Weights of all nodes.
#[derive(Clone, Debug, Default)]
pub(in crate::recognition) struct Weights {
    /// Of the estimate.
    pub(super) estimate: Vec<f64>,
    /// Of the interval.
    pub(super) interval: Vec<f64>,
    /// Posterior probability of a displacement.
    pub(super) displaced: f64,
    /// Its root mean square relative to the relief; 0 where it is too improbable to matter.
    pub(super) size: f64,
    /// The same relative to the scatter of single contacts.
    pub(super) of_scatter: f64,
    /// Posterior probability, among displaced surfaces, that neighbours share errors of at least a tenth of it.
    pub(super) shared: f64,
    /// Log evidence by which a displaced surface is ahead.
    pub(super) gap: f64,
    /// Log likelihood by which all normals prefer the displaced surface.
    pub(in crate::recognition) normals: f64,
    /// Number of cells.
    cells: f64,
    /// Whether the estimate takes the displacement for shape although it may be the sensor's error.
    pub(super) taken_for_shape: bool,
}

impl Weights {
    /// Whether the displacement is the sensor's error rather than shape.
    pub(super) fn displacement_is_error(&self) -> bool {
        let small = self.size < SENSOR[1] || (self.size < MOST && self.of_scatter < OF_SCATTER);
        SENSOR[0] < self.size && small && self.may_be_error()
    }

    /// Whether the interval has a share of surfaces without the displacement, because that may be the sensor's error.
    pub(in crate::recognition) fn displacement_may_be_error(&self) -> bool {
        self.displacement_is_error() || (self.may_be_error() && self.size < 2.0 * SENSOR[1])
    }

    /// Whether errors that neighbours share are large enough for a sensor that errs as a whole, and no normals say that the
    /// displacement is shape.
    fn may_be_error(&self) -> bool {
        let every_one = self.normals > BY_NORMALS * self.cells;
        let together = self.normals > BY_ALL && self.of_scatter < OF_SCATTER;
        let confirmed = (every_one || together) && self.gap > BY_ALL;
        self.shared > REFUTED && !confirmed
    }
}

/// Weighs the nodes; `misfit` is the root mean square distance of a kind's fit.
pub(in crate::recognition) fn weigh(
    evidence: &Evidence,
    rows: &Rows,
    nodes: &[Node],
    relief: f64,
    contacts_per_cell: f64,
    misfit: impl Fn(Kind) -> f64,
) -> Weights {
    let mut estimate = shares(nodes, |_| true);
    let displaced = total(&estimate, nodes, |n| n.is_displaced());
    let mut weights = Weights { displaced, ..Weights::default() };
    if displaced > 0.05 {
        let departure = displacement_size(evidence, rows, nodes, &estimate).unwrap_or(0.0);
        weights.size = departure / relief;
        weights.of_scatter = departure / scatter(nodes, &estimate, contacts_per_cell);
        weights.shared = shared(evidence, nodes, &estimate, OF_DEPARTURE * departure) / displaced;
    }
    weights.gap = best(nodes, |n| n.is_displaced()) - best(nodes, |n| !n.is_displaced());
    weights.normals = normals_gain(evidence, nodes).unwrap_or(0.0);
    weights.cells = evidence.cells.points.len() as f64;
    let by_evidence = estimate.clone();
    let error = weights.displacement_is_error();
    if error {
        estimate = shares(nodes, |n| !n.is_displaced());
    }
    weights.interval = with_doubt(nodes, &estimate, error, &misfit);
    if !error {
        departed(nodes, &mut estimate);
    }
    if error && displaced > 0.5 {
        keep_simple(&mut weights.interval, nodes, &misfit);
    }
    // the bound on a sensor's error is not a sharp one: above it the reading as an error fades instead of ending
    let fading = EITHER * (2.0 - weights.size / SENSOR[1]);
    let plain = |n: &Node| !n.is_displaced();
    if !error && weights.may_be_error() && displaced > 0.5 && fading > total(&weights.interval, nodes, plain) {
        raise(&mut weights.interval, nodes, plain, |_| true, fading.min(EITHER));
        departed(nodes, &mut weights.interval);
    }
    weights.taken_for_shape = error && departs_naturally(nodes, &estimate);
    weights.estimate = if weights.taken_for_shape { by_evidence } else { estimate };
    weights
}

/// Gives sphere and cylinder, where they misfit little more than the general surface, their least share of the interval.
fn keep_simple(interval: &mut [f64], nodes: &[Node], misfit: impl Fn(Kind) -> f64) {
    for kind in [Kind::Sphere, Kind::Cylinder] {
        let here = |n: &Node| n.kind == kind;
        if misfit(kind) <= SIMPLE * misfit(Kind::General) && total(interval, nodes, here) < DOUBT {
            raise(interval, nodes, here, |_| true, DOUBT);
        }
    }
}

/// Whether the rest is no simple shape under these weights of plain nodes, and natural departures explain the contacts about as
/// well as any displacement does that is free in form.
fn departs_naturally(nodes: &[Node], plain: &[f64]) -> bool {
    let simple = total(plain, nodes, |n| n.group() == 0);
    let free = |n: &Node| n.departure.process().is_none_or(is_free);
    simple < 0.5 && best(nodes, |n| n.is_natural()) > best(nodes, free) - BY_ALL
}

/// Shares in proportion to the evidence among the nodes chosen, 0 elsewhere; all 0 when none is chosen.
fn shares(nodes: &[Node], chosen: impl Fn(&Node) -> bool) -> Vec<f64> {
    let largest = highest(nodes.iter().filter(|n| chosen(n)));
    let mut out: Vec<f64> =
        nodes.iter().map(|n| if chosen(n) { (n.log_evidence - largest).exp() } else { 0.0 }).collect();
    let sum: f64 = out.iter().sum();
    if sum > 0.0 {
        out.iter_mut().for_each(|w| *w /= sum);
    }
    out
}

/// Sum of the weights of the nodes chosen.
pub(super) fn total(weights: &[f64], nodes: &[Node], chosen: impl Fn(&Node) -> bool) -> f64 {
    weights.iter().zip(nodes).filter(|(_, n)| chosen(n)).map(|(w, _)| w).sum()
}

/// Gives the nodes chosen the share `to` of what the nodes `within` have, in proportion to their evidence.
fn raise(weights: &mut [f64], nodes: &[Node], chosen: impl Fn(&Node) -> bool, within: impl Fn(&Node) -> bool, to: f64) {
    let all = total(weights, nodes, &within);
    let others = all - total(weights, nodes, &chosen);
    let fresh = shares(nodes, &chosen);
    if fresh.iter().sum::<f64>() == 0.0 {
        return;
    }
    for ((w, node), fresh) in weights.iter_mut().zip(nodes).zip(fresh) {
        if chosen(node) {
            *w = to * all * fresh;
        } else if within(node) && others > 0.0 {
            *w *= (1.0 - to) * all / others;
        }
    }
}

/// Log likelihood by which the likeliest displaced surface explains the normals better than the likeliest plain one.
fn normals_gain(evidence: &Evidence, nodes: &[Node]) -> Option<f64> {
    let best = |displaced: bool| {
        let own = nodes.iter().filter(|n| n.is_displaced() == displaced);
        likeliest(own)
    };
    let [plain, displaced] = [false, true].map(|d| evidence.misfit_of_normals(best(d)?));
    Some(plain? - displaced?)
}

/// Weight of the displaced nodes under which neighbours share errors of at least `size`.
fn shared(evidence: &Evidence, nodes: &[Node], weights: &[f64], size: f64) -> f64 {
    let tree = Neighbours::new(&evidence.cells.feet);
    let apart = (0..evidence.cells.feet.len()).filter_map(|i| tree.nearest_other(i).map(|(d, _)| d)).collect();
    let apart = median(apart);
    total(weights, nodes, |n| n.is_displaced() && n.tau() * (-0.5 * apart / n.length).exp() > size)
}

/// Share of a reading whose log evidence lies `gap` below the best: `most` where it is as good, fading slowly, because
/// no prior of shapes is known that well.
fn doubt(most: f64, gap: f64) -> f64 {
    most * (-(gap - ALIKE).max(0.0) / FADING).exp()
}

/// Standard deviation of a single contact's independent error under the likeliest displaced node.
fn scatter(nodes: &[Node], weights: &[f64], contacts_per_cell: f64) -> f64 {
    let displaced = nodes.iter().zip(weights).filter(|(n, _)| n.is_displaced());
    let best = displaced.max_by(|a, b| a.1.total_cmp(b.1));
    best.map_or(0.0, |(node, _)| (node.variance * contacts_per_cell).sqrt()).max(f64::MIN_POSITIVE)
}

/// Shares of the displaced nodes, passed on to the node of the same kernel whose prior is ten times as loose.
fn undersmoothed(nodes: &[Node]) -> Vec<f64> {
    let plain = shares(nodes, |n| n.group() == 2);
    let mut out = plain.clone();
    for (i, node) in nodes.iter().enumerate().filter(|(_, n)| n.group() == 2) {
        // the sizes of a prior follow each other
        let next = nodes.get(i + 1).filter(|next| next.kernel == node.kernel && next.departure.is_like(node.departure));
        if next.is_some() {
            let passed = plain[i] * if node.departure.process().is_some_and(is_free) { LOOSER } else { 1.0 };
            out[i] -= passed;
            out[i + 1] += passed;
        }
    }
    out
}

/// Gives departures that are free in form half of what displacements have: no body is exactly a profile that was drawn or turned.
fn with_free(mut shares: Vec<f64>, nodes: &[Node]) -> Vec<f64> {
    let displaced = |n: &Node| n.group() == 2;
    let free = |n: &Node| displaced(n) && n.departure.process().is_none_or(is_free);
    if total(&shares, nodes, free) < EITHER * total(&shares, nodes, displaced) {
        raise(&mut shares, nodes, free, displaced, EITHER);
    }
    shares
}

/// Gives rough splines their least share of what displacements have: a surface need not be smooth in all its derivatives.
fn with_rough(mut shares: Vec<f64>, nodes: &[Node]) -> Vec<f64> {
    let displaced = |n: &Node| n.group() == 2;
    let is_rough = |n: &Node| displaced(n) && !n.departure.is_smooth();
    let least = doubt(EITHER, best(nodes, displaced) - best(nodes, is_rough));
    if total(&shares, nodes, is_rough) < least {
        raise(&mut shares, nodes, is_rough, displaced, least);
    }
    shares
}

/// Weights of the interval; `error` says that a displacement was read as the sensor's error.
fn with_doubt(nodes: &[Node], estimate: &[f64], error: bool, misfit: impl Fn(Kind) -> f64) -> Vec<f64> {
    let groups: [Vec<f64>; GROUPS] = std::array::from_fn(|j| shares(nodes, |n| n.group() == j));
    let looser = if error { groups[2].clone() } else { undersmoothed(nodes) };
    let rougher = with_rough(with_free(looser, nodes), nodes);
    let wanted = group_shares(nodes, estimate, error);
    let mut out = vec![0.0; nodes.len()];
    for (wanted, fresh) in wanted.into_iter().zip([&groups[0], &groups[1], &rougher, &groups[3]]) {
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
        let least = doubt(REFERENCE, best(nodes, within) - best(nodes, here));
        if own <= AS_GOOD * other && total(&out, nodes, here) < least * total(&out, nodes, within) {
            raise(&mut out, nodes, here, within, least);
        }
    }
    if !error {
        departed(nodes, &mut out);
    }
    out
}

/// Shares of the groups in the interval.
fn group_shares(nodes: &[Node], estimate: &[f64], error: bool) -> [f64; GROUPS] {
    let sums: [f64; GROUPS] = std::array::from_fn(|j| total(estimate, nodes, |n| n.group() == j));
    let best_of = |j: usize| best(nodes, |n| n.group() == j);
    let any = sums[2] + sums[3];
    let best_of_any = best_of(2).max(best_of(3));
    let gap = best(nodes, |_| true) - best_of_any;
    let both = any.max(if error { EITHER } else { doubt(DEPARTED, gap) }).max(DOUBT);
    let general = if any < 0.5 { (sums[1] + any - both).max(DOUBT) } else { sums[1].min(1.0 - both) };
    let simple = if sums[0] > 0.0 { (1.0 - general - both).max(0.0) } else { 0.0 };
    // either kind of displacement keeps a part of what both have
    let share = if any > 0.0 { sums[3] / any } else { 0.0 };
    let [other, natural] = [2, 3].map(|j| doubt(OTHER, best_of_any - best_of(j)));
    let natural = both * share.max(natural).min(1.0 - other);
    [simple, general, both - natural, natural]
}

/// Passes the torus's share to natural departures, because no surface has two constant curvatures that differ, but for
/// cylinders. Where a simple shape explains the contacts far better, the torus keeps it: it then repeats that shape.
fn departed(nodes: &[Node], weights: &mut [f64]) {
    let is_torus = |n: &Node| n.kind == Kind::General && n.group() == 1;
    let (torus, fresh) = (total(weights, nodes, is_torus), shares(nodes, |n| n.is_natural()));
    if torus == 0.0 || fresh.iter().sum::<f64>() == 0.0 {
        return;
    }
    let gap = best(nodes, |n| n.group() == 0) - best(nodes, |n| n.is_natural());
    let passed = (-(gap - ALIKE).max(0.0) / SIMPLER).exp();
    for ((w, node), fresh) in weights.iter_mut().zip(nodes).zip(fresh) {
        if is_torus(node) {
            *w *= 1.0 - passed;
        }
        *w += passed * torus * fresh;
    }
}

/// Largest log evidence among the nodes chosen.
fn best(nodes: &[Node], chosen: impl Fn(&Node) -> bool) -> f64 {
    highest(nodes.iter().filter(|n| chosen(n)))
}

/// Root mean square of the likeliest displacement over the cells, without what the general surface could take up.
fn displacement_size(evidence: &Evidence, rows: &Rows, nodes: &[Node], weights: &[f64]) -> Option<f64> {
    let displaced = nodes.iter().zip(weights).filter(|(n, _)| n.is_displaced());
    let (node, _) = displaced.max_by(|a, b| a.1.total_cmp(b.1))?;
    let (mean, _) = evidence.joint_posterior(node)?;
    let (p, z, y) = (node.kind.unknowns(), first_of_displacement(), column_of(node.kind));
    let along_columns = evidence.weights_of(node, &mean[p..]);
    let n = rows.positions.nrows();
    let mut f: Vec<f64> = (0..n)
        .map(|i| along_columns.iter().enumerate().map(|(j, w)| rows.positions[(i, z + j)] * w).sum::<f64>())
        .collect();
    let column = |i: usize, j: usize| rows.positions[(i, y + 1 + j)];
    let normal = Mat::from_fn(p, p, |a, b| (0..n).map(|i| column(i, a) * column(i, b)).sum());
    let mut along: Vec<f64> = (0..p).map(|a| (0..n).map(|i| column(i, a) * f[i]).sum()).collect();
    dense::solve(&dense::cholesky(&normal)?, &mut along);
    (0..n).for_each(|i| f[i] -= (0..p).map(|a| column(i, a) * along[a]).sum::<f64>());
    Some(standard_deviation(&f))
}
