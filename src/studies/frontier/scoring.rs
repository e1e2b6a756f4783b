//! One call of a configuration, and what the truth says of its answer.
//!
//! ```text
//! call       contacts -> fit, S and R over the grid              (with intervals: their uncertainty as well)
//! judgement  S, R, k1 at every supported point against the true surface there; height and slope over x, y
//! ```

use palpate_fitting::fit::{Fit, FitOptions, Shape};
use palpate_fitting::parametric::{FittedSurface, ParametricFit};
use palpate_geometry::contact::Contacts;
use palpate_world::scene::Truth;

use palpate_numeric::vector::{cross, dot, norm, unit};

use super::configuration::Configuration;
use super::errors::{Deviation, HEIGHT, Judged, K1, NORMAL, R, S, SLOPE};
use super::found_surface::{FoundSurface, TimedAnswer};
use super::recognised::{judge_recognised, judge_unseen, recognise};

/// Angle in degrees between the upward normal of these slopes and a unit normal.
fn angle([zx, zy]: [f64; 2], normal: [f64; 3]) -> f64 {
    let own = unit([-zx, -zy, 1.0]);
    norm(cross(own, normal)).atan2(dot(own, normal)).to_degrees()
}

/// Fits and describes: the call that is timed. With `interval`, uncertainties and intervals are part of it.
pub(super) fn call(contacts: &Contacts, way: &Configuration, interval: bool) -> TimedAnswer {
    if way.recognised { recognise(contacts, &way.options) } else { named(contacts, &way.options, interval) }
}

fn named(contacts: &Contacts, options: &FitOptions, interval: bool) -> TimedAnswer {
    let (found, _) = FittedSurface::of(contacts, options).map_err(|error| error.to_string())?;
    match &found {
        FittedSurface::Height(fit) if interval => {
            fit.shape();
        }
        FittedSurface::Height(fit) => {
            fit.bare_shape();
        }
        // its uncertainties are part of its shape
        FittedSurface::Parametric(fit) => {
            fit.shape();
        }
    }
    Ok(FoundSurface::Named(found))
}

/// Holds an answer against the truth. Without `interval` those of a height field are not asked, which would compute them.
pub(super) fn judge(answer: &TimedAnswer, truth: &Truth, interval: bool) -> Judged {
    match answer {
        Err(why) => Judged { failed: Some(why.clone()), ..Judged::default() },
        Ok(FoundSurface::Named(FittedSurface::Height(fit))) => judge_height(fit, truth, interval),
        Ok(FoundSurface::Named(FittedSurface::Parametric(fit))) => judge_parametric(fit, truth),
        Ok(FoundSurface::Recognised(found)) => judge_recognised(found, truth),
    }
}

fn judge_height(fit: &Fit, truth: &Truth, interval: bool) -> Judged {
    let shape: &Shape = if interval { fit.shape() } else { fit.bare_shape() };
    let (maps, frame) = (&shape.maps, fit.frame());
    let mut judged = Judged { support: shape.support, ..Judged::default() };
    for (i, x) in maps.grid.x.iter().enumerate() {
        for (j, y) in maps.grid.y.iter().enumerate() {
            let Some(curvedness) = maps.curvedness_at(i, j) else { continue };
            let found = &maps.points[[i, j]];
            let place = [*x, *y, found.z];
            let place = if frame.keeps_axes() { place } else { frame.rotate_back(place) };
            let Some(there) = truth.at(place[0], place[1]) else { continue };
            let d = &mut judged.deviations;
            d[R].add(curvedness - there.local.curvedness());
            d[K1].add(maps.k1[[i, j]] - there.local.k1);
            d[HEIGHT].add(place[2] - there.point[2]);
            if let (Some(own), Some(index)) = (maps.shape_index_at(i, j), there.local.shape_index()) {
                d[S].add(own - index);
            }
            let [nx, ny, nz] = there.local.normal;
            // slopes are those over the input's own x and y, and a wall has none
            if frame.keeps_axes() && nz > 0.0 {
                d[SLOPE].add((found.zx + nx / nz).hypot(found.zy + ny / nz));
                d[NORMAL].add(angle([found.zx, found.zy], there.local.normal));
            }
        }
    }
    if shape.shape_index.mean.is_none() {
        // a plane found has no S to be wrong about
        judged.deviations[S] = Deviation::default();
    }
    // means of the truth over the points of the fit are its own means less their shifts
    let means = [shape.shape_index.mean, shape.curvedness.mean];
    let intervals = [shape.shape_index.interval, shape.curvedness.interval];
    judged.held = [S, R].map(|q| {
        let (mean, interval) = means[q].zip(intervals[q]).filter(|_| interval)?;
        let true_mean = mean - judged.deviations[q].shift()?;
        Some(interval.lo <= true_mean && true_mean <= interval.hi)
    });
    judged
}

/// Holds a fit against contacts that it has not seen: heights and, where they are known, normals.
pub(super) fn judge_contacts(answer: &TimedAnswer, unseen: &Contacts) -> Judged {
    let fit = match answer {
        Err(why) => return Judged { failed: Some(why.clone()), ..Judged::default() },
        Ok(FoundSurface::Recognised(found)) => return judge_unseen(found, unseen),
        Ok(FoundSurface::Named(FittedSurface::Parametric(_))) => {
            let why = "a parametric surface has no height over x and y".to_string();
            return Judged { failed: Some(why), ..Judged::default() };
        }
        Ok(FoundSurface::Named(FittedSurface::Height(fit))) => fit,
    };
    let surface = match fit.input_surface() {
        Ok(surface) => surface,
        Err(why) => return Judged { failed: Some(why.to_string()), ..Judged::default() },
    };
    let mut judged = Judged { support: fit.bare_shape().support, ..Judged::default() };
    for r in 0..unseen.len() {
        let found = surface.at(unseen.x[r], unseen.y[r]);
        judged.deviations[HEIGHT].add(found.z - unseen.z[r]);
        if let Some(normal) = unseen.unit_normal(r).filter(|normal| normal[2] > 0.0) {
            judged.deviations[NORMAL].add(angle([found.zx, found.zy], normal));
            let slopes = [-normal[0] / normal[2], -normal[1] / normal[2]];
            judged.deviations[SLOPE].add((found.zx - slopes[0]).hypot(found.zy - slopes[1]));
        }
    }
    judged
}

fn judge_parametric(fit: &ParametricFit, truth: &Truth) -> Judged {
    let shape = fit.shape();
    let maps = &shape.maps;
    let mut judged = Judged { support: shape.support, ..Judged::default() };
    for (at, _) in maps.supported.indexed_iter().filter(|(_, supported)| **supported) {
        let Some(local) = truth.near(maps.points[at], maps.normals[at]) else { continue };
        let d = &mut judged.deviations;
        d[R].add(maps.curvedness[at] - local.curvedness());
        d[K1].add(maps.k1[at] - local.k1);
        if let Some(index) = local.shape_index() {
            d[S].add(maps.shape_index[at] - index);
        }
    }
    if shape.shape_index.mean.is_none() {
        judged.deviations[S] = Deviation::default();
    }
    let means = [shape.shape_index.mean, shape.curvedness.mean];
    let intervals = [shape.shape_index.interval, shape.curvedness.interval];
    judged.held = [S, R].map(|q| {
        let (mean, interval) = means[q].zip(intervals[q])?;
        let true_mean = mean - judged.deviations[q].shift()?;
        Some(interval.lo <= true_mean && true_mean <= interval.hi)
    });
    judged
}
