//! `palpate simulate SCENE -o F`: the contacts of a scene and nothing else; `--explain`: what the scene consists of.

use std::io::Write;
use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use serde::Serialize;

use crate::io::{ContactFormat, visible, write_atomically, write_contacts};
use crate::report::{inverse_crime_remark, write_json};
use palpate_world::scene::{ContactBatch, Simulator, explain};

use super::failure::Failure;
use super::options::OutputFlags;
use super::output::print;
use super::scene;

/// Arguments of `palpate simulate`.
#[derive(Args)]
pub(super) struct SimulateArgs {
    /// Built-in scene, scene file, or - for standard input
    scene: String,
    /// Where the contacts go: F.csv, F.npz, F.ply, or - for CSV on standard output
    #[arg(short = 'o', long = "output", value_name = "F", required_unless_present_any = ["out", "explain"])]
    to: Option<PathBuf>,
    /// Print the stages that the scene compiles to, with draws and measured time per contact
    #[arg(long, conflicts_with = "json")]
    explain: bool,
    #[command(flatten)]
    output: OutputFlags,
}

#[derive(Serialize)]
struct SimulateDocument<'a> {
    schema: &'static str,
    scene: &'a str,
    seed: u64,
    contacts: usize,
    files: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    note: Option<&'a str>,
}

pub(super) fn simulate(args: &SimulateArgs) -> Result<(), Failure> {
    let to_stdout = args.to.as_ref().is_some_and(|to| to.as_os_str() == "-");
    if to_stdout && args.output.json {
        return Err(Failure::Input("-o - and --json both want standard output; give -o a file".into()));
    }
    if to_stdout && args.explain {
        return Err(Failure::Input("-o - and --explain both want standard output; give -o a file".into()));
    }
    // the name is wrong before the work is done, not after
    let format = args.to.as_deref().map(ContactFormat::of).transpose()?;
    let scene = scene::load(&args.scene)?;
    args.output.prepare(&[args.scene.as_ref()], args.to.as_slice())?;
    let simulator = scene.world.compile().map_err(|e| Failure::Input(format!("{}: {e}", scene.name)))?;
    if args.explain && !args.output.quiet {
        let text = explain::table(&simulator, &stage_times(&simulator, scene.seed));
        print(&mut |out| out.write_all(text.as_bytes()))?;
    }
    let (contacts, truth) = simulator.into_contacts(scene.seed, 0);
    let remark = inverse_crime_remark(&truth);
    let remark = remark.as_deref();
    let mut files = Vec::new();
    if let (Some(to), Some(format)) = (&args.to, format) {
        write_atomically(to, &mut |out| write_contacts(&contacts, format, remark, out))?;
        files.push(to.display().to_string());
    }
    if let Some(directory) = &args.output.out {
        args.output.file("contacts.csv", &mut |out| write_contacts(&contacts, ContactFormat::Csv, remark, out))?;
        args.output.publish()?;
        files.push(directory.join("contacts.csv").display().to_string());
    }
    if args.output.json {
        let (schema, contacts, seed) = ("palpate.simulate/1", contacts.len(), scene.seed);
        let document = SimulateDocument { schema, scene: &scene.name, seed, contacts, files, note: remark };
        return print(&mut |out| write_json(&document, out));
    }
    if let (Some(remark), false) = (remark, args.output.quiet) {
        // standard output may be the contacts themselves
        let _ = writeln!(std::io::stderr(), "palpate: {remark}");
    }
    if !args.output.quiet && !to_stdout {
        return print(&mut |out| {
            let told =
                |file: &String| writeln!(out, "{} contacts of {} in {}", contacts.len(), scene.name, visible(file));
            files.iter().try_for_each(told)
        });
    }
    Ok(())
}

/// Replicates that are timed together: as many as in a study, and enough for a clock.
const TIMED_REPLICATES: usize = 64;
/// How often each stage is timed; the fastest run counts.
const TIMED_RUNS: usize = 9;

/// Nanoseconds per contact of each stage, on the contacts that the stages before it made.
fn stage_times(simulator: &Simulator, seed: u64) -> Vec<f64> {
    let mut batch = ContactBatch::default();
    simulator.unchanged_batch(0, TIMED_REPLICATES, &mut batch);
    let entries = (batch.contacts() * TIMED_REPLICATES) as f64;
    let timed = (0..simulator.stage_names().len()).map(|stage| {
        let mut fastest = f64::INFINITY;
        let mut after = batch.clone();
        for _ in 0..TIMED_RUNS {
            after = batch.clone();
            let start = Instant::now();
            simulator.run_stage(stage, seed, &mut after);
            fastest = fastest.min(start.elapsed().as_secs_f64());
        }
        batch = after;
        fastest * 1e9 / entries
    });
    timed.collect()
}
