//! Arguments of `palpate study`, and the plan that they and the scene's text make.
//!
//! ```text
//! plan = f(arguments, text of the scene)      the same in a run and in `palpate merge`, which finds both in the parts
//! ```

use std::path::PathBuf;
use std::sync::Arc;

use clap::{Args, Parser};

use crate::io::scene_file::SceneFile;
use crate::io::{StudyIdentity, text_hash};
use crate::report::{
    NamedQuantities, QuantityPart, STUDY_SCHEMA, Shares, StudyDocument, effect_parts, inverse_crime_remark,
    study_notes, sum_parts,
};
use palpate_fitting::fit::FitOptions;
use palpate_numeric::simd::Isa;
use palpate_studies::montecarlo::{
    Path, Quantity, Stopped, Study, StudyError, StudyOptions, StudyResult, StudyState, Tolerance, attribute,
};
use palpate_world::scene::Effect;

use super::failure::Failure;
use super::interrupt;
use super::options::{FitFlags, OutputFlags, PictureFlags};
use super::scene::Source;
use super::until::Until;
use super::values::{self, PathChoice};

/// Arguments of `palpate study`.
#[derive(Args, Clone, Debug)]
pub(super) struct StudyArgs {
    /// Built-in scene, scene file, or - for standard input
    pub(super) scene: Option<String>,
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
    pub(super) tolerance: Option<u32>,
    /// How a tolerance is reached: stein (two stages) or adaptive (JCGM 101, 7.9)
    #[arg(long, value_name = "RULE", value_parser = values::rule, requires = "tolerance")]
    pub(super) rule: Option<values::Rule>,
    /// Stop after so many seconds of replicates
    #[arg(long, value_name = "SECONDS", value_parser = values::seconds)]
    pub(super) budget: Option<f64>,
    /// Replicates A to B (B excluded) of the run alone, to be joined by palpate merge
    #[arg(long, value_name = "A:B", value_parser = values::range, requires = "part")]
    pub(super) range: Option<[u64; 2]>,
    /// Write what the replicates came to, for palpate merge
    #[arg(long, value_name = "F", conflicts_with = "tolerance")]
    pub(super) part: Option<PathBuf>,
    /// Write every replicate, as .csv or .parquet
    #[arg(long, value_name = "F")]
    pub(super) records: Option<PathBuf>,
    /// Keep a checkpoint, and go on from it where there is one
    #[arg(long, value_name = "F")]
    pub(super) checkpoint: Option<PathBuf>,
    /// A quantity beside S and R: k1, k2, radius, direction_deg, or S, R, k1, k2 at a point as in S@0,1.5
    #[arg(long, value_name = "Q", allow_hyphen_values = true)]
    pub(super) quantity: Vec<Quantity>,
    /// Quantiles beside the intervals' ends, as 0.05,0.5
    #[arg(long, value_name = "P,..", value_delimiter = ',')]
    pub(super) quantile: Vec<f64>,
    /// The path to S and R: auto, refit or whole
    #[arg(long, value_name = "PATH", value_parser = values::study_path)]
    pub(super) path: Option<PathChoice>,
    /// Replicates of each design for the shares of the effects; 0: none [default: by the path]
    #[arg(long, value_name = "N")]
    pub(super) attribution: Option<usize>,
    /// Ask of each interval that a fit would print whether it holds the truth
    #[arg(long, conflicts_with_all = ["tolerance", "range", "part", "records",
          "checkpoint", "budget", "quantity", "quantile", "attribution", "asked"])]
    pub(super) coverage: bool,
    /// Repeat the study over a key of the scene: KEY=A:B:logN, KEY=A:B:linN or KEY=A,B,C; several make a grid
    #[arg(long, value_name = "KEY=A:B:logN", allow_hyphen_values = true,
          conflicts_with_all = ["coverage", "range", "part", "records", "checkpoint", "quantity", "quantile", "attribution"])]
    pub(super) sweep: Vec<String>,
    #[command(flatten)]
    pub(super) pictures: PictureFlags,
    #[command(flatten)]
    pub(super) fit: FitFlags,
    #[command(flatten)]
    pub(super) output: OutputFlags,
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
    /// Arguments from the verb on.
    pub(super) fn read(arguments: &[String]) -> Result<StudyArgs, String> {
        Line::try_parse_from(arguments).map(|line| line.study).map_err(|error| error.to_string())
    }

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
            options.tolerance = Some(self.rule.unwrap_or(Tolerance::Stein)(digits));
            // what a scene says is how many there are without a tolerance
            options.replicates_given = self.replicates.is_some();
        }
        options.quantities.extend(&self.quantity);
        options.quantiles.extend(&self.quantile);
        if let Some(PathChoice::Only(path)) = self.path {
            options.path = Some(path);
        }
        options
    }
}

/// Points of the grid times replicates of a design for the shares of the effects, where nobody says how many: some seconds.
const ATTRIBUTION_POINTS: usize = 1 << 26;

/// Whole fits for each replicate of a run that may go into the linear law, and as many again into the shares of the effects where
/// nobody says how many. Either takes a number of fits that the scene decides: who asks for three replicates waits for sixty fits
/// at most, and not for two thousand; from some hundred replicates on most scenes have both.
const BESIDE: u64 = 10;

/// Everything that decides the numbers of a study.
#[derive(Debug)]
pub(super) struct Plan {
    pub(super) name: String,
    pub(super) study: Study,
    pub(super) identity: StudyIdentity,
    /// Replicates of the whole run.
    pub(super) most: u64,
    attribution: usize,
    /// The linear law takes too many fits beside so few replicates.
    without_law: bool,
    /// What is said of that.
    too_dear: Option<String>,
    /// Effects of the scene that are off.
    off: Vec<&'static str>,
    remark: Option<String>,
}

