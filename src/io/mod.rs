//! Files: contacts and grids in, contacts out, saved surfaces back, and every output whole or not at all.
//!
//! ```text
//! CSV, PLY (ascii, binary), NPZ of 1-D arrays      x,y,z [nx,ny,nz | zx,zy] [finger, station] [wz,wx,wy]  -> Contacts
//! NPZ with 1-D x (n), y (m) and 2-D z (n x m)      [zx, zy] [wz, wx, wy], NaN = missing                   -> Grid
//! ```
//!
//! The format is recognised by the first bytes, not by the name, so that a pipe works like a file. What a header says of
//! the size of the data is checked against the bytes that are there before memory is asked for.

mod atomic;
mod columns;
mod csv;
mod error;
mod imported;
mod npy;
mod npz;
mod npz_writer;
mod place;
mod ply;
mod records;
mod remark;
pub(crate) mod scene_file;
mod study_file;
mod surface_file;
mod write;

use std::io::Read;
use std::path::Path;

use crate::contact::{Contacts, Grid};

use columns::Need;

pub(crate) use atomic::{remove_unfinished, write_atomically};
pub(crate) use error::IoError;
pub(crate) use imported::import_surface;
pub(crate) use npz_writer::NpzWriter;
pub use place::Place;
pub(crate) use place::Places;
pub(crate) use records::{RecordFormat, Records, write_parquet};
pub(crate) use study_file::{StudyFile, StudyIdentity, read_study, text_hash, write_study};
pub use surface_file::read_surface_bytes;
pub(crate) use surface_file::{AnySurface, Coefficient, FIT_SCHEMA, Saved, SavedFrame, SavedSurface, read_surface};
pub use write::{ContactFormat, write_contacts};

/// How contacts are read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ReadOptions {
    /// Leave out rows with missing or non-finite numbers and count them, instead of refusing the file.
    pub skip_invalid: bool,
    /// Read normals of length zero as normals that are not known, instead of refusing the file.
    pub keep_zero_normals: bool,
}

/// Scattered contacts or a grid.
#[derive(Clone, Debug, PartialEq)]
pub enum Input {
    /// One entry per touch.
    Contacts(Contacts),
    /// Heights on the product of two axes.
    Grid(Grid),
}

/// What was read, and what the reader has to say about it.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// The data.
    pub input: Input,
    /// Name of the file, for messages.
    pub file: String,
    /// Rows counted out under `skip_invalid` (pixels of a grid: made missing).
    pub skipped: usize,
    /// Columns that were there and were not used.
    pub ignored: Vec<String>,
    /// Where each contact stands; a grid has no rows.
    pub places: Option<Places>,
}

/// Reads contacts or a grid from a file, or from standard input where `path` is `-`.
///
/// # Errors
/// [`IoError`]: which file, line and field, what is wrong and what would be right.
pub(crate) fn read_input(path: &Path, options: &ReadOptions) -> Result<Reading, IoError> {
    let (file, bytes) = read_bytes(path)?;
    read_input_bytes(&file, &bytes, options)
}

/// Where to look at a surface.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Points {
    /// Input units.
    pub x: Vec<f64>,
    /// Input units.
    pub y: Vec<f64>,
}

/// Reads the columns x and y of a CSV or NPZ file (`-`: standard input), whatever else stands there.
///
/// # Errors
/// [`IoError`], as [`read_input`].
pub(crate) fn read_points(path: &Path) -> Result<Points, IoError> {
    let (file, bytes) = read_bytes(path)?;
    let strict = ReadOptions::default();
    if bytes.starts_with(b"PK") {
        npz::read_columns(&file, &bytes, Need::Points)?.into_points(&file, &Place::Entry)
    } else {
        let (columns, lines) = csv::read_columns(&file, &bytes, Need::Points, &strict)?;
        columns.into_points(&file, &|row| Place::Line(lines.get(row)))
    }
}

/// The name for messages and the whole content of a file, or of standard input where `path` is `-`.
///
/// # Errors
/// [`IoError::Read`].
pub(crate) fn read_bytes(path: &Path) -> Result<(String, Vec<u8>), IoError> {
    let mut bytes = Vec::new();
    let (file, outcome) = if path == Path::new("-") {
        ("standard input".to_string(), std::io::stdin().lock().read_to_end(&mut bytes).map(drop))
    } else {
        (path.display().to_string(), std::fs::read(path).map(|content| bytes = content))
    };
    match outcome {
        Ok(()) => Ok((file, bytes)),
        Err(source) => Err(IoError::Read { file, source }),
    }
}

/// Reads contacts or a grid from bytes; the format is recognised by the first of them.
///
/// # Errors
/// Every error of reading a file, with its place.
pub fn read_input_bytes(file: &str, bytes: &[u8], options: &ReadOptions) -> Result<Reading, IoError> {
    if bytes.starts_with(b"PK\x03\x04") || bytes.starts_with(b"PK\x05\x06") {
        return npz::read(file, bytes, options);
    }
    if bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r") {
        return ply::read(file, bytes, options);
    }
    match Path::new(file).extension().and_then(|e| e.to_str()) {
        Some("npz") if !bytes.is_empty() => Err(IoError::Zip { file: file.into(), what: "no zip archive".into() }),
        Some("ply") if !bytes.is_empty() => {
            Err(IoError::Ply { file: file.into(), what: "the first line must be ply".into() })
        }
        _ => csv::read(file, bytes, options),
    }
}
