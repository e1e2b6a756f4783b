//! Which of a few known objects a body is: its parts and what lies between them, held against those of every model.
//!
//! ```text
//! p(model | parts) ~ sum over assignments of prod_i  foreign                                  part i is of nothing in the model
//!                                                    (1 - foreign) / m  B(sizes) B(ties)      part i is one of the m parts of the model
//! p(none)          ~ 1
//! B(x) = N(x_i - x_model; s^2) / a(x)        s: both uncertainties and what two of a kind differ by, a: density of x of any part
//! ties: angle between directions, distance between faces, axes and centres, counted towards the assigned part that tells most
//! ```
//!
//! What is usual tells of no object: right angles, one axis, equal radii. An unknown object has them as well, so that a is N there.
//!
//! A scan need not show all of an object, and what it does not show says nothing. Ties between the other pairs are no further data, since
//! the pose is fixed by then, but an assignment that one of them contradicts is none. The sum over assignments takes care of objects
//! that are alike from several sides. W. Grimson, *Object Recognition by Computer* (1990), chapter 3: the interpretation tree.

use std::f64::consts::PI;

use super::pair_geometry::{cosine, distance};
use super::relations::log_normal;
use super::result::{Part, Parts};
use crate::primitives::placed::PartKind;

/// A known object.
#[derive(Clone, Debug)]
pub struct ObjectModel {
    /// What people call it.
    pub name: String,
    /// Its parts.
    pub parts: Vec<Part>,
    /// Median distance between the contacts that they were found by.
    pub spacing: f64,
}

/// One object and how probable it is.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectMatch {
    /// Which; `None`: none of those that are known.
    pub name: Option<String>,
    /// How probable.
    pub probability: f64,
    /// Parts of the body with the parts of the model that they most probably are.
    pub pairs: Vec<[usize; 2]>,
}

/// What is believed of objects before a body is touched.
#[derive(Clone, Copy, Debug)]
pub struct ObjectPrior {
    /// Probability that a part belongs to something else than the object: a table, a hand.
    pub foreign: f64,
    /// Share of its size by which one object of a kind differs from another, or from its model; and the same in radians.
    pub alike: f64,
    /// Probability that a part is seen from end to end.
    pub whole: f64,
    /// Lengths of parts that nothing ties differ by a factor of up to this.
    pub lengths: f64,
    /// Ties that are missed by more uncertainties than this contradict an assignment.
    pub contradicts: f64,
    /// Directions that differ by less are side by side: two degrees, more than what is measured well is off.
    pub beside_deg: f64,
    /// Assignments tried at most.
    pub most_tried: usize,
}

impl Default for ObjectPrior {
    fn default() -> ObjectPrior {
        ObjectPrior {
            foreign: 0.05,
            alike: 0.005,
            whole: 0.5,
            lengths: 3.0,
            contradicts: 5.0,
            beside_deg: 2.0,
            most_tried: 100_000,
        }
    }
}

impl Parts {
    /// Every model and none of them, the most probable first; each is as probable before as any other.
    pub fn object(&self, models: &[ObjectModel], prior: &ObjectPrior) -> Vec<ObjectMatch> {
        let mut logs: Vec<(f64, ObjectMatch)> = models.iter().map(|model| self.against_model(model, prior)).collect();
        logs.push((0.0, ObjectMatch { name: None, probability: 0.0, pairs: Vec::new() }));
        let most = logs.iter().map(|(log, _)| *log).fold(f64::NEG_INFINITY, f64::max);
        let sum: f64 = logs.iter().map(|(log, _)| (log - most).exp()).sum();
        let weighed = |(log, found): (f64, ObjectMatch)| ObjectMatch { probability: (log - most).exp() / sum, ..found };
        let mut found: Vec<ObjectMatch> = logs.into_iter().map(weighed).collect();
        found.sort_by(|a, b| b.probability.total_cmp(&a.probability));
        found
    }

