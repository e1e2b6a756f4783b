//! `palpate explore SCENE`: sweep, fit, plan, touch, until S and R are known well enough.

use std::sync::{Arc, Mutex};
use std::time::Instant;

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};

use crate::io::scene_file::SceneFile;
use crate::io::{ContactFormat, Input, write_contacts};
use crate::report::{
    Description, ExploreDocument, compute_shape, inverse_crime_remark, significant, write_explore_csv,
    write_explore_page, write_explore_picture, write_explore_table, write_json,
};
use palpate_fitting::fit::{FitOptions, SurfaceKind};
use palpate_geometry::contact::Contacts;
use palpate_inference::recognition::{Estimate, RecognitionOptions};
use palpate_studies::explore::{Exploration, ExploreError, ExploreOptions, Goal, Look, Strategy, explore as explored};
use palpate_world::scene::World;

use super::answer::{as_named, described};
use super::failure::Failure;
use super::found::{Found, Refusal};
use super::interrupt;
use super::options::{FitFlags, OutputFlags, PictureFlags};
use super::output::{columns, print};
use super::progress::Bar;
use super::provenance::provenance;
use super::recognise_or_fit::automatic;
use super::scene;
use super::until::{Until, held};
use super::values;

/// Arguments of `palpate explore`.
#[derive(Args)]
pub(super) struct ExploreArgs {
    /// Built-in scene, scene file, or - for standard input; its own sweep comes first
    pub(super) scene: String,
    /// How touches are chosen
    #[arg(long, default_value = "shape", value_parser = strategy(), value_name = "NAME")]
    strategy: Strategy,
    /// Most contacts, those of the first sweep among them
    #[arg(long, default_value_t = 60, value_parser = clap::value_parser!(u32).range(1..=10_000), value_name = "N")]
    pub(super) contacts: u32,
    /// Stop when the standard uncertainty of S, in all, is at most this; R follows by --u-r
    #[arg(long, value_parser = positive, value_name = "U", allow_hyphen_values = true, requires = "u_r")]
    u_s: Option<f64>,
    /// Stop when the standard uncertainty of R, in all, is at most this share of R; S follows by --u-s
    #[arg(long, value_parser = positive, value_name = "SHARE", allow_hyphen_values = true, requires = "u_s")]
    u_r: Option<f64>,
    /// Touches between two looks at S and R
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=1000), value_name = "N")]
    per_round: u32,
    /// Plan whole lines of a finger instead of single touches (variance and shape)
    #[arg(long)]
    lines: bool,
    /// Where touches may be made; default: the rectangle of the first sweep
    #[arg(long, value_parser = values::domain, value_name = "X0,X1,Y0,Y1", allow_hyphen_values = true)]
    reach: Option<[f64; 4]>,
    /// Seed in place of the scene's
    #[arg(long)]
    seed: Option<u64>,
    /// Level of the intervals
    #[arg(long, value_parser = values::level)]
    level: Option<f64>,
    #[command(flatten)]
    fit: FitFlags,
    #[command(flatten)]
    pictures: PictureFlags,
    #[command(flatten)]
    output: OutputFlags,
}

/// A strategy by its name; clap proposes the nearest one.
fn strategy() -> impl TypedValueParser<Value = Strategy> {
    let known = |word: String| Strategy::WORDS.iter().find(|(w, _)| *w == word).map(|(_, strategy)| *strategy);
    PossibleValuesParser::new(Strategy::WORDS.map(|(word, _)| word))
        .try_map(move |word| known(word).ok_or("no strategy"))
}

fn positive(text: &str) -> Result<f64, String> {
    let number = text.trim().parse::<f64>().ok().filter(|v| *v > 0.0 && v.is_finite());
    number.ok_or_else(|| "a positive number, such as 0.01".into())
}

impl ExploreArgs {
    fn options(&self, seed: u64, level: f64) -> Result<ExploreOptions, Failure> {
        let model = self.fit.names_a_model().then(|| self.fit.over(FitOptions::default()));
        if model.as_ref().is_some_and(|model| model.surface != SurfaceKind::Height) {
            let what = "--surface: touches are planned over x and y, by a height field; leave it out";
            return Err(Failure::Input(what.into()));
        }
        Ok(ExploreOptions {
            strategy: self.strategy,
            contacts: self.contacts as usize,
            goal: self.u_s.zip(self.u_r).map(|(u_s, u_r)| Goal { u_s, u_r }),
            per_round: self.per_round as usize,
            lines: self.lines,
            seed: self.seed.unwrap_or(seed),
            reach: self.reach,
            level: self.level.unwrap_or(level),
            recognition: self.recognition(),
            model,
        })
    }

