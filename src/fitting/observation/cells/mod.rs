//! The normal equations of scattered contacts, cell by cell, from moments.
//!
//! ```text
//! on a cell, with u, v in [-1, 1]:   N_a N_k = sum_i P_ak,i u^i     M_b M_l = sum_j Q_bl,j v^j     (degrees 2p, 2q)
//! A_(ab)(kl) = sum_t sum_ij  X_t,ak,i  G_t,ij  Y_t,bl,j       G_t,ij = sum_r w_t,r u_r^i v_r^j
//!     t: values  wz^2  (N N, M M);   slopes  a^2 (N'N', M M),  a b (N'N, M M') + (N N', M'M),  b^2 + d^2 (N N, M'M')
//! ```
//!
//! A stable counting sort copies the contacts into stripes of one x segment each; within a stripe only their numbers are
//! sorted into cells, so each contact is copied once. Stripes are summed in a fixed number of panels whose overlaps are
//! added in order, so the bits do not depend on the number of threads.

mod packed;
mod sorting;
mod sums;
mod tables;
mod target;

use std::sync::Mutex;

pub use packed::{PackedCells, PackedRows};
use palpate_numeric::bspline::Knots;
use palpate_numeric::linalg::{RowWeights, StencilMatrix, TensorShape};
use palpate_numeric::simd::MAX_MOMENT_DEGREE;
use palpate_numeric::work;
use sorting::Stripes;
use sums::Scratch;
use tables::{Axis, AxisTables, XTables, YTables, squares_of};
use target::Overlap;

/// Number of panels into which the stripes are divided: enough for the threads of a desktop, and few enough that their
/// overlaps are a small part of the matrix.
const PANELS: usize = 8;
/// Numbers of a contact's record: x, y and the three loads, and, if weights differ, the four squares of its row weights.
const UNIFORM: usize = 5;
const WEIGHTED: usize = 9;

/// Contacts as the assembly reads them: their positions and loads.
///
/// This is a trait and not a pair of closures because a method that is always inlined writes a record directly. Through the
/// stack it would cost a failed store-to-load forwarding, which is more than all other work for a contact.
pub trait CellRows: Sync {
    /// Number of contacts.
    fn len(&self) -> usize;
    /// No contacts at all.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// x and y of contact r, in the coordinates of the knots.
    fn at(&self, r: usize) -> [f64; 2];
    /// `E'b`'s multipliers of `N M`, `N'M`, `N M'`: `wz b_z`, `a b_1`, `b b_1 + d b_2`.
    fn loads(&self, r: usize) -> [f64; 3];
}

/// Reusable buffers and tables for all contacts under one pair of knot vectors.
#[derive(Debug)]
pub struct CellAssembly {
    shape: TensorShape,
    x: Axis<XTables>,
    y: Axis<YTables>,
    knots: [Knots; 2],
    stripes: Stripes,
    overlaps: Vec<Overlap>,
    /// First stripe of every panel, and the number of stripes at the end.
    panels: Vec<usize>,
    scratch: Mutex<Vec<Box<Scratch>>>,
}

impl Clone for CellAssembly {
    /// The same tables; the clone makes buffers of its own as it needs them.
    fn clone(&self) -> CellAssembly {
        CellAssembly {
            shape: self.shape,
            x: self.x.clone(),
            y: self.y.clone(),
            knots: self.knots.clone(),
            stripes: self.stripes.clone(),
            overlaps: self.overlaps.clone(),
            panels: self.panels.clone(),
            scratch: Mutex::default(),
        }
    }
}

impl CellAssembly {
    /// Tables for these knots; `None` if a degree is above [`MAX_MOMENT_DEGREE`]; then the equations are summed over rows.
    pub(crate) fn new(knots: [Knots; 2]) -> Option<CellAssembly> {
        if knots.iter().any(|k| k.degree() > MAX_MOMENT_DEGREE) {
            return None;
        }
        let shape = TensorShape {
            basis: [knots[0].n_basis(), knots[1].n_basis()],
            degree: [knots[0].degree(), knots[1].degree()],
        };
        let [x, y] = [AxisTables::new(&knots[0]), AxisTables::new(&knots[1])];
        let x_products = (0..knots[0].n_segments()).map(|s| XTables::of(&x, s)).collect();
        let y_products = (0..knots[1].n_segments()).map(|s| YTables::of(&y, s)).collect();
        let stripes = knots[0].n_segments();
        let count = PANELS.min(stripes);
        let panels = (0..=count).map(|k| k * stripes / count).collect();
        let lines = shape.degree[0];
        let overlaps = (0..count)
            .map(|_| Overlap {
                values: vec![0.0; lines * shape.basis[1] * shape.stencil_width()],
                right: vec![0.0; lines * shape.basis[1]],
            })
            .collect();
        Some(CellAssembly {
            shape,
            x: Axis { basis: x, products: x_products },
            y: Axis { basis: y, products: y_products },
            knots,
            stripes: Stripes::default(),
            overlaps,
            panels,
            scratch: Mutex::new(Vec::new()),
        })
    }

