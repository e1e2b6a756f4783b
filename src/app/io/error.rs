//! What can be wrong with a file, with enough fields to say where and what would be right.

use std::path::{Path, PathBuf};

use palpate_geometry::contact::ContactError;

use super::Place;
use super::escape_control_chars::visible;
use super::format_detection::READ;

/// Names less alike than this, of 1, are not proposed.
const ALIKE: f64 = 0.85;

/// Why a file cannot be read; of one that is not there, the file beside its place whose name is most alike.
fn why_unread(file: &str, source: &std::io::Error) -> String {
    match source.kind() {
        std::io::ErrorKind::NotFound => {}
        std::io::ErrorKind::IsADirectory => return format!("it is a folder; name the files in it, as in {file}/*.csv"),
        _ => return source.to_string(),
    }
    let path = Path::new(file);
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let names = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.file_name());
    let alike =
        names.map(|other| visible(&other.to_string_lossy())).map(|other| (strsim::jaro_winkler(&name, &other), other));
    let closest = alike.filter(|(score, _)| *score >= ALIKE).max_by(|a, b| a.0.total_cmp(&b.0));
    closest.map_or("there is no such file".into(), |(_, other)| format!("there is no such file; did you mean {other}?"))
}

/// A file that cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum IoError {
    /// The input cannot be opened or read.
    #[error("{file}: cannot be read: {}", why_unread(file, source))]
    Read {
        /// Name of the input.
        file: String,
        /// What the system said.
        source: std::io::Error,
    },
    /// A file with nothing in it but comments.
    #[error("{file}: empty; contacts need a header such as x,y,z,nx,ny,nz and one row each")]
    Empty {
        /// Name of the input.
        file: String,
    },
    /// A header and no usable row.
    #[error("{file}: no rows of contacts{}", skipped_words(*skipped))]
    NoRows {
        /// Name of the input.
        file: String,
        /// Rows that were counted out.
        skipped: usize,
    },
    /// Text that is not UTF-8.
    #[error("{file}, line {line}: not UTF-8 text; save the table as plain CSV in UTF-8")]
    NotUtf8 {
        /// Name of the input.
        file: String,
        /// Line, counted from 1.
        line: usize,
    },
    /// The first row is no header.
    #[error("{file}, line {line}: {text:?} is not a header; put column names first, such as {example}")]
    NoHeader {
        /// Name of the input.
        file: String,
        /// Line, counted from 1.
        line: usize,
        /// The row as it stands.
        text: String,
        /// A header that would do.
        example: &'static str,
    },
    /// A needed column or array is not there.
    #[error("{file}: no column {column}; it has {}. Needed are {needed}", list(found))]
    MissingColumn {
        /// Name of the input.
        file: String,
        /// The first that is missing.
        column: &'static str,
        /// Names that are there.
        found: Vec<String>,
        /// What would do.
        needed: &'static str,
    },
    /// A column that was named is not there.
    #[error("{file}: no column {name}; the nearest is {nearest}, and there are {}", list(found))]
    NoSuchColumn {
        /// Name of the input.
        file: String,
        /// The name that was said.
        name: String,
        /// The most alike.
        nearest: String,
        /// Names that are there.
        found: Vec<String>,
    },
    /// Places in two units.
    #[error("{file}: {} is in {} and {} in {}; places need one unit of length", columns[0], units[0], columns[1], units[1])]
    Units {
        /// Name of the input.
        file: String,
        /// Two columns that differ.
        columns: [String; 2],
        /// Their units.
        units: [String; 2],
    },
    /// A name stands twice.
    #[error("{file}: column {column} stands twice; each name may stand once")]
    DuplicateColumn {
        /// Name of the input.
        file: String,
        /// The name.
        column: String,
    },
    /// Normals and slopes in one file.
    #[error("{file}: both normals (nx,ny,nz) and slopes (zx,zy); give one of the two")]
    NormalsAndSlopes {
        /// Name of the input.
        file: String,
    },
    /// A weight for something that is not measured.
    #[error("{file}: column {weight} weighs {of}, which the file does not have; take it out or add {of}")]
    WeightOfNothing {
        /// Name of the input.
        file: String,
        /// The weight's column.
        weight: &'static str,
        /// What it would weigh.
        of: &'static str,
    },
    /// A row is too short or too long.
    #[error("{file}, line {line}: {found} fields where the header names {expected}")]
    FieldCount {
        /// Name of the input.
        file: String,
        /// Line, counted from 1.
        line: usize,
        /// Fields found.
        found: usize,
        /// Fields named.
        expected: usize,
    },
    /// A field is no number.
    #[error("{file}, {place}, column {column}: {text:?} is not a number; {} (or skip_invalid)", instead_of(ours, text))]
    NotANumber {
        /// Name of the input.
        file: String,
        /// Where.
        place: Place,
        /// What the file calls the column.
        column: String,
        /// What palpate calls it.
        ours: &'static str,
        /// The field as it stands.
        text: String,
    },
    /// A field is NaN or infinite.
    #[error("{file}, {place}, column {column}: {value} is not finite (skip_invalid leaves such rows out)")]
    NotFinite {
        /// Name of the input.
        file: String,
        /// Where.
        place: Place,
        /// What the file calls the column.
        column: String,
        /// The value.
        value: f64,
    },
    /// A normal without direction, where every contact needs one.
    #[error(
        "{file}, {place}: the normal (nx,ny,nz) is zero or empty, which says that it is not known; a fit that names no model takes such \
         contacts, here every row needs a normal, of any length (or skip_invalid)"
    )]
    ZeroNormal {
        /// Name of the input.
        file: String,
        /// Where.
        place: Place,
    },
    /// A weight below zero.
    #[error("{file}, {place}, column {column}: weight {value} is negative; weights are zero or more")]
    NegativeWeight {
        /// Name of the input.
        file: String,
        /// Where.
        place: Place,
        /// What the file calls the column.
        column: String,
        /// The value.
        value: f64,
    },
    /// A finger or station that is not a whole number.
    #[error("{file}, {place}, column {column}: {value} is not a label; use whole numbers from 0 to 4294967295")]
    Label {
        /// Name of the input.
        file: String,
        /// Where.
        place: Place,
        /// What the file calls the column.
        column: String,
        /// The value.
        value: f64,
    },
    /// Data that are readable but cannot be contacts or a grid.
    #[error("{file}: {source}")]
    Contact {
        /// Name of the input.
        file: String,
        /// What is wrong.
        source: ContactError,
    },
    /// The zip container of an NPZ.
    #[error("{file}: not an NPZ file ({what}); np.savez writes one")]
    Zip {
        /// Name of the input.
        file: String,
        /// What the reader said.
        what: String,
    },
    /// One array of an NPZ.
    #[error("{file}, array {array}: {what}")]
    Array {
        /// Name of the input.
        file: String,
        /// Name of the array.
        array: String,
        /// What is wrong and what would be right.
        what: String,
    },
    /// The header or body of a PLY.
    #[error("{file}: not a readable PLY: {what}")]
    Ply {
        /// Name of the input.
        file: String,
        /// What is wrong and what would be right.
        what: String,
    },
    /// The content of a file in one of the other formats.
    #[error("{file}: not a readable {form}: {what}")]
    Form {
        /// Name of the input.
        file: String,
        /// Name of the format.
        form: &'static str,
        /// What is wrong and what would be right.
        what: String,
    },
    /// A file of a format that is not read.
    #[error("{file}: this looks like {looks_like}; what is read: {}", READ)]
    Strange {
        /// Name of the input.
        file: String,
        /// What its first bytes look like.
        looks_like: &'static str,
    },
    /// A file that is not a saved surface.
    #[error("{file}: not a saved surface: {what}; `palpate fit --save F` writes one")]
    Surface {
        /// Name of the input.
        file: String,
        /// What is wrong.
        what: String,
    },
    /// A surface that a format cannot hold.
    #[error("{format} cannot hold this surface: {what}")]
    Unholdable {
        /// Name of the format.
        format: &'static str,
        /// What it cannot hold, and which format can.
        what: String,
    },
    /// The output's ending names no format.
    #[error("{path:?}: cannot tell the format; end the name in {expected}")]
    Extension {
        /// The output.
        path: PathBuf,
        /// Endings that would do.
        expected: &'static str,
    },
    /// The output cannot be written.
    #[error("{path:?}: cannot be written: {source}")]
    Write {
        /// The output.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
}

