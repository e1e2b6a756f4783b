//! Cards, tables and bars of a page, as HTML.

use std::fmt::Write as _;

use super::html::text;

/// Letters from which on a cell is a sentence.
const LONG: usize = 30;

/// A card with one large number; `lines` stand below it.
pub(super) fn card(name: &str, large: &str, lines: &[String]) -> String {
    let lines: String = lines.iter().map(|line| format!("<p>{}</p>", text(line))).collect();
    format!(
        "<div class=\"card\"><p class=\"name\">{}</p><p class=\"large\">{}</p>{lines}</div>\n",
        text(name),
        text(large)
    )
}

/// A table with a head; the first column names the row. On a phone it scrolls by itself.
pub(super) fn table(head: &[&str], rows: &[Vec<String>]) -> String {
    let cells: String = head.iter().map(|name| format!("<th scope=\"col\">{}</th>", text(name))).collect();
    let mut out = format!("<div class=\"scroll\" tabindex=\"0\"><table><thead><tr>{cells}</tr></thead><tbody>\n");
    for row in rows {
        let cells = row.iter().enumerate().map(|(k, cell)| {
            // sentences may be broken, numbers may not
            let class = if cell.chars().count() > LONG { " class=\"long\"" } else { "" };
            let (open, close) = if k == 0 { ("th scope=\"row\"", "th") } else { ("td", "td") };
            format!("<{open}{class}>{}</{close}>", text(cell))
        });
        let _ = writeln!(out, "<tr>{}</tr>", cells.collect::<String>());
    }
    out.push_str("</tbody></table></div>\n");
    out
}

/// Shares as bars: name, share from 0 to 1, and words behind it.
pub(super) fn bars(rows: &[(String, f64, String)]) -> String {
    let mut out = String::from("<table class=\"bars\"><tbody>\n");
    for (name, share, words) in rows {
        let width = 100.0 * share.clamp(0.0, 1.0);
        let _ = writeln!(
            out,
            "<tr><th scope=\"row\">{}</th><td><span class=\"share\" style=\"width:{width:.1}%\"></span></td><td class=\"number\">{}</td></tr>",
            text(name),
            text(words)
        );
    }
    out.push_str("</tbody></table>\n");
    out
}

/// Sentences as a list.
pub(super) fn list(sentences: &[String]) -> String {
    let items: String = sentences.iter().map(|sentence| format!("<li>{}</li>\n", text(sentence))).collect();
    format!("<ul>\n{items}</ul>\n")
}

/// What marks of a chart mean: style (`line`, `dashed`, or none for an area), colour's name in the style sheet, words.
pub(super) fn key(marks: &[(&str, &str, &str)]) -> String {
    let marks: Vec<_> = marks.iter().map(|(style, colour, words)| (*style, format!("var({colour})"), *words)).collect();
    let marks: Vec<_> = marks.iter().map(|(style, colour, words)| (*style, &colour[..], *words)).collect();
    coloured_key(&marks)
}

/// As [`key`], with colours as CSS has them.
pub(super) fn coloured_key(marks: &[(&str, &str, &str)]) -> String {
    let items = marks
        .iter()
        .map(|(style, colour, words)| format!("<li class=\"{style}\" style=\"--mark:{colour}\">{}</li>", text(words)));
    format!("<ul class=\"key\">{}</ul>\n", items.collect::<String>())
}

/// Remarks, where there are any.
pub(super) fn notes(notes: &[String]) -> String {
    if notes.is_empty() {
        return String::new();
    }
    format!("<section id=\"notes\"><h2>Worth knowing</h2>\n{}</section>\n", list(notes))
}
