//! S and R with their intervals: weighted means of the likeliest surfaces, and quantiles of surfaces drawn at random.
//!
//! ```text
//! mean S = sum w_node (mean over supported points of S(x^))              R alike
//! draws  x ~ x^ + L'^-1 N(0, 1) sqrt(nu/chi2_nu),   H = L L'             displacement and parameters drawn together
//! interval = quantiles of the draws under v      u = half of it / z      u_noise^2 = variance without shared errors
//! ```
//!
//! The directions of k1 and k2 in the middle are drawn with the rest:
//!
//! ```text
//! within = quantile of arccos |d . d^| under v        d of the draws, d^ of the reported surface; 90 degrees where d is undefined
//! ```
//!
//! Curvatures are drawn as a Hessian, so |S| never exceeds 1, and the interval reaches +-1 when a sphere is possible.
//!
//! Where a displacement was read as the sensor's error, it is only the part of that error that no simple shape can
//! represent. The part that looks like curvature cannot be seen. It is drawn with the same size, relative to the
//! relief:
//!
//! ```text
//! Hessian += N(0, (size R)^2) in every coordinate      size = rms of the displacement / relief
//! ```

use faer::Mat;
use statrs::function::erf;

use crate::dense;
use crate::recognition::discrepancy::{ChartPoint, State};
use crate::recognition::evidence::{Evidence, Node};
use crate::recognition::kinds::Kind;
use crate::recognition::region::{Place, PosteriorDraws, PredictiveDraw, measured, predicted};
use crate::recognition::{Estimate, RecognitionOptions};
use palpate_geometry::curvature::ShapeClass;
use palpate_numeric::draws::EffectDraws;
use palpate_numeric::statistics::standard_deviation;
use palpate_numeric::threads;

use super::kept_draws::kept_draws;
use super::posterior_samples::{Drawn, ShapeQuantity, classes, interval_of, pointwise, within_deg};
use super::shape_means::{Field, Points};
use super::weights::Weights;

/// Least number of draws of a node, so that its own spread is known.
const FEWEST_DRAWS: usize = 4;

/// Weights below which a node is left out.
const NEGLIGIBLE: f64 = 1e-3;

/// Draws for the uncertainty without shared errors.
const NOISE_DRAWS: usize = 100;

/// Largest number of gaussians that are drawn at once.
const AT_ONCE: usize = 64;

/// What the draws tell.
#[derive(Clone, Debug)]
pub(super) struct Summary {
    /// `None` when only planes have weight.
    pub(super) shape_index: Option<Estimate>,
    pub(super) curvedness: Estimate,
    pub(super) k1: f64,
    pub(super) k2: f64,
    /// Shares of the classes, plane included, in the order of [`ShapeClass::CURVED`] and then plane.
    pub(super) classes: Vec<(ShapeClass, f64)>,
    /// Standard uncertainty of S, of R, of the place along the normal, of the normal (radians), of k1 and of k2 at every point asked for.
    pub(super) u: Vec<[f64; 6]>,
    /// The surface that is reported.
    pub(super) surface: State,
    /// Within how many degrees of the reported ones the directions of k1 and k2 lie, at the level of the intervals.
    pub(super) directions_within_deg: Option<[f64; 2]>,
    /// Draws with what touches would measure on them; empty where none was asked for.
    pub(super) predictive: Vec<PredictiveDraw>,
    /// Draws of all kinds over the points asked for.
    pub(super) draws: PosteriorDraws,
}

impl Summary {
    /// Moves means and intervals from the points that they were taken over to others, by what one surface shows of the
    /// difference.
    pub(super) fn move_to(&mut self, state: &State, from: &[ChartPoint], to: &[ChartPoint]) {
        let mean = |points: &[ChartPoint]| {
            Points { all: points, map: &[], within: None, middle: None, touched: &[] }.field(state)
        };
        let (from, to) = (mean(from), mean(to));
        if let Some(s) = &mut self.shape_index {
            s.moved(to.s - from.s, [-1.0, 1.0]);
        }
        self.curvedness.moved(to.r - from.r, [0.0, f64::INFINITY]);
        self.k1 += to.k[0] - from.k[0];
        self.k2 += to.k[1] - from.k[1];
    }
}