    fn against_model(&self, model: &ObjectModel, prior: &ObjectPrior) -> (f64, ObjectMatch) {
        let is_told = |part: &&Part| part.kind != PartKind::Patch && part.kind != PartKind::Ellipsoid;
        let seen: Vec<&Part> = self.parts.iter().filter(is_told).collect();
        let known: Vec<&Part> = model.parts.iter().filter(is_told).collect();
        let size = seen.iter().map(|part| part.extent).fold(self.spacing, f64::max);
        let spacing = [self.spacing, model.spacing];
        let mut tree = InterpretationTree {
            seen: &seen,
            known: &known,
            compared: Compared { size, spacing, prior },
            assigned: vec![None; seen.len()],
            sum: f64::NEG_INFINITY,
            best: (f64::NEG_INFINITY, Vec::new()),
            tried: 0,
        };
        tree.extend(0, 0.0);
        let pairs = tree.best.1.iter().zip(&seen).filter_map(|(a, part)| Some([part.id, known[(*a)?].id])).collect();
        (tree.sum, ObjectMatch { name: Some(model.name.clone()), probability: 0.0, pairs })
    }
}

/// Assignments of parts that are seen to parts that are known, one after the other.
struct InterpretationTree<'a> {
    seen: &'a [&'a Part],
    known: &'a [&'a Part],
    compared: Compared<'a>,
    assigned: Vec<Option<usize>>,
    /// Log of the sum over whole assignments.
    sum: f64,
    best: (f64, Vec<Option<usize>>),
    tried: usize,
}

impl InterpretationTree<'_> {
    /// Assigns the part `next` and all after it.
    fn extend(&mut self, next: usize, log: f64) {
        self.tried += 1;
        if self.tried > self.compared.prior.most_tried {
            return;
        }
        if next == self.seen.len() {
            let most = self.sum.max(log);
            self.sum = if most.is_finite() { most + ((self.sum - most).exp() + (log - most).exp()).ln() } else { most };
            if log > self.best.0 {
                self.best = (log, self.assigned.clone());
            }
            return;
        }
        let foreign = self.compared.prior.foreign;
        for to in 0..self.known.len() {
            if self.assigned.contains(&Some(to)) {
                continue;
            }
            if let Some(gain) = self.gain(next, to) {
                self.assigned[next] = Some(to);
                let one_of = ((1.0 - foreign) / self.known.len() as f64).ln();
                self.extend(next + 1, log + one_of + gain);
                self.assigned[next] = None;
            }
        }
        self.extend(next + 1, log + foreign.ln());
    }

    /// Log of the B of one more pair; `None` where it contradicts one that is assigned.
    fn gain(&self, next: usize, to: usize) -> Option<f64> {
        let (part, model) = (self.seen[next], self.known[to]);
        let beside: Vec<&Part> =
            self.assigned[..next].iter().zip(self.seen).filter_map(|(a, part)| a.map(|_| *part)).collect();
        let mut gain = self.compared.sizes(part, model, &beside)?;
        // the tie that would tell most if it held; the others are no further data
        let mut telling = Tie { log: 0.0, at_most: 0.0 };
        for (other, its) in self.assigned[..next].iter().enumerate().filter_map(|(k, a)| Some((k, (*a)?))) {
            let tie = self.compared.ties([part, self.seen[other]], [model, self.known[its]])?;
            if tie.at_most > telling.at_most {
                telling = tie;
            }
        }
        gain += telling.log;
        Some(gain)
    }
}

/// Log of B of what lies between two parts, and what it would be if both were alike to the digit.
#[derive(Clone, Copy)]
struct Tie {
    log: f64,
    at_most: f64,
}

/// How parts of a body are held against parts of a model.
struct Compared<'a> {
    /// The body's, in the contacts' unit.
    size: f64,
    /// Of the body and of the model.
    spacing: [f64; 2],
    prior: &'a ObjectPrior,
}

