//! What `palpate parts` cuts up: contacts from a file, or felt in a scene; options of the input hold for both.

use std::path::PathBuf;
use std::sync::Arc;

use crate::io::{Input, ReadOptions, Reading, read_input};
use palpate_geometry::contact::Contacts;

use super::failure::Failure;
use super::parts_args::PartsArgs;
use super::pixels::contacts_of;
use super::reading::{ReadFlags, seen_from};
use super::scene;
use super::viewpoint::turned_towards;
use super::zero_weights::is_without_heights;

/// Contacts, and the true face of each where they come from a scene.
pub(super) struct Taken {
    pub(super) name: String,
    pub(super) contacts: Arc<Contacts>,
    pub(super) faces: Option<(Vec<usize>, Vec<&'static str>)>,
    pub(super) viewpoint: Option<[f64; 3]>,
    /// The scene as TOML, and the seed that it was played with.
    pub(super) scene: Option<String>,
    pub(super) seed: Option<u64>,
    pub(super) notes: Vec<String>,
}

pub(super) fn from_scene(args: &PartsArgs) -> Result<Taken, Failure> {
    let only_files = [
        (args.skip_invalid, "--skip-invalid", "a scene has no invalid rows to leave out"),
        (args.reading.has_intrinsics(), "--intrinsics", "a scene is no depth image"),
        (args.reading.has_columns(), "--columns", "a scene has no columns"),
    ];
    if let Some((_, option, why)) = only_files.iter().find(|(typed, _, _)| *typed) {
        return Err(Failure::Input(format!("{option} is for files, and {} is a scene: {why}", args.input)));
    }
    let (scene, text) = scene::load_with_text(&args.input)?;
    let simulator = scene.world.compile().map_err(|e| Failure::Input(format!("{}: {e}", scene.name)))?;
    let seed = args.seed.unwrap_or(scene.seed);
    let (contacts, truth) = simulator.into_contacts(seed, 0);
    let mut notes = Vec::new();
    let faces = truth.faces().map(|faces| match args.preparation.kept(&contacts) {
        Some(kept) => (kept.iter().map(|r| faces[*r as usize]).collect(), truth.face_kinds()),
        None => (faces, truth.face_kinds()),
    });
    if faces.is_none() {
        notes.push("the scene's surface is no body of solids, so that its true parts are not known".into());
    }
    let reading = Reading {
        input: Input::Contacts(contacts),
        file: scene.name,
        skipped: 0,
        ignored: Vec::new(),
        places: None,
        notes,
        viewpoint: None,
        unit: None,
    };
    Ok(Taken { faces, scene: Some(text), seed: Some(seed), ..prepared(args, reading)? })
}

pub(super) fn from_file(args: &PartsArgs) -> Result<Taken, Failure> {
    if args.seed.is_some() {
        return Err(Failure::Input(format!("--seed is for scenes, and {} is a file of contacts", args.input)));
    }
    let keep_zero_normals = args.preparation.needs_no_normals();
    let options = ReadOptions { keep_zero_normals, ..args.reading.options(args.skip_invalid) };
    let reading = read_input(&PathBuf::from(&args.input), &options).map_err(ReadFlags::refused)?;
    prepared(args, reading)
}

/// The contacts after everything that options ask for.
fn prepared(args: &PartsArgs, mut reading: Reading) -> Result<Taken, Failure> {
    let mut notes = std::mem::take(&mut reading.notes);
    notes.extend(args.preparation.apply(&mut reading)?);
    if reading.skipped > 0 {
        notes.push(format!("{} invalid rows counted out", reading.skipped));
    }
    let viewpoint = args.preparation.viewpoint.or(seen_from(&reading));
    let contacts = match reading.input {
        Input::Contacts(contacts) => contacts,
        Input::Grid(grid) => contacts_of(&grid),
    };
    if is_without_heights(&contacts) {
        let what = "no column z: parts are cut from places in space, which need x, y and z";
        return Err(Failure::Input(format!("{}: {what}", reading.file)));
    }
    if !reading.ignored.is_empty() {
        notes.push(format!("columns not used: {}", reading.ignored.join(", ")));
    }
    let contacts = match args.preparation.viewpoint {
        Some(eye) => turned_towards(contacts, eye, &mut notes),
        None => contacts,
    };
    let contacts = Arc::new(contacts);
    Ok(Taken { name: reading.file, contacts, faces: None, viewpoint, scene: None, seed: None, notes })
}
