//! What `fit`, `study`, `merge`, `frontier`, `explore`, `live` and `diff` compute, for a program that holds the contacts already and
//! wants no files: the Python package. It is no part of the public interface and changes without notice.
//!
//! ```text
//! contacts or a grid, options   ->  FitAnswer        -> palpate.fit/1
//! arguments of `palpate study`  ->  StudyPlan -> StudyRun -> palpate.study/1, or a part for `palpate merge`
//! arguments of `palpate frontier`                 -> palpate.frontier/1
//! arguments of `palpate explore`                  -> palpate.explore/1, and the contacts
//! arguments of `palpate live`, touches            -> LiveLoop -> palpate.live/1, touch by touch
//! contacts, then heights        ->  FitAnswer, RepeatedPlaces -> splines
//! parts of contacts             ->  runs -> tiles -> TiledFit -> FitAnswer
//! two documents                                   -> palpate.diff/1
//! ```

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use clap::Parser;

use crate::io::{StudyFile, scene_file::builtin_scenes, study_bytes};
use crate::report::{FrontierDocument, write_json};
use palpate_fitting::fit::FitOptions;
use palpate_geometry::contact::Contacts;
use palpate_studies::montecarlo::{Progress, Stopped, StudyState};

pub use super::embedded_diff::diff;
pub use super::embedded_fits::{AskedSurface, FitAnswer, FitRefusal, NamedArray, adaptive_spline_of, parts_of};
pub use super::embedded_live::{LiveAnswer, LiveLoop, LiveReply, check_touch};
pub use super::embedded_plan::RepeatedPlaces;
pub use super::embedded_tiles::{
    AskTiles, PartRun, TileSides, TiledFit, contact_tile, merged_runs, part_bounds, part_run, run_of_roots, run_slice,
    tile_answer, tile_sides,
};
use super::explore::{ExploreArgs, explore_in_memory};
use super::failure::Failure;
use super::frontier::is_scene;
use super::frontier_args::FrontierArgs;
use super::live::LiveArgs;
use super::merge::join;
use super::scene::{self, Source};
use super::study_plan::{Plan, StudyArgs};
pub use super::tuned::TunedOption;
use super::until::Until;
use super::{frontier_input, frontier_scene, values};

/// Everything that decides the numbers of a study.
#[derive(Debug)]
pub struct StudyPlan {
    plan: Arc<Plan>,
    args: StudyArgs,
    arguments: Vec<String>,
    scene: String,
}

/// What replicates came to.
#[derive(Debug)]
pub struct StudyRun {
    state: StudyState,
    stopped: Stopped,
    range: [u64; 2],
    seconds: f64,
}

impl StudyPlan {
    /// From the arguments of `palpate study` after the verb, the scene first. `text` is the scene as TOML, where its
    /// name is no built-in one and no file.
    ///
    /// # Errors
    /// What the command line would say.
    pub fn new(arguments: Vec<String>, text: Option<String>) -> Result<StudyPlan, String> {
        let line: Vec<String> = std::iter::once("study".to_string()).chain(arguments).collect();
        let args = StudyArgs::read(&line)?;
        let name = args.scene.clone().unwrap_or_default();
        let source = source(&name, text)?;
        let plan = Arc::new(Plan::new(&args, &source).map_err(Failure::into_message)?);
        Ok(StudyPlan { plan, args, arguments: line, scene: source.text })
    }

    /// Replicates of the whole run; where a tolerance decides, the most there may be.
    pub fn replicates(&self) -> u64 {
        self.plan.most
    }

    /// Names of the quantities, S and R first.
    pub fn quantities(&self) -> Vec<String> {
        self.plan.study.engine().quantities().iter().map(ToString::to_string).collect()
    }