impl Compared<'_> {
    /// Log of B of kind and sizes, beside parts that are assigned already; `None` where they contradict.
    fn sizes(&self, part: &Part, model: &Part, beside: &[&Part]) -> Option<f64> {
        if part.kind != model.kind || part.hollow != model.hollow {
            return None;
        }
        let (g, of_model, u, u_model) = (&part.geometry, &model.geometry, &part.u, &model.u);
        let even = 1.0 / (2.0 * self.prior.lengths.ln());
        let mut log = 0.0;
        // the radius of a cone is that at some place of it
        let radius = if part.kind == PartKind::Cone { None } else { g.radius.zip(of_model.radius) };
        let radii = [
            (radius, u.radius.zip(u_model.radius)),
            (g.minor_radius.zip(of_model.minor_radius), u.minor_radius.zip(u_model.minor_radius)),
        ];
        let known: Vec<f64> =
            beside.iter().flat_map(|other| [other.geometry.radius, other.geometry.minor_radius]).flatten().collect();
        for ((r, q), sds) in radii.into_iter().filter_map(|(values, sds)| Some((values?, sds))) {
            let (u_r, u_q) = sds.unwrap_or((0.0, 0.0));
            let s = (u_r / r).hypot(u_q / q).hypot(self.prior.alike);
            let usual: Vec<[f64; 2]> = known.iter().map(|other| [(r / other).ln(), s]).collect();
            log += self.ratio((r / q).ln(), s, even, &usual)?;
        }
        if let Some((a, b)) = g.half_angle_deg.zip(of_model.half_angle_deg) {
            let sds = u.half_angle_deg.unwrap_or(0.0).hypot(u_model.half_angle_deg.unwrap_or(0.0));
            log += self.ratio((a - b).to_radians(), sds.to_radians().hypot(self.prior.alike), 2.0 / PI, &[])?;
        }
        Some(log + self.extents(part, model, beside)?)
    }

    /// What is seen of a part reaches as far as the part, or not so far. Faces are usually as wide as their neighbours.
    fn extents(&self, part: &Part, model: &Part, beside: &[&Part]) -> Option<f64> {
        let (e, of_model) = (part.extent.max(self.spacing[0]), model.extent.max(self.spacing[1]));
        let s = self.prior.alike.hypot(self.spacing[0] / e).hypot(self.spacing[1] / of_model);
        let off = (e / of_model).ln();
        if off > self.prior.contradicts * s {
            return None;
        }
        let whole = self.prior.whole * normal(off, s);
        let partly = if off <= 0.0 { (1.0 - self.prior.whole) * e / of_model } else { 0.0 };
        let wide =
            beside.iter().flat_map(|other| [Some(other.extent), other.geometry.radius.map(|r| 2.0 * r)]).flatten();
        let usual: Vec<[f64; 2]> = wide.map(|other| [(e / other).ln(), s]).collect();
        Some(
            (whole + partly).max(f64::MIN_POSITIVE).ln()
                - self.chance(1.0 / (2.0 * self.prior.lengths.ln()), &usual).ln(),
        )
    }

    /// What lies between two parts; `None` where it contradicts.
    fn ties(&self, seen: [&Part; 2], known: [&Part; 2]) -> Option<Tie> {
        let beside = self.prior.beside_deg.to_radians().sin();
        let mut tie = Tie { log: 0.0, at_most: 0.0 };
        if let (Some((x, s)), Some((y, t))) = (cosine(seen), cosine(known)) {
            let turn = s.hypot(t).hypot(self.prior.alike);
            // near parallel the cosine is of second order
            let of_cosine = |y: f64| ((1.0 - y * y).max(0.0).sqrt() * turn).hypot(turn * turn);
            let usual = |x: f64| [[x, of_cosine(0.0)], [x - 1.0, of_cosine(1.0)]];
            tie.log += self.ratio(x - y, of_cosine(y), 1.0, &usual(x))?;
            tie.at_most += self.ratio(0.0, of_cosine(y), 1.0, &usual(y))?;
        }
        if let (Some((x, s)), Some((y, t))) = (distance(seen, beside), distance(known, beside)) {
            let s = s.hypot(t).hypot(self.prior.alike * self.size);
            tie.log += self.ratio(x - y, s, 1.0 / self.size, &[[x, s]])?;
            tie.at_most += self.ratio(0.0, s, 1.0 / self.size, &[[y, s]])?;
        }
        Some(tie)
    }

    /// ln N(off; 0, s^2) over the density by chance; `None` where it is farther off than chance has it.
    fn ratio(&self, off: f64, s: f64, even: f64, usual: &[[f64; 2]]) -> Option<f64> {
        let is_near = (off / s).abs() <= self.prior.contradicts;
        is_near.then(|| normal(off, s).ln() - self.chance(even, usual).ln())
    }

    /// Density of a value of any body: even, or, where it is one of those that are usual, as if that were known before. They are given by
    /// how far the value is off them and their sd.
    fn chance(&self, even: f64, usual: &[[f64; 2]]) -> f64 {
        usual.iter().map(|[off, s]| normal(*off, *s)).fold(even, f64::max)
    }
}

