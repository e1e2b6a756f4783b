//! Shape that a free surface does not follow, because its places are too far apart: a field of its own beside it, drawn with the surface.
//!
//! ```text
//! r_i           distance of contact i from the likeliest surface
//! c(d)          mean of r_i r_j over pairs about d apart: next to each other, and some contacts farther
//! c(d) = h^2 exp(-d^2 / 2 l^2)       h, l from two d; errors that each contact has for itself are in no c
//! f_xx = h / l^2 (g0 + sqrt 2 g1)    f_yy = h / l^2 (g0 + sqrt 2 g2)    f_xy = h / l^2 g3    slopes h / l    g: standard gaussian
//! ```
//!
//! These are the variances of the derivatives of a gaussian field (R. Adler and J. Taylor, *Random Fields and Geometry*, 2007, section 5.5).
//! Places within one cell of side 2 l have the same numbers, others have their own.

use palpate_geometry::neighbours::Neighbours;
use palpate_numeric::draws::EffectDraws;
use palpate_numeric::vector::{Vector, along, axes_along, unit};
use rand_distr::{Distribution, StandardNormal};

use super::surface_reading::SurfaceReading;
use super::tuning::Tuning;

/// The neighbours of a contact to which pairs are formed: the nearest, and one a few contacts farther.
const RANKS: [usize; 2] = [1, 6];

/// What a surface leaves, in units of the sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FinerShape {
    /// Standard deviation of its height.
    pub(crate) height: f64,
    /// Length of its correlation.
    pub(crate) length: f64,
}

impl FinerShape {
    /// Of the distances of contacts from the surface, and their feet on it: in space contacts that err alike lie nearer to each other. `None`
    /// where they lie off it each for itself.
    pub(crate) fn beside(off: &[f64], feet: &[Vector], tuning: &Tuning) -> Option<FinerShape> {
        if feet.len() < tuning.finer_from {
            return None;
        }
        let tree = Neighbours::new(feet);
        let [near, far] = RANKS.map(|rank| {
            let pair = |i: usize| tree.nearest(feet[i], rank + 1).last().map(|(square, j)| (i, *j as usize, *square));
            let pairs: Vec<(usize, usize, f64)> = (0..feet.len()).filter_map(pair).collect();
            let count = pairs.len().max(1) as f64;
            let product = pairs.iter().map(|(i, j, _)| off[*i] * off[*j]).sum::<f64>() / count;
            (product, pairs.iter().map(|(.., square)| square).sum::<f64>() / count)
        });
        let square = off.iter().map(|r| r * r).sum::<f64>() / off.len() as f64;
        // two contacts that are next to each other make one pair twice
        if near.0 <= tuning.finer_certain * square * (2.0 / feet.len() as f64).sqrt() {
            return None;
        }
        // where the farther pairs have no correlation left, it ends between both
        let least = (1.0 / (feet.len() as f64).sqrt()).min(0.5) * near.0;
        let fall = (near.0 / far.0.max(least)).ln().max(f64::MIN_POSITIVE);
        let length = ((far.1 - near.1) / (2.0 * fall)).sqrt();
        let height = (near.0 * (0.5 * near.1 / (length * length)).exp()).min(square).sqrt();
        (length.is_finite() && length > 0.0).then_some(FinerShape { height, length })
    }

    /// A reading with this field beside the surface, as draw `number` has it.
    pub(super) fn added(&self, reading: &SurfaceReading, place: Vector, number: u64) -> SurfaceReading {
        let cell = place.map(|v| (v / (2.0 * self.length)).floor() as i64);
        let key = cell.iter().fold(0_u64, |key, k| key.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(*k as u64));
        let mut generator = EffectDraws::new(number, "finer shape").generator(key, 0);
        let g: [f64; 7] = std::array::from_fn(|_| StandardNormal.sample(&mut generator));
        let [one, two, _] = axes_along(reading.normal);
        let slope = self.height / self.length;
        let bend = slope / self.length;
        let tilted = along(along(reading.normal, -slope * g[4], one), -slope * g[5], two);
        let [k1, k2] = reading.curvatures;
        let root = 2.0_f64.sqrt();
        let (a, b, c) = (k1 + bend * (g[0] + root * g[1]), k2 + bend * (g[0] + root * g[2]), bend * g[3]);
        let (mean, half) = (0.5 * (a + b), (0.5 * (a - b)).hypot(c));
        SurfaceReading {
            distance: reading.distance + self.height * g[6],
            normal: unit(tilted),
            curvatures: [mean + half, mean - half],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LENGTH: f64 = 0.2;

    /// Of contacts on waves of many directions beside a plane, whose correlation is gaussian.
    fn beside_a_plane(height: f64, noise: f64) -> Option<FinerShape> {
        let mut generator = EffectDraws::new(12, "waves").generator(0, 0);
        let mut gaussian = || -> f64 { StandardNormal.sample(&mut generator) };
        let waves: Vec<[f64; 3]> =
            (0..400).map(|_| [gaussian() / LENGTH, gaussian() / LENGTH, 9.0 * gaussian()]).collect();
        let contacts = (0..900).map(|k| {
            let [x, y] = [k % 30, k / 30].map(|v| 0.07 * f64::from(v) + 0.01 * gaussian());
            let sum: f64 = waves.iter().map(|[a, b, phase]| (a * x + b * y + phase).cos()).sum();
            (height * sum * (2.0 / waves.len() as f64).sqrt() + noise * gaussian(), [x, y, 0.0])
        });
        let (off, feet): (Vec<f64>, Vec<Vector>) = contacts.unzip();
        FinerShape::beside(&off, &feet, &Tuning::default())
    }

    #[test]
    fn waves_beside_a_surface_are_found_and_noise_is_none() {
        let found = beside_a_plane(0.03, 0.01).unwrap();
        assert!((0.8..1.25).contains(&(found.height / 0.03)), "{found:?}");
        assert!((0.75..1.3).contains(&(found.length / LENGTH)), "{found:?}");
        assert_eq!(beside_a_plane(0.0, 0.02), None);
    }

    #[test]
    fn drawn_curvatures_scatter_as_those_of_the_field() {
        let finer = FinerShape { height: 0.01, length: LENGTH };
        let flat = SurfaceReading { distance: 0.0, normal: [0.0, 0.0, 1.0], curvatures: [0.0; 2] };
        let square = |number: u64| {
            let [k1, k2] = finer.added(&flat, [0.05; 3], number).curvatures;
            // k1^2 + k2^2 = f_xx^2 + f_yy^2 + 2 f_xy^2
            k1 * k1 + k2 * k2
        };
        let mean = (0..4000).map(square).sum::<f64>() / 4000.0;
        let expected = 8.0 * (finer.height / (LENGTH * LENGTH)).powi(2);
        assert!((mean / expected - 1.0).abs() < 0.06, "{mean} {expected}");
    }
}
