//! What the residuals of contacts near each other say of the errors that they share, for several covariance functions at once.
//!
//! ```text
//! once   = sum_ij k(r_ij) a_i a_j'      twice = sum_i (sum_j k(r_ij) a_j) (sum_j k(r_ij) a_j)'      square = sum_ij k(r_ij)^2
//! a      a weighted row by all unknowns, its residual behind them
//! ```
//!
//! The rows of a contact's neighbours are summed by their distance once, in rings so narrow that k is the same in each, and every
//! covariance function is then a sum over rings.

use super::cloud::Cloud;
use super::local::Noise;
use super::tuning::PartsTuning;
use crate::primitives::normal_equations::rows;
use crate::primitives::placed::{MOST_UNKNOWNS, Primitive};
use palpate_numeric::vector::{dot, minus, norm};

/// A primitive with the noise that its rows are weighted by.
pub(super) struct Weighted<'a> {
    pub(super) primitive: &'a Primitive,
    pub(super) noise: &'a Noise,
    pub(super) tuning: &'a PartsTuning,
}

/// Unknowns, and the residual behind them.
pub(super) const ENTRIES: usize = MOST_UNKNOWNS + 1;

/// Where a row has its residual.
pub(super) const RESIDUAL: usize = MOST_UNKNOWNS;

/// A weighted row.
pub(super) type AugmentedRow = [f64; ENTRIES];

/// Sums of products of rows.
pub(super) type RowProducts = [[f64; ENTRIES]; ENTRIES];

/// Rings to a factor of e: within one, r changes by a seventh.
const RINGS: f64 = 7.0;

/// The least distance, in spacings, that has a ring of its own.
const NEAREST_RING: f64 = 0.1;

/// Ranges beyond which a covariance is none.
pub(super) const RANGES: f64 = 4.0;

/// How a covariance falls with the distance over its range, and between which rows.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum CovarianceLaw {
    /// Of distances: exp(-r).
    Distances,
    /// Of normals: exp(-r).
    Normals,
    /// Of a distance and the lean of a normal farther on, r exp(-r): where normals follow the surface that errors displaced, they lean along it.
    Ahead,
}

impl CovarianceLaw {
    pub(super) const ALL: [CovarianceLaw; 3] = [CovarianceLaw::Distances, CovarianceLaw::Normals, CovarianceLaw::Ahead];

    fn at(self, r: f64) -> f64 {
        match self {
            _ if r >= RANGES => 0.0,
            CovarianceLaw::Distances | CovarianceLaw::Normals => (-r).exp(),
            CovarianceLaw::Ahead => r * (-r).exp(),
        }
    }

    /// Products of errors in a pair of contacts: a normal has two components across it, and a distance goes with the lean of the other.
    fn products(self) -> f64 {
        if self == CovarianceLaw::Distances { 1.0 } else { 2.0 }
    }
}

/// A covariance function with what its pairs say.
pub(super) struct KernelProducts {
    pub(super) law: CovarianceLaw,
    pub(super) once: RowProducts,
    pub(super) twice: RowProducts,
    pub(super) square: f64,
}

/// Rows of one contact, or sums of such rows: of its distance and of its normal.
#[derive(Clone, Copy)]
pub(super) struct SummedRows {
    pub(super) distance: AugmentedRow,
    pub(super) normal: [AugmentedRow; 3],
}

impl SummedRows {
    const NONE: SummedRows = SummedRows { distance: [0.0; ENTRIES], normal: [[0.0; ENTRIES]; 3] };

    /// Of a contact at the primitive, over the standard deviations of its noise.
    pub(super) fn new(cloud: &Cloud, i: usize, fit: &Weighted) -> Self {
        let [distance, normal @ ..] = rows(fit.primitive, cloud.points[i], cloud.normals[i]);
        let weighted = |(residual, by): (f64, [f64; MOST_UNKNOWNS]), sd: f64| {
            let mut row = [0.0; ENTRIES];
            fit.primitive.kind.free().iter().for_each(|k| row[*k] = by[*k] / sd);
            row[RESIDUAL] = residual / sd;
            row
        };
        SummedRows {
            distance: weighted(distance, fit.noise.distance),
            normal: normal.map(|row| weighted(row, fit.noise.normal)),
        }
    }
}

/// Neighbours at about the same distance.
#[derive(Clone, Copy)]
struct DistanceRing {
    count: f64,
    alike: SummedRows,
    /// Of a distance here the normals there along the step, of a normal here the distances there.
    ahead: SummedRows,
}

