//! Regions that no primitive explains: do their S and R hold the truth?
//!
//! ```text
//! truth = mean of the true S and R at the contacts of the region         inside: |error| <= 1.96 u
//! ```
//!
//! Surfaces, sizes, pose, spacing and noise are drawn; all regions of all surfaces are counted, primitives (whose S and R
//! follow from their sizes) beside the regions of a spline's own.

use std::collections::BTreeMap;

use palpate::parts::{PartKind, Parts, PartsOptions};
use palpate::scene::{Effect, Surface, Sweep, World};
use palpate_world::scene::linspace;

use crate::bodies::Random;

/// The families in the order of the table.
const FAMILIES: [&str; 7] = ["paraboloid", "saddle", "bump", "ellipsoid", "superquadric", "egg box", "monkey saddle"];

/// Half the side of the square that is touched.
const HALF: f64 = 10.0;

/// Errors over u of S and of R, regions without u, and contacts.
#[derive(Default)]
struct Row {
    regions: usize,
    without: usize,
    contacts: usize,
    errors: [Vec<f64>; 2],
    relative: [Vec<f64>; 2],
}

pub(crate) fn print(seeds: u64, first: u64) {
    println!("{seeds} surfaces a family from seed {first}; S and R of every region; inside: |error| <= 1.96 u");
    println!(
        "{:<14} {:<10} {:>7} {:>9} {:>5} {:>12} {:>7} {:>12} {:>7} {:>12} {:>12}",
        "family",
        "described",
        "regions",
        "contacts",
        "no u",
        "S inside",
        "rms",
        "R inside",
        "rms",
        "|error S|",
        "|error R|/R"
    );
    for family in FAMILIES {
        let mut rows: BTreeMap<&str, Row> = BTreeMap::new();
        (first..first + seeds).for_each(|seed| one(family, seed, &mut rows));
        rows.iter().for_each(|(kind, row)| tell(family, kind, row));
    }
}

fn draw(family: &str, seed: u64) -> World {
    let number = FAMILIES.iter().position(|f| *f == family).expect("a family of the list") as u64;
    let mut random = Random(seed.wrapping_mul(37).wrapping_add(number));
    let mut r = |lo: f64, hi: f64| random.between(lo, hi);
    let surface = match family {
        "paraboloid" => Surface::paraboloid([r(15.0, 40.0), r(15.0, 40.0)]),
        "saddle" => Surface::saddle([r(15.0, 40.0), r(15.0, 40.0)]),
        "bump" => Surface::gaussian_bump(r(2.0, 5.0), r(5.0, 9.0)),
        "ellipsoid" => Surface::ellipsoid([r(18.0, 30.0), r(18.0, 30.0), r(14.0, 20.0)]),
        "superquadric" => {
            Surface::superquadric([r(18.0, 30.0), r(18.0, 30.0), r(14.0, 20.0)], [r(0.7, 1.0), r(0.7, 1.0)])
        }
        "egg box" => Surface::egg_box(r(0.5, 1.5), [r(14.0, 30.0), r(14.0, 30.0)]),
        _ => Surface::monkey_saddle(r(15.0, 30.0)),
    };
    let surface = surface.posed(r(0.0, 180.0), [0.0; 3], [r(-2.0, 2.0), r(-2.0, 2.0), 0.0]);
    let count = r(30.0, 42.0) as usize;
    let sweep = Sweep::new(linspace(-HALF, HALF, count), linspace(-HALF, HALF, count));
    World::new(surface, sweep).with(Effect::position_noise([r(0.01, 0.04); 3])).with(Effect::normal_noise(r(1.0, 4.0)))
}

fn one(family: &str, seed: u64, rows: &mut BTreeMap<&'static str, Row>) {
    let number = FAMILIES.iter().position(|f| *f == family).unwrap_or(0) as u64;
    let simulator = draw(family, seed).compile().expect("the surface lies under the square");
    let (contacts, truth) = simulator.simulate(seed, number);
    let found = Parts::of(&contacts, &PartsOptions::default()).expect("a surface has parts");
    for part in &found.parts {
        let kind = if part.kind == PartKind::Patch { "spline" } else { "primitive" };
        let row = rows.entry(kind).or_default();
        let members: Vec<usize> = (0..contacts.len()).filter(|r| found.labels[*r] == Some(part.id as u32)).collect();
        let mean = |values: Vec<f64>| values.iter().sum::<f64>() / values.len() as f64;
        let true_s = mean(members.iter().filter_map(|r| truth.shape_index(*r)).collect());
        let true_r = mean(members.iter().map(|r| truth.curvedness(*r)).collect());
        row.regions += 1;
        row.contacts += members.len();
        row.without += usize::from(part.u.curvedness.is_none());
        if let Some((s, u)) = part.shape_index.zip(part.u.shape_index) {
            row.errors[0].push((s - true_s) / u);
        }
        if let Some(u) = part.u.curvedness {
            row.errors[1].push((part.curvedness - true_r) / u);
        }
        row.relative[0].extend(part.shape_index.map(|s| (s - true_s).abs()));
        row.relative[1].push((part.curvedness / true_r - 1.0).abs());
    }
}

fn tell(family: &str, kind: &str, row: &Row) {
    let inside = |k: usize| {
        let errors = &row.errors[k];
        format!("{}/{}", errors.iter().filter(|e| e.abs() <= 1.96).count(), errors.len())
    };
    let rms = |k: usize| {
        let errors = &row.errors[k];
        (errors.iter().map(|e| e * e).sum::<f64>() / errors.len().max(1) as f64).sqrt()
    };
    let median = |k: usize| {
        let mut values = row.relative[k].clone();
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
    };
    println!(
        "{family:<14} {kind:<10} {:>7} {:>9} {:>5} {:>12} {:>7.2} {:>12} {:>7.2} {:>12.4} {:>12.4}",
        row.regions,
        row.contacts,
        row.without,
        inside(0),
        rms(0),
        inside(1),
        rms(1),
        median(0),
        median(1),
    );
}
