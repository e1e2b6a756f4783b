//! Twenty objects, four of a family, known from a scan of all their sides; five scans of each from one side, in other poses, with other
//! spacings and errors; and as many scans of objects that are not known.

use palpate::parts::{Parts, PartsOptions};
use palpate_inference::parts::{ObjectMatch, ObjectModel, ObjectPrior};

use super::bodies::{Drawn, FAMILIES, draw, seen};

/// Objects of a family, and scans of each.
const OBJECTS: u64 = 4;
const SCANS: u64 = 5;

/// A claim above this is sure.
const SURE: f64 = 0.95;

fn parts_of(drawn: &Drawn, seed: u64) -> Option<Parts> {
    let (contacts, _) = drawn.world.compile().expect("the body is sound").simulate(seed, 0);
    Parts::of(&contacts, &PartsOptions::default()).ok()
}

/// Counts over scans: named rightly, of these with certainty, named wrongly with certainty, called none of the library.
#[derive(Default)]
struct Count {
    scans: usize,
    right: usize,
    sure: usize,
    sure_and_wrong: usize,
    none: usize,
    said: f64,
}

impl Count {
    fn take(&mut self, found: &ObjectMatch, truth: Option<&str>) {
        let is_right = found.name.as_deref() == truth;
        self.scans += 1;
        self.right += usize::from(is_right);
        self.sure += usize::from(is_right && found.probability >= SURE);
        self.sure_and_wrong += usize::from(!is_right && found.probability >= SURE);
        self.none += usize::from(found.name.is_none());
        self.said += found.probability;
    }
}

pub(crate) fn print(first: u64) {
    let named = |family: &str, seed: u64| format!("{family}-{}", seed - first);
    let mut models = Vec::new();
    for family in FAMILIES {
        for seed in first..first + OBJECTS {
            let whole = parts_of(&draw(family, seed), seed).expect("a body has parts");
            models.push(ObjectModel { name: named(family, seed), parts: whole.parts, spacing: whole.spacing });
        }
    }
    println!("{} objects; {SCANS} scans of each from one side, and of as many that are not known", models.len());
    let head = ["family", "known", "scans", "right", "sure", "sure+wrong", "none", "mean p, %"];
    println!(
        "{:<8} {:<6} {:>6} {:>6} {:>6} {:>11} {:>6} {:>10}",
        head[0], head[1], head[2], head[3], head[4], head[5], head[6], head[7]
    );
    for family in FAMILIES {
        for is_known in [true, false] {
            let from = if is_known { first } else { first + OBJECTS };
            let mut count = Count::default();
            for seed in from..from + OBJECTS {
                for scan in 0..SCANS {
                    let Some(parts) = parts_of(&seen(family, seed, Some(scan)), scan) else { continue };
                    let found = parts.object(&models, &ObjectPrior::default());
                    let truth = is_known.then(|| named(family, seed));
                    if found[0].name != truth {
                        let said = found[0].name.clone().unwrap_or_else(|| "none".into());
                        let kinds: Vec<String> =
                            parts.parts.iter().map(|p| format!("{} of {}", p.kind.name(), p.points)).collect();
                        eprintln!(
                            "{family} {seed} scan {scan}: {said} ({:.2}); {}",
                            found[0].probability,
                            kinds.join(", ")
                        );
                    }
                    count.take(&found[0], truth.as_deref());
                }
            }
            let word = if is_known { "yes" } else { "no" };
            println!(
                "{family:<8} {word:<6} {:>6} {:>6} {:>6} {:>11} {:>6} {:>10.1}",
                count.scans,
                count.right,
                count.sure,
                count.sure_and_wrong,
                count.none,
                100.0 * count.said / count.scans.max(1) as f64
            );
        }
    }
}
