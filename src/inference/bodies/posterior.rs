//! Primitives drawn from the posterior, and what they say of a number.
//!
//! ```text
//! number of draws of a node ~ its weight, taken in turn at even steps of the cumulated weights
//! theta = likeliest + c s sqrt(nu / chi^2_nu) L^-T z       z gaussian, L the factor of the precision: Student's law of s unknown
//!                                                          c > 1 where numbers were rounded, and contacts alike
//! ```

use std::sync::Arc;

use rand_distr::{ChiSquared, Distribution, StandardNormal};

use super::body_hypothesis::BodyHypothesis;
use super::body_posterior::BodyPosterior;
use super::coordinates::{DepartureJet, Symmetry};
use super::departure::DepartureProcess;
use super::finer_shape::FinerShape;
use super::mode::is_possible;
use super::surface_reading::SurfaceReading;
use super::tuning::Tuning;
use crate::dense;
use crate::primitives::placed::Primitive;
use palpate_numeric::draws::{EffectDraws, evenly};
use palpate_numeric::statistics::weighted_quantile;
use palpate_numeric::vector::{Vector, along, axes_along, dot, minus, unit};

/// Steps onto a surface: each squares what is left.
const ONTO: usize = 4;

/// Careful steps before these, on the way to a surface that departs by as much as the body is large.
const TRACED: usize = 8;

/// Distance, in units of the sample, within which Newton's steps are safe.
const NEAR: f64 = 1e-3;

/// Squared slope of F below which it has no direction.
const FLAT: f64 = 1e-6;

/// One drawn surface, in units of the sample.
#[derive(Clone, Debug)]
pub(crate) struct DrawnBase {
    pub(crate) primitive: Primitive,
    /// Its departure with the coefficients that were drawn, where that is read as shape; as an error of the sensor it bends nothing.
    departure: Option<(Arc<DepartureProcess>, Vec<f64>)>,
    /// What it does not follow, and which draw this is.
    pub(crate) finer: Option<(FinerShape, u64)>,
    /// Its share of all; they sum to 1.
    pub(crate) share: f64,
}

impl DrawnBase {
    /// A primitive alone.
    pub(crate) fn of_primitive(primitive: Primitive) -> DrawnBase {
        DrawnBase { primitive, departure: None, finer: None, share: 1.0 }
    }

    /// The likeliest primitive of a node with its departure.
    pub(crate) fn likeliest(primitive: Primitive, node: &BodyHypothesis) -> DrawnBase {
        let departure = node.process.clone().map(|process| {
            let coefficients = process.coefficients(&node.solution[..process.len()]);
            (process, coefficients)
        });
        DrawnBase { primitive, departure, finer: None, share: 1.0 }
    }

    /// F, its gradient and its Hessian at a place; F is positive outside.
    pub(super) fn jet(&self, place: Vector) -> DepartureJet {
        let q = self.primitive.own(place);
        let base = self.primitive.at(q);
        let axes = self.primitive.axes;
        let gradient = self.primitive.out(base.gradient);
        let rotated = base.hessian.map(|row| self.primitive.out(row));
        let hessian = [0, 1, 2].map(|i| [0, 1, 2].map(|j| (0..3).map(|k| axes[k][i] * rotated[k][j]).sum::<f64>()));
        let mut jet = DepartureJet { value: base.distance, gradient, hessian };
        if let Some((process, coefficients)) = &self.departure {
            let foot = along(place, -base.distance, gradient);
            let by = process.jet_at(coefficients, &self.primitive, place, foot);
            let by = if process.over.is_small() { by.of_foot(gradient, hessian) } else { by };
            jet.value -= by.value;
            jet.gradient = minus(jet.gradient, by.gradient);
            (0..3).for_each(|i| jet.hessian[i] = minus(jet.hessian[i], by.hessian[i]));
        }
        jet
    }

    /// The point of the surface next to a place: steps of Newton's along the gradient.
    fn onto(&self, place: Vector) -> Vector {
        if self.departure.is_none() {
            let (d, normal) = self.primitive.nearest(place);
            return along(place, -d, normal);
        }
        let near = if self.is_level_set() { self.traced(place) } else { place };
        (0..ONTO).fold(near, |p, _| {
            let jet = self.jet(p);
            let square = dot(jet.gradient, jet.gradient).max(FLAT);
            along(p, -jet.value / square, jet.gradient)
        })
    }

    /// A place near the surface by steps that do not pass through it: F is about a distance, and grows by no more than it says. Newton's own
    /// are long where F is flat, and led through a thin neck to its other side.
    ///
    /// J. C. Hart, *The Visual Computer* 12 (1996) 527.
    fn traced(&self, place: Vector) -> Vector {
        let mut p = place;
        for _ in 0..TRACED {
            let jet = self.jet(p);
            let steepness = dot(jet.gradient, jet.gradient).max(FLAT).sqrt();
            if jet.value.abs() < NEAR * steepness {
                break;
            }
            p = along(p, -jet.value / (steepness * steepness.max(1.0)), jet.gradient);
        }
        p
    }

