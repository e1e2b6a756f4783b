//! Whether places lie on one conic: a ring, two lines, an ellipse. Heights over them do not tell how a surface bends.
//!
//! ```text
//! A = [1 u v u^2 u v v^2], columns with mean square 1        u, v: places in the plane of the patch, each with mean 0 and sd 1
//! on a conic:  least eigenvalue of A'A/n < Tuning::on_conic  then some A w is nearly 0 with |w| = 1
//! ```
//!
//! Heights `A c` over such places are the same for c and for c + t w, whatever t is, and w bends. F. L. Bookstein, *Computer Graphics
//! and Image Processing* 9 (1979) 56, on fitting conics to scattered places.

use faer::Mat;

use crate::bodies::Tuning;
use crate::dense;
use palpate_numeric::linalg;

/// Terms of the second degree in two variables.
const TERMS: usize = 6;

/// Whether these places lie on one conic, or so near to it that they tell nothing else.
pub(crate) fn on_conic(places: &[[f64; 2]], tuning: &Tuning) -> bool {
    NearestConic::of(places).is_some_and(|conic| conic.eigenvalue < tuning.on_conic)
}

/// Root mean square distance of places from the conic next to them, to first order (P. Sampson, *Computer Graphics and Image Processing* 18
/// (1982) 97), its five unknowns counted. `None` of six places or fewer, which tell none.
pub(crate) fn distance_from_conic(places: &[[f64; 2]]) -> Option<f64> {
    let conic = NearestConic::of(places).filter(|_| places.len() > TERMS)?;
    let square: f64 = places.iter().map(|place| conic.distance(*place).powi(2)).sum();
    Some((square / (places.len() - TERMS + 1) as f64).sqrt())
}

/// The conic `w' A = 0` that places are nearest to, over coordinates of mean 0 and sd 1.
struct NearestConic {
    means: [f64; 2],
    sds: [f64; 2],
    weights: [f64; TERMS],
    /// Mean square of `A w` over columns of size 1.
    eigenvalue: f64,
}

impl NearestConic {
    /// Value over slope.
    fn distance(&self, place: [f64; 2]) -> f64 {
        let [u, v] = [0, 1].map(|k| (place[k] - self.means[k]) / self.sds[k]);
        let [a, b, c, d, e, f] = self.weights;
        let value = a + b * u + c * v + d * u * u + e * u * v + f * v * v;
        let slope = [(b + 2.0 * d * u + e * v) / self.sds[0], (c + e * u + 2.0 * f * v) / self.sds[1]];
        value / slope[0].hypot(slope[1]).max(f64::MIN_POSITIVE)
    }

    fn of(places: &[[f64; 2]]) -> Option<NearestConic> {
        let count = places.len() as f64;
        let mean = |k: usize| places.iter().map(|p| p[k]).sum::<f64>() / count;
        let means = [mean(0), mean(1)];
        let sd = |k: usize| (places.iter().map(|p| (p[k] - means[k]).powi(2)).sum::<f64>() / count).sqrt();
        let sds = [sd(0), sd(1)];
        let mut columns = Mat::from_fn(places.len(), TERMS, |i, term| {
            let [u, v] = [0, 1].map(|k| (places[i][k] - means[k]) / sds[k]);
            [1.0, u, v, u * u, u * v, v * v][term]
        });
        let mut sizes = [0.0; TERMS];
        for j in 0..TERMS {
            let column = columns.col_as_slice_mut(j);
            let size = column.iter().map(|v| v * v).sum::<f64>().sqrt().max(f64::MIN_POSITIVE);
            column.iter_mut().for_each(|v| *v /= size);
            sizes[j] = size;
        }
        let gram = dense::gram(columns.as_ref());
        let eigen = linalg::eigen(gram.as_ref())?;
        let weights = std::array::from_fn(|j| eigen.vectors[(j, 0)] / sizes[j]);
        Some(NearestConic { means, sds, weights, eigenvalue: eigen.values[0] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring(width: f64) -> Vec<[f64; 2]> {
        let place = |k: usize| {
            let (radius, turn) =
                (5.0 + width * ((37 * k % 40) as f64 / 39.0 - 0.5), k as f64 * std::f64::consts::TAU / 40.0);
            [3.0 + radius * turn.cos(), 2.0 + 0.4 * radius * turn.sin()]
        };
        (0..40).map(place).collect()
    }

    #[test]
    fn places_beside_a_bent_path_are_as_far_from_a_conic_as_they_err() {
        let path: Vec<[f64; 2]> = (0..30)
            .map(|k| {
                let (turn, off) = (0.05 * k as f64, 0.02 * ((37 * k % 30) as f64 / 29.0 - 0.5));
                [(5.0 + off) * turn.cos(), (5.0 + off) * turn.sin()]
            })
            .collect();
        let off = distance_from_conic(&path).unwrap();
        assert!((0.003..0.012).contains(&off), "{off}");
        assert!(distance_from_conic(&lattice(&[-4.0, 0.0, 4.0], 8)).unwrap() > 0.3);
    }

    fn lattice(rows: &[f64], stations: usize) -> Vec<[f64; 2]> {
        rows.iter().flat_map(|x| (0..stations).map(move |k| [*x, 0.5 * k as f64])).collect()
    }

    #[test]
    fn rings_and_two_rows_are_conics_and_three_rows_are_none() {
        let are_on = |places: &[[f64; 2]]| on_conic(places, &Tuning::default());
        assert!(are_on(&ring(0.0)) && are_on(&ring(0.05)));
        // wide by a tenth of its radius
        assert!(!are_on(&ring(0.5)));
        assert!(are_on(&lattice(&[-4.0, 4.0], 15)) && are_on(&lattice(&[-4.0, 4.0, 4.02], 15)));
        assert!(!are_on(&lattice(&[-4.0, 0.0, 4.0], 3)) && !are_on(&lattice(&[-0.1, 0.0, 0.1], 15)));
    }
}
