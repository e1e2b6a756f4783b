//! Files: contacts and grids in, contacts out, saved surfaces back, and every output whole or not at all.
//!
//! ```text
//! CSV, PLY (ascii, binary), NPZ of 1-D arrays      x,y,z [nx,ny,nz | zx,zy] [finger, station] [wz,wx,wy]  -> Contacts
//! XYZ, PTS, PCD, OBJ, OFF, STL, NPY                x,y,z [nx,ny,nz]                                       -> Contacts
//! PNG, NPZ with depth                              d(u, v), 0 = missing, and a camera's intrinsics        -> Contacts
//! NPZ with 1-D x (n), y (m) and 2-D z (n x m)      [zx, zy] [wz, wx, wy], NaN = missing                   -> Grid
//! JSON, STEP, IGES                                 knots and coefficients or control points                <-> Saved
//! NPZ, PLY, OBJ, STL, glTF, VTU, Parquet           a spline, a mesh or its points                          <- Saved
//! ```
//!
//! The format is recognised by the first bytes, not by the name, so that a pipe works like a file; each may be packed by
//! gzip. What a header says of the size of the data is checked against the bytes that are there before memory is asked for.

mod abandoned;
mod atomic;
mod base64;
mod clouds;
mod columns;
mod csv;
mod depth;
mod error;
mod escape_control_chars;
mod facets;
mod finger_names;
mod format_detection;
mod imported;
mod large_input;
mod limits;
mod names;
mod npy;
mod npz;
mod npz_writer;
mod output_transaction;
mod page_file;
mod place;
mod ply;
mod ply_faces;
mod read_progress;
mod records;
mod remark;
mod same_file;
pub mod scene_file;
mod separator;
mod study_file;
mod support_map;
mod surface_file;
mod surfaces;
mod table_form;
mod table_pieces;
mod temporary_folder;
mod touch_lines;
mod uncertainty_map;
mod unpack;
mod write;

use std::path::Path;

use palpate_geometry::contact::{Contacts, Grid};

use columns::Need;
use depth::DepthImage;
use format_detection::Form;

pub(crate) use atomic::{remove_unfinished, write_atomically};
pub(crate) use base64::base64;
pub(crate) use depth::Intrinsics;
pub(crate) use error::IoError;
pub(crate) use escape_control_chars::{changes_others, visible};
pub(crate) use imported::{import_surface, imported_files};
pub(crate) use large_input::{OpenedInput, PieceRule, open_input};
pub(crate) use limits::{MOST_GRID_POINTS, MOST_SEGMENTS, exceeds};
pub use names::ColumnNames;
pub(crate) use npz_writer::NpzWriter;
pub(crate) use output_transaction::Together;
pub(crate) use page_file::{DOCUMENT_TAG, END_TAG, TABLE_TAG, page_content, schema_of};
pub use place::Place;
pub(crate) use place::Places;
pub(crate) use read_progress::{ReadPhase, ReadProgress, watched};
pub(crate) use records::{RecordFormat, Records, write_parquet};
pub(crate) use same_file::{same_file, same_place};
pub(crate) use study_file::{StudyFile, StudyIdentity, read_study, study_bytes, text_hash, write_study};
pub(crate) use support_map::SupportMap;
pub(crate) use surface_file::{AnySurface, FIT_SCHEMA, Saved, SavedFrame, SavedSurface};
pub(crate) use surfaces::{SurfaceFormat, encode_surface, is_cad, tensor, trimmed_primitives, write_primitives};
pub(crate) use table_pieces::TablePieces;
pub(crate) use temporary_folder::TemporaryFolder;
pub(crate) use touch_lines::{LineHeard, TouchLines};
pub(crate) use uncertainty_map::{PointUncertainty, UNCERTAINTY_POINTS, UncertaintyMap};
pub use write::{ContactFormat, write_contacts};

/// How contacts are read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// Leave out rows with missing or non-finite numbers and count them, instead of refusing the file. Where normals may be
    /// unknown, a row whose three normal cells are empty or NaN has no number missing.
    pub skip_invalid: bool,
    /// Read normals of length zero, and those whose three cells are empty or NaN, as normals that are not known, instead of
    /// refusing the file.
    pub keep_zero_normals: bool,
    /// The camera of a depth image that does not bring its own.
    pub intrinsics: Option<Intrinsics>,
    /// Which columns are which, where their names do not tell.
    pub columns: Option<ColumnNames>,
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
    /// What was assumed, left out or made of the file's content.
    pub notes: Vec<String>,
    /// Where the scanner or camera stood, where the format says so.
    pub viewpoint: Option<[f64; 3]>,
    /// Unit of the lengths, where the file says it.
    pub unit: Option<String>,
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
    let bytes = unpack::unpacked(&file, &bytes)?;
    let strict = ReadOptions::default();
    match format_detection::form_of(&bytes, &ending(&file)) {
        Ok(Form::Npz) => npz::read_columns(&file, &bytes, Need::Points)?.into_points(&file, &Place::Entry),
        Ok(_) => {
            let csv::Table { columns, lines, .. } = csv::read_columns(&file, &bytes, Need::Points, &strict)?;
            columns.into_points(&file, &|row| Place::Line(lines.get(row)))
        }
        Err(looks_like) => Err(IoError::Strange { file, looks_like }),
    }
}

