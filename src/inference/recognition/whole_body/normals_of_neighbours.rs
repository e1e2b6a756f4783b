//! Whether normals that a body does not explain are alike from one contact to the next.
//!
//! ```text
//! s_b = median |n_i - n_j| / (1.177 sqrt 2)        contact j next to i, its normal with the sign of n_i's
//! alike where s_b < s / 2                          s: sd of the normals beside the body
//! ```
//!
//! Normals at random would follow any body as badly, and say nothing against it. Those of the two sides of a plate are smooth, and a plane
//! in its middle, or a bar as wide as it, is not what was touched.

use std::f64::consts::SQRT_2;

use crate::bodies::{BodySample, Tuning, aligned};
use palpate_geometry::neighbours::Neighbours;
use palpate_numeric::statistics::{RAYLEIGH_TO_SD, upper_median};
use palpate_numeric::vector::{minus, norm};

/// Whether they are those of another surface than the body beside which they scatter by `sd`, radians. False where some are unknown.
pub(super) fn are_alike(sample: &BodySample, sd: f64, tuning: &Tuning) -> bool {
    if sample.known_normals() < sample.len() {
        return false;
    }
    let tree = Neighbours::new(&sample.points);
    let change = |i: usize| {
        let (own, next) = (sample.normals[i], sample.normals[tree.nearest_other(i)?.1]);
        Some(norm(minus(own, aligned(next, own))))
    };
    let changes: Vec<f64> = (0..sample.len()).filter_map(change).collect();
    upper_median(changes).is_some_and(|median| RAYLEIGH_TO_SD * median / SQRT_2 < tuning.sharper * sd)
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::contact::Rounding;
    use palpate_numeric::draws::Lcg;
    use palpate_numeric::vector::{Vector, unit};

    fn sample(normal: impl Fn(&mut Lcg, usize) -> Vector) -> BodySample {
        let mut generator = Lcg::new(7);
        let (points, normals): (Vec<Vector>, Vec<Vector>) = (0..200)
            .map(|k| {
                let normal = normal(&mut generator, k);
                ([generator.uniform(), generator.uniform(), 0.01 * (k % 2) as f64], normal)
            })
            .unzip();
        BodySample::new(&points, &normals, Rounding::NONE).unwrap()
    }

    #[test]
    fn those_of_two_sides_are_alike_and_those_at_random_are_not() {
        let tuning = Tuning::default();
        let sides = sample(|_, k| [0.8, 0.0, if k % 2 == 0 { -0.6 } else { 0.6 }]);
        let alike = sample(|_, k| if k % 2 == 0 { [0.0, 0.0, -1.0] } else { [0.0, 0.0, 1.0] });
        let random = sample(|generator, _| unit([0; 3].map(|_| generator.uniform() - 0.5)));
        assert!(are_alike(&alike, 0.5, &tuning));
        assert!(!are_alike(&random, 0.5, &tuning));
        // of a roof's two slopes that lie on each other most neighbours are of the other
        assert!(!are_alike(&sides, 0.5, &tuning));
    }
}