/// The likeliest surface of a node.
pub(super) fn likeliest(evidence: &Evidence, node: &Node) -> Option<State> {
    let model = evidence.models.iter().find(|m| m.kind() == node.kind)?;
    if !node.is_displaced() {
        return Some(State::new(model, &node.x, None));
    }
    let (mean, _) = evidence.joint_posterior(node)?;
    displaced(evidence, node, &mean)
}

fn displaced(evidence: &Evidence, node: &Node, joint: &[f64]) -> Option<State> {
    let model = evidence.models.iter().find(|m| m.kind() == node.kind)?;
    let (x, z) = joint.split_at(node.kind.unknowns());
    let weights = evidence.weights_of(node, z);
    Some(State::new(model, x, Some(evidence.displacement?.coefficients(&weights))))
}

/// Surfaces drawn from a node's posterior.
///
/// `hidden` is the standard deviation of a sensor's error in every coordinate of the Hessian.
fn drawn(
    evidence: &Evidence,
    (number, node): (usize, &Node),
    joint: Option<&(Vec<f64>, Mat<f64>)>,
    count: usize,
    seed: u64,
    hidden: f64,
) -> Vec<State> {
    let Some(model) = evidence.models.iter().find(|m| m.kind() == node.kind) else { return Vec::new() };
    let (mean, lower) = match joint {
        Some((mean, lower)) => (mean, lower),
        None => (&node.x, &node.precision),
    };
    let all = parameters((number, node), (mean, lower), count, seed, hidden);
    let own = |k: usize| &all.col_as_slice(k)[..node.kind.unknowns()];
    if joint.is_none() {
        return (0..count).map(|k| State::new(model, own(k), None)).collect();
    }
    let Some(splines) = evidence.splines_of(node, &all) else { return Vec::new() };
    (0..count).map(|k| State::new(model, own(k), Some(splines.col_as_slice(k).to_vec()))).collect()
}

/// Parameters drawn from a node's posterior, one surface a column; those of a displacement, in units of their prior, stand below.
fn parameters(
    (number, node): (usize, &Node),
    (mean, lower): (&[f64], &Mat<f64>),
    count: usize,
    seed: u64,
    hidden: f64,
) -> Mat<f64> {
    let draws = EffectDraws::new(seed, "recognition");
    /// Coordinates before those of the Hessian: height and tilt.
    const POSE: usize = 3;
    let (size, unknowns) = (mean.len(), node.kind.unknowns());
    let mut numbers = vec![0.0; size + 1 + unknowns.saturating_sub(POSE)];
    let mut all = Mat::<f64>::zeros(size, count);
    let mut last = Vec::with_capacity(count);
    for k in 0..count {
        for (block, part) in numbers.chunks_mut(AT_ONCE).enumerate() {
            draws.gaussians((number * 8 + block) as u64, k as u64, part.len(), part);
        }
        let (steps, rest) = numbers.split_at(size);
        all.col_as_slice_mut(k).copy_from_slice(steps);
        last.push(rest.to_vec());
    }
    dense::coloured(lower, all.as_mut());
    for (k, last) in last.iter().enumerate() {
        let column = all.col_as_slice_mut(k);
        let stretch = student(node.dof, last[0]);
        column.iter_mut().zip(mean).for_each(|(x, m)| *x = m + stretch * *x);
        column[..unknowns].iter_mut().skip(POSE).zip(&last[1..]).for_each(|(x, g)| *x += hidden * g);
    }
    all
}

/// `sqrt(nu/chi2_nu)` from a gaussian by the cube root that E. B. Wilson and M. M. Hilferty (1931) found nearly
/// gaussian.
fn student(nu: f64, gaussian: f64) -> f64 {
    let part = 2.0 / (9.0 * nu);
    (1.0 - part + gaussian * part.sqrt()).max(0.1).powf(-1.5)
}

