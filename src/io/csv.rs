//! CSV: a header naming columns in any order, one row per contact, `#` comments, blank lines ignored.

use std::borrow::Cow;
use std::io::Write;

use crate::contact::Contacts;

use super::columns::{Column, Columns, Need, columns_of};
use super::place::{Place, Places, Runs, Unit};
use super::{Input, IoError, ReadOptions, Reading};

const EXAMPLE: &str = "x,y,z,nx,ny,nz";

/// Contacts from the bytes of a CSV file.
pub(super) fn read(file: &str, bytes: &[u8], options: &ReadOptions) -> Result<Reading, IoError> {
    let (columns, lines) = read_columns(file, bytes, Need::Contacts, options)?;
    let made = columns.into_contacts(file, options, &|row| Place::Line(lines.get(row)))?;
    Ok(Reading {
        input: Input::Contacts(made.contacts),
        file: file.into(),
        skipped: made.skipped,
        ignored: made.ignored,
        places: Some(Places::new(Unit::Line, lines, made.kept.as_deref())),
    })
}

/// The known columns of a CSV file and the line of each row. Fields that are no number become NaN under `skip_invalid`.
pub(super) fn read_columns(
    file: &str,
    bytes: &[u8],
    need: Need,
    options: &ReadOptions,
) -> Result<(Columns, Runs), IoError> {
    let text = utf8(file, bytes)?;
    let mut rows = text
        .split('\n')
        .enumerate()
        .map(|(index, line)| (index + 1, line.trim()))
        .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
    let (header_line, header) = rows.next().ok_or_else(|| IoError::Empty { file: file.into() })?;
    let names: Vec<Cow<str>> = fields(header).collect();
    check_header(file, header_line, header, &names)?;
    let names: Vec<&str> = names.iter().map(|name| name.as_ref()).collect();
    let mut columns = Columns::named(file, &names, need)?;

    // per field of a row: which of `targets` it goes to
    let mut targets: Vec<(Column, Vec<f64>)> = Vec::new();
    let slots: Vec<Option<usize>> = names
        .iter()
        .map(|name| {
            let column = Column::of(name).filter(|c| columns.has(*c))?;
            targets.push((column, Vec::new()));
            Some(targets.len() - 1)
        })
        .collect();
    let mut lines = Runs::default();
    for (line, row) in rows {
        match read_row(file, line, row, &slots, &mut targets) {
            Ok(()) => {}
            Err(fault) if !options.skip_invalid => return Err(fault),
            Err(_) => targets.iter_mut().for_each(|(_, values)| {
                values.truncate(lines.len());
                values.push(f64::NAN);
            }),
        }
        lines.push(line);
    }
    for (column, values) in targets {
        columns.set(column, values);
    }
    Ok((columns, lines))
}

fn read_row(
    file: &str,
    line: usize,
    row: &str,
    slots: &[Option<usize>],
    targets: &mut [(Column, Vec<f64>)],
) -> Result<(), IoError> {
    let mut found = 0;
    let mut push = |field: &str| {
        if let Some(&Some(slot)) = slots.get(found) {
            let (column, values) = &mut targets[slot];
            // most fields have no blanks to trim
            let value = field.parse().or_else(|_| field.trim().parse()).map_err(|_| IoError::NotANumber {
                file: file.into(),
                place: Place::Line(line),
                column: column.name(),
                text: field.trim().into(),
            })?;
            values.push(value);
        }
        found += 1;
        Ok(())
    };
    if row.contains('"') {
        fields(row).try_for_each(|field| push(&field))?;
    } else {
        row.split(',').try_for_each(&mut push)?;
    }
    if found == slots.len() {
        return Ok(());
    }
    Err(IoError::FieldCount { file: file.into(), line, found, expected: slots.len() })
}

/// Fields of one row, trimmed; commas between double quotes do not separate.
fn fields(row: &str) -> impl Iterator<Item = Cow<'_, str>> {
    let mut quoted = false;
    row.split(move |c| {
        quoted ^= c == '"';
        c == ',' && !quoted
    })
    .map(|field| {
        let field = field.trim();
        match field.strip_prefix('"').and_then(|f| f.strip_suffix('"')) {
            Some(inner) => Cow::Owned(inner.replace("\"\"", "\"")),
            None => Cow::Borrowed(field),
        }
    })
}

fn utf8<'a>(file: &str, bytes: &'a [u8]) -> Result<&'a str, IoError> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    std::str::from_utf8(bytes).map_err(|error| {
        let before = &bytes[..error.valid_up_to()];
        let line = 1 + before.iter().filter(|b| **b == b'\n').count();
        IoError::NotUtf8 { file: file.into(), line }
    })
}

/// Numbers where names should be, or another separator than commas.
fn check_header(file: &str, line: usize, header: &str, names: &[Cow<str>]) -> Result<(), IoError> {
    let numbers = names.iter().any(|name| name.parse::<f64>().is_ok_and(f64::is_finite));
    let other_separator = names.len() == 1 && header.contains([';', '\t', ' ']);
    if !numbers && !other_separator {
        return Ok(());
    }
    /// Enough of a line to recognise it by.
    const SHOWN: usize = 60;
    let text = header.chars().take(SHOWN).collect();
    Err(IoError::NoHeader { file: file.into(), line, text, example: EXAMPLE })
}

/// Writes contacts with the shortest decimal that reads back to the same number.
pub(super) fn write(contacts: &Contacts, remark: Option<&str>, out: &mut dyn Write) -> std::io::Result<()> {
    if let Some(remark) = remark {
        writeln!(out, "# {}", super::remark::one_line(remark))?;
    }
    let columns = columns_of(contacts);
    let names: Vec<&str> = columns.iter().map(|(column, _)| column.name()).collect();
    writeln!(out, "{}", names.join(","))?;
    for row in 0..contacts.len() {
        for (k, (_, values)) in columns.iter().enumerate() {
            let comma = if k == 0 { "" } else { "," };
            write!(out, "{comma}{}", values[row])?;
        }
        writeln!(out)?;
    }
    Ok(())
}
