//! `palpate parts INPUT|SCENE`: what a body is made of, how its parts adjoin, and its shape at every point.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;

use crate::io::scene_file::builtin_text;
use crate::io::{Input, ReadOptions, read_input, write_atomically};
use crate::report::{
    PartsBody, PartsDocument, PointShapesFormat, Provenance, write_json, write_parts_csv, write_parts_page,
    write_parts_picture, write_parts_table, write_point_shapes, write_point_shapes_summary,
};
use palpate_geometry::contact::{Contacts, Grid};
use palpate_inference::parts::{Agreement, Parts, PartsError, PartsOptions, PointShapes, against, boundary};

use super::failure::Failure;
use super::options::{OutputFlags, PictureFlags};
use super::output::print;
use super::preparation::PreparationFlags;
use super::provenance::provenance;
use super::reading::{ReadFlags, seen_from};
use super::scene;
use super::zero_weights::is_without_heights;

/// Arguments of `palpate parts`.
#[derive(Args)]
pub(super) struct PartsArgs {
    /// A file of contacts, a mesh or a grid; or a built-in scene (palpate scenes) or a scene file ending in .toml
    input: String,
    /// Departures from a primitive that make no part of their own [default: a tenth of the spacing or 0.3 % of the body]
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    tolerance: Option<f64>,
    /// Write x, y, z, normal, k1, k2, S, R, u_S and u_R at every point to .csv, .npz, .ply or .parquet (- for CSV on standard output); without --out and --json, nothing is cut into parts
    #[arg(long, value_name = "FILE")]
    points: Option<PathBuf>,
    /// Seed in place of the scene's
    #[arg(long)]
    seed: Option<u64>,
    /// Leave out rows with missing or non-finite numbers and count them, instead of refusing the file
    #[arg(long)]
    skip_invalid: bool,
    #[command(flatten)]
    preparation: PreparationFlags,
    #[command(flatten)]
    reading: ReadFlags,
    #[command(flatten)]
    pictures: PictureFlags,
    #[command(flatten)]
    output: OutputFlags,
}

