//! `palpate study [SCENE] --coverage`: does each interval that a fit would print hold the truth as often as it says?

use std::io::Write;
use std::path::Path;

use serde::Serialize;

use crate::io::scene_file::{SceneFile, coverage_family, read_scene};
use crate::report::{TablePage, percent, write_json, write_table_page};
use palpate_studies::montecarlo::{
    Family, LeastWidth, RandomSurface, SHARE, StudyError, coverage as covered, noise_of, oracle_sd,
};

use super::coverage_parts::SceneCoverage;
use super::coverage_pooled::{Pooled, pooled, write_pooled};
use super::failure::Failure;
use super::output::print;
use super::progress::Bar;
use super::provenance::provenance;
use super::scene::{self, Source};
use super::study_plan::{Plan, StudyArgs};

/// Replicates that are fitted when nothing else is said.
const REPLICATES: u64 = 2000;
/// Replicates of the study whose errors the Monte Carlo's intervals carry.
const STUDY: u64 = 20_000;

/// Seed of the first random surface when none is said.
const FIRST: u64 = 1;

#[derive(Serialize)]
struct CoverageDocument {
    schema: &'static str,
    level: f64,
    replicates: u64,
    scenes: Vec<SceneCoverage>,
    /// Random surfaces by their kind, and all of them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pooled: Vec<Pooled>,
}

/// A scene whose intervals are judged, the oracle's standard deviations of S and R there, and the least widths.
struct Judged {
    scene: SceneFile,
    oracle: [Option<f64>; 2],
    least: LeastWidth,
}

impl Judged {
    fn new(scene: SceneFile, family: Option<Family>) -> Judged {
        let places = scene.world.compile().map(|simulator| {
            let contacts = simulator.noise_free();
            contacts.x.iter().zip(&contacts.y).map(|(x, y)| [*x, *y]).collect::<Vec<_>>()
        });
        let noise = noise_of(&scene.world);
        let (oracle, least) = match (family, places) {
            (Some(family), Ok(places)) => (oracle_sd(&family, &places, noise), LeastWidth::of(&family, &places, noise)),
            _ => ([None; 2], LeastWidth::default()),
        };
        Judged { scene, oracle, least }
    }

    fn of_source(source: &Source) -> Result<Judged, Failure> {
        let scene = source.scene()?;
        let surface = scene.world.surface.clone();
        Ok(Judged::new(scene, Family::of(&surface)))
    }

    /// The random surface of a seed; its named model is a height field of degree 3 with the noise declared.
    fn random(seed: u64) -> Result<Judged, Failure> {
        let drawn = RandomSurface::new(seed);
        let [z, normal] = noise_of(&drawn.world).map(|sd| sd.unwrap_or(1.0));
        let text = format!(
            "seed = {seed}\n[surface]\nkind = \"plane\"\n[sweep]\nfingers = [0.0]\nfrom = 0.0\nto = 1.0\nstations = 2\n\
             [fit]\ndegree = 3\nsigma = [{z:?}, {:?}]\n",
            normal.to_degrees()
        );
        let template = read_scene(&text).map_err(|e| Failure::Input(format!("{}: {e}", drawn.name)))?;
        let scene = SceneFile { name: drawn.name.clone(), world: drawn.world.clone(), ..template };
        Ok(Judged::new(scene, drawn.family()))
    }
}

/// A member of the family by its name, or any other scene.
fn named(name: &str) -> Result<Source, Failure> {
    let member = coverage_family().into_iter().find(|(member, _)| member == name);
    member.map_or_else(|| scene::source(name), |(name, text)| Ok(Source::of_text(&name, text)))
}

/// The scenes that the arguments ask about.
fn judged(args: &StudyArgs, scene: Option<&str>) -> Result<Vec<Judged>, Failure> {
    match (args.random, scene) {
        (Some(count), _) => (0..count).map(|k| Judged::random(args.seed.unwrap_or(FIRST) + k)).collect(),
        (None, Some(name)) => Ok(vec![Judged::of_source(&named(name)?)?]),
        (None, None) => {
            let texts = coverage_family().into_iter();
            texts.map(|(name, text)| Judged::of_source(&Source::of_text(&name, text))).collect()
        }
    }
}