    /// Place and unit normal of the surface over a place of the primitive.
    pub(crate) fn over(&self, foot: Vector) -> (Vector, Vector) {
        let place = self.onto(foot);
        let outwards = unit(self.jet(place).gradient);
        (place, outwards.map(|n| n * self.primitive.side))
    }

    /// Signed distance of a place, positive on the free side.
    pub(crate) fn distance(&self, place: Vector) -> f64 {
        let jet = self.jet(place);
        self.primitive.side * jet.value / dot(jet.gradient, jet.gradient).max(FLAT).sqrt()
    }

    /// The shape that contacts show beside it.
    pub(crate) fn finer_shape(&self, contacts: &[Vector], tuning: &Tuning) -> Option<FinerShape> {
        let off: Vec<f64> = contacts.iter().map(|p| self.distance(*p)).collect();
        let feet: Vec<Vector> = contacts.iter().map(|p| self.over(*p).0).collect();
        FinerShape::beside(&off, &feet, tuning)
    }

    /// Whether it departs from its primitive.
    pub(crate) fn departs(&self) -> bool {
        self.departure.is_some()
    }

    /// Whether it departs by as much as the body is large.
    pub(crate) fn is_level_set(&self) -> bool {
        self.symmetry().is_some()
    }

    /// In which way it is the same in many places, where it departs by as much as the body is large.
    pub(crate) fn symmetry(&self) -> Option<Symmetry> {
        let over = self.departure.as_ref().map(|(process, _)| process.over)?;
        (!over.is_small()).then(|| over.symmetry())
    }

    /// Principal curvatures `k1 >= k2` at the foot of a place, the normal towards the free side.
    pub(crate) fn curvatures(&self, place: Vector) -> [f64; 2] {
        self.reading(place).curvatures
    }

    /// All that is asked about a place.
    pub(crate) fn reading(&self, place: Vector) -> SurfaceReading {
        let followed = self.followed(place);
        self.finer.map_or(followed, |(finer, number)| finer.added(&followed, place, number))
    }

    fn followed(&self, place: Vector) -> SurfaceReading {
        if self.departure.is_none() {
            let (distance, normal) = self.primitive.nearest(place);
            let curvatures = self.primitive.curvatures(along(place, -distance, normal));
            return SurfaceReading { distance, normal, curvatures };
        }
        let side = self.primitive.side;
        let first = self.jet(place);
        let square = dot(first.gradient, first.gradient).max(FLAT);
        let there = if self.is_level_set() {
            self.jet(self.onto(place))
        } else {
            self.jet(along(place, -first.value / square, first.gradient))
        };
        let steepness = dot(there.gradient, there.gradient).max(FLAT).sqrt();
        let outwards = there.gradient.map(|g| g / steepness);
        let [s, t, _] = axes_along(outwards);
        let bend = |a: Vector, b: Vector| -(0..3).map(|i| a[i] * dot(there.hessian[i], b)).sum::<f64>() / steepness;
        let [a, b, c] = [bend(s, s), bend(s, t), bend(t, t)];
        let (mean, half) = (0.5 * (a + c), (0.5 * (a - c)).hypot(b));
        let [k, l] = [mean + half, mean - half].map(|k| k * side);
        SurfaceReading {
            distance: side * first.value / square.sqrt(),
            normal: outwards.map(|n| n * side),
            curvatures: [k.max(l), k.min(l)],
        }
    }
}

/// Draws of all kinds by their weights.
pub(crate) fn draws(posterior: &BodyPosterior, tuning: &Tuning, seed: u64) -> Vec<DrawnBase> {
    let count = tuning.draws;
    let source = EffectDraws::new(seed, "bodies");
    let mut found = Vec::with_capacity(count);
    let (mut cumulated, mut taken) = (0.0, 0);
    for (number, (node, weight)) in posterior.nodes.iter().zip(&posterior.weights).enumerate() {
        cumulated += weight;
        let until = (cumulated * count as f64 + 0.5).floor() as usize;
        for _ in taken..until.min(count) {
            let mut generator = source.generator(found.len() as u64, number as u64);
            let chi = ChiSquared::new(node.freedom).map_or(node.freedom, |law| law.sample(&mut generator));
            let wide = node.shared * node.sd[0] * (node.freedom / chi).sqrt();
            let mut step: Vec<f64> = (0..node.solution.len()).map(|_| StandardNormal.sample(&mut generator)).collect();
            dense::backward(&node.lower, &mut step);
            step.iter_mut().zip(&node.solution).for_each(|(s, mean)| *s = mean + wide * *s);
            let base = posterior.primitives[node.of];
            let weights = node.process.as_ref().map_or(0, |process| process.len());
            let drawn = node.moved_by(&base, &step);
            // a radius below zero is no body: the likeliest stands for it
            let primitive = if is_possible(&drawn) { drawn } else { node.likeliest(&base) };
            // where nothing tells which it is, draws of a node are read both ways
            let is_error = evenly(found.len()) < node.is_error(tuning);
            let process = node.process.clone().filter(|_| !is_error);
            let departure = process.map(|process| {
                let coefficients = process.coefficients(&step[..weights]);
                (process, coefficients)
            });
            found.push(DrawnBase { primitive, departure, finer: None, share: 0.0 });
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
