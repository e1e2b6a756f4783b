//! `palpate frontier SCENE`: what accuracy costs in time, and the configuration that meets a request.
//!
//! ```text
//! candidates -> timed and judged in rounds -> instructions by callgrind -> those that no other beats -> a choice
//! ```

use std::path::PathBuf;
use std::time::Instant;

use clap::Args;

use crate::frontier::{
    Choice, Frontier, FrontierError, Measured, REPLICATES, Request, Subject, check_truth, choose, mark,
};
use crate::io::scene_file::SceneFile;
use crate::io::{write_atomically, write_parquet};
use crate::report::{
    AskedPart, FRONTIER_SCHEMA, FrontierDocument, FrontierRecord, PickPart, frontier_columns, inverse_crime_remark,
    write_frontier_csv, write_frontier_table, write_json,
};
use crate::simd::Isa;

use super::failure::Failure;
use super::frontier_counts::{Counts, count, make_calls};
use super::frontier_emit::emitted;
use super::options::OutputFlags;
use super::output::print;
use super::scene;
use super::values;

/// Seconds that the discretisations are timed for, where nothing else is said: noisy machines want more.
const SECONDS: f64 = 30.0;

/// Arguments of `palpate frontier`.
#[derive(Args)]
pub(super) struct FrontierArgs {
    /// Built-in scene, scene file, or - for standard input
    scene: String,
    /// Ask for the cheapest fit whose root mean square error of S stays below this in 95 of 100 runs
    #[arg(long, value_name = "E", value_parser = values::positive)]
    error_s: Option<f64>,
    /// Ask the same of R, in 1/length
    #[arg(long, value_name = "E", value_parser = values::positive)]
    error_r: Option<f64>,
    /// Ask for the most accurate fit within this time, as 50us or 2ms
    #[arg(long, value_name = "TIME", value_parser = values::duration)]
    budget: Option<f64>,
    /// Write the scene with what was picked into this file
    #[arg(long, value_name = "F")]
    emit: Option<PathBuf>,
    /// Leave the number of stations as the scene has it, instead of trying half and twice as many too
    #[arg(long)]
    keep_stations: bool,
    /// Seed of the replicates, instead of the scene's
    #[arg(long)]
    seed: Option<u64>,
    /// Seconds for timing the ways of fitting
    #[arg(long, value_name = "S", value_parser = values::seconds, default_value_t = SECONDS)]
    seconds: f64,
    /// Leave out the calls that compute intervals
    #[arg(long)]
    bare: bool,
    /// Leave out the count of instructions
    #[arg(long)]
    uncounted: bool,
    /// Make every call once for whoever counts
    #[arg(long, hide = true)]
    counted: bool,
    #[command(flatten)]
    output: OutputFlags,
}

impl FrontierArgs {
    fn request(&self) -> Option<Request> {
        let request = Request {
            error_s: self.error_s,
            error_r: self.error_r,
            budget: self.budget,
            keep_stations: self.keep_stations,
        };
        let asked = request.error_s.is_some() || request.error_r.is_some() || request.budget.is_some();
        asked.then_some(request)
    }
}

pub(super) fn frontier(args: &FrontierArgs) -> Result<(), Failure> {
    let began = Instant::now();
    let source = scene::source(&args.scene)?;
    let scene = source.read().map_err(|e| Failure::Input(format!("{}: {e}", source.name)))?;
    let wrong = |error: FrontierError| Failure::Input(format!("{}: {}", scene.name, message(&error)));
    let request = args.request();
    if args.emit.is_some() && request.is_none() {
        let what = "--emit writes what was picked: ask for something by --error-s, --error-r or --budget";
        return Err(Failure::Input(what.into()));
    }
    if let Some(request) = &request {
        request.check().map_err(wrong)?;
    }
    let seed = args.seed.unwrap_or(scene.seed);
    let prepared = |most: u64| {
        let subject = Subject::with_replicates(&scene.world, &scene.fit, seed, !args.keep_stations, most);
        subject.map(|subject| if args.bare { subject.bare() } else { subject }).map_err(wrong)
    };
    if args.counted {
        let subject = prepared(1)?;
        crate::threads::alone(|| make_calls(&mut subject.calls()));
        return Ok(());
    }
    args.output.prepare(&[args.scene.as_ref()], args.emit.as_slice())?;
    let subject = prepared(REPLICATES)?;
    if let Some(request) = &request {
        check_truth(&subject, request).map_err(wrong)?;
    }
    let spinner = args.output.spinner(format!("measuring {}", scene.name));
    let mut measured = subject.measure(args.seconds);
    drop(spinner);
    let spinner = args.output.spinner("counting instructions");
    let counts = counts(args, seed, subject.calls_each() * measured.len());
    drop(spinner);
    take_counts(&mut measured, &counts, subject.calls_each());
    let picked = request.as_ref().map(|request| choose(&measured, request)).transpose().map_err(wrong)?;
    let mut document = document(&scene, seed, &measured, &counts)?;
    if let (Some(choice), Some(request)) = (&picked, &request) {
        let text = emitted(&source, &choice.options, choice.stations)?;
        document.pick = Some(pick_part(choice, request, &text));
        emit(args, &text)?;
    }
    document.seconds = began.elapsed().as_secs_f64();
    publish(args, &document)
}

