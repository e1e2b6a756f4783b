//! The hard-case table: condition, method, digits found against 80-digit references, guaranteed and allowed.
//! `cargo bench --bench hard_cases` prints it, and `tests/library/hard_cases.rs` holds the recorded one against it.

use palpate_laboratory::hard_cases::HardCase;

use super::judge::{Digits, Judged};

/// The first two lines.
pub(crate) fn header() -> String {
    let text = format!(
        "digits of coefficients / S / R: found against the 80-digit reference, guaranteed, allowed by the data\n\
         {:<30} {:>8} {:<11} {:<15} {:<15} {:<15}",
        "case", "cond", "method", "found", "guaranteed", "allowed"
    );
    text.trim_end().to_string()
}

/// One line a case.
pub(crate) fn row(case: &HardCase, judged: &Judged) -> String {
    if !judged.answered {
        return format!("{:<30} refused: {}", case.name, judged.method);
    }
    let held = match (judged.unsupported, judged.fitted) {
        (0, _) => String::new(),
        (n, Some(error)) => format!("{n} free, heights at contacts within {error:.1e}"),
        (n, None) => format!("{n} free"),
    };
    let [found, guaranteed, allowed] = [judged.found, judged.promised, judged.allowed].map(three);
    let line = format!(
        "{:<30} {:>8.1e} {:<11} {found} {guaranteed} {allowed} {held}",
        case.name, judged.condition, judged.method
    );
    line.trim_end().to_string()
}

fn three(digits: Digits) -> String {
    digits.map(|d| d.map_or("   -".to_string(), |d| format!("{d:4.1}"))).join(" ")
}
