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
pub(crate) fn write_study_table(document: &StudyDocument, out: &mut dyn Write) -> std::io::Result<()> {
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
    if !document.effects.is_empty() {
        line(
            "effects",
            format!("{:<18} {:>22} {:>22} {:>10} {:>10}", "", "share of var S", "share of var R", "S alone", "R alone"),
        );
        for effect in &document.effects {
            line("", effect_words(effect));
        }
        let sums = document.effects_sum.iter().map(|sum| share_words(sum.sum, sum.interval));
        let sums: Vec<String> = sums.map(|words| format!("{words:>22}")).collect();
        line("", format!("{:<18} {}", "sum", sums.join(" ")));
    }
    for note in &document.notes {
        line("note", note.clone());
    }
    out.write_all(folded(&text, Some(LABEL)).as_bytes())
}

fn quantity_lines(name: &str, part: &QuantityPart, level: f64, line: &mut dyn FnMut(&str, String)) {
    let (Some(mean), Some(sd)) = (part.mean, part.sd) else {
        line(name, "undefined in every replicate".into());
        return;
    };
    let mut words =
        format!("mean {}, differs by {} from replicate to replicate", significant(mean, 5), significant(sd, 3));
    if let (Some(truth), Some(bias)) = (part.truth, part.bias) {
        let _ = write!(words, ";  the truth is {}, the mean off by {}", significant(truth, 5), significant(bias, 2));
    }
    if part.undefined > 0 {
        let _ = write!(words, "   undefined in {}", part.undefined);
    }
    line(name, words);
    if let (Some(lo), Some(hi), Some([a, b])) = (part.lo, part.hi, part.shortest) {
        let error = |e: Option<f64>| e.map_or("?".into(), |e| significant(e, 1));
        let (e, f) = (error(part.standard_error.lo), error(part.standard_error.hi));
        line(
            "",
            format!(
                "{} of replicates between {} and {} (ends known to {e} and {f}); shortest such interval {} to {}",
                percent(level),
                significant(lo, 5),
                significant(hi, 5),
                significant(a, 5),
                significant(b, 5)
            ),
        );
    }
    for quantile in &part.quantiles {
        let value = significant(quantile.value, 5);
        line("", format!("quantile {}: {value} to {}", quantile.share, significant(quantile.standard_error, 1)));
    }
}

fn share_words(share: Option<f64>, interval: Option<[f64; 2]>) -> String {
    match (share, interval) {
        (Some(share), Some([lo, hi])) => format!("{share:.3} [{lo:.3}, {hi:.3}]"),
        _ => "-".into(),
    }
}

fn effect_words(effect: &EffectPart) -> String {
    let alone = |v: Option<f64>| v.map_or("-".into(), |v| significant(v, 2));
    format!(
        "{:<18} {:>22} {:>22} {:>10} {:>10}",
        effect.name,
        share_words(effect.share_S, effect.interval_S),
        share_words(effect.share_R, effect.interval_R),
        alone(effect.alone_S),
        alone(effect.alone_R)
    )
}