/// An error of the library in the words of this command line.
fn message(error: &FrontierError) -> String {
    let text = error.to_string();
    match error {
        FrontierError::Request { what, .. } => text.replacen(what, &format!("--{}", what.replace('_', "-")), 1),
        _ => text,
    }
}

fn counts(args: &FrontierArgs, seed: u64, calls: usize) -> Counts {
    if args.uncounted {
        return Err("not counted: --uncounted".into());
    }
    if args.scene == "-" {
        return Err("not counted: standard input cannot be read a second time".into());
    }
    let seed = seed.to_string();
    let mut arguments = vec!["frontier", &args.scene, "--seed", &seed];
    arguments.extend(args.keep_stations.then_some("--keep-stations"));
    arguments.extend(args.bare.then_some("--bare"));
    count(&arguments, calls)
}

fn take_counts(measured: &mut [Measured], counts: &Counts, each: usize) {
    let Ok(counts) = counts else { return };
    for (measured, own) in measured.iter_mut().zip(counts.chunks_exact(each)) {
        measured.point.instructions = own.first().copied();
        measured.point.instructions_interval = own.get(1).copied();
    }
    mark(measured);
}

fn document(scene: &SceneFile, seed: u64, measured: &[Measured], counts: &Counts) -> Result<FrontierDocument, Failure> {
    let record = |m: &Measured| FrontierRecord::new(Frontier::Discretisation, &scene.name, &m.point);
    let simulator = scene.world.compile().map_err(|e| Failure::Input(format!("{}: {e}", scene.name)))?;
    Ok(FrontierDocument {
        schema: FRONTIER_SCHEMA,
        scene: scene.name.clone(),
        reference: "the scene's truth".into(),
        seed,
        build: env!("CARGO_PKG_VERSION").into(),
        isa: Isa::active().name().into(),
        threads: 1,
        counter: match counts {
            Ok(_) => "callgrind, over one call of the first replicate (AVX2 path)".into(),
            Err(why) => why.clone(),
        },
        points: measured.iter().map(record).collect(),
        stages: Vec::new(),
        pick: None,
        notes: inverse_crime_remark(&simulator.truth()).into_iter().collect(),
        seconds: 0.0,
    })
}

fn pick_part(choice: &Choice, request: &Request, text: &str) -> PickPart {
    let finite = |error: f64| error.is_finite().then_some(error);
    PickPart {
        label: choice.label.clone(),
        error_S: finite(choice.errors[0]),
        error_R: finite(choice.errors[1]),
        seconds: choice.seconds,
        asked: AskedPart { error_S: request.error_s, error_R: request.error_r, budget: request.budget },
        met: choice.met,
        obstacle: choice.obstacle.clone(),
        scene: Some(text.into()),
    }
}

fn emit(args: &FrontierArgs, text: &str) -> Result<(), Failure> {
    let Some(path) = &args.emit else { return Ok(()) };
    Ok(write_atomically(path, &mut |out| out.write_all(text.as_bytes()))?)
}

fn publish(args: &FrontierArgs, document: &FrontierDocument) -> Result<(), Failure> {
    args.output.file("frontier.json", &mut |out| write_json(document, out))?;
    args.output.file("frontier.csv", &mut |out| write_frontier_csv(&document.points, out))?;
    if args.output.out.is_some() {
        let (names, columns) = frontier_columns(&document.points);
        args.output.file("frontier.parquet", &mut |out| write_parquet("point", &names, &columns, out))?;
    }
    args.output.publish()?;
    if args.output.json {
        return print(&mut |out| write_json(document, out));
    }
    if args.output.quiet {
        return Ok(());
    }
    print(&mut |out| write_frontier_table(document, out))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_names_the_flag() {
        let error = FrontierError::Request { what: "error_s", value: "-1".into(), expected: "more".into() };
        assert_eq!(message(&error), "--error-s is -1: more");
    }
}
