//! The data of the turning view: columns in single precision about the patch's middle, enough for a picture. The surface
//! itself stands in the page's document in full.

use serde_json::{Value, json};

use super::super::colour::{DIVERGING, FADE, Field, VIRIDIS};
use crate::io::base64;
use crate::report::surface_view::{ContactsView, SurfaceView, Vector};

/// Normals, and likewise residuals, that are drawn as strokes; more would be a fur.
pub(super) const STROKES: usize = 4000;

/// The data as JSON.
pub(super) fn view_data(view: &SurfaceView, fields: &[Field], unit: Option<&str>) -> String {
    let centre = middle(view);
    let near = |points: &[Vector]| singles(points.iter().flat_map(|p| [0, 1, 2].map(|k| p[k] - centre[k])));
    let fields: Vec<Value> = fields
        .iter()
        .map(|field| {
            json!({
                "key": field.key,
                "name": field.name,
                "ends": field.ends,
                "stops": field.stops,
                "fades": field.fading.map(|(_, largest)| largest * FADE),
                "values": singles(field.values.iter().copied()),
            })
        })
        .collect();
    let ([rows, columns], net) = (&view.net.0, &view.net.1);
    json!({
        "centre": centre,
        "axes": view.axes,
        "unit": unit,
        "places": view.places,
        "closed": view.closed,
        "points": near(&view.points),
        "normals": singles(view.normals.iter().flatten().copied()),
        "fields": fields,
        "net": {"size": [rows, columns], "points": near(net)},
        "contacts": view.contacts.as_ref().map(|contacts| contacts_data(contacts, &near)),
        "scales": {"diverging": DIVERGING, "viridis": VIRIDIS},
    })
    .to_string()
}

fn contacts_data(contacts: &ContactsView, near: &dyn Fn(&[Vector]) -> String) -> Value {
    let step = contacts.points.len().div_ceil(STROKES).max(1);
    let some = |all: &[Vector]| all.iter().step_by(step).copied().collect::<Vec<Vector>>();
    let normals = contacts.normals.as_deref().map(some);
    let out: Vec<usize> = (0..contacts.left_out.len()).filter(|k| contacts.left_out[*k]).collect();
    json!({
        "all": contacts.all,
        "points": near(&contacts.points),
        "residuals": singles(contacts.residuals.iter().copied()),
        "leftOut": out,
        "step": step,
        "feet": near(&some(&contacts.feet)),
        "normals": normals.map(|normals| singles(normals.iter().flatten().copied())),
        "measured": contacts.measured,
    })
}

/// The middle of the box around the mesh.
fn middle(view: &SurfaceView) -> Vector {
    [0, 1, 2].map(|k| {
        let finite = view.points.iter().map(|p| p[k]).filter(|v| v.is_finite());
        let (lo, hi) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
        if lo <= hi { 0.5 * (lo + hi) } else { 0.0 }
    })
}

/// Numbers in single precision, lowest byte first, in base 64.
pub(super) fn singles(values: impl Iterator<Item = f64>) -> String {
    let bytes: Vec<u8> = values.flat_map(|v| (v as f32).to_le_bytes()).collect();
    base64(&bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_in_single_precision() {
        assert_eq!(singles([1.0].into_iter()), "AACAPw==");
    }
}
