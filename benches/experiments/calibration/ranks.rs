//! Ranks of the truth among the draws, by the levels of the intervals that hold it, and the forecasts of the kind. A plane's R and the S of
//! kinds that have but one are known exactly once the kind is: all intervals hold them.

use std::collections::BTreeMap;

use palpate::Contacts;
use palpate::geometry::ShapeClass;
use palpate::recognition::{Hypothesis, Recognition, RecognitionOptions};
use palpate_laboratory::bodies::{BodyKind, RandomBody, TouchedBody};
use statrs::distribution::{ChiSquared, ContinuousCDF};

use crate::Wishes;

/// Levels of the intervals that are asked for; the classes between them are as probable as each other.
const LEVELS: [f64; 5] = [1.0 / 6.0, 2.0 / 6.0, 3.0 / 6.0, 4.0 / 6.0, 5.0 / 6.0];

/// How often the truth fell into each class.
#[derive(Clone, Copy, Default)]
struct Ranks([f64; 6]);

impl Ranks {
    fn add(&mut self, class: Option<usize>) {
        if let Some(class) = class {
            self.0[class] += 1.0;
        }
    }

    fn count(&self) -> f64 {
        self.0.iter().sum()
    }

    /// Of chi^2 on even shares.
    fn p(&self) -> f64 {
        let expected = self.count() / 6.0;
        let square: f64 = self.0.iter().map(|n| (n - expected).powi(2) / expected).sum();
        ChiSquared::new(5.0).map_or(f64::NAN, |law| law.sf(square))
    }

    fn line(&self, name: &str) {
        let all = self.count().max(1.0);
        let shares: Vec<String> = self.0.iter().map(|n| format!("{:5.1}", 100.0 * n / all)).collect();
        println!("  {name:<8} {:6} fits   {}   p {:.3}", self.count(), shares.join(" "), self.p());
    }
}

/// The class of a truth: the first interval that holds it.
fn class_of(truth: f64, intervals: &[[f64; 2]]) -> usize {
    intervals.iter().position(|[lo, hi]| (*lo..=*hi).contains(&truth)).unwrap_or(LEVELS.len())
}

/// The kinds of hypothesis that are right about a body.
pub(crate) fn is_of(hypothesis: Hypothesis, kind: BodyKind) -> bool {
    match kind {
        BodyKind::Plane => hypothesis == Hypothesis::Plane,
        BodyKind::Sphere => hypothesis == Hypothesis::Sphere,
        BodyKind::Cylinder => hypothesis == Hypothesis::Cylinder,
        BodyKind::Cone => matches!(hypothesis, Hypothesis::Cone | Hypothesis::Quadric),
        BodyKind::Torus => matches!(hypothesis, Hypothesis::Torus | Hypothesis::General),
        BodyKind::Ellipsoid => hypothesis == Hypothesis::Quadric,
    }
}

/// The recognition at a level; `None` where it is refused.
pub(crate) fn recognised(contacts: &Contacts, level: f64) -> Option<Recognition> {
    Recognition::of(contacts, &RecognitionOptions::default().with_level(level)).ok()
}

/// A cell of the kind, drawn from the laboratory's prior by a number.
fn cell(kind: BodyKind, number: u64, parts: &[f64]) -> TouchedBody {
    let pick = |count: u64, by: u64| (number / by % count) as usize;
    TouchedBody {
        kind,
        part: parts[pick(parts.len() as u64, 1)],
        count: [12, 20, 36, 60, 120][pick(5, 3)],
        has_normals: pick(2, 15) == 0,
        noise: [0.002, 0.01, 0.03][pick(3, 30)],
    }
}

/// What the fits of one kind gave.
#[derive(Default)]
struct Judged {
    s: Ranks,
    r: Ranks,
    radius: Ranks,
    axis: Ranks,
    refused: u64,
    /// By the kind that was said: how often, and how often with more than 95 %.
    said: BTreeMap<&'static str, [u64; 2]>,
}

impl Judged {
    fn judge(&mut self, body: &RandomBody, kind: BodyKind, forecasts: &mut [[f64; 3]; 10]) {
        let fits: Vec<Recognition> = LEVELS.iter().filter_map(|level| recognised(&body.contacts, *level)).collect();
        let Some(first) = fits.first().filter(|_| fits.len() == LEVELS.len()) else {
            self.refused += 1;
            return;
        };
        let [s, r] = body.mean_shape(first.averaged.iter().map(|(place, _)| *place));
        let s = if first.side_known { s } else { s.abs() };
        let shapes: Vec<[f64; 2]> = fits.iter().filter_map(|fit| Some(fit.shape_index?.interval)).collect();
        if shapes.len() == fits.len() && first.class != ShapeClass::Plane {
            self.s.add(Some(class_of(s, &shapes)));
        }
        self.r.add(Some(class_of(r, &fits.iter().map(|fit| fit.curvedness.interval).collect::<Vec<_>>())));
        let sizes: Vec<[f64; 2]> = fits.iter().filter_map(|fit| fit.radius_interval).collect();
        let is_right = is_of(first.hypothesis, kind);
        if let Some(radius) = body.radius().filter(|_| is_right && sizes.len() == fits.len()) {
            self.radius.add(Some(class_of(radius, &sizes)));
        }
        if let (Some(axis), Some(found), true) = (body.axis(), first.axis, is_right) {
            let angle = (0..3).map(|k| axis[k] * found[k]).sum::<f64>().abs().min(1.0).acos().to_degrees();
            let within: Vec<[f64; 2]> = fits.iter().filter_map(|fit| Some([0.0, fit.axis_within_deg?])).collect();
            self.axis.add((within.len() == fits.len()).then(|| class_of(angle, &within)));
        }
        if let Some(said) = first.tried.first() {
            let counted = self.said.entry(said.hypothesis.name()).or_default();
            *counted = [counted[0] + 1, counted[1] + u64::from(said.weight > 0.95)];
            let tenth = &mut forecasts[((10.0 * said.weight) as usize).min(9)];
            tenth[0] += 1.0;
            tenth[1] += said.weight;
            tenth[2] += f64::from(u8::from(is_of(said.hypothesis, kind)));
        }
    }
}

/// The tables of ranks and of forecasts.
pub(crate) fn print(wishes: &Wishes) {
    let mut forecasts = [[0.0; 3]; 10];
    println!("truth inside the interval of level  1/6   2/6   3/6   4/6   5/6  beyond (per cent; even is 16.7)");
    for kind in wishes.kinds() {
        let mut judged = Judged::default();
        for number in 0..wishes.bodies {
            let body = RandomBody::new(&cell(kind, number, &wishes.parts), wishes.seed + number);
            judged.judge(&body, kind, &mut forecasts);
        }
        let said = judged.said.iter().map(|(name, [all, sure])| format!("{name} {all} ({sure} above 95 %)"));
        println!("{}: {}; {} refused", kind.name(), said.collect::<Vec<String>>().join(", "), judged.refused);
        for (name, ranks) in [("S", judged.s), ("R", judged.r), ("radius", judged.radius), ("axis", judged.axis)] {
            if ranks.count() > 0.0 {
                ranks.line(name);
            }
        }
    }
    println!("\nkind said with a probability of     fits   said   right");
    for (tenth, [count, said, right]) in forecasts.iter().enumerate().filter(|(_, [count, ..])| *count > 0.0) {
        let (said, right) = (100.0 * said / count, 100.0 * right / count);
        println!("  {:3} to {:3} %  {count:22} {said:6.1} {right:7.1}", 10 * tenth, 10 * (tenth + 1));
    }
}
