//! Weights of the hypotheses: those of the estimate follow from the evidence, those of the interval leave room for
//! doubt.
//!
//! ```text
//! w ~ exp(log evidence)                                   the estimate
//! v                                                       the interval and the classes: `interval_weights.rs`
//! 1/40 < rms f / relief < 1/8, or < 1/2 where rms f < 2 x the scatter of single contacts,
//! P(neighbours share errors > rms f / 20) > 0.1,
//! and no measured normals that follow f:                  f is read as the sensor's systematic error, not as shape
//! ```
//!
//! So read, it is left out of the estimate where the rest is a simple shape, or where f is unlike natural departures and bodies. What
//! is neither plane, ball nor cylinder departs from two constant curvatures anyway, and f then is the likelier part of it.
//!
//! Below 1/40 a displacement cannot move R by more than some 5 %, so nothing is lost by reading it as shape. A sensor
//! whose single readings scatter may err as a whole by about as much; where a patch bends little, that is much of its
//! relief. Above both bounds a displacement is shape. It is shape too where many contacts show that neighbours share no
//! errors: a sensor that errs as a whole errs from contact to contact. Otherwise the contacts cannot tell shape from a
//! sensor's error, and the interval gives half to either reading; from 1/8 to 1/4 of the relief the share without
//! displacement fades to nothing. That a model's departure and an error cannot be told apart without knowledge from
//! elsewhere: J. Brynjarsdottir, A. O'Hagan, *Inverse Problems* 30 (2014) 114007.

use faer::Mat;

use crate::bodies::Tuning;
use crate::dense;
use crate::recognition::discrepancy::{Body, is_free};
use crate::recognition::equations::{Rows, column_of, first_of_displacement};
use crate::recognition::evidence::{Evidence, Node, likeliest};
use crate::recognition::kinds::Kind;
use palpate_geometry::neighbours::Neighbours;
use palpate_numeric::statistics::{median, standard_deviation};

use super::interval_weights::{Doubt, departed, keep_simple, with_doubt};
use super::normalised_weights::{best, raise, shares, total};

/// Weights of all nodes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Weights {
    /// Of the estimate.
    pub(super) estimate: Vec<f64>,
    /// Of the interval.
    pub(super) interval: Vec<f64>,
    /// Of the classes.
    pub(super) class: Vec<f64>,
    /// Of bodies whose intervals of R are held as if each were alone: within a body, 1 in all; 0 elsewhere.
    pub(super) heard: Vec<f64>,
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
    pub(crate) normals: f64,
    /// Number of cells.
    cells: f64,
    /// Whether the estimate takes the displacement for shape although it may be the sensor's error.
    pub(super) taken_for_shape: bool,
    tuning: Tuning,
}

impl Weights {
    /// Whether the displacement is the sensor's error rather than shape.
    pub(super) fn displacement_is_error(&self) -> bool {
        let Tuning { sensor_departs: [least, most], sensor_of_relief, sensor_over_scatter, .. } = self.tuning;
        let small = self.size < most || (self.size < sensor_of_relief && self.of_scatter < sensor_over_scatter);
        least < self.size && small && self.may_be_error()
    }

    /// Whether the interval has a share of surfaces without the displacement, because that may be the sensor's error.
    pub(crate) fn displacement_may_be_error(&self) -> bool {
        self.displacement_is_error() || (self.may_be_error() && self.size < 2.0 * self.tuning.sensor_departs[1])
    }

    /// Leaves room for the other reading, of a displacement as shape or as the sensor's error.
    fn between_readings(&self, nodes: &[Node], out: &mut [f64], doubt: Doubt, misfit: impl Fn(Kind) -> f64) {
        if self.displaced <= 0.5 {
            return;
        }
        if self.displacement_is_error() {
            keep_simple(out, nodes, doubt, misfit);
            return;
        }
        // the bound on a sensor's error is not a sharp one: above it the reading as an error fades instead of ending
        let either = self.tuning.either_reading;
        let fading = either * (2.0 - self.size / self.tuning.sensor_departs[1]);
        let plain = |n: &Node| !n.is_displaced();
        if self.may_be_error() && fading > total(out, nodes, plain) {
            raise(out, nodes, plain, |_| true, fading.min(either));
            departed(nodes, out, &self.tuning);
        }
    }

    /// Whether errors that neighbours share are large enough for a sensor that errs as a whole, and no normals say that the
    /// displacement is shape.
    fn may_be_error(&self) -> bool {
        let Tuning { sensor_over_scatter: multiple, departure_ahead: ahead, .. } = self.tuning;
        // a sensor may tilt normals by as large a multiple of their scatter as it displaces positions by
        let every_one = self.normals > 0.5 * multiple * multiple * self.cells;
        // it displaces contacts by many times what neighbours differ by: 22 times on a ball
        let together = self.normals > ahead && self.of_scatter < multiple;
        let confirmed = (every_one || together) && self.gap > ahead;
        self.shared > self.tuning.shared_refuted && !confirmed
    }
}