    /// Counts the normal matrix and the right-hand side of so many contacts.
    fn count(&self, contacts: usize) {
        work::add(3 * contacts * (self.shape.local() + 3) * self.shape.local() / 2);
    }

    /// Shape of the spline.
    pub(crate) fn shape(&self) -> TensorShape {
        self.shape
    }

    /// `matrix = E'E` and `right = E'b`. Coordinates outside the domain use the end cells.
    #[cfg(test)]
    pub(crate) fn assemble(
        &mut self,
        row_weights: &RowWeights,
        rows: &impl CellRows,
        matrix: &mut StencilMatrix,
        right: &mut [f64],
    ) {
        matrix.clear();
        right.fill(0.0);
        self.add(row_weights, rows, matrix, right);
    }

    /// `matrix += E'E` and `right += E'b`, for contacts that arrive in pieces and are not kept.
    pub(crate) fn add(
        &mut self,
        row_weights: &RowWeights,
        rows: &impl CellRows,
        matrix: &mut StencilMatrix,
        right: &mut [f64],
    ) {
        self.count(rows.len());
        let abscissa = |r: usize| rows.at(r)[0];
        match row_weights {
            RowWeights::Uniform(m) if self.knots.iter().all(|k| k.n_segments() == 1) => {
                self.sum_one_cell(rows, squares_of(*m), matrix, right);
            }
            RowWeights::Uniform(m) => {
                self.stripes.sort::<UNIFORM>(&self.knots[0], rows.len(), abscissa, |r, record| {
                    let ([x, y], [z, zx, zy]) = (rows.at(r), rows.loads(r));
                    record.copy_from_slice(&[x, y, z, zx, zy]);
                });
                let squares = Some(squares_of(*m));
                self.sum_panels(matrix, right, &|own, stripe, scratch, target| {
                    own.one_stripe::<UNIFORM>(stripe, squares, scratch, target);
                });
            }
            RowWeights::PerSite(site_weights) => {
                self.stripes.sort::<WEIGHTED>(&self.knots[0], rows.len(), abscissa, |r, record| {
                    let ([x, y], [z, zx, zy]) = (rows.at(r), rows.loads(r));
                    let [zz, aa, ab, dd] = squares_of(site_weights[r]);
                    record.copy_from_slice(&[x, y, z, zx, zy, zz, aa, ab, dd]);
                });
                self.sum_panels(matrix, right, &|own, stripe, scratch, target| {
                    own.one_stripe::<WEIGHTED>(stripe, None, scratch, target);
                });
            }
        }
    }
}

