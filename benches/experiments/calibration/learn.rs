//! Settings of priors, learned from a corpus: each is moved by itself, and the corpus is most probable at the learned value.
//!
//! ```text
//! corpus      laboratory bodies of every kind in every part, and random bumps, rings and superquadrics; or the files that are named
//! ln p        sum over every other body of the log evidence of all primitives, with and without departures, above that of the defaults
//! learned     where that is largest, one setting after another, with the sd that its curvature tells
//! judged      the same sum over the other bodies, of which nothing was learned: where these gain nothing the default is kept
//! kinds       mean probabilities of the kinds, until they stay: expectation and maximisation
//! ```
//!
//! A share is moved by its odds, a size by its logarithm. What a corpus does not tell is left: laboratory bodies have no false contacts, and the
//! sensor of their normals is the laboratory's own.

use std::path::Path;

use palpate::Contacts;
use palpate::recognition::Tuning;
use palpate_app::io::{Input, ReadOptions, read_input_bytes};
use palpate_inference::recognition::{CorpusBody, CorpusEvidence};
use palpate_laboratory::bodies::RandomBody;
use palpate_laboratory::coverage::RandomSurface;
use palpate_numeric::{brent, threads};
use serde_json::Value;

use crate::Wishes;
use crate::ranks::cell;

/// Farthest that a size's logarithm or a share's log odds is moved, how exactly the likeliest move is found, and in how many values.
const FARTHEST: f64 = 3.0;
const EXACTLY: f64 = 0.02;
const VALUES: usize = 14;

/// The step by which the curvature there is found.
const ASIDE: f64 = 0.3;

/// Rounds of expectation and maximisation of the kinds.
const ROUNDS: usize = 8;

/// Parts of the way round of which the laboratory's bodies are touched.
const PARTS: [f64; 4] = [1.0, 0.5, 0.3, 0.12];

/// How a setting is moved.
#[derive(Clone, Copy)]
enum Scale {
    /// By a factor, all of its numbers.
    Size,
    /// By its odds.
    Share,
    /// By a sum, its first number.
    Mean,
    /// By a factor, its second number.
    Spread,
}

/// The settings, with the way to each in the `Tuning` and what tells it.
const LEARNED: [(&str, Scale, bool); 11] = [
    ("half_axes", Scale::Size, true),
    ("exact", Scale::Share, true),
    ("lengths", Scale::Size, true),
    ("departures", Scale::Size, true),
    ("section", Scale::Share, true),
    ("departure_is_error", Scale::Share, true),
    ("own_normals", Scale::Share, false),
    ("log_ratio", Scale::Mean, false),
    ("log_ratio", Scale::Spread, false),
    ("false_prior", Scale::Size, false),
    ("reach", Scale::Size, false),
];

fn moved_number(value: &Value, by: f64, scale: Scale) -> Option<Value> {
    let now = value.as_f64()?;
    let next = match scale {
        Scale::Size | Scale::Spread => now * by.exp(),
        Scale::Share => 1.0 / (1.0 + (1.0 - now) / now * (-by).exp()),
        Scale::Mean => now + by,
    };
    Some(next.into())
}

/// The settings with one of them moved.
fn moved(all: &Value, name: &str, scale: Scale, by: f64) -> Option<Value> {
    let mut all = all.clone();
    let place = all.get_mut(name)?;
    match (scale, place) {
        (Scale::Mean, Value::Array(numbers)) => numbers[0] = moved_number(&numbers[0], by, scale)?,
        (Scale::Spread, Value::Array(numbers)) => numbers[1] = moved_number(&numbers[1], by, scale)?,
        (_, Value::Array(numbers)) => {
            for number in numbers.iter_mut() {
                *number = moved_number(number, by, scale)?;
            }
        }
        (_, number) => *number = moved_number(number, by, scale)?,
    }
    Some(all)
}

fn tuning(all: &Value) -> Result<Tuning, String> {
    serde_json::from_value(all.clone()).map_err(|error| error.to_string())
}

/// Contacts of the laboratory: so many bodies of every kind, and as many random surfaces of all kinds together.
fn laboratory(wishes: &Wishes, count: u64) -> Vec<Contacts> {
    let body = |kind, k| RandomBody::new(&cell(kind, k, &PARTS, wishes.sizes), wishes.seed + k).contacts;
    let bodies = wishes.kinds().flat_map(|kind| (0..count).map(move |k| body(kind, k)));
    let surface = |k: u64| {
        let simulator = RandomSurface::new(wishes.seed + k).world.compile().ok()?;
        Some(simulator.into_contacts(wishes.seed + k, 0).0)
    };
    let surfaces = if wishes.only.is_empty() { 3 * count } else { 0 };
    bodies.chain((0..surfaces).filter_map(surface)).collect()
}

/// Contacts of the files of a folder, those that hold contacts.
fn of_folder(folder: &Path) -> Result<Vec<Contacts>, String> {
    let wrong = |error: std::io::Error| format!("{}: {error}", folder.display());
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(wrong)? {
        files.push(entry.map_err(wrong)?.path());
    }
    files.sort();
    let read = |path: &std::path::PathBuf| {
        let bytes = std::fs::read(path).ok()?;
        match read_input_bytes(&path.display().to_string(), &bytes, &ReadOptions::default()).ok()?.input {
            Input::Contacts(contacts) => Some(contacts),
            Input::Grid(_) => None,
        }
    };
    Ok(files.iter().filter_map(read).collect())
}

/// What every body of the corpus says under some settings; bodies without evidence are left out by all.
fn evidence(corpus: &[CorpusBody], tuning: &Tuning) -> Vec<Option<CorpusEvidence>> {
    threads::map(corpus.len(), 1, |k| corpus[k].evidence(tuning))
}

