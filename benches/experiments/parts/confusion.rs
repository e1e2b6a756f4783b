//! What becomes of the faces of random bodies: found, lost, of a wrong kind, and parts that no face has.
//!
//! A face is judged where at least 24 contacts are on it, fewer make no part. It is *found* where one part holds most of it, and it most of
//! that part; a part that is no face's, mixed pixels included, is *invented*.

use palpate::parts::{Parts, PartsOptions};

use super::bodies::{Form, Random, form};
use super::scanned::{Scan, Scanned, scanned};

/// The families, one body after another.
pub(crate) const FAMILIES: [&str; 7] = ["box", "capsule", "cone", "flange", "mug", "pipe", "torus"];

/// Noise of places, in spacings, with that of normals, in degrees.
const LEVELS: [(f64, f64); 3] = [(0.1, 3.0), (0.0, 0.0), (1.0, 10.0)];

/// Fewest and most contacts of a body; their logarithm is even between the two.
const CONTACTS: [f64; 2] = [300.0, 100_000.0];

/// Fewest contacts of a face that is judged.
const FEWEST_CONTACTS: usize = 24;

/// Counts over bodies.
#[derive(Clone, Copy, Default)]
struct Count {
    bodies: usize,
    faultless: usize,
    faces: usize,
    found: usize,
    wrong_kind: usize,
    lost: usize,
    invented: usize,
    seconds: f64,
}

impl Count {
    fn add(&mut self, other: &Count) {
        self.bodies += other.bodies;
        self.faultless += other.faultless;
        self.faces += other.faces;
        self.found += other.found;
        self.wrong_kind += other.wrong_kind;
        self.lost += other.lost;
        self.invented += other.invented;
        self.seconds += other.seconds;
    }

    fn print(&self, name: &str) {
        let share = 100.0 * self.faultless as f64 / self.bodies.max(1) as f64;
        println!(
            "{name:<26} {:>6} {:>9} {share:>6.1} {:>6} {:>6} {:>6} {:>6} {:>9}",
            self.bodies, self.faultless, self.faces, self.found, self.wrong_kind, self.lost, self.invented
        );
    }
}

/// The table of so many bodies.
pub(crate) fn print(bodies: u64, first: u64, only: Option<f64>, contacts: [Option<f64>; 2]) {
    let [least, most] = [0, 1].map(|k| contacts[k].unwrap_or(CONTACTS[k]));
    println!(
        "{bodies} bodies from seed {first}, each at every level of noise; 5 % mixed pixels; {least} to {most} contacts"
    );
    println!(
        "{:<26} {:>6} {:>9} {:>6} {:>6} {:>6} {:>6} {:>6} {:>9}",
        "noise, normals, family", "bodies", "faultless", "%", "faces", "found", "wrong", "lost", "invented"
    );
    for (level, degrees) in LEVELS.into_iter().filter(|(level, _)| only.is_none_or(|only| only == *level)) {
        let mut rows = [[Count::default(); FAMILIES.len()]; 2];
        for number in 0..bodies {
            let family = (number % FAMILIES.len() as u64) as usize;
            // normals are measured on every second body, whatever its family
            let measured = (number / FAMILIES.len() as u64).is_multiple_of(2);
            let count = judged(family, first + number, level, measured.then_some(degrees), [least, most]);
            rows[usize::from(!measured)][family].add(&count);
        }
        let mut all = Count::default();
        for (row, word) in rows.iter().zip(["measured", "none"]) {
            let mut sum = Count::default();
            for (count, family) in row.iter().zip(FAMILIES) {
                count.print(&format!("{level} {word} {family}"));
                sum.add(count);
            }
            sum.print(&format!("{level} {word} all"));
            all.add(&sum);
        }
        all.print(&format!("{level} all"));
        eprintln!("level {level}: {:.1} s", all.seconds);
    }
}

fn judged(family: usize, seed: u64, level: f64, normals_deg: Option<f64>, [least, most]: [f64; 2]) -> Count {
    let mut random = Random(seed.wrapping_mul(47).wrapping_add(family as u64));
    let body = form(FAMILIES[family], &mut random);
    let contacts = (random.between(least.ln(), most.ln())).exp();
    let from_one_side = random.between(0.0, 1.0) < 0.5;
    let scan = Scan { contacts, level, normals_deg, from_one_side, mixed: true };
    let scan = scanned(&body, &scan, seed);
    let clock = std::time::Instant::now();
    let options = PartsOptions { viewpoint: scan.eye, ..PartsOptions::default() };
    // with errors as large as walls are apart the contacts may fill a volume, and none of its faces is found
    let found = Parts::of(&scan.contacts, &options).unwrap_or_else(|_| nothing(scan.faces.len()));
    let seconds = clock.elapsed().as_secs_f64();
    let count = Count { seconds, ..compared(&body, &scan, &found) };
    if count.faultless == 0 {
        let of = |face: usize| scan.faces.iter().filter(|f| **f == face).count();
        let faces: Vec<String> = (0..=body.faces.len())
            .filter(|f| of(*f) > 0)
            .map(|f| format!("{} {}", body.faces.get(f).map_or("mixed", |face| face.kind.name()), of(f)))
            .collect();
        let parts: Vec<String> = found.parts.iter().map(|p| format!("{} {}", p.kind.name(), p.points)).collect();
        let sides = if from_one_side { "one side" } else { "all round" };
        eprintln!(
            "{} seed {seed} level {level} {} {sides} {:.1} s: {} -> {}",
            FAMILIES[family],
            if normals_deg.is_some() { "normals" } else { "positions" },
            seconds,
            faces.join(", "),
            parts.join(", ")
        );
    }
    count
}

/// No part for any of so many contacts.
fn nothing(contacts: usize) -> Parts {
    let labels = vec![None; contacts];
    let (parts, joints, notes) = (Vec::new(), Vec::new(), Vec::new());
    Parts { parts, joints, labels, spacing: 0.0, noise: 0.0, normal_noise_deg: 0.0, tolerance: 0.0, notes }
}

fn compared(body: &Form, scan: &Scanned, found: &Parts) -> Count {
    let kinds = body.faces.len();
    let agreement = palpate_inference::parts::against(&scan.contacts, found, &scan.faces, kinds + 1);
    let mut count = Count { bodies: 1, ..Count::default() };
    let of_faces = &agreement.part_of_face[..kinds];
    for (face, part) in of_faces.iter().enumerate() {
        if agreement.table[face].iter().sum::<usize>() < FEWEST_CONTACTS {
            continue;
        }
        count.faces += 1;
        match part {
            Some(part) if found.parts[*part].kind == body.faces[face].kind => count.found += 1,
            Some(_) => count.wrong_kind += 1,
            None => count.lost += 1,
        }
    }
    count.invented = (0..found.parts.len()).filter(|part| !of_faces.contains(&Some(*part))).count();
    count.faultless = usize::from(count.found == count.faces && count.invented == 0);
    count
}
