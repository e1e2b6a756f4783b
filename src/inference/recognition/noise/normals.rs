//! The covariance of normals' tangential errors, found once under the general surface and kept.
//!
//! ```text
//! Sigma_n = s_n^2 (D_n + rho exp(-r/l)) for either tangential part; rho, l by restricted likelihood over the grid
//! ```

use faer::Mat;

use crate::dense;
use crate::recognition::contacts::is_known;
use crate::recognition::equations::{Rows, column_of, first_of_displacement};
use crate::recognition::kinds::Kind;

use super::covariance::{Factors, Kernel};
use super::gain::Gain;
use super::shared_error::take_out;
use super::tilt::Tilt;

/// Log likelihood below the best at which stronger correlations are not tried once it falls.
const HOPELESS: f64 = 8.0;

/// The covariance found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct NormalNoise {
    /// Number of the kernel.
    kernel: usize,
    /// Variance of an average cell's independent error.
    pub(crate) variance: f64,
    /// What it adds to the log evidence of every hypothesis: `-(log det Sigma_n)/2 + log prior(rho, l)`.
    pub(crate) log_share: f64,
}

impl NormalNoise {
    /// By restricted likelihood; `None` without normals or where no covariance can be factored.
    ///
    /// `spent` are degrees of freedom that a displacement has taken from the normals.
    pub(crate) fn find(rows: &Rows, factors: &Factors, spent: f64) -> Option<NormalNoise> {
        let mut best = NormalNoise::under(rows, factors, 0, spent);
        for chain in 0..Kernel::CHAINS {
            let mut last = f64::NEG_INFINITY;
            for kernel in Kernel::chain(chain) {
                let Some(found) = NormalNoise::under(rows, factors, kernel, spent) else { continue };
                let here = found.0;
                let largest = best.map_or(f64::NEG_INFINITY, |(largest, _)| largest);
                if here > largest {
                    best = Some(found);
                }
                if here < largest - HOPELESS && here <= last {
                    break;
                }
                last = here;
            }
        }
        best.map(|(_, found)| found)
    }

    /// Independent errors that are as large as differences between neighbours say; `None` without normals.
    pub(crate) fn of_differences(rows: &Rows, factors: &Factors) -> Option<NormalNoise> {
        let (halves, own, distances) = (rows.normals.as_ref()?, factors.variance(), factors.distances());
        let (y, known) = (column_of(Kind::General), known(own));
        let others = |i: usize| known.iter().copied().filter(move |&j| j != i);
        let nearest = |i: usize| others(i).min_by(|&j, &k| distances[(i, j)].total_cmp(&distances[(i, k)]));
        let pairs: Vec<[usize; 2]> = known.iter().filter_map(|&i| Some([i, nearest(i)?])).collect();
        let square = |half: &Mat<f64>, [i, j]: [usize; 2]| (half[(i, y)] - half[(j, y)]).powi(2) / (own[i] + own[j]);
        let sum: f64 = halves.iter().flat_map(|half| pairs.iter().map(|&pair| square(half, pair))).sum();
        let variance = (sum / (2 * pairs.len()).max(1) as f64).max(1e-24).max(factors.floors.of_normals());
        let log_det = 2.0 * dense::log_det(factors.of(0)?);
        Some(NormalNoise::new(0, variance, known.len(), log_det))
    }

    /// Errors under a kernel, of so many cells with normals; the log determinant is that of both parts' covariance over the variance.
    fn new(kernel: usize, variance: f64, cells: usize, log_det: f64) -> NormalNoise {
        let log_share = Kernel::all()[kernel].log_prior - 0.5 * (log_det + 2.0 * cells as f64 * variance.ln());
        NormalNoise { kernel, variance, log_share }
    }

    /// Whether neighbours share errors.
    pub(crate) fn is_shared(&self) -> bool {
        self.kernel != 0
    }

    /// Standard deviation of one normal's error, radians, what neighbours share of it included; a cell has so many normals.
    pub(crate) fn sd_of_normal(&self, per_cell: f64) -> f64 {
        (self.variance * (per_cell + Kernel::all()[self.kernel].ratio)).sqrt()
    }

