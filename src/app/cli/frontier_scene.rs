//! The frontiers of a scene, whose truth is known.

use std::sync::Arc;
use std::time::Instant;

use crate::io::scene_file::SceneFile;
use crate::io::{ContactFormat, ReadOptions, read_input_bytes, write_atomically, write_contacts};
use crate::report::{
    AskedPart, FRONTIER_SCHEMA, FrontierDocument, FrontierRecord, PickPart, RecommendedPart, StagePart,
    inverse_crime_remark,
};
use palpate_numeric::simd::Isa;
use palpate_studies::frontier::{
    Choice, Frontier, FrontierError, IntervalSubject, Measured, Point, REPLICATES, Request, Shortlist, SolverSubject,
    Stage, Subject, Watch, check_truth, choose, clock_spread, mark, mark_solvers, of_fit, of_replicate, shortlist,
};

use super::failure::Failure;
use super::frontier_args::{FrontierArgs, message};
use super::frontier_counts::{Counts, count, make_calls, uncounted};
use super::frontier_emit::emitted;
use super::frontier_measuring::{measured, nothing_yet, unreached};
use super::interrupt;
use super::scene::Source;
use super::until::Until;

/// What is timed, and how.
#[derive(Clone)]
struct Asked {
    scene: Arc<SceneFile>,
    seed: u64,
    /// Half and twice as many stations are tried too.
    vary: bool,
    /// Intervals, solvers and ways to an interval are timed too.
    all: bool,
    seconds: f64,
}

impl Asked {
    /// The ways of fitting, on so many replicates.
    fn ways(&self, replicates: u64) -> Result<Subject, FrontierError> {
        let scene = &self.scene;
        let ways = Subject::with_replicates(&scene.world, &scene.fit, self.seed, self.vary, replicates)?;
        Ok(if self.all { ways } else { ways.bare() })
    }

    fn solvers(&self) -> Result<SolverSubject, FrontierError> {
        let contacts = self.scene.world.compile()?.simulate(self.seed, 0).0;
        Ok(SolverSubject::new(&self.scene.name, &contacts, &self.scene.fit))
    }

    fn intervals(&self, counted: bool) -> Result<Result<IntervalSubject<'_>, String>, FrontierError> {
        IntervalSubject::new(&self.scene.world, &self.scene.fit, self.seed, counted)
    }

    /// Makes every call once, in the order in which counts come back: one replicate of each, and no reference.
    fn make_calls(&self) -> Result<(), FrontierError> {
        let ways = self.ways(1)?;
        let solvers = if self.all { Some(self.solvers()?) } else { None };
        let intervals = if self.all { self.intervals(true)?.ok() } else { None };
        palpate_numeric::threads::alone(|| {
            make_calls(&mut ways.calls());
            solvers.iter().for_each(|solvers| make_calls(&mut solvers.calls()));
            intervals.iter().for_each(|intervals| make_calls(&mut intervals.calls()));
        });
        Ok(())
    }
}

/// Steps that a watch is told of each frontier.
const STEPS: usize = 100;
/// Seconds after which intervals are given up that are not there, where the ways take no more: most scenes need a tenth of it.
const INTERVAL_SECONDS: f64 = 60.0;

/// How much is done of rounds that end after so many seconds or so many rounds, whichever comes first.
pub(super) fn done_share(began: Instant, seconds: f64, [round, most]: [usize; 2]) -> f64 {
    let by_time = began.elapsed().as_secs_f64() / seconds;
    (round as f64 / most.max(1) as f64).max(by_time).clamp(0.0, 0.99)
}

/// What was measured of all three frontiers.
#[derive(Default)]
struct Found {
    ways: Vec<Measured>,
    solvers: Vec<Point>,
    intervals: Vec<Point>,
    notes: Vec<String>,
    /// Methods of solvers and of intervals that there are, measured or not.
    methods: usize,
}

