//! Every replicate on a line of its own, written while the study runs: CSV or Parquet by the file's ending.
//!
//! ```text
//! CSV       replicate,S,R,...      NaN where a quantity is undefined
//! Parquet   one INT64 and one DOUBLE column a quantity, plain, uncompressed, 65,536 rows a group
//! ```
//!
//! What is written stays readable whatever happens next: CSV is cut at a whole line, and a Parquet file that meets a full
//! disk gives its last group for its footer. The few hundred lines of Parquet that plain columns need are written here
//! (`apache/parquet-format`, Thrift compact protocol): the reference crate takes longer to build than all of this one.

use std::fmt::Write as _;
use std::fs::{File, OpenOptions};
use std::io::{Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use palpate_studies::montecarlo::Values;

use super::IoError;

mod parquet;

use parquet::RowGroups;

/// Lines written at once: what a full disk can cost at most.
const LINES: usize = 1 << 12;
/// Rows of a Parquet group.
const GROUP: usize = 1 << 16;

/// Which kind of file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum RecordFormat {
    /// Text.
    Csv,
    /// Columns.
    Parquet,
}

impl RecordFormat {
    /// By the ending.
    ///
    /// # Errors
    /// Another ending, in words.
    pub(crate) fn of(path: &Path) -> Result<RecordFormat, String> {
        match path.extension().and_then(|e| e.to_str()) {
            Some("csv") => Ok(RecordFormat::Csv),
            Some("parquet") => Ok(RecordFormat::Parquet),
            _ => Err(format!("{}: records are written as .csv or .parquet", path.display())),
        }
    }
}

/// An open file of records.
#[derive(Debug)]
pub(crate) struct Records {
    path: PathBuf,
    file: File,
    /// Bytes that hold whole rows.
    sound: u64,
    /// Replicates in them.
    rows: u64,
    kind: Kind,
}

#[derive(Debug)]
enum Kind {
    Csv,
    Parquet(Box<Waiting>),
}

#[derive(Debug)]
struct Waiting {
    groups: RowGroups,
    replicates: Vec<i64>,
    columns: Vec<Vec<f64>>,
}

impl Records {
    /// A new file with columns `names` behind `replicate`.
    ///
    /// # Errors
    /// What the system says, with the path.
    pub(crate) fn create(path: &Path, names: &[String]) -> Result<Records, IoError> {
        let wrong = |source| IoError::Write { path: path.to_path_buf(), source };
        let format = RecordFormat::of(path).map_err(|why| wrong(std::io::Error::other(why)))?;
        let mut file = File::create(path).map_err(wrong)?;
        let (head, kind) = match format {
            RecordFormat::Csv => {
                // a name with a comma in it is quoted
                let name = |n: &String| if n.contains(',') { format!("\"{n}\"") } else { n.clone() };
                let names = names.iter().map(name).collect::<Vec<_>>().join(",");
                (format!("replicate,{names}\n").into_bytes(), Kind::Csv)
            }
            RecordFormat::Parquet => {
                let columns = vec![Vec::new(); names.len()];
                let waiting = Waiting { groups: RowGroups::new(names), replicates: Vec::new(), columns };
                (parquet::MAGIC.to_vec(), Kind::Parquet(Box::new(waiting)))
            }
        };
        file.write_all(&head).map_err(wrong)?;
        Ok(Records { path: path.to_path_buf(), file, sound: head.len() as u64, rows: 0, kind })
    }

    /// Goes on with a CSV of which `sound` bytes count.
    ///
    /// # Errors
    /// The file is gone or shorter than that; Parquet, which cannot be gone on with.
    pub(crate) fn resume(path: &Path, sound: u64) -> Result<Records, IoError> {
        let wrong = |source| IoError::Write { path: path.to_path_buf(), source };
        if RecordFormat::of(path) != Ok(RecordFormat::Csv) {
            return Err(wrong(std::io::Error::other("only records in CSV can be gone on with")));
        }
        let mut file = OpenOptions::new().read(true).write(true).open(path).map_err(wrong)?;
        if file.metadata().map_err(wrong)?.len() < sound {
            return Err(wrong(std::io::Error::other("it is shorter than its checkpoint says")));
        }
        file.set_len(sound).and_then(|()| file.seek(SeekFrom::End(0))).map_err(wrong)?;
        Ok(Records { path: path.to_path_buf(), file, sound, rows: 0, kind: Kind::Csv })
    }

