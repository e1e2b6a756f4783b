//! A sensor whose normals are all turned by one small angle: a finger that sits askew in its joint, a camera that is not quite level.
//!
//! ```text
//! n measured = n + w x n          w = (w_x, w_y, 0),   w_x, w_y ~ N(0, sd^2), one for all normals
//! sd = min(largest, times s_n)    [largest, times] = `Tuning::tilt`,   s_n: sd of a cell's normals
//! ```
//!
//! It moves no curvature: it only turns the whole surface that normals show against the one that positions show. Rows that do not know of
//! it take the difference for noise, or for a departure in which both agree. Where normals may be turned they do not say how a patch lies,
//! and under three fingers, whose heights lie on a circle, intervals are twice as wide for that: such a sensor is one of few.

use super::shared_error::{SharedError, ToldOfShared};
use crate::bodies::Tuning;
use crate::recognition::contacts::Cells;
use palpate_numeric::vector::{cross, dot};

/// The angles about both axes across the patch.
#[derive(Clone, Debug)]
pub(crate) struct Tilt {
    about: [[Vec<f64>; 2]; 2],
    /// Prior standard deviation of either, at most and over the scatter of normals.
    sds: [f64; 2],
    /// What the rows say of each that it was taken out of.
    told: Vec<ToldOfShared>,
}

impl Tilt {
    /// `None` without normals, or where positions are too few to tell how the surface lies.
    pub(crate) fn new(cells: &Cells, tuning: &Tuning) -> Option<Tilt> {
        let normals = cells.normals.as_ref().filter(|_| cells.points.len() >= tuning.rare_error_from)?;
        let about = |axis| {
            let of = |side: usize| {
                let turned = normals.measured.iter().map(|n| cross(axis, *n));
                turned.zip(&cells.tangents[side]).map(|(by, t)| dot(by, *t)).collect()
            };
            [of(0), of(1)]
        };
        Some(Tilt { about: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(about), sds: tuning.tilt, told: Vec::new() })
    }

    /// The angles as errors that all normals share, where those of a cell scatter by this variance.
    pub(super) fn shared(&self, variance: f64) -> impl Iterator<Item = SharedError> {
        let [largest, over_scatter] = self.sds;
        let sd = largest.min(over_scatter * variance.sqrt());
        self.about.iter().map(move |along| SharedError { along: along.clone(), sd })
    }

    /// Keeps what the rows said of each when it was taken out of them.
    pub(super) fn keep(&mut self, told: Vec<ToldOfShared>) {
        self.told = told;
    }

    /// The whole angle in degrees, where the columns have these coefficients.
    pub(crate) fn angle_deg(&self, coefficients: &[f64]) -> Option<f64> {
        let square = self.told.iter().map(|told| told.mean(coefficients).powi(2)).sum::<f64>();
        (!self.told.is_empty()).then_some(square.sqrt().to_degrees())
    }
}

#[cfg(test)]
mod tests {
    use crate::recognition::{Recognition, RecognitionOptions, Remark};
    use palpate_geometry::contact::Contacts;
    use palpate_numeric::draws::EffectDraws;
    use palpate_numeric::vector::{Vector, along, cross};

    /// 36 touches of a bar of radius 12 along y, whose normals are turned by an angle about an axis that is neither its own nor across.
    fn touched(degrees: f64, seed: u64) -> Recognition {
        let draws = EffectDraws::new(seed, "tilt");
        let angle = degrees.to_radians();
        let (mut points, mut normals) = (Vec::<Vector>::new(), Vec::<Vector>::new());
        for k in 0..36_u32 {
            let mut noise = [0.0; 6];
            draws.gaussians(u64::from(k), 0, 6, &mut noise);
            let [x, y] = [k % 6, k / 6].map(|v| 2.0 * f64::from(v) - 5.0);
            let x = x + 0.3 * noise[4];
            let height = (144.0 - x * x).sqrt();
            points.push([x, y + 0.3 * noise[5], height - 12.0 + 0.02 * noise[0]]);
            let normal = [x / 12.0, 0.0, height / 12.0];
            let turned = along(normal, angle, cross([0.6, 0.8, 0.0], normal));
            normals.push(along(turned, 0.017, [noise[1], noise[2], noise[3]]));
        }
        let contacts = Contacts::from_points(&points).with_normal_vectors(&normals);
        Recognition::of(&contacts, &RecognitionOptions::default()).unwrap()
    }

    fn said(found: &Recognition) -> Option<f64> {
        found.notes.iter().find_map(|note| if let Remark::Tilt { degrees } = note { Some(*degrees) } else { None })
    }

    /// Without a tilt intervals are two thirds wider at three degrees, and hold S of a bar in three of four fits at eight.
    #[test]
    fn normals_that_are_all_turned_leave_shape_and_bend_as_they_are() {
        for seed in 1..=6 {
            let [level, askew] = [0.0, 8.0].map(|degrees| touched(degrees, seed));
            assert_eq!(said(&level), None);
            assert!(said(&askew).is_some_and(|degrees| (degrees - 8.0).abs() < 1.0), "{:?}", askew.notes);
            let (r, s) = (askew.curvedness, askew.shape_index.unwrap());
            assert!((r.mean - 0.5_f64.sqrt() / 12.0).abs() < 3.0 * r.u, "{r:?}");
            assert!(
                (s.mean - 0.5).abs() < 0.05 && r.u < 1.1 * level.curvedness.u,
                "{s:?} {r:?} {:?}",
                level.curvedness
            );
        }
    }
}
