//! The frontier of measured contacts, judged by contacts that were left out.

use std::path::Path;
use std::time::Instant;

use crate::io::{Input, ReadOptions, read_input};
use crate::report::{FrontierDocument, FrontierRecord};
use palpate_fitting::fit::FitOptions;
use palpate_geometry::contact::Contacts;
use palpate_studies::frontier::{Frontier, FrontierError, Measured, Request, Watch, choose, held_out};

use super::failure::Failure;
use super::frontier_args::{FrontierArgs, message};
use super::frontier_scene::{done_share, empty_document, pick_part};

/// The document of a file of contacts.
pub(super) fn measure(
    args: &FrontierArgs,
    file: &str,
    request: Option<&Request>,
    watch: Watch<'_>,
) -> Result<FrontierDocument, Failure> {
    check(args, file, request)?;
    args.output.prepare(&[Path::new(file)], &[])?;
    let spinner = args.output.spinner(format!("reading {file}"));
    let reading = spinner.while_reading(|| read_input(Path::new(file), &ReadOptions::default()))?;
    spinner.phase(&format!("measuring {file}"));
    let Input::Contacts(contacts) = &reading.input else {
        return Err(Failure::Input(format!(
            "{file}: a grid cannot be judged by pixels that were left out, which its neighbours nearly repeat; a frontier needs contacts or a scene"
        )));
    };
    let began = Instant::now();
    let told = |done: usize, all: usize| {
        spinner.part((100.0 * done_share(began, args.seconds, [done, all])) as usize, 100);
        watch(done, all)
    };
    let measured = judged(args, &reading.file, contacts, &told)?;
    drop(spinner);
    document(&reading.file, &measured, request)
}

/// The document of contacts that are there already, under this name.
pub(super) fn measure_contacts(
    args: &FrontierArgs,
    name: &str,
    contacts: &Contacts,
    request: Option<&Request>,
    watch: Watch<'_>,
) -> Result<FrontierDocument, Failure> {
    check(args, name, request)?;
    // a reader of files checks what it reads
    contacts.check().map_err(|error| Failure::Input(format!("{name}: {error}")))?;
    document(name, &judged(args, name, contacts, watch)?, request)
}

/// Nothing is asked that needs a truth or a scene.
fn check(args: &FrontierArgs, file: &str, request: Option<&Request>) -> Result<(), Failure> {
    if request.is_some_and(|request| request.error_s.is_some() || request.error_r.is_some()) {
        let what = "the true S and R of measured contacts are unknown, so that no error of theirs can be asked for; \
             --budget can, and a scene like this one (palpate scenes) knows its truth";
        return Err(Failure::Input(format!("{file}: {what}")));
    }
    if args.emit.is_some() {
        let what =
            "--emit writes a scene, and this is a file of contacts: the picked line says what to give palpate fit";
        return Err(Failure::Input(format!("{file}: {what}")));
    }
    Ok(())
}

fn judged(args: &FrontierArgs, name: &str, contacts: &Contacts, watch: Watch<'_>) -> Result<Vec<Measured>, Failure> {
    held_out(contacts, &FitOptions::default(), args.seconds, watch).map_err(|error| wrong(name, &error))
}

fn document(name: &str, measured: &[Measured], request: Option<&Request>) -> Result<FrontierDocument, Failure> {
    let record = |m: &Measured| FrontierRecord::new(Frontier::Discretisation, name, &m.point);
    let mut document = FrontierDocument {
        scene: name.into(),
        reference: "contacts left out, a fifth at a time".into(),
        counter: "not counted: only the calls of a scene are".into(),
        points: measured.iter().map(record).collect(),
        notes: vec![
            "error is that of the height at contacts left out, their noise included; S and R have no truth here".into(),
        ],
        ..empty_document()
    };
    if let Some(request) = request {
        let choice = choose(measured, request).map_err(|error| wrong(name, &error))?;
        document.pick = Some(pick_part(&choice, request, None));
    }
    Ok(document)
}

fn wrong(name: &str, error: &FrontierError) -> Failure {
    Failure::Input(format!("{name}: {}", message(error)))
}
