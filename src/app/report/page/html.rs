//! Text, names and documents as they may stand in a page.
//!
//! ```text
//! text      & < > " '  as entities; control characters and those that turn the direction of writing written out
//! document  & < > U+2028 U+2029  as \uXXXX inside JSON, so that no name can end the script that holds it
//! ```

use std::fmt::Write as _;

use crate::io::{changes_others, visible};

/// Letters of a name that are shown in a heading; the whole name stands at the page's end.
const MOST_LETTERS: usize = 80;

/// Text between tags, or in an attribute's quotes.
pub(crate) fn text(plain: &str) -> String {
    let mut out = String::with_capacity(plain.len());
    for c in plain.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\n' => out.push('\n'),
            c if turns(c) => {
                let _ = write!(out, "{}", c.escape_unicode());
            }
            c if changes_others(c) => out.push_str(&visible(&c.to_string())),
            c => out.push(c),
        }
    }
    out
}

/// Marks that turn the direction of writing: they would let a name change what stands around it.
fn turns(c: char) -> bool {
    matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// A name that is short enough for a heading: its beginning and its end.
pub(super) fn short(name: &str) -> String {
    let count = name.chars().count();
    if count <= MOST_LETTERS {
        return name.into();
    }
    let half = MOST_LETTERS / 2;
    let head: String = name.chars().take(half).collect();
    let tail: String = name.chars().skip(count - half).collect();
    format!("{head} ... {tail}")
}

/// A name for a heading: the last part of a path, shortened.
pub(super) fn heading(name: &str) -> String {
    let last = std::path::Path::new(name).file_name().and_then(|last| last.to_str()).unwrap_or(name);
    short(last)
}

/// JSON that may stand in a script: these characters stand in its strings alone, and read back as themselves.
pub(super) fn embedded(json: &str) -> String {
    let mut out = String::with_capacity(json.len());
    for c in json.chars() {
        match c {
            c if turns(c) || matches!(c, '<' | '>' | '&' | '\u{2028}' | '\u{2029}') => {
                let _ = write!(out, "\\u{:04x}", u32::from(c));
            }
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markup_and_turned_writing_stay_text() {
        assert_eq!(text("<b>\"x\" & 'y'</b>"), "&lt;b&gt;&quot;x&quot; &amp; &#39;y&#39;&lt;/b&gt;");
        assert_eq!(text("a\u{1b}[31m\u{202e}b"), "a\\u{1b}[31m\\u{202e}b");
        assert_eq!(embedded("\"</script>\u{2028}\""), "\"\\u003c/script\\u003e\\u2028\"");
        let long = "x".repeat(10_000);
        assert!(short(&long).chars().count() < 100 && heading("a/b/c.csv") == "c.csv");
    }
}
