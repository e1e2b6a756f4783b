//! `palpate run [SCENE]`: sweep, fit and describe one scene, with the truth beside it. A scene that names no model is
//! recognised as `palpate fit` recognises its contacts.

use std::path::PathBuf;
use std::time::Instant;

use clap::Args;

use crate::io::Input;
use crate::io::scene_file::SceneFile;
use crate::report::{Subject, inverse_crime_remark};
use palpate_fitting::fit::FitOptions;
use palpate_world::scene::surface::Body;

use super::adaptive_model::AdaptiveFlags;
use super::answer::{Question, answer, as_named};
use super::describe::{Destination, Taken, describe};
use super::failure::{Failure, fit_message};
use super::found::{Found, Refusal};
use super::options::{FitFlags, OutputFlags, WordsFlags};
use super::provenance::provenance;
use super::save::check_name;
use super::scene;

/// Arguments of `palpate run`.
#[derive(Args)]
pub(super) struct RunArgs {
    /// Built-in scene, scene file, or - for standard input
    #[arg(default_value = scene::DEFAULT)]
    scene: String,
    /// Save the surface, in the format of the ending: .json, .step, .ply and others
    ///
    /// .json has all that is known of it; .step, .igs, .npz a spline; .ply, .obj, .stl, .glb, .vtu a mesh, .parquet its points, of --grid points each way [default: 49x49]
    #[arg(long, value_name = "F")]
    save: Option<PathBuf>,
    /// Leave out certificate, uncertainties and intervals, which can take longer than the fit; for a named model
    #[arg(long, hide_short_help = true)]
    bare: bool,
    #[command(flatten)]
    adaptive: AdaptiveFlags,
    #[command(flatten)]
    fit: FitFlags,
    #[command(flatten)]
    words: WordsFlags,
    #[command(flatten)]
    output: OutputFlags,
}

pub(super) fn run(args: &RunArgs) -> Result<(), Failure> {
    let began = Instant::now();
    if args.output.json && args.save.as_ref().is_some_and(|path| path.as_os_str() == "-") {
        return Err(Failure::Input("--save - and --json both want standard output; give --save a file".into()));
    }
    let (scene, text) = scene::load_with_text(&args.scene)?;
    args.output.prepare(&[args.scene.as_ref()], args.save.as_slice())?;
    check_name(args.save.as_deref())?;
    let spinner = args.output.spinner(format!("running {}", scene.name));
    let wrong = |what: String| Failure::Input(format!("{}: {what}", scene.name));
    let simulator = scene.world.compile().map_err(|e| wrong(e.to_string()))?;
    let (reached, asked) = simulator.reach();
    let (contacts, truth) = simulator.into_contacts(scene.seed, 0);
    let read = began.elapsed().as_secs_f64();
    let input = Input::Contacts(contacts);
    let clock = Instant::now();
    let Found { answer: found, chosen, lack_of_fit, notes: own } =
        found_in(&input, &scene, args).map_err(|e| match e {
            Refusal::Fit(error) => wrong(format!("{}{}", fit_message(&error), several_faces(&scene, "; "))),
            Refusal::Shape(message) => wrong(message),
            Refusal::Several(things) => wrong(things.message),
        })?;
    let fitted = clock.elapsed().as_secs_f64();
    let mut notes = own;
    if reached < asked {
        notes.push(format!("{reached} of {asked} sites are within reach of the surface"));
    }
    notes.extend(Some(several_faces(&scene, "")).filter(|words| !words.is_empty()));
    notes.extend(inverse_crime_remark(&truth));
    notes.extend(args.fit.without_effect(&found, &input));
    let subject = Subject {
        chosen,
        lack_of_fit,
        input: &input,
        unit: args.words.unit.clone(),
        truth: Some(&truth),
        bare: args.bare,
        notes,
    };
    drop(spinner);
    let taken = Taken { began, read, fitted };
    describe(
        &found,
        &scene.name,
        &subject,
        &taken,
        &Destination {
            output: &args.output,
            words: &args.words,
            save: args.save.as_ref(),
            grid: args.fit.typed_grid(),
            provenance: provenance(&args.scene, Some(text), Some(scene.seed)),
        },
    )
}

/// The model that the scene names, with what was typed over it; without one what `fit` finds in the same contacts.
fn found_in(input: &Input, scene: &SceneFile, args: &RunArgs) -> Result<Found, Refusal> {
    if scene.names_a_model && !args.adaptive.adaptive {
        return as_named(input, &args.fit.over(scene.fit.clone()), args.bare);
    }
    // weights are of the scene's own model alone
    let base = FitOptions { objective: FitOptions::default().objective, ..scene.fit.clone() };
    answer(input, &Question { flags: &args.fit, adaptive: &args.adaptive, base, bare: args.bare, viewpoint: None })
}

/// What to do with a body of several faces, which one patch rounds off; after `join`. Nothing for other surfaces.
fn several_faces(scene: &SceneFile, join: &str) -> String {
    match scene.world.surface.body {
        Body::Solids(_) => format!("{join}a body of several faces is taken apart by palpate parts"),
        _ => String::new(),
    }
}
