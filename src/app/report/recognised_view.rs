//! What a recognition adds to the view of its spline: the uncertainties of its map, and the contacts' distances from the
//! recognised surface.

use crate::io::Input;
use palpate_inference::recognition::Recognition;

use super::surface_view::{ContactsView, Standing, SurfaceView, between};

/// Puts contacts and uncertainties of a recognition into the view of its spline.
pub(super) fn recognised_view(found: &Recognition, input: &Input, view: &mut SurfaceView) {
    let surface = &found.surface;
    let of = |pick: fn(&palpate_inference::recognition::MapPoint) -> f64| {
        let values: Vec<f64> = found.map.iter().map(pick).collect();
        let at = |(point, r): (&[f64; 3], &f64)| {
            if r.is_nan() { f64::NAN } else { between(&values, found.grid, found.share_of_map(*point)) }
        };
        view.points.iter().zip(&view.curvedness).map(at).collect::<Vec<f64>>()
    };
    let both = [of(|p| p.u_shape_index), of(|p| p.u_curvedness)];
    view.uncertainty = both.iter().flatten().any(|u| u.is_finite()).then_some(both);
    view.uncertainty_words = if view.uncertainty.is_some() {
        "from noise, from errors that neighbours share, and from doubt about the kind of surface"
    } else {
        "not known point by point"
    };
    let flat = view.axes == ["x", "y"];
    let limit = farthest(found, input);
    view.contacts = Some(ContactsView::new(input, "along the surface's normal", |_, point| {
        let [u, v] = surface.chart_of(point);
        let residual = surface.distance(point);
        let scale = surface.frame.scale;
        let place = if flat { [point[0], point[1]] } else { [scale * u, scale * v] };
        Standing { place, foot: surface.at(u, v).0, residual, left_out: residual.is_nan() || residual.abs() > limit }
    }));
}

/// Distance of the farthest contact that belongs to the surface.
fn farthest(found: &Recognition, input: &Input) -> f64 {
    match input {
        Input::Contacts(contacts) => found.belonging(contacts).last().map_or(f64::INFINITY, |(distance, _)| *distance),
        Input::Grid(_) => f64::INFINITY,
    }
}