/// N(off; 0, s^2).
fn normal(off: f64, s: f64) -> f64 {
    log_normal(off * off, s, 1).exp()
}

#[cfg(test)]
mod tests {
    use super::super::result::{PartGeometry, PartUncertainty};
    use super::*;

    fn part(id: usize, kind: PartKind, point: [f64; 3], axis: Option<[f64; 3]>, radius: Option<f64>) -> Part {
        Part {
            id,
            kind,
            hollow: false,
            geometry: PartGeometry { point, axis, radius, ..PartGeometry::default() },
            u: PartUncertainty {
                point: Some(0.01),
                axis_deg: axis.map(|_| 0.1),
                radius: radius.map(|_| 0.01),
                ..PartUncertainty::default()
            },
            class: None,
            other_class: None,
            shape_index: None,
            curvedness: 0.0,
            points: 100,
            extent: 10.0,
            misfit: 0.01,
            rejected: None,
            p: None,
            departure: 0.0,
        }
    }

    /// A bar, a lid across it, and a ball on its axis; so far apart and so large.
    fn body(radius: f64, ball: f64, height: f64) -> Parts {
        let z = [0.0, 0.0, 1.0];
        let parts = vec![
            part(0, PartKind::Cylinder, [0.0; 3], Some(z), Some(radius)),
            part(1, PartKind::Plane, [0.0, 0.0, -5.0], Some([0.0, 0.0, -1.0]), None),
            part(2, PartKind::Sphere, [0.0, 0.0, height], None, Some(ball)),
        ];
        Parts {
            parts,
            joints: Vec::new(),
            labels: Vec::new(),
            spacing: 0.2,
            noise: 0.01,
            normal_noise_deg: 1.0,
            tolerance: 0.0,
            notes: Vec::new(),
        }
    }

    fn library(bodies: &[(&str, Parts)]) -> Vec<ObjectModel> {
        let model = |(name, body): &(&str, Parts)| ObjectModel {
            name: (*name).into(),
            parts: body.parts.clone(),
            spacing: body.spacing,
        };
        bodies.iter().map(model).collect()
    }

    #[test]
    fn sizes_and_places_tell_which_and_the_order_of_parts_does_not() {
        let models =
            library(&[("thin", body(3.0, 2.0, 8.0)), ("wide", body(4.0, 2.0, 8.0)), ("tall", body(3.0, 2.0, 9.0))]);
        let mut seen = body(3.01, 1.99, 8.02);
        let found = seen.object(&models, &ObjectPrior::default());
        assert_eq!(found[0].name.as_deref(), Some("thin"));
        assert!(found[0].probability > 0.95, "{found:?}");
        assert_eq!(found[0].pairs, [[0, 0], [1, 1], [2, 2]]);
        assert!((found.iter().map(|object| object.probability).sum::<f64>() - 1.0).abs() < 1e-12);
        seen.parts.reverse();
        let turned = seen.object(&models, &ObjectPrior::default());
        assert_eq!(turned[0].name.as_deref(), Some("thin"));
        assert!(turned[0].probability > 0.95, "{turned:?}");
    }

    #[test]
    fn another_size_and_what_is_usual_are_none_of_the_library() {
        let models = library(&[("thin", body(3.0, 2.0, 8.0))]);
        assert_eq!(body(3.4, 2.4, 7.0).object(&models, &ObjectPrior::default())[0].name, None);
        // a right angle is no sign of any object
        let mut corner = body(3.0, 2.0, 8.0);
        corner.parts.truncate(2);
        corner.parts[0] = part(0, PartKind::Plane, [0.0; 3], Some([1.0, 0.0, 0.0]), None);
        let boxes = library(&[("box", corner.clone())]);
        let found = corner.object(&boxes, &ObjectPrior::default());
        assert!(found.iter().all(|object| object.probability < 0.95), "{found:?}");
    }
}
