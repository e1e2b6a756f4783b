//! `palpate run [SCENE]`: sweep, fit and describe one scene, with the truth beside the answer.

use std::path::PathBuf;
use std::time::Instant;

use clap::Args;

use crate::fit::fit_contacts;
use crate::io::{ContactFormat, write_contacts};
use crate::report::Seconds;

use super::describe::{deliver, document};
use super::failure::Failure;
use super::fit::in_frame;
use super::options::{FitFlags, OutputFlags};
use super::scene;

/// Arguments of `palpate run`.
#[derive(Args)]
pub(super) struct RunArgs {
    /// Built-in scene, scene file, or - for standard input
    #[arg(default_value = scene::DEFAULT)]
    scene: String,
    #[command(flatten)]
    flags: FitFlags,
    /// Save the surface (and the whole document) as JSON; - for standard output
    #[arg(long, value_name = "SURFACE.json")]
    save: Option<PathBuf>,
    #[command(flatten)]
    output: OutputFlags,
}

pub(super) fn run(args: &RunArgs) -> Result<(), Failure> {
    let start = Instant::now();
    if args.output.json && args.save.as_ref().is_some_and(|path| path.as_os_str() == "-") {
        return Err(Failure::Input("--save - and --json both want standard output; give --save a file".into()));
    }
    let scene = scene::load(&args.scene)?;
    let named = |e: &dyn std::fmt::Display| Failure::Input(format!("{}: {e}", scene.name));
    args.output.prepare()?;
    let simulator = scene.world.compile().map_err(|e| named(&e))?;
    let (contacts, truth) = simulator.simulate(scene.seed, 0);
    let read = start.elapsed().as_secs_f64();
    let fit = fit_contacts(&contacts, &args.flags.over(scene.fit.clone())).map_err(|e| named(&e))?;
    let fitted = start.elapsed().as_secs_f64();
    fit.shape();
    let total = start.elapsed().as_secs_f64();
    let notes = truth.inverse_crime().map(|label| format!("inverse crime: {label}")).into_iter().collect();
    let seconds = Seconds { read, fit: fitted - read, shape: total - fitted, total };
    let document = document(&fit, contacts.len(), Some(&truth), notes, seconds)?;
    args.output.file("contacts.csv", &mut |out| write_contacts(&contacts, ContactFormat::Csv, out))?;
    let (x, y) = in_frame(&fit, &contacts);
    deliver(&scene.name, &document, fit.shape(), Some((&x, &y)), &args.output, args.save.as_deref())
}
