//! The page of a frontier: error against time, every point with its words, and those without an answer with their reason.

use std::io::Write;

use super::figure::chart;
use super::html::{short, text};
use super::provenance::Provenance;
use super::shell::Page;
use super::tables::{bars, card, key, notes, table};
use crate::report::charts::{FrontierFigure, FrontierKind, KINDS, TIME, number, time};
use crate::report::fold::PAGE_WIDTH;
use crate::report::frontier::{FrontierDocument, FrontierRecord, PickPart, RecommendedPart};
use crate::report::frontier_table::write_frontier_table;
use crate::report::frontier_words::{judged_by_contacts, way};
use crate::report::json::write_json;

/// Pixels by which the chart is higher than others.
const HIGHER: f64 = 70.0;

/// Writes the page of a frontier.
///
/// # Errors
/// What the system says.
pub(crate) fn write_frontier_page(
    document: &FrontierDocument,
    provenance: &Provenance,
    out: &mut dyn Write,
) -> std::io::Result<()> {
    let (mut json, mut words) = (Vec::new(), Vec::new());
    write_json(document, &mut json)?;
    write_frontier_table(document, true, PAGE_WIDTH, &mut words)?;
    let mut sections = String::new();
    match (&document.pick, &document.recommended) {
        (Some(pick), _) => sections.push_str(&picked(pick)),
        (None, Some(recommended)) => sections.push_str(&taken(document, recommended)),
        (None, None) => {}
    }
    KINDS.into_iter().for_each(|kind| sections.push_str(&frontier(document, kind)));
    sections.push_str(&stages(document));
    sections.push_str(&without_answer(document));
    sections.push_str(&notes(&document.notes));
    let page = Page {
        kind: "a frontier: what accuracy costs in time",
        title: short(&document.scene),
        lead: text(&lead(document)),
        notices: notices(document),
        sections,
        document: &json,
        table: &words,
        view: None,
    };
    page.write(provenance, out)
}

fn failed(document: &FrontierDocument) -> impl Iterator<Item = (&FrontierRecord, &str)> {
    document.points.iter().filter_map(|point| Some((point, point.failed.as_deref()?)))
}

fn notices(document: &FrontierDocument) -> Vec<String> {
    let count = failed(document).count();
    let all = document.points.len();
    let some =
        format!("{count} of {all} ways have no answer; they are listed below with the reason, and all others stand.");
    (count > 0).then_some(some).into_iter().collect()
}

fn lead(document: &FrontierDocument) -> String {
    let on = document.points.iter().filter(|point| point.on_frontier).count();
    format!(
        "{} ways of computing the same were timed and judged against {}. {on} of them are on a frontier: no other is certainly \
         both faster and more accurate.",
        document.points.len(),
        document.reference
    )
}

fn picked(pick: &PickPart) -> String {
    let verdict = if pick.met { "meets the request" } else { "nothing meets the request; this is nearest" };
    let mut lines = vec![verdict.to_string()];
    lines.extend(pick.obstacle.iter().map(|obstacle| format!("in the way: {obstacle}")));
    let errors = vec![format!("of R: {} (1/length)", number(pick.error_R)), "exceeded in at most 5 of 100 runs".into()];
    format!(
        "<div class=\"cards\">{}{}{}</div>\n{}",
        card("Picked", &pick.label, &lines),
        card("Error of S", &number(pick.error_S), &errors),
        card("Time of one fit", &time(pick.seconds), &[]),
        pick.scene.as_ref().map_or(String::new(), |scene| format!(
            "<details><summary>The scene with this way of fitting</summary><pre>{}</pre></details>\n",
            text(scene)
        ))
    )
}