/// Everything drawn, of every node that has weight.
fn all_drawn(
    evidence: &Evidence,
    nodes: &[Node],
    weights: &Weights,
    points: &Points,
    reference: &[Place],
    options: &RecognitionOptions,
    hidden: f64,
) -> Vec<Drawn> {
    let RecognitionOptions { seed, tuning, .. } = options;
    let [in_all, of_heard] = [tuning.draws, tuning.heard_draws].map(|count| count as f64);
    let touched = |draws: usize| predicted(draws, tuning.draws_touched);
    let counts = |weights: &[f64], i: usize| weights[i] > NEGLIGIBLE;
    let Weights { estimate, interval, class, heard, .. } = weights;
    let used: Vec<usize> =
        (0..nodes.len()).filter(|&i| [estimate, interval, class, heard].iter().any(|w| counts(w, i))).collect();
    let found = threads::map(used.len(), 1, |k| {
        let (i, node) = (used[k], &nodes[used[k]]);
        let wanted = (weights.interval[i] * in_all).max(weights.heard[i] * of_heard);
        let count = (wanted.round() as usize).max(FEWEST_DRAWS);
        let joint = if node.is_displaced() { evidence.joint_posterior(node) } else { None };
        let likeliest = match &joint {
            Some((mean, _)) => displaced(evidence, node, mean)?,
            None => likeliest(evidence, node)?,
        };
        let states = drawn(evidence, (i, node), joint.as_ref(), count, *seed, hidden);
        let draws = points.fields(&states);
        let likeliest = points.field(&likeliest);
        let asked = if points.touched.is_empty() { 0 } else { touched(states.len()) };
        let touches = states[..asked].iter().map(|state| measured(state, points.touched)).collect();
        let over_map = states[..touched(states.len())].iter().map(|state| measured(state, reference)).collect();
        Some(Drawn {
            kind: node.kind,
            hypothesis: node.hypothesis(),
            displaced: node.is_displaced() && !node.is_body(),
            smooth: node.departure.is_smooth(),
            natural: node.is_natural(),
            body: node.departure.body().map(|body| (body, weights.heard[i])),
            weights: [weights.estimate[i], weights.interval[i]],
            of_class: weights.class[i],
            likeliest,
            columns: joint.map(|(mean, _)| {
                let (x, z) = mean.split_at(node.kind.unknowns());
                (x.to_vec(), evidence.weights_of(node, z))
            }),
            draws,
            touches,
            over_map,
        })
    });
    found.into_iter().flatten().collect()
}

/// Estimates, intervals and class shares.
pub(super) fn summary(
    evidence: &Evidence,
    nodes: &[Node],
    weights: &Weights,
    reported: &Node,
    points: &Points,
    options: &RecognitionOptions,
) -> Option<Summary> {
    let state = likeliest(evidence, reported)?;
    let hidden = if weights.displacement_is_error() { weights.size * points.field(&state).r } else { 0.0 };
    let reference: Vec<Place> = points.map.iter().map(|point| Place::on(&state, point.clone())).collect();
    let found = all_drawn(evidence, nodes, weights, points, &reference, options, hidden);
    let surface = nearest_to_means(evidence, reported, state, &found, points);
    let (own, variation) = (points.field(&surface), points.variation(&surface));
    let noise = noise_alone(evidence, nodes, reported, points, options.seed);
    let level = options.level;
    let estimate = |pick: fn(&Field) -> f64, at: usize, curved: bool| {
        let chosen: Vec<&Drawn> = found.iter().filter(|d| !(curved && d.kind == Kind::Plane)).collect();
        let sum: f64 = chosen.iter().map(|d| d.weights[0]).sum();
        let mean = chosen.iter().map(|d| d.weights[0] * pick(&d.likeliest)).sum::<f64>() / sum;
        // S and R are not linear in the surface, and the mean of the draws may lie beside the likeliest value
        let quantity =
            if curved { ShapeQuantity::ShapeIndex } else { ShapeQuantity::Curvedness { heard: options.tuning.heard } };
        let [lo, hi] = interval_of(&chosen, pick, level, quantity)?;
        // rounding may put an end on the wrong side of an exact mean, which the interval would then miss
        let interval = [lo.min(mean), hi.max(mean)];
        let u = 0.5 * (interval[1] - interval[0]) / (std::f64::consts::SQRT_2 * erf::erf_inv(level));
        let u_noise = noise[at].min(u);
        let u_model = (u * u - u_noise * u_noise).max(0.0).sqrt();
        let sd = variation[at];
        mean.is_finite().then_some(Estimate { mean, sd, u_noise, u_model, u, interval, level, dof: reported.dof })
    };
    let mean_of = |k: usize| {
        let sum: f64 = found.iter().map(|d| d.weights[0]).sum();
        found.iter().map(|d| d.weights[0] * d.likeliest.k[k]).sum::<f64>() / sum
    };
    Some(Summary {
        shape_index: estimate(|f| f.s, 0, true),
        curvedness: estimate(|f| f.r, 1, false)?,
        k1: mean_of(0),
        k2: mean_of(1),
        // the class is as doubtful as the interval: a ball that needs large shared errors may be a bump
        classes: classes(&found),
        directions_within_deg: own.directions.and_then(|own| {
            let [first, second] = [0, 1].map(|k| within_deg(&found, own[k], k, level));
            first.zip(second).map(|(first, second)| [first, second])
        }),
        u: pointwise(&found, points.map.len()),
        draws: kept_draws(&found, &reference),
        predictive: predictive(found),
        surface,
    })
}

