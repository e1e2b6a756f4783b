//! Tables of text: a header naming columns in any order, one row per contact, `#` and `//` comments, blank lines ignored.
//! [`table_form`] finds out what separates the fields and where the names stand.

use std::io::Write;

use palpate_geometry::contact::Contacts;

use super::columns::{Column, Columns, Need, columns_of};
use super::escape_control_chars::visible;
use super::finger_names::FingerNames;
use super::place::{Place, Runs, Unit};
use super::read_progress::tell_line;
use super::separator::Separator;
use super::table_form::{TableForm, is_aside, table_form};
use super::{IoError, ReadOptions, Reading, ending};

/// The columns of a table with where they come from.
pub(super) struct Table {
    pub(super) columns: Columns,
    /// Line of each row.
    pub(super) lines: Runs,
    /// What was assumed because nothing said it.
    notes: Vec<String>,
}

/// Contacts from the bytes of a CSV file.
pub(super) fn read(file: &str, bytes: &[u8], options: &ReadOptions) -> Result<Reading, IoError> {
    let table = read_columns(file, bytes, Need::Contacts, options)?;
    let reading = table.columns.into_reading(file, (table.lines, Unit::Line), options)?;
    Ok(Reading { notes: table.notes, ..reading })
}

/// The known columns of a table and the line of each row. Fields that are no number become NaN under `skip_invalid`.
pub(super) fn read_columns(file: &str, bytes: &[u8], need: Need, options: &ReadOptions) -> Result<Table, IoError> {
    let text = utf8(file, bytes, 1)?;
    let form = table_form(file, text, &ending(file), need, options.columns.as_ref())?;
    let mut rows = TableRows::new(file, form, need);
    let first = rows.form.first_row;
    let below = text.split('\n').enumerate().skip(first).map(|(index, line)| (index + 1, line));
    let (columns, lines) = rows.read(below, options, |row| tell_line(text, row))?;
    Ok(Table { columns, lines, notes: rows.notes() })
}

/// Rows of a table whose layout is known, a run of lines at a time.
pub(super) struct TableRows {
    file: String,
    pub(super) form: TableForm,
    need: Need,
    /// Names of fingers go on from run to run.
    fingers: Option<FingerNames>,
}

impl TableRows {
    pub(super) fn new(file: &str, form: TableForm, need: Need) -> TableRows {
        TableRows { file: file.into(), form, need, fingers: None }
    }

    /// What was assumed because nothing said it, and what became of fingers' names.
    pub(super) fn notes(&self) -> Vec<String> {
        self.form.note.iter().cloned().chain(self.fingers.as_ref().and_then(FingerNames::note)).collect()
    }

    /// Columns of these lines, each with its number, and the numbers of those that are rows; `told` hears of each.
    pub(super) fn read<'t>(
        &mut self,
        below: impl Iterator<Item = (usize, &'t str)>,
        options: &ReadOptions,
        told: impl Fn(&str),
    ) -> Result<(Columns, Runs), IoError> {
        let TableRows { file, form, need, fingers } = self;
        let names: Vec<&str> = form.names.iter().map(String::as_str).collect();
        let titles: Vec<&str> = form.titles.iter().map(String::as_str).collect();
        let mut columns = Columns::titled(file, &names, &titles, *need)?;
        columns.unit.clone_from(&form.unit);
        let (slots, mut targets) = slots_and_targets(&names, &columns);
        let mut lines = Runs::default();
        let (titles, separator, before) = (&titles[..], form.separator, fingers.take());
        let mut reader = RowReader { file, separator, slots: &slots, titles, fingers: before };
        for (line, row) in below.map(|(line, text)| (line, text.trim())).filter(|(_, row)| !is_aside(row)) {
            told(row);
            match reader.read_row(line, row, &mut targets) {
                Ok(()) => {}
                Err(fault) if !options.skip_invalid => return Err(fault),
                Err(_) => targets.iter_mut().for_each(|(_, values)| {
                    values.truncate(lines.len());
                    values.push(f64::NAN);
                }),
            }
            lines.push(line);
        }
        *fingers = reader.fingers;
        for (column, values) in targets {
            columns.set(column, values);
        }
        Ok((columns, lines))
    }
}

