//! What each setting of `Tuning` moves: every number halved and doubled, and the same bodies asked again.
//!
//! ```text
//! bodies      of every kind, whole and in part, with and without normals; every third with 10 % false contacts, every fourth two side by side
//! kind        answers that name another kind, or refuse where there was an answer, or answer where there was a refusal
//! S, R        mean change of S and of ln R among those that name the same
//! right       answers of the true kind (two bodies: refused as several things), against those with the defaults
//! ```

use palpate::Contacts;
use palpate::recognition::{Hypothesis, Recognition, RecognitionError, RecognitionOptions, Tuning};
use palpate_laboratory::bodies::{BodyKind, RandomBody, SizeLaw, TouchedBody};
use palpate_numeric::draws::Lcg;
use palpate_numeric::threads;
use serde_json::Value;

use crate::Wishes;
use crate::ranks::is_of;

struct Case {
    contacts: Contacts,
    /// Of one body.
    kind: Option<BodyKind>,
}

/// What was said of a case.
#[derive(Clone, Copy, PartialEq)]
enum Said {
    Several,
    Refused,
    One { hypothesis: Hypothesis, s: f64, r: f64 },
}

fn said(contacts: &Contacts, tuning: &Tuning) -> Said {
    let options = RecognitionOptions { tuning: tuning.clone(), ..RecognitionOptions::default() };
    match Recognition::of(contacts, &options) {
        Ok(found) => Said::One {
            hypothesis: found.hypothesis,
            s: found.shape_index.map_or(0.0, |s| s.mean),
            r: found.curvedness.mean,
        },
        Err(RecognitionError::SeveralThings { .. }) => Said::Several,
        Err(_) => Said::Refused,
    }
}

fn cases(wishes: &Wishes, count: u64) -> Vec<Case> {
    let kinds: Vec<BodyKind> = wishes.kinds().collect();
    let parts = [1.0, 0.5, 0.2];
    let touches = [(8, true), (20, false), (20, true), (60, false), (60, true), (200, true)];
    let one = |k: u64| {
        let kind = kinds[k as usize % kinds.len()];
        let turn = k as usize / kinds.len();
        let (contacts, has_normals) = touches[turn % touches.len()];
        let cell = TouchedBody {
            kind,
            part: parts[turn % parts.len()],
            count: contacts,
            has_normals,
            noise: [0.003, 0.02][turn % 2],
            sizes: SizeLaw::Even,
        };
        let body = RandomBody::new(&cell, wishes.seed + k);
        match k % 12 {
            0 | 4 | 8 => Case {
                contacts: beside(&body.contacts, &RandomBody::new(&cell, wishes.seed + k + 7).contacts),
                kind: None,
            },
            1 | 5 | 9 => Case { contacts: with_false(body.contacts, k), kind: Some(kind) },
            _ => Case { contacts: body.contacts, kind: Some(kind) },
        }
    };
    (0..count).map(one).collect()
}

/// Middle and half of the largest side of the contacts' box.
fn box_of(contacts: &Contacts) -> ([f64; 3], f64) {
    let sides = [&contacts.x, &contacts.y, &contacts.z].map(|v| {
        let (lo, hi) = v.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(*v), hi.max(*v)));
        [0.5 * (lo + hi), 0.5 * (hi - lo)]
    });
    (sides.map(|side| side[0]), sides.iter().map(|side| side[1]).fold(0.0, f64::max))
}

fn rebuilt(points: &[[f64; 3]], normals: &[[f64; 3]]) -> Contacts {
    let contacts = Contacts::from_points(points);
    if normals.is_empty() { contacts } else { contacts.with_normal_vectors(normals) }
}

fn split(contacts: &Contacts) -> (Vec<[f64; 3]>, Vec<[f64; 3]>) {
    let points = (0..contacts.len()).map(|r| [contacts.x[r], contacts.y[r], contacts.z[r]]).collect();
    (points, (0..contacts.len()).filter_map(|r| contacts.unit_normal(r)).collect())
}

