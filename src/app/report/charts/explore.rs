//! The figures of an exploration: how the uncertainties fell, and where it touched.

use super::axis::Axis;
use super::chart::{Chart, ROOM, Style};
use super::frame::Rect;
use crate::report::drawing::Drawing;
use crate::report::explore::{ExploreDocument, KnownPart, StepPart};
use crate::report::table::significant;

/// Smallest uncertainty that is drawn: a surface found to be a sphere has an S without any.
const LEAST_U: f64 = 1e-6;
/// Touches that are numbered; more numbers than these would lie over each other.
const NUMBERED: usize = 120;

/// What falls.
pub(in crate::report) struct Falling {
    /// In words.
    pub name: &'static str,
    goal: Option<f64>,
    of: fn(&StepPart) -> Option<f64>,
}

impl Falling {
    /// u(S) and u(R)/R.
    pub(in crate::report) fn both(document: &ExploreDocument) -> [Falling; 2] {
        let goal = document.goal.as_ref();
        let share = |step: &StepPart| {
            let (u, mean) = (step.curvedness.u?, step.curvedness.mean?);
            Some(u / mean).filter(|share| share.is_finite())
        };
        let r = "standard uncertainty of R, as a share of R";
        [
            Falling {
                name: "standard uncertainty of S",
                goal: goal.map(|goal| goal.u_S),
                of: |step| step.shape_index.u,
            },
            Falling { name: r, goal: goal.map(|goal| goal.u_R), of: share },
        ]
    }

    /// Whether it is known at any look.
    pub(in crate::report) fn is_known(&self, document: &ExploreDocument) -> bool {
        document.steps.iter().any(|step| (self.of)(step).is_some())
    }

    /// Draws it over the contacts.
    pub(in crate::report) fn draw(&self, drawing: &mut Drawing, rect: Rect, document: &ExploreDocument) {
        let known = document.steps.iter().filter_map(|step| Some((step, (self.of)(step)?)));
        let known: Vec<(&StepPart, f64)> = known.collect();
        let at = |step: &StepPart, u: f64| [step.contacts as f64, u.max(LEAST_U)];
        let contacts = || document.steps.iter().map(|step| step.contacts as f64);
        let values = known.iter().map(|(_, u)| u.max(LEAST_U)).chain(self.goal);
        let axes = [Axis::holding(contacts()), Axis::logarithmic(values)];
        let mut chart = Chart::new(drawing, rect, axes, ["contacts", "standard uncertainty"], ROOM);
        if let Some(goal) = self.goal {
            let (first, last) = (contacts().next().unwrap_or(0.0), contacts().next_back().unwrap_or(0.0));
            chart.line(Style::GOAL, &[[first, goal], [last, goal]]);
        }
        chart.line(Style::MAIN, &known.iter().map(|(step, u)| at(step, *u)).collect::<Vec<_>>());
        for (step, u) in &known {
            let words = format!("{} contacts\n{} {}\n{}", step.contacts, self.name, significant(*u, 3), found(step));
            chart.dot(Style::MAIN, at(step, *u), 3.5, words);
        }
    }
}

/// What a look found.
fn found(step: &StepPart) -> String {
    let one = |name: &str, part: &KnownPart| {
        let (mean, u) = part.mean.zip(part.u)?;
        Some(format!("{name} {} with uncertainty {}", significant(mean, 4), significant(u, 2)))
    };
    let both = [one("S", &step.shape_index), one("R", &step.curvedness)];
    both.into_iter().flatten().collect::<Vec<_>>().join("\n")
}

/// Draws the places in x and y: grey those of the first sweep, then from light to dark in the order of the rounds, numbered.
pub(in crate::report) fn touched(drawing: &mut Drawing, rect: Rect, document: &ExploreDocument) {
    let places: Vec<[f64; 2]> = document.steps.iter().flat_map(|step| step.touched.iter().copied()).collect();
    let axes = Axis::level(&places, rect.map(|[from, to]| to - from));
    let mut chart = Chart::new(drawing, rect, axes, ["x", "y"], ROOM);
    let rounds = (document.steps.len().max(2) - 1) as f64;
    places.iter().for_each(|place| chart.keep_off(*place, 4.5));
    let mut number = 0;
    for (round, step) in document.steps.iter().enumerate() {
        for place in &step.touched {
            number += 1;
            let when = if round == 0 { "first sweep".to_string() } else { format!("planned, round {round}") };
            let [x, y] = place.map(|v| significant(v, 4));
            let words = format!("contact {number}: {when}\nx {x}, y {y}");
            let style = if round == 0 { Style::QUIET } else { Style::SECOND.darker(round as f64 / rounds) };
            chart.dot(style, *place, 4.5, words);
            // the first sweep has an order of its own, and its repeats lie on one another
            if round > 0 && number <= NUMBERED {
                chart.number(*place, &number.to_string());
            }
        }
    }
}
