//! Contacts out, in the format that the output's name ends in.

use std::io::{BufWriter, Cursor, Write};
use std::path::Path;

use palpate_geometry::contact::Contacts;

use super::{IoError, csv, npz, ply};

/// A format that contacts are written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactFormat {
    /// Text with a header; numbers read back exactly.
    Csv,
    /// 1-D float64 arrays.
    Npz,
    /// Binary little-endian, `double`.
    Ply,
}

impl ContactFormat {
    /// By the name's ending; `-` is CSV.
    ///
    /// # Errors
    /// `IoError::Extension`.
    pub fn of(path: &Path) -> Result<ContactFormat, IoError> {
        if path == Path::new("-") {
            return Ok(ContactFormat::Csv);
        }
        let ending = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
        match ending.as_deref() {
            Some("csv") => Ok(ContactFormat::Csv),
            Some("npz") => Ok(ContactFormat::Npz),
            Some("ply") => Ok(ContactFormat::Ply),
            _ => Err(IoError::Extension { path: path.into(), expected: ".csv, .npz or .ply" }),
        }
    }
}

/// Writes contacts in one format. A `remark` goes where the format has room for one: a comment in CSV and PLY, in NPZ
/// an array of ones named after its first words (`inverse_crime`).
///
/// # Errors
/// What the system says.
pub fn write_contacts(
    contacts: &Contacts,
    format: ContactFormat,
    remark: Option<&str>,
    out: &mut dyn Write,
) -> std::io::Result<()> {
    let mut out = BufWriter::new(out);
    match format {
        ContactFormat::Csv => csv::write(contacts, remark, &mut out)?,
        ContactFormat::Ply => ply::write(contacts, remark, &mut out)?,
        ContactFormat::Npz => {
            // zip needs to seek, which a pipe cannot
            let mut whole = Cursor::new(Vec::new());
            npz::write(contacts, remark, &mut whole)?;
            out.write_all(whole.get_ref())?;
        }
    }
    out.flush()
}