/// The way to take where nothing was asked for.
fn taken(document: &FrontierDocument, recommended: &RecommendedPart) -> String {
    let Some(record) = document.points.get(recommended.point) else { return String::new() };
    let unseen = [record.errors.height, record.errors.normal_deg].map(|errors| number(errors.map(|e| e.rms)));
    let errors = if judged_by_contacts(document) {
        card("Error of the height at contacts left out", &unseen[0], &[format!("of the normal: {} degrees", unseen[1])])
    } else {
        card("Error of S", &number(record.error_S), &[format!("of R: {} (1/length)", number(record.error_R))])
    };
    format!(
        "<div class=\"cards\">{}{errors}{}</div>\n",
        card("To take", &way(record), std::slice::from_ref(&recommended.why)),
        card("Time of one", &record.seconds.map_or("-".into(), |seconds| time(seconds.least)), &[]),
    )
}

fn frontier(document: &FrontierDocument, kind: FrontierKind) -> String {
    let Some(figure) = FrontierFigure::new(document, kind) else { return String::new() };
    let FrontierKind { frontier, title, error } = kind;
    let chart = chart(&format!("{title}: {error} against time"), |drawing, rect| {
        // taller than others, so that decades have room for words
        drawing.size[1] += HIGHER;
        figure.draw(drawing, [rect[0], [rect[1][0], rect[1][1] + HIGHER]], TIME);
    });
    let mut marks = vec![
        ("", "--second", "a model that is named"),
        ("", "--accent", "recognised, and the least error so far"),
        ("", "--faint", "all others; from line to line is one digit"),
    ];
    if frontier == "discretisation" && !document.beside.is_empty() {
        marks.push(("", "--ink", "other programs"));
    }
    let marks = key(&marks);
    let rows: Vec<Vec<String>> = figure.on.iter().map(|point| row(figure.name(point), point)).collect();
    let head =
        ["", "Error", "Error of S", "Error of R", "Quickest round", "Median between", "Multiply-adds", "Instructions"];
    format!(
        "<section id=\"{frontier}\"><h2>{title}</h2>\n<figure>{chart}</figure>\n{marks}\
         <details><summary>The points on the frontier as a table</summary>{}</details></section>\n",
        table(&head, &rows)
    )
}

fn row(name: String, point: &FrontierRecord) -> Vec<String> {
    vec![
        name,
        number(point.error),
        number(point.error_S),
        number(point.error_R),
        point.seconds.map_or("-".into(), |t| time(t.least)),
        point.seconds.map_or("-".into(), |t| format!("{} to {}", time(t.lo), time(t.hi))),
        point.multiply_adds.map_or("-".into(), |n| n.to_string()),
        point.instructions.map_or("-".into(), |n| n.to_string()),
    ]
}

fn stages(document: &FrontierDocument) -> String {
    let of = |of: &str| {
        let stages: Vec<_> = document.stages.iter().filter(|stage| stage.of == of).collect();
        if stages.is_empty() {
            return String::new();
        }
        let whole: f64 = stages.iter().map(|stage| stage.seconds.median).sum();
        let rows: Vec<_> = stages
            .iter()
            .map(|stage| {
                (
                    stage.stage.clone(),
                    stage.share,
                    format!("{} ({:.0} %)", time(stage.seconds.median), 100.0 * stage.share),
                )
            })
            .collect();
        format!("<div><h3>The {} of a {of}</h3>{}</div>", time(whole), bars(&rows))
    };
    let both = [of("fit"), of("replicate")].concat();
    if both.is_empty() {
        return both;
    }
    format!("<section id=\"stages\"><h2>Where the time goes</h2>\n<div class=\"figures\">{both}</div></section>\n")
}

fn without_answer(document: &FrontierDocument) -> String {
    let rows: Vec<Vec<String>> = failed(document)
        .map(|(point, why)| vec![point.label.clone(), point.frontier.clone(), point.case.clone(), why.to_string()])
        .collect();
    if rows.is_empty() {
        return String::new();
    }
    format!(
        "<section id=\"failed\"><h2>Ways without an answer</h2>\n{}</section>\n",
        table(&["", "Frontier", "Case", "Why"], &rows)
    )
}
