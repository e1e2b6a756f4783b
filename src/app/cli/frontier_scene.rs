//! The frontiers of a scene, whose truth is known.

use std::time::Instant;

use crate::io::scene_file::SceneFile;
use crate::io::{ContactFormat, ReadOptions, read_input_bytes, write_atomically, write_contacts};
use crate::report::{
    AskedPart, FRONTIER_SCHEMA, FrontierDocument, FrontierRecord, PickPart, StagePart, inverse_crime_remark,
};
use palpate_numeric::simd::Isa;
use palpate_studies::frontier::{
    Choice, Frontier, FrontierError, IntervalSubject, Measured, Point, REPLICATES, Request, SolverSubject, Stage,
    Subject, Watch, check_truth, choose, mark, mark_solvers, of_fit, of_replicate,
};

use super::failure::Failure;
use super::frontier_args::{FrontierArgs, message};
use super::frontier_counts::{Counts, count, make_calls};
use super::frontier_emit::emitted;
use super::scene::Source;

/// Everything that is timed.
struct Frontiers<'a> {
    ways: Subject,
    solvers: Option<SolverSubject>,
    intervals: Option<IntervalSubject<'a>>,
    notes: Vec<String>,
}

impl<'a> Frontiers<'a> {
    /// `counted`: one replicate of each, and no reference.
    fn new(
        args: &FrontierArgs,
        scene: &'a SceneFile,
        seed: u64,
        counted: bool,
    ) -> Result<Frontiers<'a>, FrontierError> {
        let most = if counted { 1 } else { REPLICATES };
        let ways = Subject::with_replicates(&scene.world, &scene.fit, seed, !args.keep_stations, most)?;
        if args.bare {
            return Ok(Frontiers { ways: ways.bare(), solvers: None, intervals: None, notes: Vec::new() });
        }
        let mut notes = Vec::new();
        let contacts = scene.world.compile()?.simulate(seed, 0).0;
        let solvers = SolverSubject::new(&scene.name, &contacts, &scene.fit);
        notes.extend(solvers.notes().iter().cloned());
        let intervals = match IntervalSubject::new(&scene.world, &scene.fit, seed, counted)? {
            Ok(intervals) => Some(intervals),
            Err(why) => {
                notes.push(format!("no frontier of intervals: {why}"));
                None
            }
        };
        Ok(Frontiers { ways, solvers: Some(solvers), intervals, notes })
    }

    /// Makes every call once, in the order in which counts come back.
    fn make_calls(&self) {
        palpate_numeric::threads::alone(|| {
            make_calls(&mut self.ways.calls());
            self.solvers.iter().for_each(|solvers| make_calls(&mut solvers.calls()));
            self.intervals.iter().for_each(|intervals| make_calls(&mut intervals.calls()));
        });
    }
}

/// Steps that a watch is told of each frontier.
const STEPS: usize = 100;

/// How much is done of rounds that end after so many seconds or so many rounds, whichever comes first.
pub(super) fn done_share(began: Instant, seconds: f64, [round, most]: [usize; 2]) -> f64 {
    let by_time = began.elapsed().as_secs_f64() / seconds;
    (round as f64 / most.max(1) as f64).max(by_time).clamp(0.0, 0.99)
}

/// What was measured of all three frontiers.
struct Found {
    ways: Vec<Measured>,
    solvers: Vec<Point>,
    intervals: Vec<Point>,
}

impl Found {
    /// Measures all of them; the watch is told hundredths of each, one after the other. `None` where it ended them.
    fn measure(frontiers: &Frontiers<'_>, seconds: f64, watch: Watch<'_>) -> Option<Found> {
        let steps = STEPS * (1 + usize::from(frontiers.solvers.is_some()) + usize::from(frontiers.intervals.is_some()));
        let part = |number: usize| move |round: usize, most: usize| watch(STEPS * number + STEPS * round / most, steps);
        let (ways, solvers, intervals) = (&frontiers.ways, &frontiers.solvers, &frontiers.intervals);
        let began = Instant::now();
        let found = Found {
            ways: ways.measure(seconds, &|round, most| {
                watch((STEPS as f64 * done_share(began, seconds, [round, most])) as usize, steps)
            }),
            solvers: solvers.as_ref().map_or(Vec::new(), |solvers| solvers.measure(&part(1))),
            intervals: intervals.as_ref().map_or(Vec::new(), |intervals| intervals.measure(&part(2))),
        };
        watch(steps, steps).then_some(found)
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
    let scene = source.scene()?;
    let wrong = |error: FrontierError| Failure::Input(format!("{}: {}", scene.name, message(&error)));
    let seed = args.seed.unwrap_or(scene.seed);
    if args.counted {
        Frontiers::new(args, &scene, seed, true).map_err(wrong)?.make_calls();
        return Ok(None);
    }
    args.output.prepare(&[name.as_ref()], args.emit.as_slice())?;
    let spinner = args.output.spinner(format!("measuring {}", scene.name));
    let frontiers = Frontiers::new(args, &scene, seed, false).map_err(wrong)?;
    if let Some(request) = request {
        check_truth(&frontiers.ways, request).map_err(wrong)?;
    }
    let told = |done: usize, all: usize| {
        spinner.part(done, all);
        watch(done, all)
    };
    let Some(mut found) = Found::measure(&frontiers, args.seconds, &told) else { return Ok(None) };
    let stages = if args.bare { Vec::new() } else { stages(&scene, seed).map_err(wrong)? };
    drop(spinner);
    let spinner = args.output.spinner("counting instructions");
    let each = frontiers.ways.calls_each();
    let counts = counts(args, name, seed, each * found.ways.len() + found.solvers.len() + found.intervals.len());
    drop(spinner);
    take_counts(&mut found, &counts, each);
    let picked = request.map(|request| choose(&found.ways, request)).transpose().map_err(wrong)?;
    let mut document = document(&scene, seed, &found, &counts)?;
    document.stages = stages.iter().map(|stage| stage_part(stage, &stages)).collect();
    document.notes.extend(frontiers.notes.iter().cloned());
    if let (Some(choice), Some(request)) = (&picked, request) {
        let text = emitted(source, &choice.options, choice.stations)?;
        document.pick = Some(pick_part(choice, request, Some(&text)));
        if let Some(path) = &args.emit {
            write_atomically(path, &mut |out| out.write_all(text.as_bytes()))?;
        }
    }
    Ok(Some(document))
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
    if args.uncounted {
        return Err("not counted: --uncounted".into());
    }
    if name == "-" {
        return Err("not counted: standard input cannot be read a second time".into());
    }
    let seed = seed.to_string();
    let mut arguments = vec!["frontier", name, "--seed", &seed];
    arguments.extend(args.keep_stations.then_some("--keep-stations"));
    arguments.extend(args.bare.then_some("--bare"));
    count(&arguments, calls)
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
    Ok(FrontierDocument {
        scene: scene.name.clone(),
        reference: "the scene's truth".into(),
        seed,
        counter: match counts {
            Ok(_) => "callgrind, one call of the first replicate by the AVX2 path".into(),
            Err(why) => why.clone(),
        },
        points: ways.chain(solvers).chain(intervals).collect(),
        notes: inverse_crime_remark(&simulator.truth()).into_iter().collect(),
        ..empty_document()
    })
}

/// A document of this machine in which nothing was measured.
pub(super) fn empty_document() -> FrontierDocument {
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
        seconds: choice.seconds,
        asked: AskedPart { error_S: request.error_s, error_R: request.error_r, budget: request.budget },
        met: choice.met,
        obstacle: choice.obstacle.clone(),
        scene: text.map(String::from),
    }
}
