//! What the surfaces drawn at random say: intervals, angles, shares of the classes and scatter at every point.
//!
//! ```text
//! quantile(p) = least value v with   sum of shares of draws <= v   >=   p sum of all shares
//! share of a draw = weight of its node / draws of the node
//! mirrored draw   = 2 likeliest - draw
//! ```

use crate::recognition::Hypothesis;
use crate::recognition::discrepancy::Body;
use crate::recognition::kinds::Kind;
use palpate_geometry::curvature::{ShapeClass, principal_curvatures};
use palpate_numeric::statistics::weighted_quantile;
use palpate_numeric::vector::{Vector, dot};

use super::shape_means::Field;

/// Everything drawn for one node.
pub(super) struct Drawn {
    pub(crate) kind: Kind,
    pub(super) hypothesis: Hypothesis,
    pub(super) displaced: bool,
    /// Whether it departs smoothly.
    pub(super) smooth: bool,
    /// Whether it departs naturally alone.
    pub(super) natural: bool,
    /// The body that it is, and the node's share of it where its interval of R is held as if it were alone.
    pub(super) body: Option<(Body, f64)>,
    /// Weights of the node in estimate and interval.
    pub(crate) weights: [f64; 2],
    /// Its weight in the shares of the classes.
    pub(super) of_class: f64,
    pub(super) likeliest: Field,
    /// Its likeliest surface where it is displaced: step of the model and weights of the displacement's columns.
    pub(crate) columns: Option<(Vec<f64>, Vec<f64>)>,
    pub(super) draws: Vec<Field>,
    /// What touches would measure on the first of the draws.
    pub(super) touches: Vec<Vec<[f64; 3]>>,
    /// Height over the reported surface and two slopes against it at every point of the map, of the first of the draws.
    pub(super) over_map: Vec<Vec<[f64; 3]>>,
}

/// Which draws count half as they are and half mirrored at the likeliest value of their node.
#[derive(Clone, Copy)]
enum Mirrored {
    None,
    /// Those of rough splines and natural departures.
    AllButSmooth,
    /// Those of all displaced surfaces.
    Displaced,
}

impl Mirrored {
    fn counts(self, drawn: &Drawn) -> bool {
        match self {
            Mirrored::None => false,
            Mirrored::AllButSmooth => drawn.displaced && !drawn.smooth,
            Mirrored::Displaced => drawn.displaced,
        }
    }
}

/// What an interval is of.
#[derive(Clone, Copy)]
pub(super) enum ShapeQuantity {
    ShapeIndex,
    /// With the share of natural departures in the estimate from which on the interval holds theirs.
    Curvedness {
        heard: f64,
    },
}

/// The interval of S or of R. Noise bends a displaced surface more and pulls its k1 and k2 apart: draws of R lie
/// above the likeliest R as that lies above the truth, and draws of |S| lie below. Draws of displaced surfaces therefore count half as
/// they are and half mirrored at the likeliest. A smooth departure is smoothed instead, so that its likeliest R lies below the truth,
/// and draws as they are hold it. Either quantity takes the wider end of two ways on either side: S, which ends at 1 where mirrored draws
/// pile up, with all draws as they are, R with those of smooth departures. Natural departures that have a good part of the
/// estimate of R are held by its interval as if they were alone: other departures lie lower, and with half of the weights there they
/// would put the upper end at nine tenths of what natural departures allow. So are bodies that are about as likely as the likeliest one.
pub(super) fn interval_of(
    found: &[&Drawn],
    pick: fn(&Field) -> f64,
    level: f64,
    quantity: ShapeQuantity,
) -> Option<[f64; 2]> {
    let (range, other) = match quantity {
        ShapeQuantity::ShapeIndex => ([-1.0, 1.0], Mirrored::None),
        ShapeQuantity::Curvedness { .. } => ([0.0, f64::INFINITY], Mirrored::AllButSmooth),
    };
    let of_interval = |drawn: &Drawn| drawn.weights[1];
    let [lo, hi] = quantiles(found, pick, level, other, range, of_interval)?;
    let [low, high] = quantiles(found, pick, level, Mirrored::Displaced, range, of_interval)?;
    let mut ends = [lo.min(low), hi.max(high)];
    let ShapeQuantity::Curvedness { heard } = quantity else { return Some(ends) };
    let mut hold = |own: Option<[f64; 2]>| {
        if let Some([lo, hi]) = own {
            ends = [ends[0].min(lo), ends[1].max(hi)];
        }
    };
    let natural: Vec<&Drawn> = found.iter().copied().filter(|drawn| drawn.natural).collect();
    let in_estimate = |drawn: &[&Drawn]| drawn.iter().map(|d| d.weights[0]).sum::<f64>();
    if in_estimate(&natural) >= heard * in_estimate(found) {
        hold(quantiles(&natural, pick, level, Mirrored::None, range, of_interval));
    }
    for body in Body::ALL {
        let share = |drawn: &Drawn| drawn.body.filter(|(own, _)| *own == body).map_or(0.0, |(_, share)| share);
        hold(quantiles(found, pick, level, Mirrored::None, range, share));
    }
    Some(ends)
}

