//! Columns with their places, checked, as what was read: the last step of every reader of contacts.

use super::columns::Columns;
use super::place::{Places, Runs, Unit};
use super::{Input, IoError, ReadOptions, Reading};

/// Contacts from columns; `numbers` are the lines (entries, vertices) of the rows, called `unit`.
pub(super) fn reading_of(
    file: &str,
    columns: Columns,
    (numbers, unit): (Runs, Unit),
    options: &ReadOptions,
) -> Result<Reading, IoError> {
    let made = columns.into_contacts(file, options, &|row| unit.place(numbers.get(row)))?;
    Ok(Reading {
        input: Input::Contacts(made.contacts),
        file: file.into(),
        skipped: made.skipped,
        ignored: made.ignored,
        places: Some(Places::new(unit, numbers, made.kept.as_deref())),
        notes: Vec::new(),
        viewpoint: None,
    })
}
