//! `palpate frontier SCENE|INPUT`: what accuracy costs in time, and the configuration that meets a request.
//!
//! ```text
//! candidates -> timed and judged in rounds -> [instructions by callgrind] -> a few rows, one to take, and a choice
//! ```

use std::io::Write;
use std::path::Path;
use std::time::Instant;

use crate::io::scene_file::builtin_text;
use crate::io::write_parquet;
use crate::report::{
    FrontierDocument, KINDS, OrdersDocument, frontier_columns, has_picture, write_frontier_csv, write_frontier_page,
    write_frontier_picture, write_frontier_table, write_json, write_orders_table, write_stages_picture,
};
use palpate_studies::frontier::orders;

use super::failure::Failure;
use super::frontier_args::FrontierArgs;
use super::frontier_beside::beside;
use super::output::{columns, print};
use super::provenance::provenance;
use super::{frontier_input, frontier_scene, interrupt, scene};

pub(super) fn frontier(args: &FrontierArgs) -> Result<(), Failure> {
    let began = Instant::now();
    let Some(subject) = &args.subject else { return print_orders(args) };
    let request = args.request()?;
    let source = if is_scene(subject) { Some(scene::source(subject)?) } else { None };
    // before anything is measured, so that a wrong file is heard of at once
    let beside = match (&args.beside, &source) {
        (None, _) => Vec::new(),
        (Some(file), Some(source)) => beside(file, subject, &source.scene()?.name)?,
        (Some(file), None) => beside(file, subject, subject)?,
    };
    let found = match &source {
        Some(source) => frontier_scene::measure(args, subject, source, request.as_ref(), &|_, _| true)?,
        None => {
            check_file(args, subject)?;
            Some(frontier_input::measure(args, subject, request.as_ref(), &|_, _| true)?)
        }
    };
    let Some(mut document) = found else { return Ok(()) };
    document.beside = beside;
    document.seconds = began.elapsed().as_secs_f64();
    publish(args, &document)?;
    if interrupt::asked() {
        let points = document.points.len();
        return Err(Failure::Interrupted(format!("interrupted after {points} points were measured; these are kept")));
    }
    Ok(())
}

/// Nothing is typed that means something for scenes alone.
fn check_file(args: &FrontierArgs, file: &str) -> Result<(), Failure> {
    let typed = [
        (args.keep_stations, "--keep-stations", "measured contacts stay as they are"),
        (args.seed.is_some(), "--seed", "nothing is drawn"),
        (args.stages, "--stages", "the stages of a fit are timed on simulated contacts"),
        (args.count.is_some(), "--count", "the calls of a scene alone are counted"),
    ];
    match typed.iter().find(|(typed, _, _)| *typed) {
        Some((_, option, why)) => {
            Err(Failure::Input(format!("{option} is for scenes, and {file} is a file of contacts: {why}")))
        }
        None => Ok(()),
    }
}

/// Whether this names a scene; otherwise it is a file of contacts.
pub(super) fn is_scene(subject: &str) -> bool {
    builtin_text(subject).is_some()
        || subject == "-"
        || Path::new(subject).extension().is_some_and(|e| e.eq_ignore_ascii_case("toml"))
        || !Path::new(subject).exists()
}

fn publish(args: &FrontierArgs, document: &FrontierDocument) -> Result<(), Failure> {
    let provenance = provenance(&document.scene, None, Some(document.seed));
    args.output.file("report.html", &mut |out| write_frontier_page(document, &provenance, out))?;
    args.output.file("frontier.json", &mut |out| write_json(document, out))?;
    args.output.file("frontier.csv", &mut |out| write_frontier_csv(&document.points, out))?;
    if args.output.out.is_some() {
        let (names, columns) = frontier_columns(&document.points);
        args.output.file("frontier.parquet", &mut |out| write_parquet("point", &names, &columns, out))?;
    }
    for which in KINDS.into_iter().filter(|which| has_picture(document, *which)) {
        let name = if which.frontier == "discretisation" { "frontier" } else { which.frontier };
        for (ending, png) in [("svg", false), ("png", true)] {
            let mut fill = |out: &mut dyn Write| write_frontier_picture(document, which, png, out);
            args.output.file(&format!("{name}.{ending}"), &mut fill)?;
        }
    }
    if !document.stages.is_empty() {
        args.output.file("stages.svg", &mut |out| write_stages_picture(document, false, out))?;
        args.output.file("stages.png", &mut |out| write_stages_picture(document, true, out))?;
    }
    args.output.publish()?;
    if args.output.json {
        return print(&mut |out| write_json(document, out));
    }
    if args.output.quiet {
        return Ok(());
    }
    args.output.tell(&mut |out| write_frontier_table(document, args.all, columns(), out))
}

fn print_orders(args: &FrontierArgs) -> Result<(), Failure> {
    let spinner = args.output.spinner("measuring orders of accuracy");
    let document = OrdersDocument::new(&orders());
    drop(spinner);
    if args.output.json {
        return print(&mut |out| write_json(&document, out));
    }
    if args.output.quiet {
        return Ok(());
    }
    print(&mut |out| write_orders_table(&document, out))
}
