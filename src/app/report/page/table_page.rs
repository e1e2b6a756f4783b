//! The page of a verb whose answer is a table alone.

use std::io::Write;

use super::html::{heading, text};
use super::provenance::Provenance;
use super::shell::Page;

/// What such a page shows.
pub(crate) struct TablePage<'a> {
    /// Small words above the title.
    pub kind: &'a str,
    /// What it is about.
    pub title: &'a str,
    /// A sentence.
    pub lead: &'a str,
    /// The document, as `--json` prints it.
    pub document: &'a [u8],
    /// The table, as the verb prints it.
    pub table: &'a [u8],
}

/// Lines of a table that are shown; the document in the page holds all of them.
const LINES: usize = 1000;

/// Writes the page.
///
/// # Errors
/// What the system says.
pub(crate) fn write_table_page(
    page: &TablePage<'_>,
    provenance: &Provenance,
    out: &mut dyn Write,
) -> std::io::Result<()> {
    let whole = String::from_utf8_lossy(page.table);
    let lines: Vec<&str> = whole.lines().take(LINES).collect();
    let left = whole.lines().count() - lines.len();
    let more = if left > 0 {
        format!("<p class=\"hint\">{left} more lines are in the page's document.</p>")
    } else {
        String::new()
    };
    let shown = Page {
        kind: page.kind,
        title: heading(page.title),
        lead: text(page.lead),
        sections: format!(
            "<section id=\"table\"><pre tabindex=\"0\">{}</pre>{more}</section>\n",
            text(&lines.join("\n"))
        ),
        document: page.document,
        table: page.table,
        ..Page::default()
    };
    shown.write(provenance, out)
}