/// The likeliest surface, or the mean of all displaced ones, which are linear in the same columns: whichever shows S and R nearer to the
/// means that are said. The likeliest of several may lie beside them, and the mean of several bends less than any.
fn nearest_to_means(evidence: &Evidence, reported: &Node, likeliest: State, found: &[Drawn], points: &Points) -> State {
    let curved = || found.iter().filter(|d| d.kind != Kind::Plane);
    let sum: f64 = curved().map(|d| d.weights[0]).sum();
    let mean = |pick: fn(&Field) -> f64| curved().map(|d| d.weights[0] * pick(&d.likeliest)).sum::<f64>() / sum;
    let (s, r) = (mean(|f| f.s), mean(|f| f.r));
    let away = |state: &State| {
        let field = points.field(state);
        (field.s - s).abs() + (field.r / r - 1.0).abs()
    };
    match mean_surface(evidence, reported, found) {
        Some(mean) if away(&mean) < away(&likeliest) => mean,
        _ => likeliest,
    }
}

/// The mean of the displaced surfaces of the reported kind under the estimate's weights; `None` where none is reported.
fn mean_surface(evidence: &Evidence, reported: &Node, found: &[Drawn]) -> Option<State> {
    let displacement = evidence.displacement.filter(|_| reported.is_displaced())?;
    let model = evidence.models.iter().find(|m| m.kind() == reported.kind)?;
    let own = found.iter().filter(|d| d.kind == reported.kind);
    let own: Vec<_> = own.filter_map(|d| Some((d.weights[0], d.columns.as_ref()?))).collect();
    let sum: f64 = own.iter().map(|(w, _)| w).sum();
    let mut x = vec![0.0; reported.kind.unknowns()];
    let mut weights = vec![0.0; displacement.columns()];
    for (w, (step, columns)) in own {
        x.iter_mut().zip(step).for_each(|(x, step)| *x += w / sum * step);
        weights.iter_mut().zip(columns).for_each(|(weight, own)| *weight += w / sum * own);
    }
    Some(State::new(model, &x, Some(displacement.coefficients(&weights))))
}

/// The draws of curved surfaces that touches were predicted on, under the interval's weights.
fn predictive(found: Vec<Drawn>) -> Vec<PredictiveDraw> {
    let mut out: Vec<PredictiveDraw> = Vec::new();
    for drawn in found.into_iter().filter(|d| d.kind != Kind::Plane) {
        let share = drawn.weights[1] / drawn.touches.len().max(1) as f64;
        let pairs = drawn.draws.iter().zip(drawn.touches);
        out.extend(pairs.map(|(f, touches)| PredictiveDraw { share, shape: [f.s, f.r], touches }));
    }
    let sum: f64 = out.iter().map(|draw| draw.share).sum();
    out.iter_mut().for_each(|draw| draw.share /= sum);
    out
}

/// Standard deviations of mean S and mean R of the reported hypothesis were errors independent.
fn noise_alone(evidence: &Evidence, nodes: &[Node], reported: &Node, points: &Points, seed: u64) -> [f64; 2] {
    let alike = |n: &&(usize, &Node)| {
        n.1.kind == reported.kind && n.1.is_displaced() == reported.is_displaced() && n.1.ratio == 0.0
    };
    let numbered: Vec<(usize, &Node)> = nodes.iter().enumerate().collect();
    let best = numbered.iter().filter(alike).max_by(|a, b| a.1.log_evidence.total_cmp(&b.1.log_evidence));
    let Some((i, node)) = best else { return [0.0; 2] };
    let joint = if node.is_displaced() { evidence.joint_posterior(node) } else { None };
    let states = drawn(evidence, (*i, node), joint.as_ref(), NOISE_DRAWS, seed, 0.0);
    let fields = points.fields(&states);
    let sd = |pick: fn(&Field) -> f64| standard_deviation(&fields.iter().map(pick).collect::<Vec<_>>());
    [sd(|f| f.s), sd(|f| f.r)]
}
