//! Text from a file, or a file's name, as it may be shown: a control character could command a terminal, and has no place
//! in an SVG.

/// The text with every control character written out, as `\u{1b}`.
pub(crate) fn visible(text: &str) -> String {
    let shown = |c: char| if c.is_control() { c.escape_default().to_string() } else { c.to_string() };
    text.chars().map(shown).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_written_out() {
        assert_eq!(visible("a\u{1b}[31mé\n"), "a\\u{1b}[31mé\\n");
    }
}
