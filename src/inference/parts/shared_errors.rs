//! What errors that neighbours share add to the covariance of a primitive's unknowns.
//!
//! ```text
//! covariance of the residuals     M (v I + s K) M,   M = I - A C A'          v, s: at which e'e and e'Ke are what is expected of them
//! K(r) = exp(-r / l)  of distances, and of normals        r / l exp(-r / l)  of a distance and the lean of a normal towards it
//! V    = C (v A'A + s A'KA) C                                                l: where s K tells most of the residuals
//! ```
//!
//! A fit takes from the residuals what it has unknowns for, and of few neighbourhoods it takes most: M says how much. C. R. Rao, *Estimation
//! of variance and covariance components: MINQUE theory*, J. Multivariate Anal. 1 (1971) 257. The kernel is that of `recognition`. A range
//! of which the unknowns take most could not be told from them, and is not asked.

use super::cloud::Cloud;
use super::neighbour_products::{
    CovarianceLaw, ENTRIES, KernelProducts, RESIDUAL, RowProducts, SummedRows, Weighted, kernel_products,
};
use super::tuning::PartsTuning;
use crate::primitives::placed::MOST_UNKNOWNS;
use palpate_numeric::draws::EffectDraws;
use palpate_numeric::linalg::small::Square;
use palpate_numeric::statistics::evenly_among;

/// The rows of one sort: their number, products of rows, and those products with C before them.
struct RowsOfASort {
    count: f64,
    squares: RowProducts,
    taken: Square<MOST_UNKNOWNS>,
}

/// A variance of single contacts and a covariance that neighbours share.
struct ErrorComponents {
    single: f64,
    shared: f64,
    /// How much e'e and e'Ke fall together by them.
    gain: f64,
}

/// Covariance of the unknowns where `covariance` is that under independent errors.
pub(super) fn with_shared_errors(
    cloud: &Cloud,
    inner: &[u32],
    fit: &Weighted,
    covariance: &Square<MOST_UNKNOWNS>,
) -> Square<MOST_UNKNOWNS> {
    let [asked, beside] = fit.tuning.shared_asked;
    let (asked, beside) = (
        evenly_among(inner.len(), asked).map(|k| inner[k] as usize).collect::<Vec<usize>>(),
        drawn_among(inner, beside),
    );
    let rows: Vec<SummedRows> = beside.iter().map(|i| SummedRows::new(cloud, *i, fit)).collect();
    let estimate = VarianceEstimate::new(fit.tuning, (inner.len(), asked.len()), &rows, covariance);
    let products = kernel_products(cloud, &asked, (&beside, &rows), fit);
    let mut middle = [[0.0; MOST_UNKNOWNS]; MOST_UNKNOWNS];
    let mut add = |heavy: f64, products: &RowProducts| {
        (0..MOST_UNKNOWNS).for_each(|p| (0..MOST_UNKNOWNS).for_each(|q| middle[p][q] += heavy * products[p][q]));
    };
    for law in CovarianceLaw::ALL {
        let of_law = products.iter().filter(|kernel| kernel.law == law);
        let found = of_law.filter_map(|kernel| Some((estimate.components(kernel)?, kernel)));
        let best = found.max_by(|a, b| a.0.gain.total_cmp(&b.0.gain));
        let rows = match law {
            CovarianceLaw::Distances => Some(&estimate.sorts[0]),
            CovarianceLaw::Normals => Some(&estimate.sorts[1]),
            CovarianceLaw::Ahead => None,
        };
        if let Some(rows) = rows {
            add(best.as_ref().map_or(1.0, |(found, _)| found.single.max(0.0)), &rows.squares);
        }
        if let Some((found, kernel)) = best {
            add(found.shared * estimate.stands, &kernel.once);
        }
    }
    let right: Square<MOST_UNKNOWNS> =
        middle.map(|row| std::array::from_fn(|q| (0..MOST_UNKNOWNS).map(|k| row[k] * covariance[k][q]).sum()));
    covariance.map(|row| std::array::from_fn(|q| (0..MOST_UNKNOWNS).map(|k| row[k] * right[k][q]).sum()))
}

/// What components of variance are estimated from.
struct VarianceEstimate<'a> {
    tuning: &'a PartsTuning,
    covariance: &'a Square<MOST_UNKNOWNS>,
    /// Rows of distances and of normals.
    sorts: [RowsOfASort; 2],
    /// How many pairs every pair of contacts that is asked stands for, and how many contacts every one beside it.
    stands: f64,
    beside: f64,
    /// By how much chance is larger, since a pair of which both are asked counts twice.
    twice: f64,
}

impl<'a> VarianceEstimate<'a> {
    fn new(
        tuning: &'a PartsTuning,
        (all, asked): (usize, usize),
        beside: &[SummedRows],
        covariance: &'a Square<MOST_UNKNOWNS>,
    ) -> Self {
        let [stand_asked, stand_beside] = [asked, beside.len()].map(|some| all as f64 / some.max(1) as f64);
        let mut squares = [[[0.0; ENTRIES]; ENTRIES]; 2];
        for rows in beside {
            for p in 0..ENTRIES {
                for q in 0..ENTRIES {
                    squares[0][p][q] += stand_beside * rows.distance[p] * rows.distance[q];
                    squares[1][p][q] += stand_beside * rows.normal.iter().map(|row| row[p] * row[q]).sum::<f64>();
                }
            }
        }
        let of = |sort: usize| {
            let squares = squares[sort];
            RowsOfASort { count: (sort + 1) as f64 * all as f64, squares, taken: before(covariance, &squares) }
        };
        VarianceEstimate {
            tuning,
            covariance,
            sorts: [0, 1].map(of),
            stands: stand_asked * stand_beside,
            beside: stand_beside,
            twice: 1.0 + asked as f64 / all as f64,
        }
    }

