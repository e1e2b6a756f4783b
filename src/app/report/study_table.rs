//! A study as a table for people: one labelled line a thing, numbers rounded to what they are worth.

use std::fmt::Write as _;
use std::io::Write;

use super::fold::folded;
use super::percent::percent;
use super::study::{EffectPart, LinearQuantity, QuantityPart, StudyDocument};
use super::table::significant;
use palpate_studies::montecarlo::Stopped;

/// Columns of a label.
const LABEL: usize = 11;

/// The word for why a study ended.
pub(crate) fn stopped_words(stopped: Stopped) -> &'static str {
    match stopped {
        Stopped::Replicates => "all replicates done",
        Stopped::Tolerance => "the digits asked for are there",
        Stopped::Budget => "the time is up",
    }
}

/// Writes the table of one study.
///
/// # Errors
/// What the system says.
pub(crate) fn write_study_table(document: &StudyDocument, width: usize, out: &mut dyn Write) -> std::io::Result<()> {
    let mut text = String::new();
    let mut line = |label: &str, words: String| {
        let _ = writeln!(text, "{label:<10} {}", words.trim_end());
    };
    line("study", format!("{} replicates of {}, seed {}", document.replicates, document.scene, document.seed));
    let rate = document.replicates_per_second.map_or(String::new(), |r| format!(", {} a second", significant(r, 3)));
    line("stopped", format!("{}{rate}", document.stopped));
    line("path", format!("{}: {}", document.path, document.path_why));
    let quantities = [("S", &document.shape_index), ("R", &document.curvedness)];
    let others = document.quantities.0.iter().map(|(name, part)| (name.as_str(), part));
    for (name, part) in quantities.into_iter().chain(others) {
        quantity_lines(name, part, document.level, &mut line);
    }
    let shares = document.class.0.iter().filter(|(_, share)| *share > 0.0);
    let shares: Vec<String> = shares.map(|(name, share)| format!("{name} {share:.4}")).collect();
    line("class", shares.join("   "));
    let verdict = document.verdict.as_ref().map_or_else(
        || format!("none: no class has a share of {}", document.level),
        |class| format!("{class}, with a share of {} or more", document.level),
    );
    line("verdict", verdict);
    let linear = |part: &LinearQuantity| match (part.sd, part.lo, part.hi) {
        (Some(sd), Some(lo), Some(hi)) => {
            format!("sd {} [{}, {}]", significant(sd, 3), significant(lo, 4), significant(hi, 4))
        }
        _ => "undefined".into(),
    };
    let law = &document.linear;
    line("linear", format!("S {}   R {}", linear(&law.shape_index), linear(&law.curvedness)));
    line("", format!("{}: {}", if law.valid { "valid" } else { "not valid" }, law.why));
    effect_lines(document, &mut text);
    for note in &document.notes {
        let _ = writeln!(text, "{:<10} {}", "note", note.trim_end());
    }
    out.write_all(folded(&text, Some(LABEL), width).as_bytes())
}

fn quantity_lines(name: &str, part: &QuantityPart, level: f64, line: &mut dyn FnMut(&str, String)) {
    let (Some(mean), Some(sd)) = (part.mean, part.sd) else {
        line(name, "undefined in every replicate".into());
        return;
    };
    let error = &part.standard_error;
    let mut words =
        format!("mean {}, differs by {} from replicate to replicate", known_to(mean, error.mean), significant(sd, 3));
    if let (Some(truth), Some(bias)) = (part.truth, part.bias) {
        let _ = write!(words, ";  the truth is {}, the mean off by {}", significant(truth, 5), significant(bias, 2));
    }
    if part.undefined > 0 {
        let _ = write!(words, "   undefined in {}", part.undefined);
    }
    line(name, words);
    if let (Some(lo), Some(hi), Some([a, b])) = (part.lo, part.hi, part.shortest) {
        let said = |e: Option<f64>| e.map_or("?".into(), |e| significant(e, 1));
        let (e, f) = (said(error.lo), said(error.hi));
        let [of_a, of_b] = error.shortest.map_or([None; 2], |ends| ends.map(Some));
        line(
            "",
            format!(
                "{} of replicates between {} and {} (ends known to {e} and {f}); shortest such interval {} to {}",
                percent(level),
                known_to(lo, error.lo),
                known_to(hi, error.hi),
                known_to(a, of_a),
                known_to(b, of_b)
            ),
        );
    }
    for quantile in &part.quantiles {
        let value = known_to(quantile.value, Some(quantile.standard_error));
        line("", format!("quantile {}: {value} to {}", quantile.share, significant(quantile.standard_error, 1)));
    }
}

/// Most significant digits of a value that is known exactly.
const EXACT: i32 = 5;

/// A value with as many digits as it is known to: the last one is that of its standard error's first.
fn known_to(value: f64, error: Option<f64>) -> String {
    let Some(error) = error.filter(|e| *e > 0.0 && e.is_finite() && *e < value.abs()) else {
        return significant(value, EXACT);
    };
    // an error that is rounded up to the next power of ten takes a digit with it
    let first = significant(error, 1).parse().unwrap_or(error);
    let digits = value.abs().log10().floor() - first.log10().floor();
    significant(value, (digits as i32 + 1).clamp(1, 2 * EXACT))
}

fn share_words(share: Option<f64>, interval: Option<[f64; 2]>) -> String {
    match (share, interval) {
        (Some(share), Some([lo, hi])) => format!("{share:.3} [{lo:.3}, {hi:.3}]"),
        _ => "-".into(),
    }
}

fn effect_words(effect: &EffectPart) -> String {
    let alone = |v: Option<f64>| v.map_or("-".into(), |v| significant(v, 2));
    let [s, r] = [share_words(effect.share_S, effect.interval_S), share_words(effect.share_R, effect.interval_R)];
    row_of([effect.name.as_str(), &s, &r, &alone(effect.alone_S), &alone(effect.alone_R)])
}

/// The effects, one a row.
fn effect_lines(document: &StudyDocument, text: &mut String) {
    if document.effects.is_empty() {
        return;
    }
    let head = row_of(["effects", "share of var S", "share of var R", "S alone", "R alone"]);
    let sums: Vec<String> = document.effects_sum.iter().map(|sum| share_words(sum.sum, sum.interval)).collect();
    let [s, r] = [0, 1].map(|k| sums.get(k).map_or("", String::as_str));
    let rows = document.effects.iter().map(effect_words);
    for row in std::iter::once(head).chain(rows).chain([row_of(["sum", s, r, "", ""])]) {
        text.push_str(row.trim_end());
        text.push('\n');
    }
}

/// One row of the effects, which fits a narrow terminal.
fn row_of([name, s, r, alone_s, alone_r]: [&str; 5]) -> String {
    format!("{name:<17} {s:>20}  {r:>20} {alone_s:>8}  {alone_r:>8}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_end_where_the_error_begins() {
        let cases = [
            (0.498123, Some(0.0004), "0.4981"),
            (0.498123, Some(0.03), "0.50"),
            (0.0802345, Some(0.00098), "0.080"),
            (12.34567, Some(0.02), "12.35"),
            (0.5, None, "0.50000"),
            (0.001, Some(0.5), "0.0010000"),
        ];
        for (value, error, text) in cases {
            assert_eq!(known_to(value, error), text, "{value} {error:?}");
        }
    }
}
