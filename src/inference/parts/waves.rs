//! Parts that are no more than waves of the errors that neighbours share.
//!
//! ```text
//! a part is told      share n > unknowns of its primitive        share = n_e / n of all parts together (`evidence.rs`)
//! a region is told    share n > independent_of_region, the unknowns of the surface through neighbours
//! ```
//!
//! A depth camera errs alike over some hundred contacts, so that a wave of its errors holds one or two independent ones. Any ring or cone
//! follows it, and with normals computed from the same positions both agree on it. Where errors are independent share is 1.

use super::cloud::FEWEST_POINTS;
use super::partition::{Field, NONE, Partition, SWEEPS};

impl Partition {
    /// Parts with fewer independent errors than their primitive has unknowns go. Their contacts are those of the parts beside them, or of
    /// none.
    pub(super) fn drop_waves(&mut self, field: &Field) {
        let share = self.independent(field);
        let members = self.members();
        let is_told = |part: usize| share * members[part].len() as f64 > self.parts[part].kind.free().len() as f64;
        let told: Vec<bool> = (0..self.parts.len()).map(is_told).collect();
        if told.iter().all(|told| *told) {
            return;
        }
        self.keep(|part| told[part]);
        let scatter = self.scatter(field);
        (0..SWEEPS).for_each(|_| self.relabel(field, &scatter));
        self.refit(field);
    }

    /// Fewest contacts that tell a surface of no kind.
    pub(super) fn fewest_of_region(&self, field: &Field) -> usize {
        FEWEST_POINTS.max((field.tuning.independent_of_region / self.independent(field)).ceil() as usize)
    }

    /// Share of the errors that are independent.
    fn independent(&self, field: &Field) -> f64 {
        let held = (0..field.cloud.len()).filter(|i| self.labels[*i] != NONE);
        let off = |i: usize| (i as u32, self.parts[self.labels[i] as usize].nearest(field.cloud.points[i]).0);
        let residuals: Vec<(u32, f64)> = if field.shared { held.map(off).collect() } else { Vec::new() };
        if residuals.is_empty() { 1.0 } else { field.cells.independent(&residuals) / residuals.len() as f64 }
    }
}

#[cfg(test)]
mod tests {
    use crate::parts::cloud::{Cloud, FEWEST_POINTS};
    use crate::parts::partition::{NONE, Partition};
    use crate::parts::surveyed::{LetPass, Surveyed};
    use crate::parts::tuning::PartsTuning;
    use crate::primitives::placed::{PartKind, Primitive};
    use palpate_numeric::draws::EffectDraws;
    use palpate_numeric::vector::Vector;

    /// A plane whose contacts err together in squares of 8 by 8, and two parts beside it: a ball of one square, and a plane of 40 squares.
    #[test]
    fn a_part_of_one_wave_goes_and_a_part_of_many_stays() {
        let draws = EffectDraws::new(7, "wave");
        let side = 64_u32;
        let square = |k: u32| (k % side) / 8 + 8 * (k / side / 8);
        let place = |k: u32| -> Vector {
            let mut error = [0.0];
            draws.gaussians(0, u64::from(square(k)), 1, &mut error);
            [f64::from(k % side), f64::from(k / side), 0.3 * error[0]]
        };
        let points: Vec<Vector> = (0..side * side).map(place).collect();
        let cloud = Cloud::new(&points, vec![[0.0, 0.0, 1.0]; points.len()]).unwrap();
        let tuning = PartsTuning::default();
        let pass = LetPass::new(&cloud, None, false, &tuning);
        let surveyed = Surveyed::new(cloud, &pass, &tuning);
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let plane = Primitive { kind: PartKind::Plane, origin: [0.0; 3], axes, sizes: [0.0; 3], side: 1.0 };
        let ball = Primitive { kind: PartKind::Sphere, origin: [0.0, 0.0, -1.0], sizes: [1.0, 0.0, 0.0], ..plane };
        let label = |k: u32| match square(k) {
            0 => 1,
            1..=40 => 2,
            _ => 0,
        };
        let labels: Vec<u32> = (0..side * side).map(label).collect();
        for (shared, left) in
            [(true, [PartKind::Plane; 2].to_vec()), (false, vec![PartKind::Plane, PartKind::Sphere, PartKind::Plane])]
        {
            let mut field = surveyed.field(&tuning);
            field.shared = shared;
            let mut cut = Partition { parts: vec![plane, ball, plane], labels: labels.clone() };
            let fewest = cut.fewest_of_region(&field);
            assert!(if shared { fewest > 100 } else { fewest == FEWEST_POINTS }, "{fewest}");
            cut.drop_waves(&field);
            assert_eq!(cut.parts.iter().map(|part| part.kind).collect::<Vec<_>>(), left);
            assert!(cut.labels.iter().all(|label| *label == NONE || (*label as usize) < cut.parts.len()));
        }
    }
}
