//! Arguments of `palpate frontier`, and the request in them.

use std::path::PathBuf;

use clap::Args;

use palpate_studies::frontier::{FrontierError, Request};

use super::failure::Failure;
use super::options::OutputFlags;
use super::values;

/// Seconds that the ways of fitting are timed for, where nothing else is said: with what comes before and after, an answer in 20 s.
const SECONDS: f64 = 18.0;

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
    /// Leave the number of stations as the scene has it: a request, --all and --count try half and twice as many too
    #[arg(long)]
    pub(super) keep_stations: bool,
    /// Seed of the replicates, instead of the scene's
    #[arg(long)]
    pub(super) seed: Option<u64>,
    /// Seconds for timing the ways of fitting
    #[arg(long, value_name = "S", value_parser = values::seconds, default_value_t = SECONDS)]
    pub(super) seconds: f64,
    /// Print every way that no other beats; of a scene also the ways to solve the equations and to an interval
    #[arg(long)]
    pub(super) all: bool,
    /// Draw and list what other programs do with the same scene, from a file like frontier.json
    #[arg(long, value_name = "F")]
    pub(super) beside: Option<PathBuf>,
    /// Say where the time of a fit and of a replicate goes
    #[arg(long)]
    pub(super) stages: bool,
    /// Count instructions by valgrind, for so many seconds [default: those of --seconds]
    #[arg(long, value_name = "S", value_parser = values::seconds, num_args = 0..=1, require_equals = true)]
    pub(super) count: Option<Option<f64>>,
    /// Measure the order of accuracy of every degree instead, on surfaces that are known
    #[arg(long, conflicts_with_all = ["subject", "error_s", "error_r", "budget",
          "emit", "keep_stations", "seed", "seconds", "all", "beside", "stages", "count", "out"])]
    pub(super) orders: bool,
    /// Make every call once for whoever counts
    #[arg(long, hide = true)]
    pub(super) counted: bool,
    #[command(flatten)]
    pub(super) output: OutputFlags,
}

impl FrontierArgs {
    /// Seconds that instructions are counted for, where they are.
    pub(super) fn counting_seconds(&self) -> Option<f64> {
        self.count.map(|seconds| seconds.unwrap_or(self.seconds))
    }

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

/// An error of the library in the words of this command line.
pub(super) fn message(error: &FrontierError) -> String {
    let text = error.to_string();
    match error {
        FrontierError::Request { what, .. } => text.replacen(what, &format!("--{}", what.replace('_', "-")), 1),
        _ => text,
    }
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
