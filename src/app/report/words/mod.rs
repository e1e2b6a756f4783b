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
use super::fold::PAGE_WIDTH;

pub(crate) use class::named;
pub(super) use class::{like, likelier, of_patch, of_the_patch, radius_of_class};
pub(super) use map::small_maps;
pub(crate) use numbers::chance;
pub(super) use table::{OPEN, flat_r};
use wrap::Labelled;

/// For whom the words are.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Audience {
    /// Columns of a line.
    pub(crate) width: usize,
    /// Somebody at a command line, who is told what else to type; a page and a notebook have no options.
    pub(crate) typing: bool,
    /// The technical lines follow.
    pub(crate) detailed: bool,
    /// Pictures and tables are written.
    pub(crate) drawn: bool,
}

impl Audience {
    /// Somebody who reads what others have run.
    pub(crate) const READER: Audience = Audience { width: PAGE_WIDTH, typing: false, detailed: true, drawn: true };

    /// What else there is, without what was asked for already.
    fn more(self) -> Option<String> {
        let all = [
            (!self.detailed, "--verbose: how it was found"),
            (!self.drawn, "--out DIR: pictures"),
            (true, "palpate explain R"),
        ];
        let left = all.iter().filter(|(open, _)| *open).map(|(_, words)| *words);
        self.typing.then(|| left.collect::<Vec<_>>().join("; "))
    }
}

/// Writes the first output; `name` is the scene or the file.
///
/// # Errors
/// What the system says.
pub(crate) fn write_words(
    name: &str,
    document: &FitDocument,
    audience: Audience,
    out: &mut dyn Write,
) -> std::io::Result<()> {
    let mut text = Labelled::new(audience.width);
    text.add("contacts", format!("{} touched points of {name}", document.contacts));
    text.add("shape", class::sentence(&document.shape) + &in_truth(document));
    text.blank();
    table::table(document, &mut text);
    text.blank();
    remarks::remarks(document, audience, &mut text);
    if let Some(more) = audience.more() {
        text.add("more", more);
    }
    out.write_all(text.text().as_bytes())
}

/// The class of the true surface, in a simulated world.
fn in_truth(document: &FitDocument) -> String {
    let class = document.truth.as_ref().and_then(|truth| truth.class.as_deref());
    class.map_or(String::new(), |class| match document.shape.class.as_deref() == Some(class) {
        true => ", as in truth".into(),
        false => format!("; in truth a {class}"),
    })
}

#[cfg(test)]
mod tests {
    use super::super::document::{Shares, TriedPart};
    use super::super::sample::full_document;
    use super::*;

    fn written(document: &FitDocument) -> String {
        let mut out = Vec::new();
        write_words("a.csv", document, Audience { typing: true, ..Audience::READER }, &mut out).unwrap();
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn every_line_fits_a_terminal() {
        let mut document = full_document();
        document.fit.notes = vec!["a long note that goes on ".repeat(20)];
        for line in written(&document).lines() {
            assert!(line.chars().count() <= PAGE_WIDTH && line == line.trim_end(), "{line}");
        }
    }

    /// A wide terminal has what a number means beside it, a narrow one below all of them.
    #[test]
    fn the_table_is_as_wide_as_its_reader() {
        let mut document = full_document();
        document.shape.class_by_area = None;
        let at = |width| {
            let mut out = Vec::new();
            write_words("a.csv", &document, Audience { width, ..Audience::READER }, &mut out).unwrap();
            String::from_utf8(out).unwrap()
        };
        let [wide, narrow] = [140, PAGE_WIDTH].map(at);
        let line = |text: &str, words: &str| text.lines().position(|line| line.contains(words)).unwrap();
        let [value, meaning] = ["R, strength of bend", "0 is flat"].map(|words| line(&wide, words));
        assert_eq!(value, meaning, "{wide}");
        let [value, meaning] = ["0.50", "0 is flat"].map(|words| line(&narrow, words));
        assert!(meaning > value + 1 && narrow.lines().all(|line| line.chars().count() <= PAGE_WIDTH), "{narrow}");
    }

    #[test]
    fn advice_that_was_taken_is_not_given_again() {
        let document = full_document();
        let said = |audience| {
            let mut out = Vec::new();
            write_words("a.csv", &document, audience, &mut out).unwrap();
            String::from_utf8(out).unwrap()
        };
        let fresh = said(Audience { typing: true, detailed: false, drawn: false, ..Audience::READER });
        let last = fresh.lines().last().unwrap();
        assert!(last.starts_with("more ") && last.contains("--out") && last.contains("--verbose"), "{fresh}");
        let drawn = said(Audience { typing: true, detailed: false, ..Audience::READER });
        assert!(!drawn.contains("--out") && drawn.contains("--verbose"), "{drawn}");
        assert!(!said(Audience::READER).contains("--") && !said(Audience::READER).contains("\nmore"));
    }

    /// The mean of S may lie in a class that nearly no surface which explains the contacts has.
    #[test]
    fn a_class_without_probability_is_not_said_as_found() {
        let mut document = full_document();
        let shape = &mut document.shape;
        (shape.class, shape.class_by_area) = (Some("ridge".into()), None);
        (shape.radius, shape.radii, shape.centre) = (Some(8.9), None, Some([0.0; 3]));
        let shares = |cap: f64, ridge: f64| Some(Shares(vec![("cap".into(), cap), ("ridge".into(), ridge)]));
        shape.class_probability = shares(0.57, 0.004);
        let text = written(&document);
        for words in ["between ridge and cap: the mean of S is that of a ridge, but 57 %", "shows on a larger patch"] {
            assert!(text.replace("\n           ", " ").contains(words), "{words}: {text}");
        }
        for words in
            ["do not tell which", "leave the class open", "pipe or bar that fits", "0.707/radius", "the axis goes"]
        {
            assert!(!text.contains(words), "{words}: {text}");
        }
        assert_eq!(named(&document.shape), "between ridge and cap");
        // where both are likely, nobody can tell, and the radius stands
        document.shape.class_probability = shares(0.5, 0.4);
        let text = written(&document).replace("\n           ", " ");
        assert!(
            text.contains("do not tell which (40 % and 50 % sure)") && text.contains("pipe or bar that fits"),
            "{text}"
        );
    }

    /// A plane that is likelier than each kind that bends, but not than all, is no answer, and is not called the next best.
    #[test]
    fn the_likeliest_kind_is_named_first() {
        let mut document = full_document();
        let kind = |name: &str, probability| TriedPart {
            name: name.into(),
            probability: Some(probability),
            ..TriedPart::default()
        };
        let mut said = |plane| {
            let chosen = document.fit.chosen.as_mut().unwrap();
            (chosen.hypothesis, chosen.tried) =
                (Some("sphere".into()), vec![kind("plane", plane), kind("sphere", 0.41)]);
            written(&document).replace("\n           ", " ")
        };
        let flat = said(0.45);
        assert!(
            flat.contains("of 2 kinds of surface a plane (45 %) explains the contacts best, of those that"),
            "{flat}"
        );
        let bent = said(0.25);
        assert!(
            bent.contains("of 2 kinds of surface a ball (41 %) explains the contacts best; next a plane"),
            "{bent}"
        );
    }

    #[test]
    fn units_are_echoed_when_given() {
        let mut document = full_document();
        document.unit = Some("mm".into());
        document.shape.class = Some("ridge".into());
        let text = written(&document);
        assert!(text.contains("per mm") && text.contains("0.5000 mm"), "{text}");
        document.unit = None;
        assert!(!written(&document).contains("mm"), "{text}");
    }
}
