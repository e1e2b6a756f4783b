//! `palpate study SCENE`: intervals of S and R over replicates, the shares of the effects, and how far all of it is known.
//!
//! A run is one function of its arguments and the scene's text: [`Plan`] is made from them, here and by `palpate merge`,
//! which finds both in the parts it joins.

use std::path::{Path as FilePath, PathBuf};
use std::time::Instant;

use clap::{Args, Parser};

use crate::fit::FitOptions;
use crate::io::scene_file::SceneFile;
use crate::io::{RecordFormat, Records, StudyFile, StudyIdentity, read_study, text_hash, write_study};
use crate::montecarlo::{
    Path, Quantity, Stopped, StoppingRule, Study, StudyError, StudyOptions, StudyState, Tolerance,
};
use crate::report::{
    NamedQuantities, NamedShares, QuantityPart, STUDY_SCHEMA, StudyDocument, effect_parts, inverse_crime_remark,
    stopped_words, study_notes, sum_parts, write_json, write_study_picture, write_study_table,
};
use crate::scene::Effect;
use crate::simd::Isa;

use super::failure::Failure;
use super::options::{FitFlags, OutputFlags};
use super::output::print;
use super::progress::Bar;
use super::scene::Source;
use super::{coverage, scene, sweep, values};

/// Seconds between two checkpoints.
const CHECKPOINT_SECONDS: f64 = 1.0;

/// Arguments of `palpate study`.
#[derive(Args, Clone, Debug)]
pub(super) struct StudyArgs {
    /// Built-in scene, scene file, or - for standard input; with --coverage none takes the built-in family
    scene: Option<String>,
    /// Replicates [default: the scene's, 10000]; with --tolerance the most there may be
    #[arg(long, value_name = "N", value_parser = values::replicates)]
    pub(super) replicates: Option<u64>,
    /// Seed [default: the scene's]
    #[arg(long, value_name = "K")]
    pub(super) seed: Option<u64>,
    /// Level of the intervals, between 0 and 1 [default: the scene's, 0.95]
    #[arg(long, value_name = "P", allow_hyphen_values = true, value_parser = values::level)]
    pub(super) level: Option<f64>,
    /// Go on until both ends of both intervals have so many significant digits of u
    #[arg(long, value_name = "DIGITS", value_parser = clap::value_parser!(u32).range(1..=4), conflicts_with = "range")]
    tolerance: Option<u32>,
    /// How a tolerance is reached: stein (two stages) or adaptive (JCGM 101, 7.9)
    #[arg(long, value_name = "RULE", value_parser = values::rule, requires = "tolerance")]
    rule: Option<StoppingRule>,
    /// Stop after so many seconds of replicates
    #[arg(long, value_name = "SECONDS", value_parser = values::seconds)]
    budget: Option<f64>,
    /// Replicates A to B (B excluded) of the run alone, to be joined by palpate merge
    #[arg(long, value_name = "A:B", value_parser = values::range, requires = "part")]
    range: Option<[u64; 2]>,
    /// Write what the replicates came to, for palpate merge
    #[arg(long, value_name = "F", conflicts_with = "tolerance")]
    part: Option<PathBuf>,
    /// Write every replicate, as .csv or .parquet
    #[arg(long, value_name = "F")]
    records: Option<PathBuf>,
    /// Keep a checkpoint, and go on from it where there is one
    #[arg(long, value_name = "F")]
    checkpoint: Option<PathBuf>,
    /// A quantity beside S and R: k1, k2, radius, direction_deg, or S, R, k1, k2 at a point as in S@0,1.5
    #[arg(long, value_name = "Q", allow_hyphen_values = true)]
    quantity: Vec<Quantity>,
    /// Quantiles beside the intervals' ends, as 0.05,0.5
    #[arg(long, value_name = "P,..", value_delimiter = ',')]
    quantile: Vec<f64>,
    /// The way to S and R: auto, refit or whole
    #[arg(long, value_name = "WAY", value_parser = values::way)]
    path: Option<Way>,
    /// Replicates of each design for the shares of the effects; 0: none [default: by the way]
    #[arg(long, value_name = "N")]
    pub(super) attribution: Option<usize>,
    /// Ask of each interval that a fit would print whether it holds the truth
    #[arg(long, conflicts_with_all = ["tolerance", "range", "part", "records", "checkpoint", "budget"])]
    coverage: bool,
    /// Repeat the study over a key of the scene: KEY=A:B:logN, KEY=A:B:linN or KEY=A,B,C; several make a grid
    #[arg(long, value_name = "KEY=A:B:logN", allow_hyphen_values = true,
          conflicts_with_all = ["coverage", "range", "part", "records", "checkpoint"])]
    sweep: Vec<String>,
    #[command(flatten)]
    pub(super) fit: FitFlags,
    #[command(flatten)]
    pub(super) output: OutputFlags,
}

