//! `palpate study SCENE --coverage`: does each interval that a fit would print hold the truth as often as it says?

use std::io::Write;
use std::path::Path;
use std::sync::{Arc, Mutex};
use std::time::Instant;

use serde::Serialize;

use crate::io::scene_file::SceneFile;
use crate::report::{TablePage, percent, write_json, write_table_page};
use palpate_fitting::fit::FitOptions;
use palpate_studies::montecarlo::{CoverageTally, Path as StudyPath, StudyError, Summary};

use super::coverage_parts::SceneCoverage;
use super::failure::Failure;
use super::interrupt;
use super::output::print;
use super::progress::Bar;
use super::provenance::provenance;
use super::scene::Source;
use super::study_plan::{Plan, StudyArgs};
use super::until::{Until, held};

/// Replicates that are fitted when nothing else is said.
const REPLICATES: u64 = 2000;
/// Ctrl-C loses the block of replicates that it comes in: one grows until it takes so many seconds, and begins with few, because a
/// single fit may take as long.
const FIRST_BLOCK: u64 = 8;
const BLOCK_SECONDS: f64 = 0.2;
/// Replicates of the study whose errors the Monte Carlo's intervals carry.
const STUDY: u64 = 20_000;

#[derive(Serialize)]
struct CoverageDocument {
    schema: &'static str,
    level: f64,
    replicates: u64,
    scenes: Vec<SceneCoverage>,
}

/// The scene's study, where the intervals of the Monte Carlo are taken from, and what its fits came to; the latter are added
/// to `tally` as they are made, so that whoever leaves has those that are done.
struct CoverageWork {
    plan: Plan,
    fit: FitOptions,
    replicates: u64,
    tally: Mutex<CoverageTally>,
    summaries: Mutex<Vec<Summary>>,
}

impl CoverageWork {
    fn new(args: &StudyArgs, scene: &SceneFile, replicates: u64) -> Result<CoverageWork, Failure> {
        let mut fit = args.fit.over(scene.fit.clone());
        fit.level = args.level.unwrap_or(scene.study.level);
        let mut args = args.clone();
        (args.replicates, args.attribution) = (Some(STUDY.max(replicates)), Some(0));
        let plan = Plan::of_scene(&args, scene)?;
        Ok(CoverageWork { plan, fit, replicates, tally: Mutex::default(), summaries: Mutex::default() })
    }

    fn run(&self) -> Result<(), StudyError> {
        let study = &self.plan.study;
        // whole fits are dear: as many as are asked of, no more
        let enough = if study.engine().path() == StudyPath::Whole { self.replicates } else { self.plan.most };
        let (state, _) = study.run(study.start(0), enough, &mut |_| !interrupt::asked())?;
        *held(&self.summaries) = study.replicates_alone(&state).quantities;
        let (mut from, mut block) = (0, FIRST_BLOCK);
        while from < self.replicates && !interrupt::asked() {
            let (clock, to) = (Instant::now(), self.replicates.min(from + block));
            let next = CoverageTally::of(study, &self.fit, [from, to]);
            held(&self.tally).append(next);
            from = to;
            block *= if clock.elapsed().as_secs_f64() < BLOCK_SECONDS { 2 } else { 1 };
        }
        Ok(())
    }

    /// Of the replicates that are fitted by now.
    fn coverage(&self) -> SceneCoverage {
        SceneCoverage::new(&self.plan, &held(&self.tally).coverages(&held(&self.summaries)))
    }
}

pub(super) fn coverage(args: &StudyArgs, name: &str, source: &Source) -> Result<(), Failure> {
    args.output.prepare(&[Path::new(name)], &[])?;
    let scene = source.scene()?;
    let asked = args.replicates.unwrap_or(REPLICATES);
    let level = args.level.unwrap_or(scene.study.level);
    let bar = Bar::new(&args.output, asked, &format!("coverage of {}", scene.name));
    let work = Arc::new(CoverageWork::new(args, &scene, asked)?);
    interrupt::gently();
    let (own, mut shown) = (Arc::clone(&work), 0);
    let look = || {
        let done = held(&work.tally).replicates();
        bar.steps(done - shown);
        shown = done;
        true
    };
    let outcome = Until::interrupted().wait_and(look, move || own.run());
    drop(bar);
    if let Some(Err(error)) = outcome {
        return Err(Failure::Input(format!("{}: {error}", work.plan.name)));
    }
    let done = held(&work.tally).replicates();
    if done == 0 && asked > 0 {
        return Err(Failure::Interrupted(
            "interrupted before the first replicates were fitted; nothing is kept".into(),
        ));
    }
    let scenes = vec![work.coverage()];
    publish(args, name, &CoverageDocument { schema: "palpate.coverage/1", level, replicates: done, scenes })?;
    if done < asked {
        let what = format!("interrupted after {done} of {asked} replicates; what they came to is kept");
        return Err(Failure::Interrupted(what));
    }
    Ok(())
}