    /// How contacts are recognised where no model is named.
    fn recognition(&self) -> RecognitionOptions {
        let typed = self.fit.over(FitOptions::default());
        RecognitionOptions {
            grid: typed.grid,
            inset: typed.inset,
            sigma_xy: typed.sigma_xy,
            ..RecognitionOptions::default()
        }
    }

    /// What changes nothing under this strategy.
    fn without_effect(&self) -> Option<String> {
        let plans = matches!(self.strategy, Strategy::Shape | Strategy::Variance);
        (self.lines && !plans).then(|| format!("--lines changes nothing for {}", self.strategy.name()))
    }
}

pub(super) fn explore(args: &ExploreArgs) -> Result<(), Failure> {
    let (scene, text) = scene::load_with_text(&args.scene)?;
    args.output.prepare(&[args.scene.as_ref()], &[])?;
    let options = args.options(scene.seed, scene.fit.level)?;
    let found = play_until_interrupted(args, &scene, &options)?;
    let input = Arc::new(Input::Contacts(found.contacts.clone()));
    let (own, asked, typed) = (Arc::clone(&input), options.clone(), args.fit.over(FitOptions::default()));
    let answer = Until::interrupted().wait(move || answer_of(&own, &asked, &typed));
    let answer = answer.unwrap_or_else(|| Err(LEFT_OUT.into()));
    let described =
        answer.as_ref().map_err(Clone::clone).and_then(|(found, taken)| described(found, &input, *taken, Vec::new()));
    let document = document(args, &scene, (&options, &found, &input), (&answer, &described));
    let surface = described.ok();
    let provenance = provenance(&args.scene, Some(text), Some(options.seed));
    args.output.file("report.html", &mut |out| write_explore_page(&document, surface.as_ref(), &provenance, out))?;
    let remark = inverse_crime_remark(&found.truth);
    args.output.file("explore.json", &mut |out| write_json(&document, out))?;
    args.output.file("explore.csv", &mut |out| write_explore_csv(&document, out))?;
    args.pictures.write(&args.output, "explore", &|format, out| write_explore_picture(&document, format, out))?;
    args.output
        .file("contacts.csv", &mut |out| write_contacts(&found.contacts, ContactFormat::Csv, remark.as_deref(), out))?;
    args.output.publish()?;
    if args.output.json {
        print(&mut |out| write_json(&document, out))?;
        return ended(&document);
    }
    if args.output.quiet {
        return ended(&document);
    }
    args.output.tell(&mut |out| write_explore_table(&document, columns(), out))?;
    ended(&document)
}

/// The same for a program that wants no files: the document, and the contacts.
pub(super) fn explore_in_memory(
    args: &ExploreArgs,
    scene: &SceneFile,
    seen: impl FnMut(&Look) -> bool,
) -> Result<(ExploreDocument, Contacts), Failure> {
    let options = args.options(scene.seed, scene.fit.level)?;
    let found = explored(&scene.world, &options, seen).map_err(|e| refused(scene, &e))?;
    let input = Input::Contacts(found.contacts.clone());
    let answer = answer_of(&input, &options, &args.fit.over(FitOptions::default()));
    let described =
        answer.as_ref().map_err(Clone::clone).and_then(|(found, taken)| described(found, &input, *taken, Vec::new()));
    Ok((document(args, scene, (&options, &found, &input), (&answer, &described)), found.contacts))
}

/// Plays on a thread of its own. Ctrl-C may come in the middle of a look, which takes seconds: then the looks before it count.
fn play_until_interrupted(
    args: &ExploreArgs,
    scene: &SceneFile,
    options: &ExploreOptions,
) -> Result<Exploration, Failure> {
    let bar = Bar::new(&args.output, u64::from(args.contacts / args.per_round) + 1, "looks");
    let looks: Arc<Mutex<Vec<Look>>> = Arc::default();
    let (kept, world, own) = (Arc::clone(&looks), scene.world.clone(), options.clone());
    let mut shown = 0;
    let look = || {
        let looks = held(&looks);
        looks[shown..].iter().for_each(|look| bar.step(words(look)));
        shown = looks.len();
        true
    };
    interrupt::gently();
    let found = Until::interrupted().wait_and(look, move || {
        explored(&world, &own, |look| {
            held(&kept).push(look.clone());
            !interrupt::asked()
        })
    });
    let found = match found {
        Some(found) => found,
        None if held(&looks).is_empty() => {
            let what = "interrupted before the contacts of the first sweep were looked at; nothing is kept";
            return Err(Failure::Interrupted(what.into()));
        }
        None => Exploration::after(&scene.world, options, std::mem::take(&mut *held(&looks))),
    };
    found.map_err(|e| refused(scene, &e))
}

