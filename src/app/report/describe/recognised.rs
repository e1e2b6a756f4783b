//! A recognised surface described: S and R are those of the recognition, the surface in the document is its spline.
//!
//! ```text
//! shape, intervals, class     from the recognition, averaged where contacts support the surface
//! surface, maps, picture      from the spline through the recognised surface
//! ```

use std::borrow::Cow;

use ndarray::Array2;

use crate::io::{AnySurface, Input, SupportMap};
use crate::report::document::{ChosenPart, FitDocument, FitPart, LackOfFitPart, RmsPart, SigmaPart, TriedPart};
use crate::report::shape_part::shape_part;
use crate::report::subject::{Source, Subject};
use crate::report::surface_maps::{Maps, ShownGrid};
use crate::report::uncertainty;
use palpate_fitting::fit::FitError;
use palpate_geometry::contact::{Contacts, Frame, Grid, counted};
use palpate_geometry::shape::{PointSds, parametric_maps_at, uv_grid};
use palpate_inference::recognition::{MapPoint, NormalsUse, Pointwise, RecognisedSpline, Recognition, Tried};
use palpate_world::scene::Truth;

use super::Found;
use super::truth::{TruePlace, truth_part};

/// What a recognition found.
///
/// # Errors
/// When the input's own rounding leaves no distinct knots.
pub(super) fn found<'a>(found: &'a Recognition, subject: &Subject<'a>) -> Result<Found<'a>, FitError> {
    // samples of the surface support all coefficients of a map into space
    let (surface, saved_frame, unsupported) = match found.spline()? {
        RecognisedSpline::Height { surface, fit } => (AnySurface::Height(surface), *fit.frame(), fit.without_data()),
        RecognisedSpline::Parametric { surface, support } => {
            (AnySurface::Parametric(surface, support), found.frame, Vec::new())
        }
    };
    Ok(Found {
        contacts: found.contacts + found.outliers,
        saved_frame,
        frame: Frame::IDENTITY,
        fit: fit_part(found, &surface, subject),
        shape: shape_part(&found.shape(), found.grid, found.curvedness.level),
        truth: subject.truth.map(|truth| truth_part(&found.shape(), truth, &against(found, truth))),
        surface,
        unsupported: Cow::Owned(unsupported),
        source: Source::Recognised { found, input: subject.input },
    })
}

/// The true surface at the supported points of the recognition's map, along the recognised normal.
fn against(found: &Recognition, truth: &Truth) -> Vec<TruePlace> {
    let supported = found.map.iter().filter(|place| place.supported);
    let place = |p: &MapPoint| {
        let local = truth.near(p.position, p.normal)?;
        Some(TruePlace { found: (p.shape_index, p.curvedness), point: p.position, local })
    };
    supported.filter_map(place).collect()
}

/// Maps over the spline's domain where contacts surround the recognised surface.
pub(in crate::report) fn maps(found: &Recognition, surface: &AnySurface, points: [usize; 2]) -> Maps<'static> {
    // means are over the supported points of the recognition's own map, and the maps show these
    let own = (points == found.grid).then(|| supported(found));
    let shown = ShownGrid { points, inset: 0.0, again: false };
    match (surface, own) {
        (AnySurface::Parametric(surface, _), Some(own)) => {
            let grid = uv_grid(surface.knots().each_ref(), points, 0.0);
            let mut maps = parametric_maps_at(surface, grid, &own);
            as_recognised(found, |at, here| {
                (maps.points[at], maps.normals[at]) = (here.position, here.normal);
                (maps.k1[at], maps.k2[at]) = (here.k1, here.k2);
                (maps.shape_index[at], maps.curvedness[at]) = (here.shape_index.unwrap_or(f64::NAN), here.curvedness);
            });
            Maps::Parametric(Cow::Owned(maps))
        }
        (_, own) => {
            let mut maps = Maps::over(surface, shown, &[]);
            if let Maps::Height(maps) = &mut maps {
                let maps = maps.to_mut();
                match own {
                    Some(own) => {
                        maps.supported = own;
                        as_recognised(found, |at, here| {
                            maps.points[at].z = here.position[2];
                            (maps.k1[at], maps.k2[at]) = (here.k1, here.k2);
                            let s = here.shape_index.unwrap_or(f64::NAN);
                            (maps.shape_index[at], maps.curvedness[at]) = (s, here.curvedness);
                        });
                    }
                    None => {
                        let held = Array2::from_shape_fn(maps.supported.dim(), |(i, j)| {
                            supports(found, [maps.grid.x[i], maps.grid.y[j], maps.points[[i, j]].z])
                        });
                        // where none is left the recognition took its means over all points, and says so in its support
                        maps.leave_out(&held);
                    }
                }
            }
            maps
        }
    }
}

