//! Uncertainty of a recognised surface point by point.
//!
//! ```text
//! S, R, k1, k2       standard deviations over the drawn surfaces, between the points of the map
//! position, normal   the same, or those of a quadratic height over the chart, where these are larger:
//!                    u^2 = s^2 f'(X'X)^-1 f,   f = (1, u, v, u^2, u v, v^2),   s^2 = (sd^2 + shared sd^2) N / N_eff
//! ```
//!
//! A quadratic over the chart, fitted to the contacts that belong to the surface, has all that a recognised surface may do near
//! its own shape; a plane or a sphere would leave it less, and a displaced surface moves by more. N_eff contacts with independent errors would tell the mean height
//! as well as all N do, so that shared errors count. Normals are not counted, which makes both larger than they need be.

use crate::dense;
use crate::recognition::{MapPoint, Recognition};
use palpate_geometry::contact::Contacts;
use palpate_geometry::curvature::Derivatives;
use palpate_geometry::shape::{ByJet, PointSds, ShapeSds, Uncertain, point_sds};
use palpate_geometry::surface::Jet;

/// Coefficients of the quadratic.
const TERMS: usize = 6;

/// Contacts that are looked at; of more, every so many-th.
const MOST_CONTACTS: usize = 4096;

/// Half sides of the chart in units of the frame are at least this long, so that contacts on one line leave a tangent plane.
const LEAST_SIDE: f64 = 1e-30;

/// A part of the largest diagonal entry that keeps a design of few contacts solvable.
const RIDGE: f64 = 1e-12;

/// The recognised surface with what tells its uncertainty.
#[derive(Debug)]
pub struct Pointwise<'a> {
    found: &'a Recognition,
    /// Lower Cholesky factor of X'X / N, and the chart's middle and half sides.
    design: Option<faer::Mat<f64>>,
    middle: [f64; 2],
    half: [f64; 2],
    /// Variance of the mean height.
    variance: f64,
}

