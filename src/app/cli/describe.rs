//! Where a description goes: files, standard output, a table for people. `run`, `fit` and `show` have this in common.

use std::path::PathBuf;
use std::time::Instant;

use crate::io::{ContactFormat, Input, write_contacts};
use crate::report::{
    Answer, Audience, Description, FitDocument, Provenance, Seconds, Subject, SurfacePictures, compute_shape,
    describe_fit, inverse_crime_remark, write_fit_page, write_json, write_table, write_words,
};

use super::failure::{Failure, fit_message};
use super::options::{OutputFlags, WordsFlags};
use super::output::{columns, print, wants_colour, with_bold_labels};
use super::save::save;

/// Where a description goes.
pub(super) struct Destination<'a> {
    pub(super) output: &'a OutputFlags,
    pub(super) words: &'a WordsFlags,
    pub(super) save: Option<&'a PathBuf>,
    /// Vertices of a saved mesh each way, where they were typed.
    pub(super) grid: Option<[usize; 2]>,
    /// What the page says of where its numbers come from.
    pub(super) provenance: Provenance,
}

/// When a verb began, and the seconds that it has taken so far.
pub(super) struct Taken {
    pub(super) began: Instant,
    /// Seconds of reading, or of simulating.
    pub(super) read: f64,
    /// Seconds of fitting.
    pub(super) fitted: f64,
}

/// Describes an answer of any kind wherever the flags ask for it; `name` is the scene or the file.
pub(super) fn describe(
    answer: &Answer,
    name: &str,
    subject: &Subject,
    taken: &Taken,
    to: &Destination,
) -> Result<(), Failure> {
    let description = description_of(answer, name, subject, taken)?;
    let saved = (to.save.is_some() || to.output.out.is_some()).then(|| description.saved());
    files(&description, saved.as_ref(), name, to.output, to.words, &to.provenance)?;
    // those that came in pieces are not here
    if let Input::Contacts(contacts) = subject.input
        && !contacts.is_empty()
    {
        let remark = subject.truth.and_then(inverse_crime_remark);
        to.output
            .file("contacts.csv", &mut |out| write_contacts(contacts, ContactFormat::Csv, remark.as_deref(), out))?;
    }
    to.output.publish()?;
    if let (Some(path), Some(document)) = (to.save, &saved) {
        save(path, document, name, to.grid, to.output.quiet)?;
    }
    // what `--save -` sent to standard output is not to be mixed with a table
    let saved_there = to.save.is_some_and(|path| path.as_os_str() == "-");
    show(&description, name, to.output, to.words, saved_there)
}

fn description_of<'a>(
    answer: &'a Answer,
    name: &str,
    subject: &Subject<'a>,
    taken: &Taken,
) -> Result<Description<'a>, Failure> {
    let clock = Instant::now();
    compute_shape(answer, subject.bare);
    let seconds = Seconds {
        read: taken.read,
        fit: taken.fitted,
        shape: clock.elapsed().as_secs_f64(),
        total: taken.began.elapsed().as_secs_f64(),
    };
    describe_fit(answer, subject, seconds).map_err(|e| Failure::Input(format!("{name}: {}", fit_message(&e))))
}

/// The document of an answer and nothing else.
pub(super) fn document_of(
    answer: &Answer,
    name: &str,
    subject: &Subject,
    taken: &Taken,
) -> Result<FitDocument, Failure> {
    Ok(description_of(answer, name, subject, taken)?.document().clone())
}

/// The files of the output directory, if one is asked for; `saved` is the document as it is saved.
pub(super) fn files(
    description: &Description,
    saved: Option<&FitDocument>,
    name: &str,
    output: &OutputFlags,
    words: &WordsFlags,
    provenance: &Provenance,
) -> Result<(), Failure> {
    let document = saved.unwrap_or_else(|| description.document());
    output.file("fit.json", &mut |out| write_json(document, out))?;
    output.file("maps.csv", &mut |out| description.write_maps_csv(out))?;
    output.file("maps.npz", &mut |out| description.write_maps_npz(out))?;
    if output.out.is_some() {
        let pictures = SurfacePictures::new(description, document, name);
        for name in SurfacePictures::NAMES {
            words.pictures.write(output, name, &|format, out| pictures.write(name, format, out))?;
        }
    }
    output.file("report.html", &mut |out| write_fit_page(description, document, name, provenance, out))
}

/// The document on standard output, as JSON or in words; no words where standard output is taken.
pub(super) fn show(
    description: &Description,
    name: &str,
    output: &OutputFlags,
    words: &WordsFlags,
    taken: bool,
) -> Result<(), Failure> {
    let document = description.document();
    if output.json {
        return print(&mut |out| write_json(document, out));
    }
    if output.quiet || taken {
        return Ok(());
    }
    let mut text = Vec::new();
    let width = columns();
    let audience = Audience { width, typing: true, detailed: words.verbose, drawn: output.out.is_some() };
    write_words(name, document, audience, &mut text)?;
    if words.verbose {
        text.push(b'\n');
        write_table(document, width, &mut text)?;
        let maps = description.small_maps();
        if !maps.is_empty() {
            text.extend(format!("\n{maps}").into_bytes());
        }
    }
    let text = String::from_utf8_lossy(&text);
    let text = if wants_colour() { with_bold_labels(&text).into() } else { text };
    output.tell(&mut |out| out.write_all(text.as_bytes()))
}
