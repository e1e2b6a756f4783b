//! `palpate fit` of several things: the first lines of `palpate parts`, since they have no one shape.
//!
//! ```text
//! a table on the screen                      what the parts are, and the command that says more
//! --json, --out, --save, several files       the refusal: these hold one surface
//! ```

use std::time::Instant;

use crate::io::{Input, Reading};
use crate::report::{PartsDocument, write_parts_table};
use palpate_inference::parts::{Parts, PartsError, PartsOptions};

use super::failure::Failure;
use super::found::SeveralThings;
use super::options::OutputFlags;
use super::output::{Spinner, columns};
use super::reading::seen_from;

/// Lines of the table of parts that stand here; the rest is what `palpate parts` is for.
const FIRST_LINES: usize = 12;

/// Contacts that were recognised as several things.
pub(super) struct Things {
    pub(super) reading: Reading,
    pub(super) found: SeveralThings,
}

/// How they are to be told.
pub(super) struct TellThings<'a> {
    pub(super) output: &'a OutputFlags,
    /// Whether a surface is to be saved.
    pub(super) saves: bool,
    /// Where the sensor stood, if it was said.
    pub(super) viewpoint: Option<[f64; 3]>,
}

impl Things {
    /// Where one surface is wanted.
    pub(super) fn refused(&self) -> Failure {
        Failure::Input(format!("{}: {}", self.reading.file, self.found.message))
    }

    /// Says what the parts are.
    ///
    /// # Errors
    /// The refusal, where an output holds one surface, and where no two parts hold most contacts.
    pub(super) fn tell(&self, told: &TellThings, spinner: Spinner) -> Result<(), Failure> {
        let Input::Contacts(contacts) = &self.reading.input else { return Err(self.refused()) };
        if told.output.json || told.output.out.is_some() || told.saves {
            return Err(self.refused());
        }
        spinner.phase(&format!("looking for the parts of {}", self.reading.file));
        let clock = Instant::now();
        let options =
            PartsOptions { viewpoint: told.viewpoint.or(seen_from(&self.reading)), ..PartsOptions::default() };
        let cut = || match Parts::of(contacts, &options) {
            Ok(found) if holds_most(&found) => Ok(found),
            // says more than that one surface does not hold them
            Err(error @ PartsError::Volume { .. }) => Err(Failure::Input(format!("{}: {error}", self.reading.file))),
            _ => Err(self.refused()),
        };
        let found = self.found.parts.clone().map_or_else(cut, Ok)?;
        let document = PartsDocument::new(&self.reading.file, &found, Vec::new(), clock.elapsed().as_secs_f64());
        drop(spinner);
        if told.output.quiet {
            return Ok(());
        }
        told.output.tell(&mut |out| {
            let mut table = Vec::new();
            write_parts_table(&document, columns(), &mut table)?;
            let table = String::from_utf8_lossy(&table).into_owned();
            writeln!(out, "shape      several things, which have no one shape")?;
            table.lines().take(FIRST_LINES).try_for_each(|line| writeln!(out, "{line}"))?;
            writeln!(out, "more       palpate parts {}: joints, pictures, every point's part", self.reading.file)
        })
    }
}

/// Whether several parts hold most contacts.
fn holds_most(found: &Parts) -> bool {
    let held = found.labels.iter().flatten().count();
    found.parts.len() > 1 && 2 * held > found.labels.len()
}
