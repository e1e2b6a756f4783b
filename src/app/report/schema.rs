//! The JSON Schemas of `palpate.fit/1`, `palpate.fits/1`, `palpate.diff/1`, `palpate.study/1`, `palpate.frontier/1`, `palpate.explore/1` and `palpate.parts/1`, generated from documents that the types themselves write.
//!
//! A key is required when every sample has it, and may be `null` when some sample has it `null`. So the schema cannot
//! fall behind the structs; `tests/program/schema.rs` holds the committed files to it and real output to the files.

use serde_json::{Map, Value, json};

use super::diff::{DIFF_SCHEMA, diff_samples};
use super::document::*;
use super::explore::{EXPLORE_SCHEMA, explore_samples};
use super::fits::{FITS_SCHEMA, fits_samples};
use super::frontier::FRONTIER_SCHEMA;
use super::frontier_samples::{empty_frontier, frontier_without_pick, full_frontier};
use super::parts::PARTS_SCHEMA;
use super::parts_samples::parts_samples;
use super::study::STUDY_SCHEMA;
use super::study_samples::{empty_study, full_study};
use super::truth_part::TruthPart;
use crate::io::{Coefficient, FIT_SCHEMA, PointUncertainty, SavedFrame, SavedSurface, SupportMap, UncertaintyMap};
use palpate_geometry::curvature::ShapeClass;

/// JSON Schema (draft 2020-12) of `palpate.fit/1`.
pub fn fit_schema() -> Value {
    let samples: Vec<Value> =
        [full(), bare(), emptied(), in_space(), without_labels(), in_cells(Some(0.5)), in_cells(None)]
            .iter()
            .filter_map(|d| serde_json::to_value(d).ok())
            .collect();
    let mut schema = merged(&samples.iter().collect::<Vec<_>>());
    schema["$schema"] = "https://json-schema.org/draft/2020-12/schema".into();
    schema["title"] = FIT_SCHEMA.into();
    schema["properties"]["schema"] = json!({ "const": FIT_SCHEMA });
    schema
}

/// JSON Schema (draft 2020-12) of `palpate.study/1`.
pub fn study_schema() -> Value {
    let samples: Vec<Value> =
        [full_study(), empty_study()].iter().filter_map(|d| serde_json::to_value(d).ok()).collect();
    let mut schema = merged(&samples.iter().collect::<Vec<_>>());
    schema["$schema"] = "https://json-schema.org/draft/2020-12/schema".into();
    schema["title"] = STUDY_SCHEMA.into();
    schema["properties"]["schema"] = json!({ "const": STUDY_SCHEMA });
    // quantities beside S and R stand under the names that they were asked for by
    let quantity = schema["properties"]["S"].clone();
    schema["properties"]["quantities"] = json!({ "type": "object", "additionalProperties": quantity });
    schema
}

/// JSON Schema (draft 2020-12) of `palpate.explore/1`.
pub fn explore_schema() -> Value {
    let documents = explore_samples(full().shape, emptied().shape, bare().shape);
    let samples: Vec<Value> = documents.iter().filter_map(|d| serde_json::to_value(d).ok()).collect();
    let mut schema = merged(&samples.iter().collect::<Vec<_>>());
    schema["$schema"] = "https://json-schema.org/draft/2020-12/schema".into();
    schema["title"] = EXPLORE_SCHEMA.into();
    schema["properties"]["schema"] = json!({ "const": EXPLORE_SCHEMA });
    schema
}

/// JSON Schema (draft 2020-12) of `palpate.parts/1`.
pub fn parts_schema() -> Value {
    let samples: Vec<Value> = parts_samples().iter().filter_map(|d| serde_json::to_value(d).ok()).collect();
    let mut schema = merged(&samples.iter().collect::<Vec<_>>());
    schema["$schema"] = "https://json-schema.org/draft/2020-12/schema".into();
    schema["title"] = PARTS_SCHEMA.into();
    schema["properties"]["schema"] = json!({ "const": PARTS_SCHEMA });
    schema
}

