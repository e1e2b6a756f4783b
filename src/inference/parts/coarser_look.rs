//! The same cloud cut again, with larger departures let pass, where contacts depart from their parts side by side.
//!
//! ```text
//! asked    mad(d_i - d_j) / sqrt 2 < mad(d) / 2         d_i: distance from its part, contact j next to i and of the same part
//! taken    n_e (l1 - l2) <= price of the unknowns that the finer cut (2) has more than the coarser (1), their parts among them
//! l        (1 - f) (ln s + 2 ln v) + f (ln s0 + 2 ln v0)       s, v, n_e: `evidence.rs`
//! f        share of the contacts in no part; these are anywhere within the reach (s0), with any normal (2 pi e v0^2 = 4 pi)
//! ```
//!
//! The wall of a can that was handled is no cylinder to a thousandth of its size: any number of balls, cones and rings follow it a little
//! better, none of them as it is, and all say less than the cylinder that it is to a hundredth. Where parts are what the body is made of,
//! contacts scatter about them one by one, or lie on them to the last digit, and nothing is asked.

use std::f64::consts::E;

use super::cloud::DIGITS;
use super::evidence::{Cells, Residuals};
use super::partition::{Field, NONE, Partition};
use super::scatter::lie_off_together;
use palpate_numeric::statistics::mad;

impl Partition {
    /// The coarsest cut that tells more than the one before it, this being the first, with what it was cut by and what share of the cloud's
    /// size it lets pass. `None` where this one stands.
    pub(super) fn at_coarser_looks<'a>(
        &self,
        field: &Field<'a>,
        cut: impl Fn(&Field<'a>) -> (Partition, Field<'a>),
    ) -> Option<(Partition, Field<'a>, f64)> {
        let mut taken: Option<(Partition, Field, f64)> = None;
        for share in field.tuning.departs.into_iter().filter(|share| *share > field.pass.distance) {
            let best = taken.as_ref().map_or(self, |(found, ..)| found);
            if best.parts.len() < 2 || !best.departs_in_a_pattern(field) {
                break;
            }
            let (found, fine) = cut(&field.letting_pass(share));
            let [rough, precise] = [&found, best].map(|cut| ToldCut::new(cut, field));
            if !found.parts.is_empty() && precise.gains_over(&rough, field.cells) <= 0.0 {
                taken = Some((found, fine, share));
            }
        }
        taken
    }

    /// Whether these parts tell the cloud better than those, normals and contacts of no part included: what has more unknowns must earn them.
    pub(super) fn outtells(&self, those: &Partition, field: &Field) -> bool {
        let [own, other] = [self, those].map(|cut| ToldCut::new(cut, field));
        let gain = |one: &ToldCut, coarser: &ToldCut| one.gains_over(coarser, field.cells);
        if own.unknowns < other.unknowns { gain(&other, &own) <= 0.0 } else { gain(&own, &other) > 0.0 }
    }

    /// Whether contacts next to each other lie off their part together.
    fn departs_in_a_pattern(&self, field: &Field) -> bool {
        let cloud = field.cloud;
        let off = |i: usize| self.parts[self.labels[i] as usize].nearest(cloud.points[i]).0;
        let held = || (0..cloud.len()).filter(|i| self.labels[*i] != NONE);
        let pairs = held().filter_map(|i| {
            let next = cloud.near(i).iter().map(|j| *j as usize).find(|j| self.labels[*j] == self.labels[i])?;
            Some(off(i) - off(next))
        });
        mad(held().map(off)) > DIGITS && lie_off_together(held().map(off), pairs, &field.tuning.recognition)
    }
}

/// How well a cut tells a cloud.
struct ToldCut {
    /// What a contact costs.
    length: f64,
    /// Contacts that are off independently.
    independent: f64,
    unknowns: usize,
}

