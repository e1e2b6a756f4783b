//! `palpate.frontier/1`: every point of every frontier as a record, and what was picked.
//!
//! ```text
//! Point -> FrontierRecord -> JSON, and flat columns for CSV and Parquet
//! ```
//!
//! Other programs write records of the same keys, so that their points stand in the same pictures.

use schemars::JsonSchema;
use serde::Serialize;

use palpate_studies::frontier::{Clocked, Errors, Frontier, Point, QUANTITIES, Share};

/// Schema name.
pub(crate) const FRONTIER_SCHEMA: &str = "palpate.frontier/1";

/// Errors of the six quantities; null where they are undefined or not judged.
#[derive(Clone, Copy, Debug, Default, Serialize, JsonSchema)]
pub(crate) struct AllErrorsPart {
    /// Shape index.
    #[serde(rename = "S")]
    pub shape_index: Option<Errors>,
    /// Curvedness, 1/length.
    #[serde(rename = "R")]
    pub curvedness: Option<Errors>,
    /// Larger principal curvature, 1/length.
    pub k1: Option<Errors>,
    /// Height, length.
    pub height: Option<Errors>,
    /// Slope.
    pub slope: Option<Errors>,
    /// Angle between the normals, degrees.
    pub normal_deg: Option<Errors>,
}

/// Coverage of the intervals of S and of R.
#[derive(Clone, Copy, Debug, Default, Serialize, JsonSchema)]
pub(crate) struct CoveragePart {
    /// Of S.
    #[serde(rename = "S")]
    pub shape_index: Option<Share>,
    /// Of R.
    #[serde(rename = "R")]
    pub curvedness: Option<Share>,
}

/// Standard uncertainties of S and of R in the posterior; null where there is none.
#[derive(Clone, Copy, Debug, Default, Serialize, JsonSchema)]
pub(crate) struct PosteriorSpreadPart {
    /// Of S.
    #[serde(rename = "S")]
    pub shape_index: Option<f64>,
    /// Of R, 1/length.
    #[serde(rename = "R")]
    pub curvedness: Option<f64>,
}

/// One point of a frontier.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[allow(non_snake_case, reason = "keys of the document")]
pub(crate) struct FrontierRecord {
    /// `discretisation`, `solver` or `interval`.
    pub frontier: String,
    /// Scene or file.
    pub case: String,
    /// Who computed it: `palpate`, or the name of another program.
    pub program: String,
    /// The line that tells it from others.
    pub label: String,
    /// How it was solved, or where the interval came from.
    pub method: String,
    /// `height`, `parametric` or `recognised`.
    pub surface: String,
    /// Words for weights or noise.
    pub weights: String,
    /// Degrees in x and y.
    pub degree: [usize; 2],
    /// Segments in x and y.
    pub segments: [usize; 2],
    /// Stations of each finger, where the number was changed.
    pub stations: Option<usize>,
    /// Contacts.
    pub contacts: usize,
    /// Replicates that were judged.
    pub replicates: u64,
    /// Root mean square error of S over points and replicates.
    pub error_S: Option<f64>,
    /// The same of R, 1/length.
    pub error_R: Option<f64>,
    /// The error that the pictures show: of S and R together, of the coefficients (solver), of the ends (interval).
    pub error: Option<f64>,
    /// Its interval of 95 %.
    pub error_interval: Option<[f64; 2]>,
    /// All errors with their uncertainties.
    pub errors: AllErrorsPart,
    /// Condition of the problem (solver).
    pub condition: Option<f64>,
    /// Right digits of the coefficients (solver).
    pub digits: Option<f64>,
    /// Standard uncertainties in the posterior of what was recognised in all contacts of a file.
    pub u: PosteriorSpreadPart,
    /// Coverage of the intervals.
    pub coverage: CoveragePart,
    /// Time of a call without intervals.
    pub seconds: Option<Clocked>,
    /// Time of a call with intervals.
    pub seconds_interval: Option<Clocked>,
    /// Multiply-adds of a call without intervals, by palpate's own counter: the same in every run.
    pub multiply_adds: Option<u64>,
    /// Instructions of a call without intervals.
    pub instructions: Option<u64>,
    /// Instructions of a call with intervals.
    pub instructions_interval: Option<u64>,
    /// Bytes that the arrays of the fit hold.
    pub memory_bytes: Option<u64>,
    /// Grid points that the data support, as a share.
    pub support: Option<f64>,
    /// No other point of this frontier and case is certainly better in error and time.
    pub on_frontier: bool,
    /// No other is better in error and instructions.
    pub on_instructions_frontier: bool,
    /// Why there is no answer; null where there is one.
    pub failed: Option<String>,
}

/// What was asked and what was picked.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[allow(non_snake_case, reason = "keys of the document")]
pub(crate) struct PickPart {
    /// The configuration in words.
    pub label: String,
    /// Error of S that at most 5 of 100 fresh replicates exceed.
    pub error_S: Option<f64>,
    /// The same of R, 1/length.
    pub error_R: Option<f64>,
    /// Replicates that the errors rest on.
    pub replicates: u64,
    /// Median seconds of a fit with S and R; `null` where none was timed.
    #[schemars(with = "Option<f64>")]
    pub seconds: f64,
    /// What was asked.
    pub asked: AskedPart,
    /// Whether the request is met; otherwise this is the nearest.
    pub met: bool,
    /// What stands in the way.
    pub obstacle: Option<String>,
    /// The scene with this configuration, as TOML.
    pub scene: Option<String>,
}

