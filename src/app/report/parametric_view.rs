//! A surface in space as a page shows it: `Q(u, v)` with its normals, and its control points.

use crate::io::Input;
use palpate_geometry::shape::ParametricMaps;
use palpate_geometry::surface::Parametric;

use super::surface_view::{ContactsView, Standing, SurfaceView};

/// The view of a surface in space, without contacts and uncertainties.
pub(super) fn parametric_view(surface: &Parametric, maps: &ParametricMaps) -> SurfaceView {
    let knots = surface.knots();
    let masked = |map: &ndarray::Array2<f64>| {
        let both = map.iter().zip(&maps.supported);
        both.map(|(value, supported)| if *supported { *value } else { f64::NAN }).collect()
    };
    // where nothing is supported the maps have no normals, but the surface does
    let normal = |((i, j), known): ((usize, usize), &[f64; 3])| {
        if known[0].is_finite() {
            return *known;
        }
        surface.at(maps.grid.x[i], maps.grid.y[j]).principal().map_or([f64::NAN; 3], |p| p.normal)
    };
    let net = surface.coefficients();
    SurfaceView {
        axes: ["u", "v"],
        places: [maps.grid.x.clone(), maps.grid.y.clone()],
        points: maps.points.iter().copied().collect(),
        normals: maps.normals.indexed_iter().map(normal).collect(),
        shape_index: masked(&maps.shape_index),
        curvedness: masked(&maps.curvedness),
        uncertainty: None,
        uncertainty_words: "not computed point by point for a surface in space that was named by options",
        closed: [knots[0].is_closed(), knots[1].is_closed()],
        net: ([net.nrows(), net.ncols()], net.iter().copied().collect()),
        contacts: None,
        flat: None,
    }
}

/// Contacts beside their feet: where nearest points were found for as many contacts as there are.
pub(super) fn contacts_on_feet(surface: &Parametric, input: &Input, feet: &[[f64; 2]]) -> ContactsView {
    ContactsView::new(input, "along the surface's normal", |number, point| {
        let place = feet.get(number).copied().unwrap_or([f64::NAN; 2]);
        let here = surface.at(place[0], place[1]);
        let normal = here.principal().map_or([f64::NAN; 3], |p| p.normal);
        let residual = (0..3).map(|k| (point[k] - here.point[k]) * normal[k]).sum();
        Standing { place, foot: here.point, residual, left_out: false }
    })
}
