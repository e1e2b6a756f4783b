//! Parameters, frame and knots of a parametric fit, and where its contacts reach.
//!
//! ```text
//! (u, v) of every contact in input units  ->  / scale, scale = half the longer side
//! ```

use super::flattening::Flattening;
use super::patch_contacts::PatchContacts;
use super::{fingers, isomap};
use crate::fit::{FitError, FitOptions};
use palpate_geometry::contact::Frame;
use palpate_geometry::convex_hull::convex_hull;
use palpate_geometry::shape::UvSupport;
use palpate_numeric::bspline::Knots;

/// Segments of a closed direction where none are asked for: a cubic's curvature of a circle is then off by 2 % at worst.
const ROUND: usize = 12;

/// Parameters of the contacts: by fingers and stations where they are known and form a net, else from the contacts alone.
/// Beside them the reason why fingers were not used, for the certificate.
///
/// # Errors
/// [`FitError::Sheet`], [`FitError::Closed`].
pub(super) fn flatten(contacts: &PatchContacts, options: &FitOptions) -> Result<(Flattening, String), FitError> {
    let refused = |why: &'static str| FitError::Sheet { contacts: contacts.len(), why };
    match fingers::flatten_by_fingers(contacts, options.closed) {
        Ok(flat) => Ok((flat, String::new())),
        Err(why) if options.closed != [false; 2] => Err(FitError::Closed { why }),
        Err(why) if contacts.labels.is_none() => {
            isomap::flatten_scattered(contacts).map(|flat| (flat, format!(": {why}"))).map_err(refused)
        }
        Err(why) => isomap::flatten_scattered(contacts)
            .map(|flat| (flat, format!(": {why}")))
            // the fault that the labels show is the more useful message
            .map_err(|_| refused(why)),
    }
}

/// Frame and knots: the origin is the mean contact, and the longer side of (u, v) is two patch units. The places in
/// `flat` are scaled to patch units.
///
/// # Errors
/// [`FitError::Sheet`] for contacts on one curve, [`FitError::Knots`].
pub(super) fn lay_out(
    contacts: &PatchContacts,
    flat: &mut Flattening,
    options: &FitOptions,
) -> Result<(Frame, [Knots; 2]), FitError> {
    let ends = [0, 1].map(|k| {
        let range = flat.places.iter().map(|p| p[k]);
        let (lo, hi) = range.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
        flat.period[k].map_or([lo, hi], |period| [0.0, period])
    });
    let side = (ends[0][1] - ends[0][0]).max(ends[1][1] - ends[1][0]);
    if !(side > 0.0 && side.is_finite()) || ends.iter().any(|e| e[1] - e[0] <= 1e-6 * side) {
        return Err(FitError::Sheet { contacts: contacts.len(), why: "all contacts lie on one curve" });
    }
    let scale = 0.5 * side;
    flat.places.iter_mut().for_each(|p| *p = p.map(|t| t / scale));
    let make = |k: usize, axis: &'static str| {
        let [lo, hi] = ends[k].map(|t| t / scale);
        let (degree, segments) = (options.degree[k], options.segments[k]);
        let made = if options.closed[k] {
            // one segment, the default, cannot close
            Knots::closed(degree, if segments == 1 { ROUND.max(degree + 1) } else { segments }, lo, hi)
        } else {
            Knots::uniform(degree, segments, lo, hi)
        };
        made.map_err(|source| FitError::Knots { axis, source })
    };
    let knots = [make(0, "u")?, make(1, "v")?];
    Ok((Frame { origin: contacts.centre(), scale, ..Frame::IDENTITY }, knots))
}

/// Where contacts reach in (u, v): triangles between the feet of neighbouring fingers and stations, or the convex hull
/// of all feet.
pub(super) fn support(flat: &Flattening, places: &[[f64; 2]], knots: &[Knots; 2]) -> UvSupport {
    let corners = if flat.triangles.is_empty() {
        let rim = convex_hull(places);
        (1..rim.len().saturating_sub(1)).map(|k| [rim[0], rim[k], rim[k + 1]]).collect()
    } else {
        flat.triangles.iter().map(|t| t.map(|r| places[r])).collect()
    };
    let period = [0, 1].map(|k| {
        let [lo, hi] = knots[k].domain();
        knots[k].is_closed().then_some(hi - lo)
    });
    UvSupport::new(corners, period)
}