impl Found {
    /// Measures all of them, one after the other; what Ctrl-C does not leave time for is left out. The watch is told
    /// hundredths of each.
    fn measure(asked: &Asked, ways: &Arc<Subject>, watch: Watch<'_>) -> Result<Found, FrontierError> {
        let steps = STEPS * if asked.all { 3 } else { 1 };
        let mut found = Found::default();
        let (ledger, began, seconds) = (Arc::new(ways.ledger()), Instant::now(), asked.seconds);
        let seen = |round: usize, most: usize| {
            watch((STEPS as f64 * done_share(began, seconds, [round, most])) as usize, steps)
        };
        let (own, entered) = (Arc::clone(ways), Arc::clone(&ledger));
        let until = Until::interrupted();
        // the ledger holds what there is, whether or not it came to an end
        let _ = measured(until, &seen, move |watch| own.measure_into(&entered, seconds, watch));
        found.ways = ways.measured(&ledger);
        if !asked.all || interrupt::asked() {
            return Ok(found);
        }
        let part =
            |number: usize| move |round: usize, most: usize| watch(STEPS * number + STEPS * round / most.max(1), steps);
        let own = asked.clone();
        let solvers = measured(until, &part(1), move |watch| {
            own.solvers().map(|all| (all.measure(own.seconds, watch), all.notes().to_vec(), all.calls().len()))
        });
        (found.solvers, found.notes, found.methods) = solvers.transpose()?.unwrap_or_default();
        if interrupt::asked() {
            return Ok(found);
        }
        let until = Until::seconds_after(Instant::now(), Some(seconds.max(INTERVAL_SECONDS)));
        let own = asked.clone();
        let intervals = measured(until, &part(2), move |watch| {
            let all = own.intervals(false)?;
            Ok::<_, FrontierError>(all.map(|all| (all.measure(own.seconds, watch), all.calls().len())))
        });
        match intervals.transpose()? {
            Some(Ok((points, methods))) => {
                found.intervals = points;
                found.methods += methods;
            }
            Some(Err(why)) => found.notes.push(format!("no frontier of intervals: {why}")),
            None => found.notes.push("no frontier of intervals: its reference was not done in time".into()),
        }
        Ok(found)
    }
}

/// The document of a scene; `None` where the calls were made for a counter alone, or the watch ended them.
pub(super) fn measure(
    args: &FrontierArgs,
    name: &str,
    source: &Source,
    request: Option<&Request>,
    watch: Watch<'_>,
) -> Result<Option<FrontierDocument>, Failure> {
    let scene = Arc::new(source.scene()?);
    let wrong = |error: FrontierError| Failure::Input(format!("{}: {}", scene.name, message(&error)));
    let seed = args.seed.unwrap_or(scene.seed);
    let (all, seconds) = (args.all, args.seconds);
    let vary = !args.keep_stations && (request.is_some() || all || args.count.is_some() || args.counted);
    let asked = Asked { scene: Arc::clone(&scene), seed, vary, all, seconds };
    if args.counted {
        return asked.make_calls().map(|()| None).map_err(wrong);
    }
    args.output.prepare(&[name.as_ref()], args.emit.as_slice())?;
    let spinner = args.output.spinner(format!("measuring {}", scene.name));
    interrupt::gently();
    let own = asked.clone();
    let ways = Until::interrupted().wait(move || own.ways(REPLICATES)).ok_or_else(nothing_yet)?;
    let ways = Arc::new(ways.map_err(wrong)?.asked(request));
    if let Some(request) = request {
        check_truth(&ways, request).map_err(wrong)?;
    }
    let told = |done: usize, all: usize| {
        spinner.part(done, all);
        watch(done, all)
    };
    let mut found = Found::measure(&asked, &ways, &told).map_err(wrong)?;
    // whoever watches wants all or nothing
    let steps = STEPS * if all { 3 } else { 1 };
    if !watch(steps, steps) {
        return Ok(None);
    }
    found.notes.extend(unreached(seconds, found.ways.len(), ways.ways())?);
    drop(spinner);
    finished(args, (name, source), &asked, (found, &ways), request).map(Some)
}

