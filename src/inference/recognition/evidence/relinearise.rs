//! The second look, where a displacement is likely: equations about the displaced surface instead of the plain one.
//!
//! ```text
//! theta <- theta + x of the likeliest displaced node        the terms x^2 and x f, left out by the first look, vanish
//! f = natural departure + spline                            where the first look has a spline alone
//! normals scatter about n(theta) - grad f                   not about the plain surface, whose misfit is no noise
//! s_n <-> f                                                 in turns, about the moved surface
//! again, until k1 and k2 stay                               the first look's likeliest departure need not be the last one's
//! ```
//!
//! Steps of Gauss and Newton. A displacement f itself enters the distances exactly.

use faer::Mat;

use crate::dense;
use crate::recognition::discrepancy::{Body, Forms, State};
use crate::recognition::equations::{Moved, Rows, slopes};
use crate::recognition::kinds::Model;
use crate::recognition::noise::NormalNoise;

use super::linearised::Linearised;
use super::marginal_likelihood::Evidence;
use super::node::{Node, highest, likeliest};
use super::search_context::SearchContext;

/// Share of the equations that are normals': two rows of three.
const OF_NORMALS: f64 = 2.0 / 3.0;

/// Rounds in which displacement and noise of the normals find each other, and the change of that noise's variance at which
/// they have.
const ROUNDS: usize = 12;
const SETTLED: f64 = 0.1;

/// Change of a curvature, in units of the patch, below which the equations need not be placed again: at the edges its square moves the
/// surface by some `k dk^2`, which is a hundredth of the scatter of precise contacts.
const NEAR: f64 = 0.005;

/// The same for the numbers that say a body's form, whose square moves the surface by some `k^2 dp^2 / 8`.
const NEAR_FORM: f64 = 0.03;

/// The move under the likeliest displaced node, with a natural departure beside its spline; `None` where displacements are unlikely.
pub(crate) fn moved(plain: &Linearised, nodes: &[Node], at: SearchContext) -> Option<Moved> {
    let largest = highest(nodes);
    let share = |chosen: &dyn Fn(&Node) -> bool| {
        nodes.iter().filter(|n| chosen(n)).map(|n| (n.log_evidence - largest).exp()).sum::<f64>()
    };
    if share(&|n| n.is_displaced()) < at.tuning.second_look * share(&|_| true) {
        return None;
    }
    let (evidence, nodes) = Evidence::under(at, plain, displaced(nodes)?.kernel);
    under_likeliest(&evidence, &plain.rows, &nodes)
}

/// The likeliest displaced node.
fn displaced(nodes: &[Node]) -> Option<&Node> {
    likeliest(nodes.iter().filter(|n| n.is_displaced()))
}

/// The second look of whoever believes the normals, and the largest log evidence under it; `None` where the first reading has no
/// errors of normals that neighbours share.
///
/// The errors of normals are found about the plain surface. Where that is not the true one, normals differ from it alike
/// wherever contacts lie close to each other, as along the path of a finger, and such a difference passes for an error that
/// neighbours share. No displacement is likely then, and the errors are never asked again. Which of the two readings is right is
/// told by their evidence.
pub(super) fn with_normals_believed(
    chosen: &Linearised,
    plain: &Linearised,
    at: SearchContext,
) -> Option<(Linearised, f64)> {
    chosen.normal_noise.filter(|noise| noise.is_shared())?;
    let start = plain.with_normals_believed(at.factors)?;
    let (evidence, nodes) = Evidence::under(at, &start, 0);
    let moved = under_likeliest(&evidence, &start.rows, &nodes)?;
    let made = taken(&start, &moved, at)?;
    let (_, nodes) = Evidence::under(at, &made, moved.kernel);
    let log_evidence = highest(&nodes) + made.log_share();
    Some((made, log_evidence))
}

