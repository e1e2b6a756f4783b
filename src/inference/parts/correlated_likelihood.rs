//! How probable what a description leaves over is, where neighbours may share errors.
//!
//! ```text
//! ln p = -(squares within cells + m' (D + g K)^-1 m + ln det(D^-1 (D + g K))) / 2
//! m    means over cells, in units of the scatter of single contacts        D = 1 / contacts of a cell
//! K    displaced     a surface displaced by f, whose normals lean by its gradient: Matern's covariance of smoothness 5/2 and its derivatives
//!      apart         distances and normals each by a law of their own; without a range, each cell's own
//! ```
//!
//! g = 0 is among the laws, so that errors which nobody shares cost nothing. A scanner's waves are smooth, and a detail with an edge is not.
//! What is compared is judged by one law, and by one scatter: those that the finer description shows. Each by its own was tried, and grooves
//! of pipes were waves. So was moving the unknowns to where they fit best by the law, which moves no answer.

use std::ops::Range;

use faer::Mat;

use super::cell_means::{CellMeans, NeighbourCells, RESIDUALS};
use super::local::Noise;
use super::tuning::PartsTuning;
use crate::dense::{cholesky, log_det, whiten};
use palpate_numeric::vector::{dot, minus, norm, scaled};

/// A Cholesky factor of a covariance, and the log determinant of the covariance over that of independent errors.
pub(super) struct FactoredLaw {
    lower: Mat<f64>,
    log_det: f64,
}

/// A law by which the means over some cells err.
#[derive(Clone, Copy)]
pub(super) enum MeansLaw<'a> {
    Displaced(&'a FactoredLaw),
    Apart { distances: &'a FactoredLaw, leans: &'a FactoredLaw },
}

/// All the laws by which they may.
pub(super) struct CorrelatedErrors {
    cells: usize,
    /// Of one sort of residuals.
    single: Vec<FactoredLaw>,
    /// Of all sorts together.
    displaced: Vec<FactoredLaw>,
}

impl CorrelatedErrors {
    /// Where residuals are in units of these standard deviations; normals that tell nothing have an infinite one.
    pub(super) fn new(cells: &NeighbourCells, sd: &Noise, tuning: &PartsTuning) -> CorrelatedErrors {
        let at = |range: f64| tuning.merged_shares.map(|share| (range, share));
        let ranged = tuning.merged_ranges.into_iter().flat_map(at);
        let single = std::iter::once((0.0, 0.0)).chain(at(0.0)).chain(ranged.clone());
        let ranged = ranged.filter(|_| sd.normal.is_finite());
        CorrelatedErrors {
            cells: cells.counts.len(),
            single: single.filter_map(|(range, share)| single_factor(cells, range, share)).collect(),
            displaced: ranged.filter_map(|(range, share)| displaced_factor(cells, sd, range, share)).collect(),
        }
    }

    /// The law that these residuals find likeliest.
    pub(super) fn likeliest(&self, left: &CellMeans) -> Option<MeansLaw<'_>> {
        let of_sorts = |sorts: Range<usize>| {
            let log_density = |factor| -> f64 { sorts.clone().map(|sort| self.of_sort(factor, left, sort)).sum() };
            let rated = self.single.iter().map(|factor| (log_density(factor), factor));
            rated.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, factor)| factor)
        };
        let apart = MeansLaw::Apart { distances: of_sorts(0..1)?, leans: of_sorts(1..RESIDUALS)? };
        let all = self.displaced.iter().map(MeansLaw::Displaced).chain(std::iter::once(apart));
        let rated = all.map(|law| (self.log_density(left, &law), law));
        rated.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, law)| law)
    }

    /// Of what a description leaves over, by a law.
    pub(super) fn log_density(&self, left: &CellMeans, law: &MeansLaw) -> f64 {
        let of_means = match law {
            MeansLaw::Displaced(factor) => log_density(factor, left, 0..RESIDUALS * self.cells),
            MeansLaw::Apart { distances, leans } => {
                let factors = [distances, leans, leans].into_iter().enumerate();
                factors.map(|(sort, factor)| self.of_sort(factor, left, sort)).sum()
            }
        };
        of_means - 0.5 * left.within
    }

    fn of_sort(&self, factor: &FactoredLaw, left: &CellMeans, sort: usize) -> f64 {
        log_density(factor, left, sort * self.cells..(sort + 1) * self.cells)
    }
}

