//! What `palpate diff` tells, for a program that holds the documents.

use crate::report::write_json;

use super::diff::{ComparedFile, DEFAULT_DIFF_GRID, compared};
use super::failure::Failure;

/// The document that `palpate diff A B --json` prints, and the table that it prints without. Each surface is its name with the
/// bytes of its file.
///
/// # Errors
/// What the command line would say.
pub fn diff(a: (&str, &[u8]), b: (&str, &[u8]), grid: Option<[usize; 2]>) -> Result<[Vec<u8>; 2], String> {
    let read = |(name, bytes): (&str, &[u8])| ComparedFile::of(name.into(), bytes).map_err(Failure::into_message);
    let (a, b) = (read(a)?, read(b)?);
    let (_, document) = compared(&a, &b, grid.unwrap_or(DEFAULT_DIFF_GRID)).map_err(Failure::into_message)?;
    let (mut json, mut table) = (Vec::new(), Vec::new());
    // a Vec takes every byte
    let _ = write_json(&document, &mut json);
    let _ = crate::report::write_diff_table(&document, crate::report::PAGE_WIDTH, &mut table);
    Ok([json, table])
}
