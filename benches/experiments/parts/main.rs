//! Parts of bodies whose sizes, pose, spacing and noise are drawn from seeds, beside the truth.
//!
//!     cargo bench --bench parts [-- SEEDS [FIRST]]
//!     cargo bench --bench parts -- free [SEEDS [FIRST]]       regions that no primitive explains
//!     cargo bench --bench parts -- confusion [BODIES [FIRST]] [level=0.1] [least=300] [most=6000] faces found, lost, invented
//!     cargo bench --bench parts -- intervals [BODIES [FIRST]] how often intervals of sizes and axes hold
//!     cargo bench --bench parts -- angles [BODIES [FIRST]]    how often intervals of joints' angles hold
//!     cargo bench --bench parts -- objects [SEEDS [FIRST]]    which of 20 known objects a scan from one side is
//!     cargo bench --bench parts -- relations [BODIES [FIRST]] how many of the relations that are stated hold
//!
//! Seeds from 1,000,001 on were not looked at before the recorded run (`benches/runs/parts.md`).

mod angles;
mod bodies;
mod confusion;
mod free;
mod intervals;
mod objects;
mod relations;
mod scanned;

use std::collections::BTreeMap;

use bodies::{Drawn, FAMILIES};
use palpate::parts::{Part, PartKind, Parts, PartsOptions};

/// The first seed that was not looked at while the method was made.
const UNSEEN: u64 = 1_000_001;

/// Counts over the seeds of one family.
#[derive(Default)]
struct Tally {
    family: &'static str,
    bodies: usize,
    kinds_right: usize,
    joints_right: usize,
    joints: usize,
    joints_false: usize,
    right: Vec<f64>,
    boundary: Vec<f64>,
    inside: usize,
    sizes: usize,
    rejected: usize,
    tested: usize,
    seconds: f64,
    contacts: usize,
}

/// Error over u of every size, by family, face and size.
type Errors = BTreeMap<(&'static str, usize, &'static str), Vec<f64>>;

fn main() {
    let numbers: Vec<u64> = std::env::args().skip(1).filter_map(|a| a.parse().ok()).collect();
    let (seeds, first) = (numbers.first().copied().unwrap_or(20), numbers.get(1).copied().unwrap_or(UNSEEN));
    if std::env::args().any(|word| word == "free") {
        return free::print(seeds, first);
    }
    if std::env::args().any(|word| word == "confusion") {
        let named = |name: &str| std::env::args().find_map(|word| word.strip_prefix(name).and_then(|v| v.parse().ok()));
        let contacts = [named("least="), named("most=")];
        return confusion::print(numbers.first().copied().unwrap_or(200), first, named("level="), contacts);
    }
    if std::env::args().any(|word| word == "intervals") {
        return intervals::print(numbers.first().copied().unwrap_or(100), first);
    }
    if std::env::args().any(|word| word == "angles") {
        return angles::print(numbers.first().copied().unwrap_or(100), first);
    }
    if std::env::args().any(|word| word == "objects") {
        return objects::print(first);
    }
    if std::env::args().any(|word| word == "relations") {
        return relations::print(numbers.first().copied().unwrap_or(140), first);
    }
    let mut confusion: BTreeMap<(&str, &str), usize> = BTreeMap::new();
    let mut errors = Errors::new();
    println!("{seeds} bodies a family from seed {first}; sizes inside: |error| <= 1.96 u");
    println!(
        "{:<8} {:>8} {:>8} {:>9} {:>11} {:>9} {:>9} {:>9} {:>13} {:>11}",
        "family",
        "contacts",
        "parts ok",
        "right, %",
        "least, %",
        "bound.",
        "worst",
        "joints",
        "sizes inside",
        "rejected"
    );
    for family in FAMILIES {
        let mut tally = Tally { family, ..Tally::default() };
        for seed in first..first + seeds {
            one(&bodies::draw(family, seed), &mut tally, &mut confusion, &mut errors, seed);
        }
        print(family, &tally);
    }
    print_confusion(&confusion);
    print_errors(&errors);
}

