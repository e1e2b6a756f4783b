//! The page of a study: how S and R are distributed over the replicates, which class, which effect is to blame.

use std::fmt::Write as _;
use std::io::Write;

use super::figure::{chart, precise, shown};
use super::html::{short, text};
use super::provenance::Provenance;
use super::shell::Page;
use super::tables::{bars, card, key, list, notes, table};
use crate::report::charts::{CUT, Scatter, class_shares, effect_shares};
use crate::report::fold::PAGE_WIDTH;
use crate::report::json::write_json;
use crate::report::percent::percent;
use crate::report::study::{LinearQuantity, QuantityPart, StudyDocument};
use crate::report::study_table::write_study_table;
use crate::report::table::significant;
use crate::report::words::like;
use palpate_studies::montecarlo::Ranked;

/// The word of [`StudyDocument::stopped`] for a study that Ctrl-C ended.
pub(crate) const INTERRUPTED: &str = "interrupted";

/// Writes the page of a study; `ranked` are the values of S and of R, `asked` the replicates that were asked for.
///
/// # Errors
/// What the system says.
pub(crate) fn write_study_page(
    document: &StudyDocument,
    ranked: &[Ranked<'_>; 2],
    asked: u64,
    provenance: &Provenance,
    out: &mut dyn Write,
) -> std::io::Result<()> {
    let (mut json, mut table) = (Vec::new(), Vec::new());
    write_json(document, &mut json)?;
    write_study_table(document, PAGE_WIDTH, &mut table)?;
    let mut sections = cards(document);
    sections.push_str(&histograms(document, ranked));
    sections.push_str(&numbers(document));
    sections.push_str(&classes(document));
    sections.push_str(&effects(document));
    sections.push_str(&trust(document));
    sections.push_str(&notes(&document.notes));
    let page = Page {
        kind: "a study: the same measurement many times over, with fresh noise each time",
        title: short(&document.scene),
        lead: text(&lead(document)),
        notices: notices(document, asked),
        sections,
        document: &json,
        table: &table,
        view: None,
    };
    page.write(provenance, out)
}

fn notices(document: &StudyDocument, asked: u64) -> Vec<String> {
    let mut said = Vec::new();
    if document.stopped == INTERRUPTED {
        said.push(format!(
            "Interrupted: {} of {asked} replicates are done, and everything below is of these alone.",
            document.replicates
        ));
    } else if document.stopped == "budget" {
        said.push(format!(
            "The time was up after {} replicates; everything below is of these alone.",
            document.replicates
        ));
    }
    if document.failed > 0 {
        said.push(format!(
            "{} of {} replicates could not be fitted and are left out.",
            document.failed, document.replicates
        ));
    }
    said
}

fn lead(document: &StudyDocument) -> String {
    let level = percent(document.level);
    match &document.verdict {
        Some(class) => format!(
            "With this much noise the patch is still recognised as a {class} ({}) in at least {level} of {} measurements.",
            like(class),
            document.replicates
        ),
        None => format!(
            "With this much noise no class is found in {level} of {} measurements: the class cannot be relied on.",
            document.replicates
        ),
    }
}

fn cards(document: &StudyDocument) -> String {
    let level = percent(document.level);
    let one = |name: &str, part: &QuantityPart| {
        let mut lines = Vec::new();
        lines.extend(part.lo.zip(part.hi).map(|(lo, hi)| {
            format!("{level} of measurements between {} and {}", precise(lo, hi - lo), precise(hi, hi - lo))
        }));
        lines.extend(part.sd.map(|sd| format!("standard deviation {}", significant(sd, 3))));
        lines.extend(part.truth.map(|truth| format!("truth {}", shown(truth))));
        card(name, &part.mean.map_or("undefined".into(), shown), &lines)
    };
    let rate = document.replicates_per_second.map(|rate| format!("{} a second", significant(rate, 3)));
    format!(
        "<div class=\"cards\">{}{}{}</div>\n",
        one("S, mean of the measurements", &document.shape_index),
        one("R, mean of the measurements (1/length)", &document.curvedness),
        card("Replicates", &document.replicates.to_string(), &rate.into_iter().collect::<Vec<_>>())
    )
}

fn histograms(document: &StudyDocument, ranked: &[Ranked<'_>; 2]) -> String {
    let both = [("S, shape index", &document.shape_index), ("R, curvedness (1/length)", &document.curvedness)];
    let figures: String = both
        .into_iter()
        .zip(ranked)
        .map(|((name, part), ranked)| {
            let Some(scatter) = Scatter::new(part, ranked) else {
                return format!(
                    "<figure><figcaption><b>{}</b>: undefined in every replicate.</figcaption></figure>\n",
                    text(name)
                );
            };
            let chart = chart(&format!("Histogram of {name}"), |drawing, rect| scatter.draw(drawing, rect, name));
            let far = scatter.far().map_or(String::new(), |far| format!(" {far}"));
            format!("<figure><figcaption><b>{}</b>{}</figcaption>{chart}</figure>\n", text(name), text(&far))
        })
        .collect();
    let level = percent(document.level);
    let interval = format!("interval that holds {level} of the measurements");
    let marks = key(&[
        ("", "--accent", "measurements"),
        ("", "--band", &interval),
        ("line", "--ink", "mean"),
        ("line dashed", "--second", "truth"),
    ]);
    let cut = format!("The {} % that lie farthest out on either side are not drawn.", 100.0 * CUT);
    format!(
        "<section id=\"histograms\"><h2>How the measurements scatter</h2>\n<div class=\"figures\">\n{figures}</div>\n{marks}<p class=\"hint\">{cut}</p></section>\n"
    )
}

fn numbers(document: &StudyDocument) -> String {
    let number = |v: Option<f64>| v.map_or("-".into(), shown);
    let pair = |lo: Option<f64>, hi: Option<f64>| {
        lo.zip(hi).map_or("-".into(), |(lo, hi)| format!("{} to {}", precise(lo, hi - lo), precise(hi, hi - lo)))
    };
    let named = [("S", &document.shape_index), ("R", &document.curvedness)];
    let others = document.quantities.0.iter().map(|(name, part)| (name.as_str(), part));
    let row = |(name, part): (&str, &QuantityPart)| {
        let few = |v: Option<f64>| v.map_or("-".into(), |v| significant(v, 2));
        vec![
            name.to_string(),
            number(part.mean),
            few(part.standard_error.mean),
            number(part.sd),
            pair(part.lo, part.hi),
            pair(part.shortest.map(|s| s[0]), part.shortest.map(|s| s[1])),
            number(part.truth),
            few(part.bias),
        ]
    };
    let rows: Vec<Vec<String>> = named.into_iter().chain(others).map(row).collect();
    let level = percent(document.level);
    let (symmetric, shortest) = (format!("{level} interval"), format!("Shortest {level} interval"));
    let head =
        ["", "Mean", "Error of the mean", "Standard deviation", &symmetric, &shortest, "Truth", "Mean less truth"];
    format!(
        "<section id=\"numbers\"><h2>Numbers</h2>\n{}\
         <dl class=\"terms\"><dt>Standard deviation</dt><dd>how far one measurement scatters.</dd>\
         <dt>Error of the mean</dt><dd>how far the mean itself may be off for want of more replicates.</dd>\
         <dt>Interval</dt><dd>as many measurements lie below it as above it; the shortest one is the narrowest that holds as many.</dd></dl></section>\n",
        table(&head, &rows)
    )
}

fn classes(document: &StudyDocument) -> String {
    let rows = class_shares(document);
    if rows.is_empty() {
        return String::new();
    }
    format!("<section id=\"classes\"><h2>Which class the measurements show</h2>\n{}</section>\n", bars(&rows))
}

fn effects(document: &StudyDocument) -> String {
    if document.effects.is_empty() {
        return String::new();
    }
    let [s, r] = effect_shares(document).map(|rows| bars(&rows));
    format!(
        "<section id=\"effects\"><h2>Which error is to blame</h2>\n<div class=\"figures wide\"><div><h3>Share of the variance of S</h3>{s}</div>\
         <div><h3>Share of the variance of R</h3>{r}</div></div>\n\
         <p class=\"hint\">What each effect brings to the scatter by itself; in brackets how well that is known.</p></section>\n"
    )
}

fn trust(document: &StudyDocument) -> String {
    let law = &document.linear;
    let linear = |name: &str, part: &LinearQuantity| {
        let (sd, lo, hi) = (part.sd?, part.lo?, part.hi?);
        Some(format!(
            "{name} {} to {} (standard deviation {})",
            precise(lo, hi - lo),
            precise(hi, hi - lo),
            significant(sd, 3)
        ))
    };
    let both: Vec<String> =
        [linear("S", &law.shape_index), linear("R", &law.curvedness)].into_iter().flatten().collect();
    let mut said = vec![format!("Path: {}; {}.", document.path, document.path_why)];
    if !both.is_empty() {
        let valid = if law.valid { "and agrees with the study" } else { "and does not agree with the study" };
        said.push(format!(
            "The linear law of uncertainty, without any draws, says {}, {valid}: {}.",
            both.join(" and "),
            law.why
        ));
    }
    let mut ends = String::new();
    for (name, part) in [("S", &document.shape_index), ("R", &document.curvedness)] {
        if let (Some(lo), Some(hi)) = (part.standard_error.lo, part.standard_error.hi) {
            let _ = write!(ends, " {name}: {} and {}.", significant(lo, 1), significant(hi, 1));
        }
    }
    if !ends.is_empty() {
        said.push(format!("Standard errors of the intervals' ends, for want of more replicates:{ends}"));
    }
    let [from, to] = document.range;
    said.push(format!(
        "Replicates {from} to {to}, drawn from seed {}; the same seed gives the same numbers.",
        document.seed
    ));
    format!("<section id=\"certificate\"><h2>How far to trust it</h2>\n{}</section>\n", list(&said))
}