/// One scene: its study, where the intervals of the Monte Carlo are taken from, and its fits.
fn scene_coverage(args: &StudyArgs, judged: &Judged, replicates: u64) -> Result<SceneCoverage, Failure> {
    let read = &judged.scene;
    let mut fit = args.fit.over(read.fit.clone());
    fit.level = args.level.unwrap_or(read.study.level);
    let study = if args.random.is_some() { replicates } else { STUDY.max(replicates) };
    let mut args = args.clone();
    (args.replicates, args.attribution) = (Some(study), Some(0));
    if args.random.is_some() {
        // each surface has noise of its own: that of the first seed would move all of them the same way
        args.seed = None;
    }
    let plan = Plan::of_scene(&args, read)?;
    let wrong = |e: StudyError| Failure::Input(format!("{}: {e}", plan.name));
    // whole fits are dear: as many as are asked of, no more
    let enough =
        if plan.study.engine().path() == palpate_studies::montecarlo::Path::Whole { replicates } else { plan.most };
    let (state, _) = plan.study.run(plan.study.start(0), enough, &mut |_| true).map_err(wrong)?;
    let result = plan.study.result(&state, 0);
    let found = covered(&plan.study, &fit, replicates, &result.quantities);
    Ok(SceneCoverage::new(&plan, &found, judged.oracle, judged.least))
}

pub(super) fn coverage(args: &StudyArgs, scene: Option<&str>) -> Result<(), Failure> {
    args.output.prepare(&scene.iter().map(Path::new).collect::<Vec<_>>(), &[])?;
    let all = judged(args, scene)?;
    let replicates = args.replicates.unwrap_or(REPLICATES);
    let level = args.level.unwrap_or(all.first().map_or(0.95, |one| one.scene.study.level));
    let bar = Bar::new(&args.output, all.len() as u64, "coverage");
    let mut scenes = Vec::new();
    for one in &all {
        scenes.push(scene_coverage(args, one, replicates)?);
        bar.step(one.scene.name.clone());
    }
    drop(bar);
    let pooled = if args.random.is_some() { pooled(&scenes) } else { Vec::new() };
    let document = CoverageDocument { schema: "palpate.coverage/1", level, replicates, scenes, pooled };
    args.output.file("coverage.json", &mut |out| write_json(&document, out))?;
    args.output.file("coverage.csv", &mut |out| write_csv(&document, out))?;
    let (mut json, mut table) = (Vec::new(), Vec::new());
    // a Vec takes every byte
    let _ = write_json(&document, &mut json).and_then(|()| write_table(&document, &mut table));
    let page = TablePage {
        kind: "coverage: do intervals hold the truth as often as they say?",
        title: scene.unwrap_or("coverage"),
        lead: "Every interval that a fit would print, and how often it held the truth.",
        document: &json,
        table: &table,
    };
    let provenance = provenance(scene.unwrap_or("the family of scenes"), None, args.seed);
    args.output.file("report.html", &mut |out| write_table_page(&page, &provenance, out))?;
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
    let level = percent(document.level);
    writeln!(out, "intervals that hold the truth, per cent of {} fits; {level} are promised", document.replicates)?;
    writeln!(
        out,
        "linear and Monte Carlo: the model that the scene names, by noise alone; named: what other kinds of surface say \
         counted, too; chosen: no model named, the contacts recognised"
    )?;
    writeln!(
        out,
        "least/oracle: the least width of any interval that also holds surfaces up to {} of the relief beside the family, in \
         third and fourth degree",
        percent(SHARE)
    )?;
    let head = ["linear", "Monte Carlo", "bias/sd", "named", "chosen", "width/1.96 sd", "width/oracle", "least/oracle"];
    let [a, b, c, d, e, f, g, h] = head;
    writeln!(out, "{:<24}    {a:>18} {b:>18} {c:>8} {d:>18} {e:>18} {f:>14} {g:>13} {h:>13}  planes failed", "scene")?;
    for scene in &document.scenes {
        for (name, letter, part) in [(&scene.scene[..], "S", &scene.shape_index), ("", "R", &scene.curvedness)] {
            let number = |value: Option<f64>| value.map_or("-".into(), |v| format!("{v:.2}"));
            let counts = if letter == "S" { format!("{:>6} {:>6}", scene.planes, scene.failed) } else { String::new() };
            let line = format!(
                "{name:<24} {letter}  {:>18} {:>18} {:>8} {:>18} {:>18} {:>14} {:>13} {:>13}  {counts}",
                part.linear.words(),
                part.monte_carlo.words(),
                number(part.bias_over_sd),
                part.named.words(),
                part.chosen.words(),
                number(part.chosen_width),
                number(part.chosen_over_oracle),
                number(part.least_over_oracle)
            );
            writeln!(out, "{}", line.trim_end())?;
        }
    }
    write_pooled(&document.pooled, out)
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
            "chosen_over_oracle",
            "named_half_width",
            "least_over_oracle",
            "goal_departure",
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
            let others = [
                part.bias_over_sd,
                part.u_over_sd,
                part.chosen_width,
                part.chosen_half_width,
                part.chosen_over_oracle,
                part.named_half_width,
                part.least_over_oracle,
                part.goal_departure,
            ];
            words.extend(others.map(|v| v.unwrap_or(f64::NAN).to_string()));
        }
        // a path's name may hold a comma
        words[1] = words[1].replace(',', ";");
        writeln!(out, "{}", words.join(","))?;
    }
    Ok(())
}