/// The equations about the moved surface; `None` where that has no chart to depart from. The displacement was found over the chart
/// of another surface, and normals that scatter about it seem noisier than they are. Displacement and noise are therefore found
/// again, in turns, under the covariance of positions that was the likeliest, and the equations are placed again where the curvatures
/// move.
pub(super) fn taken(plain: &Linearised, moved: &Moved, at: SearchContext) -> Option<Linearised> {
    let SearchContext { cells, contacts, factors, tuning, .. } = at;
    let mut made = plain.about(moved, cells, contacts, factors)?;
    let (mut base, mut forms) = (moved.base.clone(), moved.forms);
    for _ in 0..ROUNDS {
        let (evidence, nodes) = Evidence::under(at, &made, moved.kernel);
        let Some(again) = under_likeliest(&evidence, &made.rows, &nodes) else { break };
        let within = if displaced(&nodes).is_some_and(Node::is_body) { tuning.nearer_body } else { 1.0 };
        let stays = is_near(&again.base, &base, within) && are_near(&again.forms, &forms, within);
        let before = made.normal_noise;
        if stays {
            made.scatter_about(&again, cells, factors);
        } else if let Some(next) = plain.about(&again, cells, contacts, factors) {
            made = next;
            (base, forms) = (again.base, again.forms);
        } else {
            break;
        }
        let settled = |(a, b): (NormalNoise, NormalNoise)| (a.variance / b.variance - 1.0).abs() < SETTLED;
        if stays && made.normal_noise.zip(before).is_none_or(settled) {
            break;
        }
    }
    Some(made)
}

/// Whether a step from one model to the other is so short that its square does not count.
fn is_near(one: &Model, other: &Model, within: f64) -> bool {
    let (a, b) = (one.theta(), other.theta());
    // a plane bends as it did, but a tilt moves what stands on it
    let watched = if one.is_flat() { 1..3 } else { 3..5 };
    watched.into_iter().all(|i| (a[i] - b[i]).abs() < within * NEAR)
}

/// Whether bodies are linear enough about these forms.
fn are_near(some: &Forms, others: &Forms, within: f64) -> bool {
    some.as_flattened().iter().zip(others.as_flattened()).all(|(a, b)| (a - b).abs() < within * NEAR_FORM)
}

/// The general surface that departures stand on after a step: a plane stays one.
fn base_after(model: &Model, x: &[f64]) -> Model {
    let theta = model.theta();
    match model.is_flat() {
        true => Model::new(model.kind(), [theta[0] + x[0], theta[1] + x[1], theta[2] + x[2], 0.0, 0.0, theta[5]]),
        false => State::new(model, x, None).model().clone(),
    }
}

/// The forms in which bodies are nearest to the general surface under a displacement whose columns have these weights. A body that was
/// already asked in another form than none, and is far behind, keeps it.
fn nearest_forms(evidence: &Evidence, nodes: &[Node], model: &Model, weights: &[f64]) -> Forms {
    let (Model::Constant(_, surface), Some(displacement)) = (model, evidence.displacement) else {
        return Forms::default();
    };
    let best = highest(nodes);
    let has_chance = |body: Body| {
        let own = highest(nodes.iter().filter(|n| n.departure.body() == Some(body)));
        own > best - evidence.tuning.hopeless_form || displacement.forms[body.number()] == [0.0; 3]
    };
    let charts: Vec<[f64; 2]> = evidence.cells.points.iter().map(|p| surface.chart(*p)).collect();
    displacement.nearest_forms(surface, &charts, &displacement.coefficients(weights), has_chance)
}

/// The move under the likeliest displaced node.
pub(super) fn under_likeliest(evidence: &Evidence, rows: &Rows, nodes: &[Node]) -> Option<Moved> {
    let best = displaced(nodes)?;
    let model = evidence.models.iter().find(|m| m.kind() == best.kind)?;
    let (mean, lower) = evidence.joint_posterior(best)?;
    let (x, z) = mean.split_at(best.kind.unknowns());
    let weights = evidence.weights_of(best, z);
    let mut inverse = Mat::<f64>::identity(mean.len(), mean.len());
    dense::whiten(&lower, inverse.as_mut());
    // the prior's precision is 1: what the data do not tell stays at variance 1
    let untold: f64 =
        (x.len()..mean.len()).map(|j| (0..mean.len()).map(|i| inverse[(i, j)] * inverse[(i, j)]).sum::<f64>()).sum();
    Some(Moved {
        base: base_after(model, x),
        slopes: slopes(rows, &weights, model, x),
        spent: OF_NORMALS * (z.len() as f64 - untold),
        kernel: best.kernel,
        forms: nearest_forms(evidence, nodes, model, &weights),
    })
}
