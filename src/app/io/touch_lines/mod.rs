//! Touches line by line, as a robot writes them while it touches: rows of a table, or JSON lines.
//!
//! ```text
//! x,y,z,nx,ny,nz        names        by the rules of every other table: names, units, separators
//! 1,2,3,0,0,1           a touch
//! {"x":1,"y":2,"z":3}   a touch, too: the keys are its names
//! x,y,z                 names again: the sensor was started anew
//! 1,2                   a fault, with its line; the next line is read as if it had not been there
//! ```
//!
//! A line is judged when it comes, and nothing of it is kept but its touch.

mod json;

use palpate_geometry::contact::Contacts;

use super::columns::{Column, Columns, Need};
use super::csv::RowReader;
use super::finger_names::FingerNames;
use super::place::{Runs, Unit};
use super::separator::{Separator, declared_separator};
use super::table_form::{TableForm, is_aside, is_count, names_in_line, table_form, units_in_row};
use super::{ColumnNames, Input, IoError, ReadOptions};

/// What a line came to.
#[derive(Debug)]
pub(crate) enum LineHeard {
    /// Nothing that counts: empty, a comment, a row of units.
    Nothing,
    /// The names of the columns, and what was assumed of them.
    Names {
        /// Other names stood before them.
        again: bool,
        /// What was assumed because nothing said it.
        note: Option<String>,
    },
    /// One touch.
    Touch {
        /// One contact.
        contact: Box<Contacts>,
        /// When it was made, where a column says so.
        time: Option<f64>,
        /// What was assumed because no line said it.
        note: Option<String>,
    },
}

/// The names of a table that is being read.
#[derive(Debug)]
struct StreamForm {
    form: TableForm,
    /// Per field of a row: which target it goes to.
    slots: Vec<Option<usize>>,
    targets: Vec<Column>,
    /// Field that holds the time.
    time: Option<usize>,
    /// A row of units or a count may follow.
    fresh: bool,
}

/// Reads touches from lines.
#[derive(Debug)]
pub(crate) struct TouchLines {
    file: String,
    said: Option<ColumnNames>,
    line: usize,
    form: Option<StreamForm>,
    /// Comments before the names, which may name them; the last few.
    asides: Vec<String>,
    fingers: Option<FingerNames>,
    /// What separates the fields, where a line said it (`sep=;`).
    declared: Option<Separator>,
    /// The names are those of an earlier stream: names that come first are no new start.
    inherited: bool,
}

/// Comments that are kept until names are found.
const KEPT_ASIDES: usize = 9;

impl TouchLines {
    /// Of a file or standard input by its name.
    pub(crate) fn new(file: &str, said: Option<ColumnNames>) -> TouchLines {
        TouchLines {
            file: file.into(),
            said,
            line: 0,
            form: None,
            asides: Vec::new(),
            fingers: None,
            declared: None,
            inherited: false,
        }
    }

    /// Goes on by the names of an earlier stream, as [`TouchLines::header`] had them, unless the lines bring their own.
    pub(crate) fn inherit(&mut self, header: &str) {
        // names that are of no use any longer are as none
        let _ = self.names(header.trim());
        if let Some(known) = &mut self.form {
            (known.fresh, self.inherited) = (false, true);
        }
    }

    /// The name for messages.
    pub(crate) fn file(&self) -> &str {
        &self.file
    }

    /// Number of the last line, counted from 1.
    pub(crate) fn line(&self) -> usize {
        self.line
    }

    /// The names of the columns as a line, to go on by when more lines come without them.
    pub(crate) fn header(&self) -> Option<String> {
        let separator = |form: &TableForm| form.separator.character().unwrap_or(' ').to_string();
        self.form.as_ref().map(|known| known.form.titles.join(&separator(&known.form)))
    }

