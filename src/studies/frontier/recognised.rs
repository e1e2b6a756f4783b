//! The answer that everyone gets who names no model, as one more way: what `palpate fit` of the same contacts says.
//!
//! ```text
//! contacts -> a simple surface or body  |  a flexible height field  |  of too few contacts, a height field of degree 2
//! truth    -> S, R at every supported point of its map, along its normal        (what `palpate run` prints as `truth`)
//! unseen   -> d with Q on the line through the contact along z, and the angle between the normals
//! ```

use palpate_fitting::fit::FitOptions;
use palpate_fitting::parametric::FittedSurface;
use palpate_geometry::contact::Contacts;
use palpate_inference::recognition::{FieldRequest, Recognition, RecognitionError, RecognitionOptions, Shown, shown};
use palpate_numeric::vector::{cross, dot, norm};
use palpate_world::scene::Truth;

use super::errors::{Deviation, HEIGHT, Judged, K1, NORMAL, R, S, SLOPE};
use super::found_surface::{FoundSurface, TimedAnswer};

/// Steps to the surface along z; each leaves the square of the last.
const STEPS_ALONG_Z: usize = 5;
/// Below this z of its normal a surface stands too steep to be met along z; its distance is taken in its place.
const STEEP: f64 = 0.2;

/// What the contacts show.
pub(super) fn recognise(contacts: &Contacts, fit: &FitOptions) -> TimedAnswer {
    let options = RecognitionOptions {
        grid: fit.grid,
        level: fit.level,
        sigma_xy: fit.sigma_xy,
        ..RecognitionOptions::default()
    };
    let request = FieldRequest { fit, recognition: &options, gridded: false };
    match shown(Recognition::of(contacts, &options), || contacts.clone(), &request) {
        Ok(Shown::Simple(found)) => Ok(FoundSurface::Recognised(found)),
        Ok(Shown::Flexible(field, _) | Shown::Detailed(field, _)) => {
            Ok(FoundSurface::Named(FittedSurface::Height(Box::new(field.fit))))
        }
        Err(RecognitionError::TooFew { .. } | RecognitionError::Arithmetic { .. }) => {
            let (found, _) = FittedSurface::of(contacts, fit).map_err(|error| error.to_string())?;
            Ok(FoundSurface::Named(found))
        }
        Err(error) => Err(error.to_string()),
    }
}

/// Standard uncertainties of S and of R in the posterior.
pub(super) fn uncertainties(found: &Recognition) -> [Option<f64>; 2] {
    [found.shape_index.map(|estimate| estimate.u), Some(found.curvedness.u)]
}

/// Holds what was recognised against the truth.
pub(super) fn judge_recognised(found: &Recognition, truth: &Truth) -> Judged {
    let (supported, all) = found.support;
    let mut judged = Judged { support: supported as f64 / all.max(1) as f64, ..Judged::default() };
    let mut true_sums = [Deviation::default(); 2];
    for place in found.map.iter().filter(|place| place.supported) {
        let Some(local) = truth.near(place.position, place.normal) else { continue };
        let d = &mut judged.deviations;
        d[R].add(place.curvedness - local.curvedness());
        d[K1].add(place.k1 - local.k1);
        true_sums[R].add(local.curvedness());
        if let Some(index) = local.shape_index() {
            true_sums[S].add(index);
            place.shape_index.into_iter().for_each(|own| d[S].add(own - index));
        }
        d[NORMAL].add(between(place.normal, local.normal));
        if let Some(there) = truth.at(place.position[0], place.position[1]) {
            d[HEIGHT].add(place.position[2] - there.point[2]);
        }
    }
    if found.shape().shape_index.mean.is_none() {
        // a plane found has no S to be wrong about
        judged.deviations[S] = Deviation::default();
    }
    let intervals = [found.shape_index.map(|s| s.interval), Some(found.curvedness.interval)];
    judged.held = [S, R].map(|q| {
        let ([lo, hi], true_mean) = intervals[q].zip(true_sums[q].shift())?;
        Some(lo <= true_mean && true_mean <= hi)
    });
    judged
}