impl CellAssembly {
    /// `matrix += E'E` of packed cells, with the same bits as [`CellAssembly::add`].
    pub(crate) fn add_packed(&mut self, row_weights: &RowWeights, packed: &PackedCells, matrix: &mut StencilMatrix) {
        self.count(packed.len());
        let mut nothing = vec![0.0; matrix.order()];
        self.sum_panels(matrix, &mut nothing, &|own, stripe, scratch, target| {
            own.packed_stripe(stripe, row_weights, packed, scratch, target);
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observation::ScatteredSites;
    use palpate_numeric::linalg::{SiteWeights, assemble, normal_rhs};

    struct Given {
        points: Vec<[f64; 2]>,
        loads: Vec<[f64; 3]>,
    }

    impl CellRows for Given {
        fn len(&self) -> usize {
            self.points.len()
        }
        fn at(&self, r: usize) -> [f64; 2] {
            self.points[r]
        }
        fn loads(&self, r: usize) -> [f64; 3] {
            self.loads[r]
        }
    }

    fn points(count: usize) -> Vec<[f64; 2]> {
        (0..count)
            .map(|r| [(r as f64 * 0.754_877_666).fract(), (r as f64 * 0.569_840_291).fract() * 2.0 - 1.0])
            .collect()
    }

    fn check(
        degree: [usize; 2],
        segments: [usize; 2],
        count: usize,
        row_weights: impl Fn(usize) -> SiteWeights,
        uniform: bool,
    ) {
        let knots = [
            Knots::uniform(degree[0], segments[0], 0.0, 1.0).unwrap(),
            Knots::uniform(degree[1], segments[1], -1.0, 1.0).unwrap(),
        ];
        let points = points(count);
        let rows: Vec<[f64; 3]> = (0..count).map(|r| [1.0, 2.0, 3.0].map(|k| (k * r as f64).sin())).collect();
        let sites = ScatteredSites::new(knots.clone(), points.clone());
        let site_weights = if uniform {
            RowWeights::Uniform(row_weights(0))
        } else {
            RowWeights::PerSite((0..count).map(&row_weights).collect())
        };
        let mut cells = CellAssembly::new(knots).unwrap();
        let shape = cells.shape();
        let mut expected = StencilMatrix::zeros(shape);
        assemble(&sites, &site_weights, &mut expected);
        let mut expected_right = vec![0.0; shape.unknowns()];
        normal_rhs(&sites, &site_weights, &rows, &mut expected_right);
        let loads = (0..count).map(|r| {
            let (m, b) = (site_weights.at(r), rows[r]);
            [m.z * b[0], m.a * b[1], m.b * b[1] + m.d * b[2]]
        });
        let given = Given { points, loads: loads.collect() };
        let (mut matrix, mut right) = (StencilMatrix::zeros(shape), vec![1.0; shape.unknowns()]);
        for _ in 0..2 {
            cells.assemble(&site_weights, &given, &mut matrix, &mut right);
        }
        let mut again = StencilMatrix::zeros(shape);
        if let Some(packed) = sites.packed_cells() {
            cells.add_packed(&site_weights, packed, &mut again);
            assert!(again == matrix, "contacts that are in their cells already: other bits");
        }
        let diagonal = expected.diagonal();
        let mut worst = 0.0_f64;
        expected.for_each_lower(|i, j, at| {
            let size = (diagonal[i] * diagonal[j]).sqrt().max(1e-300);
            worst = worst.max((matrix.values()[at] - expected.values()[at]).abs() / size);
        });
        let largest = expected_right.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        let worst_right = right.iter().zip(&expected_right).map(|(a, b)| (a - b).abs() / largest).fold(0.0, f64::max);
        println!(
            "degree {degree:?} contacts {count}: matrix {worst:.1e} of its diagonal, right side {worst_right:.1e}"
        );
        // measured 2e-15: centred powers up to the sixth cost a few roundings
        assert!(worst < 1e-14 && worst_right < 1e-14, "{worst:e} {worst_right:e}");
    }

    #[test]
    fn moments_and_rows_give_the_same_equations() {
        for (degree, segments) in
            [([3, 3], [5, 4]), ([2, 2], [1, 1]), ([2, 3], [12, 3]), ([1, 2], [3, 9]), ([3, 1], [9, 2])]
        {
            check(degree, segments, 3000, |_| SiteWeights { z: 2.0, a: 0.5, b: 0.0, d: 0.7 }, true);
            check(degree, segments, 700, |_| SiteWeights { z: 1.0, a: 0.5, b: -0.3, d: 0.7 }, true);
            let varied = |r: usize| {
                let w = 1.0 + 0.5 * (r as f64).sin();
                SiteWeights { z: w, a: 0.5 * w, b: 0.2 * (r as f64).cos(), d: 2.0 - w }
            };
            check(degree, segments, 700, varied, false);
        }
    }

    #[test]
    fn one_and_two_threads_give_the_same_bits() {
        let knots = [Knots::uniform(3, 17, 0.0, 1.0).unwrap(), Knots::uniform(3, 9, -1.0, 1.0).unwrap()];
        let points = points(70_000);
        let run = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let mut cells = CellAssembly::new(knots.clone()).unwrap();
            let mut matrix = StencilMatrix::zeros(cells.shape());
            let mut right = vec![0.0; matrix.order()];
            let row_weights = RowWeights::Uniform(SiteWeights { z: 1.0, a: 1.0, b: 0.0, d: 1.0 });
            let loads = points.iter().map(|p| [p[0].sin(), p[1].sin(), 1.0]).collect();
            let given = Given { points: points.clone(), loads };
            pool.install(|| cells.assemble(&row_weights, &given, &mut matrix, &mut right));
            (matrix, right)
        };
        assert!(run(1) == run(2));
    }
}
