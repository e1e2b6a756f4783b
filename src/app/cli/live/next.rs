//! What to touch next: the place that tells most of S and R, or the one farthest from all touches.
//!
//! ```text
//! patch seen from above     TouchPlanner over a lattice of x and y       by "shape"
//! body                      point of the map, by draws of the posterior  by "shape"
//! steep patch               point of the map farthest from a touch       by "farthest"
//! no answer yet             place of the lattice farthest from a touch   by "farthest"
//! ```

use std::borrow::Cow;

use serde::Serialize;

use crate::cli::found::Found;
use crate::report::Answer;
use palpate_fitting::fit::Fit;
use palpate_fitting::parametric::FittedSurface;
use palpate_geometry::contact::{Contacts, Orientation};
use palpate_inference::recognition::Recognition;
use palpate_studies::explore::{TouchPlanner, best_of_map, planning_fit};
use palpate_world::scene::linspace;

/// Places each way at which a touch may be made.
const LATTICE_PLACES: usize = 21;

/// Least nz of a patch that is planned over x and y: 70 degrees, beyond which a height field tells nothing of the surface.
const STEEPEST_NZ: f64 = 0.34;

/// Where touches may be made.
#[derive(Clone, Debug)]
pub(in crate::cli) enum TouchReach {
    /// In a rectangle of x and y, or in that of the touches so far.
    Rectangle(Option<[f64; 4]>),
    /// At one of these places.
    Places(Vec<[f64; 2]>),
}

/// The touch that is proposed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct NextTouch {
    /// x and y.
    pub(super) at: [f64; 2],
    /// Height at which the surface is expected; `None` where nothing is known of it.
    pub(super) z: Option<f64>,
    /// Outward unit normal that is expected there.
    pub(super) normal: Option<[f64; 3]>,
    /// `shape` where it lowers the uncertainties of S and R most, `farthest` where it lies farthest from all touches.
    pub(super) by: &'static str,
}

/// The next touch after these contacts; `None` where no place is left or known.
pub(super) fn next_touch(found: Option<&Found>, contacts: &Contacts, reach: &TouchReach) -> Option<NextTouch> {
    if let Some(body) = found.and_then(body) {
        return best_of_body(body).or_else(|| farthest_of_map(body, contacts));
    }
    let places = untouched(reach, contacts);
    let planned = found.and_then(|found| planned(found, contacts, &places, reach));
    planned.or_else(|| {
        let at = farthest(&places, |place| nearest(contacts, |x, y, _| (x - place[0]).hypot(y - place[1])))?;
        Some(NextTouch { at, z: None, normal: None, by: "farthest" })
    })
}

/// What no height field over x and y follows.
fn body(found: &Found) -> Option<&Recognition> {
    match &found.answer {
        Answer::Recognised(found) => Some(&**found).filter(|found| {
            let steep = |normal: &[f64; 3]| normal[2] < STEEPEST_NZ;
            found.averaged.iter().any(|(_, normal)| steep(normal))
        }),
        Answer::Adaptive(_) | Answer::Fitted(_) => None,
    }
}

fn best_of_body(body: &Recognition) -> Option<NextTouch> {
    let point = body.map.get(best_of_map(body)?)?;
    let [x, y, z] = point.position;
    Some(NextTouch { at: [x, y], z: Some(z), normal: Some(point.normal), by: "shape" })
}

fn farthest_of_map(body: &Recognition, contacts: &Contacts) -> Option<NextTouch> {
    let apart = |[a, b, c]: [f64; 3]| nearest(contacts, |x, y, z| (x - a).hypot(y - b).hypot(z - c));
    let point = farthest(&body.map, |point| apart(point.position))?;
    let [x, y, z] = point.position;
    Some(NextTouch { at: [x, y], z: Some(z), normal: Some(point.normal), by: "farthest" })
}

/// The place whose touch lets the uncertainties of S and R fall most.
fn planned(found: &Found, contacts: &Contacts, places: &[[f64; 2]], reach: &TouchReach) -> Option<NextTouch> {
    let fit: Cow<Fit> = match &found.answer {
        Answer::Recognised(found) => Cow::Owned(planning_fit(&with_whole_normals(contacts), Some(found))?),
        Answer::Fitted(FittedSurface::Height(fit)) => Cow::Borrowed(&**fit),
        Answer::Adaptive(_) | Answer::Fitted(FittedSurface::Parametric(_)) => return None,
    };
    let mut planner = TouchPlanner::new(&fit).ok()?;
    let best = *planner.next_touches(places, 1).ok()?.first()?;
    let at @ [x, y] = places[best];
    let known = surrounds(contacts, at) || matches!(reach, TouchReach::Places(_));
    let surface = fit.input_surface().ok().filter(|_| known).map(|surface| surface.at(x, y));
    let (z, normal) =
        (surface.as_ref().map(|s| s.z), surface.as_ref().map(palpate_geometry::surface::SurfacePoint::normal));
    Some(NextTouch { at, z, normal, by: "shape" })
}

