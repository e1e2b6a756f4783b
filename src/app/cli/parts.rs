//! `palpate parts INPUT|SCENE`: what a body is made of, how its parts adjoin, and its shape at every point.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use crate::io::scene_file::builtin_text;
use crate::io::{trimmed_primitives, write_atomically, write_primitives};
use crate::report::{
    PartsBody, PartsDocument, PointShapesFormat, Provenance, write_dot, write_graphml, write_json, write_parts_csv,
    write_parts_page, write_parts_picture, write_parts_table, write_point_shapes, write_point_shapes_summary,
};
use palpate_geometry::contact::Contacts;
use palpate_inference::parts::{
    Agreement, ObjectPrior, Parts, PartsError, PartsOptions, PointShapes, against, boundary,
};

use super::failure::Failure;
use super::interrupt;
use super::library;
use super::output::{columns, print};
use super::parts_args::PartsArgs;
use super::parts_input::{Taken, from_file, from_scene};
use super::provenance::provenance;
use super::scene;
use super::until::Until;

pub(super) fn parts(args: &PartsArgs) -> Result<(), Failure> {
    let is_scene =
        builtin_text(&args.input).is_some() || Path::new(&args.input).extension().is_some_and(|e| e == "toml");
    if is_scene {
        // what the scene names is an input, too
        scene::load(&args.input)?;
    }
    let known = args.library.as_deref().map(library::files_of).transpose()?.unwrap_or_default();
    let inputs: Vec<&Path> =
        std::iter::once(Path::new(&args.input)).chain(known.iter().map(PathBuf::as_path)).collect();
    args.output.prepare(&inputs, args.points.as_slice())?;
    let format = points_format(args)?;
    // an object that cannot be read is said before the body is cut up
    let models = library::models(&known, &args.output)?;
    let spinner = args.output.spinner(format!("reading {}", args.input));
    let taken = if is_scene { from_scene(args)? } else { spinner.while_reading(|| from_file(args))? };
    spinner.phase(&format!("looking for the parts of {}", args.input));
    let clock = Instant::now();
    let options = PartsOptions { tolerance: args.tolerance, viewpoint: taken.viewpoint, ..PartsOptions::default() };
    if let Some((path, format)) = format {
        let found = in_time(&taken, &options, PointShapes::of, "the shape of every point was known; nothing is kept")?;
        let is_all = args.output.out.is_none() && !args.output.json && known.is_empty();
        if !is_all {
            // an interrupt that comes between this file and the search for parts still says that the file is kept
            interrupt::gently();
        }
        write_atomically(path, &mut |out| write_point_shapes(&taken.contacts, &found, format, out))?;
        if is_all {
            drop(spinner);
            return summary(args, &taken, &found);
        }
    }
    let kept = match format {
        Some((path, _)) => format!("the parts were known; the shape of every point is kept in {}", path.display()),
        None => "the parts were known; nothing is kept".into(),
    };
    let found = in_time(&taken, &options, Parts::of, &kept)?;
    let mut document = document(&taken, &found, clock.elapsed().as_secs_f64());
    if !models.is_empty() {
        document = document.with_objects(found.object(&models, &ObjectPrior::default()));
    }
    drop(spinner);
    let provenance = provenance(&args.input, taken.scene.clone(), taken.seed);
    publish(args, &document, (&taken.contacts, &found), &provenance)
}

/// The answer, beside the truth of a scene.
fn document(taken: &Taken, found: &Parts, seconds: f64) -> PartsDocument {
    let document = PartsDocument::new(&taken.name, found, taken.notes.clone(), seconds);
    let Some((faces, kinds)) = &taken.faces else { return document };
    let agreement: Agreement = against(&taken.contacts, found, faces, kinds.len());
    document.with_truth(&agreement, kinds)
}

/// What `work` makes of the contacts, on a thread of its own: it takes seconds where there are many, and Ctrl-C does not wait.
/// A body is known as a whole or not at all, so that `kept` says what there is where it comes before.
fn in_time<T: Send + 'static>(
    taken: &Taken,
    options: &PartsOptions,
    work: fn(&Contacts, &PartsOptions) -> Result<T, PartsError>,
    kept: &str,
) -> Result<T, Failure> {
    let (contacts, options) = (Arc::clone(&taken.contacts), options.clone());
    interrupt::gently();
    let found = Until::interrupted().wait(move || work(&contacts, &options));
    interrupt::at_once();
    match found {
        Some(found) => found.map_err(|error| refused(taken, &error)),
        None => Err(Failure::Interrupted(format!("interrupted before {kept}"))),
    }
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
        output.file("parts.dot", &mut |out| write_dot(document, out))?;
        output.file("parts.graphml", &mut |out| write_graphml(document, out))?;
        let primitives = trimmed_primitives(found, contacts);
        // a shell without faces is none
        if !primitives.is_empty() {
            output.file("parts.step", &mut |out| write_primitives(&primitives, &args.input, out))?;
        }
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
    output.tell(&mut |out| write_parts_table(document, columns(), out))
}
