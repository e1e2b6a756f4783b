//! Whether one primitive does for two, or a simpler kind for a richer one, when neighbours may share errors.
//!
//! ```text
//! keep the richer      n_e (ln(s1 / s2) + 2 ln(v1 / v2)) > max(k ln(n_e), chi-square of k at `by_chance`) / 2
//!                      k = unknowns 2 - unknowns 1
//! s, v                 rms of distances and of normals per tangent axis, of the simpler (1) and of the richer (2) description
//! n_e = n / max over widths of  sum_cells (sum_i d_i)^2 / sum_i d_i^2               d: distances from the simpler
//! ```
//!
//! n_e is the number of independent residuals: n where they have nothing to do with each other, and n over the points of one
//! patch where a patch errs together. So a dent a hundred times the noise is a part, and the waves of a depth camera are not,
//! however many points show them. With n in place of n_e this is the criterion of G. Schwarz, *Ann. Statist.* 6 (1978) 461. Of few
//! independent residuals it asks little: of twenty, one more unknown would do by chance in every twelfth case. There the
//! likelihood ratio's own test is asked (S. S. Wilks, *Ann. Math. Statist.* 9 (1938) 60).

use std::collections::HashMap;

use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::cloud::Cloud;
use super::local::Noise;
use super::tuning::PartsTuning;
use crate::primitives::placed::Primitive;
use palpate_geometry::shape::chi_square_upper_tail;
use palpate_numeric::vector::{dot, minus};

/// Widths of cells in spacings; the widest holds some 4000 points of a surface.
const WIDTHS: [f64; 5] = [4.0, 8.0, 16.0, 32.0, 64.0];

/// Cells of all widths, one number for each point and width.
#[derive(Clone, Debug)]
pub(super) struct Cells {
    of: [Vec<u32>; WIDTHS.len()],
    /// How often unknowns that mean nothing may seem to, where the residuals are few.
    by_chance: f64,
}

impl Cells {
    pub(super) fn new(cloud: &Cloud, tuning: &PartsTuning) -> Cells {
        let of = WIDTHS.map(|width| {
            let mut numbers: HashMap<[i32; 3], u32> = HashMap::new();
            let side = width * cloud.spacing.max(f64::MIN_POSITIVE);
            let cell = |p: &[f64; 3]| p.map(|v| (v / side).floor() as i32);
            let mut number = |p| {
                let next = numbers.len() as u32;
                *numbers.entry(cell(p)).or_insert(next)
            };
            cloud.points.iter().map(&mut number).collect()
        });
        Cells { of, by_chance: tuning.by_chance }
    }

    /// What so many unknowns cost beside so many independent residuals.
    pub(super) fn price(&self, unknowns: usize, independent: f64) -> f64 {
        let unknowns = unknowns as f64;
        let by_chance = ChiSquared::new(unknowns).map_or(0.0, |law| law.inverse_cdf(1.0 - self.by_chance));
        0.5 * (unknowns * independent.ln()).max(by_chance)
    }

    /// How many of these residuals are independent.
    pub(super) fn independent(&self, residuals: &[(u32, f64)]) -> f64 {
        let squares: f64 = residuals.iter().map(|(_, d)| d * d).sum();
        let count = residuals.len() as f64;
        if squares <= 0.0 {
            return count;
        }
        let shared =
            self.of.iter().map(|cells| sums_of(cells, residuals).map(|(sum, _)| sum * sum).sum::<f64>() / squares);
        (count / shared.fold(1.0, f64::max)).max(3.0)
    }

    /// By how much the variance of the sum of these values exceeds that of independent ones, 1 where nothing says that
    /// neighbours share errors: the largest over the widths at which chance does not explain it. So many `unknowns` were
    /// fitted, which makes the sums of few cells smaller than errors are.
    ///
    /// ```text
    /// sum_cells (sum_i h_i)^2 / sum_i h_i^2  ~  chi-square of as many cells
    /// factor = sum_cells (sum_i h_i)^2 / sum h^2 x cells / (cells - unknowns)
    /// ```
    pub(super) fn shared(&self, values: &[(u32, f64)], unknowns: usize) -> f64 {
        let squares: f64 = values.iter().map(|(_, h)| h * h).sum();
        if squares <= 0.0 {
            return 1.0;
        }
        let of_width = |cells: &Vec<u32>| {
            let (mut statistic, mut together, mut count) = (0.0, 0.0, 0.0);
            for (sum, own) in sums_of(cells, values) {
                (statistic, together, count) = (statistic + sum * sum / own, together + sum * sum, count + 1.0);
            }
            let left = count - unknowns as f64;
            let p = chi_square_upper_tail(statistic, count);
            // as many cells as twice the unknowns: with fewer the fit itself has made most sums zero
            if left >= unknowns as f64 && p < self.by_chance / WIDTHS.len() as f64 {
                together / squares * count / left
            } else {
                1.0
            }
        };
        self.of.iter().map(of_width).fold(1.0, f64::max)
    }
}

