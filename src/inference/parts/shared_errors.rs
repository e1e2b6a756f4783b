//! What errors that neighbours share add to the covariance of a primitive's unknowns.
//!
//! ```text
//! c(r) = s^2 exp(-r / l)     least squares through the mean products of residuals of contacts r apart; distances and normals each
//! V    = C + g C (sum_{i != j} a_i a_j' c_d(r_ij) + sum_t b_it b_jt' c_n(r_ij)) C          a, b: weighted rows of distance and normal
//! g    = 1 / (1 - unknowns / n_e)       n_e = n^2 sd^2 / sum_ij c_d(r_ij): a fit takes from the residuals what it has unknowns for
//! ```
//!
//! The kernel is that of `recognition`, and the sum that of K.-Y. Liang and S. L. Zeger, *Biometrika* 73 (1986) 13, with the kernel
//! in place of products of single residuals: of few neighbourhoods these know too little.

use super::cloud::Cloud;
use super::local::Noise;
use super::tuning::PartsTuning;
use crate::primitives::descent::rows;
use crate::primitives::placed::{MOST_UNKNOWNS, Primitive};
use palpate_numeric::linalg::small::Square;
use palpate_numeric::vector::{minus, norm};

/// A primitive with the noise that its rows are weighted by.
pub(super) struct Weighted<'a> {
    pub(super) primitive: &'a Primitive,
    pub(super) noise: &'a Noise,
    pub(super) tuning: &'a PartsTuning,
}

/// An exponential covariance.
#[derive(Clone, Copy)]
struct ErrorKernel {
    variance: f64,
    range: f64,
}

impl ErrorKernel {
    fn at(&self, r: f64) -> f64 {
        self.variance * (-r / self.range).exp()
    }
}

/// By how much shared errors widen the variance of every unknown.
pub(super) fn widened(
    cloud: &Cloud,
    inner: &[u32],
    fit: &Weighted,
    covariance: &Square<MOST_UNKNOWNS>,
) -> [f64; MOST_UNKNOWNS] {
    let count = inner.len().min(fit.tuning.shared_asked);
    let asked: Vec<usize> = (0..count).map(|k| inner[k * inner.len() / count] as usize).collect();
    let rows: Vec<_> = asked.iter().map(|i| rows(fit.primitive, cloud.points[*i], cloud.normals[*i])).collect();
    let pairs = pairs(cloud, &asked);
    let products = |first: usize, last: usize, i: usize, j: usize| -> f64 {
        (first..=last).map(|t| rows[i][t].0 * rows[j][t].0).sum::<f64>()
    };
    let of_distances = kernel((cloud, fit.tuning), &pairs, fit.noise.distance.powi(2), |i, j| products(0, 0, i, j));
    let of_normals = kernel((cloud, fit.tuning), &pairs, fit.noise.normal.powi(2), |i, j| 0.5 * products(1, 3, i, j));
    let mut middle = [[0.0; MOST_UNKNOWNS]; MOST_UNKNOWNS];
    let free = fit.primitive.kind.free();
    let weights = [fit.noise.distance.powi(-2), fit.noise.normal.powi(-2)];
    // every contact asked stands for as many
    let stands = (inner.len() as f64 / count as f64).powi(2);
    let mut together = 0.0;
    for (t, kernel) in [of_distances, of_normals, of_normals, of_normals].into_iter().enumerate() {
        let Some(kernel) = kernel else { continue };
        let heavy = stands * weights[usize::from(t > 0)].powi(2);
        for (i, j, r) in &pairs {
            let shared = heavy * kernel.at(*r);
            let (a, b) = (&rows[*i][t].1, &rows[*j][t].1);
            free.iter().for_each(|&p| free.iter().for_each(|&q| middle[p][q] += shared * (a[p] * b[q] + b[p] * a[q])));
            together += if t == 0 { 2.0 * stands * kernel.at(*r) } else { 0.0 };
        }
    }
    let all = inner.len() as f64;
    let independent = all / (1.0 + together / (all * fit.noise.distance.powi(2)));
    let taken = (free.len() as f64 / independent).min(fit.tuning.shared_taken);
    std::array::from_fn(|k| {
        let row = |p: usize| free.iter().map(|&q| middle[p][q] * covariance[q][k]).sum::<f64>();
        let more: f64 = free.iter().map(|&p| covariance[k][p] * row(p)).sum();
        if covariance[k][k] > 0.0 { 1.0 + (more / covariance[k][k]).max(0.0) / (1.0 - taken) } else { 1.0 }
    })
}