/// A way that was asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Way {
    Auto,
    Only(Path),
}

/// The line of `palpate merge`, which reads the arguments of `palpate study` back from a part.
#[derive(Parser)]
struct Line {
    #[arg(long)]
    portable: bool,
    #[command(flatten)]
    study: StudyArgs,
}

impl StudyArgs {
    /// Arguments as they stand in a part; the instruction set is compared by name, so `--portable` is read and left.
    pub(super) fn parse_back(arguments: &[String]) -> Option<StudyArgs> {
        let line = Line::try_parse_from(arguments).ok()?;
        let _ = line.portable;
        Some(line.study)
    }

    /// Keys to sweep.
    pub(super) fn sweeps(&self) -> &[String] {
        &self.sweep
    }

    /// The options with everything that was typed put in.
    fn options(&self, scene: &SceneFile) -> StudyOptions {
        let mut options = scene.study.clone();
        if let Some(replicates) = self.replicates {
            (options.replicates, options.replicates_given) = (replicates, true);
        }
        options.level = self.level.unwrap_or(options.level);
        if let Some(digits) = self.tolerance {
            options.tolerance = Some(Tolerance { digits, rule: self.rule.unwrap_or_default() });
            // what a scene says is how many there are without a tolerance
            options.replicates_given = self.replicates.is_some();
        }
        options.quantities.extend(&self.quantity);
        options.quantiles.extend(&self.quantile);
        if let Some(Way::Only(path)) = self.path {
            options.path = Some(path);
        }
        options
    }
}

/// Everything that decides the numbers of a study.
pub(super) struct Plan {
    pub(super) name: String,
    pub(super) study: Study,
    pub(super) identity: StudyIdentity,
    /// Replicates of the whole run.
    pub(super) most: u64,
    attribution: usize,
    /// Effects of the scene that are off.
    off: Vec<&'static str>,
    remark: Option<String>,
}

impl Plan {
    /// From the arguments and the scene's text.
    pub(super) fn new(args: &StudyArgs, source: &Source) -> Result<Plan, Failure> {
        let scene = source.read().map_err(|e| Failure::Input(format!("{}: {e}", source.name)))?;
        Plan::of_scene(args, &scene)
    }

    /// From the arguments and a scene that was read.
    pub(super) fn of_scene(args: &StudyArgs, scene: &SceneFile) -> Result<Plan, Failure> {
        let wrong = |e: StudyError| Failure::Input(format!("{}: {e}", scene.name));
        let options = args.options(scene);
        let fit = args.fit.over(scene.fit.clone());
        let seed = args.seed.unwrap_or(scene.seed);
        let simulator = scene.world.compile().map_err(|e| wrong(e.into()))?;
        let on = simulator.stage_names();
        let off = scene.world.effects.iter().map(Effect::name).filter(|name| !on.contains(name)).collect();
        let remark = inverse_crime_remark(&simulator.truth());
        let most = options.most();
        let identity = identity(scene, &fit, &options, seed, most);
        let study = Study::new(simulator, &fit, options, seed).map_err(wrong)?;
        let random = study.engine().simulator().stages().iter().any(|stage| stage.draws_per_contact() > 0);
        let attribution = args.attribution.unwrap_or(match study.engine().path() {
            Path::FixedSites | Path::Linearised => 20_000,
            Path::Refit => 8_000,
            Path::Whole => 320,
        });
        let attribution = if random { attribution } else { 0 };
        Ok(Plan { name: scene.name.clone(), study, identity, most, attribution, off, remark })
    }