impl Plan {
    /// From the arguments and the scene's text.
    pub(super) fn new(args: &StudyArgs, source: &Source) -> Result<Plan, Failure> {
        let scene = source.scene()?;
        Plan::of_scene(args, &scene)
    }

    /// From the arguments and a scene that was read.
    pub(super) fn of_scene(args: &StudyArgs, scene: &SceneFile) -> Result<Plan, Failure> {
        let wrong = |e: StudyError| Failure::Input(format!("{}: {e}", scene.name));
        if args.fit.asks_own_axes() {
            let what = "--frame auto: every replicate of a study is fitted over one domain, which lies along the input's axes; \
                 palpate run takes the patch's own";
            return Err(Failure::Input(what.into()));
        }
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
        // every replicate of every design is taken over the whole grid
        let [x, y] = fit.grid;
        let affordable = (ATTRIBUTION_POINTS / (x * y)).max(1);
        let attribution = if args.attribution.is_none() { attribution.min(affordable) } else { attribution };
        let mut attribution = if random { attribution } else { 0 };
        let (mut without_law, mut too_dear) = (false, None);
        if study.engine().path() == Path::Whole {
            let fits = most.saturating_mul(BESIDE);
            let affordable = args.attribution.map_or_else(|| study.attribution_within(fits), |_| attribution);
            without_law = study.replicates_of_law() as u64 > fits;
            too_dear = too_dear_of(&study, without_law, attribution > 0 && affordable == 0);
            attribution = attribution.min(affordable);
        }
        let name = scene.name.clone();
        Ok(Plan { name, study, identity, most, attribution, without_law, too_dear, off, remark })
    }

    /// The replicates with the linear law, where it is had in time.
    fn with_law(self: &Arc<Plan>, state: &StudyState, until: Until) -> Option<StudyResult> {
        if self.without_law {
            let mut alone = self.study.replicates_alone(state);
            alone.linear.why = "it was left out".into();
            return Some(alone);
        }
        let (plan, copy) = (Arc::clone(self), state.clone());
        until.wait(move || plan.study.result(&copy, 0))
    }

    /// The most that can be said in time, and what was left out of it: the linear law and the shares of the effects take
    /// fits of their own, as many as the study or more.
    fn result(self: &Arc<Plan>, state: &StudyState, until: Until) -> (StudyResult, Option<&'static str>) {
        let Some(with_law) = self.with_law(state, until) else {
            let mut alone = self.study.replicates_alone(state);
            alone.linear.why = "it was left out".into();
            let what = if self.attribution > 0 {
                "the linear law and the shares of the effects are"
            } else {
                "the linear law is"
            };
            return (alone, Some(what));
        };
        if self.attribution == 0 {
            return (with_law, None);
        }
        const SHARES: &str = "the shares of the effects are";
        if until.is_over() {
            return (with_law, Some(SHARES));
        }
        let (plan, law) = (Arc::clone(self), with_law.linear.clone());
        let shares = move || attribute(plan.study.engine(), plan.study.seed(), plan.attribution, &law);
        match until.wait(shares) {
            Some(attribution) => (StudyResult { attribution: Some(attribution), ..with_law }, None),
            None => (with_law, Some(SHARES)),
        }
    }

    /// The part of a budget that replicates may take: what is said of them afterwards takes fits, too.
    pub(super) fn share_of_replicates(&self) -> f64 {
        if self.attribution > 0 { 0.7 } else { 0.85 }
    }

    /// The document of a state.
    pub(super) fn document(
        self: &Arc<Plan>,
        state: &StudyState,
        stopped: Stopped,
        seconds: f64,
        until: Until,
    ) -> StudyDocument {
        let (result, left_out) = self.result(state, until);
        let failure = state.first_failure.as_ref().map(|(_, why)| why.as_str());
        let mut notes = study_notes(&result, state.failed, failure);
        notes.extend(self.remark.clone());
        notes.extend(self.too_dear.clone());
        if let Some(what) = left_out {
            let why = if interrupt::asked() { "the study was interrupted" } else { "the budget was over" };
            notes.push(format!("{what} left out, because {why}"));
        }
        let engine = self.study.engine();
        let parts: Vec<QuantityPart> = result.quantities.iter().map(QuantityPart::from).collect();
        let others = engine.quantities().iter().map(ToString::to_string).zip(parts.iter().cloned()).skip(2);
        let classes = result.classes.iter().map(|(class, share)| (class.name().to_string(), *share));
        let classes = classes.chain([("none".to_string(), result.no_class)]);
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
            class: Shares(classes.collect()),
            verdict: result.verdict.map(|class| class.name().to_string()),
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

/// What is said where the linear law, the shares of the effects or both are left out beside so few replicates.
fn too_dear_of(study: &Study, law: bool, shares: bool) -> Option<String> {
    let (law_takes, shares_take) = (study.replicates_of_law(), study.replicates_of_shares());
    let (what, fits, it) = match (law, shares) {
        (false, false) => return None,
        (true, false) => ("the linear law is", law_takes, "it takes"),
        (false, true) => ("the shares of the effects are", shares_take, "they take"),
        (true, true) => {
            ("the linear law and the shares of the effects are", law_takes.max(shares_take), "they take up to")
        }
    };
    let enough = (fits as u64).div_ceil(BESIDE);
    Some(format!("{what} left out: {it} {fits} whole fits, which are made from --replicates {enough} on"))
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