/// Both quantiles of the draws under these weights. Draws that are `mirrored` count half as they are and half mirrored at the
/// likeliest value of their node, within the range of the quantity.
fn quantiles(
    found: &[&Drawn],
    pick: fn(&Field) -> f64,
    level: f64,
    mirrored: Mirrored,
    [least, most]: [f64; 2],
    weight: impl Fn(&Drawn) -> f64,
) -> Option<[f64; 2]> {
    let mut values: Vec<(f64, f64)> = Vec::new();
    for drawn in found.iter().filter(|d| !d.draws.is_empty()) {
        let share = weight(drawn) / drawn.draws.len() as f64;
        let twice = mirrored.counts(drawn);
        let share = if twice { 0.5 * share } else { share };
        values.extend(drawn.draws.iter().map(|field| (pick(field), share)));
        if twice {
            let about = 2.0 * pick(&drawn.likeliest);
            values.extend(drawn.draws.iter().map(|field| ((about - pick(field)).clamp(least, most), share)));
        }
    }
    values.retain(|(value, share)| value.is_finite() && *share > 0.0);
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    Some([weighted_quantile(&values, 0.5 * (1.0 - level))?, weighted_quantile(&values, 0.5 * (1.0 + level))?])
}

/// The angle from this direction, degrees, that a part `level` of the draws does not exceed.
pub(super) fn within_deg(found: &[Drawn], own: Vector, which: usize, level: f64) -> Option<f64> {
    let angle = |field: &Field| {
        let along = field.directions.map_or(0.0, |of| dot(of[which], own).abs());
        along.min(1.0).acos().to_degrees()
    };
    let mut angles: Vec<(f64, f64)> = Vec::new();
    for drawn in found.iter().filter(|drawn| !drawn.draws.is_empty()) {
        let share = drawn.weights[1] / drawn.draws.len() as f64;
        angles.extend(drawn.draws.iter().map(|field| (angle(field), share)));
    }
    angles.sort_by(|a, b| a.0.total_cmp(&b.0));
    weighted_quantile(&angles, level)
}

/// Shares of the classes: that of the plane by the evidence, because a surface so near to a plane that it cannot be told from
/// one is called plane; those of the others, which have the rest, under weights of their own.
pub(super) fn classes(found: &[Drawn]) -> Vec<(ShapeClass, f64)> {
    let is_plane = |drawn: &&Drawn| drawn.kind == Kind::Plane;
    let estimate: f64 = found.iter().map(|d| d.weights[0]).sum();
    let plane = found.iter().filter(is_plane).map(|d| d.weights[0]).sum::<f64>() / estimate;
    let curved: f64 = found.iter().filter(|d| !is_plane(d)).map(|d| d.of_class).sum();
    let mut out: Vec<(ShapeClass, f64)> = ShapeClass::CURVED.into_iter().map(|class| (class, 0.0)).collect();
    for drawn in found.iter().filter(|d| d.kind != Kind::Plane && d.of_class > 0.0) {
        let share = (1.0 - plane) * drawn.of_class / (curved * drawn.draws.len().max(1) as f64);
        for field in &drawn.draws {
            let class = ShapeClass::of_shape_index(field.s);
            out.iter_mut().filter(|(c, _)| *c == class).for_each(|(_, sum)| *sum += share);
        }
    }
    out.push((ShapeClass::Plane, plane));
    let sum: f64 = out.iter().map(|c| c.1).sum();
    out.iter_mut().for_each(|c| c.1 /= sum);
    out.retain(|c| c.1 > 0.0);
    out.sort_by(|a, b| b.1.total_cmp(&a.1));
    out
}

/// Standard deviations of S and R at every point over all draws, root mean squares of their heights over the reported surface and of
/// their angles to it, and standard deviations of k1 and k2.
pub(super) fn pointwise(found: &[Drawn], points: usize) -> Vec<[f64; 6]> {
    let rms = |i: usize, of: fn(&[f64; 3]) -> f64| {
        let (mut all, mut squares) = (0.0, 0.0);
        for drawn in found {
            let share = drawn.weights[1] / drawn.over_map.len().max(1) as f64;
            let known = drawn.over_map.iter().map(|draw| of(&draw[i])).filter(|square| square.is_finite());
            known.for_each(|square| (all, squares) = (all + share, squares + share * square));
        }
        if all > 0.0 { (squares / all).sqrt() } else { 0.0 }
    };
    let sd = |i: usize, k: usize| {
        let (mut all, mut sum, mut squares) = (0.0, 0.0, 0.0);
        let value = |at: &[f64; 2]| if k < 2 { at[k] } else { principal_curvatures(*at)[k - 2] };
        // about the first value, so that the squares do not cancel
        let about = found.first().map_or(0.0, |d| value(&d.likeliest.at[i]));
        for drawn in found.iter().filter(|d| k != 0 || d.kind != Kind::Plane) {
            let share = drawn.weights[1] / drawn.draws.len().max(1) as f64;
            for field in &drawn.draws {
                let value = value(&field.at[i]) - about;
                (all, sum, squares) = (all + share, sum + share * value, squares + share * value * value);
            }
        }
        if all > 0.0 { (squares / all - (sum / all).powi(2)).max(0.0).sqrt() } else { 0.0 }
    };
    let height = |touch: &[f64; 3]| touch[0] * touch[0];
    let angle = |touch: &[f64; 3]| touch[1] * touch[1] + touch[2] * touch[2];
    (0..points).map(|i| [sd(i, 0), sd(i, 1), rms(i, height), rms(i, angle), sd(i, 2), sd(i, 3)]).collect()
}