    /// The next line, without its end.
    ///
    /// # Errors
    /// Why it is no touch. The line counts, and the next one is read as if this one had not been there.
    pub(crate) fn hear(&mut self, bytes: &[u8]) -> Result<LineHeard, IoError> {
        self.line += 1;
        let bytes = if self.line == 1 { bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes) } else { bytes };
        let not_text = |_| IoError::NotUtf8 { file: self.file.clone(), line: self.line };
        let line = std::str::from_utf8(bytes).map_err(not_text)?.trim();
        if is_aside(line) {
            self.remember(line);
            return Ok(LineHeard::Nothing);
        }
        if line.starts_with('{') {
            return self.json_touch(line);
        }
        if let Some(separator) = declared_separator(line) {
            self.declared = Some(separator);
            return Ok(LineHeard::Nothing);
        }
        if self.is_below_names(line) {
            return Ok(LineHeard::Nothing);
        }
        if let Some(heard) = self.names(line)? {
            return Ok(heard);
        }
        match self.form {
            Some(_) => {
                self.inherited = false;
                self.row(line, None)
            }
            None => self.first_row(line),
        }
    }

    fn remember(&mut self, line: &str) {
        if self.form.is_none() && !line.is_empty() {
            self.asides.push(line.into());
            let surplus = self.asides.len().saturating_sub(KEPT_ASIDES);
            self.asides.drain(..surplus);
        }
    }

    /// A row of units or a count of rows, which may stand below the names.
    fn is_below_names(&mut self, line: &str) -> bool {
        let Some(known) = self.form.as_mut().filter(|known| known.fresh && known.form.names.len() > 1) else {
            return is_count(line) && self.form.is_none();
        };
        let is_below = is_count(line) || units_in_row(&known.form, line).is_some();
        known.fresh = is_below;
        is_below
    }

    /// Names of columns, where this line holds some.
    fn names(&mut self, line: &str) -> Result<Option<LineHeard>, IoError> {
        let number = |field: &str| field.parse::<f64>().is_ok_and(f64::is_finite);
        if line.split([',', ';', '\t', ' ']).any(number) {
            return Ok(None);
        }
        let declared = self.declared.as_slice();
        let Some(form) = names_in_line(&self.file, line, declared, self.said.as_ref())? else { return Ok(None) };
        let known = form.names.iter().filter(|name| Column::of(name).is_some()).count();
        // words in a row that goes on are a fault of that row
        if self.form.is_some() && known < 2 {
            return Ok(None);
        }
        let again = self.form.is_some() && !std::mem::take(&mut self.inherited);
        let note = form.note.clone();
        self.form = Some(StreamForm::of(&self.file, form)?);
        self.asides.clear();
        Ok(Some(LineHeard::Names { again, note }))
    }

    /// A row before which no names stood: a comment may hold them, or the count of columns tells.
    fn first_row(&mut self, line: &str) -> Result<LineHeard, IoError> {
        let text: String = self.asides.iter().map(String::as_str).chain([line]).collect::<Vec<_>>().join("\n");
        // the ending of a file whose columns may have no names
        let form = table_form(&self.file, &text, "xyz", Need::Contacts, self.said.as_ref());
        let form = form.map_err(|error| match error {
            IoError::NoHeader { file, text, example, .. } => IoError::NoHeader { file, line: self.line, text, example },
            other => other,
        })?;
        let note = form.note.clone();
        self.form = Some(StreamForm::of(&self.file, form)?);
        self.asides.clear();
        self.row(line, note)
    }

    fn row(&mut self, line: &str, note: Option<String>) -> Result<LineHeard, IoError> {
        let Some(known) = &self.form else { return Ok(LineHeard::Nothing) };
        let titles: Vec<&str> = known.form.titles.iter().map(String::as_str).collect();
        let separator = known.form.separator;
        let mut targets: Vec<(Column, Vec<f64>)> = known.targets.iter().map(|column| (*column, Vec::new())).collect();
        let fingers = self.fingers.take();
        let (file, slots) = (self.file.as_str(), known.slots.as_slice());
        let mut reader = RowReader { file, separator, slots, titles: &titles, fingers };
        let outcome = reader.read_row(self.line, line, &mut targets);
        let fingers = reader.fingers;
        let time = known.time.and_then(|at| time_in(separator, line, at));
        self.fingers = fingers;
        outcome?;
        let contact = self.contact(targets)?;
        Ok(LineHeard::Touch { contact: Box::new(contact), time, note })
    }

    fn json_touch(&mut self, line: &str) -> Result<LineHeard, IoError> {
        let fields = json::fields(line).map_err(|what| IoError::Form {
            file: format!("{}, line {}", self.file, self.line),
            form: "JSON line",
            what,
        })?;
        let titles: Vec<&str> = fields.iter().map(|(title, _)| title.as_str()).collect();
        let names = super::names::in_our_words(&self.file, &titles, self.said.as_ref())?;
        let mut targets: Vec<(Column, Vec<f64>)> = Vec::new();
        for (name, (title, value)) in names.iter().zip(&fields) {
            let Some(column) = Column::of(name) else { continue };
            let number = match (column, value.text.as_deref()) {
                (Column::Finger, text) => {
                    let fingers = self.fingers.get_or_insert_with(|| FingerNames::begun_by(value.number));
                    fingers.number_of(text.unwrap_or_default(), value.number)
                }
                _ => value.number,
            };
            let wrong = || IoError::NotANumber {
                file: self.file.clone(),
                place: Unit::Line.place(self.line),
                column: super::visible(title),
                ours: column.name(),
                text: value.text.clone().unwrap_or_default(),
            };
            targets.push((column, vec![number.ok_or_else(wrong)?]));
        }
        let names: Vec<&str> = targets.iter().map(|(column, _)| column.name()).collect();
        // refuses what is missing or doubled, in the words of every other reader
        Columns::titled(&self.file, &names, &names, Need::Contacts)?;
        let time = fields.iter().find(|(title, _)| is_time(title)).and_then(|(_, value)| value.number);
        let contact = self.contact(targets)?;
        Ok(LineHeard::Touch { contact: Box::new(contact), time, note: None })
    }

    /// One contact by the rules of every other reader; a normal that is not known is zero.
    fn contact(&self, targets: Vec<(Column, Vec<f64>)>) -> Result<Contacts, IoError> {
        let mut columns = Columns::default();
        targets.into_iter().for_each(|(column, values)| columns.set(column, values));
        let options = ReadOptions { keep_zero_normals: true, ..ReadOptions::default() };
        let place = (std::iter::once(self.line).collect::<Runs>(), Unit::Line);
        match columns.into_reading(&self.file, place, &options)?.input {
            Input::Contacts(contact) => Ok(contact),
            Input::Grid(_) => Err(IoError::NoRows { file: self.file.clone(), skipped: 0 }),
        }
    }
}