/// Weighs the nodes; `misfit` is the root mean square distance of a kind's fit.
pub(crate) fn weigh(
    evidence: &Evidence,
    rows: &Rows,
    nodes: &[Node],
    relief: f64,
    contacts_per_cell: f64,
    misfit: impl Fn(Kind) -> f64,
    tuning: &Tuning,
) -> Weights {
    let mut estimate = shares(nodes, |_| true);
    let displaced = total(&estimate, nodes, |n| n.is_displaced());
    let mut weights = Weights { displaced, tuning: tuning.clone(), ..Weights::default() };
    if displaced > 0.05 {
        let departure = displacement_size(evidence, rows, nodes, &estimate).unwrap_or(0.0);
        weights.size = departure / relief;
        weights.of_scatter = departure / scatter(nodes, &estimate, contacts_per_cell);
        weights.shared = shared(evidence, nodes, &estimate, tuning.shared_of_departure * departure) / displaced;
    }
    weights.gap = best(nodes, |n| n.is_displaced()) - best(nodes, |n| !n.is_displaced());
    weights.normals = normals_gain(evidence, nodes).unwrap_or(0.0);
    weights.cells = evidence.cells.points.len() as f64;
    let by_evidence = estimate.clone();
    let error = weights.displacement_is_error();
    if error {
        estimate = shares(nodes, |n| !n.is_displaced());
    }
    weights.taken_for_shape = error && departs_naturally(nodes, &estimate, tuning);
    let doubted = |doubt: Doubt| {
        let mut out = with_doubt(nodes, &estimate, error, doubt, &misfit);
        weights.between_readings(nodes, &mut out, doubt, &misfit);
        out
    };
    // evidence does not tell an error of the sensor from shape, and what is read as one keeps the room that classes have
    let of_interval = if error && !weights.taken_for_shape { Doubt::of_class } else { Doubt::of_interval };
    let [interval, class] = [of_interval(tuning), Doubt::of_class(tuning)].map(doubted);
    (weights.interval, weights.class) = (interval, class);
    if !error {
        departed(nodes, &mut estimate, tuning);
    }
    weights.heard = heard(nodes, if weights.taken_for_shape { &by_evidence } else { &estimate }, tuning);
    weights.estimate = if weights.taken_for_shape { by_evidence } else { estimate };
    weights
}

/// Shares within every body that is as likely as the likeliest one to within `departure_ahead`, where bodies have a good part of the estimate: a ring
/// and an ellipsoid that no contact tells apart differ in R by some per cent, and which of them has fewer numbers says little.
fn heard(nodes: &[Node], estimate: &[f64], tuning: &Tuning) -> Vec<f64> {
    let mut out = vec![0.0; nodes.len()];
    if total(estimate, nodes, Node::is_body) < tuning.heard {
        return out;
    }
    let likeliest = best(nodes, Node::is_body);
    for body in Body::ALL {
        let own = |n: &Node| n.departure.body() == Some(body);
        if best(nodes, own) > likeliest - tuning.departure_ahead {
            out.iter_mut().zip(shares(nodes, own)).for_each(|(out, share)| *out += share);
        }
    }
    out
}

/// Whether the rest is no simple shape under these weights of plain nodes, and natural departures explain the contacts about as
/// well as any displacement does that is free in form; or a body of a few numbers more explains them best of all, and clearly better than
/// whatever does not depart.
fn departs_naturally(nodes: &[Node], plain: &[f64], tuning: &Tuning) -> bool {
    let simple = total(plain, nodes, |n| n.group() == 0);
    let body = best(nodes, Node::is_body);
    let rivals = [
        best(nodes, |n| !n.is_displaced()) + tuning.departure_ahead,
        best(nodes, |n| n.is_displaced() && !n.is_body()),
    ];
    let is_body = rivals.into_iter().all(|rival| body > rival);
    let free = |n: &Node| n.departure.process().is_none_or(is_free);
    simple < 0.5 && (is_body || best(nodes, Node::is_natural) > best(nodes, free) - tuning.departure_ahead)
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
    let apart = (0..evidence.cells.feet.len()).filter_map(|i| tree.nearest_other(i).map(|(d, _)| d));
    let apart = median(apart.collect::<Vec<f64>>()).unwrap_or(0.0);
    total(weights, nodes, |n| n.is_displaced() && n.tau() * (-0.5 * apart / n.length).exp() > size)
}

/// Standard deviation of a single contact's independent error under the likeliest displaced node.
fn scatter(nodes: &[Node], weights: &[f64], contacts_per_cell: f64) -> f64 {
    let displaced = nodes.iter().zip(weights).filter(|(n, _)| n.is_displaced());
    let best = displaced.max_by(|a, b| a.1.total_cmp(b.1));
    best.map_or(0.0, |(node, _)| (node.variance * contacts_per_cell).sqrt()).max(f64::MIN_POSITIVE)
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
