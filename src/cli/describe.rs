//! Where a description goes: files, standard output, a table for people. `run`, `fit` and `show` have this in common.

use std::path::PathBuf;
use std::time::Instant;

use crate::io::{ContactFormat, Input, write_atomically, write_contacts};
use crate::report::{
    Answer, Description, Seconds, Subject, compute_shape, describe_fit, inverse_crime_remark, write_json, write_table,
    write_words,
};

use super::failure::{Failure, fit_message};
use super::options::{OutputFlags, WordsFlags};
use super::output::{print, wants_colour, with_bold_labels};

/// Where a description goes.
pub(super) struct Destination<'a> {
    pub(super) output: &'a OutputFlags,
    pub(super) words: &'a WordsFlags,
    pub(super) save: Option<&'a PathBuf>,
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
    let clock = Instant::now();
    compute_shape(answer, subject.bare);
    let seconds = Seconds {
        read: taken.read,
        fit: taken.fitted,
        shape: clock.elapsed().as_secs_f64(),
        total: taken.began.elapsed().as_secs_f64(),
    };
    let description =
        describe_fit(answer, subject, seconds).map_err(|e| Failure::Input(format!("{name}: {}", fit_message(&e))))?;
    files(&*description, name, to.output)?;
    if let Input::Contacts(contacts) = subject.input {
        let remark = subject.truth.and_then(inverse_crime_remark);
        to.output
            .file("contacts.csv", &mut |out| write_contacts(contacts, ContactFormat::Csv, remark.as_deref(), out))?;
    }
    to.output.publish()?;
    if let Some(path) = to.save {
        write_atomically(path, &mut |out| write_json(description.document(), out))?;
    }
    // what `--save -` sent to standard output is not to be mixed with a table
    let saved_there = to.save.is_some_and(|path| path.as_os_str() == "-");
    show(&*description, name, to.output, to.words, saved_there)
}

/// The files of the output directory, if one is asked for.
pub(super) fn files(description: &dyn Description, name: &str, output: &OutputFlags) -> Result<(), Failure> {
    output.file("fit.json", &mut |out| write_json(description.document(), out))?;
    output.file("maps.csv", &mut |out| description.write_maps_csv(out))?;
    output.file("maps.npz", &mut |out| description.write_maps_npz(out))?;
    output.file("shape.svg", &mut |out| description.write_picture(name, out))
}

/// The document on standard output, as JSON or in words; no words where standard output is taken.
pub(super) fn show(
    description: &dyn Description,
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
    write_words(name, document, &mut text)?;
    if words.verbose {
        text.push(b'\n');
        write_table(document, &mut text)?;
        let maps = description.small_maps();
        if !maps.is_empty() {
            text.extend(format!("\n{maps}").into_bytes());
        }
    }
    let text = String::from_utf8_lossy(&text);
    let text = if wants_colour() { with_bold_labels(&text).into() } else { text };
    print(&mut |out| out.write_all(text.as_bytes()))
}
