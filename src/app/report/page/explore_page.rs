//! The page of an exploration: how the uncertainties fell, where it touched and in which order, and what all contacts show.

use std::io::Write;

use super::chart::{Axis, Chart, precise, shown};
use super::fit_page::surface;
use super::html::{short, text};
use super::provenance::Provenance;
use super::shell::Page;
use super::tables::{key, notes, table};
use crate::report::description::Description;
use crate::report::explore::{ExploreDocument, KnownPart, StepPart, write_explore_table};
use crate::report::json::write_json;
use crate::report::table::significant;
use crate::report::words::like;

/// Writes the page of an exploration; `found` describes the surface that all contacts show, where they show one.
///
/// # Errors
/// What the system says.
pub(crate) fn write_explore_page(
    document: &ExploreDocument,
    found: Option<&Description>,
    provenance: &Provenance,
    out: &mut dyn Write,
) -> std::io::Result<()> {
    let (mut json, mut words) = (Vec::new(), Vec::new());
    write_json(document, &mut json)?;
    write_explore_table(document, &mut words)?;
    let mut sections = falling(document);
    sections.push_str(&touched(document));
    sections.push_str(&looks(document));
    sections.push_str(&notes(&document.notes));
    let mut view = None;
    if let Some(found) = found {
        let (of_surface, data) = surface(found)?;
        sections.push_str("<section><h2>What all contacts show</h2></section>\n");
        sections.push_str(&of_surface);
        view = Some(data);
    }
    let stopped = document.stopped == "asked";
    let page = Page {
        kind: "an exploration: sweep, look, touch where it tells most",
        title: short(&document.scene),
        lead: text(&lead(document)),
        notices: stopped
            .then(|| format!("Interrupted after {} contacts; everything below is of these alone.", document.contacts))
            .into_iter()
            .collect(),
        sections,
        document: &json,
        table: &words,
        view,
    };
    page.write(provenance, out)
}

fn lead(document: &ExploreDocument) -> String {
    let class = document.shape.as_ref().and_then(|shape| shape.class.as_deref());
    let kind = class.map_or(String::new(), |class| match like(class) {
        "" => format!(" They show a {class}."),
        like => format!(" They show a {class}: {like}."),
    });
    format!(
        "{} contacts were taken by the strategy \"{}\"; it ended because {}.{kind}",
        document.contacts, document.strategy, document.reason
    )
}

/// u(S) and u(R)/R over the contacts.
fn falling(document: &ExploreDocument) -> String {
    let one = |name: &str, goal: Option<f64>, of: fn(&StepPart) -> Option<f64>| {
        let points: Vec<([f64; 2], &StepPart)> =
            document.steps.iter().filter_map(|step| Some(([step.contacts as f64, of(step)?], step))).collect();
        if points.is_empty() {
            return format!(
                "<figure><figcaption><b>{}</b> is undefined at every look.</figcaption></figure>",
                text(name)
            );
        }
        let all = points.iter().map(|(p, _)| p[1]).chain(goal);
        let mut chart = Chart::new(
            &format!("{name} against the number of contacts"),
            Axis::holding("contacts", document.steps.iter().map(|step| step.contacts as f64)),
            Axis::logarithmic("standard uncertainty", all),
        );
        if let Some(goal) = goal {
            let ends = [document.steps.first(), document.steps.last()].map(|s| s.map_or(0.0, |s| s.contacts as f64));
            chart.line("goal", &[[ends[0], goal], [ends[1], goal]]);
        }
        chart.line("", &points.iter().map(|(p, _)| *p).collect::<Vec<_>>());
        for (at, step) in &points {
            let words = format!("{} contacts\n{name} {}\n{}", step.contacts, significant(at[1], 3), known(step));
            chart.dot("", *at, 4.0, &words);
        }
        format!("<figure><figcaption><b>{}</b></figcaption>{}</figure>", text(name), chart.svg())
    };
    let goal = document.goal.as_ref();
    let s = one("standard uncertainty of S", goal.map(|goal| goal.u_S), |step| step.shape_index.u.filter(|u| *u > 0.0));
    let r = one("standard uncertainty of R, as a share of R", goal.map(|goal| goal.u_R), |step| {
        let (u, mean) = (step.curvedness.u?, step.curvedness.mean?);
        Some(u / mean).filter(|share| *share > 0.0 && share.is_finite())
    });
    let marks = if goal.is_some() {
        key(&[("line", "--accent", "so far"), ("line dashed", "--faint", "goal")])
    } else {
        String::new()
    };
    format!(
        "<section id=\"falling\"><h2>How the uncertainty fell</h2>\n<div class=\"figures\">{s}{r}</div>{marks}</section>\n"
    )
}

fn known(step: &StepPart) -> String {
    let one = |name: &str, part: &KnownPart| {
        part.mean.zip(part.u).map(|(mean, u)| format!("{name} {} with uncertainty {}", shown(mean), significant(u, 2)))
    };
    let both = [one("S", &step.shape_index), one("R", &step.curvedness)];
    both.into_iter().flatten().collect::<Vec<_>>().join("\n")
}

/// Where it touched, the first sweep apart from the planned touches.
fn touched(document: &ExploreDocument) -> String {
    let places = || document.steps.iter().flat_map(|step| step.touched.iter());
    if places().next().is_none() {
        return String::new();
    }
    let [x, y] = Axis::level(["x", "y"], &places().copied().collect::<Vec<_>>());
    let mut chart = Chart::new("Where it touched", x, y);
    let mut number = 0;
    for (k, step) in document.steps.iter().enumerate() {
        for place in &step.touched {
            number += 1;
            let when = if k == 0 { "first sweep".to_string() } else { format!("planned, round {k}") };
            let words = format!("contact {number}: {when}\nx {}, y {}", shown(place[0]), shown(place[1]));
            chart.dot(if k == 0 { "quiet" } else { "second" }, *place, 4.5, &words);
        }
    }
    let marks = key(&[("", "--faint", "first sweep"), ("", "--second", "planned touches")]);
    format!("<section id=\"touched\"><h2>Where it touched</h2>\n<figure>{}</figure>{marks}</section>\n", chart.svg())
}

fn looks(document: &ExploreDocument) -> String {
    let of = |part: &KnownPart| {
        let interval = part
            .interval
            .map_or("-".into(), |[lo, hi]| format!("{} to {}", precise(lo, hi - lo), precise(hi, hi - lo)));
        let number = |v: Option<f64>| v.map_or("-".into(), shown);
        [number(part.mean), part.u.map_or("-".into(), |u| significant(u, 2)), interval, number(part.truth)]
    };
    let rows: Vec<Vec<String>> = document
        .steps
        .iter()
        .map(|step| {
            let kind = step.kind.clone().or_else(|| step.refused.clone()).unwrap_or_else(|| "-".into());
            let numbers = of(&step.shape_index).into_iter().chain(of(&step.curvedness));
            std::iter::once(step.contacts.to_string()).chain([kind]).chain(numbers).collect()
        })
        .collect();
    let head =
        ["Contacts", "They show", "S", "Uncertainty", "Interval", "Truth", "R", "Uncertainty", "Interval", "Truth"];
    format!("<section id=\"looks\"><h2>Every look</h2>\n{}</section>\n", table(&head, &rows))
}