    /// The document of a state.
    pub(super) fn document(&self, state: &StudyState, stopped: Stopped, seconds: f64) -> StudyDocument {
        let result = self.study.result(state, self.attribution);
        let failure = state.first_failure.as_ref().map(|(_, why)| why.as_str());
        let mut notes = study_notes(&result, state.failed, failure);
        notes.extend(self.remark.clone());
        let engine = self.study.engine();
        let parts: Vec<QuantityPart> = result.quantities.iter().map(QuantityPart::from).collect();
        let others = engine.quantities().iter().map(ToString::to_string).zip(parts.iter().cloned()).skip(2);
        let classes = result.classes.shares.iter().map(|(class, share)| (class.name().to_string(), *share));
        let classes = classes.chain([("none".to_string(), result.classes.none)]);
        let attribution = result.attribution.clone().unwrap_or_default();
        let off: &[&str] = if result.attribution.is_some() { &self.off } else { &[] };
        StudyDocument {
            schema: STUDY_SCHEMA,
            scene: self.name.clone(),
            seed: self.study.seed(),
            scene_hash: self.identity.scene_hash.clone(),
            build: self.identity.build.clone(),
            isa: self.identity.isa.clone(),
            range: [state.from, state.to],
            replicates: state.done(),
            stopped: stopped.name().into(),
            level: self.study.options().level,
            path: engine.path().name().into(),
            path_why: engine.why().into(),
            shape_index: parts.first().cloned().unwrap_or_default(),
            curvedness: parts.get(1).cloned().unwrap_or_default(),
            quantities: NamedQuantities(others.collect()),
            class: NamedShares(classes.collect()),
            verdict: result.classes.verdict.map(|class| class.name().to_string()),
            failed: state.failed,
            planes: state.planes,
            linear: (&result.linear).into(),
            effects: effect_parts(&attribution, off),
            effects_replicates: attribution.replicates as u64,
            effects_sum: sum_parts(&attribution),
            notes,
            seconds,
            replicates_per_second: (seconds > 0.0).then(|| state.done() as f64 / seconds),
        }
    }
}

fn identity(scene: &SceneFile, fit: &FitOptions, options: &StudyOptions, seed: u64, most: u64) -> StudyIdentity {
    // the alternate form spells long lists out
    let text = format!("{:#?}\n{fit:#?}\n{options:#?}", scene.world);
    StudyIdentity {
        scene_hash: text_hash(&text),
        seed,
        build: env!("CARGO_PKG_VERSION").into(),
        isa: Isa::active().name().into(),
        replicates: most,
    }
}

pub(super) fn study(args: &StudyArgs) -> Result<(), Failure> {
    if args.coverage {
        return coverage::coverage(args, args.scene.as_deref());
    }
    let Some(name) = &args.scene else {
        return Err(Failure::Input(
            "a study needs a scene: a built-in name (palpate scenes lists them) or a file".into(),
        ));
    };
    if let Some(records) = &args.records {
        let format = RecordFormat::of(records).map_err(Failure::Input)?;
        if format == RecordFormat::Parquet && args.checkpoint.is_some() {
            let why = "records in Parquet cannot be gone on with after a checkpoint: give --records a .csv";
            return Err(Failure::Input(why.into()));
        }
    }
    let source = scene::source(name)?;
    if !args.sweep.is_empty() {
        return sweep::sweep(args, &source);
    }
    args.output.prepare()?;
    let plan = Plan::new(args, &source)?;
    run(args, &plan, source)
}

fn run(args: &StudyArgs, plan: &Plan, source: Source) -> Result<(), Failure> {
    let range = args.range.unwrap_or([0, plan.most]);
    if range[1] > plan.most {
        return Err(Failure::Input(format!(
            "--range {}:{} ends beyond the {} replicates of the run; --replicates says how many the whole run has",
            range[0], range[1], plan.most
        )));
    }
    let file = |state: StudyState, seconds: f64, records: u64| StudyFile {
        identity: plan.identity.clone(),
        // from the verb on, which stands where a program's name would
        arguments: std::env::args().skip_while(|word| word != "study").collect(),
        scene: source.text.clone(),
        range,
        seconds,
        records,
        state,
    };
    let resumed = resumed(args, plan, range)?;
    let (state, before, sound) = match resumed {
        Some(found) => (found.state, found.seconds, Some(found.records)),
        None => (plan.study.start(range[0]), 0.0, None),
    };
    let names: Vec<String> = plan.study.engine().quantities().iter().map(ToString::to_string).collect();
    let mut records = match (&args.records, sound) {
        (None, _) => None,
        (Some(path), Some(sound)) => Some(Records::resume(path, sound)?),
        (Some(path), None) => Some(Records::create(path, &names)?),
    };
    let bar = Bar::new(&args.output, range[1] - range[0], &plan.name);
    let (clock, mut saved) = (Instant::now(), Instant::now());
    let mut fault: Option<Failure> = None;
    let outcome = plan.study.run(state, range[1], &mut |progress| {
        let seconds = before + clock.elapsed().as_secs_f64();
        bar.show(progress, seconds);
        if let Some(Err(error)) = records.as_mut().map(|records| records.append(progress.values)) {
            fault = Some(error.into());
            return false;
        }
        if let Some(path) = args.checkpoint.as_ref().filter(|_| saved.elapsed().as_secs_f64() > CHECKPOINT_SECONDS) {
            let sound = records.as_ref().map_or(0, Records::sound);
            if let Err(error) = write_study(path, &file(progress.state.clone(), seconds, sound)) {
                fault = Some(error.into());
                return false;
            }
            saved = Instant::now();
        }
        match args.budget {
            Some(budget) if args.tolerance.is_some() => {
                fault = out_of_reach(args, progress.state.done(), progress.end - progress.state.from, seconds, budget);
                fault.is_none() && seconds < budget
            }
            Some(budget) => seconds < budget,
            None => true,
        }
    });
    let seconds = before + clock.elapsed().as_secs_f64();
    drop(bar);
    if let Some(fault) = fault {
        return Err(fault);
    }
    let (state, stopped) = outcome.map_err(|e| Failure::Input(format!("{}: {e}", plan.name)))?;
    let sound = records.as_ref().map_or(0, Records::sound);
    if let Some(records) = records {
        records.finish()?;
    }
    if let Some(path) = &args.checkpoint {
        write_study(path, &file(state.clone(), seconds, sound))?;
    }
    if let Some(path) = &args.part {
        write_study(path, &file(state.clone(), seconds, 0))?;
    }
    let spinner = args.output.spinner("shares of the effects");
    let document = plan.document(&state, stopped, seconds);
    drop(spinner);
    tell(&args.output, plan, &document, &state)
}

