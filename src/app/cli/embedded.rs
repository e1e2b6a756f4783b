//! What `fit`, `study`, `merge`, `frontier` and `explore` compute, for a program that holds the contacts already and wants no files: the Python
//! package. It is no part of the public interface and changes without notice.
//!
//! ```text
//! contacts or a grid, options   ->  FitAnswer        -> palpate.fit/1
//! arguments of `palpate study`  ->  StudyPlan -> StudyRun -> palpate.study/1, or a part for `palpate merge`
//! arguments of `palpate frontier`                 -> palpate.frontier/1
//! arguments of `palpate explore`                  -> palpate.explore/1, and the contacts
//! ```

use std::borrow::Cow;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use clap::Parser;

use crate::io::{AnySurface, Input, StudyFile, read_surface_bytes, scene_file::builtin_scenes, study_bytes, tensor};
use crate::report::{
    Answer, Audience, Description, PartsDocument, Seconds, Subject, compute_shape, describe_fit, write_json,
    write_words,
};
use palpate_fitting::fit::{Fit, FitError, FitOptions};
use palpate_fitting::parametric::{FittedSurface, ParametricFit};
use palpate_geometry::contact::Contacts;
use palpate_geometry::shape::{ShapeMaps, ShapeReport};
use palpate_geometry::surface::HeightField;
use palpate_inference::parts::{Parts, PartsOptions};
use palpate_inference::recognition::Recognition;
use palpate_studies::explore::planning_fit;
use palpate_studies::montecarlo::{Progress, Stopped, StudyState};

use super::adaptive_model::{TypedForAdaptive, adaptive_model};
use super::answer::recognition_of;
use super::explicit_model::fit_input;
use super::explore::{ExploreArgs, explore_in_memory};
use super::failure::Failure;
use super::found::{Found, Refusal};
use super::frontier::is_scene;
use super::frontier_args::FrontierArgs;
use super::merge::join;
use super::recognise_or_fit::automatic;
use super::scene::{self, Source};
use super::study_plan::{Plan, StudyArgs};
use super::until::Until;
use super::{frontier_input, frontier_scene, values};

/// Why there is no fit.
#[derive(Debug)]
pub enum FitRefusal {
    /// A fault of the data or of the options.
    Fit(FitError),
    /// The contacts show no shape; the message says what can be done.
    Shape(String),
}

impl From<Refusal> for FitRefusal {
    fn from(refusal: Refusal) -> FitRefusal {
        match refusal {
            Refusal::Fit(error) => FitRefusal::Fit(error),
            Refusal::Shape(message) | Refusal::Several(message) => FitRefusal::Shape(message),
        }
    }
}

/// Which surface is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AskedSurface {
    /// What the contacts show.
    Recognised,
    /// The spline that the options name.
    Spline,
    /// Small cells where the contacts ask for them; degrees and grid points where they were named.
    Adaptive {
        /// Degrees in x and y.
        degree: Option<[usize; 2]>,
        /// Points of the shape grid.
        grid: Option<[usize; 2]>,
    },
}

/// The answer to an input, with the input.
#[derive(Debug)]
pub struct FitAnswer {
    input: Input,
    found: Found,
    bare: bool,
    /// The document shall count that the surface may be of another kind than the one that was named.
    uncertain: bool,
    seconds: f64,
}

impl FitAnswer {
    /// Does what `palpate fit` does: the surface that is asked for, by the options.
    ///
    /// # Errors
    /// Both kinds of [`FitRefusal`].
    pub fn new(
        input: Input,
        asked: AskedSurface,
        options: &FitOptions,
        viewpoint: Option<[f64; 3]>,
        bare: bool,
    ) -> Result<FitAnswer, FitRefusal> {
        let clock = Instant::now();
        let found = match asked {
            AskedSurface::Spline => {
                let (found, chosen) = fit_input(&input, options).map_err(FitRefusal::Fit)?;
                Found { answer: Answer::Fitted(found), chosen, lack_of_fit: None, notes: Vec::new() }
            }
            AskedSurface::Adaptive { degree, grid } => {
                adaptive_model(&input, TypedForAdaptive { degree, grid }, options, bare)?
            }
            AskedSurface::Recognised => {
                options.check().map_err(FitRefusal::Fit)?;
                automatic(&input, &recognition_of(options, viewpoint), options)?
            }
        };
        let uncertain = asked == AskedSurface::Spline && !bare;
        Ok(FitAnswer { input, found, bare, uncertain, seconds: clock.elapsed().as_secs_f64() })
    }

