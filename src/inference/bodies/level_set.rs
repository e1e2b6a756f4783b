//! Rows of contacts on a surface that departs from its base by as much as the body is large.
//!
//! ```text
//! F(p) = d(p) - phi(q)' w                        the surface is where F is 0
//! distance of contact i    F(p_i)
//! its normal, along t      t . grad F            t: two directions across the measured normal, in which F does not change
//! steepness                n . grad F - 1        n: the measured normal, else that of the surface as far as it is known
//! move x of the base       F rides along: dF = grad F . dq,   dq = -tau - omega x q   in the base's own axes
//! ```
//!
//! Steepness is no measurement: it belongs to the prior, which knows that F is a distance. Without it F is 0 everywhere for the f that
//! follows d not only where contacts lie. `t . grad F = 0` holds however steep the departure is, where a comparison of grad F with the
//! normal would want |grad F| = 1. Gauss's and Newton's steps: with grad F of the surface that was found the equations are solved again.
//! Rows divided by |grad F| of the step before were tried: F then grows steep where it passes contacts by, and scatter and evidence mean
//! nothing.

use super::coordinates::{DepartureJet, DepartureOver};
use super::mode::aligned;
use super::posterior::DrawnBase;
use super::rows::BaseRows;
use super::sample::BodySample;
use crate::primitives::placed::Primitive;
use palpate_geometry::primitives::DistanceJet;
use palpate_numeric::vector::{Vector, along, axes_along, cross, dot, unit};

impl BaseRows {
    /// Rows about a surface, by those of `tau omega size omega3` that move it.
    pub(super) fn of_level_set(
        surface: &DrawnBase,
        over: DepartureOver,
        moving: &[usize],
        members: &[usize],
        sample: &BodySample,
    ) -> BaseRows {
        let mut found = BaseRows::empty(over, moving.len(), members, sample);
        for (r, &i) in members.iter().enumerate() {
            found.add_level_set(r, &PlacedJet::new(surface, sample.points[i], moving), sample.normal(i));
        }
        found
    }

    fn add_level_set(&mut self, r: usize, at: &PlacedJet, given: Option<Vector>) {
        let last = at.motions.len();
        for (c, (_, by)) in at.motions.iter().enumerate() {
            self.distances[(r, c)] = dot(at.gradient, *by);
        }
        self.distances[(r, last)] = at.base.distance;
        self.places.push(self.over.coordinates(at.primitive, at.place, at.foot()));
        let upward = unit(given.map_or(at.jet.gradient, |n| aligned(n, at.jet.gradient)));
        let slopes = at.slopes(upward);
        (0..=last).for_each(|c| self.steepness[(r, c)] = slopes[c]);
        self.steepness[(r, last)] -= 1.0;
        self.upward.push(self.over.along(at.primitive, at.place, upward));
        self.count_side(given, at.jet.gradient);
        let Some(normal) = given else { return };
        let [first, second, _] = axes_along(normal);
        for (k, tangent) in [first, second].into_iter().enumerate() {
            let row = 2 * self.across.len() + k;
            let slopes = at.slopes(tangent);
            (0..=last).for_each(|c| self.tangential[(row, c)] = slopes[c]);
        }
        self.across.push((r, [first, second].map(|tangent| self.over.along(at.primitive, at.place, tangent))));
    }
}

/// The surface as far as it is known at one contact, in the base's own axes but for the jet.
struct PlacedJet<'a> {
    primitive: &'a Primitive,
    place: Vector,
    base: DistanceJet,
    jet: DepartureJet,
    gradient: Vector,
    /// Unknowns that move the base, and how the place then moves.
    motions: Vec<(usize, Vector)>,
}

impl<'a> PlacedJet<'a> {
    fn new(surface: &'a DrawnBase, place: Vector, moving: &[usize]) -> PlacedJet<'a> {
        let primitive = &surface.primitive;
        let q = primitive.own(place);
        let jet = surface.jet(place);
        let gradient = primitive.axes.map(|axis| dot(axis, jet.gradient));
        let motions = moving.iter().map(|a| (*a, motion(*a, q))).collect();
        PlacedJet { primitive, place, base: primitive.at(q), jet, gradient, motions }
    }

    fn foot(&self) -> Vector {
        along(self.place, -self.base.distance, self.primitive.out(self.base.gradient))
    }

    /// The slope of F along a direction by the unknowns, and last that of the base itself.
    fn slopes(&self, direction: Vector) -> Vec<f64> {
        let own = |v: Vector| self.primitive.axes.map(|axis| dot(axis, v));
        let bent = own([0, 1, 2].map(|i| dot(self.jet.hessian[i], direction)));
        let direction = own(direction);
        let of = |(a, by): &(usize, Vector)| dot(bent, *by) + dot(self.gradient, turning(*a, direction));
        self.motions.iter().map(of).chain([dot(direction, self.base.gradient)]).collect()
    }
}

/// The axis that an unknown turns about.
fn axis_of(unknown: usize) -> Option<Vector> {
    match unknown {
        3 => Some([1.0, 0.0, 0.0]),
        4 => Some([0.0, 1.0, 0.0]),
        8 => Some([0.0, 0.0, 1.0]),
        _ => None,
    }
}

/// How a place moves in the base's own axes as the base moves.
fn motion(unknown: usize, q: Vector) -> Vector {
    match axis_of(unknown) {
        Some(axis) => cross(q, axis),
        None => [0, 1, 2].map(|k| if k == unknown { -1.0 } else { 0.0 }),
    }
}

/// How a direction turns in them.
fn turning(unknown: usize, direction: Vector) -> Vector {
    axis_of(unknown).map_or([0.0; 3], |axis| cross(direction, axis))
}