fn publish(args: &StudyArgs, name: &str, document: &CoverageDocument) -> Result<(), Failure> {
    args.output.file("coverage.json", &mut |out| write_json(document, out))?;
    args.output.file("coverage.csv", &mut |out| write_csv(document, out))?;
    let (mut json, mut table) = (Vec::new(), Vec::new());
    // a Vec takes every byte
    let _ = write_json(document, &mut json).and_then(|()| write_table(document, &mut table));
    let page = TablePage {
        kind: "coverage: do intervals hold the truth as often as they say?",
        title: name,
        lead: "Every interval that a fit would print, and how often it held the truth.",
        document: &json,
        table: &table,
    };
    let provenance = provenance(name, None, args.seed);
    args.output.file("report.html", &mut |out| write_table_page(&page, &provenance, out))?;
    args.output.publish()?;
    if args.output.json {
        return print(&mut |out| write_json(document, out));
    }
    if args.output.quiet {
        return Ok(());
    }
    args.output.tell(&mut |out| write_table(document, out))
}

fn write_table(document: &CoverageDocument, out: &mut dyn Write) -> std::io::Result<()> {
    let level = percent(document.level);
    writeln!(out, "intervals that hold the truth, per cent of {} fits; {level} are promised", document.replicates)?;
    writeln!(
        out,
        "linear and Monte Carlo: the model that the scene names, by noise alone; named: what other kinds of surface say \
         counted, too; chosen: no model named, the contacts recognised"
    )?;
    let head = ["linear", "Monte Carlo", "bias/sd", "named", "chosen", "width/1.96 sd"];
    let [a, b, c, d, e, f] = head;
    writeln!(out, "{:<24}    {a:>18} {b:>18} {c:>8} {d:>18} {e:>18} {f:>14}  planes failed", "scene")?;
    for scene in &document.scenes {
        for (name, letter, part) in [(&scene.scene[..], "S", &scene.shape_index), ("", "R", &scene.curvedness)] {
            let number = |value: Option<f64>| value.map_or("-".into(), |v| format!("{v:.2}"));
            let counts = if letter == "S" { format!("{:>6} {:>6}", scene.planes, scene.failed) } else { String::new() };
            let line = format!(
                "{name:<24} {letter}  {:>18} {:>18} {:>8} {:>18} {:>18} {:>14}  {counts}",
                part.linear.words(),
                part.monte_carlo.words(),
                number(part.bias_over_sd),
                part.named.words(),
                part.chosen.words(),
                number(part.chosen_width)
            );
            writeln!(out, "{}", line.trim_end())?;
        }
    }
    Ok(())
}

fn write_csv(document: &CoverageDocument, out: &mut dyn Write) -> std::io::Result<()> {
    let of = |name: &str| {
        [
            "linear",
            "linear_lo",
            "linear_hi",
            "mc",
            "mc_lo",
            "mc_hi",
            "named",
            "named_lo",
            "named_hi",
            "chosen",
            "chosen_lo",
            "chosen_hi",
            "bias_over_sd",
            "u_over_sd",
            "chosen_width",
            "chosen_half_width",
            "named_half_width",
        ]
        .map(|what| format!("{name}_{what}"))
        .join(",")
    };
    writeln!(out, "scene,path,fitted,failed,planes,{},{}", of("S"), of("R"))?;
    for scene in &document.scenes {
        let mut words =
            vec![scene.scene.clone(), scene.path.clone(), scene.fitted.to_string(), scene.failed.to_string()];
        words.push(scene.planes.to_string());
        for part in [&scene.shape_index, &scene.curvedness] {
            for held in [&part.linear, &part.monte_carlo, &part.named, &part.chosen] {
                let ends = held.interval.unwrap_or([f64::NAN; 2]);
                words.extend([held.share.unwrap_or(f64::NAN), ends[0], ends[1]].map(|v| v.to_string()));
            }
            let others =
                [part.bias_over_sd, part.u_over_sd, part.chosen_width, part.chosen_half_width, part.named_half_width];
            words.extend(others.map(|v| v.unwrap_or(f64::NAN).to_string()));
        }
        // a path's name may hold a comma
        words[1] = words[1].replace(',', ";");
        writeln!(out, "{}", words.join(","))?;
    }
    Ok(())
}
