//! Random surfaces by their kind: how often their intervals held the truth, how wide they were, and how far the values lay off.
//!
//! ```text
//! inside = sum of intervals that held the truth / sum of those asked        over the surfaces of a kind
//! error of S: value - truth        error of R: (value - truth)/truth        median, and what 90 % of the sizes do not exceed
//! ```

use std::io::Write;

use serde::Serialize;

use super::coverage_parts::{ErrorPart, SceneCoverage, reached};

/// One quantity over the surfaces of a kind.
#[derive(Serialize)]
struct PooledQuantity {
    inside: Option<f64>,
    asked: u64,
    /// Median over the surfaces of the half width over the oracle's.
    over_oracle: Option<f64>,
    error: ErrorPart,
}

/// The surfaces of one kind.
#[derive(Serialize)]
pub(super) struct Pooled {
    kind: String,
    surfaces: usize,
    #[serde(rename = "S")]
    shape_index: PooledQuantity,
    #[serde(rename = "R")]
    curvedness: PooledQuantity,
    /// Mean probability given to the reported class, and the share in which it is the true one.
    class_forecast: Option<[f64; 2]>,
}

impl Pooled {
    fn new(kind: &str, own: &[&SceneCoverage]) -> Pooled {
        let quantity = |of_s: bool| {
            let parts: Vec<_> = own.iter().map(|s| if of_s { &s.shape_index } else { &s.curvedness }).collect();
            let asked: u64 = parts.iter().map(|p| p.chosen.asked).sum();
            let inside: u64 = parts.iter().map(|p| p.chosen.inside).sum();
            PooledQuantity {
                inside: (asked > 0).then(|| inside as f64 / asked as f64),
                asked,
                over_oracle: reached(parts.iter().filter_map(|p| p.chosen_over_oracle).collect(), 0.5),
                error: ErrorPart::new(parts.iter().flat_map(|p| p.chosen_error.all.clone()).collect()),
            }
        };
        let forecasts: Vec<[f64; 2]> = own.iter().filter_map(|s| s.class_forecast).collect();
        let mean = |k: usize| forecasts.iter().map(|f| f[k]).sum::<f64>() / forecasts.len() as f64;
        Pooled {
            kind: kind.into(),
            surfaces: own.len(),
            shape_index: quantity(true),
            curvedness: quantity(false),
            class_forecast: (!forecasts.is_empty()).then(|| [mean(0), mean(1)]),
        }
    }
}

/// Kind of a random surface: its name up to the first dash.
fn kind_of(scene: &SceneCoverage) -> &str {
    scene.scene.split('-').next().unwrap_or_default()
}

/// The kinds in order of their names, and all surfaces.
pub(super) fn pooled(scenes: &[SceneCoverage]) -> Vec<Pooled> {
    let mut kinds: Vec<&str> = scenes.iter().map(kind_of).collect();
    kinds.sort_unstable();
    kinds.dedup();
    let of_kind = |kind: &str| Pooled::new(kind, &scenes.iter().filter(|s| kind_of(s) == kind).collect::<Vec<_>>());
    let all = Pooled::new("all", &scenes.iter().collect::<Vec<_>>());
    kinds.into_iter().map(of_kind).chain([all]).collect()
}

/// The table below that of the surfaces.
pub(super) fn write_pooled(pooled: &[Pooled], out: &mut dyn Write) -> std::io::Result<()> {
    if pooled.is_empty() {
        return Ok(());
    }
    writeln!(
        out,
        "\nno model named, by kind; class: probability given to the reported class, and how often it is right"
    )?;
    let [inside, width, median, most] = ["inside, %", "width/oracle", "median error", "90 % of errors"];
    let (kind, class) = ("kind", "class");
    writeln!(out, "{kind:<14} {:>8}    {inside:>10} {width:>13} {median:>13} {most:>15}   {class}", "surfaces")?;
    for one in pooled {
        for (letter, part) in [("S", &one.shape_index), ("R", &one.curvedness)] {
            let number = |value: Option<f64>, digits: usize| value.map_or("-".into(), |v| format!("{v:.digits$}"));
            let error = |value: Option<f64>| match letter {
                "S" => number(value, 3),
                _ => value.map_or("-".into(), |v| format!("{:.1} %", 100.0 * v)),
            };
            let head = match letter {
                "S" => format!("{:<14} {:>8}", one.kind, one.surfaces),
                _ => String::new(),
            };
            let class = one.class_forecast.filter(|_| letter == "S");
            let line = format!(
                "{head:<23} {letter}  {:>10} {:>13} {:>13} {:>15}   {}",
                number(part.inside.map(|v| 100.0 * v), 1),
                number(part.over_oracle, 2),
                error(part.error.median),
                format!("< {}", error(part.error.of_90_percent)),
                class.map_or(String::new(), |[given, right]| format!("{given:.2}, {right:.2}"))
            );
            writeln!(out, "{}", line.trim_end())?;
        }
    }
    Ok(())
}
