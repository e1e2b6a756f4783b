//! `--save FILE`: a surface in the format that the file's name ends in.

use std::io::Write;
use std::path::Path;

use crate::io::{IoError, Saved, SurfaceFormat, encode_surface, visible, write_atomically};
use crate::report::{FitDocument, write_json};

use super::failure::Failure;

/// Vertices of a mesh each way where `--grid` does not say: as fine as the pictures.
const MESH: [usize; 2] = [49, 49];

/// Refuses a name whose ending means nothing, before any work is done for it.
pub(super) fn check_name(path: Option<&Path>) -> Result<(), Failure> {
    path.map_or(Ok(()), |path| Ok(SurfaceFormat::of(path).map(drop)?))
}

/// Writes the surface of a document; meshes have `grid` vertices each way.
pub(super) fn save(
    path: &Path,
    document: &FitDocument,
    title: &str,
    grid: Option<[usize; 2]>,
    quiet: bool,
) -> Result<(), Failure> {
    let format = SurfaceFormat::of(path)?;
    if format == SurfaceFormat::Json {
        return Ok(write_atomically(path, &mut |out| write_json(document, out))?);
    }
    let wrong = |what: String| IoError::Surface { file: title.into(), what };
    let surface = document.surface.clone();
    let saved = Saved::of(title, &document.frame, surface, document.uncertainty.clone()).map_err(wrong)?;
    save_surface(path, &saved, format, title, grid, quiet)
}

/// Writes a surface in a format other than JSON.
pub(super) fn save_surface(
    path: &Path,
    saved: &Saved,
    format: SurfaceFormat,
    title: &str,
    grid: Option<[usize; 2]>,
    quiet: bool,
) -> Result<(), Failure> {
    let encoded = encode_surface(saved, format, grid.unwrap_or(MESH), title)
        .map_err(|e| Failure::Input(format!("{}: {e}", path.display())))?;
    write_atomically(path, &mut |out| out.write_all(&encoded.bytes))?;
    for note in encoded.notes.iter().filter(|_| !quiet) {
        // standard error may be closed; the file is written all the same
        let _ = writeln!(std::io::stderr(), "palpate: {}: {note}", visible(&path.display().to_string()));
    }
    Ok(())
}
