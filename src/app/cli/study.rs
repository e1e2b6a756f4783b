//! `palpate study SCENE`: intervals of S and R over replicates, the shares of the effects, and how far all of it is known.
//!
//! ```text
//! replicates -> tallies -> means, intervals, shares       until the number, the tolerance or the budget says stop
//! ```

use std::io::Write;
use std::path::Path as FilePath;
use std::sync::Arc;
use std::sync::mpsc::{RecvTimeoutError, channel, sync_channel};
use std::time::Instant;

use crate::io::{RecordFormat, Records, StudyFile, read_study, write_study};
use crate::report::{
    INTERRUPTED, Provenance, StudyDocument, stopped_words, write_json, write_study_page, write_study_picture,
    write_study_table,
};
use palpate_studies::montecarlo::{Path, Progress, Stopped, StudyError, StudyState};

use super::failure::Failure;
use super::options::{OutputFlags, PictureFlags};
use super::output::{columns, print};
use super::progress::Bar;
use super::provenance::provenance;
use super::scene::Source;
use super::study_plan::{Plan, StudyArgs};
use super::until::{LOOK, Until};
use super::{coverage, interrupt, scene, sweep};
/// Seconds between two checkpoints.
const CHECKPOINT_SECONDS: f64 = 1.0;

pub(super) fn study(args: &StudyArgs) -> Result<(), Failure> {
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
    // what the scene names is an input, too
    source.scene()?;
    if args.coverage {
        return coverage::coverage(args, name, &source);
    }
    if !args.sweep.is_empty() {
        return sweep::sweep(args, &source);
    }
    let outputs: Vec<_> = [&args.part, &args.records, &args.checkpoint].into_iter().flatten().cloned().collect();
    args.output.prepare(&[name.as_ref()], &outputs)?;
    let plan = Arc::new(Plan::new(args, &source)?);
    run(args, &plan, source)
}

fn run(args: &StudyArgs, plan: &Arc<Plan>, source: Source) -> Result<(), Failure> {
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
    interrupt::gently();
    let bar = Bar::new(&args.output, range[1] - range[0], &plan.name);
    let (clock, mut saved) = (Instant::now(), Instant::now());
    let mut fault: Option<Failure> = None;
    // of a study that is gone on with, the seconds before count too
    let until = Until::seconds_after(clock, args.budget.map(|budget| (budget - before).max(0.0)));
    let for_replicates = args.budget.map(|budget| budget * plan.share_of_replicates());
    let replicates_until = Until::seconds_after(clock, for_replicates.map(|budget| (budget - before).max(0.0)));
    let outcome = replicates(plan, state, range[1], replicates_until, &mut |progress| {
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
        if let Some(budget) = args.budget.filter(|_| args.tolerance.is_some()) {
            fault = out_of_reach(args, progress.state.done(), progress.end - progress.state.from, seconds, budget);
        }
        fault.is_none() && !replicates_until.is_over()
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
    let mut document = plan.document(&state, stopped, seconds, until);
    drop(spinner);
    // what was done before the interrupt came may have been all
    let cut_short = interrupt::asked() && stopped == Stopped::Budget;
    if cut_short {
        document.stopped = INTERRUPTED.into();
    }
    let provenance = provenance(&source.name, Some(source.text), Some(plan.study.seed()));
    tell(
        &args.output,
        plan,
        &document,
        &state,
        &PageExtras { provenance, asked: range[1] - range[0], pictures: &args.pictures },
    )?;
    if cut_short {
        let done = state.done();
        return Err(Failure::Interrupted(format!("interrupted after {done} replicates; what they came to is kept")));
    }
    Ok(())
}

/// Runs the replicates. Whole fits may take seconds each and hundreds make a chunk: they are made by a thread of their own, and
/// what the last whole chunk left is taken where the time is over in the middle of one.
fn replicates(
    plan: &Arc<Plan>,
    state: StudyState,
    to: u64,
    until: Until,
    watch: &mut dyn FnMut(&Progress<'_>) -> bool,
) -> Result<(StudyState, Stopped), StudyError> {
    if plan.study.engine().path() != Path::Whole {
        return plan.study.run(state, to, watch);
    }
    let (send, chunks) = sync_channel(0);
    let (answer, answers) = channel();
    let (own, start) = (Arc::clone(plan), state.clone());
    let worker = std::thread::spawn(move || {
        own.study.run(start, to, &mut |progress| {
            let chunk = (progress.state.clone(), progress.values.clone(), progress.end);
            send.send(chunk).is_ok() && answers.recv().unwrap_or(false)
        })
    });
    let mut last = state;
    loop {
        match chunks.recv_timeout(LOOK) {
            Ok((seen, values, end)) => {
                last = seen;
                let goes_on = watch(&Progress { state: &last, columns: &values.columns, end, values: &values });
                // the worker ends when it is told so, or when nobody answers
                let _ = answer.send(goes_on);
            }
            Err(RecvTimeoutError::Timeout) if until.is_over() => return Ok((last, Stopped::Budget)),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => {
                return worker.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            }
        }
    }
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

/// What the page says beside the document.
pub(super) struct PageExtras<'a> {
    pub(super) provenance: Provenance,
    /// Replicates that were asked for.
    pub(super) asked: u64,
    /// Kinds of pictures.
    pub(super) pictures: &'a PictureFlags,
}

/// The document wherever the flags ask for it.
pub(super) fn tell(
    output: &OutputFlags,
    plan: &Plan,
    document: &StudyDocument,
    state: &StudyState,
    told: &PageExtras<'_>,
) -> Result<(), Failure> {
    output.file("study.json", &mut |out| write_json(document, out))?;
    if output.out.is_some() {
        let ranked = [state.tallies[0].ranked(), state.tallies[1].ranked()];
        let picture = |format, out: &mut dyn Write| write_study_picture(document, &ranked, format, out);
        told.pictures.write(output, "study", &picture)?;
        let mut page = |out: &mut dyn Write| write_study_page(document, &ranked, told.asked, &told.provenance, out);
        output.file("report.html", &mut page)?;
    }
    output.publish()?;
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
    // a tolerance or a budget ends a run before its last replicate, and says so itself
    let is_part = document.stopped == Stopped::Replicates.name() && document.range != [0, plan.identity.replicates];
    if is_part {
        shown.notes.push(format!("replicates {} to {} alone", document.range[0], document.range[1]));
    }
    output.tell(&mut |out| write_study_table(&shown, columns(), out))
}

/// Where a part says its scene came from.
pub(super) fn source_of(file: &StudyFile, args: &StudyArgs) -> Source {
    Source::of_text(args.scene.as_deref().unwrap_or("-"), file.scene.clone())
}

/// A part of a study.
pub(super) fn part(path: &FilePath) -> Result<StudyFile, Failure> {
    read_study(path).map_err(|e| Failure::Input(e.to_string()))
}