/// The budget is too short for the digits asked for, by the time that the first stage took.
fn out_of_reach(args: &StudyArgs, done: u64, wanted: u64, seconds: f64, budget: f64) -> Option<Failure> {
    let needed = seconds * wanted as f64 / done as f64;
    // half as much again: the first replicates are slower than the rest
    (wanted > done && needed > 1.5 * budget).then(|| {
        Failure::Input(format!(
            "--tolerance {} needs about {wanted} replicates, some {needed:.1} seconds here; --budget allows {budget}: raise it, or ask for fewer digits",
            args.tolerance.unwrap_or(0)
        ))
    })
}

fn resumed(args: &StudyArgs, plan: &Plan, range: [u64; 2]) -> Result<Option<StudyFile>, Failure> {
    let Some(path) = args.checkpoint.as_ref().filter(|path| path.exists()) else { return Ok(None) };
    let found = read_study(path).map_err(|e| Failure::Input(e.to_string()))?;
    let foreign = |why: String| Failure::Input(format!("{}: a checkpoint of another study: {why}", path.display()));
    plan.identity.check(&found.identity).map_err(|e| foreign(e.to_string()))?;
    if found.range != range {
        let [a, b] = found.range;
        return Err(foreign(format!("it is of replicates {a}:{b}")));
    }
    if args.records.is_some() && found.records == 0 {
        return Err(foreign("it was kept without --records".into()));
    }
    Ok(Some(found))
}

/// The document wherever the flags ask for it.
pub(super) fn tell(
    output: &OutputFlags,
    plan: &Plan,
    document: &StudyDocument,
    state: &StudyState,
) -> Result<(), Failure> {
    output.file("study.json", &mut |out| write_json(document, out))?;
    if output.out.is_some() {
        let ranked = [state.tallies[0].ranked(), state.tallies[1].ranked()];
        output.file("study.svg", &mut |out| write_study_picture(document, &ranked, out))?;
    }
    if output.json {
        return print(&mut |out| write_json(document, out));
    }
    if output.quiet {
        return Ok(());
    }
    let mut shown = document.clone();
    if let Some(stopped) = [Stopped::Replicates, Stopped::Tolerance, Stopped::Budget]
        .into_iter()
        .find(|stopped| stopped.name() == document.stopped)
    {
        shown.stopped = stopped_words(stopped).into();
    }
    if plan.identity.replicates != document.replicates && document.range != [0, plan.identity.replicates] {
        shown.notes.push(format!("replicates {} to {} alone", document.range[0], document.range[1]));
    }
    print(&mut |out| write_study_table(&shown, out))
}

/// Where a part says its scene came from.
pub(super) fn source_of(file: &StudyFile, args: &StudyArgs) -> Source {
    Source::of_text(args.scene.as_deref().unwrap_or("-"), file.scene.clone())
}

/// A part of a study.
pub(super) fn part(path: &FilePath) -> Result<StudyFile, Failure> {
    read_study(path).map_err(|e| Failure::Input(e.to_string()))
}