/// Puts the recognition's own places and curvatures in the place of its spline's, where contacts support them: a spline through the
/// surface bends a little otherwise, and through a body that closes on itself by more than noise.
fn as_recognised(found: &Recognition, mut put: impl FnMut([usize; 2], &MapPoint)) {
    let [_, m] = found.grid;
    let supported = found.map.iter().enumerate().filter(|(_, here)| here.supported);
    supported.for_each(|(number, here)| put([number / m, number % m], here));
}

/// Whether contacts surround the recognised surface next to a place.
fn supports(found: &Recognition, place: [f64; 3]) -> bool {
    let [u, v] = found.chart_of(place);
    found.supported_at(u, v)
}

/// Which points of the recognition's map contacts support.
fn supported(found: &Recognition) -> Array2<bool> {
    let [_, m] = found.grid;
    Array2::from_shape_fn(found.grid, |(i, j)| found.map.get(i * m + j).is_some_and(|p| p.supported))
}

/// Where contacts support a spline over x and y, and the standard uncertainties at the places where they are saved.
pub(in crate::report) fn support_and_sds(
    found: &Recognition,
    surface: &AnySurface,
    input: &Input,
) -> (Option<SupportMap>, Vec<Option<PointSds>>) {
    let map = surface.map();
    let place = |u: f64, v: f64| map.jet([u, v]).point;
    let support_map = match surface {
        AnySurface::Height(_) => SupportMap::of(map.domain(), |x, y| supports(found, place(x, y))),
        AnySurface::Parametric(..) | AnySurface::Hierarchical(_) => None,
    };
    let pointwise = match input {
        Input::Contacts(contacts) => Pointwise::new(found, contacts),
        Input::Grid(grid) => Pointwise::new(found, &pixels(grid)),
    };
    let [u, v] = uncertainty::places(surface.knots());
    let places = u.iter().flat_map(|u| v.iter().map(move |v| (*u, *v)));
    (support_map, places.map(|(u, v)| pointwise.at(place(u, v))).collect())
}

/// The measured pixels of a grid.
fn pixels(grid: &Grid) -> Contacts {
    let known = grid.z.indexed_iter().filter(|(_, z)| !z.is_nan());
    let points: Vec<[f64; 3]> = known.map(|((i, j), z)| [grid.x[i], grid.y[j], *z]).collect();
    Contacts::from_points(&points)
}

/// Equations and unknowns of the shape that was recognised.
fn size(found: &Recognition) -> [usize; 2] {
    let normals = if found.normals == NormalsUse::Believed { 2 * found.contacts } else { 0 };
    [found.contacts + normals, found.hypothesis.unknowns()]
}

fn fit_part(found: &Recognition, surface: &AnySurface, subject: &Subject) -> FitPart {
    let knots = surface.knots();
    let (degree, segments) = ([0, 1].map(|k| knots[k].degree()), [0, 1].map(|k| knots[k].n_segments()));
    let [equations, unknowns] = size(found);
    let noise = &found.noise;
    FitPart {
        degree,
        segments,
        weights: None,
        chosen: Some(chosen(found, surface, degree, segments)),
        lack_of_fit: Some(LackOfFitPart {
            p: Some(found.misfit.p),
            percent_of_relief: Some(found.misfit.percent_of_relief),
            words: found.misfit.words.clone(),
        }),
        parametric: None,
        adaptive: None,
        sigma: Some(SigmaPart {
            z: Some(noise.sd_z),
            normal_deg: noise.sd_normal_deg,
            slope: None,
            shared: (noise.sd_correlated > 0.0).then_some(noise.sd_correlated),
            shared_over: noise.correlation_length,
        }),
        method: "recognition".into(),
        reason: format!("simple shapes weighed by their evidence; normals {}", found.normals.name()),
        equations,
        unknowns,
        rank: unknowns,
        condition: None,
        backward_error: None,
        promise: None,
        refinements: 0,
        smooth: 0.0,
        rms: RmsPart { z: rms(found, subject.input), ..RmsPart::default() },
        notes: subject
            .notes
            .iter()
            .cloned()
            .chain(set_aside(found))
            .chain(found.notes.iter().map(ToString::to_string))
            .collect(),
        technical_notes: Vec::new(),
    }
}

