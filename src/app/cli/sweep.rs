//! `palpate study SCENE --sweep KEY=A:B:logN`: the study over any key of the scene, several keys as a grid.
//!
//! Every point has the same seed, so that points differ by the key and not by their draws.

use std::io::Write;
use std::sync::Arc;
use std::time::Instant;

use serde::Serialize;
use toml::{Table, Value};

use crate::io::scene_file::SceneFileError;
use crate::io::write_parquet;
use crate::report::{
    StudyDocument, SweepPage, SweepPoint, significant, sweep_columns, write_json, write_sweep_csv, write_sweep_page,
    write_sweep_picture, write_sweep_table,
};

use super::failure::Failure;
use super::interrupt;
use super::output::print;
use super::progress::Bar;
use super::provenance::provenance;
use super::scene::Source;
use super::study_plan::{Plan, StudyArgs};
use super::until::Until;
use palpate_studies::montecarlo::StudyError;

/// Most points of a grid.
const MOST_POINTS: usize = 100_000;

/// One key with its values.
#[derive(Clone, Debug, PartialEq)]
struct Axis {
    key: String,
    values: Vec<f64>,
}

#[derive(Serialize)]
struct SweepDocument<'a> {
    schema: &'static str,
    scene: &'a str,
    seed: u64,
    replicates: u64,
    level: f64,
    keys: Vec<&'a str>,
    points: &'a [SweepPoint],
}

fn axis(text: &str) -> Result<Axis, Failure> {
    let wrong = || {
        Failure::Input(format!(
            "--sweep {text}: KEY=A:B:logN, KEY=A:B:linN or KEY=A,B,C is needed, as effects.position_noise.sigma=0.001:0.1:log10"
        ))
    };
    let (key, range) = text.split_once('=').ok_or_else(wrong)?;
    let number = |text: &str| text.trim().parse::<f64>().ok().filter(|v| v.is_finite()).ok_or_else(wrong);
    let parts: Vec<&str> = range.split(':').collect();
    let values = match parts[..] {
        [list] => list.split(',').map(number).collect::<Result<Vec<f64>, Failure>>()?,
        [a, b, steps] => {
            let (a, b) = (number(a)?, number(b)?);
            let (logarithmic, count) = match (steps.strip_prefix("log"), steps.strip_prefix("lin")) {
                (Some(count), _) => (true, count),
                (_, Some(count)) => (false, count),
                _ => (false, steps),
            };
            let count = count.parse::<usize>().ok().filter(|n| (2..=MOST_POINTS).contains(n)).ok_or_else(wrong)?;
            if logarithmic && !(a > 0.0 && b > 0.0) {
                return Err(Failure::Input(format!("--sweep {text}: both ends of a logarithmic sweep are above 0")));
            }
            let at = |k: usize| {
                let t = k as f64 / (count - 1) as f64;
                match (k, logarithmic) {
                    (0, _) => a,
                    (k, _) if k + 1 == count => b,
                    (_, true) => (a.ln() + t * (b.ln() - a.ln())).exp(),
                    (_, false) => a + t * (b - a),
                }
            };
            (0..count).map(at).collect()
        }
        _ => return Err(wrong()),
    };
    if key.is_empty() || key.split('.').any(str::is_empty) {
        return Err(wrong());
    }
    Ok(Axis { key: key.into(), values })
}

/// Puts a number where the key says; tables that the key passes through are made.
fn put(table: &mut Table, key: &str, value: Value) -> Result<(), String> {
    let (path, last) = key.rsplit_once('.').unwrap_or(("", key));
    let mut home = table;
    for word in path.split('.').filter(|word| !word.is_empty()) {
        let next = home.entry(word).or_insert_with(|| Value::Table(Table::new()));
        home = next.as_table_mut().ok_or_else(|| format!("{word} is no table of the scene"))?;
    }
    home.insert(last.into(), value);
    Ok(())
}

/// The scene at one point of the grid: whole numbers are tried as such where a key takes no other.
fn scene_at(source: &Source, axes: &[Axis], at: &[f64]) -> Result<Source, Failure> {
    let base: Table = toml::from_str(&source.text).map_err(|e| Failure::Input(format!("{}: {e}", source.name)))?;
    let named = |keys: &str, why: String| Failure::Input(format!("--sweep {keys}: {why}"));
    let with = |whole: &[bool]| -> Result<Source, Failure> {
        let mut table = base.clone();
        for ((axis, value), whole) in axes.iter().zip(at).zip(whole) {
            let value = if *whole { Value::Integer(*value as i64) } else { Value::Float(*value) };
            put(&mut table, &axis.key, value).map_err(|why| named(&axis.key, why))?;
        }
        let text = toml::to_string(&table).map_err(|e| named("", e.to_string()))?;
        Ok(source.with_text(text))
    };
    let mut whole = vec![false; axes.len()];
    for tried in 0..=axes.len() {
        let trial = with(&whole)?;
        let error = match trial.read() {
            Ok(_) => return Ok(trial),
            Err(error) => error,
        };
        // lines and columns of the error are those of the text with the key put in: the key says more
        let blamed = |axis: &Axis| match &error {
            SceneFileError::Value { key, .. } => *key == axis.key,
            SceneFileError::Unknown { name, .. } => axis.key.split('.').any(|word| word == name),
            _ => false,
        };
        let Some(k) = axes.iter().position(blamed) else {
            let keys: Vec<String> = axes.iter().zip(at).map(|(axis, v)| format!("{}={v}", axis.key)).collect();
            return Err(named(&keys.join(" "), error.to_string()));
        };
        let is_value = matches!(error, SceneFileError::Value { .. });
        if !is_value || whole[k] || at[k].fract() != 0.0 || tried == axes.len() {
            let why = match &error {
                SceneFileError::Unknown { name, nearest, known, .. } => {
                    format!("there is no `{name}` in a scene{nearest}; known here: {known}")
                }
                SceneFileError::Value { found, expected, .. } => format!("{found}; {expected}"),
                other => other.to_string(),
            };
            return Err(named(&axes[k].key, why));
        }
        whole[k] = true;
    }
    with(&whole)
}