    /// The components of the rows that a kernel is of; `None` where chance explains them, or the unknowns take most of what tells of them.
    fn components(&self, kernel: &KernelProducts) -> Option<ErrorComponents> {
        let once = kernel.once.map(|row| row.map(|value| self.stands * value));
        let taken = before(self.covariance, &once);
        let twice = trace(&before(self.covariance, &kernel.twice)) * self.stands * self.beside;
        let square = self.stands * kernel.square;
        // tr(K M K M)
        let told = square - 2.0 * twice + trace_of_product(&taken, &taken);
        let [distances, normals] = &self.sorts;
        let (own, others) = match kernel.law {
            CovarianceLaw::Distances => (Some(distances), Some(normals)),
            CovarianceLaw::Normals => (Some(normals), Some(distances)),
            CovarianceLaw::Ahead => (None, None),
        };
        let (single, info, together) = match own {
            Some(own) => {
                let other = |products| others.map_or(0.0, |other| trace_of_product(products, &other.taken));
                let of_own = trace_of_product(&own.taken, &own.taken);
                // tr(I M I M), tr(I M K M), and what is left of e'e and e'Ke where the rows of the other sort err by their noise alone
                let both = own.count - 2.0 * trace(&own.taken) + of_own;
                let mixed = trace_of_product(&own.taken, &taken) - 2.0 * trace(&taken);
                let left = own.squares[RESIDUAL][RESIDUAL] - other(&own.taken);
                let left_together = once[RESIDUAL][RESIDUAL] - other(&taken);
                let info = told - mixed * mixed / both;
                (Some((left / both, mixed / both)), info, left_together - mixed / both * left)
            }
            None => (None, told, once[RESIDUAL][RESIDUAL] + trace(&taken)),
        };
        let shared = together / info;
        let clear = shared.abs() * (info / (self.stands * self.twice)).sqrt();
        let is_told = info > (1.0 - self.tuning.shared_taken) * square && clear > self.tuning.shared_clear;
        let single = single.map_or(0.0, |(alone, mixed)| alone - mixed * shared);
        (is_told && (kernel.law == CovarianceLaw::Ahead || shared > 0.0)).then_some(ErrorComponents {
            single,
            shared,
            gain: shared * together,
        })
    }
}

/// C times the products of rows by the unknowns.
fn before(covariance: &Square<MOST_UNKNOWNS>, products: &RowProducts) -> Square<MOST_UNKNOWNS> {
    covariance.map(|row| std::array::from_fn(|q| (0..MOST_UNKNOWNS).map(|k| row[k] * products[k][q]).sum()))
}

fn trace(matrix: &Square<MOST_UNKNOWNS>) -> f64 {
    (0..MOST_UNKNOWNS).map(|k| matrix[k][k]).sum()
}

fn trace_of_product(a: &Square<MOST_UNKNOWNS>, b: &Square<MOST_UNKNOWNS>) -> f64 {
    (0..MOST_UNKNOWNS).map(|p| (0..MOST_UNKNOWNS).map(|q| a[p][q] * b[q][p]).sum::<f64>()).sum()
}

/// About so many of these contacts, each as likely as any other: those that lie evenly have no near neighbours among them.
fn drawn_among(inner: &[u32], about: usize) -> Vec<usize> {
    let (draws, share) = (EffectDraws::new(0, "shared errors"), about as f64 / inner.len() as f64);
    let is_drawn = |k: usize| {
        let mut at = [0.0];
        draws.uniforms(k as u64, 0, 1, &mut at);
        at[0] < share
    };
    inner.iter().enumerate().filter(|(k, _)| share >= 1.0 || is_drawn(*k)).map(|(_, i)| *i as usize).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parts::hypothesis::{descended, extent};
    use crate::parts::local::Noise;
    use crate::primitives::descent::Sample;
    use crate::primitives::placed::PartKind;

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
        let tuning = PartsTuning::default();
        let found = descended(PartKind::Plane, &sample, &[], extent(&cloud.points), &tuning).unwrap();
        let fit = Weighted { primitive: &found.primitive, noise: &noise, tuning: &tuning };
        let inner: Vec<u32> = (0..625).collect();
        let independent = found.covariance().unwrap();
        with_shared_errors(&cloud, &inner, &fit, &independent)[2][2] / independent[2][2]
    }

    #[test]
    fn contacts_that_are_drawn_have_each_other_for_neighbours_as_often_as_all_have() {
        let inner: Vec<u32> = (0..10_000).collect();
        let drawn = drawn_among(&inner, 2500);
        let side_by_side = drawn.windows(2).filter(|pair| pair[1] == pair[0] + 1).count();
        assert!(drawn.len().abs_diff(2500) < 150 && side_by_side.abs_diff(625) < 100, "{} {side_by_side}", drawn.len());
        assert_eq!(drawn_among(&inner, 10_000).len(), 10_000);
    }

    /// Of 25 squares the mean is known as of 25 contacts; an exponential through their steps finds most of that.
    #[test]
    fn errors_of_squares_leave_a_mean_as_unsure_as_few_contacts() {
        let [own, shared] = [of_plane(1), of_plane(5)];
        assert!(own < 1.5, "{own}");
        assert!((8.0..60.0).contains(&shared), "{shared}");
    }
}
