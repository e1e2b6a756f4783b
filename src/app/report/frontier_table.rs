//! A frontier as text for people: a few rows and the one to take; on request every point that no other beats.

use std::fmt::Write as _;
use std::io::Write;

use super::charts::time;
use super::fold::folded;
use super::frontier::{BesidePart, FrontierDocument, FrontierRecord, is_unbeaten};
use super::frontier_long::{long_tables, stage_lines};
use super::frontier_words::{command, judged_by_contacts, short, way};
use super::table::significant;
use palpate_studies::frontier::Errors;

/// Columns of the labels of lines.
const LABEL: usize = 11;

/// Errors below this are those of the arithmetic: how many times smaller they are tells nothing.
const ROUNDED: f64 = 1e-9;

/// The rows that are shown first, the picked one, and with `all` the long tables.
///
/// # Errors
/// What the system says.
pub(crate) fn write_frontier_table(
    document: &FrontierDocument,
    all: bool,
    width: usize,
    out: &mut dyn Write,
) -> std::io::Result<()> {
    let mut text = head(document, width);
    if !document.shortlist.is_empty() {
        rows(document, &mut text);
        rows_beside(document, &mut text);
    }
    let mut lines = Vec::new();
    pick_lines(document, &mut lines);
    recommended_lines(document, &mut lines);
    uncertainty_lines(document, &mut lines);
    lines.extend(document.notes.iter().map(|note| ("note", note.clone())));
    if !all && document.recommended.is_some() {
        lines.push(("more", more(document)));
    }
    if !lines.is_empty() {
        text.push('\n');
    }
    for (label, words) in lines {
        text.push_str(&folded(&format!("{label:<LABEL$}{words}"), Some(LABEL), width));
    }
    let mut long = String::new();
    if all {
        long_tables(document, &mut long);
    }
    stage_lines(document, &mut long);
    text.push_str(&folded(&long, Some(LABEL), width));
    out.write_all(text.as_bytes())
}

/// What was judged, by what, and how often.
fn head(document: &FrontierDocument, width: usize) -> String {
    let ways = document.points.iter().filter(|record| record.frontier == "discretisation");
    let (count, failed) = (ways.clone().count(), ways.clone().filter(|record| record.failed.is_some()).count());
    let without = if failed > 0 { format!(", {failed} of them without an answer") } else { String::new() };
    let first = ways.clone().find(|record| record.stations.is_none());
    let contacts = first.map_or(0, |record| record.contacts);
    let runs = ways.map(|record| record.replicates).max().unwrap_or(0);
    let judged = match (judged_by_contacts(document), runs) {
        (true, _) => format!("judged by {}", document.reference),
        (false, 1) => format!("{contacts} contacts, judged by {}", document.reference),
        (false, _) => format!("{contacts} contacts, touched {runs} times, judged by {}", document.reference),
    };
    let text = format!("{}: {count} ways to S and R{without}; {judged}; times of one thread", document.scene);
    folded(&text, Some(2), width)
}