pub(super) fn refused(scene: &SceneFile, error: &ExploreError) -> Failure {
    Failure::Input(format!("{}: {}", scene.name, with_flags(error)))
}

fn document(
    args: &ExploreArgs,
    scene: &SceneFile,
    (options, found, input): (&ExploreOptions, &Exploration, &Input),
    (answer, described): (&Answered, &Described<'_>),
) -> ExploreDocument {
    let mut notes: Vec<String> = args.without_effect().into_iter().collect();
    notes.extend(inverse_crime_remark(&found.truth));
    notes.extend(finger_note(&scene.world));
    match (answer, described) {
        (Ok((found, _)), Ok(_)) => {
            notes.extend(found.notes.iter().cloned());
            notes.extend(args.fit.without_effect(&found.answer, input));
        }
        (_, Err(refusal)) => notes.push(refusal.clone()),
        (Err(_), Ok(_)) => {}
    }
    let shape = described.as_ref().ok().map(|surface| surface.document().shape.clone());
    ExploreDocument::new(&scene.name, found, options, shape, notes)
}

/// Exit 130 where Ctrl-C ended it early.
fn ended(document: &ExploreDocument) -> Result<(), Failure> {
    if !interrupt::asked() {
        return Ok(());
    }
    let contacts = document.contacts;
    Err(Failure::Interrupted(format!("interrupted after {contacts} contacts; what they show is kept")))
}

/// Said in place of the answer where Ctrl-C leaves no time for it.
const LEFT_OUT: &str = "what all contacts show together was left out, because the exploration was interrupted";

/// An answer with the seconds that it took, or why there is none.
type Answered = Result<(Found, f64), String>;
/// The same described.
type Described<'a> = Result<Description<'a>, String>;

/// What all contacts show, as `palpate fit` answers; `typed` are the options of a fit with everything that was typed put in.
fn answer_of(input: &Input, options: &ExploreOptions, typed: &FitOptions) -> Answered {
    let level = options.level;
    let began = Instant::now();
    let found = match &options.model {
        None => {
            let recognition = options.recognition.clone().with_level(level).with_up([0.0, 0.0, 1.0]);
            automatic(input, &recognition, &typed.clone().with_level(level))
        }
        Some(model) => as_named(input, &model.clone().with_level(level), false),
    };
    let found = found.map_err(Refusal::words)?;
    compute_shape(&found.answer, false);
    Ok((found, began.elapsed().as_secs_f64()))
}

/// Effects that belong to a finger err anew at every touch, because every touch counts as a finger of its own.
fn finger_note(world: &World) -> Option<String> {
    let of_fingers = world.effects.iter().map(|effect| effect.name()).filter(|name| *name == "finger_noise");
    let names: Vec<&str> = of_fingers.collect();
    (!names.is_empty()).then(|| {
        format!("{}: every planned touch counts as a finger of its own, so its errors are drawn anew", names.join(", "))
    })
}

/// The message with the library's options written as flags.
fn with_flags(error: &ExploreError) -> String {
    match error {
        ExploreError::NoPatch { .. } => error.to_string().replace("the reach", "--reach X0,X1,Y0,Y1"),
        ExploreError::Budget { .. } => error.to_string().replace("allow more", "allow more by --contacts"),
        ExploreError::Option { option, value, expected } => {
            format!("--{} {value}: {expected}", option.replace('_', "-"))
        }
        other => other.to_string(),
    }
}

/// S and R so far, for the bar.
fn words(look: &Look) -> String {
    let of = |name: &str, e: Option<Estimate>| {
        e.map(|e| format!("{name} {} +- {}", significant(e.mean, 4), significant(e.u, 2)))
    };
    let both = [of("S", look.shape_index), of("R", look.curvedness)];
    both.into_iter().flatten().collect::<Vec<_>>().join("  ")
}
