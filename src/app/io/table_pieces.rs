//! A table of text that is more than memory holds: read once, a run of whole lines at a time.
//!
//! ```text
//! bytes -> whole lines of some megabytes -> contacts of these lines -> the next ones
//! ```
//!
//! Layout, names of fingers and numbers of lines go on from piece to piece: the pieces one behind the other are what [`csv`] reads of the
//! whole.

use std::cell::Cell;
use std::io::Read;
use std::rc::Rc;

use palpate_geometry::contact::Contacts;

use super::columns::Need;
use super::csv::{TableRows, utf8};
use super::place::Unit;
use super::read_progress::{ReadPhase, tell};
use super::table_form::table_form;
use super::unpack::{limit, limit_words};
use super::{Input, IoError, ReadOptions, Reading, ending};

/// Bytes that are read at a time.
const READ: usize = 1 << 16;
/// Lines are looked for in so many bytes at most, in pieces: a longer line is no row of numbers.
const MOST_PIECES_OF_LINE: usize = 4;

/// Bytes as they come from a file or a pipe, counted.
pub(super) struct CountedBytes<R> {
    source: R,
    count: Rc<Cell<usize>>,
}

impl<R: Read> Read for CountedBytes<R> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let read = self.source.read(buffer)?;
        self.count.set(self.count.get() + read);
        Ok(read)
    }
}

/// A table on its way.
pub(crate) struct TablePieces {
    file: String,
    source: Box<dyn Read>,
    /// Bytes that came, packed as they are, and how many there are in all.
    came: Rc<Cell<usize>>,
    total: Option<usize>,
    options: ReadOptions,
    /// Bytes of a piece.
    size: usize,
    /// Known from the first piece on.
    rows: Option<TableRows>,
    /// Bytes behind the last whole line.
    rest: Vec<u8>,
    /// Lines and bytes of the pieces so far.
    lines: usize,
    taken: usize,
    ended: bool,
}

impl TablePieces {
    /// Of a source of so many bytes, packed by gzip or not; pieces have about `size` bytes.
    pub(super) fn new(
        file: String,
        source: Box<dyn Read>,
        total: Option<usize>,
        options: ReadOptions,
        size: usize,
        is_packed: bool,
    ) -> TablePieces {
        let came = Rc::new(Cell::new(0));
        let counted = CountedBytes { source, count: Rc::clone(&came) };
        let source: Box<dyn Read> =
            if is_packed { Box::new(flate2::read::MultiGzDecoder::new(counted)) } else { Box::new(counted) };
        let (rest, rows) = (Vec::new(), None);
        TablePieces { file, source, came, total, options, size, rows, rest, lines: 0, taken: 0, ended: false }
    }

    /// Name of the file, for messages.
    pub(crate) fn file(&self) -> &str {
        &self.file
    }

    /// What was assumed or made of the table's content so far.
    pub(crate) fn notes(&self) -> Vec<String> {
        self.rows.as_ref().map_or(Vec::new(), TableRows::notes)
    }

    /// Whole lines of about a piece; none at the end.
    fn next_lines(&mut self) -> Result<Vec<u8>, IoError> {
        let read_error = |source: std::io::Error| IoError::Read { file: self.file.clone(), source };
        let mut wanted = self.size;
        loop {
            while self.rest.len() < wanted && !self.ended {
                let before = self.rest.len();
                self.source.by_ref().take(READ as u64).read_to_end(&mut self.rest).map_err(read_error)?;
                self.ended = self.rest.len() == before;
                tell(ReadPhase::Fetching, self.came.get(), self.total);
            }
            if self.ended {
                return Ok(std::mem::take(&mut self.rest));
            }
            if let Some(at) = self.rest.iter().rposition(|byte| *byte == b'\n') {
                let behind = self.rest.split_off(at + 1);
                return Ok(std::mem::replace(&mut self.rest, behind));
            }
            if self.rest.len() > MOST_PIECES_OF_LINE * self.size {
                return Err(self.wrong(format!("line {} is longer than any row of numbers", self.lines + 1)));
            }
            wanted += self.size;
        }
    }

    fn wrong(&self, what: String) -> IoError {
        IoError::Form { file: self.file.clone(), form: "table", what }
    }

    /// What unpacks to a hundredfold is no table of measured numbers.
    fn check_ratio(&self) -> Result<(), IoError> {
        let came = self.came.get() as u64;
        if self.taken as u64 <= limit(came) {
            return Ok(());
        }
        Err(self.wrong(format!("it unpacks to {}", limit_words(came))))
    }

