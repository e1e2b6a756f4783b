//! The paper's patch on balls and bars, and what a fit of it says.

use palpate::Contacts;
use palpate::fit::{Fit, FitOptions, NormalSigma, Objective, Smooth, SurfaceKind, fit_contacts};
use palpate::parametric::ParametricFit;
use palpate::scene::{Effect, Simulator, Surface, Sweep, World};
use palpate_world::scene::linspace;

pub(crate) const SEED: u64 = 1997;
pub(crate) const SIGMA: f64 = 0.02;
pub(crate) const SIGMA_NORMAL: f64 = 0.03;

#[derive(Clone)]
pub(crate) struct Case {
    pub name: String,
    pub surface: Surface,
    pub radius: f64,
    pub shape_index: f64,
    pub curvedness: f64,
}

pub(crate) fn sphere(radius: f64) -> Case {
    Case {
        name: format!("sphere r = {radius}"),
        surface: Surface::sphere(radius),
        radius,
        shape_index: 1.0,
        curvedness: 1.0,
    }
}

pub(crate) fn cylinder(radius: f64, angle: f64) -> Case {
    Case {
        name: format!("cylinder r = {radius} at {angle}"),
        surface: Surface::cylinder(radius).turned(angle),
        radius,
        shape_index: 0.5,
        curvedness: 0.5_f64.sqrt(),
    }
}

pub(crate) fn world(case: &Case, noisy: bool) -> Simulator {
    let sweep = Sweep::new(vec![-4.0, 0.0, 4.0], linspace(-4.0, 4.0, 9));
    let world = World::new(case.surface.clone(), sweep);
    let world = if noisy {
        world.with(Effect::position_noise([SIGMA; 3])).with(Effect::normal_noise(SIGMA_NORMAL.to_degrees()))
    } else {
        world
    };
    world.compile().expect("the patch lies on the body")
}

pub(crate) fn options(degree: usize, segments: usize) -> FitOptions {
    FitOptions::default()
        .with_surface(SurfaceKind::Parametric)
        .with_degree(degree)
        .with_segments(segments, segments)
        .with_objective(Objective::Normals(NormalSigma::Known { z: SIGMA, normal_deg: SIGMA_NORMAL.to_degrees() }))
        .with_smooth(Smooth::Lambda(30.0))
}

/// S, its spread, R r at the contacts' feet.
pub(crate) fn at_contacts(fit: &ParametricFit, radius: f64) -> [f64; 3] {
    let surface = fit.input_surface().expect("finite");
    let shapes: Vec<[f64; 2]> = fit
        .feet()
        .iter()
        .filter_map(|p| surface.at(p[0], p[1]).principal())
        .map(|p| [p.shape_index().unwrap_or(f64::NAN), p.curvedness() * radius])
        .collect();
    summary(&shapes)
}

pub(crate) fn height_at_contacts(fit: &Fit, contacts: &Contacts, radius: f64) -> [f64; 3] {
    let surface = fit.input_surface().expect("finite");
    let shapes: Vec<[f64; 2]> = (0..contacts.len())
        .filter_map(|r| surface.at(contacts.x[r], contacts.y[r]).derivatives().principal())
        .map(|p| [p.shape_index().unwrap_or(f64::NAN), p.curvedness() * radius])
        .collect();
    summary(&shapes)
}

fn summary(shapes: &[[f64; 2]]) -> [f64; 3] {
    let n = shapes.len() as f64;
    let mean = |k: usize| shapes.iter().map(|s| s[k]).sum::<f64>() / n;
    let s = mean(0);
    let sd = (shapes.iter().map(|v| (v[0] - s).powi(2)).sum::<f64>() / (n - 1.0)).sqrt();
    [s, sd, mean(1)]
}

pub(crate) fn parametric(contacts: &Contacts, options: &FitOptions) -> Result<ParametricFit, String> {
    ParametricFit::new(contacts, options).map_err(|e| e.to_string())
}

/// The height field of the same degree and objective, as far as one has it.
pub(crate) fn height(contacts: &Contacts, options: &FitOptions) -> Result<Fit, String> {
    let options = options.clone().with_surface(SurfaceKind::Height).with_smooth(Smooth::None);
    fit_contacts(contacts, &options).map_err(|e| e.to_string())
}
