//! The page of an exploration: how the uncertainties fell, where it touched and in which order, and what all contacts show.

use std::io::Write;

use super::figure::{chart, precise, shown};
use super::fit_page::surface;
use super::html::{short, text};
use super::provenance::Provenance;
use super::shell::Page;
use super::tables::{key, notes, table};
use crate::report::charts::{Falling, touched};
use crate::report::description::Description;
use crate::report::explore::{ExploreDocument, KnownPart, write_explore_table};
use crate::report::fold::PAGE_WIDTH;
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
    write_explore_table(document, PAGE_WIDTH, &mut words)?;
    let mut sections = falling(document);
    sections.push_str(&places(document));
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
    let both = Falling::both(document).map(|falling| {
        let name = text(falling.name);
        if !falling.is_known(document) {
            return format!("<figure><figcaption><b>{name}</b> is undefined at every look.</figcaption></figure>");
        }
        let label = format!("{} against the number of contacts", falling.name);
        let chart = chart(&label, |drawing, rect| falling.draw(drawing, rect, document));
        format!("<figure><figcaption><b>{name}</b></figcaption>{chart}</figure>")
    });
    let [s, r] = both;
    let marks = if document.goal.is_some() {
        key(&[("line", "--accent", "so far"), ("line dashed", "--faint", "goal")])
    } else {
        String::new()
    };
    format!(
        "<section id=\"falling\"><h2>How the uncertainty fell</h2>\n<div class=\"figures\">{s}{r}</div>{marks}</section>\n"
    )
}

/// Where it touched, the first sweep apart from the planned touches.
fn places(document: &ExploreDocument) -> String {
    if document.steps.iter().all(|step| step.touched.is_empty()) {
        return String::new();
    }
    let chart = chart("Where it touched", |drawing, rect| touched(drawing, rect, document));
    let marks = key(&[("", "--faint", "first sweep"), ("", "--second", "planned touches")]);
    format!("<section id=\"touched\"><h2>Where it touched</h2>\n<figure>{chart}</figure>{marks}</section>\n")
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
