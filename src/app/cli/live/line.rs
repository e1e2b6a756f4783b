//! One answer on one line, for people or as JSON.
//!
//! ```text
//! 12  ridge 99 %  cylinder 87 %  radius 25.3 [24.4, 26.2]  next -3.0, 4.5, 0.1
//! 13  ...                                                                       (of 12 touches, made at touch 12)
//! ```

use serde::Serialize;

use crate::report::{FitDocument, ShapePart, chance, named, radius_bounds, significant};

use super::look::LiveLook;
use super::next::NextTouch;

/// The word that says what a line is.
pub(super) const LINE_SCHEMA: &str = "palpate.live/1";

/// Significant digits of values, and of the ends of their intervals.
const SHOWN_DIGITS: i32 = 4;

/// One answer as JSON.
#[derive(Debug, Serialize)]
struct AnswerLine<'a> {
    schema: &'static str,
    /// Number of the touch, counted from 1.
    touch: u64,
    /// `fresh`: all touches that count were looked at; `moved`: the last look's answer was moved by the touches since; `stands`: it is of
    /// the touches before; `none`: there is no answer.
    answer: &'static str,
    /// Touches that the answer is of.
    contacts: usize,
    /// Number of the touch at which it was made.
    made_at: u64,
    /// Kind of surface.
    kind: Option<&'a str>,
    kind_probability: Option<f64>,
    /// As palpate.fit/1 has it.
    shape: Option<&'a ShapePart>,
    next: Option<&'a NextTouch>,
    /// Why there is no answer.
    why: Option<&'a str>,
    /// Seconds from the touch to this line.
    seconds: f64,
}

/// The kind of surface with its probability.
fn kind(document: &FitDocument) -> (Option<&str>, Option<f64>) {
    let Some(chosen) = &document.fit.chosen else { return (None, None) };
    let name = chosen.hypothesis.as_deref().unwrap_or(&chosen.surface);
    let probability = chosen.tried.iter().find(|tried| tried.name == name).and_then(|tried| tried.probability);
    (Some(name), probability)
}

/// The line after touch `touch`, by the last look.
pub(in crate::cli) fn json_line(look: &LiveLook, touch: u64, seconds: f64) -> serde_json::Result<String> {
    let document = look.document.as_ref().ok();
    let (kind, kind_probability) = document.map_or((None, None), |document| kind(document));
    let answer = match document {
        None => "none",
        Some(_) if look.touches == touch => "fresh",
        Some(_) if look.counts_to(touch) => "moved",
        Some(_) => "stands",
    };
    serde_json::to_string(&AnswerLine {
        schema: LINE_SCHEMA,
        touch,
        answer,
        contacts: look.contacts,
        made_at: look.touches,
        kind,
        kind_probability,
        shape: document.map(|document| &document.shape),
        next: look.next.as_ref(),
        why: look.document.as_ref().err().map(String::as_str),
        seconds,
    })
}

/// The same in words.
pub(in crate::cli) fn text_line(look: &LiveLook, touch: u64) -> String {
    let mut words = vec![touch.to_string()];
    match &look.document {
        Ok(document) => words.extend(answer_words(document)),
        // what to do about it stands behind the first colon, and need not stand in every line
        Err(why) => words.push(format!("no answer: {}", why.split([':', '\n']).next().unwrap_or_default())),
    }
    words.extend(look.next.as_ref().map(next_words));
    if look.touches != touch && !look.counts_to(touch) {
        words.push(format!("(of {} touches, made at touch {})", look.contacts, look.touches));
    }
    words.join("  ")
}

fn answer_words(document: &FitDocument) -> Vec<String> {
    let shape = &document.shape;
    let of_class = |name: &str| shape.class_probability.as_ref()?.0.iter().find(|(n, _)| n == name).map(|(_, p)| *p);
    let [own, other] = [&shape.class, &shape.other_class].map(|class| class.as_deref().and_then(of_class));
    let sure = own.map(|own| own + other.unwrap_or(0.0)).map_or(String::new(), |p| format!(" {}", chance(p)));
    let mut words = vec![format!("{}{sure}", named(shape))];
    if let (Some(name), Some(p)) = kind(document) {
        words.push(format!("{name} {}", chance(p)));
    }
    match shape.radius {
        Some(radius) => words.push(format!("radius {}{}", shown(radius), ends(radius_bounds(shape)))),
        None => {
            let both = [("S", &shape.shape_index), ("R", &shape.curvedness)];
            let known = both.into_iter().filter_map(|(name, part)| Some((name, part.mean?, part.interval)));
            words.extend(known.map(|(name, mean, interval)| {
                format!("{name} {}{}", shown(mean), ends(interval.map_or([None; 2], |ends| ends.map(Some))))
            }));
        }
    }
    words
}

fn shown(value: f64) -> String {
    significant(value, SHOWN_DIGITS)
}

/// Both ends of an interval, where they are known.
fn ends([lo, hi]: [Option<f64>; 2]) -> String {
    match (lo, hi) {
        (Some(lo), Some(hi)) => format!(" [{}, {}]", shown(lo), shown(hi)),
        (Some(lo), None) => format!(" [{}, open]", shown(lo)),
        _ => String::new(),
    }
}

fn next_words(next: &NextTouch) -> String {
    let places: Vec<String> = next.at.iter().copied().chain(next.z).map(|v| significant(v, 3)).collect();
    format!("next {}", places.join(", "))
}