/// `-(ln det V + m' V^-1 m) / 2` of some of the means.
fn log_density(factor: &FactoredLaw, left: &CellMeans, rows: Range<usize>) -> f64 {
    let mut means = left.means.as_ref().subrows(rows.start, rows.len()).to_owned();
    whiten(&factor.lower, means.as_mut());
    -0.5 * (means.squared_norm_l2() + factor.log_det)
}

/// Variance that cells share on average, where it is so many times that of their own means.
fn shared(cells: &NeighbourCells, share: f64) -> f64 {
    share * cells.counts.iter().map(|count| 1.0 / count).sum::<f64>() / cells.counts.len() as f64
}

/// Of a covariance of so many sorts of residuals.
fn factor(cells: &NeighbourCells, sorts: usize, covariance: &Mat<f64>) -> Option<FactoredLaw> {
    let lower = cholesky(covariance)?;
    let of_counts = cells.counts.iter().map(|count| count.ln()).sum::<f64>();
    Some(FactoredLaw { log_det: log_det(&lower) + sorts as f64 * of_counts, lower })
}

/// One sort of residuals.
fn single_factor(cells: &NeighbourCells, range: f64, share: f64) -> Option<FactoredLaw> {
    let (count, shared) = (cells.counts.len(), shared(cells, share));
    let covariance = Mat::from_fn(count, count, |i, j| {
        if i == j {
            return 1.0 / cells.counts[i] + shared;
        }
        let r = norm(minus(cells.centres[i], cells.centres[j])) / (range * cells.apart);
        if range > 0.0 { shared * matern(r)[0] } else { 0.0 }
    });
    factor(cells, 1, &covariance)
}

/// Distances and leans of a surface that is displaced by f.
///
/// ```text
/// cov(f, f) = k      cov(f_i, t f'_j) = -k' (p_i - p_j) t / r      cov(t f'_i, u f'_j) = -(k'' (r t)(r u) + k' / r (t u - (r t)(r u)))
/// ```
fn displaced_factor(cells: &NeighbourCells, sd: &Noise, range: f64, share: f64) -> Option<FactoredLaw> {
    let (count, shared) = (cells.counts.len(), shared(cells, share));
    let length = range * cells.apart;
    // a slope in standard deviations of a normal, where f is in those of a distance
    let slope = sd.distance / (sd.normal * length);
    let mut covariance = Mat::<f64>::zeros(RESIDUALS * count, RESIDUALS * count);
    for i in 0..count {
        for j in 0..count {
            let step = minus(cells.centres[i], cells.centres[j]);
            let r = norm(step) / length;
            let towards = if r > 0.0 { scaled(1.0 / (r * length), step) } else { [0.0; 3] };
            let [k, first, second] = matern(r);
            let lean = -first * slope * r;
            covariance[(i, j)] = shared * k;
            for b in 0..2 {
                let along = dot(towards, cells.tangents[j][b]);
                covariance[(i, (1 + b) * count + j)] = shared * lean * along;
                covariance[((1 + b) * count + j, i)] = shared * lean * along;
                for a in 0..2 {
                    let (t, u) = (cells.tangents[i][a], cells.tangents[j][b]);
                    let both = dot(towards, t) * along;
                    let leans = -slope * slope * (second * both + first * (dot(t, u) - both));
                    covariance[((1 + a) * count + i, (1 + b) * count + j)] = shared * leans;
                }
            }
        }
    }
    (0..RESIDUALS * count).for_each(|p| covariance[(p, p)] += 1.0 / cells.counts[p % count]);
    factor(cells, RESIDUALS, &covariance)
}