/// The sums for every law and range of the contacts `asked` with those `beside` them, whose rows these are.
pub(super) fn kernel_products(
    cloud: &Cloud,
    asked: &[usize],
    (beside, rows): (&[usize], &[SummedRows]),
    fit: &Weighted,
) -> Vec<KernelProducts> {
    let ranges = fit.tuning.shared_ranges.map(|range| range * cloud.spacing);
    let widest = RANGES * ranges.iter().fold(0.0_f64, |most, range| range.max(most));
    let nearest = NEAREST_RING * cloud.spacing;
    let ring = |r: f64| (RINGS * (r / nearest).ln()).max(0.0) as usize;
    let middle = |ring: usize| nearest * ((ring as f64 + 0.5) / RINGS).exp();
    let laws =
        CovarianceLaw::ALL.into_iter().filter(|law| *law == CovarianceLaw::Distances || fit.noise.normal.is_finite());
    let kernels: Vec<(CovarianceLaw, f64)> = laws.flat_map(|law| ranges.map(|range| (law, range))).collect();
    let empty = |(law, _): &(CovarianceLaw, f64)| KernelProducts {
        law: *law,
        once: [[0.0; ENTRIES]; ENTRIES],
        twice: [[0.0; ENTRIES]; ENTRIES],
        square: 0.0,
    };
    let mut sums: Vec<KernelProducts> = kernels.iter().map(empty).collect();
    let mut rings =
        vec![DistanceRing { count: 0.0, alike: SummedRows::NONE, ahead: SummedRows::NONE }; ring(widest) + 1];
    for &one in asked {
        rings.fill(DistanceRing { count: 0.0, alike: SummedRows::NONE, ahead: SummedRows::NONE });
        for (&other, rows) in beside.iter().zip(rows).filter(|(other, _)| **other != one) {
            let step = minus(cloud.points[other], cloud.points[one]);
            let apart = norm(step);
            if apart > 0.0 && apart < widest {
                let towards = fit.primitive.axes.map(|axis| dot(axis, step) / apart);
                rings[ring(apart)].add(rows, towards);
            }
        }
        let own = SummedRows::new(cloud, one, fit);
        for ((law, range), sums) in kernels.iter().zip(&mut sums) {
            sums.add(&own, &rings, |ring| law.at(middle(ring) / range));
        }
    }
    sums
}

impl DistanceRing {
    fn add(&mut self, rows: &SummedRows, towards: [f64; 3]) {
        self.count += 1.0;
        // entries innermost, so that several are summed at once
        (0..ENTRIES).for_each(|e| self.alike.distance[e] += rows.distance[e]);
        for (t, along) in towards.into_iter().enumerate() {
            for e in 0..ENTRIES {
                self.alike.normal[t][e] += rows.normal[t][e];
                self.ahead.distance[e] += along * rows.normal[t][e];
                self.ahead.normal[t][e] -= along * rows.distance[e];
            }
        }
    }
}

impl KernelProducts {
    fn add(&mut self, own: &SummedRows, rings: &[DistanceRing], kernel: impl Fn(usize) -> f64) {
        let mut around = SummedRows::NONE;
        for (number, ring) in rings.iter().enumerate().filter(|(_, ring)| ring.count > 0.0) {
            let k = kernel(number);
            self.square += self.law.products() * ring.count * k * k;
            let rows = if self.law == CovarianceLaw::Ahead { &ring.ahead } else { &ring.alike };
            (0..ENTRIES).for_each(|e| around.distance[e] += k * rows.distance[e]);
            for t in 0..3 {
                (0..ENTRIES).for_each(|e| around.normal[t][e] += k * rows.normal[t][e]);
            }
        }
        if self.law != CovarianceLaw::Normals {
            self.add_row(&own.distance, &around.distance);
        }
        if self.law != CovarianceLaw::Distances {
            (0..3).for_each(|t| self.add_row(&own.normal[t], &around.normal[t]));
        }
    }

    fn add_row(&mut self, own: &AugmentedRow, around: &AugmentedRow) {
        for p in 0..ENTRIES {
            for q in 0..ENTRIES {
                self.once[p][q] += 0.5 * (own[p] * around[q] + around[p] * own[q]);
                self.twice[p][q] += around[p] * around[q];
            }
        }
    }
}
