//! The hard-case table: condition, method, digits found against 80-digit references, digits promised and allowed.

use palpate::cases::hard_cases;

use super::golden::Golden;
use super::golden::judge::{Digits, judge};

/// One line a case, then the counts that the promise is held to.
pub fn print() {
    println!("digits of coefficients / S / R: found against the 80-digit reference, promised, allowed by the data");
    println!("{:<30} {:>8} {:<11} {:<15} {:<15} {:<15}", "case", "cond", "method", "found", "promised", "allowed");
    let (mut broken, mut short, mut margins) = (0, 0, Vec::new());
    for case in hard_cases() {
        let row = judge(&case, &Golden::read(case.name));
        if !row.answered {
            println!("{:<30} refused: {}", case.name, row.method);
            continue;
        }
        for k in 0..3 {
            let (Some(found), Some(promised)) = (row.found[k], row.promised[k]) else { continue };
            broken += usize::from(promised > found);
            margins.push(found - promised);
            short += usize::from(row.allowed[k].is_some_and(|allowed| found < allowed - 1.0));
        }
        let held = match (row.unsupported, row.fitted) {
            (0, _) => String::new(),
            (n, Some(error)) => format!("{n} free, heights at contacts within {error:.1e}"),
            (n, None) => format!("{n} free"),
        };
        let [found, promised, allowed] = [row.found, row.promised, row.allowed].map(three);
        println!("{:<30} {:>8.1e} {:<11} {found} {promised} {allowed} {held}", case.name, row.condition, row.method);
    }
    println!("promised above found: {broken} of {}; found below allowed - 1: {short}", margins.len());
    println!("median of found - promised: {:.2}", median(&mut margins));
    println!();
}

fn three(digits: Digits) -> String {
    digits.map(|d| d.map_or("   -".to_string(), |d| format!("{d:4.1}"))).join(" ")
}

/// Middle value; NaN of nothing.
pub fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    if values.is_empty() { f64::NAN } else { values[values.len() / 2] }
}