/// Log evidence above that of the defaults.
fn gain(now: &[Option<CorpusEvidence>], of_defaults: &[Option<CorpusEvidence>]) -> f64 {
    let both = now.iter().zip(of_defaults).filter_map(|(a, b)| Some((a.as_ref()?, b.as_ref()?)));
    both.map(|(a, b)| a.log_evidence - b.log_evidence).sum()
}

/// The odds of kinds that make the corpus most probable.
fn kinds(corpus: &[CorpusBody], beside: &Tuning) -> [f64; 6] {
    let mut tuning = beside.clone();
    for _ in 0..ROUNDS {
        let mut sum = [0.0; 6];
        for found in evidence(corpus, &tuning).into_iter().flatten() {
            sum.iter_mut().zip(found.kinds).for_each(|(sum, own)| *sum += own);
        }
        let all: f64 = sum.iter().sum();
        tuning.kinds = sum.map(|own| 6.0 * own / all);
    }
    tuning.kinds
}

/// A corpus, of which every other body is learned from and the others judge, and the settings that were learned so far.
struct Learner {
    learned_from: Vec<CorpusBody>,
    judging: Vec<CorpusBody>,
    /// What both say under the defaults.
    of_defaults: [Vec<Option<CorpusEvidence>>; 2],
    defaults: Value,
    learned: Value,
}

impl Learner {
    fn new(contacts: &[Contacts]) -> Result<Learner, String> {
        let found = threads::map(contacts.len(), 1, |k| CorpusBody::new(&contacts[k]));
        let (mut learned_from, mut judging) = (Vec::new(), Vec::new());
        for (k, body) in found.into_iter().enumerate() {
            if k % 2 == 0 { learned_from.extend(body) } else { judging.extend(body) }
        }
        let of_defaults = [&learned_from, &judging].map(|bodies| evidence(bodies, &Tuning::default()));
        let defaults = serde_json::to_value(Tuning::default()).map_err(|error| error.to_string())?;
        Ok(Learner { learned_from, judging, of_defaults, learned: defaults.clone(), defaults })
    }

    /// Gains over the defaults: of the bodies that are learned from, and of those that judge.
    fn gained(&self, all: &Value) -> Result<[f64; 2], String> {
        let tuning = tuning(all)?;
        let [own, judging] = [&self.learned_from, &self.judging].map(|bodies| evidence(bodies, &tuning));
        Ok([gain(&own, &self.of_defaults[0]), gain(&judging, &self.of_defaults[1])])
    }

    /// Moves one setting to where the corpus is most probable, unless the bodies that judge gain nothing by it.
    fn learn(&mut self, name: &str, scale: Scale) -> Result<(), String> {
        let at = |by: f64| moved(&self.learned, name, scale, by).ok_or_else(|| format!("{name} is no setting"));
        let value = |by: f64| {
            let tuning = at(by).and_then(|all| tuning(&all));
            tuning.map_or(f64::NEG_INFINITY, |t| gain(&evidence(&self.learned_from, &t), &self.of_defaults[0]))
        };
        let (best, most) = brent::maximum([-FARTHEST, FARTHEST], 0.0, EXACTLY, VALUES, value);
        let curvature = (2.0 * most - value(best - ASIDE) - value(best + ASIDE)) / (ASIDE * ASIDE);
        let sd = if curvature > 0.0 { format!("{:.2}", curvature.powf(-0.5)) } else { "-".into() };
        let likeliest = at(best)?;
        let ([now, was], [own, judged]) = (self.gained(&self.learned)?, self.gained(&likeliest)?);
        let gains = most > now && judged > was;
        let told = if gains { "" } else { "  the others gain nothing: kept" };
        let (default, found) = (shown(&self.defaults[name]), shown(&likeliest[name]));
        println!("{name:<20} {default:>20} {found:>34}   {best:6.2} +- {sd:>5} {own:8.1} {judged:8.1}{told}");
        if gains {
            self.learned = likeliest;
        }
        Ok(())
    }
}

/// One line a setting, each beside those that were learned before it, and then all settings as JSON.
pub(crate) fn print(wishes: &Wishes, count: u64) -> Result<(), String> {
    let contacts = match &wishes.corpus {
        Some(folder) => of_folder(folder)?,
        None => laboratory(wishes, count),
    };
    let mut learner = Learner::new(&contacts)?;
    println!("{} bodies learned from, {} that judge", learner.learned_from.len(), learner.judging.len());
    println!("{:<20} {:>20} {:>34}   {:>15} {:>8} {:>8}", "setting", "default", "learned", "move", "ln p", "judged");
    for (name, scale, is_told_by_laboratory) in LEARNED {
        if wishes.corpus.is_some() || is_told_by_laboratory {
            learner.learn(name, scale)?;
        }
    }
    learner.learned["kinds"] = kinds(&learner.learned_from, &tuning(&learner.learned)?).to_vec().into();
    let ([own, judged], of_kinds) = (learner.gained(&learner.learned)?, shown(&learner.learned["kinds"]));
    println!("{:<20} {:>20} {of_kinds:>34}   {:>15} {own:8.1} {judged:8.1}", "kinds", "even", "");
    println!("{}", learner.learned);
    Ok(())
}

/// Numbers in three digits.
fn shown(value: &Value) -> String {
    let one = |v: &Value| v.as_f64().map_or_else(String::new, |v| format!("{v:.3}"));
    value.as_array().map_or_else(|| one(value), |all| all.iter().map(one).collect::<Vec<String>>().join(" "))
}
