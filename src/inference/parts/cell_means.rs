//! Contacts in cells of neighbours, and what a description leaves over in each: means over the cell, and the rest.
//!
//! ```text
//! residuals of a contact     its distance and its normal's lean along two tangents of the cell, each over its standard deviation
//! means                      of each over the contacts of a cell
//! within                     sum of (residual - mean of its cell)^2, of all three sorts
//! ```
//!
//! Errors that neighbours share are those of the means. Cells are as many as their covariance can be factored for at once.

use faer::Mat;

use super::cloud::Cloud;
use super::local::Noise;
use crate::primitives::placed::Primitive;
use palpate_numeric::statistics::upper_median;
use palpate_numeric::vector::{Vector, along, axes_along, dot, minus, norm};

/// Cells at most: a wave of errors that is one cell wide or less is not seen to be shared.
const CELLS: usize = 128;

/// Residuals of a contact: its distance, and the lean of its normal along two tangents.
pub(super) const RESIDUALS: usize = 3;

/// Contacts in cells.
pub(super) struct NeighbourCells {
    pub(super) members: Vec<u32>,
    of: Vec<u32>,
    pub(super) counts: Vec<f64>,
    pub(super) centres: Vec<Vector>,
    pub(super) tangents: Vec<[Vector; 2]>,
    /// Distance between centres next to each other.
    pub(super) apart: f64,
}

/// What a description leaves over.
pub(super) struct CellMeans {
    /// Distances of all cells, then their leans along the first tangents, then those along the second.
    pub(super) means: Mat<f64>,
    pub(super) within: f64,
}

impl NeighbourCells {
    pub(super) fn new(cloud: &Cloud, members: Vec<u32>) -> NeighbourCells {
        let mut of = vec![0; members.len()];
        let points: Vec<Vector> = members.iter().map(|i| cloud.points[*i as usize]).collect();
        let mut all: Vec<u32> = (0..members.len() as u32).collect();
        let (mut counts, mut centres, mut tangents) = (Vec::new(), Vec::new(), Vec::new());
        halved(&points, &mut all, members.len().div_ceil(CELLS).max(1), &mut |cell| {
            cell.iter().for_each(|k| of[*k as usize] = centres.len() as u32);
            let share = 1.0 / cell.len() as f64;
            centres.push(cell.iter().fold([0.0; 3], |sum, k| along(sum, share, points[*k as usize])));
            let normal = |k: &u32| cloud.normals[members[*k as usize] as usize];
            let [u, v, _] = axes_along(cell.iter().fold([0.0; 3], |sum, k| along(sum, share, normal(k))));
            tangents.push([u, v]);
            counts.push(cell.len() as f64);
        });
        let apart = apart(&centres);
        NeighbourCells { members, of, counts, centres, tangents, apart }
    }

    /// What primitives leave over, each of so many of the contacts, in their order.
    pub(super) fn means(&self, cloud: &Cloud, told: &[(Primitive, usize)], sd: &Noise) -> CellMeans {
        let of_each = told.iter().flat_map(|(primitive, count)| std::iter::repeat_n(primitive, *count));
        let residuals: Vec<[f64; RESIDUALS]> =
            of_each.enumerate().map(|(k, primitive)| self.residuals(cloud, k, primitive, sd)).collect();
        let cells = self.counts.len();
        let mut means = Mat::<f64>::zeros(RESIDUALS * cells, 1);
        for (residuals, cell) in residuals.iter().zip(&self.of) {
            let cell = *cell as usize;
            (0..RESIDUALS).for_each(|sort| means[(sort * cells + cell, 0)] += residuals[sort] / self.counts[cell]);
        }
        let off = |(residuals, cell): (&[f64; RESIDUALS], &u32)| -> f64 {
            let of_sort = |sort: usize| residuals[sort] - means[(sort * cells + *cell as usize, 0)];
            (0..RESIDUALS).map(of_sort).map(|off| off * off).sum()
        };
        let within = residuals.iter().zip(&self.of).map(off).sum();
        CellMeans { means, within }
    }

    fn residuals(&self, cloud: &Cloud, k: usize, primitive: &Primitive, sd: &Noise) -> [f64; RESIDUALS] {
        let i = self.members[k] as usize;
        let (distance, normal) = primitive.nearest(cloud.points[i]);
        let lean = minus(normal, cloud.normals[i]);
        let [u, v] = self.tangents[self.of[k] as usize];
        [distance / sd.distance, dot(lean, u) / sd.normal, dot(lean, v) / sd.normal]
    }
}

/// Median distance from a centre to the next one.
fn apart(centres: &[Vector]) -> f64 {
    let nearest = |i: usize| {
        let others = (0..centres.len()).filter(|j| *j != i);
        others.map(|j| norm(minus(centres[i], centres[j]))).fold(f64::INFINITY, f64::min)
    };
    upper_median((0..centres.len()).map(nearest).collect::<Vec<f64>>()).unwrap_or(0.0)
}

/// Halves contacts across their longest side until a cell holds so many at most.
fn halved(points: &[Vector], members: &mut [u32], most: usize, take: &mut impl FnMut(&[u32])) {
    if members.len() <= most {
        return take(members);
    }
    let extent = |axis: usize| {
        let values = members.iter().map(|i| points[*i as usize][axis]);
        let (lo, hi) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
        hi - lo
    };
    let axis = (0..3).max_by(|a, b| extent(*a).total_cmp(&extent(*b))).unwrap_or(0);
    let half = members.len() / 2;
    let order = |a: &u32, b: &u32| points[*a as usize][axis].total_cmp(&points[*b as usize][axis]).then(a.cmp(b));
    members.select_nth_unstable_by(half, order);
    let (low, high) = members.split_at_mut(half);
    halved(points, low, most, take);
    halved(points, high, most, take);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::primitives::placed::PartKind;
    use palpate_numeric::draws::Lcg;

    /// Squares about the means and those of the means are the squares of all residuals, and every contact is in a cell.
    #[test]
    fn squares_are_those_within_cells_and_those_of_their_means() {
        let mut generator = Lcg::new(5);
        let points: Vec<Vector> = (0..730).map(|_| [9.0, 4.0, 1.0].map(|side| side * generator.uniform())).collect();
        let cloud = Cloud::new(&points, vec![[0.0, 0.6, 0.8]; points.len()]).unwrap();
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let plane = Primitive { kind: PartKind::Plane, origin: [0.0; 3], axes, sizes: [0.0; 3], side: 1.0 };
        let cells = NeighbourCells::new(&cloud, (0..points.len() as u32).collect());
        assert!(cells.counts.len() <= CELLS && cells.counts.iter().sum::<f64>() == 730.0);
        let sd = Noise { distance: 0.3, normal: 0.7 };
        let left = cells.means(&cloud, &[(plane, 400), (plane, 330)], &sd);
        let count = cells.counts.len();
        let of_means: f64 =
            (0..RESIDUALS * count).map(|row| cells.counts[row % count] * left.means[(row, 0)].powi(2)).sum();
        // normals lean by (0, -0.6, 0.2), of which the tangents hold what is not along the normals themselves
        let of_normal = (0.36 + 0.04 - 0.2_f64.powi(2)) / 0.49;
        let expected: f64 = cloud.points.iter().map(|p| (p[2] / 0.3).powi(2) + of_normal).sum();
        assert!((left.within + of_means - expected).abs() < 1e-9 * expected, "{} {of_means} {expected}", left.within);
    }
}
