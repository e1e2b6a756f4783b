//! `palpate.explore/1`: an exploration as a document, a table and CSV.
//!
//! ```text
//! Exploration, ShapePart -> ExploreDocument -> JSON (report/json.rs), a table, explore.csv; the picture in explore_picture.rs
//! ```

use std::fmt::Write as _;
use std::io::Write;

use schemars::JsonSchema;
use serde::Serialize;

use super::document::ShapePart;
use super::fold::folded;
use super::table::significant;
use super::words::of_the_patch;
use palpate_fitting::fit::FitOptions;
use palpate_inference::recognition::Estimate;
use palpate_studies::explore::{Exploration, ExploreOptions, Goal, Look, Stopped};

/// Schema name.
pub(crate) const EXPLORE_SCHEMA: &str = "palpate.explore/1";

/// S or R after some contacts.
#[derive(Clone, Debug, Default, Serialize, JsonSchema)]
pub(crate) struct KnownPart {
    /// Mean over the patch.
    pub mean: Option<f64>,
    /// Standard uncertainty in all.
    pub u: Option<f64>,
    /// What independent noise contributes.
    pub u_noise: Option<f64>,
    /// What doubt about the model and shared errors contribute.
    pub u_model: Option<f64>,
    /// Interval at the options' level.
    pub interval: Option<[f64; 2]>,
    /// The truth at the same places.
    pub truth: Option<f64>,
}

/// One look.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub(crate) struct StepPart {
    /// Contacts so far.
    pub contacts: usize,
    /// S.
    #[serde(rename = "S")]
    pub shape_index: KnownPart,
    /// R.
    #[serde(rename = "R")]
    pub curvedness: KnownPart,
    /// Kind of surface that the contacts show, or the class under a named model.
    pub kind: Option<String>,
    /// Why nothing was recognised.
    pub refused: Option<String>,
    /// Probability of so good an explanation by a richer spline, if what was recognised were all there is.
    pub richer_p: Option<f64>,
    /// u(S) and u(R)/R that noise alone leaves after the whole budget.
    pub attainable: Option<UncertaintyPart>,
    /// Where it touched since the step before.
    pub touched: Vec<[f64; 2]>,
}

/// u of S, and of R as a share of R.
#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
#[allow(non_snake_case, reason = "keys of the document")]
pub(crate) struct UncertaintyPart {
    /// u(S).
    pub u_S: f64,
    /// u(R)/R; `null` where R is 0.
    #[schemars(with = "Option<f64>")]
    pub u_R: f64,
}

/// The whole exploration.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub(crate) struct ExploreDocument {
    /// `palpate.explore/1`.
    pub schema: &'static str,
    /// Its scene.
    pub scene: String,
    /// Seed of noise and of random choices.
    pub seed: u64,
    /// The strategy's word.
    pub strategy: String,
    /// Why it ended, in a word.
    pub stopped: String,
    /// The same in a sentence.
    pub reason: String,
    /// What answers: `recognised`, or the model that was named.
    pub model: String,
    /// Contacts in all.
    pub contacts: usize,
    /// Contacts allowed.
    pub budget: usize,
    /// The goal.
    pub goal: Option<UncertaintyPart>,
    /// Every look.
    pub steps: Vec<StepPart>,
    /// S, R and class from all contacts, as `palpate fit` answers; null where it refuses.
    pub shape: Option<ShapePart>,
    /// What a user should know.
    pub notes: Vec<String>,
}

impl ExploreDocument {
    /// From an exploration of the scene of this name; `shape` describes all its contacts.
    pub(crate) fn new(
        scene: &str,
        found: &Exploration,
        options: &ExploreOptions,
        shape: Option<ShapePart>,
        notes: Vec<String>,
    ) -> ExploreDocument {
        ExploreDocument {
            schema: EXPLORE_SCHEMA,
            scene: scene.into(),
            seed: options.seed,
            strategy: options.strategy.name().into(),
            stopped: found.stopped.name().into(),
            reason: reason(found, options),
            model: model_words(options.model.as_ref()),
            contacts: found.contacts.len(),
            budget: options.contacts,
            goal: options.goal.map(|goal| UncertaintyPart { u_S: goal.u_s, u_R: goal.u_r }),
            steps: found.looks.iter().map(step).collect(),
            shape,
            notes,
        }
    }
}

fn model_words(model: Option<&FitOptions>) -> String {
    let Some(model) = model else { return "recognised".into() };
    let ([p, q], [n, m]) = (model.degree, model.segments);
    format!("height field of degree {p} x {q} with {n} x {m} segments; u counts noise alone")
}

fn step(look: &Look) -> StepPart {
    StepPart {
        contacts: look.contacts,
        shape_index: known(look.shape_index, look.truth[0]),
        curvedness: known(look.curvedness, look.truth[1]),
        kind: look.kind.clone(),
        refused: look.refused.clone(),
        richer_p: look.richer_p,
        attainable: look.attainable.map(|[s, r]| UncertaintyPart { u_S: s, u_R: r }),
        touched: look.touched.clone(),
    }
}

fn known(estimate: Option<Estimate>, truth: Option<f64>) -> KnownPart {
    let Some(e) = estimate else { return KnownPart { truth, ..KnownPart::default() } };
    KnownPart {
        mean: Some(e.mean),
        u: Some(e.u),
        u_noise: Some(e.u_noise),
        u_model: Some(e.u_model),
        interval: Some(e.interval),
        truth,
    }
}

