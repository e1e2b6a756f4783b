//! Do the intervals of a named model hold the truth, and do plane tests err as often as they say?
//!
//! ```text
//! cargo bench --bench intervals -- [REPLICATES [RECOGNISED [NAME]]]
//!
//! noise    shape() of REPLICATES fits: what noise alone makes of S and R
//! total    the same after Fit::with_model_error, of RECOGNISED fits: what `palpate fit` with a named model prints
//! ```
//!
//! Every row is a scene of its own, its seed is 18. Per cent of the truths inside the 95 % interval; the median half width
//! over 1.96 sd of the values; planes: per cent of the fits that are called a plane; class: mean probability of the class
//! that is reported, and the share in which it is the true one. NAME: only scenes whose name holds it.

mod scenes;

use palpate::fit::{Fit, FitOptions, Shape};
use palpate::fit_contacts;
use palpate::geometry::ShapeClass;
use palpate::scene::{Simulator, Truth};
use palpate_app::io::scene_file::read_scene;

type Fault = Box<dyn std::error::Error>;

const SEED: u64 = 18;

/// One fit: truth, value and interval of S and of R; its class with its probability and the true class.
struct Asked {
    truth: [Option<f64>; 2],
    value: [Option<f64>; 2],
    interval: [Option<[f64; 2]>; 2],
    class: ShapeClass,
    forecast: Option<f64>,
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

impl Asked {
    fn new(shape: &Shape, truth: &Truth) -> Asked {
        let (mut s, mut r) = (Vec::new(), Vec::new());
        let maps = &shape.maps;
        for ((i, j), _) in maps.supported.indexed_iter().filter(|(_, supported)| **supported) {
            let Some(point) = truth.at(maps.grid.x[i], maps.grid.y[j]) else { continue };
            s.extend(point.local.shape_index());
            r.push(point.local.curvedness());
        }
        let statistics = [&shape.shape_index, &shape.curvedness];
        Asked {
            truth: [mean(&s), mean(&r)],
            value: statistics.map(|m| m.mean),
            interval: statistics.map(|m| m.interval.map(|i| [i.lo, i.hi])),
            class: shape.class,
            forecast: shape.class_probability.iter().find(|(c, _)| *c == shape.class).map(|(_, p)| *p),
        }
    }

    fn true_class(&self) -> ShapeClass {
        self.truth[0].map_or(ShapeClass::Plane, ShapeClass::of_shape_index)
    }
}

/// What one way of making intervals comes to.
struct Found {
    held: [Option<f64>; 2],
    width: [Option<f64>; 2],
    planes: f64,
    class: Option<[f64; 2]>,
}

fn found(asked: &[Asked]) -> Found {
    /// Rounding of a truth that an interval ends at.
    const ROUNDING: f64 = 1e-9;
    let held = |q: usize| {
        let pairs = asked.iter().filter_map(|a| Some((a.truth[q]?, a.interval[q]?)));
        let inside = pairs.map(|(t, [lo, hi])| f64::from(u8::from(lo - ROUNDING <= t && t <= hi + ROUNDING)));
        mean(&inside.collect::<Vec<f64>>()).map(|share| 100.0 * share)
    };
    let width = |q: usize| {
        let values: Vec<f64> = asked.iter().filter_map(|a| a.value[q]).collect();
        let middle = mean(&values)?;
        let variance = values.iter().map(|v| (v - middle).powi(2)).sum::<f64>() / (values.len() as f64 - 1.0);
        let mut widths: Vec<f64> = asked.iter().filter_map(|a| a.interval[q].map(|[lo, hi]| 0.5 * (hi - lo))).collect();
        widths.sort_unstable_by(f64::total_cmp);
        Some(widths.get(widths.len() / 2)? / (1.96 * variance.sqrt()))
    };
    let share = |of: &dyn Fn(&&Asked) -> bool| asked.iter().filter(of).count() as f64 / asked.len().max(1) as f64;
    let forecasts: Vec<&Asked> = asked.iter().filter(|a| a.forecast.is_some()).collect();
    let given: Vec<f64> = forecasts.iter().filter_map(|a| a.forecast).collect();
    let right: Vec<f64> = forecasts.iter().map(|a| f64::from(u8::from(a.class == a.true_class()))).collect();
    Found {
        held: [held(0), held(1)],
        width: [width(0), width(1)],
        planes: 100.0 * share(&|a| a.class == ShapeClass::Plane),
        class: mean(&given).zip(mean(&right)).map(|(g, r)| [g, r]),
    }
}

fn all(simulator: &Simulator, options: &FitOptions, count: u64, finish: fn(Fit) -> Fit) -> (Vec<Asked>, u64) {
    let one = |b: u64| {
        let (contacts, truth) = simulator.simulate(SEED, b);
        let fit = finish(fit_contacts(&contacts, options).ok()?);
        Some(Asked::new(fit.shape(), &truth))
    };
    let asked: Vec<Asked> = (0..count).filter_map(one).collect();
    let failed = count - asked.len() as u64;
    (asked, failed)
}

fn main() -> Result<(), Fault> {
    let words: Vec<String> = std::env::args().skip(1).filter(|w| !w.starts_with("--")).collect();
    let number = |k: usize, default: u64| words.get(k).map_or(Ok(default), |w| w.parse::<u64>());
    let (replicates, recognised) = (number(0, 2000)?, number(1, 200)?);
    let name = words.get(2).cloned().unwrap_or_default();
    println!("{replicates} fits; total: {recognised} of them. Held: S | R, per cent; width: S | R over 1.96 sd\n");
    println!("| scene | noise: held | width | planes % | class | total: held | width | class | failed |");
    println!("|---|---|---|---|---|---|---|---|---|");
    for (scene, text) in scenes::all().into_iter().filter(|(scene, _)| scene.contains(&name)) {
        let read = read_scene(&text).map_err(|e| format!("{scene}: {e}"))?;
        let simulator = read.world.compile()?;
        let (noise, failed) = all(&simulator, &read.fit, replicates, |fit| fit);
        let (total, _) = all(&simulator, &read.fit, recognised, palpate::recognition::Recognition::beside);
        let pair = |of: [Option<f64>; 2], places: usize| {
            of.map(|v| v.map_or("-".into(), |v| format!("{v:.places$}"))).join(" \\| ")
        };
        let class = |of: Option<[f64; 2]>| of.map_or("-".into(), |[g, r]| format!("{g:.2}, {r:.2}"));
        let [n, t] = [found(&noise), found(&total)];
        println!(
            "| {scene} | {} | {} | {:.1} | {} | {} | {} | {} | {failed} |",
            pair(n.held, 1),
            pair(n.width, 2),
            n.planes,
            class(n.class),
            pair(t.held, 1),
            pair(t.width, 2),
            class(t.class)
        );
    }
    Ok(())
}
