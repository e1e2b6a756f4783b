//! The level of an interval as people say it.
//!
//! ```text
//! 0.95 -> 95 %      0.999 -> 99.9 %      0.9999 -> 99.99 %
//! ```

/// A level as per cent; rounding makes neither 100 % of 0.999 nor 94.99999999999999 % of 0.95.
pub(crate) fn percent(level: f64) -> String {
    format!("{} %", (1e6 * level).round() / 1e4)
}

#[cfg(test)]
mod tests {
    use super::percent;

    #[test]
    fn a_level_is_neither_rounded_to_all_nor_shown_with_its_rounding() {
        let cases =
            [(0.95, "95 %"), (0.99, "99 %"), (0.999, "99.9 %"), (0.9999, "99.99 %"), (0.9, "90 %"), (0.29, "29 %")];
        for (level, words) in cases {
            assert_eq!(percent(level), words);
        }
        assert_eq!(percent(0.95_f64.next_down()), "95 %");
    }
}