    /// Bytes of whole rows so far.
    pub(crate) fn sound(&self) -> u64 {
        self.sound
    }

    /// Adds replicates.
    ///
    /// # Errors
    /// What the system says; the rows before stay readable.
    pub(crate) fn append(&mut self, values: &Values) -> Result<(), IoError> {
        let count = values.columns.first().map_or(0, Vec::len);
        match &mut self.kind {
            Kind::Csv => self.put_lines(values, count),
            Kind::Parquet(waiting) => {
                waiting.replicates.extend((0..count as i64).map(|k| values.first as i64 + k));
                waiting.columns.iter_mut().zip(&values.columns).for_each(|(own, more)| own.extend_from_slice(more));
                while self.waiting_rows() >= GROUP {
                    self.put_group(GROUP)?;
                }
                Ok(())
            }
        }
    }

    fn put_lines(&mut self, values: &Values, count: usize) -> Result<(), IoError> {
        let mut text = String::new();
        for from in (0..count).step_by(LINES) {
            text.clear();
            let to = (from + LINES).min(count);
            for k in from..to {
                // writing to a string cannot fail
                let _ = write!(text, "{}", values.first + k as u64);
                values.columns.iter().for_each(|column| {
                    let _ = write!(text, ",{}", column[k]);
                });
                text.push('\n');
            }
            self.put(text.as_bytes(), (to - from) as u64)?;
        }
        Ok(())
    }

    fn waiting_rows(&self) -> usize {
        match &self.kind {
            Kind::Parquet(waiting) => waiting.replicates.len(),
            Kind::Csv => 0,
        }
    }

    fn put_group(&mut self, rows: usize) -> Result<(), IoError> {
        let Kind::Parquet(waiting) = &mut self.kind else { return Ok(()) };
        let replicates: Vec<i64> = waiting.replicates.drain(..rows).collect();
        let columns: Vec<Vec<f64>> = waiting.columns.iter_mut().map(|column| column.drain(..rows).collect()).collect();
        let (bytes, group) = waiting.groups.encode(self.sound, &replicates, &columns);
        self.put(&bytes, rows as u64)?;
        if let Kind::Parquet(waiting) = &mut self.kind {
            waiting.groups.push(group);
        }
        Ok(())
    }

    /// Writes whole rows, or cuts the file where they began.
    fn put(&mut self, bytes: &[u8], rows: u64) -> Result<(), IoError> {
        match self.file.write_all(bytes) {
            Ok(()) => {
                self.sound += bytes.len() as u64;
                self.rows += rows;
                Ok(())
            }
            Err(source) => {
                // what cannot be cut off is at least not counted
                let _ = self.file.set_len(self.sound);
                let _ = self.file.seek(SeekFrom::End(0));
                let source = std::io::Error::new(
                    source.kind(),
                    format!("{source}; the {} replicates before stand in it whole", self.rows),
                );
                if let Kind::Parquet(_) = &self.kind {
                    self.close_in_need();
                }
                Err(IoError::Write { path: self.path.clone(), source })
            }
        }
    }

    /// The footer in the room that the last groups leave.
    fn close_in_need(&mut self) {
        let Kind::Parquet(waiting) = &mut self.kind else { return };
        loop {
            let footer = waiting.groups.footer();
            if self.file.write_all(&footer).is_ok() {
                return;
            }
            let Some(start) = waiting.groups.pop() else { return };
            let _ = self.file.set_len(start);
            let _ = self.file.seek(SeekFrom::End(0));
        }
    }