/// The second as large as the first, and next to it.
fn beside(one: &Contacts, other: &Contacts) -> Contacts {
    let ((mut points, mut normals), (theirs, of_theirs)) = (split(one), split(other));
    let ((middle, half), (centre, size)) = (box_of(one), box_of(other));
    let scale = half / size;
    points.extend(theirs.iter().map(|p| {
        let moved = [0, 1, 2].map(|k| middle[k] + scale * (p[k] - centre[k]));
        [moved[0] + 2.0 * half, moved[1], moved[2]]
    }));
    normals.extend(of_theirs);
    rebuilt(&points, &normals)
}

/// Every tenth contact anywhere in the box.
fn with_false(contacts: Contacts, seed: u64) -> Contacts {
    let mut generator = Lcg::new(seed + 1);
    let ((mut points, normals), (middle, half)) = (split(&contacts), box_of(&contacts));
    for point in points.iter_mut().step_by(10) {
        *point = middle.map(|m| m + half * (2.0 * generator.uniform() - 1.0));
    }
    rebuilt(&points, &normals)
}

/// Every number of the settings with the way to it.
fn numbers(value: &Value, way: &str, found: &mut Vec<String>) {
    match value {
        Value::Number(_) => found.push(way.to_string()),
        Value::Array(all) => all.iter().enumerate().for_each(|(k, v)| numbers(v, &format!("{way}/{k}"), found)),
        Value::Object(all) => all.iter().for_each(|(key, v)| numbers(v, &format!("{way}/{key}"), found)),
        _ => {}
    }
}

/// The settings with one number multiplied; `None` where that is no setting.
fn changed(all: &Value, way: &str, factor: f64) -> Option<Tuning> {
    let mut all = all.clone();
    let place = all.pointer_mut(way)?;
    let now = place.as_f64()?;
    *place = if place.is_u64() { ((now * factor).round() as u64).into() } else { (now * factor).into() };
    serde_json::from_value(all).ok()
}

fn is_right(case: &Case, said: Said) -> bool {
    match (case.kind, said) {
        (Some(kind), Said::One { hypothesis, .. }) => is_of(hypothesis, kind),
        (None, said) => said == Said::Several,
        _ => false,
    }
}

/// One line a number and factor.
pub(crate) fn print(wishes: &Wishes, count: u64) -> Result<(), String> {
    let cases = cases(wishes, count);
    let defaults = serde_json::to_value(Tuning::default()).map_err(|error| error.to_string())?;
    let asked = |tuning: &Tuning| threads::map(cases.len(), 1, |k| said(&cases[k].contacts, tuning));
    let before = asked(&Tuning::default());
    let right = |all: &[Said]| cases.iter().zip(all).filter(|(case, said)| is_right(case, **said)).count();
    println!("{count} bodies, {} right with the defaults", right(&before));
    println!(
        "{:<24} {:>10} {:>7} {:>6} {:>8} {:>8} {:>6}",
        "setting", "default", "times", "kind", "S", "ln R", "right"
    );
    let mut ways = Vec::new();
    numbers(&defaults, "", &mut ways);
    for way in ways {
        for factor in [0.5, 2.0] {
            let Some(tuning) = changed(&defaults, &way, factor) else { continue };
            let after = asked(&tuning);
            let (mut kinds, mut same, mut s, mut r) = (0, 0.0_f64, 0.0, 0.0);
            for (was, now) in before.iter().zip(&after) {
                match (was, now) {
                    (Said::One { hypothesis: a, s: s0, r: r0 }, Said::One { hypothesis: b, s: s1, r: r1 })
                        if a == b =>
                    {
                        same += 1.0;
                        s += (s1 - s0).abs();
                        r += if r0.min(*r1) > 0.0 { (r1 / r0).ln().abs() } else { 0.0 };
                    }
                    (was, now) if was == now => {}
                    _ => kinds += 1,
                }
            }
            let default = defaults.pointer(&way).map_or_else(String::new, Value::to_string);
            let gained = right(&after) as i64 - right(&before) as i64;
            let same = same.max(1.0);
            println!(
                "{:<24} {default:>10} {factor:>7} {kinds:>6} {:>8.4} {:>8.4} {gained:>+6}",
                &way[1..],
                s / same,
                r / same
            );
        }
    }
    Ok(())
}