/// Holds it against contacts that it has not seen.
pub(super) fn judge_unseen(found: &Recognition, unseen: &Contacts) -> Judged {
    let (supported, all) = found.support;
    let mut judged = Judged { support: supported as f64 / all.max(1) as f64, ..Judged::default() };
    for r in 0..unseen.len() {
        let place = [unseen.x[r], unseen.y[r], unseen.z[r]];
        let (height, normal) = met_along_z(found, place);
        let d = &mut judged.deviations;
        d[HEIGHT].add(height);
        let Some(measured) = unseen.unit_normal(r) else { continue };
        // which of its two sides the input's normals are on is known to the recognition alone
        let normal = if dot(normal, measured) < 0.0 { normal.map(|v| -v) } else { normal };
        d[NORMAL].add(between(normal, measured));
        if normal[2].abs() > STEEP && measured[2].abs() > STEEP {
            let slopes = |n: [f64; 3]| [n[0] / n[2], n[1] / n[2]];
            let ([a, b], [c, d]) = (slopes(normal), slopes(measured));
            judged.deviations[SLOPE].add((a - c).hypot(b - d));
        }
    }
    judged
}

/// How far above a place the surface is along z, and its normal there.
fn met_along_z(found: &Recognition, place: [f64; 3]) -> (f64, [f64; 3]) {
    let at = |place: [f64; 3]| {
        let [u, v] = found.chart_of(place);
        (found.distance(place), found.at(u, v).1)
    };
    let ([x, y, z0], mut z) = (place, place[2]);
    let (mut distance, mut normal) = at(place);
    for _ in 0..STEPS_ALONG_Z {
        if normal[2].abs() < STEEP {
            let (distance, normal) = at(place);
            return (-distance, normal);
        }
        z -= distance / normal[2];
        (distance, normal) = at([x, y, z]);
    }
    (z - z0, normal)
}

/// Angle between two unit vectors, degrees.
fn between(a: [f64; 3], b: [f64; 3]) -> f64 {
    norm(cross(a, b)).atan2(dot(a, b)).to_degrees()
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_world::scene::{Surface, Sweep, World};

    /// A ball of radius 10 under five fingers.
    fn ball() -> (Contacts, Truth) {
        let stations: Vec<f64> = (0..9).map(|k| f64::from(k) - 4.0).collect();
        let sweeps = vec![Sweep::new(vec![-4.0, -2.0, 0.0, 2.0, 4.0], stations)];
        let world = World { surface: Surface::sphere(10.0), sweeps, effects: vec![], laws: vec![] };
        world.compile().unwrap().simulate(1, 0)
    }

    #[test]
    fn a_ball_without_noise_is_found_and_met_along_z() {
        let (contacts, truth) = ball();
        let Ok(FoundSurface::Recognised(found)) = recognise(&contacts, &FitOptions::default()) else { panic!() };
        let judged = judge_recognised(&found, &truth);
        assert!(judged.deviations[R].rms().unwrap() < 1e-6 && judged.deviations[HEIGHT].rms().unwrap() < 1e-6);
        // half a unit above a slope of 45 degrees and more than that of nothing
        let [x, y] = [10.0 * 0.5_f64.sqrt(), 0.0];
        let (height, normal) = met_along_z(&found, [x, y, contacts.z[22] - 10.0 + x + 0.5]);
        assert!((height + 0.5).abs() < 1e-5, "{height}");
        assert!((normal[2] - 0.5_f64.sqrt()).abs() < 1e-5, "{normal:?}");
    }

    #[test]
    fn too_few_contacts_are_fitted_as_on_the_command_line() {
        let (contacts, _) = ball();
        let few = contacts.in_order(&[0, 4, 8]);
        assert!(!matches!(recognise(&few, &FitOptions::default()), Ok(FoundSurface::Recognised(_))));
    }
}