/// Root mean square distance of the contacts that belong to the surface.
fn rms(found: &Recognition, input: &Input) -> Option<f64> {
    let Input::Contacts(contacts) = input else {
        let best = found.tried.iter().find(|t| t.hypothesis == found.hypothesis)?;
        return Some(best.rms);
    };
    let kept = found.belonging(contacts);
    (!kept.is_empty()).then(|| (kept.iter().map(|(d, _)| d * d).sum::<f64>() / kept.len() as f64).sqrt())
}

/// Contacts and normals that were set aside or changed, in words.
fn set_aside(found: &Recognition) -> Vec<String> {
    let known = found.contacts + found.outliers - found.normals_of_length_zero;
    // without a viewpoint the side of most normals is taken
    let by_viewpoint = 2 * found.normals_flipped > known;
    let reversed = match found.normals_flipped {
        flipped if flipped >= known => "pointed away from the viewpoint: all reversed",
        _ if by_viewpoint => "pointed away from the viewpoint, or to the other side than the neighbours: reversed",
        _ => "pointed to the other side than the neighbours: reversed",
    };
    let set_aside = [
        (found.outliers, "contact", "too far off the surface to belong to it: left out"),
        (
            found.normals_of_length_zero,
            "normal",
            "of length 0 or empty: not known, these contacts count by their places alone",
        ),
        (found.normals_flipped, "normal", reversed),
        (found.normals_against, "normal", "more than 60 degrees off the surface: left out"),
    ];
    let some = set_aside.iter().filter(|(count, _, _)| *count > 0);
    some.map(|(count, thing, what)| format!("{} {what}", counted(*count, thing))).collect()
}

fn chosen(found: &Recognition, surface: &AnySurface, degree: [usize; 2], segments: [usize; 2]) -> ChosenPart {
    let (surface, frame) = match surface {
        AnySurface::Height(_) => ("height", "keep"),
        AnySurface::Parametric(..) => ("parametric", "auto"),
        AnySurface::Hierarchical(_) => ("adaptive", "keep"),
    };
    ChosenPart {
        degree: Some(degree),
        segments: Some(segments),
        frame: Some(frame.into()),
        hypothesis: Some(found.hypothesis.name().into()),
        tried: tried(found),
        ..ChosenPart::new(surface, why(found))
    }
}

/// Why this kind was chosen.
fn why(found: &Recognition) -> String {
    let best = found.tried.iter().find(|t| t.hypothesis == found.hypothesis);
    let weight = best.map_or(1.0, |t| t.weight);
    let next = found.tried.iter().find(|t| t.hypothesis != found.hypothesis);
    let beside = next.map_or(String::new(), |t| format!("; next best: {} ({:.3})", t.hypothesis, t.weight));
    let best = format!("{} explains the contacts best (probability {weight:.3})", found.hypothesis.described());
    match next.filter(|t| t.weight > weight) {
        // a plane is an answer only where it is likelier than all that bend
        Some(flat) => format!("of what bends, {best}; {} has {:.3}", flat.hypothesis.described(), flat.weight),
        None => best + &beside,
    }
}

fn tried(found: &Recognition) -> Vec<TriedPart> {
    let one = |t: &Tried| TriedPart {
        name: t.hypothesis.name().into(),
        probability: Some(t.weight),
        k1: Some(t.k1),
        k2: Some(t.k2),
        rms: Some(t.rms),
    };
    found.tried.iter().map(one).collect()
}

/// Puts what touches have moved since it was recognised into a document of it: S, R, class, radius and kinds. Surface, noise and remarks
/// stay.
pub(crate) fn move_document(document: &mut FitDocument, found: &Recognition) {
    document.contacts = found.contacts + found.outliers;
    document.shape = shape_part(&found.shape(), found.grid, found.curvedness.level);
    [document.fit.equations, document.fit.unknowns] = size(found);
    if let Some(chosen) = &mut document.fit.chosen {
        (chosen.why, chosen.tried) = (why(found), tried(found));
    }
}