/// Positions alone where some normals are not known.
fn with_whole_normals(contacts: &Contacts) -> Cow<'_, Contacts> {
    let Orientation::Normals { nx, ny, nz } = &contacts.orientation else { return Cow::Borrowed(contacts) };
    let unknown = (0..nx.len()).any(|k| nx[k] == 0.0 && ny[k] == 0.0 && nz[k] == 0.0);
    if unknown {
        Cow::Owned(Contacts { orientation: Orientation::None, ..contacts.clone() })
    } else {
        Cow::Borrowed(contacts)
    }
}

/// Least and largest x and y.
fn rectangle(contacts: &Contacts) -> [f64; 4] {
    let ends =
        |values: &[f64]| values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(*v), b.max(*v)]);
    let ([x0, x1], [y0, y1]) = (ends(&contacts.x), ends(&contacts.y));
    [x0, x1, y0, y1]
}

fn surrounds(contacts: &Contacts, [x, y]: [f64; 2]) -> bool {
    let [x0, x1, y0, y1] = rectangle(contacts);
    (x0..=x1).contains(&x) && (y0..=y1).contains(&y)
}

/// The places of the reach that were not touched: a place touched twice tells of noise and not of shape.
fn untouched(reach: &TouchReach, contacts: &Contacts) -> Vec<[f64; 2]> {
    let places = match reach {
        TouchReach::Places(places) => Cow::Borrowed(places),
        TouchReach::Rectangle(asked) => {
            let [x0, x1, y0, y1] = asked.unwrap_or_else(|| rectangle(contacts));
            if !(x1 > x0 && y1 > y0) {
                return Vec::new();
            }
            let [xs, ys] = [[x0, x1], [y0, y1]].map(|[a, b]| linspace(a, b, LATTICE_PLACES));
            Cow::Owned(xs.iter().flat_map(|x| ys.iter().map(|y| [*x, *y])).collect())
        }
    };
    let [x0, x1, y0, y1] = rectangle(contacts);
    let near = 1e-6 * (x1 - x0).hypot(y1 - y0);
    let is_new = |place: &&[f64; 2]| {
        contacts.is_empty() || nearest(contacts, |x, y, _| (x - place[0]).hypot(y - place[1])) > near
    };
    places.iter().filter(is_new).copied().collect()
}

/// Distance of the nearest contact.
fn nearest(contacts: &Contacts, distance: impl Fn(f64, f64, f64) -> f64) -> f64 {
    let each = contacts.x.iter().zip(&contacts.y).zip(&contacts.z);
    each.map(|((x, y), z)| distance(*x, *y, *z)).fold(f64::INFINITY, f64::min)
}

/// The first of those with the largest distance.
fn farthest<T: Copy>(places: &[T], distance: impl Fn(&T) -> f64) -> Option<T> {
    let far = places.iter().map(|place| (place, distance(place)));
    far.reduce(|best, next| if next.1 > best.1 { next } else { best }).map(|(place, _)| *place)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_an_answer_the_farthest_place_of_the_reach_is_touched() {
        let contacts = Contacts::from_points(&[[0.0, 0.0, 1.0], [1.0, 0.2, 1.0]]);
        let next = next_touch(None, &contacts, &TouchReach::Rectangle(Some([0.0, 4.0, 0.0, 4.0]))).unwrap();
        assert_eq!((next.at, next.z, next.by), ([4.0, 4.0], None, "farthest"));
        // one row of touches spans no rectangle
        let row = Contacts::from_points(&[[0.0, 0.0, 1.0], [1.0, 0.0, 1.0]]);
        assert_eq!(next_touch(None, &row, &TouchReach::Rectangle(None)), None);
        let places = TouchReach::Places(vec![[1.0, 0.0], [0.5, 0.0]]);
        assert_eq!(next_touch(None, &row, &places).unwrap().at, [0.5, 0.0]);
    }
}
