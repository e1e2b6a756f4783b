//! The frontier of measured contacts, judged by contacts that were left out.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use crate::io::{Input, ReadOptions, read_input};
use crate::report::{FrontierDocument, FrontierRecord};
use palpate_fitting::fit::FitOptions;
use palpate_geometry::contact::Contacts;
use palpate_studies::frontier::{Frontier, FrontierError, HeldOut, Measured, Request, Watch, choose};

use super::failure::Failure;
use super::frontier_args::{FrontierArgs, message};
use super::frontier_measuring::{measured, nothing_yet, unreached};
use super::frontier_scene::{done_share, pick_part, shown_first};
use super::interrupt;
use super::until::Until;

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
    interrupt::gently();
    let document = judged(args, &reading.file, contacts, request, &told)?;
    drop(spinner);
    document.ok_or_else(nothing_yet)
}

/// The document of contacts that are there already, under this name; `None` where the watch ended it.
pub(super) fn measure_contacts(
    args: &FrontierArgs,
    name: &str,
    contacts: &Contacts,
    request: Option<&Request>,
    watch: Watch<'_>,
) -> Result<Option<FrontierDocument>, Failure> {
    check(args, name, request)?;
    // a reader of files checks what it reads
    contacts.check().map_err(|error| Failure::Input(format!("{name}: {error}")))?;
    judged(args, name, contacts, request, watch)
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

/// The document of these contacts; `None` where the watch ended it.
fn judged(
    args: &FrontierArgs,
    name: &str,
    contacts: &Contacts,
    request: Option<&Request>,
    watch: Watch<'_>,
) -> Result<Option<FrontierDocument>, Failure> {
    let subject = HeldOut::new(contacts, &FitOptions::default()).map_err(|error| wrong(name, &error))?;
    let (ledger, seconds) = (Arc::new(subject.ledger()), args.seconds);
    let subject = Arc::new(subject);
    let (own, entered) = (Arc::clone(&subject), Arc::clone(&ledger));
    // the ledger holds what there is, whether or not it came to an end
    let _ = measured(Until::interrupted(), watch, move |watch| own.measure_into(&entered, seconds, watch));
    let found = subject.measured(&ledger);
    // whoever watches wants all or nothing
    if !watch(1, 1) {
        return Ok(None);
    }
    let note = unreached(seconds, found.len(), subject.ways())?;
    let mut document = document(name, &found, request)?;
    document.notes.extend(note);
    Ok(Some(document))
}

fn document(name: &str, measured: &[Measured], request: Option<&Request>) -> Result<FrontierDocument, Failure> {
    let record = |m: &Measured| FrontierRecord::new(Frontier::Discretisation, name, &m.point);
    let mut document = FrontierDocument {
        scene: name.into(),
        reference: "contacts left out, a fifth at a time".into(),
        counter: "not counted: only the calls of a scene are".into(),
        points: measured.iter().map(record).collect(),
        ..shown_first(measured, false)
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