/// A request.
#[derive(Clone, Copy, Debug, Default, Serialize, JsonSchema)]
#[allow(non_snake_case, reason = "keys of the document")]
pub(crate) struct AskedPart {
    /// Largest error of S.
    pub error_S: Option<f64>,
    /// Largest error of R.
    pub error_R: Option<f64>,
    /// Most seconds.
    pub budget: Option<f64>,
}

/// What to take where nothing is asked for.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub(crate) struct RecommendedPart {
    /// Its place among the points.
    pub point: usize,
    /// The configuration in words.
    pub label: String,
    /// Why this one.
    pub why: String,
}

/// What another program does with the same contacts.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[allow(non_snake_case, reason = "keys of the document")]
pub(crate) struct BesidePart {
    /// Its name.
    pub program: String,
    /// What it was told to do.
    pub label: String,
    /// Error of S and R together.
    pub error: f64,
    /// Root mean square error of S.
    pub error_S: Option<f64>,
    /// The same of R, 1/length.
    pub error_R: Option<f64>,
    /// Seconds of a call.
    pub seconds: f64,
}

/// One stage of a fit or of a replicate.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub(crate) struct StagePart {
    /// `fit` or `replicate`.
    pub of: String,
    /// Name of the stage.
    pub stage: String,
    /// Time.
    pub seconds: Clocked,
    /// Share of the whole.
    pub share: f64,
    /// How it is switched off, and what of the whole that would save; empty where it cannot be.
    pub saved_by: String,
}

/// The whole document.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub(crate) struct FrontierDocument {
    /// `palpate.frontier/1`.
    pub schema: &'static str,
    /// Scene or file.
    pub scene: String,
    /// What errors are measured against.
    pub reference: String,
    /// Seed of the replicates.
    pub seed: u64,
    /// Version that computed it.
    pub build: String,
    /// Instruction set.
    pub isa: String,
    /// Threads of every timed call.
    pub threads: usize,
    /// Who counted instructions, or why nobody did.
    pub counter: String,
    /// All points.
    pub points: Vec<FrontierRecord>,
    /// Places among the points of those that are shown first, the quickest first.
    pub shortlist: Vec<usize>,
    /// What to take where nothing is asked for.
    pub recommended: Option<RecommendedPart>,
    /// What other programs do with the same contacts, as they were told of.
    pub beside: Vec<BesidePart>,
    /// Where the time of a fit and of a replicate goes.
    pub stages: Vec<StagePart>,
    /// What was picked.
    pub pick: Option<PickPart>,
    /// What a reader should know.
    pub notes: Vec<String>,
    /// Seconds that all of this took.
    pub seconds: f64,
}

/// Whether none of these is quicker and as accurate, or as quick and more accurate.
pub(super) fn is_unbeaten(part: &BesidePart, of: &[BesidePart]) -> bool {
    let beats = |other: &BesidePart| {
        other.seconds <= part.seconds
            && other.error <= part.error
            && (other.seconds, other.error) != (part.seconds, part.error)
    };
    !of.iter().any(beats)
}

impl FrontierRecord {
    /// The record of a point of `frontier` on the scene or file `subject`.
    pub(crate) fn new(frontier: Frontier, subject: &str, point: &Point) -> FrontierRecord {
        const { assert!(QUANTITIES.len() == 6) };
        let [s, r, k1, height, slope, normal_deg] = point.errors;
        let [covered_s, covered_r] = point.coverage;
        FrontierRecord {
            frontier: frontier.name().into(),
            case: point.case.clone().unwrap_or_else(|| subject.to_string()),
            program: "palpate".into(),
            label: point.label.clone(),
            method: point.method.clone(),
            surface: point.surface.into(),
            weights: point.weights.clone(),
            degree: point.degree,
            segments: point.segments,
            stations: point.stations,
            contacts: point.contacts,
            replicates: point.replicates,
            error_S: s.map(|part| part.rms),
            error_R: r.map(|part| part.rms),
            error: point.error,
            error_interval: point.error_interval,
            errors: AllErrorsPart { shape_index: s, curvedness: r, k1, height, slope, normal_deg },
            condition: point.condition,
            digits: point.digits,
            u: PosteriorSpreadPart { shape_index: point.uncertainty[0], curvedness: point.uncertainty[1] },
            coverage: CoveragePart { shape_index: covered_s, curvedness: covered_r },
            seconds: point.seconds,
            seconds_interval: point.seconds_interval,
            multiply_adds: point.multiply_adds,
            instructions: point.instructions,
            instructions_interval: point.instructions_interval,
            memory_bytes: point.memory,
            support: point.support,
            on_frontier: point.on_frontier,
            on_instructions_frontier: point.on_instructions_frontier,
            failed: point.failed.clone(),
        }
    }
}