/// Sums of the values in every cell that holds any, with the sum of their squares, in the order of the cells' numbers: sums that
/// are taken in another order differ in their last bits.
fn sums_of(cells: &[u32], residuals: &[(u32, f64)]) -> impl Iterator<Item = (f64, f64)> {
    let most = residuals.iter().map(|(i, _)| cells[*i as usize] as usize + 1).max().unwrap_or(0);
    let mut sums = vec![(0.0, 0.0); most];
    for (i, d) in residuals {
        let (sum, squares) = &mut sums[cells[*i as usize] as usize];
        (*sum, *squares) = (*sum + d, *squares + d * d);
    }
    sums.into_iter().filter(|(_, squares)| *squares > 0.0)
}

/// Residuals of some points under their primitives.
#[derive(Clone, Debug, Default)]
pub(super) struct Residuals {
    distances: Vec<(u32, f64)>,
    /// Squares of what the normals are off by.
    normals: Vec<f64>,
}

impl Residuals {
    /// Adds points that belong to one primitive.
    pub(super) fn add(&mut self, cloud: &Cloud, members: &[u32], primitive: &Primitive) {
        for &i in members {
            let (d, normal) = primitive.nearest(cloud.points[i as usize]);
            let off = minus(normal, cloud.normals[i as usize]);
            self.distances.push((i, d));
            self.normals.push(dot(off, off));
        }
    }

    /// How many of the distances are independent.
    pub(super) fn independent(&self, cells: &Cells) -> f64 {
        cells.independent(&self.distances)
    }

    /// Root mean squares of this share of the least, with what is let pass.
    pub(super) fn spread(&self, pass: &Noise, share: f64) -> Noise {
        let mean = |mut squares: Vec<f64>| {
            let kept = ((share * squares.len() as f64).ceil() as usize).clamp(1, squares.len().max(1));
            if kept < squares.len() {
                squares.select_nth_unstable_by(kept - 1, f64::total_cmp);
            }
            squares.iter().take(kept).sum::<f64>() / kept as f64
        };
        let distances = mean(self.distances.iter().map(|(_, d)| d * d).collect());
        let normals = 0.5 * mean(self.normals.clone());
        Noise { distance: distances.sqrt().hypot(pass.distance), normal: normals.sqrt().hypot(pass.normal) }
    }

    /// By how much the richer description beats this one.
    pub(super) fn lose_to(&self, richer: &Residuals, unknowns: usize, cells: &Cells, pass: &Noise) -> f64 {
        self.lose_over(richer, unknowns, cells, pass, 1.0)
    }

    /// The same where both are one primitive: what the richer leaves over is errors then, and what the simpler leaves besides is not.
    pub(super) fn lose_to_kind(&self, richer: &Residuals, unknowns: usize, cells: &Cells, pass: &Noise) -> f64 {
        self.lost(richer, (unknowns, cells.independent(&richer.distances)), cells, (pass, 1.0))
    }

    /// The same over the `share` of the contacts that is nearest, where others at the rim may be of neither: a plane with what a camera puts
    /// beside its edges is no ring.
    pub(super) fn lose_over(
        &self,
        richer: &Residuals,
        unknowns: usize,
        cells: &Cells,
        pass: &Noise,
        share: f64,
    ) -> f64 {
        self.lost(richer, (unknowns, cells.independent(&self.distances)), cells, (pass, share))
    }

    fn lost(
        &self,
        richer: &Residuals,
        (unknowns, independent): (usize, f64),
        cells: &Cells,
        (pass, share): (&Noise, f64),
    ) -> f64 {
        let (one, two) = (self.spread(pass, share), richer.spread(pass, share));
        let of_normals = if pass.normal.is_finite() { 2.0 * (one.normal / two.normal).ln() } else { 0.0 };
        let gain = (one.distance / two.distance).ln() + of_normals;
        independent * gain - cells.price(unknowns, independent)
    }
}