/// Every two of these contacts, and how far apart they are.
fn pairs(cloud: &Cloud, asked: &[usize]) -> Vec<(usize, usize, f64)> {
    let apart = |i: usize, j: usize| norm(minus(cloud.points[asked[i]], cloud.points[asked[j]]));
    (0..asked.len()).flat_map(|i| (0..i).map(move |j| (i, j))).map(|(i, j)| (i, j, apart(i, j))).collect()
}

/// The kernel that products of residuals follow best, beside `variance` of each; `None` where chance explains them.
fn kernel(
    (cloud, tuning): (&Cloud, &PartsTuning),
    pairs: &[(usize, usize, f64)],
    variance: f64,
    product: impl Fn(usize, usize) -> f64,
) -> Option<ErrorKernel> {
    let mut best: Option<(f64, ErrorKernel)> = None;
    for range in tuning.shared_ranges.map(|range| range * cloud.spacing) {
        let (mut along, mut square) = (0.0, 0.0);
        for (i, j, r) in pairs.iter().filter(|(_, _, r)| *r < 4.0 * range) {
            let shape = (-r / range).exp();
            along += shape * product(*i, *j);
            square += shape * shape;
        }
        let clear = along / (square.sqrt() * variance);
        if square > 0.0 && clear > tuning.shared_clear && best.is_none_or(|(most, _)| clear > most) {
            best = Some((clear, ErrorKernel { variance: (along / square).min(variance), range }));
        }
    }
    best.map(|(_, kernel)| kernel)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parts::hypothesis::{descended, extent};
    use crate::primitives::descent::Sample;
    use crate::primitives::placed::PartKind;
    use palpate_numeric::draws::EffectDraws;

    /// By how much the place of a plane is less sure: errors of 0.1 are each contact's own, or those of squares of 5 by 5 contacts.
    fn of_plane(square: u32) -> f64 {
        let draws = EffectDraws::new(12, "squares");
        let place = |k: u32| {
            let [i, j] = [k % 25, k / 25];
            let mut error = [0.0];
            draws.gaussians(0, u64::from(i / square + 25 * (j / square)), 1, &mut error);
            [f64::from(i), f64::from(j), 0.1 * error[0]]
        };
        let points: Vec<_> = (0..625).map(place).collect();
        let cloud = Cloud::new(&points, vec![[0.0, 0.0, 1.0]; 625]).unwrap();
        let noise = Noise { distance: 0.1 / cloud.scale, normal: f64::INFINITY };
        let sample = Sample {
            points: &cloud.points,
            normals: &cloud.normals,
            u_distance: noise.distance,
            u_normal: f64::INFINITY,
        };
        let found = descended(PartKind::Plane, &sample, &[], extent(&cloud.points)).unwrap();
        let fit = Weighted { primitive: &found.primitive, noise: &noise, tuning: &PartsTuning::default() };
        let inner: Vec<u32> = (0..625).collect();
        widened(&cloud, &inner, &fit, &found.covariance().unwrap())[2]
    }

    /// Of 25 squares the mean is known as of 25 contacts; an exponential through their steps finds most of that.
    #[test]
    fn errors_of_squares_leave_a_mean_as_unsure_as_few_contacts() {
        let [own, shared] = [of_plane(1), of_plane(5)];
        assert!(own < 1.5, "{own}");
        assert!((8.0..60.0).contains(&shared), "{shared}");
    }
}