impl IoError {
    /// Options of reading that the message proposes, as [`palpate_fitting::fit::FitError::remedies`] has them.
    pub fn remedies(&self) -> &'static [(&'static str, &'static str)] {
        match self {
            IoError::NotANumber { .. } | IoError::NotFinite { .. } | IoError::ZeroNormal { .. } => {
                &[("skip_invalid", "")]
            }
            _ => &[],
        }
    }
}

/// What to write in place of a field that is no number.
fn instead_of(column: &str, text: &str) -> &'static str {
    match column {
        "nx" | "ny" | "nz" if text.is_empty() => {
            "where a normal is not known, leave all three of nx,ny,nz empty, or write 0,0,0"
        }
        "finger" | "station" => {
            "fingers and stations are whole numbers; without the column, or under another name, the rest is read"
        }
        _ => "write one such as -0.25",
    }
}

fn skipped_words(skipped: usize) -> String {
    if skipped == 0 { String::new() } else { format!(" left: all {skipped} were counted out as invalid") }
}

fn list(names: &[String]) -> String {
    /// Enough to recognise the file by; a table of 500 columns would drown the message.
    const SHOWN: usize = 12;
    if names.is_empty() {
        return "no columns".into();
    }
    let more = if names.len() > SHOWN { format!(", ... ({} in all)", names.len()) } else { String::new() };
    names.iter().take(SHOWN).cloned().collect::<Vec<_>>().join(",") + &more
}
