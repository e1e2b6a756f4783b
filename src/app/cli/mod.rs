//! The command line: arguments in, exit code out. One file per verb.
//!
//! ```text
//! palpate run [SCENE] | simulate SCENE -o F | fit INPUT | study SCENE | frontier SCENE | merge PART... | explore SCENE | diff A B
//! palpate live INPUT|SCENE | parts INPUT|SCENE | explain WORD | scenes [NAME] | show SURFACE [--at POINTS] | completions SHELL | man | help [COMMAND|scene]
//! ```
//!
//! Exit 0 done, 2 bad usage or bad input, 130 on Ctrl-C, 1 anything else; a closed pipe ends quietly.

mod adaptive_model;
mod answer;
mod batch;
mod completions;
mod coverage;
mod coverage_parts;
mod describe;
mod diff;
#[doc(hidden)]
pub mod embedded;
mod embedded_diff;
mod embedded_fits;
mod embedded_live;
mod embedded_plan;
mod embedded_tiles;
mod examples;
mod explain;
mod explicit_model;
mod explore;
mod failure;
mod fit;
mod fit_in_pieces;
mod found;
mod frontier;
mod frontier_args;
mod frontier_beside;
mod frontier_counts;
mod frontier_emit;
mod frontier_input;
mod frontier_measuring;
mod frontier_scene;
mod gathered;
mod help;
mod interrupt;
mod library;
mod live;
mod local_detail;
mod memory;
mod merge;
mod options;
mod output;
mod parts;
mod parts_args;
mod parts_input;
mod pixels;
mod preparation;
mod progress;
mod provenance;
mod reading;
mod recognise_or_fit;
mod rival_parts;
mod run;
mod save;
mod scene;
mod scenes;
mod show;
mod signals;
mod simulate;
mod study;
mod study_plan;
mod sweep;
mod things;
mod time_left;
mod tuned;
mod until;
mod values;
mod viewpoint;
mod zero_weights;

use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};

use failure::Failure;

/// The shape of a curved surface from a few touches, and how far to trust it.
#[derive(Parser)]
#[command(name = "palpate", version, disable_help_subcommand = true)]
#[command(after_help = examples::ALL)]
struct Line {
    /// Compute so that every machine gives the same bits, more slowly (but for results by QR)
    #[arg(long, global = true, hide_short_help = true)]
    portable: bool,
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Subcommand)]
enum Verb {
    /// Touch a simulated world (a scene), fit the contacts and compare with the truth
    #[command(after_help = examples::RUN)]
    Run(Box<run::RunArgs>),
    /// Touch a simulated world and write the contacts into a file
    #[command(after_help = examples::SIMULATE)]
    Simulate(simulate::SimulateArgs),
    /// Tell the shape of your own contacts, or of a grid of heights
    #[command(after_help = examples::FIT)]
    Fit(Box<fit::FitArgs>),
    /// Repeat a simulated measurement thousands of times: how S and R scatter, and which error is to blame
    #[command(after_help = examples::STUDY)]
    Study(Box<study_plan::StudyArgs>),
    /// What accuracy costs in time: ways of fitting a scene or a file, each timed and judged, and the one that meets a request
    #[command(after_help = examples::FRONTIER)]
    Frontier(frontier_args::FrontierArgs),
    /// Join parts of a study that were made with --range, as if they had been one run
    #[command(after_help = examples::MERGE)]
    Merge(merge::MergeArgs),
    /// Touch a simulated world where it tells most, until S and R are known well enough
    #[command(after_help = examples::EXPLORE)]
    Explore(Box<explore::ExploreArgs>),
    /// Answer after every touch while a robot touches, and say what to touch next
    #[command(after_help = examples::LIVE)]
    Live(Box<live::LiveArgs>),
    /// What a body is made of: planes, balls, bars, cones and rings, and how they adjoin
    #[command(after_help = examples::PARTS)]
    Parts(Box<parts_args::PartsArgs>),
    /// Say what a word of the output means
    #[command(after_help = examples::EXPLAIN)]
    Explain(explain::ExplainArgs),
    /// List the built-in scenes, or print one as TOML
    #[command(after_help = examples::SCENES)]
    Scenes(scenes::ScenesArgs),
    /// Describe a saved surface, evaluate it at given points, or write it in another format
    #[command(after_help = examples::SHOW)]
    Show(show::ShowArgs),
    /// Compare two saved surfaces: height, normal, S, R, each against its uncertainty
    #[command(after_help = examples::DIFF)]
    Diff(diff::DiffArgs),
    /// Print what a shell needs to complete commands and options
    #[command(after_help = examples::COMPLETIONS)]
    Completions(completions::CompletionsArgs),
    /// Print the manual page (palpate man | man -l -)
    Man,
    /// Print help on a command, or on scene files (palpate help scene)
    Help(help::HelpArgs),
}

/// The commands and their options, for a test that tries every one of them.
#[doc(hidden)]
pub fn command() -> clap::Command {
    Line::command().term_width(output::columns())
}

/// What was typed.
fn typed() -> Result<Line, clap::Error> {
    let mut command = command();
    let matches = command.try_get_matches_from_mut(std::env::args_os())?;
    Line::from_arg_matches(&matches).map_err(|error| error.format(&mut command))
}

/// Runs the command line of this process.
pub fn main() -> ExitCode {
    let line = match typed() {
        Ok(line) => line,
        Err(error) => {
            let code = ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2));
            return failure::print_usage(&error).map_or_else(Failure::report, |()| code);
        }
    };
    if line.portable {
        palpate_numeric::simd::Isa::force_portable();
    }
    signals::heed();
    let outcome = match line.verb {
        Verb::Run(args) => run::run(&args),
        Verb::Simulate(args) => simulate::simulate(&args),
        Verb::Fit(args) => fit::fit(&args),
        Verb::Study(args) => study::study(&args),
        Verb::Frontier(args) => frontier::frontier(&args),
        Verb::Merge(args) => merge::merge(&args),
        Verb::Explore(args) => explore::explore(&args),
        Verb::Live(args) => live::live(&args),
        Verb::Parts(args) => parts::parts(&args),
        Verb::Explain(args) => explain::explain(&args),
        Verb::Completions(args) => completions::completions(&args),
        Verb::Man => completions::man(),
        Verb::Help(args) => help::help(&args),
        Verb::Scenes(args) => scenes::scenes(&args),
        Verb::Show(args) => show::show(&args),
        Verb::Diff(args) => diff::diff(&args),
    };
    outcome.map_or_else(Failure::report, |()| ExitCode::SUCCESS)
}