    /// Runs replicates `range`, or all; `watch` ends the run by saying `false`.
    ///
    /// # Errors
    /// What the command line would say.
    pub fn run(
        &self,
        range: Option<[u64; 2]>,
        watch: &mut dyn FnMut(&Progress<'_>) -> bool,
    ) -> Result<StudyRun, String> {
        let range = range.unwrap_or([0, self.plan.most]);
        if range[0] >= range[1] || range[1] > self.plan.most {
            let [a, b] = range;
            return Err(format!("range {a}:{b} is no part of the {} replicates of the run", self.plan.most));
        }
        let clock = Instant::now();
        let budget = self.args.budget.unwrap_or(f64::INFINITY);
        let outcome = self.plan.study.run(self.plan.study.start(range[0]), range[1], &mut |progress| {
            watch(progress) && clock.elapsed().as_secs_f64() < budget
        });
        let (state, stopped) = outcome.map_err(|e| format!("{}: {e}", self.plan.name))?;
        Ok(StudyRun { state, stopped, range, seconds: clock.elapsed().as_secs_f64() })
    }

    /// The bytes of the file that `palpate study --range A:B --part F` writes.
    pub fn part(&self, run: &StudyRun) -> Vec<u8> {
        study_bytes(&StudyFile {
            identity: self.plan.identity.clone(),
            arguments: self.arguments.clone(),
            scene: self.scene.clone(),
            range: run.range,
            seconds: run.seconds,
            records: 0,
            state: run.state.clone(),
        })
    }

    /// The document that `palpate study --json` prints.
    pub fn document(&self, run: &StudyRun) -> Vec<u8> {
        let mut json = Vec::new();
        // a Vec takes every byte
        let _ = write_json(&self.plan.document(&run.state, run.stopped, run.seconds, Until::interrupted()), &mut json);
        json
    }
}

/// The document that `palpate merge --json` prints.
///
/// # Errors
/// What the command line would say.
pub fn merge(parts: &[PathBuf]) -> Result<Vec<u8>, String> {
    let (_, document, _) = join(parts, || ()).map_err(Failure::into_message)?;
    let mut json = Vec::new();
    let _ = write_json(&document, &mut json);
    Ok(json)
}

#[derive(Parser)]
struct FrontierLine {
    #[command(flatten)]
    args: FrontierArgs,
}

#[derive(Parser)]
struct ExploreLine {
    #[command(flatten)]
    args: ExploreArgs,
}

#[derive(Parser)]
struct LiveLine {
    #[command(flatten)]
    args: LiveArgs,
}

/// A loop that answers every touch, from the arguments of `palpate live`, `-` first.
///
/// # Errors
/// What the command line would say.
pub fn live(arguments: Vec<String>) -> Result<LiveLoop, String> {
    let LiveLine { args } = parsed("live", arguments)?;
    LiveLoop::of(&args)
}

/// The verb and its arguments, read.
fn parsed<T: Parser>(verb: &str, arguments: Vec<String>) -> Result<T, String> {
    T::try_parse_from(std::iter::once(verb.to_string()).chain(arguments)).map_err(|error| error.to_string())
}

/// The document that `palpate frontier --json` prints, from its arguments, the scene or the file of contacts first. `text`
/// is the scene as TOML, as for [`StudyPlan::new`]. `watch(step, steps)` is asked
/// many times a second, and ends the measurement by saying `false`.
///
/// # Errors
/// What the command line would say, and that it was ended.
pub fn frontier(
    arguments: Vec<String>,
    text: Option<String>,
    watch: &(dyn Fn(usize, usize) -> bool + Sync),
) -> Result<Vec<u8>, String> {
    let clock = Instant::now();
    let FrontierLine { args } = parsed("frontier", arguments)?;
    let subject = args.subject.clone().unwrap_or_default();
    let request = args.request().map_err(Failure::into_message)?;
    let found = if text.is_some() || is_scene(&subject) {
        let source = source(&subject, text)?;
        frontier_scene::measure(&args, &subject, &source, request.as_ref(), watch)
    } else {
        frontier_input::measure(&args, &subject, request.as_ref(), watch).map(Some)
    };
    measured(found, clock)
}

/// The same of contacts that are there already; the subject of `arguments` is what they are called.
///
/// # Errors
/// What the command line would say of a file of them.
pub fn frontier_of_contacts(
    arguments: Vec<String>,
    contacts: &Contacts,
    watch: &(dyn Fn(usize, usize) -> bool + Sync),
) -> Result<Vec<u8>, String> {
    let clock = Instant::now();
    let FrontierLine { args } = parsed("frontier", arguments)?;
    let name = args.subject.clone().unwrap_or_default();
    let request = args.request().map_err(Failure::into_message)?;
    let found = frontier_input::measure_contacts(&args, &name, contacts, request.as_ref(), watch);
    measured(found, clock)
}

/// A frontier as it is printed, with the time that it took.
fn measured(found: Result<Option<FrontierDocument>, Failure>, clock: Instant) -> Result<Vec<u8>, String> {
    let mut document = found.map_err(Failure::into_message)?.ok_or("ended before everything was measured")?;
    document.seconds = clock.elapsed().as_secs_f64();
    let mut json = Vec::new();
    // a Vec takes every byte
    let _ = write_json(&document, &mut json);
    Ok(json)
}

/// The document that `palpate explore --json` prints, from its arguments, the scene first, and all contacts. `text` is
/// the scene as TOML, as for [`StudyPlan::new`]. `watch(contacts, most)` ends the exploration by saying `false`.
///
/// # Errors
/// What the command line would say.
pub fn explore(
    arguments: Vec<String>,
    text: Option<String>,
    watch: &mut dyn FnMut(u64, u64) -> bool,
) -> Result<(Vec<u8>, Contacts), String> {
    let ExploreLine { args } = parsed("explore", arguments)?;
    let source = source(&args.scene, text)?;
    let scene = source.read().map_err(|e| format!("{}: {e}", source.name))?;
    let most = u64::from(args.contacts);
    let found = explore_in_memory(&args, &scene, |look| watch(look.contacts as u64, most));
    let (document, contacts) = found.map_err(Failure::into_message)?;
    let mut json = Vec::new();
    let _ = write_json(&document, &mut json);
    Ok((json, contacts))
}

/// The name of a unit of length, where it is one.
///
/// # Errors
/// What the command line would say.
pub fn unit(text: &str) -> Result<String, String> {
    values::unit(text)
}

fn source(name: &str, text: Option<String>) -> Result<Source, String> {
    match text {
        Some(text) => Ok(Source::of_text(name, text)),
        None => scene::source(name).map_err(Failure::into_message),
    }
}

/// Names of the built-in scenes, a line on each, and each as TOML.
pub fn scenes() -> Vec<[String; 3]> {
    builtin_scenes().into_iter().map(|scene| [scene.name, scene.line, scene.toml.into_owned()]).collect()
}

/// The contacts of one replicate of a scene, by its name, its file, or its text.
///
/// # Errors
/// What the command line would say.
pub fn simulate(
    name: &str,
    text: Option<String>,
    seed: Option<u64>,
    replicate: u64,
) -> Result<(Contacts, FitOptions), String> {
    let source = source(name, text)?;
    let scene = source.read().map_err(|e| format!("{}: {e}", source.name))?;
    let simulator = scene.world.compile().map_err(|e| format!("{}: {e}", scene.name))?;
    let (contacts, _) = simulator.into_contacts(seed.unwrap_or(scene.seed), replicate);
    Ok((contacts, scene.fit))
}