/// JSON Schema (draft 2020-12) of `palpate.diff/1`.
pub fn diff_schema() -> Value {
    let samples: Vec<Value> = diff_samples().iter().filter_map(|d| serde_json::to_value(d).ok()).collect();
    let mut schema = merged(&samples.iter().collect::<Vec<_>>());
    schema["$schema"] = "https://json-schema.org/draft/2020-12/schema".into();
    schema["title"] = DIFF_SCHEMA.into();
    schema["properties"]["schema"] = json!({ "const": DIFF_SCHEMA });
    schema
}

/// JSON Schema (draft 2020-12) of `palpate.fits/1`.
pub fn fits_schema() -> Value {
    let samples: Vec<Value> = fits_samples().iter().filter_map(|d| serde_json::to_value(d).ok()).collect();
    let mut schema = merged(&samples.iter().collect::<Vec<_>>());
    schema["$schema"] = "https://json-schema.org/draft/2020-12/schema".into();
    schema["title"] = FITS_SCHEMA.into();
    schema["properties"]["schema"] = json!({ "const": FITS_SCHEMA });
    schema
}

/// JSON Schema (draft 2020-12) of `palpate.frontier/1`.
pub fn frontier_schema() -> Value {
    let samples: Vec<Value> = [full_frontier(), empty_frontier(), frontier_without_pick()]
        .iter()
        .filter_map(|d| serde_json::to_value(d).ok())
        .collect();
    let mut schema = merged(&samples.iter().collect::<Vec<_>>());
    schema["$schema"] = "https://json-schema.org/draft/2020-12/schema".into();
    schema["title"] = FRONTIER_SCHEMA.into();
    schema["description"] = FRONTIER_WORDS.into();
    schema["properties"]["schema"] = json!({ "const": FRONTIER_SCHEMA });
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

/// The schema that all samples obey.
fn merged(samples: &[&Value]) -> Value {
    let nullable = samples.iter().any(|v| v.is_null());
    let present: Vec<&Value> = samples.iter().copied().filter(|v| !v.is_null()).collect();
    let mut kinds: Vec<&str> = present.iter().map(|v| kind(v)).collect();
    kinds.sort_unstable();
    kinds.dedup();
    if kinds.is_empty() {
        kinds.push("string");
    }
    let mut schema = match kinds[..] {
        ["object"] => object(&present),
        // a coefficient is a number or three of them
        ["array", ..] => array(&present),
        _ => json!({}),
    };
    kinds.extend(nullable.then_some("null"));
    schema["type"] = if let [one] = kinds[..] { one.into() } else { json!(kinds) };
    schema
}

fn kind(value: &Value) -> &'static str {
    match value {
        Value::Object(_) => "object",
        Value::Array(_) => "array",
        Value::Number(n) if n.is_f64() => "number",
        Value::Number(_) => "integer",
        Value::Bool(_) => "boolean",
        _ => "string",
    }
}

fn object(samples: &[&Value]) -> Value {
    let objects: Vec<&Map<String, Value>> = samples.iter().filter_map(|v| v.as_object()).collect();
    let mut properties = Map::new();
    let mut required = Vec::new();
    for key in objects.iter().flat_map(|o| o.keys()) {
        let values: Vec<&Value> = objects.iter().filter_map(|o| o.get(key)).collect();
        if !properties.contains_key(key) {
            if values.len() == objects.len() {
                required.push(key.clone());
            }
            properties.insert(key.clone(), merged(&values));
        }
    }
    required.sort();
    json!({ "properties": properties, "required": required })
}

fn array(samples: &[&Value]) -> Value {
    let items: Vec<&Value> = samples.iter().filter_map(|v| v.as_array()).flatten().collect();
    json!({ "items": merged(&items) })
}

