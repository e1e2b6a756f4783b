//! Waves that are too short for the contacts to show.
//!
//! ```text
//! length = 2 sqrt(A / n)        n contacts over an area A, the hull of their feet in the patch's plane
//! ```
//!
//! One contact for every half wave each way is the fewest that tell a wave, however they lie (H. J. Landau, *Acta Math.* 117 (1967) 37).
//! Shape that is shorter looks like noise. Only where contacts scatter by as much as the patch bends is that worth a word.

use palpate_geometry::convex_hull::{convex_hull, turn};
use palpate_numeric::vector::Vector;

use crate::bodies::Tuning;
use crate::recognition::{Recognition, Remark};

/// A patch with the remark how short waves may be that its contacts show, where their scatter may be such waves.
pub(crate) fn beside_short_waves(mut found: Recognition, points: &[Vector], tuning: &Tuning) -> Recognition {
    let is_deep = found.noise.sd_of_contact() > tuning.deep_waves * found.frame.scale;
    if is_deep && found.misfit.percent_of_relief > 100.0 * tuning.bend_of_waves {
        let length = shortest_wave(&found, points);
        found.notes.push(Remark::ShorterWaves { length });
    }
    found
}

/// Length of the shortest wave that the contacts tell, input units.
fn shortest_wave(found: &Recognition, points: &[Vector]) -> f64 {
    let local = |p: &Vector| {
        let [x, y, _] = found.frame.to_patch(*p);
        [x, y]
    };
    let hull = convex_hull(&points.iter().map(local).collect::<Vec<[f64; 2]>>());
    let twice = |k: usize| turn(hull[0], hull[k], hull[k + 1]);
    let area = 0.5 * (1..hull.len().saturating_sub(1)).map(twice).sum::<f64>();
    2.0 * found.frame.scale * (area / points.len().max(1) as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recognition::RecognitionOptions;
    use palpate_geometry::contact::Contacts;
    use palpate_numeric::draws::Lcg;

    fn told(count: usize, height: impl Fn(f64) -> f64) -> Option<f64> {
        let mut generator = Lcg::new(4);
        let one = |_| {
            let [x, y] = [0, 1].map(|_| 12.0 * generator.uniform() - 6.0);
            [x, y, height(x) + 0.01 * generator.normal()]
        };
        let contacts = Contacts::from_points(&(0..count).map(one).collect::<Vec<Vector>>());
        let found = Recognition::of(&contacts, &RecognitionOptions::default()).unwrap();
        let length = |remark: &Remark| if let Remark::ShorterWaves { length } = remark { Some(*length) } else { None };
        found.notes.iter().find_map(length)
    }

    #[test]
    fn waves_between_contacts_are_said_to_be_possible_with_the_length_of_those_that_are_not() {
        // 14 contacts over 12 x 12: one for every 3.2 x 3.2, and the hull is smaller
        let length = told(14, |x| 0.5 * (std::f64::consts::PI * x).sin()).unwrap();
        assert!((4.0..6.5).contains(&length), "{length}");
        assert_eq!(told(14, |_| 0.0), None);
        assert_eq!(told(14, |x| x * x / 40.0), None);
    }
}