/// One point of the sweep.
fn point_of(args: &StudyArgs, scene: &Source) -> Result<StudyDocument, Failure> {
    let plan = Arc::new(Plan::new(args, scene)?);
    let wrong = |e: StudyError| Failure::Input(format!("{}: {e}", plan.name));
    let (state, stopped) = plan.study.run(plan.study.start(0), plan.most, &mut |_| true).map_err(wrong)?;
    Ok(plan.document(&state, stopped, 0.0, Until::interrupted()))
}

pub(super) fn sweep(args: &StudyArgs, source: &Source) -> Result<(), Failure> {
    args.output.prepare(&[source.name.as_ref()], &[])?;
    let axes: Vec<Axis> = args.sweeps().iter().map(|text| axis(text)).collect::<Result<_, _>>()?;
    let count = axes.iter().try_fold(1_usize, |n, axis| n.checked_mul(axis.values.len()).filter(|n| *n <= MOST_POINTS));
    let Some(count) = count else {
        return Err(Failure::Input(format!("--sweep: a grid of more than {MOST_POINTS} points")));
    };
    let mut args = args.clone();
    args.attribution = Some(0);
    let bar = Bar::new(&args.output, count as u64, &source.name);
    let mut points = Vec::with_capacity(count);
    let mut level = 0.95;
    let mut head = (String::new(), 0, 0);
    interrupt::gently();
    let until = Until::seconds_after(Instant::now(), args.budget);
    for number in 0..count {
        if until.is_over() && number > 0 {
            break;
        }
        let mut rest = number;
        let mut at = vec![0.0; axes.len()];
        for (value, axis) in at.iter_mut().zip(&axes).rev() {
            *value = axis.values[rest % axis.values.len()];
            rest /= axis.values.len();
        }
        let (own, scene) = (args.clone(), scene_at(source, &axes, &at)?);
        let Some(outcome) = until.wait(move || point_of(&own, &scene)) else { break };
        let document = outcome?;
        level = document.level;
        head = (document.scene.clone(), document.seed, document.replicates);
        points.push(SweepPoint::new(at.clone(), &document));
        let keys = axes.iter().map(|axis| axis.key.rsplit('.').next().unwrap_or_default());
        let reached = keys.zip(&at).map(|(key, value)| format!("{key} {}", significant(*value, 4)));
        bar.step(reached.collect::<Vec<_>>().join(", "));
    }
    drop(bar);
    if points.is_empty() {
        return Err(match interrupt::asked() {
            true => Failure::Interrupted("interrupted before the first point was done; nothing is kept".into()),
            false => Failure::Input("--budget is over before the first point of the sweep is done: raise it".into()),
        });
    }
    let keys: Vec<&str> = axes.iter().map(|axis| axis.key.as_str()).collect();
    let (scene, seed, replicates) = head;
    let document = SweepDocument {
        schema: "palpate.sweep/1",
        scene: &scene,
        seed,
        replicates,
        level,
        keys: keys.clone(),
        points: &points,
    };
    args.output.file("sweep.json", &mut |out| write_json(&document, out))?;
    args.output.file("sweep.csv", &mut |out| write_sweep_csv(&keys, &points, out))?;
    if args.output.out.is_some() {
        let (names, columns) = sweep_columns(&keys, &points);
        args.output.file("sweep.parquet", &mut |out| write_parquet("point", &names, &columns, out))?;
        let mut json = Vec::new();
        // a Vec takes every byte
        let _ = write_json(&document, &mut json);
        let page = SweepPage { scene: &scene, keys: &keys, points: &points, asked: count, level, document: &json };
        let provenance = provenance(&source.name, Some(source.text.clone()), Some(seed));
        args.output.file("report.html", &mut |out| write_sweep_page(&page, &provenance, out))?;
        let picture =
            |format, out: &mut dyn std::io::Write| write_sweep_picture(&scene, &keys, &points, level, format, out);
        args.pictures.write(&args.output, "sweep", &picture)?;
    }
    args.output.publish()?;
    if args.output.json {
        print(&mut |out| write_json(&document, out))?;
    } else if !args.output.quiet {
        args.output.tell(&mut |out| write_sweep_table(&keys, &points, out))?;
    }
    let done = points.len();
    if done < count && !interrupt::asked() {
        // standard error may be closed; the table has the points that there are
        let _ =
            writeln!(std::io::stderr(), "palpate: the budget was over after {done} of {count} points; these are kept");
        return Ok(());
    }
    if done < count {
        return Err(Failure::Interrupted(format!("interrupted after {done} of {count} points; these are kept")));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_logarithmic_linear_or_listed() {
        let log = axis("effects.position_noise.sigma=0.001:0.1:log3").unwrap();
        assert_eq!(log.key, "effects.position_noise.sigma");
        assert!((log.values[1] - 0.01).abs() < 1e-15 && log.values[2] == 0.1);
        assert_eq!(axis("surface.radius=1:3:lin3").unwrap().values, [1.0, 2.0, 3.0]);
        assert_eq!(axis("fit.degree=2,3").unwrap().values, [2.0, 3.0]);
        for wrong in ["", "a", "a=", "=1:2:3", "a=1:2", "a=0:1:log5", "a=1:2:log1", "a..b=1", "a=1:2:logx"] {
            assert!(axis(wrong).is_err(), "{wrong}");
        }
    }
}