/// A document in which everything is there.
pub(super) fn full() -> FitDocument {
    let measure = MeasurePart {
        mean: Some(0.5),
        sd: Some(0.5),
        u: Some(0.5),
        interval: Some([0.5, 0.5]),
        u_noise: Some(0.5),
        u_model: Some(0.5),
        level: Some(0.5),
        coverage_factor: Some(0.5),
        dof: Some(0.5),
    };
    let spread = SpreadPart { mean: Some(0.5), sd: Some(0.5) };
    let classes = ShapeClass::CURVED.into_iter().chain([ShapeClass::Plane]);
    let shares = classes.map(|class| (class.name().to_string(), 0.5)).collect();
    FitDocument {
        schema: FIT_SCHEMA.into(),
        unit: Some("mm".into()),
        contacts: 1,
        frame: SavedFrame { origin: [0.5; 3], axes: [[0.5; 3]; 3], scale: 0.5 },
        fit: FitPart {
            degree: [2, 2],
            segments: [1, 1],
            weights: Some([0.5; 3]),
            chosen: Some(ChosenPart {
                surface: "height".into(),
                why: "asked for".into(),
                reason: "asked for".into(),
                degree: Some([4, 4]),
                segments: Some([2, 2]),
                frame: Some("keep".into()),
                hypothesis: Some("cylinder".into()),
                tried: vec![
                    TriedPart {
                        name: "cylinder".into(),
                        probability: Some(0.5),
                        k1: Some(0.5),
                        k2: Some(0.5),
                        rms: Some(0.5),
                    },
                    TriedPart::default(),
                ],
            }),
            lack_of_fit: Some(LackOfFitPart { p: Some(0.5), percent_of_relief: Some(0.5), words: "no pattern".into() }),
            parametric: None,
            adaptive: None,
            sigma: Some(SigmaPart {
                z: Some(0.5),
                normal_deg: Some(0.5),
                slope: Some(0.5),
                shared: Some(0.5),
                shared_over: Some(0.5),
            }),
            method: "cholesky".into(),
            reason: "asked for".into(),
            equations: 1,
            unknowns: 1,
            rank: 1,
            condition: Some(0.5),
            backward_error: Some(0.5),
            promise: Some(PromisePart { coefficients: 0.5, shape_index: 0.5, curvedness: 0.5 }),
            refinements: 1,
            smooth: 0.5,
            rms: RmsPart { z: Some(0.5), zx: Some(0.5), zy: Some(0.5), normal_deg: Some(0.5) },
            notes: vec!["a note".into()],
            technical_notes: vec!["a note".into()],
        },
        shape: ShapePart {
            grid: [8, 8],
            shape_index: measure.clone(),
            curvedness: measure,
            radius: Some(0.5),
            radius_interval: Some([0.5, 0.5]),
            radii: Some([0.5, 0.5]),
            class: Some("ridge".into()),
            other_class: Some("cup".into()),
            class_probability: Some(Shares(shares)),
            class_by_area: Some(Shares(vec![("ridge".into(), 0.5)])),
            k1: spread.clone(),
            k2: spread,
            direction_deg: Some(0.5),
            direction: Some([0.5; 3]),
            axis_deg: Some(0.5),
            axis: Some([0.5; 3]),
            axis_within_deg: Some(0.5),
            centre: Some([0.5; 3]),
            support: 0.5,
            plane_p: Some(0.5),
            covariance: Some(0.5),
            intervals: Some(IntervalsPart {
                law: "student_t".into(),
                beside: Some("a cylinder".into()),
                seed: Some(1),
                isa: "portable".into(),
            }),
        },
        truth: Some(TruthPart {
            shape_index: Some(0.5),
            curvedness: Some(0.5),
            error_shape_index: Some(0.5),
            error_curvedness: Some(0.5),
            class: Some("ridge".into()),
            radius: Some(0.5),
            radii: Some([0.5; 2]),
            direction_deg: Some(0.5),
            direction: Some([0.5; 3]),
            axis_deg: Some(0.5),
            axis: Some([0.5; 3]),
        }),
        surface: SavedSurface {
            kind: "height".into(),
            degree: [2, 2],
            knots: [vec![0.5], vec![0.5]],
            coefficients: vec![vec![Coefficient::Height(0.5)]],
            closed: None,
            support: None,
            support_map: Some(SupportMap::of([[0.0, 1.0]; 2], |x, y| x < y)).flatten(),
            splits: None,
            unsupported: vec![1],
        },
        uncertainty: Some(uncertainty()),
        seconds: Seconds { read: 0.5, fit: 0.5, shape: 0.5, total: 0.5 },
    }
}