impl ToldCut {
    fn new(cut: &Partition, field: &Field) -> ToldCut {
        let mut off = Residuals::default();
        for (part, members) in cut.parts.iter().zip(cut.members()) {
            off.add(field.cloud, &members, part);
        }
        let count = field.cloud.len() as f64;
        let strays = cut.labels.iter().filter(|label| **label == NONE).count() as f64 / count;
        let pass = field.told(field.pass);
        let of =
            |distance: f64, normal: f64| distance.ln() + if pass.normal.is_finite() { 2.0 * normal.ln() } else { 0.0 };
        let held = off.spread(&pass, field.tuning.own);
        let of_stray = of(field.tuning.recognition.scatter_of_none(), (2.0 / E).sqrt());
        ToldCut {
            length: (1.0 - strays) * of(held.distance, held.normal) + strays * of_stray,
            independent: off.independent(field.cells) / (1.0 - strays).max(1.0 / count),
            unknowns: cut.parts.iter().map(|part| part.kind.free().len() + 1).sum(),
        }
    }

    /// By how much it is more probable than a coarser one, by whose independent contacts both are judged.
    fn gains_over(&self, coarser: &ToldCut, cells: &Cells) -> f64 {
        let more = self.unknowns.saturating_sub(coarser.unknowns);
        coarser.independent * (coarser.length - self.length) - cells.price(more, coarser.independent)
    }
}

#[cfg(test)]
mod tests {
    use crate::parts::{PartKind, Parts, PartsOptions};
    use palpate_geometry::contact::Contacts;
    use palpate_numeric::vector::{Vector, unit};

    const SIDE: u32 = 26;

    /// Contacts on the faces of a cube of side 2, each of which departs from a plane by waves of this height, two across the face.
    fn cube(height: f64) -> Contacts {
        let contact = |k: u32| -> (Vector, Vector) {
            let (face, k) = (k / (SIDE * SIDE), k % (SIDE * SIDE));
            let place = |k: u32| 2.0 * (f64::from(k) + 0.5) / f64::from(SIDE) - 1.0;
            let ([u, v], phase) = ([place(k % SIDE), place(k / SIDE)], f64::from(face));
            let wave = [6.0 * u + phase, 7.0 * v - phase];
            let off = height * (wave[0].sin() + wave[1].cos()) / 2.0_f64.sqrt();
            let lean = [6.0 * height * wave[0].cos(), -7.0 * height * wave[1].sin()].map(|s| s / 2.0_f64.sqrt());
            let sign = if face % 2 == 0 { 1.0 } else { -1.0 };
            // the face's own normal first, then turned to the axis that it faces
            let about = |own: Vector| [0, 1, 2].map(|axis| own[(axis + (face / 2) as usize) % 3]);
            (about([sign * (1.0 + off), u, v]), unit(about([sign, -lean[0], -lean[1]])))
        };
        let (points, normals): (Vec<Vector>, Vec<Vector>) = (0..6 * SIDE * SIDE).map(contact).unzip();
        Contacts::from_points(&points).with_normal_vectors(&normals)
    }

    fn kinds(found: &Parts) -> Vec<PartKind> {
        found.parts.iter().map(|part| part.kind).collect()
    }

    #[test]
    fn faces_that_depart_by_a_hundredth_are_faces() {
        let options = PartsOptions::default();
        let [exact, handled] = [0.0, 0.012].map(|height| Parts::of(&cube(height), &options).unwrap());
        assert_eq!(kinds(&exact), [PartKind::Plane; 6]);
        assert_eq!(kinds(&handled), [PartKind::Plane; 6]);
        assert!(handled.tolerance > 1.5 * exact.tolerance, "{} {}", handled.tolerance, exact.tolerance);
        // what is named is what is let pass
        let named = PartsOptions { tolerance: Some(exact.tolerance), ..options };
        assert_eq!(Parts::of(&cube(0.012), &named).unwrap().tolerance, exact.tolerance);
    }
}
