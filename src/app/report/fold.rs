//! Long lines of text for people, folded at blanks; what is folded goes on below the text and not below its label.
//!
//! ```text
//! note       a long remark that          hang = 11: columns of the label
//!            goes on here
//! ```

/// Columns of a line of a page, and of a text that nobody looks at in a terminal.
pub(crate) const PAGE_WIDTH: usize = 80;

/// The text with no line longer than `width`, but for words and tables that hold no place to break. What is folded goes on
/// `hang` columns to the right, or below the line's own first word.
pub(crate) fn folded(text: &str, hang: Option<usize>, width: usize) -> String {
    text.lines().map(|line| fold(line, hang, width) + "\n").collect()
}

fn fold(line: &str, hang: Option<usize>, width: usize) -> String {
    if line.chars().count() <= width {
        return line.into();
    }
    let own = line.chars().take_while(|c| *c == ' ').count();
    let hang = " ".repeat(hang.unwrap_or(own));
    let (mut folded, mut columns) = (String::new(), 0);
    // the blanks before a word stay as they are where the line does not break there, so that columns keep their places
    let mut gap = 0;
    for word in line.split(' ') {
        if word.is_empty() {
            gap += 1;
            continue;
        }
        let length = word.chars().count();
        if columns > hang.len() && columns + gap + length > width {
            folded.push('\n');
            folded.push_str(&hang);
            columns = hang.len();
        } else {
            folded.push_str(&" ".repeat(gap));
            columns += gap;
        }
        folded.push_str(word);
        columns += length;
        gap = 1;
    }
    folded
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDTH: usize = 110;

    #[test]
    fn long_lines_go_on_below_their_text_and_short_ones_stay() {
        let table = "a     b        c\n";
        assert_eq!(folded(table, Some(11), WIDTH), table);
        let text = folded(&format!("note       {}", "word ".repeat(60)), Some(11), WIDTH);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 3);
        assert!(lines.iter().all(|line| line.len() <= WIDTH && line.trim_end() == *line), "{text}");
        assert!(lines[0].starts_with("note       word") && lines[1].starts_with("           word"), "{text}");
        let own = folded(&format!("    {}", "word ".repeat(40)), None, WIDTH);
        assert!(own.lines().all(|line| line.starts_with("    word")), "{own}");
        // a word that is longer than a line has nowhere to break
        assert_eq!(folded(&"w".repeat(300), Some(11), WIDTH).lines().count(), 1);
    }
}