/// The name for messages and the whole content of a file, or of standard input where `path` is `-`.
///
/// # Errors
/// [`IoError::Read`].
pub(crate) fn read_bytes(path: &Path) -> Result<(String, Vec<u8>), IoError> {
    let mut bytes = Vec::new();
    let (file, outcome) = if path == Path::new("-") {
        ("standard input".to_string(), read_progress::fetch(std::io::stdin().lock(), None, &mut bytes))
    } else {
        let content = std::fs::File::open(path).and_then(|file| {
            let size = file.metadata().ok().and_then(|about| usize::try_from(about.len()).ok());
            read_progress::fetch(file, size, &mut bytes)
        });
        (visible(&path.display().to_string()), content)
    };
    match outcome {
        Ok(()) => Ok((file, bytes)),
        Err(source) => Err(IoError::Read { file, source }),
    }
}

/// Reads a saved surface, or one in STEP or IGES, from a file; `-` is standard input.
///
/// # Errors
/// [`IoError::Read`], [`IoError::Surface`], [`IoError::Form`].
pub(crate) fn read_surface(path: &Path) -> Result<Saved, IoError> {
    let (file, bytes) = read_bytes(path)?;
    read_surface_bytes(&file, &bytes)
}

/// Reads a surface from bytes, as `fit --save` wrote it in JSON, STEP or IGES.
///
/// # Errors
/// Every fault of the file, with its place.
pub fn read_surface_bytes(file: &str, bytes: &[u8]) -> Result<Saved, IoError> {
    match surfaces::read_cad(file, bytes) {
        Some(found) => found,
        None => surface_file::read_document_bytes(file, bytes),
    }
}

/// Our names for the columns of a table, by the rules of every reader; a column that means nothing keeps its own.
///
/// # Errors
/// `IoError::DuplicateColumn` where two of them mean one.
pub fn column_names(file: &str, names: &[&str]) -> Result<Vec<String>, IoError> {
    Ok(names::in_our_words(file, names, None)?.into_iter().map(std::borrow::Cow::into_owned).collect())
}

/// The file name's ending in lower case, without `.gz`.
fn ending(file: &str) -> String {
    let name = file.strip_suffix(".gz").unwrap_or(file);
    Path::new(name).extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase()
}

/// Reads contacts or a grid from bytes; the format is recognised by the first of them.
///
/// # Errors
/// Every error of reading a file, with its place.
pub fn read_input_bytes(file: &str, bytes: &[u8], options: &ReadOptions) -> Result<Reading, IoError> {
    let bytes = &unpack::unpacked(file, bytes)?[..];
    let mut reading = read_form(file, bytes, options)?;
    // the camera's own place is that of depth images alone
    if options.intrinsics.is_some() && reading.viewpoint != Some([0.0; 3]) {
        reading.notes.push("intrinsics were given and not used: this is no depth image".into());
    }
    Ok(reading)
}

fn read_form(file: &str, bytes: &[u8], options: &ReadOptions) -> Result<Reading, IoError> {
    let form = format_detection::form_of(bytes, &ending(file));
    if options.columns.is_some() && matches!(form, Ok(Form::Npy | Form::Off | Form::Obj | Form::Stl | Form::Png)) {
        let what = "its columns have no names that --columns could mean".into();
        return Err(IoError::Form { file: file.into(), form: "table", what });
    }
    match form {
        Ok(Form::Npz) if !bytes.starts_with(b"PK") => {
            Err(IoError::Zip { file: file.into(), what: "no zip archive".into() })
        }
        Ok(Form::Ply) if !bytes.starts_with(b"ply") => {
            Err(IoError::Ply { file: file.into(), what: "the first line must be ply".into() })
        }
        Ok(Form::Npz) => npz::read(file, bytes, options),
        Ok(Form::Npy) => read_npy(file, bytes, options),
        Ok(Form::Ply) => ply::read(file, bytes, options),
        Ok(Form::Pcd) => clouds::read_pcd(file, bytes, options),
        Ok(Form::Off) => clouds::read_off(file, bytes, options),
        Ok(Form::Obj) => clouds::read_obj(file, bytes, options),
        Ok(Form::Stl) => clouds::read_stl(file, bytes, options),
        Ok(Form::Png) => {
            let image = depth::read_png(bytes);
            read_depth(file, "PNG", image, options)
        }
        Ok(Form::Table) => csv::read(file, bytes, options),
        Err(looks_like) => Err(IoError::Strange { file: file.into(), looks_like }),
    }
}

/// One array: contacts in its rows, or a depth image where a camera is given.
fn read_npy(file: &str, bytes: &[u8], options: &ReadOptions) -> Result<Reading, IoError> {
    if options.intrinsics.is_none() {
        return clouds::read_npy(file, bytes, options);
    }
    let image = npy::Header::read_whole(bytes).and_then(|(header, values)| {
        let image = DepthImage::of_array(&header.shape, header.fortran_order, &values);
        image.ok_or_else(|| format!("its shape is {:?}; a depth image is 2-D, [row, column]", header.shape))
    });
    read_depth(file, "NPY", image, options)
}

fn read_depth(
    file: &str,
    form: &'static str,
    image: Result<DepthImage, String>,
    options: &ReadOptions,
) -> Result<Reading, IoError> {
    let wrong = |what: String| IoError::Form { file: file.into(), form, what };
    let image = image.map_err(wrong)?;
    let intrinsics = options.intrinsics.ok_or_else(|| {
        wrong("an image is read as depths, which takes the camera's --intrinsics FX,FY,CX,CY[,SCALE]".into())
    })?;
    depth::read(file, &image, &intrinsics, options)
}
