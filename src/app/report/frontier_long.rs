//! Every point of a frontier that no other beats, and where the time of a fit goes: what `--all` and `--stages` print.

use std::fmt::Write as _;

use super::charts::time;
use super::frontier::{FrontierDocument, FrontierRecord};
use super::frontier_words::{judged_by_contacts, short};
use super::table::significant;

/// Columns of the bar of a stage.
const BAR: f64 = 20.0;

/// All frontiers, one after the other.
pub(super) fn long_tables(document: &FrontierDocument, text: &mut String) {
    let _ = writeln!(
        text,
        "\ninstructions: {}; work: multiply-adds; {}; * no other way is certainly better",
        document.counter, document.isa
    );
    let ways = if judged_by_contacts(document) { ["height", "normal"] } else { ["error S", "error R"] };
    for (frontier, head) in
        [("discretisation", ways), ("solver", ["digits", "error"]), ("interval", ["holds S", "ends"])]
    {
        frontier_lines(document, frontier, head, text);
    }
}

fn frontier_lines(document: &FrontierDocument, frontier: &str, head: [&str; 2], text: &mut String) {
    let all: Vec<&FrontierRecord> = document.points.iter().filter(|record| record.frontier == frontier).collect();
    if all.is_empty() {
        return;
    }
    let failed = all.iter().filter(|record| record.failed.is_some()).count();
    // of solvers and intervals, which are few, every point is shown
    let shown = |record: &&&FrontierRecord| frontier != "discretisation" || record.on_frontier;
    let mut shown: Vec<&FrontierRecord> = all.iter().filter(shown).copied().collect();
    shown.sort_by(|a, b| a.case.cmp(&b.case).then(least(a).total_cmp(&least(b))));
    let _ = writeln!(text, "\n{frontier}: {} of {} points, {failed} without an answer", shown.len(), all.len());
    let [first, second] = head;
    // instructions where they were asked for, else what palpate counts itself
    let counts: [(&str, Count); 2] =
        [("instr.", |record| record.instructions), ("work", |record| record.multiply_adds)];
    let count = counts.into_iter().find(|(_, of)| shown.iter().any(|record| of(record).is_some()));
    let _ = writeln!(text, "  {first:>8} {second:>8} {:>8} {:>7}", "time", count.map_or("", |(name, _)| name));
    for record in shown {
        record_line(record, frontier, count.map(|(_, of)| of), text);
    }
}

/// What is counted of a call.
type Count = fn(&FrontierRecord) -> Option<u64>;

fn least(record: &FrontierRecord) -> f64 {
    record.seconds.map_or(f64::INFINITY, |time| time.least)
}

fn record_line(record: &FrontierRecord, frontier: &str, count: Option<Count>, text: &mut String) {
    let number = |value: Option<f64>| value.map_or("-".into(), |v| significant(v, 2));
    let values = match (frontier, &record.errors) {
        ("solver", _) => [record.digits, record.error],
        ("interval", _) => [record.coverage.shape_index.map(|c| c.share), record.error],
        (_, errors) if record.error_R.is_none() => [errors.height, errors.normal_deg].map(|e| e.map(|e| e.rms)),
        _ => [record.error_S, record.error_R],
    };
    let name = short(record);
    if let Some(why) = &record.failed {
        let _ = writeln!(text, "  {name}: {why}");
        return;
    }
    let [first, second] = values.map(number);
    let seconds = record.seconds.map_or("-".into(), |seconds| time(seconds.least));
    let mark = if record.on_frontier { "*" } else { " " };
    let _ = write!(text, "{mark} {first:>8} {second:>8} {seconds:>8} ");
    if let Some(of) = count {
        let count = of(record).map_or("-".into(), |count| significant(count as f64, 3));
        let _ = write!(text, "{count:>7} ");
    }
    let _ = writeln!(text, "{name}");
}

/// Where the time of a fit and of a replicate goes.
pub(super) fn stage_lines(document: &FrontierDocument, text: &mut String) {
    for of in ["fit", "replicate"] {
        let stages: Vec<_> = document.stages.iter().filter(|stage| stage.of == of).collect();
        if stages.is_empty() {
            continue;
        }
        let whole: f64 = stages.iter().map(|stage| stage.seconds.median).sum();
        let _ = writeln!(text, "\nwhere the {} of a {of} go", time(whole));
        for stage in stages {
            let bar = "#".repeat((BAR * stage.share).round() as usize);
            let taken = time(stage.seconds.median.max(0.0));
            let percent = 100.0 * stage.share;
            let line = format!("  {:<11} {taken:>8} {percent:>4.0} %  {bar:<20}  {}", stage.stage, stage.saved_by);
            let _ = writeln!(text, "{}", line.trim_end());
        }
    }
}
