//! A sensor whose normals are all too steep, or all too flat, by one factor.
//!
//! ```text
//! slopes measured = (1 + g) slopes true          g ~ N(0, `Tuning::gain`^2), one for all normals
//! y_n = .. + g v,   v = (n.a) ((n.a) n - a) . t  a: normal of the patch's frame, n: of the surface, t: tangent
//! taken out of the rows as `shared_error.rs` says
//! ```
//!
//! Slopes that a sensor takes from shading, or heights in another unit, leave positions and normals that each show a smooth surface,
//! of other curvatures. Nothing in the residuals of either tells, and both together show something between them, with an interval
//! that holds neither. With a gain the positions tell how strongly the surface bends, and the normals how that varies.
//!
//! Where positions say little, as under three fingers, whose heights lie on a circle whatever was touched, some surface explains both
//! without a gain. That this surface is none of the simple ones is no reason for a gain, however much likelier simple ones are before
//! the contacts are looked at: a gain is believed where no surface explains both as well.

use super::shared_error::{SharedError, ToldOfShared};
use crate::bodies::Tuning;
use crate::recognition::contacts::Cells;
use crate::recognition::kinds::{Kind, Model};
use palpate_numeric::vector::{dot, minus, scaled, unit};

/// What a gain does to the normals of every cell.
#[derive(Clone, Debug)]
pub(crate) struct Gain {
    /// v along both tangents.
    steeper: [Vec<f64>; 2],
    /// Prior standard deviation of the gain, and the multiple of it up to which one is believed.
    sd: f64,
    most: f64,
    /// What the rows say of it that it was taken out of.
    told: Option<ToldOfShared>,
}

impl Gain {
    /// About the general surface under a displacement of these slopes along both tangents; `None` without normals, or where positions
    /// are too few to tell by themselves how the surface bends.
    pub(crate) fn new(
        cells: &Cells,
        models: &[Model],
        slopes: Option<&[Vec<f64>; 2]>,
        tuning: &Tuning,
    ) -> Option<Gain> {
        cells.normals.as_ref().filter(|_| cells.points.len() >= tuning.rare_error_from)?;
        let steeper = steeper(cells, models, slopes)?;
        Some(Gain { steeper, sd: tuning.gain, most: tuning.most_gains, told: None })
    }

    /// The same gain about another surface.
    pub(crate) fn about(&self, cells: &Cells, models: &[Model], slopes: Option<&[Vec<f64>; 2]>) -> Option<Gain> {
        Some(Gain { steeper: steeper(cells, models, slopes)?, told: None, ..*self })
    }

    /// The gain as an error that all normals share.
    pub(super) fn shared(&self) -> SharedError {
        SharedError { along: self.steeper.clone(), sd: self.sd }
    }

    /// Keeps what its rows said when it was taken out of them.
    pub(super) fn keep(&mut self, told: ToldOfShared) {
        self.told = Some(told);
    }

    /// Whether a sensor may be so wrong.
    pub(crate) fn is_believable(&self, coefficients: &[f64]) -> bool {
        self.mean(coefficients).is_some_and(|gain| gain.abs() <= self.most * self.sd)
    }

    /// Mean of the gain where the columns have these coefficients.
    pub(crate) fn mean(&self, coefficients: &[f64]) -> Option<f64> {
        self.told.as_ref().map(|told| told.mean(coefficients))
    }
}

/// v along both tangents of every cell, about the general surface under a displacement of these slopes.
fn steeper(cells: &Cells, models: &[Model], slopes: Option<&[Vec<f64>; 2]>) -> Option<[Vec<f64>; 2]> {
    let general = models.iter().find(|m| m.kind() == Kind::General)?;
    let normal = |i: usize| {
        let (_, n) = general.distance_and_normal(cells.points[i]);
        let Some(slopes) = slopes else { return n };
        unit(minus(n, cells.gradient(i, n, [slopes[0][i], slopes[1][i]])))
    };
    let of = |side: usize, i: usize| {
        let n = normal(i);
        let steep = n[2];
        dot(scaled(steep, minus(scaled(steep, n), [0.0, 0.0, 1.0])), cells.tangents[side][i])
    };
    Some([0, 1].map(|side| (0..cells.points.len()).map(|i| of(side, i)).collect()))
}

#[cfg(test)]
mod tests {
    use crate::recognition::{Recognition, RecognitionOptions, Remark};
    use palpate_geometry::contact::Contacts;
    use palpate_numeric::draws::EffectDraws;
    use palpate_numeric::vector::Vector;

    /// 49 touches of a ball of radius 10 whose slopes are measured `steeper` times too steep.
    fn touched(steeper: f64, seed: u64) -> Recognition {
        let draws = EffectDraws::new(seed, "gain");
        let (mut points, mut normals) = (Vec::<Vector>::new(), Vec::<Vector>::new());
        for k in 0..49_u32 {
            let mut noise = [0.0; 3];
            draws.gaussians(u64::from(k), 0, 3, &mut noise);
            let [x, y] = [k % 7, k / 7].map(|v| 4.0 * (f64::from(v) / 3.0 - 1.0));
            let height = (100.0 - x * x - y * y).sqrt();
            points.push([x, y, height - 10.0 + 0.02 * noise[0]]);
            let slope = |v: f64, noise: f64| steeper * v / height + 0.03 * noise;
            normals.push([slope(x, noise[1]), slope(y, noise[2]), 1.0]);
        }
        let contacts = Contacts::from_points(&points).with_normal_vectors(&normals);
        Recognition::of(&contacts, &RecognitionOptions::default()).unwrap()
    }

    fn says_steeper(found: &Recognition) -> bool {
        found.notes.iter().any(|note| matches!(note, Remark::Gain { gain } if *gain > 0.0))
    }

    /// Without a gain no interval of R holds the truth (`benches/runs/coverage.md`).
    #[test]
    fn normals_that_are_all_too_steep_do_not_bend_a_ball_more() {
        for seed in 1..=4 {
            let found = touched(1.3, seed);
            assert!(says_steeper(&found), "{:?}", found.notes);
            assert!((found.curvedness.mean - 0.1).abs() < 3.0 * found.curvedness.u, "{:?}", found.curvedness);
        }
    }

    #[test]
    fn normals_that_agree_with_the_positions_have_no_gain() {
        assert!((1..=4).all(|seed| !says_steeper(&touched(1.0, seed))));
    }
}
