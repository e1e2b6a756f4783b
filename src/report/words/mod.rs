//! The first output: what was found, how sure that is, what to do next, in words for somebody who knows no statistics.
//!
//! ```text
//! contacts.csv, 60 contacts
//! shape   a ridge ...                                    class
//!         value    95 % sure to lie between              table
//! S       0.5001   0.4800 and 0.5226
//! how sure, noise, notes, next                           remarks
//! ```
//!
//! The technical lines that `--verbose` adds are those of [`super::table`].

mod class;
mod map;
mod numbers;
mod remarks;
mod table;
mod wrap;

use std::io::Write;

use super::document::FitDocument;

pub(super) use class::{like, of_the_patch};
pub(super) use map::small_maps;
pub(super) use numbers::chance;
pub(super) use table::OPEN;
use wrap::Labelled;

/// Writes the first output; `name` is the scene or the file.
///
/// # Errors
/// What the system says.
pub(crate) fn write_words(name: &str, document: &FitDocument, out: &mut dyn Write) -> std::io::Result<()> {
    let mut text = Labelled::default();
    text.add("contacts", format!("{} touched points of {name}", document.contacts));
    text.add("shape", class::sentence(&document.shape));
    text.blank();
    text.push(&table::table(document));
    text.blank();
    remarks::remarks(document, &mut text);
    text.add(
        "more",
        "--verbose: how it was found.  --out DIR: pictures, tables.  --json: for programs.  palpate explain R: what R means",
    );
    out.write_all(text.text().as_bytes())
}

#[cfg(test)]
mod tests {
    use super::super::schema::full;
    use super::*;

    fn written(document: &FitDocument) -> String {
        let mut out = Vec::new();
        write_words("a.csv", document, &mut out).unwrap();
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn every_line_fits_a_terminal() {
        let mut document = full();
        document.fit.notes = vec!["a long note that goes on ".repeat(20)];
        for (k, block) in written(&document).split("\n\n").enumerate() {
            // the rows of the table, in the second block, cannot be wrapped
            let most = if k == 1 { 125 } else { wrap::WIDTH };
            for line in block.lines() {
                assert!(line.chars().count() <= most && line == line.trim_end(), "{line}");
            }
        }
    }

    #[test]
    fn units_are_echoed_when_given() {
        let mut document = full();
        document.unit = Some("mm".into());
        document.shape.class = Some("ridge".into());
        let text = written(&document);
        assert!(text.contains("per mm") && text.contains("0.5000 mm"), "{text}");
        document.unit = None;
        assert!(!written(&document).contains("mm"), "{text}");
    }
}