/// The columns of errors: their names, and what stands in them.
type Column = (&'static str, fn(&FrontierRecord) -> Option<f64>);

fn rms(errors: Option<Errors>) -> Option<f64> {
    errors.map(|errors| errors.rms)
}

fn columns(document: &FrontierDocument) -> Vec<Column> {
    let both: [Column; 2] = if judged_by_contacts(document) {
        [("unseen height", |r| rms(r.errors.height)), ("unseen normal", |r| rms(r.errors.normal_deg))]
    } else {
        [("error of S", |r| r.error_S), ("error of R", |r| r.error_R)]
    };
    let shown = |column: &Column| document.shortlist.iter().any(|k| column.1(&document.points[*k]).is_some());
    both.into_iter().filter(shown).collect()
}

fn rows(document: &FrontierDocument, text: &mut String) {
    let columns = columns(document);
    text.push_str("\n ");
    for (name, _) in &columns {
        let _ = write!(text, " {name:>14}");
    }
    let _ = writeln!(text, " {:>9}   way", "time");
    for k in &document.shortlist {
        let record = &document.points[*k];
        let taken = document.recommended.as_ref().is_some_and(|recommended| recommended.point == *k);
        text.push(if taken { '>' } else { ' ' });
        for (name, value) in &columns {
            let mut word = value(record).map_or("-".into(), |value| significant(value, 2));
            if *name == "unseen normal" {
                word.push_str(" deg");
            }
            let _ = write!(text, " {word:>14}");
        }
        let seconds = record.seconds.map_or("-".into(), |seconds| time(seconds.least));
        let _ = writeln!(text, " {seconds:>9}   {}", way(record));
    }
}

/// What other programs do: those that no other of them beats, the quickest first.
fn rows_beside(document: &FrontierDocument, text: &mut String) {
    let beside = &document.beside;
    let mut shown: Vec<&BesidePart> = beside.iter().filter(|part| is_unbeaten(part, beside)).collect();
    shown.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
    let columns = columns(document);
    for part in shown {
        text.push(' ');
        for (name, _) in &columns {
            // where contacts judge, the error is that of the height
            let error = match *name {
                "error of S" => part.error_S,
                "error of R" => part.error_R,
                "unseen height" => Some(part.error),
                _ => None,
            };
            let _ = write!(text, " {:>14}", error.map_or("-".into(), |error| significant(error, 2)));
        }
        let _ = writeln!(text, " {:>9}   {}: {}", time(part.seconds), part.program, part.label);
    }
}

/// What was picked of what was asked for.
fn pick_lines(document: &FrontierDocument, lines: &mut Vec<(&'static str, String)>) {
    let Some(pick) = &document.pick else { return };
    let error = |value: Option<f64>| value.map_or("unknown".into(), |v| significant(v, 3));
    let kept = match (judged_by_contacts(document), pick.replicates) {
        (true, _) => String::new(),
        (false, 1) => format!("; error of S {}, of R {} in every run", error(pick.error_S), error(pick.error_R)),
        (false, runs) => format!(
            "; in 95 of 100 runs the error of S stays below {}, of R below {} (from {runs} runs)",
            error(pick.error_S),
            error(pick.error_R)
        ),
    };
    let label = pick.label.strip_prefix("height ").unwrap_or(&pick.label);
    let label_of = if pick.met { "picked" } else { "nearest" };
    let asked = if pick.met { "" } else { "; nothing meets the request" };
    lines.push((label_of, format!("{label}, {}{asked}{kept}", time(pick.seconds))));
    lines.extend(pick.obstacle.iter().map(|obstacle| ("in the way", obstacle.clone())));
}

/// What to take where nothing is asked for, what it costs, and what to type.
fn recommended_lines(document: &FrontierDocument, lines: &mut Vec<(&'static str, String)>) {
    let Some(recommended) = document.recommended.as_ref().filter(|_| document.pick.is_none()) else { return };
    let record = &document.points[recommended.point];
    lines.push(("take", format!("{}: {}", short(record), recommended.why)));
    lines.extend(command(document, record).map(|command| ("type", command)));
    lines.extend(cost(document, record).map(|cost| ("cost", cost)));
}

/// How much more time the taken row takes than the quickest, and how much less it errs.
fn cost(document: &FrontierDocument, taken: &FrontierRecord) -> Option<String> {
    let first = &document.points[*document.shortlist.first()?];
    let (from, to) = (first.error.zip(first.seconds)?, taken.error.zip(taken.seconds)?);
    let (less, more) = (from.0 / to.0, to.1.least / from.1.least);
    let [times_less, times_more] = [less, more].map(|ratio| significant(ratio, 2));
    match less > 1.05 && more > 1.05 {
        true if to.0 < ROUNDED => {
            Some(format!("its error is rounding; it takes {times_more} times as long as the first row"))
        }
        true => {
            Some(format!("it errs {times_less} times less than the first row and takes {times_more} times as long"))
        }
        false => None,
    }
}

/// How sure S and R are, where there is a posterior.
fn uncertainty_lines(document: &FrontierDocument, lines: &mut Vec<(&'static str, String)>) {
    for record in document.shortlist.iter().map(|k| &document.points[*k]) {
        let word = |value: Option<f64>| value.map_or("undefined".into(), |v| significant(v, 2));
        if record.u.curvedness.is_some() {
            let (s, r) = (word(record.u.shape_index), word(record.u.curvedness));
            let whose =
                "of what is recognised in all contacts (posterior); errors of S and R are unknown, as is the truth";
            lines.push(("u", format!("S {s}, R {r}: standard uncertainties {whose}")));
        }
    }
}

/// What else can be had.
fn more(document: &FrontierDocument) -> String {
    let ask =
        if judged_by_contacts(document) { "--budget T asks" } else { "--error-s E, --error-r E or --budget T ask" };
    format!("{ask} for what you need; --all prints every way that no other beats; --out DIR draws them")
}