impl<'a> Pointwise<'a> {
    /// Of contacts, which for a grid are its pixels.
    pub fn new(found: &'a Recognition, contacts: &Contacts) -> Pointwise<'a> {
        let surface = &found.surface;
        let middle = [surface.u, surface.v].map(|[lo, hi]| 0.5 * (lo + hi));
        let half = [surface.u, surface.v].map(|[lo, hi]| (0.5 * (hi - lo)).max(LEAST_SIDE));
        let step = contacts.len().div_ceil(MOST_CONTACTS).max(1);
        let mut sums = faer::Mat::<f64>::zeros(TERMS, TERMS);
        let mut count = 0.0;
        for r in (0..contacts.len()).step_by(step) {
            let chart = surface.chart_of([contacts.x[r], contacts.y[r], contacts.z[r]]);
            let f = terms([0, 1].map(|k| (chart[k] - middle[k]) / half[k]));
            // strays far off the patch would say that it is known there
            if f.iter().all(|v| v.abs() <= 4.0) {
                count += 1.0;
                (0..TERMS).for_each(|a| (0..TERMS).for_each(|b| sums[(a, b)] += f[a] * f[b]));
            }
        }
        let largest = (0..TERMS).map(|k| sums[(k, k)]).fold(f64::MIN_POSITIVE, f64::max);
        (0..TERMS).for_each(|k| sums[(k, k)] += RIDGE * largest);
        (0..TERMS).for_each(|a| (0..TERMS).for_each(|b| sums[(a, b)] /= f64::max(count, 1.0)));
        let noise = &found.noise;
        let total = noise.sd_z * noise.sd_z + noise.sd_correlated * noise.sd_correlated;
        let variance = total / found.effective_contacts.max(1.0);
        Pointwise { found, design: dense::cholesky(&sums), middle, half, variance }
    }

    /// Standard uncertainties on the surface nearest to a place, input units.
    pub fn at(&self, place: [f64; 3]) -> Option<PointSds> {
        if let Some(body) = self.found.surface.body() {
            let [position, normal, s, curvedness, k1, k2] = body.sds_at(place);
            let shape_index = self.found.shape_index.map(|_| s.min(1.0));
            let (curvedness, curvatures) = (Some(curvedness), Some([k1, k2]));
            return Some(PointSds { position, normal, shape_index, curvedness, curvatures });
        }
        let chart = self.found.surface.chart_of(place);
        let local = [0, 1].map(|k| (chart[k] - self.middle[k]) / self.half[k]);
        let [shape_index, curvedness, position, normal, k1, k2] = self.drawn_at(self.found.share_of_map(place));
        let curved = self.found.shape_index.is_some();
        let sds = point_sds(self, local).filter(|sds| sds.position.is_finite())?.scaled(self.found.surface.frame.scale);
        // those of the map are in the input's unit already
        Some(PointSds {
            position: position.map_or(sds.position, |drawn| sds.position.max(drawn)),
            normal: normal.map_or(sds.normal, |drawn| sds.normal.max(drawn)).min(std::f64::consts::PI),
            shape_index: shape_index.filter(|_| curved).map(|u| u.min(1.0)),
            curvedness,
            curvatures: k1.zip(k2).map(<[f64; 2]>::from),
        })
    }

    /// What the draws say of S, R, position, normal, k1 and k2 between the four nearest points of the map.
    fn drawn_at(&self, share: [f64; 2]) -> [Option<f64>; 6] {
        let [n, m] = self.found.grid;
        let cell = |k: usize, count: usize| {
            let t = share[k].clamp(0.0, 1.0) * count.saturating_sub(1) as f64;
            let first = (t.floor() as usize).min(count.saturating_sub(2));
            (first, t - first as f64)
        };
        let ((i, s), (j, t)) = (cell(0, n), cell(1, m));
        let at = |i: usize, j: usize| self.found.map.get(i.min(n - 1) * m + j.min(m - 1));
        let value = |pick: fn(&MapPoint) -> f64| {
            let between = |i: usize| Some((1.0 - t) * pick(at(i, j)?) + t * pick(at(i, j + 1)?));
            Some((1.0 - s) * between(i)? + s * between(i + 1)?).filter(|u| u.is_finite())
        };
        let of_shape = [value(|p| p.u_shape_index), value(|p| p.u_curvedness)];
        let of_place = [value(|p| p.u_position), value(|p| p.u_normal)];
        let [s, r, position, normal] = [of_shape[0], of_shape[1], of_place[0], of_place[1]];
        [s, r, position, normal, value(|p| p.u_curvatures[0]), value(|p| p.u_curvatures[1])]
    }
}

/// The quadratic height over the chart, in units of the frame; places are shares of the half sides.
impl Uncertain for Pointwise<'_> {
    fn jet(&self, [u, v]: [f64; 2]) -> Jet {
        let [a, b] = self.half;
        let derivatives =
            Derivatives { u: [a, 0.0, 0.0], v: [0.0, b, 0.0], ..Derivatives::of_height(0.0, 0.0, 0.0, 0.0, 0.0) };
        Jet { point: [a * u, b * v, 0.0], derivatives }
    }

    fn functional_sd(&self, [u, v]: [f64; 2], by: &ByJet) -> Option<f64> {
        let lower = self.design.as_ref()?;
        let orders = [terms([u, v]), [0.0, 1.0, 0.0, 2.0 * u, v, 0.0], [0.0, 0.0, 1.0, 0.0, u, 2.0 * v]];
        let mut f: [f64; TERMS] =
            std::array::from_fn(|k| orders.iter().zip(by).map(|(of, by)| by[2] * of[k]).sum::<f64>());
        dense::forward(lower, &mut f);
        Some(self.variance.sqrt() / self.found.surface.frame.scale * f.iter().map(|v| v * v).sum::<f64>().sqrt())
    }

    /// A quadratic says little of curvatures; the draws say more.
    fn shape_sds(&self, _: [f64; 2], _: &Jet) -> ShapeSds {
        [None; 4]
    }
}

fn terms([u, v]: [f64; 2]) -> [f64; TERMS] {
    [1.0, u, v, u * u, u * v, v * v]
}
