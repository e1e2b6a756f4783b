//! `palpate frontier SCENE|INPUT`: what accuracy costs in time, and the configuration that meets a request.
//!
//! ```text
//! candidates -> timed and judged in rounds -> instructions by callgrind -> those that no other beats -> a choice
//! ```

use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;

use crate::frontier::{FrontierError, Request, orders};
use crate::io::scene_file::builtin_text;
use crate::io::write_parquet;
use crate::report::{
    FrontierDocument, OrdersDocument, PICTURES, frontier_columns, has_picture, write_frontier_csv,
    write_frontier_picture, write_frontier_table, write_json, write_orders_table, write_stages_picture,
};

use super::failure::Failure;
use super::options::OutputFlags;
use super::output::print;
use super::{frontier_input, frontier_scene, values};

/// Seconds that the ways of fitting are timed for, where nothing else is said: noisy machines want more.
const SECONDS: f64 = 20.0;

/// Arguments of `palpate frontier`.
#[derive(Args)]
pub(super) struct FrontierArgs {
    /// Built-in scene, scene file (.toml), - for a scene on standard input, or a file of contacts
    #[arg(required_unless_present = "orders")]
    pub(super) subject: Option<String>,
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
    pub(super) emit: Option<PathBuf>,
    /// Leave the number of stations as the scene has it, instead of trying half and twice as many too
    #[arg(long)]
    pub(super) keep_stations: bool,
    /// Seed of the replicates, instead of the scene's
    #[arg(long)]
    pub(super) seed: Option<u64>,
    /// Seconds for timing the ways of fitting
    #[arg(long, value_name = "S", value_parser = values::seconds, default_value_t = SECONDS)]
    pub(super) seconds: f64,
    /// Time the ways of fitting alone: no intervals, no solvers, no stages
    #[arg(long)]
    pub(super) bare: bool,
    /// Leave out the count of instructions
    #[arg(long)]
    pub(super) uncounted: bool,
    /// Measure the order of accuracy of every degree instead, on surfaces that are known
    #[arg(long, conflicts_with_all = ["subject", "error_s", "error_r", "budget", "emit"])]
    orders: bool,
    /// Make every call once for whoever counts
    #[arg(long, hide = true)]
    pub(super) counted: bool,
    #[command(flatten)]
    pub(super) output: OutputFlags,
}

impl FrontierArgs {
    /// What is asked, where anything is.
    pub(super) fn request(&self) -> Result<Option<Request>, Failure> {
        let request = Request {
            error_s: self.error_s,
            error_r: self.error_r,
            budget: self.budget,
            keep_stations: self.keep_stations,
        };
        match request.check() {
            Ok(()) => Ok(Some(request)),
            Err(FrontierError::Empty) if self.emit.is_none() => Ok(None),
            Err(FrontierError::Empty) => {
                let what = "--emit writes what was picked: ask for something by --error-s, --error-r or --budget";
                Err(Failure::Input(what.into()))
            }
            Err(error) => Err(Failure::Input(message(&error))),
        }
    }
}

pub(super) fn frontier(args: &FrontierArgs) -> Result<(), Failure> {
    let began = Instant::now();
    let Some(subject) = &args.subject else { return print_orders(args) };
    let request = args.request()?;
    let is_scene = builtin_text(subject).is_some()
        || subject == "-"
        || Path::new(subject).extension().is_some_and(|e| e.eq_ignore_ascii_case("toml"))
        || !Path::new(subject).exists();
    let found = if is_scene {
        frontier_scene::measure(args, subject, request.as_ref())?
    } else {
        Some(frontier_input::measure(args, subject, request.as_ref())?)
    };
    let Some(mut document) = found else { return Ok(()) };
    document.seconds = began.elapsed().as_secs_f64();
    publish(args, &document)
}

/// An error of the library in the words of this command line.
pub(super) fn message(error: &FrontierError) -> String {
    let text = error.to_string();
    match error {
        FrontierError::Request { what, .. } => text.replacen(what, &format!("--{}", what.replace('_', "-")), 1),
        _ => text,
    }
}

fn publish(args: &FrontierArgs, document: &FrontierDocument) -> Result<(), Failure> {
    args.output.file("frontier.json", &mut |out| write_json(document, out))?;
    args.output.file("frontier.csv", &mut |out| write_frontier_csv(&document.points, out))?;
    if args.output.out.is_some() {
        let (names, columns) = frontier_columns(&document.points);
        args.output.file("frontier.parquet", &mut |out| write_parquet("point", &names, &columns, out))?;
    }
    for which in PICTURES.into_iter().filter(|which| has_picture(document, *which)) {
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
    print(&mut |out| write_frontier_table(document, out))
}

fn print_orders(args: &FrontierArgs) -> Result<(), Failure> {
    let spinner = args.output.spinner("measuring orders of accuracy");
    let document = OrdersDocument::new(&orders());
    drop(spinner);
    if args.output.json {
        return print(&mut |out| write_json(&document, out));
    }
    print(&mut |out| write_orders_table(&document, out))
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
