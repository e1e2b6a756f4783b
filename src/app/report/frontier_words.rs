//! The words for a way of a frontier: its name in a table, and what to type for it.

use super::frontier::{FrontierDocument, FrontierRecord};

/// Whether contacts that were left out judge, because the truth is unknown.
pub(super) fn judged_by_contacts(document: &FrontierDocument) -> bool {
    document.reference.starts_with("contacts left out")
}

/// Its name beside others.
pub(super) fn way(record: &FrontierRecord) -> String {
    if record.surface == "recognised" { "recognised, what palpate fit gives".into() } else { short(record) }
}

/// Its name beside a point: what tells it from the others in two or three words.
pub(super) fn tag(record: &FrontierRecord) -> String {
    if record.surface == "recognised" || record.frontier != "discretisation" {
        return record.label.clone();
    }
    let [[p, q], [n, m]] = [record.degree, record.segments];
    let degree = if p == q { format!("degree {p}") } else { format!("degree {p},{q}") };
    let pieces = if n * m == 1 { String::new() } else { format!(" in {n}x{m}") };
    match &record.surface[..] {
        "parametric" => format!("parametric, {degree}{pieces}"),
        _ => format!("{degree}{pieces}, {}", record.weights.trim_start_matches("weights ")),
    }
}

/// Its label without what most have alike.
pub(super) fn short(record: &FrontierRecord) -> String {
    record.label.strip_prefix("height ").unwrap_or(&record.label).into()
}

/// The command that gives its answer; `None` of what other programs computed.
pub(super) fn command(document: &FrontierDocument, record: &FrontierRecord) -> Option<String> {
    if record.program != "palpate" {
        return None;
    }
    let subject = &document.scene;
    let verb = if judged_by_contacts(document) { "fit" } else { "run" };
    if record.surface == "recognised" {
        return (verb == "fit").then(|| format!("palpate fit {subject}"));
    }
    let pair = |[a, b]: [usize; 2]| if a == b { format!("{a}") } else { format!("{a},{b}") };
    let surface = if record.surface == "parametric" { " --surface parametric" } else { "" };
    let (degree, segments) = (pair(record.degree), pair(record.segments));
    // `auto` is what a fit of a named model does by itself
    let weights = if record.weights == "auto" { String::new() } else { format!(" --{}", record.weights) };
    (verb == "fit").then(|| format!("palpate fit {subject}{surface} --degree {degree} --segments {segments}{weights}"))
}