/// Columns that fields of a row go to.
type FieldTargets = Vec<(Column, Vec<f64>)>;

/// Per field of a row which of the targets it goes to, and the targets, empty.
fn slots_and_targets(names: &[&str], columns: &Columns) -> (Vec<Option<usize>>, FieldTargets) {
    let mut targets: FieldTargets = Vec::new();
    let slots = names.iter().map(|name| {
        let column = Column::of(name).filter(|c| columns.has(*c))?;
        targets.push((column, Vec::new()));
        Some(targets.len() - 1)
    });
    let slots = slots.collect();
    (slots, targets)
}

/// Reads the fields of one row after another.
pub(super) struct RowReader<'a> {
    pub(super) file: &'a str,
    pub(super) separator: Separator,
    /// Per field of a row: which target it goes to.
    pub(super) slots: &'a [Option<usize>],
    /// What the file calls the fields.
    pub(super) titles: &'a [&'a str],
    /// Set by the first row that has a finger.
    pub(super) fingers: Option<FingerNames>,
}

impl RowReader<'_> {
    pub(super) fn read_row(
        &mut self,
        line: usize,
        row: &str,
        targets: &mut [(Column, Vec<f64>)],
    ) -> Result<(), IoError> {
        let (file, separator, slots) = (self.file, self.separator, self.slots);
        let titles = self.titles;
        let wrong = |column: Column, field: usize, text: &str| IoError::NotANumber {
            file: file.into(),
            place: Place::Line(line),
            column: visible(titles.get(field).copied().unwrap_or(column.name())),
            ours: column.name(),
            text: text.trim().into(),
        };
        // cells of the normal that are empty
        let mut empty: Vec<(Column, usize)> = Vec::new();
        let mut found = 0;
        let mut push = |field: &str| {
            if let Some(&Some(slot)) = slots.get(found) {
                let (column, values) = &mut targets[slot];
                if matches!(column, Column::Nx | Column::Ny | Column::Nz) && field.trim().is_empty() {
                    empty.push((*column, found));
                    values.push(f64::NAN);
                } else {
                    values.push(self.value(*column, field).ok_or_else(|| wrong(*column, found, field))?);
                }
            }
            found += 1;
            Ok(())
        };
        match separator.character() {
            _ if row.contains('"') => separator.fields(row).iter().try_for_each(|field| push(field))?,
            Some(character) => row.split(character).try_for_each(&mut push)?,
            None => row.split_whitespace().try_for_each(&mut push)?,
        }
        let expected = slots.len();
        match empty[..] {
            // part of a normal is no normal
            [(first, field)] | [(first, field), _] => Err(wrong(first, field, "")),
            _ if found != expected => Err(IoError::FieldCount { file: file.into(), line, found, expected }),
            _ => Ok(()),
        }
    }

    fn value(&mut self, column: Column, field: &str) -> Option<f64> {
        let number = self.separator.number(field);
        match column {
            Column::Finger => {
                let fingers = self.fingers.get_or_insert_with(|| FingerNames::begun_by(number));
                fingers.number_of(field.trim(), number)
            }
            _ => number,
        }
    }
}

/// Text whose first line has this number in the file.
pub(super) fn utf8<'a>(file: &str, bytes: &'a [u8], first_line: usize) -> Result<&'a str, IoError> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    std::str::from_utf8(bytes).map_err(|error| {
        let before = &bytes[..error.valid_up_to()];
        let line = first_line + before.iter().filter(|b| **b == b'\n').count();
        IoError::NotUtf8 { file: file.into(), line }
    })
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
