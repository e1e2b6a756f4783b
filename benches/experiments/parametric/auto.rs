//! Every paper scene under `auto`: which kind it chose, and the errors of both kinds against the truth.

use palpate::fit::SurfaceKind;
use palpate::parametric::FittedSurface;
use palpate::scene::Truth;
use palpate_app::io::scene_file::{builtin, builtin_scenes, family_members};

pub(crate) fn print() {
    println!("\npaper scenes under auto: rms error of S and of R (relative) over each kind's own grid");
    println!("{:<34} {:<11} {:<22} {:<22} why", "scene", "chosen", "height", "parametric");
    for scene in builtin_scenes().into_iter().chain(family_members()) {
        let Ok(file) = builtin(&scene.name) else { continue };
        let Ok(world) = file.world.compile() else { continue };
        let (contacts, truth) = world.simulate(file.seed, 0);
        let fit = |surface| FittedSurface::of(&contacts, &file.fit.clone().with_surface(surface));
        let text = |found: Result<(FittedSurface, String), palpate::fit::FitError>| match found {
            Ok((surface, _)) => errors(&surface, &truth),
            Err(error) => error.to_string().chars().take(22).collect(),
        };
        let auto = file.fit.clone().with_surface(SurfaceKind::Auto);
        let (chosen, why) = palpate_fitting::parametric::choose_surface(&contacts, &auto);
        let space = file
            .fit
            .clone()
            .with_surface(SurfaceKind::Parametric)
            .with_degrees(file.fit.degree.map(|p| p.max(3))[0], file.fit.degree.map(|p| p.max(3))[1]);
        println!(
            "{:<34} {:<11} {:<22} {:<22} {why}",
            scene.name,
            chosen.name(),
            text(fit(SurfaceKind::Height)),
            text(FittedSurface::of(&contacts, &space))
        );
    }
}

fn errors(found: &FittedSurface, truth: &Truth) -> String {
    let (mut s2, mut r2, mut n, mut m) = (0.0, 0.0, 0.0_f64, 0.0_f64);
    let mut add = |s: f64, r: f64, local: palpate_world::scene::surface::Local| {
        r2 += (r / local.curvedness() - 1.0).powi(2);
        n += 1.0;
        if let Some(true_s) = local.shape_index().filter(|_| s.is_finite()) {
            s2 += (s - true_s).powi(2);
            m += 1.0;
        }
    };
    match found {
        FittedSurface::Height(fit) => {
            let maps = &fit.shape().maps;
            for ((i, j), _) in maps.supported.indexed_iter().filter(|(_, s)| **s) {
                let Some(point) = truth.at(maps.grid.x[i], maps.grid.y[j]) else { continue };
                add(maps.shape_index[[i, j]], maps.curvedness[[i, j]], point.local);
            }
        }
        FittedSurface::Parametric(fit) => {
            let maps = &fit.shape().maps;
            for (at, _) in maps.supported.indexed_iter().filter(|(_, s)| **s) {
                let Some(local) = truth.near(maps.points[at], maps.normals[at]) else { continue };
                add(maps.shape_index[at], maps.curvedness[at], local);
            }
        }
    }
    format!("{:.4}  {:.4}", (s2 / m).sqrt(), (r2 / n).sqrt())
}