fn one(
    drawn: &Drawn,
    tally: &mut Tally,
    confusion: &mut BTreeMap<(&'static str, &'static str), usize>,
    errors: &mut Errors,
    seed: u64,
) {
    // contacts of one number and seed would otherwise be off alike in all families
    let replicate = FAMILIES.iter().position(|family| *family == tally.family).unwrap_or(0) as u64;
    let (contacts, truth) = drawn.world.compile().expect("the body is sound").simulate(seed, replicate);
    let faces = truth.faces().expect("solids have faces");
    let clock = std::time::Instant::now();
    let found = Parts::of(&contacts, &PartsOptions::default()).expect("a body has parts");
    tally.seconds += clock.elapsed().as_secs_f64();
    let agreement = palpate_inference::parts::against(&contacts, &found, &faces, drawn.faces.len());
    tally.bodies += 1;
    tally.contacts += contacts.len();
    tally.right.push(100.0 * agreement.right);
    tally.boundary.extend(agreement.boundary_error);
    for (face, label) in faces.iter().zip(&found.labels) {
        let kind = label.map_or("none", |part| found.parts[part as usize].kind.name());
        *confusion.entry((drawn.faces[*face].kind.name(), kind)).or_default() += 1;
    }
    let seen: Vec<usize> = (0..drawn.faces.len()).filter(|face| faces.contains(face)).collect();
    let is_right = |face: &usize| {
        agreement.part_of_face[*face].is_some_and(|part| found.parts[part].kind == drawn.faces[*face].kind)
    };
    let right = seen.iter().all(is_right) && seen.len() == found.parts.len();
    tally.kinds_right += usize::from(right);
    if !right {
        let kinds: Vec<String> = found.parts.iter().map(|p| format!("{} of {}", p.kind.name(), p.points)).collect();
        eprintln!("{}, seed {seed}: {} faces are {}", tally.family, seen.len(), kinds.join(", "));
    }
    for (face, part) in agreement.part_of_face.iter().enumerate().filter_map(|(face, part)| Some((face, (*part)?))) {
        let part = &found.parts[part];
        if part.kind != drawn.faces[face].kind {
            continue;
        }
        tally.rejected += usize::from(part.rejected == Some(true));
        tally.tested += usize::from(part.rejected.is_some());
        for (size, value, u, truth) in sizes(part, &drawn.faces[face]) {
            tally.sizes += 1;
            tally.inside += usize::from((value - truth).abs() <= 1.96 * u);
            errors.entry((tally.family, face, size)).or_default().push((value - truth) / u);
        }
    }
    joints(drawn, &found, &agreement.part_of_face, tally);
}

/// Every size with its uncertainty and its truth.
fn sizes(part: &Part, face: &bodies::Face) -> Vec<(&'static str, f64, f64, f64)> {
    let (g, u) = (&part.geometry, &part.u);
    let mut found = Vec::new();
    let mut take = |size: &'static str, value: Option<f64>, u: Option<f64>, truth: Option<f64>| {
        if let (Some(value), Some(u), Some(truth)) = (value, u, truth) {
            found.push((size, value, u, truth));
        }
    };
    let radius = if part.kind == PartKind::Cone { None } else { face.radius };
    take("radius", g.radius, u.radius, radius);
    take("minor radius", g.minor_radius, u.minor_radius, face.minor_radius);
    take("half angle", g.half_angle_deg, u.half_angle_deg, face.half_angle_deg);
    found
}

fn joints(drawn: &Drawn, found: &Parts, part_of_face: &[Option<usize>], tally: &mut Tally) {
    let mut expected = Vec::new();
    for (a, b, kind) in &drawn.joints {
        tally.joints += 1;
        let Some((a, b)) = part_of_face[*a].zip(part_of_face[*b]) else { continue };
        expected.push(([a.min(b), a.max(b)], *kind));
    }
    for joint in &found.joints {
        if expected.iter().any(|(parts, kind)| *parts == joint.parts && *kind == joint.kind) {
            tally.joints_right += 1;
        } else {
            tally.joints_false += 1;
        }
    }
}

fn print(family: &str, t: &Tally) {
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len().max(1) as f64;
    let least = t.right.iter().copied().fold(f64::INFINITY, f64::min);
    let worst = t.boundary.iter().copied().fold(0.0, f64::max);
    println!(
        "{family:<8} {:>8} {:>8} {:>9.2} {least:>11.2} {:>9.3} {worst:>9.3} {:>9} {:>13} {:>11}",
        t.contacts / t.bodies,
        format!("{}/{}", t.kinds_right, t.bodies),
        mean(&t.right),
        mean(&t.boundary),
        format!("{}/{}+{}", t.joints_right, t.joints, t.joints_false),
        format!("{}/{}", t.inside, t.sizes),
        format!("{}/{}", t.rejected, t.tested),
    );
}

/// Are the sizes' errors those that u promises? Their mean tells a bias, their root mean square an u that is too small.
fn print_errors(errors: &Errors) {
    println!("\nerror / u of the sizes of right parts, by face");
    println!(
        "{:<8} {:>5} {:<14} {:>6} {:>8} {:>8} {:>10}",
        "family", "face", "size", "count", "mean", "rms", "beyond 1.96"
    );
    for ((family, face, size), z) in errors {
        let count = z.len() as f64;
        let mean = z.iter().sum::<f64>() / count;
        let rms = (z.iter().map(|z| z * z).sum::<f64>() / count).sqrt();
        let beyond = z.iter().filter(|z| z.abs() > 1.96).count();
        println!("{family:<8} {face:>5} {size:<14} {count:>6} {mean:>8.2} {rms:>8.2} {beyond:>10}");
    }
}

fn print_confusion(confusion: &BTreeMap<(&str, &str), usize>) {
    let kinds = ["plane", "sphere", "cylinder", "cone", "torus", "patch", "none"];
    println!("\ncontacts of each true kind (rows) in parts of each kind");
    println!("{:<10}{}", "", kinds.map(|kind| format!("{kind:>10}")).concat());
    for row in &kinds[..5] {
        let cells = kinds.map(|column| format!("{:>10}", confusion.get(&(*row, column)).copied().unwrap_or(0)));
        println!("{row:<10}{}", cells.concat());
    }
}