/// Why it ended, in a sentence with the numbers.
fn reason(found: &Exploration, options: &ExploreOptions) -> String {
    let contacts = found.contacts.len();
    let last = found.looks.last();
    match (found.stopped, options.goal) {
        (Stopped::Goal, _) => "the goal holds at two looks in a row".into(),
        (Stopped::Budget, Some(_)) if last.is_some_and(|look| look.shape_index.is_none()) => format!(
            "all {contacts} contacts of the budget are made, and they show a plane or nothing at all: a plane has no S, and its R is 0"
        ),
        (Stopped::Budget, None) => format!("all {contacts} contacts of the budget are made"),
        (Stopped::Budget, Some(_)) => {
            format!("all {contacts} contacts of the budget are made, and the goal does not hold at two looks in a row")
        }
        (Stopped::Noise, Some(goal)) => last.and_then(|look| noise_words(look, &goal, options)).unwrap_or_default(),
        (Stopped::Model, Some(_)) => last.and_then(doubt_words).unwrap_or_default(),
        (Stopped::Places, _) => format!("every place inside reach is touched, after {contacts} contacts"),
        (Stopped::Asked, _) | (Stopped::Noise | Stopped::Model, None) => "it was asked to stop".into(),
    }
}

fn noise_words(look: &Look, goal: &Goal, options: &ExploreOptions) -> Option<String> {
    let [s, r] = look.attainable?;
    let short = (s / goal.u_s).max(r / goal.u_r);
    let needed = significant(options.contacts as f64 * short * short, 2);
    Some(format!(
        "with {} contacts noise alone leaves u(S) = {} and u(R)/R = {}, more than the goal: it needs some {needed} contacts, or less noise",
        options.contacts,
        significant(s, 2),
        significant(r, 2)
    ))
}

fn doubt_words(look: &Look) -> Option<String> {
    let (s, r) = (look.shape_index?, look.curvedness?);
    let richer = look.richer_p.map_or(String::new(), |p| {
        format!(" (p = {} that what was recognised is all there is, beside a richer spline)", significant(p, 2))
    });
    Some(format!(
        "doubt about the kind of surface, or errors that contacts share, leave u(S) = {} and u(R)/R = {}, and more contacts do not \
         settle it{richer}; a model named by --degree answers with noise alone",
        significant(s.u, 2),
        significant(r.u / r.mean, 2)
    ))
}

/// A table for people: one line a look, then why it ended.
///
/// # Errors
/// What the system says.
pub(crate) fn write_explore_table(
    document: &ExploreDocument,
    width: usize,
    out: &mut dyn Write,
) -> std::io::Result<()> {
    let mut text = format!("explored   {} by {}, seed {}\n", document.scene, document.strategy, document.seed);
    let _ = writeln!(text, "model      {}", document.model);
    let _ = writeln!(
        text,
        "{:<8} {:>8} {:>8} {:>8} {:>10} {:>8} {:>9}  kind",
        "contacts", "S", "u(S)", "truth", "R", "u(R)/R", "truth"
    );
    for step in &document.steps {
        let word = |v: Option<f64>, digits| v.map_or("-".into(), |v| significant(v, digits));
        let (s, r) = (&step.shape_index, &step.curvedness);
        let share = r.u.zip(r.mean).map(|(u, mean)| u / mean);
        let kind = step.kind.as_deref().or(step.refused.as_deref()).unwrap_or("-");
        let _ = writeln!(
            text,
            "{:<8} {:>8} {:>8} {:>8} {:>10} {:>8} {:>9}  {kind}",
            step.contacts,
            word(s.mean, 4),
            word(s.u, 2),
            word(s.truth, 4),
            word(r.mean, 4),
            word(share, 2),
            word(r.truth, 4)
        );
    }
    text.push_str(&folded(&format!("stopped    {}: {}", document.stopped, document.reason), Some(11), width));
    if let Some(shape) = &document.shape {
        let several =
            shape.class_by_area.as_ref().map(|by_area| format!("several side by side: {}", of_the_patch(by_area)));
        let class = shape.class.clone().or(several).unwrap_or("none: S is undefined here".into());
        let _ = writeln!(text, "class      {class}");
    }
    for note in &document.notes {
        text.push_str(&folded(&format!("note       {note}"), Some(11), width));
    }
    out.write_all(text.as_bytes())
}

/// One line a look.
///
/// # Errors
/// What the system says.
pub(crate) fn write_explore_csv(document: &ExploreDocument, out: &mut dyn Write) -> std::io::Result<()> {
    let of = |name: &str| ["mean", "u", "lo", "hi", "truth"].map(|what| format!("{name}_{what}")).join(",");
    writeln!(out, "contacts,touched,{},{},kind", of("S"), of("R"))?;
    for step in &document.steps {
        let number = |v: Option<f64>| v.map_or(String::new(), |v| v.to_string());
        let columns = |p: &KnownPart| {
            [p.mean, p.u, p.interval.map(|i| i[0]), p.interval.map(|i| i[1]), p.truth].map(number).join(",")
        };
        let (s, r) = (columns(&step.shape_index), columns(&step.curvedness));
        let kind = step.kind.as_deref().unwrap_or("");
        writeln!(out, "{},{},{s},{r},{kind}", step.contacts, step.touched.len())?;
    }
    Ok(())
}