/// Uncertainties that are known at one point and not at the other.
fn uncertainty() -> UncertaintyMap {
    let half = Some(0.5);
    let known =
        PointUncertainty { position: half, normal_deg: half, shape_index: half, curvedness: half, k1: half, k2: half };
    UncertaintyMap::of([vec![0.5], vec![0.5, 1.5]], &[known, PointUncertainty::default()])
}

/// A parametric surface.
fn in_space() -> FitDocument {
    let mut document = full();
    document.fit.chosen = None;
    document.fit.parametric = Some(ParametricPart {
        parametrisation: "arc lengths of lanes".into(),
        iterations: 1,
        settled: true,
        folds_refused: 1,
        smallest_jacobian: 0.5,
        fold_free: true,
        bending: 1.2,
        fairness_raised: 0,
        fingers_monotone: Some(true),
        against: 1,
        closed: [false; 2],
    });
    document.surface.kind = "parametric".into();
    document.surface.coefficients = vec![vec![Coefficient::Space([0.5; 3])]];
    document.surface.closed = Some([false; 2]);
    document.surface.support = Some(vec![[[0.5; 2]; 3]]);
    document
}

/// An adaptive surface.
fn in_cells(freedom: Option<f64>) -> FitDocument {
    let mut document = full();
    document.fit.chosen = Some(ChosenPart::new("adaptive", "asked for".into()));
    document.fit.adaptive = Some(AdaptivePart {
        cells: 4,
        halvings: 1,
        rounds: 2,
        left_out: 1,
        freedom,
        factor_entries: 10,
        draws_error: Some(0.01),
    });
    document.surface.kind = "adaptive".into();
    document.surface.splits = Some(vec![[0; 3]]);
    document
}

/// A parametric surface whose contacts have no finger and station.
fn without_labels() -> FitDocument {
    let mut document = in_space();
    document.fit.parametric.iter_mut().for_each(|part| part.fingers_monotone = None);
    document
}

/// The same with every value missing that may be, under keys that stay.
fn emptied() -> FitDocument {
    let mut document = full();
    document.fit.sigma = Some(SigmaPart::default());
    document.fit.lack_of_fit = Some(LackOfFitPart::default());
    document.fit.chosen = document.fit.chosen.map(|chosen| ChosenPart::new("height", chosen.why));
    (document.shape.radius_interval, document.shape.radii, document.shape.class_by_area) = (None, None, None);
    document.shape.other_class = None;
    document.shape.intervals = Some(IntervalsPart::default());
    // a named fit has no probability of its own for the plane
    document.shape.class_probability.iter_mut().for_each(|shares| shares.0.retain(|(name, _)| name != "plane"));
    document.truth = Some(TruthPart::default());
    document
}

/// The same with every part missing that may be.
fn bare() -> FitDocument {
    let mut document = full();
    (document.uncertainty, document.surface.support_map) = (None, None);
    document.fit.weights = None;
    document.fit.sigma = None;
    document.fit.condition = None;
    document.fit.backward_error = None;
    document.fit.promise = None;
    document.fit.chosen = None;
    document.fit.lack_of_fit = None;
    document.fit.rms = RmsPart::default();
    document.fit.technical_notes = Vec::new();
    (document.shape.direction, document.shape.axis, document.shape.axis_within_deg) = (None, None, None);
    (document.shape.axis_deg, document.unit) = (None, None);
    document.shape.centre = None;
    document.shape.shape_index = MeasurePart::default();
    document.shape.curvedness = MeasurePart::default();
    document.shape.radius = None;
    document.shape.class = None;
    (document.shape.class_probability, document.shape.class_by_area) = (None, None);
    document.shape.k1 = SpreadPart::default();
    document.shape.k2 = SpreadPart::default();
    document.shape.direction_deg = None;
    document.shape.plane_p = None;
    (document.shape.covariance, document.shape.intervals) = (None, None);
    document.truth = None;
    document
}
