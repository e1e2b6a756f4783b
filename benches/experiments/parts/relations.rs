//! Of the relations that are stated with more than 95 %, how many hold; and of those that hold, how many are stated.
//!
//! What holds is told by an exact scan of the same body from all sides: relations that are missed by less than a millionth of what is asked.
//! Two parts that are coaxial are parallel, too. Only pairs of parts that are faces of the body are counted.

use std::collections::{BTreeMap, BTreeSet};

use palpate::parts::{Parts, PartsOptions};
use palpate_inference::parts::{RelationKind, RelationPrior};

use super::bodies::{Form, Random, form};
use super::confusion::FAMILIES;
use super::scanned::{Scan, scanned};

/// A claim above this is stated.
const STATED: f64 = 0.95;

/// Degrees and lengths below which an exact scan misses what holds; bodies are some 20 large.
const EXACT: f64 = 1e-4;

/// Contacts of the exact scan, and fewest and most of the others.
const CONTACTS: [f64; 3] = [20_000.0, 1_000.0, 10_000.0];

/// A relation of two faces, the smaller number first.
type Tie = ([usize; 2], RelationKind);

/// Relations of a scan by faces, with their probability and by how much they are missed; and the faces that were found.
fn ties(body: &Form, scan: &Scan, seed: u64, prior: &RelationPrior) -> (BTreeMap<Tie, (f64, f64)>, BTreeSet<usize>) {
    let scan = scanned(body, scan, seed);
    let options = PartsOptions { viewpoint: scan.eye, ..PartsOptions::default() };
    let found = Parts::of(&scan.contacts, &options).expect("a body has parts");
    let kinds = body.faces.len();
    let agreement = palpate_inference::parts::against(&scan.contacts, &found, &scan.faces, kinds + 1);
    let kind = |part: usize| found.parts[part].kind;
    let right =
        |(face, part): (usize, &Option<usize>)| part.filter(|p| kind(*p) == body.faces[face].kind).map(|p| (p, face));
    let face_of: BTreeMap<usize, usize> =
        agreement.part_of_face[..kinds].iter().enumerate().filter_map(right).collect();
    let told = found.relations(prior).into_iter().filter_map(|relation| {
        let [a, b] = [face_of.get(&relation.parts[0])?, face_of.get(&relation.parts[1])?];
        Some((([*a.min(b), *a.max(b)], relation.kind), (relation.probability, relation.missed_by)))
    });
    (told.collect(), face_of.into_values().collect())
}

/// Counts of one kind of relation.
#[derive(Clone, Copy, Default)]
struct Count {
    stated: usize,
    right: usize,
    hold: usize,
}

/// The table of so many bodies.
pub(crate) fn print(bodies: u64, first: u64) {
    let prior = RelationPrior::default();
    let mut counts: BTreeMap<RelationKind, Count> = BTreeMap::new();
    for number in 0..bodies {
        let seed = first + number;
        let mut random = Random(seed.wrapping_mul(53));
        let body = form(FAMILIES[(number % FAMILIES.len() as u64) as usize], &mut random);
        let exact =
            Scan { contacts: CONTACTS[0], level: 0.0, normals_deg: Some(0.0), from_one_side: false, mixed: false };
        let (truth, known) = ties(&body, &exact, seed, &prior);
        let truth: BTreeSet<Tie> =
            truth.into_iter().filter(|(_, (_, missed))| *missed < EXACT).map(|(tie, _)| tie).collect();
        let contacts = random.between(CONTACTS[1].ln(), CONTACTS[2].ln()).exp();
        let normals_deg = number.is_multiple_of(2).then_some(3.0);
        let scan = Scan { contacts, level: 0.1, normals_deg, from_one_side: number % 4 > 1, mixed: true };
        let (told, found) = ties(&body, &scan, seed, &prior);
        let holds = |(faces, kind): &Tie| {
            let coaxial = *kind == RelationKind::Parallel && truth.contains(&(*faces, RelationKind::Coaxial));
            coaxial || truth.contains(&(*faces, *kind))
        };
        let is_known = |(faces, _): &Tie| faces.iter().all(|face| known.contains(face));
        for (tie, _) in told.iter().filter(|(tie, (p, _))| *p >= STATED && is_known(tie)) {
            let count = counts.entry(tie.1).or_default();
            count.stated += 1;
            count.right += usize::from(holds(tie));
            if !holds(tie) {
                eprintln!("seed {seed}: {} of faces {:?} does not hold", tie.1.name(), tie.0);
            }
        }
        for (_, kind) in truth.iter().filter(|(faces, _)| faces.iter().all(|face| found.contains(face))) {
            counts.entry(*kind).or_default().hold += 1;
        }
    }
    println!(
        "{bodies} bodies from seed {first}, noise of 0.1 spacing; relations stated with {:.0} % or more",
        100.0 * STATED
    );
    println!("{:<14} {:>7} {:>7} {:>7} {:>16}", "relation", "stated", "right", "%", "hold (both found)");
    let mut all = Count::default();
    for (kind, count) in &counts {
        line(kind.name(), count);
        all = Count { stated: all.stated + count.stated, right: all.right + count.right, hold: all.hold + count.hold };
    }
    line("all", &all);
}

fn line(name: &str, count: &Count) {
    let share = 100.0 * count.right as f64 / count.stated.max(1) as f64;
    println!("{name:<14} {:>7} {:>7} {share:>7.1} {:>16}", count.stated, count.right, count.hold);
}
