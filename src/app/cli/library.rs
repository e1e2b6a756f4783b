//! `palpate parts SCAN --library DIR`: the known objects that a body may be, one file of the directory each.
//!
//! ```text
//! mug.json     what `palpate parts mug.ply --out D` wrote as D/parts.json, taken as it is
//! mug.ply      any file of contacts, mesh, grid or scene (.toml) that `palpate parts` reads, cut into parts now
//! ```

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::io::{Input, ReadOptions, read_input};
use crate::report::parts_of_document;
use palpate_geometry::contact::Contacts;
use palpate_inference::parts::{ObjectModel, Parts, PartsOptions};

use super::failure::Failure;
use super::interrupt;
use super::options::OutputFlags;
use super::pixels::contacts_of;
use super::scene;
use super::until::Until;

/// Files of a directory that are no hidden ones, in the order of their names.
///
/// # Errors
/// When it cannot be read or has none.
pub(super) fn files_of(directory: &Path) -> Result<Vec<PathBuf>, Failure> {
    let failed = |what: &str| Failure::Input(format!("--library {}: {what}", directory.display()));
    let entries = std::fs::read_dir(directory).map_err(|error| failed(&format!("cannot be read: {error}")))?;
    let is_hidden = |path: &PathBuf| path.file_name().is_none_or(|name| name.to_string_lossy().starts_with('.'));
    let mut files: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    files.retain(|path| path.is_file() && !is_hidden(path));
    files.sort();
    if files.is_empty() { Err(failed("has no files; put one of each known object into it")) } else { Ok(files) }
}

/// The objects, named by their files without the ending; people who wait see which one is at work.
///
/// # Errors
/// When a file cannot be read, or has no parts; after Ctrl-C.
pub(super) fn models(files: &[PathBuf], output: &OutputFlags) -> Result<Vec<ObjectModel>, Failure> {
    let at_work = |file: &PathBuf| {
        let _spinner = output.spinner(format!("reading {}", file.display()));
        model(file)
    };
    files.iter().map(at_work).collect()
}

fn model(file: &Path) -> Result<ObjectModel, Failure> {
    let failed = |what: String| Failure::Input(format!("{}: {what}", file.display()));
    let name = file.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    let is = |ending: &str| file.extension().is_some_and(|e| e.eq_ignore_ascii_case(ending));
    if is("json") {
        let text = std::fs::read_to_string(file).map_err(|error| failed(format!("cannot be read: {error}")))?;
        let (spacing, parts) = parts_of_document(&text).map_err(failed)?;
        return Ok(ObjectModel { name, parts, spacing });
    }
    let contacts = Arc::new(if is("toml") { felt(file)? } else { read(file)? });
    interrupt::gently();
    let found = Until::interrupted().wait(move || Parts::of(&contacts, &PartsOptions::default()));
    interrupt::at_once();
    let found = found.ok_or_else(|| {
        Failure::Interrupted(format!("interrupted while {} was cut into parts; nothing is kept", file.display()))
    })?;
    let found = found.map_err(|error| failed(error.to_string()))?;
    Ok(ObjectModel { name, parts: found.parts, spacing: found.spacing })
}

fn felt(file: &Path) -> Result<Contacts, Failure> {
    let scene = scene::load(&file.to_string_lossy())?;
    let simulator = scene.world.compile().map_err(|error| Failure::Input(format!("{}: {error}", file.display())))?;
    Ok(simulator.into_contacts(scene.seed, 0).0)
}

fn read(file: &Path) -> Result<Contacts, Failure> {
    let reading = read_input(file, &ReadOptions::default()).map_err(super::reading::ReadFlags::refused)?;
    Ok(match reading.input {
        Input::Contacts(contacts) => contacts,
        Input::Grid(grid) => contacts_of(&grid),
    })
}