/// The document with stages, counts and what was picked.
fn finished(
    args: &FrontierArgs,
    (name, source): (&str, &Source),
    asked: &Asked,
    (mut found, ways): (Found, &Subject),
    request: Option<&Request>,
) -> Result<FrontierDocument, Failure> {
    let (scene, seed) = (&asked.scene, asked.seed);
    let wrong = |error: FrontierError| Failure::Input(format!("{}: {}", scene.name, message(&error)));
    let own = asked.clone();
    let stages = match args.stages && !interrupt::asked() {
        false => Vec::new(),
        true => {
            let stages = Until::interrupted().wait(move || stages(&own.scene, own.seed));
            stages.transpose().map_err(wrong)?.unwrap_or_default()
        }
    };
    let each = ways.calls_each();
    let methods = found.solvers.len() + found.intervals.len();
    let called = each * found.ways.len() + methods;
    // a count is told from others by its place among all calls
    let whole = found.ways.len() == ways.ways() && methods == found.methods && !interrupt::asked();
    let counts = match whole || args.count.is_none() {
        true => counts(args, name, seed, called),
        false => Err("not counted: not every call was timed".into()),
    };
    take_counts(&mut found, &counts, each);
    found.notes.extend(args.counting_seconds().and_then(|seconds| uncounted(&counts, called, seconds)));
    let picked = request.map(|request| choose(&found.ways, request)).transpose().map_err(wrong)?;
    let mut document = document(scene, seed, &found, &counts)?;
    document.stages = stages.iter().map(|stage| stage_part(stage, &stages)).collect();
    document.notes.extend(found.notes);
    if let (Some(choice), Some(request)) = (&picked, request) {
        let text = emitted(source, choice)?;
        document.pick = Some(pick_part(choice, request, Some(&text)));
        if let Some(path) = &args.emit {
            write_atomically(path, &mut |out| out.write_all(text.as_bytes()))?;
        }
    }
    Ok(document)
}

/// Stages of the scene's own fit, read from a table in memory, and of its replicates.
fn stages(scene: &SceneFile, seed: u64) -> Result<Vec<Stage>, FrontierError> {
    let contacts = scene.world.compile()?.simulate(seed, 0).0;
    let mut table = Vec::new();
    // writing to memory cannot fail
    let _ = write_contacts(&contacts, ContactFormat::Csv, None, &mut table);
    let read = || {
        let _ = std::hint::black_box(read_input_bytes("contacts.csv", &table, &ReadOptions::default()));
    };
    let mut stages = of_fit(&contacts, &scene.fit, &read);
    stages.extend(of_replicate(&scene.world, &scene.fit, seed));
    Ok(stages)
}

fn stage_part(stage: &Stage, all: &[Stage]) -> StagePart {
    // a difference of two times may come out below zero where it is nothing
    let time = |stage: &Stage| stage.time.median.max(0.0);
    let whole: f64 = all.iter().filter(|other| other.of == stage.of).map(time).sum();
    StagePart {
        of: stage.of.into(),
        stage: stage.name.into(),
        seconds: stage.time,
        share: if whole > 0.0 { time(stage) / whole } else { 0.0 },
        saved_by: stage.saved_by.into(),
    }
}

fn counts(args: &FrontierArgs, name: &str, seed: u64, calls: usize) -> Counts {
    let Some(seconds) = args.counting_seconds() else { return Err("not counted: --count does".into()) };
    if name == "-" {
        return Err("not counted: standard input cannot be read a second time".into());
    }
    let _spinner = args.output.spinner("counting instructions");
    let seed = seed.to_string();
    let mut arguments = vec!["frontier", name, "--seed", &seed];
    arguments.extend(args.keep_stations.then_some("--keep-stations"));
    arguments.extend(args.all.then_some("--all"));
    count(&arguments, calls, seconds)
}

