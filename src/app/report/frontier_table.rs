//! A frontier as a table for people: the points that no other beats, and how many others there are.

use std::fmt::Write as _;
use std::io::Write;

use super::fold::folded;
use super::frontier::{FrontierDocument, FrontierRecord};
use super::table::significant;
use palpate_studies::frontier::Clocked;

/// The points on every frontier, the picked one, and where the time of a fit goes.
///
/// # Errors
/// What the system says.
pub(crate) fn write_frontier_table(
    document: &FrontierDocument,
    width: usize,
    out: &mut dyn Write,
) -> std::io::Result<()> {
    let mut text = String::new();
    // writing to a string cannot fail
    let _ = writeln!(text, "{}: errors against {}, one thread, {}", document.scene, document.reference, document.isa);
    let _ = writeln!(text, "instructions: {}", document.counter);
    for (frontier, head) in [
        ("discretisation", ["error S", "error R"]),
        ("solver", ["digits", "error"]),
        ("interval", ["coverage S", "error of ends"]),
    ] {
        frontier_lines(document, frontier, head, &mut text);
    }
    stage_lines(document, &mut text);
    pick_lines(document, &mut text);
    for note in &document.notes {
        text.push_str(&folded(&format!("note: {note}"), Some(6), width));
    }
    out.write_all(text.as_bytes())
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
    shown.sort_by(|a, b| a.case.cmp(&b.case).then(median(a).total_cmp(&median(b))));
    let _ = writeln!(text, "\n{frontier}: {} of {} points, {failed} without an answer", shown.len(), all.len());
    let [first, second] = head;
    let _ = writeln!(
        text,
        "  {:<52} {first:>11} {second:>13} {:>10} {:>21} {:>12} {:>13}",
        "", "us", "interval", "instructions", "us, interval"
    );
    for record in shown {
        record_line(record, frontier, text);
    }
}

fn median(record: &FrontierRecord) -> f64 {
    record.seconds.map_or(f64::INFINITY, |time| time.median)
}

fn record_line(record: &FrontierRecord, frontier: &str, text: &mut String) {
    let number = |value: Option<f64>, digits: i32| value.map_or("-".into(), |v| significant(v, digits));
    let micro = |time: Option<Clocked>| number(time.map(|time| 1e6 * time.median), 3);
    let interval = record
        .seconds
        .map_or("-".into(), |time| format!("[{}, {}]", significant(1e6 * time.lo, 3), significant(1e6 * time.hi, 3)));
    let [first, second] = match frontier {
        "solver" => [number(record.digits, 3), number(record.error, 2)],
        "interval" => [number(record.coverage.shape_index.map(|c| c.share), 3), number(record.error, 2)],
        _ => [number(record.error_S, 3), number(record.error_R, 3)],
    };
    let name = if frontier == "solver" { format!("{}: {}", record.case, record.label) } else { record.label.clone() };
    let mark = if record.on_frontier { "*" } else { " " };
    if let Some(why) = &record.failed {
        let _ = writeln!(text, "{mark} {name:<52} {why}");
        return;
    }
    let _ = writeln!(
        text,
        "{mark} {name:<52} {first:>11} {second:>13} {:>10} {interval:>21} {:>12} {:>13}",
        micro(record.seconds),
        record.instructions.map_or("-".into(), |n| n.to_string()),
        micro(record.seconds_interval),
    );
}

fn stage_lines(document: &FrontierDocument, text: &mut String) {
    for of in ["fit", "replicate"] {
        let stages: Vec<_> = document.stages.iter().filter(|stage| stage.of == of).collect();
        if stages.is_empty() {
            continue;
        }
        let whole: f64 = stages.iter().map(|stage| stage.seconds.median).sum();
        let _ = writeln!(text, "\nwhere the {} us of a {of} go", significant(1e6 * whole, 3));
        for stage in stages {
            let bar = "#".repeat((40.0 * stage.share).round() as usize);
            let time = significant(1e6 * stage.seconds.median, 3);
            let percent = 100.0 * stage.share;
            let _ =
                writeln!(text, "  {:<12} {time:>9} us {percent:>5.1} %  {bar:<40}  {}", stage.stage, stage.saved_by);
        }
    }
}

fn pick_lines(document: &FrontierDocument, text: &mut String) {
    let Some(pick) = &document.pick else { return };
    let verb = if pick.met { "picked" } else { "nothing meets the request; nearest" };
    let error = |value: Option<f64>| value.map_or("-".into(), |v| significant(v, 3));
    let _ = writeln!(
        text,
        "\n{verb}: {}\n  errors kept in 95 of 100 runs: S {}, R {};  {} us",
        pick.label,
        error(pick.error_S),
        error(pick.error_R),
        significant(1e6 * pick.seconds, 3)
    );
    if let Some(obstacle) = &pick.obstacle {
        let _ = writeln!(text, "  in the way: {obstacle}");
    }
}
