//! What a touch measures of the drawn surfaces, and how it errs.
//!
//! ```text
//! height   h = distance from the reported surface                       v = sd^2 + n tau^2
//! normal   two components of its normal less the reported one, across   v = sd^2 of a normal
//! agrees:  off^2 <= q^2 (v + var over the draws)                        n: touches that share an error already, and this one
//! ```
//!
//! Of touches that share an error all together tell as much as one of them alone: with n tau^2 in the place of tau^2 each tells the n-th
//! part.

use crate::recognition::Recognition;
use palpate_numeric::vector::{Vector, axes_along, dot, minus, norm};

use super::ensemble::{DrawnEnsemble, LinearReading};

/// Rounding that is no disagreement, as a share of the patch's size, and of a normal.
const ROUNDING: f64 = 1e-9;

/// Variances of a touch.
pub(super) struct TouchErrors {
    across: f64,
    of_normal: Option<f64>,
}

impl TouchErrors {
    /// Of a touch after these.
    pub(super) fn of(found: &Recognition, since: &[Vector], place: Vector) -> TouchErrors {
        let noise = &found.noise;
        let floor = ROUNDING * found.frame.scale;
        let shared = match noise.correlation_length {
            Some(length) => (1.0 + neighbours(found, since, place, length)) * noise.sd_correlated.powi(2),
            None => noise.sd_correlated.powi(2),
        };
        let of_normal = noise.sd_normal_deg.map(|sd| sd.to_radians().max(ROUNDING).powi(2));
        TouchErrors { across: noise.sd_z.max(floor).powi(2) + shared, of_normal }
    }
}

/// Touches within the length over which errors are shared: those since the recognition, and those before it by their number in all,
/// as if they lay evenly over the map.
fn neighbours(found: &Recognition, since: &[Vector], place: Vector, length: f64) -> f64 {
    let near = since.iter().filter(|touch| norm(minus(**touch, place)) <= length).count();
    let [u, v] = found.chart().map(|[lo, hi]| (hi - lo) * found.frame.scale);
    let before = found.contacts.saturating_sub(since.len()) as f64;
    let covered = (2.0 * length / u.max(length)).min(1.0) * (2.0 * length / v.max(length)).min(1.0);
    near as f64 + before * covered
}

/// The readings of a touch: its height, and two of its normal where it has one that counts.
pub(super) struct MeasuredTouch {
    pub(super) readings: Vec<LinearReading>,
}

impl MeasuredTouch {
    /// At this place of the map and of the input, with this normal.
    pub(super) fn of(
        found: &Recognition,
        ensemble: &DrawnEnsemble,
        (at, place, normal): ([f64; 2], Vector, Option<Vector>),
        errors: &TouchErrors,
    ) -> MeasuredTouch {
        let [u, v] = found.chart_of(place);
        let (_, reported) = found.at(u, v);
        let reading = |parts: [f64; 4], measured: f64, variance: f64| LinearReading {
            of: ensemble.reading_at(at, parts),
            measured,
            variance,
        };
        let mut readings = vec![reading([1.0, 0.0, 0.0, 0.0], found.distance(place), errors.across)];
        if let Some((normal, variance)) = normal.zip(errors.of_normal) {
            // where no side is known, neither way of a normal is wrong
            let towards = if dot(normal, reported) < 0.0 && !found.side_known { -1.0 } else { 1.0 };
            let [first, second, _] = axes_along(reported);
            for [x, y, z] in [first, second] {
                readings.push(reading([0.0, x, y, z], towards * dot(normal, [x, y, z]), variance));
            }
        }
        MeasuredTouch { readings }
    }

    /// Whether the reported surface explains it, as far as the surface itself is known.
    pub(super) fn agrees(&self, ensemble: &DrawnEnsemble, within: f64) -> bool {
        let is_near = |reading: &LinearReading| {
            let [mean, variance] = ensemble.moments(reading);
            (reading.measured - mean).powi(2) <= within * within * (variance + reading.variance)
        };
        self.readings.iter().all(is_near)
    }
}