    /// The contacts of some lines; rows that are left out are counted in it.
    fn piece_of(&mut self, bytes: &[u8]) -> Result<Reading, IoError> {
        let text = utf8(&self.file, bytes, self.lines + 1)?;
        let rows = match &mut self.rows {
            Some(rows) => rows,
            none => {
                let said = self.options.columns.as_ref();
                let form = table_form(&self.file, text, &ending(&self.file), Need::Contacts, said)?;
                none.insert(TableRows::new(&self.file, form, Need::Contacts))
            }
        };
        // the layout counts lines from the first of the file
        let (before, first) = (self.lines, rows.form.first_row);
        let below = text.split('\n').enumerate().map(|(k, line)| (before + k, line)).filter(|(k, _)| *k >= first);
        let (columns, numbers) = rows.read(below.map(|(k, line)| (k + 1, line)), &self.options, |_| ())?;
        self.lines += bytes.iter().filter(|byte| **byte == b'\n').count();
        match columns.into_reading(&self.file, (numbers, Unit::Line), &self.options) {
            Err(IoError::NoRows { skipped, .. }) => Ok(empty(&self.file, skipped)),
            found => found,
        }
    }
}

/// A piece without contacts.
fn empty(file: &str, skipped: usize) -> Reading {
    Reading {
        input: Input::Contacts(Contacts::default()),
        file: file.into(),
        skipped,
        ignored: Vec::new(),
        places: None,
        notes: Vec::new(),
        viewpoint: None,
        unit: None,
    }
}

impl Iterator for TablePieces {
    type Item = Result<Reading, IoError>;

    fn next(&mut self) -> Option<Result<Reading, IoError>> {
        let bytes = match self.next_lines() {
            Ok(bytes) if bytes.is_empty() => return None,
            Ok(bytes) => bytes,
            Err(error) => return Some(Err(error)),
        };
        self.taken += bytes.len();
        Some(self.check_ratio().and_then(|()| self.piece_of(&bytes)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::read_input_bytes;

    /// Rows with names of fingers, remarks, holes and lines of many lengths.
    fn text() -> String {
        let mut text = String::from("\u{feff}# a scan\nx;y;z;finger\nmm;mm;mm;\n");
        for k in 0..5000 {
            match k % 97 {
                13 => text.push_str("# a remark\n\n"),
                14 => text.push_str("1;2;;thumb\n"),
                _ => text.push_str(&format!("{};{:.3};{};f{}\r\n", k, 0.1 * f64::from(k), k * k, k / 500)),
            }
        }
        text
    }

    fn pieces_of(bytes: &[u8], size: usize, is_packed: bool) -> (Contacts, usize, Vec<String>, Vec<crate::io::Place>) {
        let options = ReadOptions { skip_invalid: true, ..ReadOptions::default() };
        let source = Box::new(std::io::Cursor::new(bytes.to_vec()));
        let mut pieces = TablePieces::new("f.csv".into(), source, None, options, size, is_packed);
        let (mut all, mut skipped, mut places) = (Contacts::default(), 0, Vec::new());
        let mut fingers = Vec::new();
        for piece in pieces.by_ref() {
            let piece = piece.unwrap();
            let Input::Contacts(here) = piece.input else { panic!("contacts") };
            places.extend((0..here.len()).map(|k| piece.places.as_ref().unwrap().of(k)));
            [(&mut all.x, here.x), (&mut all.y, here.y), (&mut all.z, here.z)]
                .into_iter()
                .for_each(|(all, more)| all.extend(more));
            fingers.extend(here.finger.unwrap_or_default());
            skipped += piece.skipped;
        }
        all.finger = Some(fingers);
        (all, skipped, pieces.notes(), places)
    }

    #[test]
    fn pieces_are_the_whole_whatever_their_size() {
        let text = text();
        let options = ReadOptions { skip_invalid: true, ..ReadOptions::default() };
        let whole = read_input_bytes("f.csv", text.as_bytes(), &options).unwrap();
        let Input::Contacts(contacts) = whole.input else { panic!("contacts") };
        let places: Vec<_> = (0..contacts.len()).map(|k| whole.places.as_ref().unwrap().of(k)).collect();
        let packed = {
            let mut out = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
            std::io::Write::write_all(&mut out, text.as_bytes()).unwrap();
            out.finish().unwrap()
        };
        let expected = (contacts, whole.skipped, whole.notes, places);
        for size in [100, 4096, 1 << 20] {
            assert_eq!(pieces_of(text.as_bytes(), size, false), expected, "{size}");
            assert_eq!(pieces_of(&packed, size, true), expected, "{size} packed");
        }
        assert!(expected.1 > 40 && !expected.2.is_empty());
    }

    #[test]
    fn faults_name_their_line_in_the_whole() {
        let mut text = String::from("x,y,z\n");
        (0..3000).for_each(|k| text.push_str(&format!("{k},{},0\n", k * 7 % 11)));
        text.push_str("1,2,three\n");
        let source = Box::new(std::io::Cursor::new(text.into_bytes()));
        let pieces = TablePieces::new("f.csv".into(), source, None, ReadOptions::default(), 1000, false);
        let fault = pieces.filter_map(Result::err).next().unwrap();
        assert!(matches!(fault, IoError::NotANumber { place: crate::io::Place::Line(3002), .. }), "{fault}");
    }

    #[test]
    fn a_line_without_end_is_refused() {
        let source = Box::new(std::io::repeat(b'1'));
        let mut pieces = TablePieces::new("f.csv".into(), source, None, ReadOptions::default(), 1 << 12, false);
        assert!(matches!(pieces.next(), Some(Err(IoError::Form { .. }))));
    }
}