    /// The fitted height field, where one was fitted.
    pub fn height_field(&self) -> Option<&Fit> {
        match &self.found.answer {
            Answer::Fitted(FittedSurface::Height(fit)) => Some(fit),
            _ => None,
        }
    }

    /// The fitted surface in space, where one was fitted.
    pub fn parametric(&self) -> Option<&ParametricFit> {
        match &self.found.answer {
            Answer::Fitted(FittedSurface::Parametric(fit)) => Some(fit),
            _ => None,
        }
    }

    /// The shape of an adaptive surface, where one was fitted.
    pub fn adaptive_shape(&self) -> Option<&ShapeReport<ShapeMaps>> {
        match &self.found.answer {
            Answer::Adaptive(answer) => Some(&answer.shape),
            _ => None,
        }
    }

    /// The tensor spline of an adaptive surface's smallest cells, where one was fitted.
    ///
    /// # Errors
    /// Why it has none: it would be too large.
    pub fn adaptive_spline(&self) -> Option<Result<HeightField, String>> {
        let Answer::Adaptive(answer) = &self.found.answer else { return None };
        Some(answer.fit.input_field().map_err(|error| error.to_string()).and_then(|field| tensor(&field)))
    }

    /// The fit by which touches are planned: the fitted height field, or, of contacts that were recognised, one with the
    /// noise that was found. `None` where no height field over x and y fits them.
    pub fn planning_fit(&self) -> Option<Cow<'_, Fit>> {
        match (&self.found.answer, &self.input) {
            (Answer::Fitted(FittedSurface::Height(fit)), _) => Some(Cow::Borrowed(fit)),
            (Answer::Recognised(found), Input::Contacts(contacts)) => {
                planning_fit(contacts, Some(found)).map(Cow::Owned)
            }
            _ => None,
        }
    }

    /// How far each contact lies off the surface: along its normal where it was recognised, along z of a height field. `None`
    /// of other surfaces, and of a grid.
    ///
    /// # Errors
    /// When the input's own rounding leaves no distinct knots.
    pub fn residuals(&self) -> Result<Option<Vec<f64>>, FitError> {
        let Input::Contacts(contacts) = &self.input else { return Ok(None) };
        let places = (0..contacts.len()).map(|r| [contacts.x[r], contacts.y[r], contacts.z[r]]);
        Ok(match &self.found.answer {
            Answer::Recognised(found) => Some(places.map(|place| found.distance(place)).collect()),
            Answer::Fitted(FittedSurface::Height(fit)) => {
                let (surface, frame) = (fit.input_surface()?, fit.frame());
                let off = |place: [f64; 3]| {
                    let [x, y, z] = frame.rotate(place);
                    z - surface.at(x, y).z
                };
                Some(places.map(off).collect())
            }
            Answer::Adaptive(answer) => Some(places.map(|[x, y, z]| z - answer.fit.at(x, y).z).collect()),
            Answer::Fitted(FittedSurface::Parametric(_)) => None,
        })
    }

    /// What the contacts were recognised as.
    pub fn recognition(&self) -> Option<&Recognition> {
        match &self.found.answer {
            Answer::Recognised(found) => Some(found),
            Answer::Adaptive(_) | Answer::Fitted(_) => None,
        }
    }

    /// The document that `palpate fit --json` prints, and the table that it prints without; lengths are in `unit`.
    ///
    /// # Errors
    /// When the input's own rounding leaves no distinct knots.
    pub fn document(&self, name: &str, unit: Option<&str>) -> Result<[Vec<u8>; 2], FitError> {
        self.described(unit, |description| {
            let (mut json, mut table) = (Vec::new(), Vec::new());
            // a Vec takes every byte
            let _ = write_json(description.document(), &mut json);
            let _ =
                write_words(name, description.document(), Audience { detailed: false, ..Audience::READER }, &mut table);
            [json, table]
        })
    }

    /// The axes and the arrays of `maps.npz`, over another number of points where one is given.
    ///
    /// # Errors
    /// When the input's own rounding leaves no distinct knots.
    pub fn maps(&self, points: Option<[usize; 2]>) -> Result<([Vec<f64>; 2], Vec<NamedArray>), FitError> {
        self.described(None, |description| {
            let (grid, arrays) = description.map_arrays(points);
            ([grid.x, grid.y], arrays)
        })
    }

    fn described<T>(&self, unit: Option<&str>, of: impl FnOnce(&Description) -> T) -> Result<T, FitError> {
        let clock = Instant::now();
        // other kinds of surface are asked only here: it takes longer than many a fit, whose surface alone may be wanted
        let counted = match &self.found.answer {
            Answer::Fitted(FittedSurface::Height(fit)) if self.uncertain => {
                let fit = Recognition::beside(fit.as_ref().clone());
                Some(Answer::Fitted(FittedSurface::Height(Box::new(fit))))
            }
            _ => None,
        };
        let answer = counted.as_ref().unwrap_or(&self.found.answer);
        compute_shape(answer, self.bare);
        let shape = clock.elapsed().as_secs_f64();
        let seconds = Seconds { read: 0.0, fit: self.seconds, shape, total: self.seconds + shape };
        let subject = Subject {
            input: &self.input,
            unit: unit.map(String::from),
            truth: None,
            bare: self.bare,
            notes: self.found.notes.clone(),
            chosen: self.found.chosen.clone(),
            lack_of_fit: self.found.lack_of_fit.clone(),
        };
        Ok(of(&describe_fit(answer, &subject, seconds)?))
    }
}