impl StreamForm {
    fn of(file: &str, form: TableForm) -> Result<StreamForm, IoError> {
        let names: Vec<&str> = form.names.iter().map(String::as_str).collect();
        let titles: Vec<&str> = form.titles.iter().map(String::as_str).collect();
        Columns::titled(file, &names, &titles, Need::Contacts)?;
        let mut targets = Vec::new();
        let slots = names.iter().map(|name| {
            let column = Column::of(name)?;
            targets.push(column);
            Some(targets.len() - 1)
        });
        let slots = slots.collect();
        let time = form.titles.iter().position(|title| is_time(title));
        Ok(StreamForm { slots, targets, time, fresh: true, form })
    }
}

/// Names of a column that says when a touch was made, as letters without their unit.
const TIMES: [&str; 7] = ["t", "time", "timestamp", "stamp", "seconds", "sec", "ts"];

/// Whether a column says when a touch was made: `time`, `t [s]`, `stamp_ns`.
fn is_time(title: &str) -> bool {
    let words = title.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
    let words: Vec<String> = words.map(str::to_ascii_lowercase).collect();
    let unit = words.last().is_some_and(|word| words.len() > 1 && ["s", "ms", "us", "ns"].contains(&word.as_str()));
    let name = words.len() - usize::from(unit);
    words[..name].last().is_some_and(|word| TIMES.contains(&word.as_str()))
}

