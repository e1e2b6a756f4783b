//! Parts out of a document of `palpate.parts/1`, as a library of objects holds them.

use serde::Deserialize;
use serde_json::Value;

use super::parts::{PARTS_SCHEMA, PartRecord};
use palpate_geometry::curvature::ShapeClass;
use palpate_inference::parts::{Part, PartKind};

/// What a library needs of a document.
#[derive(Deserialize)]
struct SavedParts {
    schema: String,
    spacing: f64,
    parts: Vec<PartRecord>,
}

/// The spacing of the contacts and the parts that they were cut into.
///
/// # Errors
/// What is wrong with the text, in words that follow the file's name.
pub(crate) fn parts_of_document(text: &str) -> Result<(f64, Vec<Part>), String> {
    let wanted = "the library takes the parts.json that palpate parts --out writes";
    let saved: SavedParts = serde_json::from_str(text).map_err(|error| format!("{error}; {wanted}"))?;
    if saved.schema != PARTS_SCHEMA {
        return Err(format!("a document of {}; {wanted}", saved.schema));
    }
    let parts: Result<Vec<Part>, String> = saved.parts.into_iter().map(part).collect();
    Ok((saved.spacing, parts.map_err(|what| format!("{what}; {wanted}"))?))
}

fn part(record: PartRecord) -> Result<Part, String> {
    let kind: PartKind = serde_json::from_value(Value::String(record.kind.clone()))
        .map_err(|_| format!("no kind of part is called '{}'", record.kind))?;
    let flat = (kind == PartKind::Plane).then_some(ShapeClass::Plane);
    Ok(Part {
        id: record.id,
        kind,
        hollow: record.hollow,
        geometry: record.parameters,
        u: record.u,
        class: flat.or(record.shape_index.map(ShapeClass::of_shape_index)),
        other_class: None,
        shape_index: record.shape_index,
        curvedness: record.curvedness,
        points: record.points,
        extent: record.extent,
        misfit: record.misfit,
        rejected: record.rejected,
        p: record.p,
        departure: record.departure,
    })
}
