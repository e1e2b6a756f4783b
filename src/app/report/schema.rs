//! The JSON Schemas (draft 2020-12) of the documents, as they are written: made from the types, with the comments of their fields as
//! descriptions. `tests/program/schema.rs` holds the committed files to these and real output to the files.

use std::borrow::Cow;

use schemars::generate::SchemaSettings;
use schemars::transform::RecursiveTransform;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde_json::{Map, Value, json};

use super::diff::{DIFF_SCHEMA, DiffDocument};
use super::document::{FitDocument, Shares};
use super::explore::{EXPLORE_SCHEMA, ExploreDocument};
use super::fits::{FITS_SCHEMA, FitsDocument};
use super::frontier::{FRONTIER_SCHEMA, FrontierDocument};
use super::parts::{PARTS_SCHEMA, PartsDocument};
use super::study::{STUDY_SCHEMA, StudyDocument};
use crate::io::FIT_SCHEMA;
use palpate_geometry::curvature::ShapeClass;

/// JSON Schema of `palpate.fit/1`.
pub fn fit_schema() -> Value {
    schema_of::<FitDocument>(FIT_SCHEMA)
}

/// JSON Schema of `palpate.study/1`.
pub fn study_schema() -> Value {
    let mut schema = schema_of::<StudyDocument>(STUDY_SCHEMA);
    // replicates without a class are counted, too
    schema["properties"]["class"]["properties"]["none"] = json!({ "type": "number" });
    schema
}

/// JSON Schema of `palpate.explore/1`.
pub fn explore_schema() -> Value {
    schema_of::<ExploreDocument>(EXPLORE_SCHEMA)
}

/// JSON Schema of `palpate.parts/1`.
pub fn parts_schema() -> Value {
    schema_of::<PartsDocument>(PARTS_SCHEMA)
}

/// JSON Schema of `palpate.diff/1`.
pub fn diff_schema() -> Value {
    schema_of::<DiffDocument>(DIFF_SCHEMA)
}

/// JSON Schema of `palpate.fits/1`.
pub fn fits_schema() -> Value {
    schema_of::<FitsDocument>(FITS_SCHEMA)
}

/// JSON Schema of `palpate.frontier/1`.
pub fn frontier_schema() -> Value {
    let mut schema = schema_of::<FrontierDocument>(FRONTIER_SCHEMA);
    schema["description"] = FRONTIER_WORDS.into();
    schema
}

/// What a record of a frontier is, for those who read or write one.
const FRONTIER_WORDS: &str = "A record of `points` is one way of computing S and R. Required of other programs: frontier \
    (discretisation, solver, interval), case (scene or file), program, label, method, error_S, error_R, seconds {median, lo, \
    hi}, contacts, failed (null, or why there is no answer); a record that lacks other keys is read as if they were null. \
    error_S and error_R are root mean squares over the shape grid and the replicates, R in 1/length; `error` is \
    sqrt(error_S^2 + (error_R/true R)^2), of a solver 10^-digits, of an interval the error of its ends over its half width. \
    `errors` holds rms, interval, worst, bias, sd, upper of S, R, k1, height, slope and normal_deg. `seconds` is a call without intervals, \
    `seconds_interval` one with them. frontier.csv has one line a record, nested keys joined by a full stop, in the order of \
    `points`; frontier.parquet has its numbers.";

/// The schema of a document of this name, everything in one piece.
fn schema_of<T: JsonSchema>(name: &str) -> Value {
    let settings = SchemaSettings::draft2020_12().for_serialize().with(|settings| settings.inline_subschemas = true);
    let mut schema = settings
        .with_transform(RecursiveTransform(in_plain_words))
        .into_generator()
        .into_root_schema_for::<T>()
        .to_value();
    schema["title"] = name.into();
    schema["properties"]["schema"]["const"] = name.into();
    schema
}

/// A comment runs over its lines; how many bits a number has, and what a reader puts for a missing key, is no matter of the document.
fn in_plain_words(schema: &mut Schema) {
    schema.remove("format");
    schema.remove("default");
    if let Some(Value::String(words)) = schema.get_mut("description") {
        *words = words.replace('\n', " ");
    }
}

/// A share for each class that there may be.
impl JsonSchema for Shares {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "Shares".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let classes = ShapeClass::CURVED.into_iter().chain([ShapeClass::Plane]);
        let shares: Map<String, Value> =
            classes.map(|class| (class.name().into(), json!({ "type": "number" }))).collect();
        json_schema!({ "type": "object", "properties": shares })
    }
}