/// Gives every point its count, in the order of the calls.
fn take_counts(found: &mut Found, counts: &Counts, each: usize) {
    let Ok(counts) = counts else { return };
    let (ways, others) = counts.split_at((each * found.ways.len()).min(counts.len()));
    for (measured, own) in found.ways.iter_mut().zip(ways.chunks_exact(each)) {
        measured.point.instructions = own.first().copied();
        measured.point.instructions_interval = own.get(1).copied();
    }
    for (point, count) in found.solvers.iter_mut().chain(&mut found.intervals).zip(others) {
        point.instructions = Some(*count);
    }
    mark(&mut found.ways);
    mark_solvers(&mut found.solvers);
    mark_solvers(&mut found.intervals);
}

fn document(scene: &SceneFile, seed: u64, found: &Found, counts: &Counts) -> Result<FrontierDocument, Failure> {
    let record = |frontier: Frontier| move |point: &Point| FrontierRecord::new(frontier, &scene.name, point);
    let ways = found.ways.iter().map(|measured| &measured.point).map(record(Frontier::Discretisation));
    let solvers = found.solvers.iter().map(record(Frontier::Solver));
    let intervals = found.intervals.iter().map(record(Frontier::Interval));
    let simulator = scene.world.compile().map_err(|e| Failure::Input(format!("{}: {e}", scene.name)))?;
    let mut first = shown_first(&found.ways, true);
    first.notes.extend(inverse_crime_remark(&simulator.truth()));
    Ok(FrontierDocument {
        scene: scene.name.clone(),
        reference: "the scene's truth".into(),
        seed,
        counter: counts.as_ref().map_or_else(String::clone, |_| COUNTER.into()),
        points: ways.chain(solvers).chain(intervals).collect(),
        ..first
    })
}

/// Who counts instructions, and of what.
const COUNTER: &str = "callgrind, one call of the first replicate by the AVX2 path";

/// From so many times its quickest round on a call is timed by a noisy clock.
const NOISY: f64 = 1.3;

/// A document of this machine with what is shown first of these ways, which are its first points.
pub(super) fn shown_first(ways: &[Measured], truth_known: bool) -> FrontierDocument {
    let Shortlist { rows, taken, why } = shortlist(ways, truth_known);
    let points: Vec<Point> = ways.iter().map(|way| way.point.clone()).collect();
    let noisy = clock_spread(&points).filter(|spread| *spread > NOISY).map(|spread| {
        format!(
            "this machine was busy: half of the rounds took {spread:.1} times as long as the quickest or longer, and times are those of \
             the quickest"
        )
    });
    FrontierDocument {
        shortlist: rows,
        recommended: taken.map(|point| RecommendedPart { point, label: points[point].label.clone(), why: why.into() }),
        notes: noisy.into_iter().collect(),
        ..empty_document()
    }
}

/// A document of this machine in which nothing was measured.
fn empty_document() -> FrontierDocument {
    FrontierDocument {
        schema: FRONTIER_SCHEMA,
        scene: String::new(),
        reference: String::new(),
        seed: 0,
        build: env!("CARGO_PKG_VERSION").into(),
        isa: Isa::active().name().into(),
        threads: 1,
        counter: String::new(),
        points: Vec::new(),
        shortlist: Vec::new(),
        recommended: None,
        beside: Vec::new(),
        stages: Vec::new(),
        pick: None,
        notes: Vec::new(),
        seconds: 0.0,
    }
}

/// What was picked; `text` is the scene that says so.
pub(super) fn pick_part(choice: &Choice, request: &Request, text: Option<&str>) -> PickPart {
    let finite = |error: f64| error.is_finite().then_some(error);
    PickPart {
        label: choice.label.clone(),
        error_S: finite(choice.errors[0]),
        error_R: finite(choice.errors[1]),
        replicates: choice.replicates,
        seconds: choice.seconds,
        asked: AskedPart { error_S: request.error_s, error_R: request.error_r, budget: request.budget },
        met: choice.met,
        obstacle: choice.obstacle.clone(),
        scene: text.map(String::from),
    }
}