/// Matern's covariance of smoothness 5/2, its first derivative over the distance, and its second one; the distance is in ranges.
///
/// ```text
/// (1 + r + r^2/3) exp(-r)        -(1 + r) exp(-r) / 3        -(1 + r - r^2) exp(-r) / 3
/// ```
fn matern(r: f64) -> [f64; 3] {
    [1.0 + r + r * r / 3.0, -(1.0 + r) / 3.0, -(1.0 + r - r * r) / 3.0].map(|factor| factor * (-r).exp())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parts::cloud::Cloud;
    use crate::primitives::placed::{PartKind, Primitive};
    use palpate_numeric::draws::EffectDraws;
    use palpate_numeric::vector::{Vector, unit};

    const SIDE: u32 = 24;
    const SD: f64 = 0.1;

    /// A plane that is touched on a lattice, displaced by waves of this size some 12 spacings long, with errors of each contact's own.
    fn left_over(waves: f64) -> (NeighbourCells, CellMeans, Noise) {
        let draws = EffectDraws::new(8, "displaced");
        let contact = |k: u32| -> (Vector, Vector) {
            let [x, y] = [k % SIDE, k / SIDE].map(f64::from);
            let mut own = [0.0; 3];
            draws.gaussians(0, u64::from(k), 3, &mut own);
            let (phase, other) = (0.5 * x + 0.2 * y, 0.3 * x - 0.45 * y);
            let f = waves * (phase.sin() + other.cos());
            let slopes = [0.5 * phase.cos() - 0.3 * other.sin(), 0.2 * phase.cos() + 0.45 * other.sin()];
            let lean = |k: usize| SD * own[1 + k] - waves * slopes[k];
            ([x, y, f + SD * own[0]], unit([lean(0), lean(1), 1.0]))
        };
        let (points, normals): (Vec<Vector>, Vec<Vector>) = (0..SIDE * SIDE).map(contact).unzip();
        let cloud = Cloud::new(&points, normals).unwrap();
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let plane = Primitive { kind: PartKind::Plane, origin: [0.0; 3], axes, sizes: [0.0; 3], side: 1.0 };
        let sd = Noise { distance: SD / cloud.scale, normal: SD };
        let cells = NeighbourCells::new(&cloud, (0..points.len() as u32).collect());
        let means = cells.means(&cloud, &[(plane, points.len())], &sd);
        (cells, means, sd)
    }

    /// What the likeliest law gains over errors that nobody shares, and whether it is that of a displaced surface.
    fn gain(waves: f64) -> (f64, bool) {
        let (cells, left, sd) = left_over(waves);
        let errors = CorrelatedErrors::new(&cells, &sd, &PartsTuning::default());
        let none = MeansLaw::Apart { distances: &errors.single[0], leans: &errors.single[0] };
        let law = errors.likeliest(&left).unwrap();
        let gain = errors.log_density(&left, &law) - errors.log_density(&left, &none);
        (gain, matches!(law, MeansLaw::Displaced(_)))
    }

    #[test]
    fn a_displaced_surface_is_told_by_its_distances_and_normals_together() {
        let (of_own, _) = gain(0.0);
        assert!((0.0..6.0).contains(&of_own), "{of_own}");
        let (of_waves, displaced) = gain(0.1);
        assert!(of_waves > 100.0 && displaced, "{of_waves} {displaced}");
    }

    /// Without shared errors it is the density of gaussians, one for every contact.
    #[test]
    fn errors_of_single_contacts_cost_their_squares() {
        let (cells, left, sd) = left_over(0.0);
        let errors = CorrelatedErrors::new(&cells, &sd, &PartsTuning::default());
        let none = MeansLaw::Apart { distances: &errors.single[0], leans: &errors.single[0] };
        let count = cells.counts.len();
        let of_means: f64 =
            (0..RESIDUALS * count).map(|row| cells.counts[row % count] * left.means[(row, 0)].powi(2)).sum();
        let found = errors.log_density(&left, &none);
        assert!((found + 0.5 * (of_means + left.within)).abs() < 1e-9 * found.abs(), "{found}");
    }

    #[test]
    fn derivatives_of_the_covariance_are_its_differences() {
        let step = 1e-4;
        for r in [0.05, 0.4, 1.0, 2.7] {
            let [_, first, second] = matern(r);
            let k = |r: f64| matern(r)[0];
            assert!((first * r - (k(r + step) - k(r - step)) / (2.0 * step)).abs() < 1e-7);
            assert!((second - (k(r + step) - 2.0 * k(r) + k(r - step)) / (step * step)).abs() < 1e-6);
        }
    }
}
