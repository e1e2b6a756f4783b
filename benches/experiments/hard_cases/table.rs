//! The hard-case table with the counts that the guarantee is held to.

use palpate_laboratory::hard_cases::HardCase;

use super::golden::judge::judge;
use super::golden::{Golden, table};

/// One line a case, then the counts.
pub(crate) fn table() -> String {
    let mut lines = vec![table::header()];
    let (mut broken, mut short, mut margins) = (0, 0, Vec::new());
    for case in HardCase::all() {
        let judged = judge(&case, &Golden::read(case.name));
        lines.push(table::row(&case, &judged));
        for k in 0..3 {
            let (Some(found), Some(guaranteed)) = (judged.found[k], judged.promised[k]) else { continue };
            broken += usize::from(guaranteed > found);
            margins.push(found - guaranteed);
            short += usize::from(judged.allowed[k].is_some_and(|allowed| found < allowed - 1.0));
        }
    }
    lines.push(format!("guaranteed above found: {broken} of {}; found below allowed - 1: {short}", margins.len()));
    lines.push(format!("median of found - guaranteed: {:.2}", median(&mut margins)));
    lines.join("\n")
}

/// Middle value; NaN of nothing.
fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    if values.is_empty() { f64::NAN } else { values[values.len() / 2] }
}