/// The tensor spline of the smallest cells of an adaptive surface, from its document.
///
/// # Errors
/// What is wrong with the document, and why there is no spline.
pub fn adaptive_spline_of(document: &[u8]) -> Result<HeightField, String> {
    match read_surface_bytes("document", document).map_err(|error| error.to_string())?.surface {
        AnySurface::Hierarchical(field) => tensor(&field),
        _ => Err("the document is not that of an adaptive surface".into()),
    }
}

/// A map with its name.
pub type NamedArray = (&'static str, ndarray::Array2<f64>);

/// The document that `palpate parts --json` prints, and the part of every contact, counted from 1; 0 is none.
///
/// # Errors
/// What the command line would say.
pub fn parts_of(
    contacts: &Contacts,
    tolerance: Option<f64>,
    viewpoint: Option<[f64; 3]>,
) -> Result<(Vec<u8>, Vec<u32>), String> {
    let clock = Instant::now();
    let found = Parts::of(contacts, &PartsOptions { tolerance, viewpoint }).map_err(|error| error.to_string())?;
    let document = PartsDocument::new("contacts", &found, Vec::new(), clock.elapsed().as_secs_f64());
    let mut json = Vec::new();
    // a Vec takes every byte
    let _ = write_json(&document, &mut json);
    Ok((json, found.labels.iter().map(|label| label.map_or(0, |part| part + 1)).collect()))
}

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
    let mut document = found.map_err(Failure::into_message)?.ok_or("ended before everything was measured")?;
    document.seconds = clock.elapsed().as_secs_f64();
    let mut json = Vec::new();
    // a Vec takes every byte
    let _ = write_json(&document, &mut json);
    Ok(json)
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
    let mut document = found.map_err(Failure::into_message)?.ok_or("ended before everything was measured")?;
    document.seconds = clock.elapsed().as_secs_f64();
    let mut json = Vec::new();
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
