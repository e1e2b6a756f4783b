//! Whether a departure is shape or an error of the sensor.
//!
//! ```text
//! error  p(r) = 2 / (pi (1 + r^2))      shared errors are as large as a contact's own, seldom far larger; r: sds of a contact
//! shape  p(r) = 1 / (r ln(most / least))     of any size
//! ```
//!
//! Measured normals follow a shape and not an error of the places, which is then a hypothesis of its own. Normals that were computed from the
//! places follow both, so that size still decides where they follow.

use std::f64::consts::PI;

use super::tuning::Tuning;

/// What a departure is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum DepartureReading {
    /// A free surface's.
    Shape,
    /// An error that neighbours share, and that normals do not follow.
    SensorError,
    /// Normals follow it, if there are any.
    Either,
}

impl DepartureReading {
    /// Those that are hypotheses of their own.
    pub(super) fn told_by_normals(normals: bool) -> &'static [DepartureReading] {
        if normals { &[DepartureReading::Either, DepartureReading::SensorError] } else { &[DepartureReading::Either] }
    }

    /// What it is weighed with beforehand, of a departure of some size: of error as of one that normals do not follow.
    pub(super) fn probability(self, size: f64, tuning: &Tuning) -> f64 {
        match self {
            DepartureReading::SensorError => of_error(size, tuning),
            DepartureReading::Shape | DepartureReading::Either => 1.0,
        }
    }

    /// Probability that it is an error of the sensor where it is this.
    pub(super) fn is_error(self, size: f64, tuning: &Tuning) -> f64 {
        match self {
            DepartureReading::Shape => 0.0,
            DepartureReading::SensorError => 1.0,
            DepartureReading::Either => of_error(size, tuning),
        }
    }
}

/// Probability that a departure of r standard deviations of a contact is an error of the sensor and not shape.
fn of_error(r: f64, tuning: &Tuning) -> f64 {
    let ends = tuning.departures.iter().fold([f64::INFINITY, 0.0_f64], |[lo, hi], r| [lo.min(*r), hi.max(*r)]);
    let of_error = tuning.departure_is_error * 2.0 / (PI * (1.0 + r * r));
    let of_shape = (1.0 - tuning.departure_is_error) / (r * (ends[1] / ends[0]).ln().max(1.0));
    of_error / (of_error + of_shape)
}
