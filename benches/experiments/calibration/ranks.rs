//! Ranks of the truth among the draws, by the levels of the intervals that hold it, and the forecasts of the kind. A plane's R and the S of
//! kinds that have but one are known exactly once the kind is: all intervals hold them.

use std::collections::BTreeMap;

use palpate::Contacts;
use palpate::geometry::ShapeClass;
use palpate::recognition::{Hypothesis, Recognition, RecognitionOptions, Tried};
use palpate_laboratory::bodies::{BodyKind, RandomBody, SizeLaw, TouchedBody};
use palpate_numeric::threads;
use statrs::distribution::{ChiSquared, ContinuousCDF};

use crate::Wishes;

/// Levels of the intervals that are asked for; the classes between them are as probable as each other.
const LEVELS: [f64; 5] = [1.0 / 6.0, 2.0 / 6.0, 3.0 / 6.0, 4.0 / 6.0, 5.0 / 6.0];

/// Bodies that are fitted at the same time and then held.
const AT_ONCE: usize = 32;

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
pub(crate) fn cell(kind: BodyKind, number: u64, parts: &[f64], sizes: SizeLaw) -> TouchedBody {
    let pick = |count: u64, by: u64| (number / by % count) as usize;
    TouchedBody {
        kind,
        part: parts[pick(parts.len() as u64, 1)],
        count: [12, 20, 36, 60, 120][pick(5, 3)],
        has_normals: pick(2, 15) == 0,
        noise: [0.002, 0.01, 0.03][pick(3, 30)],
        sizes,
    }
}

/// Probabilities that were said, and what was right.
#[derive(Default)]
struct Forecasts {
    /// Of the likeliest kind, by tenths: how many, their sum, and how many were right.
    tenths: [[f64; 3]; 10],
    /// ln of what was said of the true kind, summed: how many and their sum.
    of_true: [f64; 2],
}

/// Least probability of the true kind: of what was not said at all.
const UNSAID: f64 = 1e-3;

impl Forecasts {
    fn add(&mut self, tried: &[Tried], kind: BodyKind) {
        let Some(said) = tried.first() else { return };
        let tenth = &mut self.tenths[((10.0 * said.weight) as usize).min(9)];
        tenth[0] += 1.0;
        tenth[1] += said.weight;
        tenth[2] += f64::from(u8::from(is_of(said.hypothesis, kind)));
        let own: f64 = tried.iter().filter(|tried| is_of(tried.hypothesis, kind)).map(|tried| tried.weight).sum();
        self.of_true[0] += 1.0;
        self.of_true[1] += own.max(UNSAID).ln();
    }

    fn print(&self) {
        println!("\nkind said with a probability of     fits   said   right");
        for (tenth, [count, said, right]) in self.tenths.iter().enumerate().filter(|(_, [count, ..])| *count > 0.0) {
            let (said, right) = (100.0 * said / count, 100.0 * right / count);
            println!("  {:3} to {:3} %  {count:22} {said:6.1} {right:7.1}", 10 * tenth, 10 * (tenth + 1));
        }
        println!("mean ln p of the true kind, at least ln {UNSAID}: {:.3}", self.of_true[1] / self.of_true[0].max(1.0));
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
    fn judge(&mut self, body: &RandomBody, fits: &[Recognition], kind: BodyKind, forecasts: &mut Forecasts) {
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
            forecasts.add(&first.tried, kind);
        }
    }
}

/// The tables of ranks and of forecasts.
pub(crate) fn print(wishes: &Wishes) {
    let mut forecasts = Forecasts::default();
    println!("truth inside the interval of level  1/6   2/6   3/6   4/6   5/6  beyond (per cent; even is 16.7)");
    for kind in wishes.kinds() {
        let mut judged = Judged::default();
        for first in (0..wishes.bodies).step_by(AT_ONCE) {
            let count = AT_ONCE.min((wishes.bodies - first) as usize);
            let fitted = threads::map(count, 1, |k| {
                let number = first + k as u64;
                let body = RandomBody::new(&cell(kind, number, &wishes.parts, wishes.sizes), wishes.seed + number);
                let fits: Vec<Recognition> = LEVELS.iter().filter_map(|l| recognised(&body.contacts, *l)).collect();
                (body, fits)
            });
            fitted.iter().for_each(|(body, fits)| judged.judge(body, fits, kind, &mut forecasts));
        }
        let said = judged.said.iter().map(|(name, [all, sure])| format!("{name} {all} ({sure} above 95 %)"));
        println!("{}: {}; {} refused", kind.name(), said.collect::<Vec<String>>().join(", "), judged.refused);
        for (name, ranks) in [("S", judged.s), ("R", judged.r), ("radius", judged.radius), ("axis", judged.axis)] {
            if ranks.count() > 0.0 {
                ranks.line(name);
            }
        }
    }
    forecasts.print();
}
