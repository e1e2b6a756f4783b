//! What other programs do with the same scene, drawn and listed beside palpate's own ways: `--beside FILE`.
//!
//! ```text
//! { "points": [ { "program": "SciPy", "label": "bisplrep, degree 3", "case": "bar",
//!                 "error": 0.02, "error_S": 0.01, "error_R": 0.0004, "seconds": { "median": 0.0012 } } ] }
//! ```
//!
//! The keys are those of `palpate.frontier/1`, so that a `frontier.json` of another version of palpate can stand beside, too.

use std::path::Path;

use serde::Deserialize;

use crate::report::BesidePart;

use super::failure::Failure;

#[derive(Deserialize)]
struct BesideFile {
    points: Vec<BesideRecord>,
}

/// What is read of a point; other keys may stand beside these.
#[derive(Deserialize)]
#[allow(non_snake_case, reason = "keys of the document")]
struct BesideRecord {
    program: String,
    label: String,
    case: Option<String>,
    frontier: Option<String>,
    error: Option<f64>,
    error_S: Option<f64>,
    error_R: Option<f64>,
    seconds: Option<BesideTime>,
    failed: Option<String>,
}

#[derive(Deserialize)]
struct BesideTime {
    median: f64,
    least: Option<f64>,
}

/// The points of `file` that are of the scene or file `subject`, which people call `name`.
pub(super) fn beside(file: &Path, subject: &str, name: &str) -> Result<Vec<BesidePart>, Failure> {
    let wrong = |what: String| Failure::Input(format!("--beside {}: {what}", file.display()));
    let text = std::fs::read_to_string(file).map_err(|error| wrong(error.to_string()))?;
    let read: BesideFile = serde_json::from_str(&text)
        .map_err(|error| wrong(format!("{error}; it takes a document like frontier.json, with a list of points")))?;
    let stem = Path::new(subject).file_stem().map_or(subject, |stem| stem.to_str().unwrap_or(subject));
    let is_of =
        |record: &&BesideRecord| record.case.as_deref().is_none_or(|case| [subject, stem, name].contains(&case));
    let found: Vec<BesidePart> = read.points.iter().filter(is_of).filter_map(part).collect();
    if found.is_empty() {
        let mut cases: Vec<&str> = read.points.iter().filter_map(|record| record.case.as_deref()).collect();
        cases.dedup();
        return Err(wrong(format!(
            "no point with an error and a time is of {stem}; its points are of {}",
            if cases.is_empty() { "nothing".into() } else { cases.join(", ") }
        )));
    }
    Ok(found)
}

/// A point that has an answer, an error and a time; ways to solve equations and to intervals have errors of another kind.
fn part(record: &BesideRecord) -> Option<BesidePart> {
    let seconds = record.seconds.as_ref().map(|seconds| seconds.least.unwrap_or(seconds.median))?;
    let error =
        record.error.filter(|error| error.is_finite() && *error >= 0.0 && seconds.is_finite() && seconds > 0.0)?;
    let is_way = record.frontier.as_deref().is_none_or(|frontier| frontier == "discretisation");
    (is_way && record.failed.is_none()).then(|| BesidePart {
        program: record.program.clone(),
        label: record.label.clone(),
        error,
        error_S: record.error_S,
        error_R: record.error_R,
        seconds,
    })
}