    /// Log likelihood and variance under one kernel.
    fn under(rows: &Rows, factors: &Factors, kernel: usize, spent: f64) -> Option<(f64, NormalNoise)> {
        let n = known(factors.variance()).len();
        let p = Kind::General.unknowns() - 1;
        let own = (column_of(Kind::General), 1 + Kind::General.unknowns());
        let (gram, log_det) = whitened(rows, factors, kernel, own)?;
        // the height h does not move normals: its column, the first, is left out
        let jj = dense::cholesky(&Mat::from_fn(p, p, |i, j| gram[(2 + i, 2 + j)]))?;
        let mut along: Vec<f64> = (0..p).map(|i| gram[(2 + i, 0)]).collect();
        dense::forward(&jj, &mut along);
        let rss = (gram[(0, 0)] - along.iter().map(|v| v * v).sum::<f64>()).max(1e-24);
        let dof = ((2 * n).saturating_sub(p) as f64 - spent).max(1.0);
        let prior = Kernel::all()[kernel].log_prior;
        let variance = (rss / dof).max(factors.floors.of_normals());
        // 0 where no floor raises the variance
        let raised = dof * ((rss / dof) / variance - 1.0);
        let likelihood = -0.5 * (log_det + dense::log_det(&jj) + dof * variance.ln() + raised) + prior;
        Some((likelihood, NormalNoise::new(kernel, variance, n, log_det)))
    }

    /// Gram matrix of the whitened normal rows; a tilt and a gain are taken out of it, and their share of the log evidence counted.
    pub(crate) fn gram(
        &mut self,
        rows: &Rows,
        factors: &Factors,
        tilt: Option<&mut Tilt>,
        gain: Option<&mut Gain>,
    ) -> Option<Mat<f64>> {
        let lower = factors.of(self.kernel)?;
        let mut halves = rows.normals.clone()?;
        halves.iter_mut().for_each(|half| dense::whiten(lower, half.as_mut()));
        let of_tilt = tilt.as_deref().into_iter().flat_map(|tilt| tilt.shared(self.variance));
        let errors = of_tilt.chain(gain.as_deref().map(Gain::shared)).collect();
        let (log_det, mut told) = take_out(errors, &mut halves, lower, self.variance);
        self.log_share -= 0.5 * log_det;
        if let Some(gain) = gain {
            told.pop().into_iter().for_each(|told| gain.keep(told));
        }
        if let Some(tilt) = tilt {
            tilt.keep(told);
        }
        let [mut gram, other] =
            halves.map(|half| dense::gram_of_groups(half.as_ref(), first_of_displacement(), &rows.groups));
        gram += other;
        for j in 0..gram.ncols() {
            gram.col_as_slice_mut(j).iter_mut().for_each(|v| *v /= self.variance);
        }
        Some(gram)
    }
}

/// Numbers of the cells that have normals.
fn known(own: &[f64]) -> Vec<usize> {
    (0..own.len()).filter(|&i| is_known(own[i])).collect()
}

/// Gram matrix of some columns (first, count) under `D + rho exp(-r/l)`, and the log determinant of both parts' covariance.
fn whitened(rows: &Rows, factors: &Factors, kernel: usize, (first, count): (usize, usize)) -> Option<(Mat<f64>, f64)> {
    let halves = rows.normals.as_ref()?;
    let lower = factors.of(kernel)?;
    let mut sum = Mat::<f64>::zeros(count, count);
    for half in halves {
        let mut whitened = half.as_ref().subcols(first, count).to_owned();
        dense::whiten(lower, whitened.as_mut());
        sum += dense::gram(whitened.as_ref());
    }
    Some((sum, 2.0 * dense::log_det(lower)))
}

#[cfg(test)]
mod tests {
    use crate::recognition::{Recognition, RecognitionOptions};
    use palpate_geometry::contact::Contacts;
    use palpate_numeric::draws::Lcg;
    use palpate_numeric::vector::{Vector, unit};
    use std::f64::consts::TAU;

    /// Errors that neighbours share are errors of every single normal.
    #[test]
    fn normals_that_are_turned_with_their_neighbours_scatter_by_all_that_they_are_turned() {
        let mut generator = Lcg::new(12);
        // two waves of errors across each other, root mean square 3 degrees in all
        let error = |x: f64, y: f64| 3.0_f64.to_radians() * ((TAU * x / 3.0).sin() + (TAU * y / 3.0).cos());
        let one = |_: i32| {
            let [x, y] = [0, 1].map(|_| 8.0 * generator.uniform() - 4.0);
            let z = (400.0 - x * x - y * y).sqrt() - 20.0 + 0.001 * generator.normal();
            ([x, y, z], unit([x / (20.0 + z) + error(x, y), y / (20.0 + z) + error(y, x), 1.0]))
        };
        let (points, normals): (Vec<Vector>, Vec<Vector>) = (0..150).map(one).unzip();
        let contacts = Contacts::from_points(&points).with_normal_vectors(&normals);
        let found = Recognition::of(&contacts, &RecognitionOptions::default()).unwrap();
        let sd = found.noise.sd_normal_deg.unwrap();
        // of what a patch holds a few lengths of, the size is known to a factor of two
        assert!((1.5..6.0).contains(&sd), "{sd}");
    }
}
