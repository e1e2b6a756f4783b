//! Text from a file, or a file's name, as it may be shown: a control character could command a terminal, and has no place
//! in an SVG. A mark of direction would show the text in another order than it has (Unicode Technical Report 36, section 3.6).

/// The text with every character that is not seen itself, but changes how others are seen, written out, as `\u{1b}`.
pub(crate) fn visible(text: &str) -> String {
    let shown = |c: char| if changes_others(c) { c.escape_unicode().to_string() } else { c.to_string() };
    let as_before = |c: char| if c.is_control() { c.escape_default().to_string() } else { shown(c) };
    text.chars().map(as_before).collect()
}

/// Whether a character commands the terminal, reverses or joins what stands beside it, breaks the line, or has no width.
pub(crate) fn changes_others(c: char) -> bool {
    c.is_control()
        || matches!(c,
            '\u{61c}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{feff}' | '\u{fff9}'..='\u{fffb}'
            | '\u{e0000}'..='\u{e007f}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_written_out() {
        assert_eq!(visible("a\u{1b}[31mé\n"), "a\\u{1b}[31mé\\n");
    }

    #[test]
    fn marks_of_direction_and_marks_without_width_are_written_out() {
        assert_eq!(visible("a\u{202e}vsc.b"), "a\\u{202e}vsc.b");
        assert_eq!(visible("x\u{2066}y\u{200b}z\u{feff}"), "x\\u{2066}y\\u{200b}z\\u{feff}");
        assert_eq!(visible("Fläche 面 \u{5d0}"), "Fläche 面 \u{5d0}");
    }
}
