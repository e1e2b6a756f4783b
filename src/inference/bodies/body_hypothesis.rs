//! One hypothesis about a body: a kind with a departure of one length and size, and what contacts then say.

use std::sync::Arc;

use faer::Mat;

use super::coordinates::{DepartureOver, Symmetry};
use super::departure::DepartureProcess;
use super::departure_reading::DepartureReading;
use super::tuning::Tuning;
#[cfg(test)]
use crate::dense;
use crate::primitives::placed::{MOST_UNKNOWNS, Primitive};

/// What one hypothesis says.
#[derive(Clone, Debug)]
pub(crate) struct BodyHypothesis {
    /// Number of the kind's linearisation.
    pub(super) of: usize,
    /// Length of the departure and its size over the sd of a contact; `None` without one.
    pub(super) departure: Option<[f64; 2]>,
    /// What that is.
    pub(super) reading: DepartureReading,
    pub(super) log_evidence: f64,
    /// The departure's weights, then the move to the likeliest primitive by the unknowns that are free.
    pub(super) solution: Vec<f64>,
    /// Which of the primitive's unknowns these are.
    pub(super) moving: &'static [usize],
    /// Lower factor of their precision in units of one over the sd.
    pub(super) lower: Mat<f64>,
    /// What the weights are those of.
    pub(super) process: Option<Arc<DepartureProcess>>,
    /// Sds of distances and normals.
    pub(super) sd: [f64; 2],
    /// By how much errors that contacts share widen what is drawn.
    pub(super) shared: f64,
    /// Root mean square of the departure at the contacts.
    pub(super) departure_rms: f64,
    /// Degrees of freedom of the sd.
    pub(super) freedom: f64,
}

impl BodyHypothesis {
    /// The move to the likeliest primitive.
    pub(super) fn step(&self) -> &[f64] {
        &self.solution[self.process.as_ref().map_or(0, |process| process.len())..]
    }

    /// A primitive moved by the last numbers of a solution, by the likeliest one or by one that was drawn.
    pub(super) fn moved_by(&self, base: &Primitive, solution: &[f64]) -> Primitive {
        moved(base, self.moving, &solution[self.solution.len() - self.moving.len()..])
    }

    /// The likeliest primitive.
    pub(super) fn likeliest(&self, base: &Primitive) -> Primitive {
        self.moved_by(base, &self.solution)
    }

    /// ln of the factor's determinant.
    #[cfg(test)]
    pub(super) fn lower_determinant(&self) -> f64 {
        0.5 * dense::log_det(&self.lower)
    }

    /// Sd of a single contact.
    pub(crate) fn scatter(&self) -> f64 {
        self.sd[0]
    }

    /// Sd of a normal in each tangent direction, radians.
    pub(crate) fn sd_of_normals(&self) -> f64 {
        self.sd[1]
    }

    /// Whether a sensor has distances and normals that scatter by so much beside each other, in 95 of a hundred cases.
    pub(crate) fn is_of_a_sensor(&self, tuning: &Tuning) -> bool {
        let [mean, sd] = tuning.log_ratio;
        ((self.sd[0] / self.sd[1]).ln() - mean).abs() <= 2.0 * sd
    }

    /// Root mean square of the departure at the contacts.
    pub(crate) fn departure_size(&self) -> f64 {
        self.departure_rms
    }

    /// Root mean square of the departure over its length; 0 without one.
    pub(super) fn slope(&self) -> f64 {
        self.departure.map_or(0.0, |[length, _]| self.departure_rms / length)
    }

    /// With the prior of how its departure is read, and its share of departures of all feet and of the section alone.
    pub(super) fn weighed_by_reading(mut self, [of_feet, of_section]: [f64; 2], tuning: &Tuning) -> BodyHypothesis {
        self.log_evidence += self.departure.map_or(0.0, |[_, size]| self.reading.prior(size, tuning).ln());
        if self.departure.is_some() {
            self.log_evidence += if self.is_of_section() { of_section } else { of_feet }.ln();
        }
        self
    }

    /// Whether it departs in its section alone.
    pub(super) fn is_of_section(&self) -> bool {
        self.process.as_ref().is_some_and(|process| process.over == DepartureOver::Section)
    }

    /// Probability that its departure is an error of the sensor; 0 without one.
    pub(super) fn is_error(&self, tuning: &Tuning) -> f64 {
        self.departure.map_or(0.0, |[_, size]| self.reading.is_error(size, tuning))
    }

    /// Whether its departure is likelier shape than an error of the sensor.
    pub(crate) fn departs_in_shape(&self, tuning: &Tuning) -> bool {
        self.departure.is_some() && self.is_error(tuning) < 0.5
    }

    /// Length of the departure.
    pub(crate) fn length(&self) -> Option<f64> {
        self.departure.map(|[length, _]| length)
    }

    /// In which way its departure is the same in many places.
    pub(super) fn symmetry(&self) -> Symmetry {
        self.process.as_ref().map_or(Symmetry::None, |process| process.over.symmetry())
    }

    /// Degrees of freedom of the sd.
    pub(crate) fn freedom(&self) -> f64 {
        self.freedom
    }
}

/// A primitive moved by some of its unknowns.
pub(super) fn moved(primitive: &Primitive, moving: &[usize], step: &[f64]) -> Primitive {
    let mut all = [0.0; MOST_UNKNOWNS];
    moving.iter().zip(step).for_each(|(i, s)| all[*i] = *s);
    primitive.moved(&all)
}
