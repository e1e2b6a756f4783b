//! The page of a frontier: error against time, every point with its words, and those without an answer with their reason.

use std::io::Write;

use super::chart::{Axis, Chart};
use super::html::{short, text};
use super::provenance::Provenance;
use super::shell::Page;
use super::tables::{bars, card, key, notes, table};
use crate::report::frontier::{FrontierDocument, FrontierRecord, PickPart};
use crate::report::frontier_table::write_frontier_table;
use crate::report::json::write_json;
use crate::report::table::significant;

/// The frontiers: key, heading, name of the error.
const KINDS: [[&str; 3]; 3] = [
    ["discretisation", "Ways of fitting", "error of S and R together"],
    ["solver", "Ways of solving the equations", "error of the coefficients"],
    ["interval", "Ways to an interval", "error of the ends / half width"],
];

/// Errors below this are rounding: they are drawn there.
const ROUNDING: f64 = 1e-17;

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
    write_frontier_table(document, &mut words)?;
    let mut sections = String::new();
    if let Some(pick) = &document.pick {
        sections.push_str(&picked(pick));
    }
    KINDS.iter().for_each(|kind| sections.push_str(&frontier(document, kind)));
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

fn time(seconds: f64) -> String {
    match seconds {
        s if s < 1e-3 => format!("{} us", significant(1e6 * s, 3)),
        s if s < 1.0 => format!("{} ms", significant(1e3 * s, 3)),
        s => format!("{} s", significant(s, 3)),
    }
}

fn number(value: Option<f64>) -> String {
    value.map_or("-".into(), |v| significant(v, 3))
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

/// Time and error of a point that has both.
fn place(point: &FrontierRecord) -> Option<[f64; 2]> {
    let error = point.error.filter(|_| point.failed.is_none())?;
    Some([point.seconds?.median, error.max(ROUNDING)])
}

/// What a point says when it is pointed at.
fn words(point: &FrontierRecord) -> String {
    let mut lines =
        vec![if point.frontier == "solver" { format!("{}: {}", point.case, point.label) } else { point.label.clone() }];
    if let Some(seconds) = point.seconds {
        lines.push(format!("time {} ({} to {})", time(seconds.median), time(seconds.lo), time(seconds.hi)));
    }
    lines.push(format!("error {}", number(point.error)));
    if point.error_S.is_some() || point.error_R.is_some() {
        lines.push(format!("error of S {}, of R {}", number(point.error_S), number(point.error_R)));
    }
    lines.extend(point.digits.map(|digits| format!("{} right digits", significant(digits, 3))));
    lines.extend(point.instructions.map(|count| format!("{count} instructions")));
    if point.on_frontier {
        lines.push("on the frontier".into());
    }
    lines.join("\n")
}

fn frontier(document: &FrontierDocument, [kind, title, error]: &[&str; 3]) -> String {
    let mut all: Vec<(&FrontierRecord, [f64; 2])> =
        document.points.iter().filter(|point| point.frontier == *kind).filter_map(|p| Some((p, place(p)?))).collect();
    if all.is_empty() {
        return String::new();
    }
    all.sort_by(|a, b| a.1[0].total_cmp(&b.1[0]));
    let mut chart = Chart::new(
        &format!("{title}: {error} against time"),
        Axis::logarithmic("seconds on one thread", all.iter().map(|(_, p)| p[0])),
        Axis::logarithmic(error, all.iter().map(|(_, p)| p[1])),
    );
    // solvers are compared case by case, and have no single frontier to draw
    let on: Vec<&(&FrontierRecord, [f64; 2])> = all.iter().filter(|(point, _)| point.on_frontier).collect();
    if *kind != "solver" {
        chart.line("second", &stairs(&on.iter().map(|(_, p)| *p).collect::<Vec<_>>()));
    }
    for (point, at) in all.iter().filter(|(point, _)| !point.on_frontier) {
        chart.dot("quiet", *at, 3.2, &words(point));
    }
    for (point, at) in &on {
        if let Some(seconds) = point.seconds {
            chart.whisker("second", [[seconds.lo, at[1]], [seconds.hi, at[1]]]);
        }
        chart.dot("second", *at, 5.0, &words(point));
    }
    let marks = key(&[("", "--second", "on the frontier"), ("", "--faint", "another is faster and more accurate")]);
    let rows: Vec<Vec<String>> = on.iter().map(|(point, _)| row(point)).collect();
    let head = ["", "Error", "Error of S", "Error of R", "Time", "Time interval", "Instructions"];
    format!(
        "<section id=\"{kind}\"><h2>{title}</h2>\n<figure>{}</figure>\n{marks}\
         <details><summary>The points on the frontier as a table</summary>{}</details></section>\n",
        chart.svg(),
        table(&head, &rows)
    )
}

/// From point to point: first along the time, then down.
fn stairs(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut out: Vec<[f64; 2]> = Vec::new();
    let mut least = f64::INFINITY;
    for [x, y] in points.iter().copied().filter(|p| p[1].is_finite()) {
        if y < least {
            out.extend(out.last().map(|last| [x, last[1]]));
            out.push([x, y]);
            least = y;
        }
    }
    out
}

fn row(point: &FrontierRecord) -> Vec<String> {
    let name =
        if point.frontier == "solver" { format!("{}: {}", point.case, point.label) } else { point.label.clone() };
    vec![
        name,
        number(point.error),
        number(point.error_S),
        number(point.error_R),
        point.seconds.map_or("-".into(), |t| time(t.median)),
        point.seconds.map_or("-".into(), |t| format!("{} to {}", time(t.lo), time(t.hi))),
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
