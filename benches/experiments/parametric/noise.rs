//! With noise: the same draws for the surface in space and for the height field.

use rayon::prelude::*;

use crate::worlds::{self, Case, SEED, cylinder, sphere};

/// What came of one replicate: S, R r at the contacts, and whether the map is free of folds.
type Outcome = Option<([f64; 3], bool)>;

pub(crate) fn print(replicates: u64) {
    println!("\nnoise 0.02 on positions, 0.03 rad on normals, {replicates} replicates; S and R r at the contacts");
    for case in [sphere(5.7), sphere(6.0), cylinder(5.7, 45.0), cylinder(6.0, 45.0)] {
        for degree in [3, 4] {
            study(&case, degree, replicates);
        }
    }
}

fn study(case: &Case, degree: usize, replicates: u64) {
    let world = worlds::world(case, true);
    let options = worlds::options(degree, 1);
    let clock = std::time::Instant::now();
    let found: Vec<(Outcome, Outcome)> = (0..replicates)
        .into_par_iter()
        .map(|replicate| {
            let (contacts, _) = world.simulate(SEED, replicate);
            let space = worlds::parametric(&contacts, &options).ok();
            let height = worlds::height(&contacts, &options).ok();
            (
                space.map(|fit| (worlds::at_contacts(&fit, case.radius), fit.certificate().fold_free)),
                height.map(|fit| (worlds::height_at_contacts(&fit, &contacts, case.radius), true)),
            )
        })
        .collect();
    let seconds = clock.elapsed().as_secs_f64();
    tell(case, degree, "parametric", found.iter().map(|f| &f.0));
    tell(case, degree, "height", found.iter().map(|f| &f.1));
    println!("    {:.2} ms a replicate", 1e3 * seconds / replicates as f64);
}

fn tell<'a>(case: &Case, degree: usize, kind: &str, found: impl Iterator<Item = &'a Outcome>) {
    let all: Vec<&Outcome> = found.collect();
    let good: Vec<&([f64; 3], bool)> = all.iter().filter_map(|o| o.as_ref()).collect();
    let n = good.len() as f64;
    let s = good.iter().map(|g| g.0[0]).sum::<f64>() / n;
    let sd = (good.iter().map(|g| (g.0[0] - s).powi(2)).sum::<f64>() / (n - 1.0)).sqrt();
    let least = good.iter().map(|g| g.0[0]).fold(f64::INFINITY, f64::min);
    let r = good.iter().map(|g| g.0[2]).sum::<f64>() / n;
    let within = good.iter().filter(|g| (g.0[2] / case.curvedness - 1.0).abs() < 0.2).count();
    let folded = good.iter().filter(|g| !g.1).count();
    println!(
        "{:<22} degree {degree} {kind:<11} S {s:.4} (sd {sd:.4}, least {least:.3}; truth {})  R r {r:.4}  within 20 %: {:.3}  folds {folded}  refused {}",
        case.name,
        case.shape_index,
        within as f64 / all.len() as f64,
        all.len() - good.len()
    );
}
