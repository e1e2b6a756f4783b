//! Labelled lines, wrapped at words.

use std::fmt::Write as _;

/// Columns of a label.
const LABEL: usize = 11;

/// Text that is put together line by line.
pub(super) struct Labelled {
    text: String,
    width: usize,
}

impl Labelled {
    /// Nothing yet, in lines of so many columns.
    pub(super) fn new(width: usize) -> Labelled {
        Labelled { text: String::new(), width }
    }

    /// A labelled paragraph; further lines stand below its text.
    pub(super) fn add(&mut self, label: &str, words: impl AsRef<str>) {
        let (mut line, mut label) = (String::new(), label);
        for word in unbroken(words.as_ref()) {
            if !line.is_empty() && LABEL + line.chars().count() + 1 + word.chars().count() > self.width {
                self.line(label, &line);
                (line, label) = (String::new(), "");
            }
            if !line.is_empty() {
                line.push(' ');
            }
            line.push_str(word);
        }
        self.line(label, &line);
    }

    fn line(&mut self, label: &str, words: &str) {
        let _ = writeln!(self.text, "{}", format!("{label:<LABEL$}{}", words.trim()).trim_end());
    }

    /// An empty line, never two.
    pub(super) fn blank(&mut self) {
        if !self.text.ends_with("\n\n") {
            self.text.push('\n');
        }
    }

    /// A line as it is.
    pub(super) fn push(&mut self, line: &str) {
        self.text.push_str(line);
        self.text.push('\n');
    }

    /// Columns of a line.
    pub(super) fn width(&self) -> usize {
        self.width
    }

    pub(super) fn text(&self) -> &str {
        &self.text
    }
}

/// Words at which a line may break: a number keeps its percent sign.
fn unbroken(text: &str) -> impl Iterator<Item = &str> {
    let mut rest = Some(text);
    std::iter::from_fn(move || {
        let here = rest?;
        let end = here.match_indices(' ').map(|(at, _)| at).find(|at| !here[at + 1..].starts_with('%'));
        rest = end.map(|at| &here[at + 1..]);
        Some(&here[..end.unwrap_or(here.len())])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDTH: usize = 110;

    #[test]
    fn long_paragraphs_go_on_below_their_text() {
        let mut text = Labelled::new(WIDTH);
        text.add("note", "word ".repeat(30));
        let lines: Vec<&str> = text.text().lines().collect();
        assert_eq!(lines.len(), 2);
        assert!(lines[0].starts_with("note       word") && lines[1].starts_with("           word"), "{lines:?}");
        let mut text = Labelled::new(WIDTH);
        text.add("note", format!("{} (1 %)", "w".repeat(WIDTH - LABEL - 3)));
        assert!(text.text().ends_with("\n           (1 %)\n"), "{}", text.text());
    }
}
