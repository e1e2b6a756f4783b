//! A scene with another way of fitting written into it.

use toml::{Table, Value};

use palpate_fitting::fit::{FitOptions, NormalSigma, Objective, SlopeWeights, SurfaceKind};
use palpate_studies::frontier::Choice;

use super::failure::Failure;
use super::scene::Source;

/// Keys that name a model: without them a scene's contacts are recognised.
const NAMING: [&str; 9] = ["surface", "closed", "degree", "segments", "domain", "weights", "sigma", "smooth", "method"];

/// The scene's TOML with what was picked in the place of its own. What else stands there stays.
pub(super) fn emitted(source: &Source, choice: &Choice) -> Result<String, Failure> {
    let wrong = |why: String| Failure::Input(format!("{}: {why}", source.name));
    let mut scene: Table = toml::from_str(&source.text).map_err(|e| wrong(e.to_string()))?;
    if choice.recognised {
        unname(&mut scene);
    } else {
        write_fit(table(&mut scene, "fit").map_err(wrong)?, &choice.options);
    }
    if let Some(count) = choice.stations {
        write_stations(table(&mut scene, "sweep").map_err(wrong)?, count).map_err(wrong)?;
    }
    toml::to_string(&scene).map_err(|e| wrong(e.to_string()))
}

fn table<'a>(scene: &'a mut Table, name: &str) -> Result<&'a mut Table, String> {
    let part = scene.entry(name).or_insert_with(|| Value::Table(Table::new()));
    part.as_table_mut().ok_or_else(|| format!("{name} is no table of the scene"))
}

/// Takes out what names a model, and a table that holds nothing else.
fn unname(scene: &mut Table) {
    let Some(fit) = scene.get_mut("fit").and_then(Value::as_table_mut) else { return };
    fit.retain(|key, value| !NAMING.contains(&key) && (key != "frame" || value.as_str() != Some("keep")));
    if fit.is_empty() {
        scene.remove("fit");
    }
}

fn write_fit(fit: &mut Table, options: &FitOptions) {
    let count = |n: usize| Value::Integer(n as i64);
    let pair = |[p, q]: [usize; 2]| if p == q { count(p) } else { Value::Array(vec![count(p), count(q)]) };
    fit.insert("degree".into(), pair(options.degree));
    fit.insert("segments".into(), pair(options.segments));
    if options.surface == SurfaceKind::Height {
        fit.remove("surface");
        fit.remove("closed");
    } else {
        fit.insert("surface".into(), options.surface.name().into());
    }
    fit.remove("weights");
    fit.remove("sigma");
    let numbers = |list: &[f64]| Value::Array(list.iter().map(|v| Value::Float(*v)).collect());
    match options.objective {
        // a scene has no word for it; with normals, which scenes have, it is this one
        Objective::Auto => fit.insert("sigma".into(), "auto".into()),
        Objective::Normals(NormalSigma::Auto) => fit.insert("sigma".into(), "auto".into()),
        Objective::Normals(NormalSigma::Known { z, normal_deg }) => {
            fit.insert("sigma".into(), numbers(&[z, normal_deg]))
        }
        Objective::Slopes(SlopeWeights::Explicit(weights)) => fit.insert("weights".into(), numbers(&weights)),
        Objective::Slopes(weights) => {
            let word = SlopeWeights::WORDS.iter().find(|(_, known)| *known == weights).map_or("auto", |(word, _)| word);
            fit.insert("weights".into(), word.into())
        }
    };
}

/// Stations between the same ends; a list of places, which is even where stations are varied, becomes its two ends.
fn write_stations(sweep: &mut Table, count: usize) -> Result<(), String> {
    if let Some(list) = sweep.remove("at") {
        let list = list.as_array().cloned().unwrap_or_default();
        let (Some(first), Some(last)) = (list.first(), list.last()) else {
            return Err("sweep.at holds no stations".into());
        };
        sweep.insert("from".into(), first.clone());
        sweep.insert("to".into(), last.clone());
    }
    sweep.insert("stations".into(), Value::Integer(count as i64));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_emitted_scene_reads_back_as_what_was_chosen() {
        let text = crate::io::scene_file::builtin_text("paper-cylinder").unwrap().into_owned();
        let source = Source::of_text("paper-cylinder", text);
        let options = FitOptions {
            degree: [3, 4],
            segments: [1, 2],
            objective: Objective::Normals(NormalSigma::Auto),
            ..source.read().unwrap().fit
        };
        let mut choice = Choice {
            options: options.clone(),
            stations: Some(12),
            recognised: false,
            label: String::new(),
            errors: [0.0; 2],
            replicates: 1,
            seconds: 1.0,
            met: true,
            obstacle: None,
        };
        let again = source.with_text(emitted(&source, &choice).unwrap()).read().unwrap();
        assert_eq!(again.fit, options);
        assert!(again.names_a_model && again.world.sweeps[0].stations.len() == 12);
        assert_eq!(again.world.surface, source.read().unwrap().world.surface);
        choice.recognised = true;
        let again = source.with_text(emitted(&source, &choice).unwrap()).read().unwrap();
        assert!(!again.names_a_model && again.world.sweeps[0].stations.len() == 12);
    }
}
