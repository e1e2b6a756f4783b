//! Whether a departure is shape or an error of the sensor.
//!
//! ```text
//! error  p(r) = 2 / (pi (1 + r^2))      shared errors are as large as a contact's own, seldom far larger; r: sds of a contact
//! shape  p(r) = 1 / (r ln(most / least))     of any size
//! ```
//!
//! Normals that were measured by themselves, as they are with probability m, follow a shape and not an error of the places. Those that were
//! computed from the places follow both.
//!
//! ```text
//! prior                  normals do not follow: m e        they do: 1 - m e          e = p(error) / (p(error) + p(shape))
//! error, given that      1                                 (1 - m) e / (1 - m e)     without normals: e
//! ```

use std::f64::consts::PI;

use super::tuning::Tuning;

/// What a departure is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum DepartureReading {
    /// Shape, for certain.
    Shape,
    /// Shape or error: there are no normals.
    Untold,
    /// Shape, or an error of the places that the normals were computed from.
    Followed,
    /// An error of the places that normals do not follow.
    SensorError,
}

impl DepartureReading {
    /// Its prior, of a departure of some size.
    pub(super) fn prior(self, size: f64, tuning: &Tuning) -> f64 {
        let apart = tuning.own_normals * of_error(size, tuning);
        match self {
            DepartureReading::Shape | DepartureReading::Untold => 1.0,
            DepartureReading::Followed => 1.0 - apart,
            DepartureReading::SensorError => apart,
        }
    }

    /// Probability that it is an error where it is this.
    pub(super) fn is_error(self, size: f64, tuning: &Tuning) -> f64 {
        let (error, own) = (of_error(size, tuning), tuning.own_normals);
        match self {
            DepartureReading::Shape => 0.0,
            DepartureReading::Untold => error,
            DepartureReading::Followed => (1.0 - own) * error / (1.0 - own * error),
            DepartureReading::SensorError => 1.0,
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