/// Contacts, and the true face of each where they come from a scene.
struct Taken {
    name: String,
    contacts: Contacts,
    faces: Option<(Vec<usize>, Vec<&'static str>)>,
    viewpoint: Option<[f64; 3]>,
    /// The scene as TOML, and the seed that it was played with.
    scene: Option<String>,
    seed: Option<u64>,
    notes: Vec<String>,
}

pub(super) fn parts(args: &PartsArgs) -> Result<(), Failure> {
    let is_scene =
        builtin_text(&args.input).is_some() || Path::new(&args.input).extension().is_some_and(|e| e == "toml");
    if is_scene {
        // what the scene names is an input, too
        scene::load(&args.input)?;
    }
    args.output.prepare(&[args.input.as_ref()], args.points.as_slice())?;
    let format = points_format(args)?;
    let spinner = args.output.spinner(format!("reading {}", args.input));
    let taken = if is_scene { from_scene(args)? } else { spinner.while_reading(|| from_file(args))? };
    spinner.phase(&format!("looking for the parts of {}", args.input));
    let clock = Instant::now();
    let options = PartsOptions { tolerance: args.tolerance, viewpoint: taken.viewpoint };
    if let Some((path, format)) = format {
        let found = PointShapes::of(&taken.contacts, &options).map_err(|error| refused(&taken, &error))?;
        write_atomically(path, &mut |out| write_point_shapes(&taken.contacts, &found, format, out))?;
        if args.output.out.is_none() && !args.output.json {
            drop(spinner);
            return summary(args, &taken, &found);
        }
    }
    let found = Parts::of(&taken.contacts, &options).map_err(|error| refused(&taken, &error))?;
    let seconds = clock.elapsed().as_secs_f64();
    let mut document = PartsDocument::new(&taken.name, &found, taken.notes.clone(), seconds);
    if let Some((faces, kinds)) = &taken.faces {
        let agreement: Agreement = against(&taken.contacts, &found, faces, kinds.len());
        document = document.with_truth(&agreement, kinds);
    }
    drop(spinner);
    let provenance = provenance(&args.input, taken.scene.clone(), taken.seed);
    publish(args, &document, (&taken.contacts, &found), &provenance)
}

fn refused(taken: &Taken, error: &PartsError) -> Failure {
    let message = error.to_string().replace("tolerance =", "--tolerance");
    Failure::Input(format!("{}: {message}", taken.name))
}

/// Where the shape of every point goes, known before any work is done for it.
fn points_format(args: &PartsArgs) -> Result<Option<(&Path, PointShapesFormat)>, Failure> {
    let Some(path) = args.points.as_deref() else { return Ok(None) };
    if args.output.json && path.as_os_str() == "-" {
        return Err(Failure::Input("--points - and --json both want standard output; give --points a file".into()));
    }
    Ok(Some((path, PointShapesFormat::of(path).map_err(Failure::Input)?)))
}

fn summary(args: &PartsArgs, taken: &Taken, found: &PointShapes) -> Result<(), Failure> {
    if args.output.quiet || args.points.as_ref().is_some_and(|path| path.as_os_str() == "-") {
        return Ok(());
    }
    print(&mut |out| write_point_shapes_summary(&taken.name, found, &taken.notes, out))
}

fn publish(
    args: &PartsArgs,
    document: &PartsDocument,
    (contacts, found): (&Contacts, &Parts),
    provenance: &Provenance,
) -> Result<(), Failure> {
    let output = &args.output;
    if output.out.is_some() {
        let edge = boundary(contacts, &found.labels);
        output.file("parts.json", &mut |out| write_json(document, out))?;
        output.file("parts.csv", &mut |out| write_parts_csv(contacts, found, out))?;
        let picture = |format, out: &mut dyn Write| write_parts_picture(contacts, found, &edge, format, out);
        args.pictures.write(output, "parts", &picture)?;
        let body = PartsBody { contacts, found, edge: &edge };
        output.file("report.html", &mut |out| write_parts_page(document, &body, provenance, out))?;
        output.publish()?;
    }
    if output.json {
        return print(&mut |out| write_json(document, out));
    }
    if output.quiet {
        return Ok(());
    }
    print(&mut |out| write_parts_table(document, out))
}

fn from_scene(args: &PartsArgs) -> Result<Taken, Failure> {
    let (scene, text) = scene::load_with_text(&args.input)?;
    let simulator = scene.world.compile().map_err(|e| Failure::Input(format!("{}: {e}", scene.name)))?;
    let seed = args.seed.unwrap_or(scene.seed);
    let (contacts, truth) = simulator.into_contacts(seed, 0);
    let faces = truth.faces().map(|faces| (faces, truth.face_kinds()));
    let mut notes = Vec::new();
    if faces.is_none() {
        notes.push("the scene's surface is no body of solids, so that its true parts are not known".into());
    }
    Ok(Taken { name: scene.name, contacts, faces, viewpoint: None, scene: Some(text), seed: Some(seed), notes })
}

fn from_file(args: &PartsArgs) -> Result<Taken, Failure> {
    if args.seed.is_some() {
        return Err(Failure::Input(format!("--seed is for scenes, and {} is a file of contacts", args.input)));
    }
    let path = PathBuf::from(&args.input);
    let keep_zero_normals = args.preparation.needs_no_normals();
    let options = ReadOptions { keep_zero_normals, ..args.reading.options(args.skip_invalid) };
    let mut reading = read_input(&path, &options)?;
    let mut notes = reading.notes.clone();
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
    Ok(Taken { name: reading.file, contacts, faces: None, viewpoint, scene: None, seed: None, notes })
}

/// The pixels that are there, as contacts.
fn contacts_of(grid: &Grid) -> Contacts {
    let (mut x, mut y, mut z, mut zx, mut zy) = (Vec::new(), Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let slope = |slopes: &Option<ndarray::Array2<f64>>, at: (usize, usize)| slopes.as_ref().map(|s| s[at]);
    for ((i, j), height) in grid.z.indexed_iter().filter(|(_, height)| height.is_finite()) {
        x.push(grid.x[i]);
        y.push(grid.y[j]);
        z.push(*height);
        zx.extend(slope(&grid.zx, (i, j)));
        zy.extend(slope(&grid.zy, (i, j)));
    }
    let whole = zx.len() == x.len() && zy.len() == x.len() && zx.iter().chain(&zy).all(|v| v.is_finite());
    let contacts = Contacts::from_positions(x, y, z);
    if whole { contacts.with_slopes(zx, zy) } else { contacts }
}
