//! The paper's second sweep on its cylinders: what it gains beside touching once more over the first sweep's lattice.
//!
//! ```text
//! first sweep 3 fingers x 9 stations; then 18 touches, by each strategy; error of S, error of R/R: rms over the noise seeds
//! ```

use palpate::FitOptions;
use palpate::fit::{NormalSigma, Objective};
use palpate::scene::{Effect, Surface, Sweep, World};
use palpate_studies::explore::{ExploreOptions, Strategy, explore};
use palpate_world::scene::linspace;
use rayon::prelude::*;

use crate::contacts::options;

/// Contacts of the first sweep and of what follows.
const MADE: [usize; 2] = [27, 45];

fn world(radius: f64, axis_deg: f64) -> World {
    let bar = Surface::cylinder(radius).turned(axis_deg);
    World::new(bar, Sweep::new(vec![-4.0, 0.0, 4.0], linspace(-4.0, 4.0, 9)))
        .with(Effect::position_noise([0.02; 3]))
        .with(Effect::normal_noise(0.03_f64.to_degrees()))
}

pub(crate) fn print(noises: u64) {
    println!(
        "\ncylinders under the paper's sweep (27 contacts), then 18 touches more; {noises} noise seeds; rms errors"
    );
    println!(
        "{:<22} {:<14} {:<13} {:>9} {:>11} {:>12} {:>12} {:>12}",
        "cylinder", "model", "strategy", "S before", "R/R before", "S after", "R/R after", "u(R) x"
    );
    let sensor = Objective::Normals(NormalSigma::Known { z: 0.02, normal_deg: 0.03_f64.to_degrees() });
    let cubic = FitOptions::default().with_degree(3).with_objective(sensor);
    for (radius, axis) in [(10.0, 45.0), (10.0, 0.0), (6.6, 45.0)] {
        for model in [None, Some(&cubic)] {
            for strategy in [Strategy::SecondSweep, Strategy::Lattice, Strategy::Shape] {
                line(radius, axis, model, strategy, noises);
            }
        }
    }
}

fn line(radius: f64, axis: f64, model: Option<&FitOptions>, strategy: Strategy, noises: u64) {
    let runs: Vec<[[f64; 3]; 2]> = (1..=noises)
        .into_par_iter()
        .filter_map(|noise| {
            let options = ExploreOptions {
                per_round: MADE[1] - MADE[0],
                model: model.cloned(),
                ..options(strategy, noise, MADE[1])
            };
            let found = explore(&world(radius, axis), &options, |_| true).ok()?;
            let of = |k: usize| {
                let look = found.looks.get(k)?;
                let (s, r) = (look.shape_index?, look.curvedness?);
                let [ts, tr] = look.truth;
                Some([s.mean - ts?, r.mean / tr? - 1.0, r.u / r.mean])
            };
            Some([of(0)?, of(1)?])
        })
        .collect();
    let rms = |k: usize, q: usize| (runs.iter().map(|r| r[k][q].powi(2)).sum::<f64>() / runs.len() as f64).sqrt();
    let named = if model.is_some() { "degree 3" } else { "recognised" };
    println!(
        "{:<22} {named:<14} {:<13} {:>9.4} {:>11.4} {:>12.4} {:>12.4} {:>12.2}",
        format!("r = {radius} at {axis}"),
        strategy.name(),
        rms(0, 0),
        rms(0, 1),
        rms(1, 0),
        rms(1, 1),
        rms(1, 2) / rms(0, 2)
    );
}
