//! What errors that neighbours share add to the covariance of a primitive's unknowns.
//!
//! ```text
//! c(r) = s^2 exp(-r / l)     least squares through the mean products of residuals of contacts r apart; distances and normals each
//! x(r) = s r / l exp(-r / l) the same of a distance and the lean of a normal towards it
//! V    = C + g C (sum_{i != j} a_i a_j' c_d(r_ij) + sum_t b_it b_jt' c_n(r_ij) + (a_i b_je' + b_je a_i') x(r_ij)) C
//!        a, b: weighted rows of distance and normal;  e: direction from i to j
//! g    = 1 / (1 - unknowns / n_e)       n_e = n^2 sd^2 / sum_ij c_d(r_ij): a fit takes from the residuals what it has unknowns for
//! ```
//!
//! The kernel is that of `recognition`, and the sum that of K.-Y. Liang and S. L. Zeger, *Biometrika* 73 (1986) 13, with the kernel
//! in place of products of single residuals: of few neighbourhoods these know too little.

use super::cloud::Cloud;
use super::local::Noise;
use super::tuning::PartsTuning;
use crate::primitives::normal_equations::rows;
use crate::primitives::placed::{MOST_UNKNOWNS, Primitive};
use palpate_numeric::linalg::small::Square;
use palpate_numeric::vector::{Vector, dot, minus, norm};

/// Ranges beyond which an exponential covariance is none.
const RANGES: f64 = 4.0;

/// A primitive with the noise that its rows are weighted by.
pub(super) struct Weighted<'a> {
    pub(super) primitive: &'a Primitive,
    pub(super) noise: &'a Noise,
    pub(super) tuning: &'a PartsTuning,
}

/// A derivative by the unknowns.
type Row = [f64; MOST_UNKNOWNS];

/// How a covariance falls with the distance over its range.
type Law = fn(f64) -> f64;

/// Of errors of one sort.
const ALIKE: Law = |r| (-r).exp();

/// Of an error of place and the lean of a normal farther on: where normals follow the surface that errors displaced, they lean along it.
const AHEAD: Law = |r| r * (-r).exp();

/// A covariance.
#[derive(Clone, Copy)]
struct ErrorKernel {
    law: Law,
    size: f64,
    range: f64,
}

impl ErrorKernel {
    fn at(&self, r: f64) -> f64 {
        self.size * (self.law)(r / self.range)
    }
}

/// Two contacts, by their numbers among those asked and those beside them.
struct Pair {
    one: usize,
    other: usize,
    apart: f64,
    /// Unit vector from the one to the other, in the primitive's own axes.
    towards: Vector,
}

impl Pair {
    /// The component towards the other of what has three, those of a normal being rows 1 to 3.
    fn ahead(&self, of: impl Fn(usize) -> f64) -> f64 {
        (0..3).map(|k| self.towards[k] * of(k + 1)).sum()
    }
}