fn time_in(separator: Separator, line: &str, at: usize) -> Option<f64> {
    let fields = separator.fields(line);
    separator.number(fields.get(at)?.trim()).filter(|time| time.is_finite())
}

#[cfg(test)]
mod tests {
    use palpate_geometry::contact::Orientation;

    use super::*;

    fn heard(lines: &[&str]) -> Vec<Result<LineHeard, IoError>> {
        let mut reader = TouchLines::new("f", None);
        lines.iter().map(|line| reader.hear(line.as_bytes())).collect()
    }

    fn places(lines: &[&str]) -> Vec<[f64; 3]> {
        let touch = |heard| match heard {
            Ok(LineHeard::Touch { contact, .. }) => Some([contact.x[0], contact.y[0], contact.z[0]]),
            _ => None,
        };
        heard(lines).into_iter().filter_map(touch).collect()
    }

    #[test]
    fn rows_and_json_lines_are_the_same_touches() {
        let expected = [[1.0, 2.0, 3.5], [4.0, 5.0, 6.0]];
        for lines in [
            &["x,y,z", "1,2,3.5", "4,5,6"][..],
            &["sep=;", "z;y;x", "3,5;2;1", "6;5;4"][..],
            &["# x y z", "1 2 3.5", "4 5 6"][..],
            &["1 2 3.5", "4 5 6"][..],
            &["x [mm],y [mm],z [mm],t", "mm,mm,mm,s", "2", "1,2,3.5,0", "4,5,6,1"][..],
            &[r#"{"x":1,"y":2,"z":3.5}"#, r#"{"pose":{"position":{"x":4,"y":5,"z":6}}}"#][..],
            &[r#"{"position":[1,2,3.5],"normal":[0,0,1]}"#, r#"{"p":null,"x":4,"y":5,"z":6}"#][..],
        ] {
            assert_eq!(places(lines), expected, "{lines:?}");
        }
    }

    #[test]
    fn a_fault_is_said_with_its_line_and_the_next_line_is_read() {
        let lines = ["x,y,z", "1,2", "1,2,word", "1,2,inf", "{\"x\":1}", "{\"x\":", "7,8,9"];
        let found = heard(&lines);
        for (k, heard) in found.iter().enumerate().take(6).skip(1) {
            let message = heard.as_ref().unwrap_err().to_string();
            assert!(message.starts_with('f') && (k == 4 || message.contains(&format!("line {}", k + 1))), "{message}");
        }
        assert_eq!(places(&lines), [[7.0, 8.0, 9.0]]);
        let mut reader = TouchLines::new("f", None);
        assert!(reader.hear(b"\xff\xfe").unwrap_err().to_string().contains("line 1"));
    }

    #[test]
    fn names_again_are_a_sensor_that_was_started_anew() {
        let found = heard(&["x,y,z,nx,ny,nz,time", "1,2,3,0,0,1,5.5", "time,x,y,z", "0.5,4,5,6"]);
        assert!(matches!(found[0], Ok(LineHeard::Names { again: false, .. })));
        let Ok(LineHeard::Touch { contact, time: Some(5.5), .. }) = &found[1] else { panic!("{found:?}") };
        assert!(matches!(contact.orientation, Orientation::Normals { .. }));
        assert!(matches!(found[2], Ok(LineHeard::Names { again: true, .. })));
        let Ok(LineHeard::Touch { contact, time: Some(0.5), .. }) = &found[3] else { panic!("{found:?}") };
        assert_eq!(contact.orientation, Orientation::None);
    }

    #[test]
    fn columns_of_time_are_known() {
        for title in ["time", "T", "t [s]", "stamp_ns", "header.stamp", "Time (ms)"] {
            assert!(is_time(title), "{title}");
        }
        for title in ["x", "temperature", "nt", "s", "force_ms"] {
            assert!(!is_time(title), "{title}");
        }
    }
}