    /// Ends the file.
    ///
    /// # Errors
    /// What the system says.
    pub(crate) fn finish(mut self) -> Result<(), IoError> {
        let rows = self.waiting_rows();
        if rows > 0 {
            self.put_group(rows)?;
        }
        if let Kind::Parquet(waiting) = &self.kind {
            let footer = waiting.groups.footer();
            self.put(&footer, 0)?;
        }
        self.file.flush().map_err(|source| IoError::Write { path: self.path.clone(), source })
    }
}

/// A whole table in Parquet: the column `number` counts the rows from 0, the others are `columns`, all of one length.
///
/// # Errors
/// What the system says.
pub(crate) fn write_parquet(
    number: &str,
    names: &[String],
    columns: &[Vec<f64>],
    out: &mut dyn Write,
) -> std::io::Result<()> {
    let rows = columns.first().map_or(0, Vec::len);
    let mut groups = RowGroups::numbered(number, names);
    let (bytes, group) = groups.encode(parquet::MAGIC.len() as u64, &(0..rows as i64).collect::<Vec<i64>>(), columns);
    groups.push(group);
    out.write_all(parquet::MAGIC)?;
    out.write_all(&bytes)?;
    out.write_all(&groups.footer())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(first: u64, count: usize) -> Values {
        let column = |scale: f64| (0..count).map(|k| scale * (first as f64 + k as f64)).collect();
        Values { first, columns: vec![column(0.5), column(-1e-3)], ..Values::default() }
    }

    #[test]
    fn a_cut_file_goes_on_to_the_same_bytes() {
        let folder = tempfile::tempdir().unwrap();
        let names = ["S".to_string(), "R".to_string()];
        let whole = folder.path().join("whole.csv");
        let mut records = Records::create(&whole, &names).unwrap();
        records.append(&values(0, 50)).unwrap();
        let sound = records.sound();
        records.append(&values(50, 50)).unwrap();
        records.finish().unwrap();
        let cut = folder.path().join("cut.csv");
        let text = std::fs::read(&whole).unwrap();
        std::fs::write(&cut, &text[..sound as usize + 33]).unwrap();
        let mut records = Records::resume(&cut, sound).unwrap();
        records.append(&values(50, 50)).unwrap();
        records.finish().unwrap();
        assert_eq!(std::fs::read(&cut).unwrap(), text);
        assert!(Records::resume(&cut, 1 << 40).is_err());
        assert!(String::from_utf8(text).unwrap().starts_with("replicate,S,R\n0,0,-0\n1,0.5,-0.001\n"));
    }

    #[test]
    fn parquet_begins_and_ends_as_it_should() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("records.parquet");
        let mut records = Records::create(&path, &["S".to_string(), "R".to_string()]).unwrap();
        records.append(&values(0, GROUP + 10)).unwrap();
        records.finish().unwrap();
        let bytes = std::fs::read(&path).unwrap();
        assert!(bytes.starts_with(b"PAR1") && bytes.ends_with(b"PAR1"));
        let length = u32::from_le_bytes(bytes[bytes.len() - 8..bytes.len() - 4].try_into().unwrap()) as usize;
        assert!(length + 12 < bytes.len());
        // three columns of eight bytes a row, and little besides
        assert!(bytes.len() > 24 * (GROUP + 10) && bytes.len() < 24 * (GROUP + 10) + 2000);
    }

    #[test]
    fn other_endings_are_refused() {
        assert!(RecordFormat::of(Path::new("records.txt")).unwrap_err().contains(".csv or .parquet"));
    }

    /// `/dev/full` is a disk without room.
    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_is_named() {
        let full = Path::new("/dev/full");
        let file = OpenOptions::new().write(true).open(full).unwrap();
        let mut records = Records { path: full.into(), file, sound: 0, rows: 7, kind: Kind::Csv };
        let error = records.append(&values(0, 5)).unwrap_err().to_string();
        assert!(error.contains("/dev/full") && error.contains("7 replicates before"), "{error}");
    }
}