/// By how much shared errors widen the variance of every unknown.
pub(super) fn widened(
    cloud: &Cloud,
    inner: &[u32],
    fit: &Weighted,
    covariance: &Square<MOST_UNKNOWNS>,
) -> [f64; MOST_UNKNOWNS] {
    let [asked, beside] = fit.tuning.shared_asked.map(|most| evenly_among(inner, most));
    let of = |i: &usize| rows(fit.primitive, cloud.points[*i], cloud.normals[*i]);
    let [asked_rows, rows] = [&asked, &beside].map(|some| some.iter().map(of).collect::<Vec<_>>());
    let pairs = pairs(cloud, [&asked, &beside], fit);
    let products = |first: usize, last: usize, p: &Pair| -> f64 {
        (first..=last).map(|t| asked_rows[p.one][t].0 * rows[p.other][t].0).sum::<f64>()
    };
    let sd = [fit.noise.distance, fit.noise.normal];
    let of =
        |law: Law, bound: f64, product: &dyn Fn(&Pair) -> f64| kernel((cloud, fit.tuning), &pairs, law, bound, product);
    let of_distances = of(ALIKE, sd[0] * sd[0], &|p| products(0, 0, p));
    let of_normals = of(ALIKE, sd[1] * sd[1], &|p| 0.5 * products(1, 3, p));
    let of_both = of(AHEAD, sd[0] * sd[1], &|p| asked_rows[p.one][0].0 * p.ahead(|t| rows[p.other][t].0));
    let mut middle = [[0.0; MOST_UNKNOWNS]; MOST_UNKNOWNS];
    let free = fit.primitive.kind.free();
    // every contact asked stands for as many, and so does every one beside it
    let stands = (inner.len() as f64).powi(2) / (asked.len() * beside.len()) as f64;
    let mut add = |heavy: f64, a: &Row, b: &Row| {
        free.iter().for_each(|&p| free.iter().for_each(|&q| middle[p][q] += heavy * (a[p] * b[q] + b[p] * a[q])));
    };
    let weights = sd.map(|sd| sd.powi(-2));
    let mut together = 0.0;
    for p in &pairs {
        let (one, other) = (&asked_rows[p.one], &rows[p.other]);
        for (t, kernel) in [of_distances, of_normals, of_normals, of_normals].into_iter().enumerate() {
            let Some(kernel) = kernel else { continue };
            add(0.5 * stands * weights[usize::from(t > 0)].powi(2) * kernel.at(p.apart), &one[t].1, &other[t].1);
        }
        if let Some(kernel) = of_both {
            let ahead: Row = std::array::from_fn(|k| p.ahead(|t| other[t].1[k]));
            add(stands * weights[0] * weights[1] * kernel.at(p.apart), &one[0].1, &ahead);
        }
        together += of_distances.map_or(0.0, |kernel| stands * kernel.at(p.apart));
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

/// At most so many of these contacts, evenly among all.
fn evenly_among(inner: &[u32], most: usize) -> Vec<usize> {
    let count = inner.len().min(most);
    (0..count).map(|k| inner[k * inner.len() / count] as usize).collect()
}

/// Every contact asked with every other one within the widest range.
fn pairs(cloud: &Cloud, [asked, beside]: [&[usize]; 2], fit: &Weighted) -> Vec<Pair> {
    let widest = RANGES * cloud.spacing * fit.tuning.shared_ranges.iter().fold(0.0, |most, range| range.max(most));
    let all = (0..asked.len()).flat_map(|one| (0..beside.len()).map(move |other| (one, other)));
    let pair = |(one, other): (usize, usize)| {
        let step = minus(cloud.points[beside[other]], cloud.points[asked[one]]);
        let apart = norm(step);
        let is_near = asked[one] != beside[other] && apart > 0.0 && apart < widest;
        let own = fit.primitive.axes.map(|axis| dot(axis, step) / apart);
        is_near.then_some(Pair { one, other, apart, towards: own })
    };
    all.filter_map(pair).collect()
}

/// The kernel that products of residuals follow best, where none exceeds the `bound`; `None` where chance explains them.
fn kernel(
    (cloud, tuning): (&Cloud, &PartsTuning),
    pairs: &[Pair],
    law: Law,
    bound: f64,
    product: &dyn Fn(&Pair) -> f64,
) -> Option<ErrorKernel> {
    let mut best: Option<(f64, ErrorKernel)> = None;
    for range in tuning.shared_ranges.map(|range| range * cloud.spacing) {
        let (mut along, mut square) = (0.0, 0.0);
        for pair in pairs.iter().filter(|pair| pair.apart < RANGES * range) {
            let shape = law(pair.apart / range);
            along += shape * product(pair);
            square += shape * shape;
        }
        let clear = (along / (square.sqrt() * bound)).abs();
        if square > 0.0 && clear > tuning.shared_clear && best.is_none_or(|(most, _)| clear > most) {
            best = Some((clear, ErrorKernel { law, size: (along / square).clamp(-bound, bound), range }));
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
