//! `palpate study [SCENE] --coverage`: does each interval that a fit would print hold the truth as often as it says?

use std::io::Write;
use std::path::Path;

use serde::Serialize;

use crate::io::scene_file::coverage_family;
use crate::montecarlo::{Coverages, Held, StudyError, coverage as covered};
use crate::report::write_json;

use super::failure::Failure;
use super::output::print;
use super::progress::Bar;
use super::scene::{self, Source};
use super::study_plan::{Plan, StudyArgs};

/// Replicates that are fitted when nothing else is said.
const REPLICATES: u64 = 2000;
/// Replicates of the study whose errors the Monte Carlo's intervals carry.
const STUDY: u64 = 20_000;

#[derive(Serialize)]
struct HeldPart {
    share: Option<f64>,
    interval: Option<[f64; 2]>,
    asked: u64,
}

#[derive(Serialize)]
struct QuantityCoverage {
    linear: HeldPart,
    monte_carlo: HeldPart,
    chosen: HeldPart,
    chosen_width: Option<f64>,
    bias_over_sd: Option<f64>,
    u_over_sd: Option<f64>,
}

#[derive(Serialize)]
struct SceneCoverage {
    scene: String,
    path: String,
    fitted: u64,
    failed: u64,
    planes: u64,
    /// Mean probability given to the reported class, and the share in which it is the true one.
    class_forecast: Option<[f64; 2]>,
    #[serde(rename = "S")]
    shape_index: QuantityCoverage,
    #[serde(rename = "R")]
    curvedness: QuantityCoverage,
}

#[derive(Serialize)]
struct CoverageDocument {
    schema: &'static str,
    level: f64,
    replicates: u64,
    scenes: Vec<SceneCoverage>,
}

impl HeldPart {
    fn new(held: &Held) -> HeldPart {
        HeldPart { share: held.share(), interval: held.interval.map(|i| [i.lo, i.hi]), asked: held.asked }
    }

    fn words(&self) -> String {
        match (self.share, self.interval) {
            (Some(share), Some([lo, hi])) => {
                format!("{:.1} [{:.1}, {:.1}]", 100.0 * share, 100.0 * lo, 100.0 * hi)
            }
            _ => "-".into(),
        }
    }
}

impl SceneCoverage {
    fn new(plan: &Plan, found: &Coverages) -> SceneCoverage {
        let part = |q: usize| QuantityCoverage {
            linear: HeldPart::new(&found.linear[q]),
            monte_carlo: HeldPart::new(&found.monte_carlo[q]),
            chosen: HeldPart::new(&found.chosen[q]),
            chosen_width: found.chosen_width[q],
            bias_over_sd: found.bias[q],
            u_over_sd: found.u_ratio[q],
        };
        SceneCoverage {
            scene: plan.name.clone(),
            path: plan.study.engine().path().name().into(),
            fitted: found.fitted,
            failed: found.failed,
            planes: found.planes,
            class_forecast: found.class_forecast,
            shape_index: part(0),
            curvedness: part(1),
        }
    }
}

pub(super) fn coverage(args: &StudyArgs, scene: Option<&str>) -> Result<(), Failure> {
    args.output.prepare(&scene.iter().map(Path::new).collect::<Vec<_>>(), &[])?;
    let sources: Vec<Source> = match scene {
        Some(name) => vec![scene::source(name)?],
        None => coverage_family().into_iter().map(|(name, text)| Source::of_text(&name, text)).collect(),
    };
    let replicates = args.replicates.unwrap_or(REPLICATES);
    let bar = Bar::new(&args.output, sources.len() as u64, "coverage");
    let mut scenes = Vec::new();
    let mut level = 0.95;
    for source in &sources {
        let read = source.read().map_err(|e| Failure::Input(format!("{}: {e}", source.name)))?;
        let mut fit = args.fit.over(read.fit.clone());
        level = args.level.unwrap_or(read.study.level);
        fit.level = level;
        let mut args = args.clone();
        (args.replicates, args.attribution) = (Some(STUDY.max(replicates)), Some(0));
        let plan = Plan::of_scene(&args, &read)?;
        let wrong = |e: StudyError| Failure::Input(format!("{}: {e}", plan.name));
        // whole fits are dear: as many as are asked of, no more
        let enough = if plan.study.engine().path() == crate::montecarlo::Path::Whole { replicates } else { plan.most };
        let (state, _) = plan.study.run(plan.study.start(0), enough, &mut |_| true).map_err(wrong)?;
        let result = plan.study.result(&state, 0);
        let found = covered(&plan.study, &fit, replicates, &result.quantities);
        scenes.push(SceneCoverage::new(&plan, &found));
        bar.step(plan.name.clone());
    }
    drop(bar);
    let document = CoverageDocument { schema: "palpate.coverage/1", level, replicates, scenes };
    args.output.file("coverage.json", &mut |out| write_json(&document, out))?;
    args.output.file("coverage.csv", &mut |out| write_csv(&document, out))?;
    args.output.publish()?;
    if args.output.json {
        return print(&mut |out| write_json(&document, out));
    }
    if args.output.quiet {
        return Ok(());
    }
    print(&mut |out| write_table(&document, out))
}

fn write_table(document: &CoverageDocument, out: &mut dyn Write) -> std::io::Result<()> {
    let level = 100.0 * document.level;
    writeln!(out, "intervals that hold the truth, per cent of {} fits; {level} are promised", document.replicates)?;
    writeln!(
        out,
        "linear and Monte Carlo: the model that the scene names; chosen: no model named, the contacts recognised"
    )?;
    let head = ["linear", "Monte Carlo", "bias/sd", "chosen", "width/1.96 sd"];
    let [a, b, c, d, e] = head;
    writeln!(out, "{:<24}    {a:>18} {b:>18} {c:>8} {d:>18} {e:>14}  planes failed", "scene")?;
    for scene in &document.scenes {
        for (name, letter, part) in [(&scene.scene[..], "S", &scene.shape_index), ("", "R", &scene.curvedness)] {
            let number = |value: Option<f64>| value.map_or("-".into(), |v| format!("{v:.2}"));
            let counts = if letter == "S" { format!("{:>6} {:>6}", scene.planes, scene.failed) } else { String::new() };
            let line = format!(
                "{name:<24} {letter}  {:>18} {:>18} {:>8} {:>18} {:>14}  {counts}",
                part.linear.words(),
                part.monte_carlo.words(),
                number(part.bias_over_sd),
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
            "chosen",
            "chosen_lo",
            "chosen_hi",
            "bias_over_sd",
            "u_over_sd",
            "chosen_width",
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
            for held in [&part.linear, &part.monte_carlo, &part.chosen] {
                let ends = held.interval.unwrap_or([f64::NAN; 2]);
                words.extend([held.share.unwrap_or(f64::NAN), ends[0], ends[1]].map(|v| v.to_string()));
            }
            let others = [part.bias_over_sd, part.u_over_sd, part.chosen_width];
            words.extend(others.map(|v| v.unwrap_or(f64::NAN).to_string()));
        }
        // a path's name may hold a comma
        words[1] = words[1].replace(',', ";");
        writeln!(out, "{}", words.join(","))?;
    }
    Ok(())
}
