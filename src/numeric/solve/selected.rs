//! `tr A^-1 B` for a matrix B of A's own pattern, from the entries of the inverse within the band, and these from the factor
//! (K. Takahashi, J. Fagan, M.-S. Chen, *8th PICA Conf.* (1973) 63; by block columns J with R the rows below them).
//!
//! ```text
//! A = L L'     M = L_RJ L_JJ^-1     Z_RJ = -Z_RR M     Z_JJ = L_JJ^-T L_JJ^-1 - M' Z_RJ     Z = A^-1 within the band
//! tr A^-1 B = sum_ij Z_ij B_ij
//! ```
//!
//! Columns are taken backwards, from the middle to both ends. Only `Z_RR`, a square as wide as the band, is stored, as a ring
//! of rows and columns in which J replaces the unknowns that are no longer needed. The work is n w^2 multiply-adds, twice
//! that of the factorisation.

use super::band::{BandCholesky, Part, WIDTH};
use super::numbering::Numbering;
use crate::linalg::StencilMatrix;
use crate::simd::{BlockShape, GRAIN, Isa, Panels, ProductSize, subtract_product};

/// Rows of a panel.
const PANEL: usize = 8;
/// Size of a block column in the ring, in grains.
const GRAINS: usize = WIDTH / GRAIN;

/// Position of an entry in a matrix with `stride` columns, stored in panels.
#[inline(always)]
fn place(stride: usize, row: usize, column: usize) -> usize {
    (row / PANEL * stride + column) * PANEL + row % PANEL
}

/// `Z_RR`: entries of the inverse among the unknowns within reach of the remaining block columns.
struct Ring {
    /// Places, in grains: grain g of the unknowns stands at `g % grains`.
    grains: usize,
    /// All places belong to one grain each, so that those not yet filled are at the front.
    whole: bool,
    values: Vec<f64>,
    /// M' and `Z_JR`, 48 rows each.
    multipliers: Vec<f64>,
    rows: Vec<f64>,
    corner: Corner,
}

/// Matrices of J alone, 48 x 48 each.
struct Corner {
    /// `L_JJ^-T` and its negative.
    inverse: Vec<f64>,
    negative: Vec<f64>,
    /// `Z_JJ`.
    own: Vec<f64>,
}

impl Corner {
    /// Computes `L_JJ^-1` by forward substitution, row by row, and stores its transpose.
    fn invert(&mut self, shape: BlockShape, columns: &[f64]) {
        let mut rows = [[0.0; WIDTH]; WIDTH];
        for i in 0..WIDTH {
            let (done, rest) = rows.split_at_mut(i);
            let row = &mut rest[0];
            for (k, above) in done.iter().enumerate() {
                let factor = columns[shape.place(i, k)];
                row[..=k].iter_mut().zip(above).for_each(|(r, a)| *r -= factor * a);
            }
            row[i] = 1.0;
            let pivot = 1.0 / columns[shape.place(i, i)];
            row[..=i].iter_mut().for_each(|r| *r *= pivot);
        }
        for (i, row) in rows.iter().enumerate() {
            for (j, value) in row.iter().enumerate() {
                let at = place(WIDTH, j, i);
                (self.inverse[at], self.negative[at]) = (*value, -value);
            }
        }
    }
}

impl Ring {
    /// An empty ring for `count` block columns of this shape; with `whole` it has room for all of them at once.
    fn new(shape: BlockShape, count: usize, whole: bool) -> Ring {
        let below = shape.height.saturating_sub(WIDTH) / GRAIN;
        let grains = if whole { count * GRAINS } else { below.max(GRAINS) };
        let order = grains * GRAIN;
        let square = || vec![0.0; WIDTH * WIDTH];
        Ring {
            grains,
            whole,
            values: vec![0.0; order * order],
            multipliers: vec![0.0; WIDTH * order],
            rows: vec![0.0; WIDTH * order],
            corner: Corner { inverse: square(), negative: square(), own: square() },
        }
    }

    fn order(&self) -> usize {
        self.grains * GRAIN
    }

    /// Position in the ring of unknown number `k` of the part.
    #[inline(always)]
    fn at(&self, k: usize) -> usize {
        k / GRAIN % self.grains * GRAIN + k % GRAIN
    }

    /// `Z_JR` and `Z_JJ` of block column b, of `count`.
    fn advance(&mut self, isa: Isa, shape: BlockShape, columns: &[f64], b: usize, count: usize) {
        let order = self.order();
        self.corner.invert(shape, columns);
        let Ring { grains, whole, values, multipliers, rows, corner } = self;
        multipliers.fill(0.0);
        rows.fill(0.0);
        let below = shape.height.saturating_sub(WIDTH) / GRAIN;
        let inverse = Panels { values: &corner.negative, stride: WIDTH };
        for g in 0..below.min((count - b - 1) * GRAINS) {
            let to = (GRAINS * (b + 1) + g) % *grains * GRAIN;
            let from = Panels { values: &columns[shape.place(WIDTH + g * GRAIN, 0)..], stride: WIDTH };
            let size = ProductSize { rows: WIDTH, columns: GRAIN, inner: WIDTH };
            subtract_product(isa, [inverse, from], size, &mut multipliers[to * PANEL..], order);
        }
        // a ring for all block columns is filled from block column b + 1 on; any other is used as a whole
        let first = if *whole { (b + 1) * WIDTH } else { 0 };
        let inner = order - first;
        let m = Panels { values: &multipliers[first.min(order - 1) * PANEL..], stride: order };
        if inner > 0 {
            let z = Panels { values: &values[place(order, first, first)..], stride: order };
            let size = ProductSize { rows: WIDTH, columns: inner, inner };
            subtract_product(isa, [m, z], size, &mut rows[first * PANEL..], order);
        }
        corner.own.fill(0.0);
        let [negative, inverse] = [&corner.negative, &corner.inverse].map(|values| Panels { values, stride: WIDTH });
        let size = ProductSize { rows: WIDTH, columns: WIDTH, inner: WIDTH };
        subtract_product(isa, [negative, inverse], size, &mut corner.own, WIDTH);
        if inner > 0 {
            let z = Panels { values: &rows[first * PANEL..], stride: order };
            let size = ProductSize { rows: WIDTH, columns: WIDTH, inner };
            subtract_product(isa, [z, m], size, &mut corner.own, WIDTH);
        }
    }

    /// Stores block column b in the places of unknowns that are no longer needed.
    fn keep(&mut self, b: usize) {
        let order = self.order();
        let Ring { grains, values, rows, corner, .. } = self;
        for g in 0..GRAINS {
            let at = (GRAINS * b + g) % *grains * GRAIN;
            let (from, to) = (place(order, g * GRAIN, 0), place(order, at, 0));
            values[to..to + GRAIN * order].copy_from_slice(&rows[from..from + GRAIN * order]);
            for (panel, target) in values.chunks_exact_mut(order * PANEL).enumerate() {
                for j in 0..GRAIN {
                    let start = place(order, g * GRAIN + j, panel * PANEL);
                    let line = &mut target[(at + j) * PANEL..][..PANEL];
                    for (value, row) in line.iter_mut().zip(rows[start..].iter().step_by(PANEL)) {
                        *value = *row;
                    }
                }
            }
        }
        let stand: [usize; WIDTH] = std::array::from_fn(|k| (GRAINS * b + k / GRAIN) % *grains * GRAIN + k % GRAIN);
        for i in 0..WIDTH {
            for j in 0..WIDTH {
                values[place(order, stand[i], stand[j])] = corner.own[place(WIDTH, i, j)];
            }
        }
    }

    /// `sum Z_ij B_ij` over block column b and the rows below it, entries off the diagonal counted twice.
    fn products(&self, b: usize, unknowns: usize, column: impl Fn(usize, &mut dyn FnMut(usize, f64))) -> f64 {
        let mut sum = 0.0;
        let below = unknowns - b * WIDTH;
        for c in 0..WIDTH.min(below) {
            column(b * WIDTH + c, &mut |offset, value| {
                let row = c + offset;
                if row >= below {
                    return;
                }
                let z = if row < WIDTH {
                    self.corner.own[place(WIDTH, row, c)]
                } else {
                    self.rows[place(self.order(), c, self.at(b * WIDTH + row))]
                };
                sum += if offset == 0 { z * value } else { 2.0 * z * value };
            });
        }
        sum
    }
}

impl BandCholesky {
    /// `tr (D A D)^-1 D B D` with this `scale` for D.
    pub(super) fn inverse_trace(&self, b: &StencilMatrix, scale: &[f64]) -> f64 {
        let isa = Isa::active();
        let (end, middle) = (self.end, self.middle);
        let forwards = Numbering { matrix: b, scale, reversed: false };
        let count = self.centre.count;
        let mut ring = Ring::new(self.middle_block, count, end > 0);
        let mut sum = 0.0;
        for k in (0..count).rev() {
            ring.advance(isa, self.middle_block, self.centre.block(k, self.middle_block), k, count);
            sum += ring.products(k, middle, |number, put| forwards.column(end + number, put));
            ring.keep(k);
        }
        if end == 0 {
            return sum;
        }
        let backwards = Numbering { matrix: b, scale, reversed: true };
        // the middle's ring holds all unknowns of the middle, in their own order
        let entry = |i: usize, k: usize| ring.values[place(ring.order(), i, k)];
        let one = |part: &Part, numbering: &Numbering, reversed: bool| {
            self.end_products(isa, part, numbering, |i, k| {
                if reversed { entry(middle - 1 - i, middle - 1 - k) } else { entry(i, k) }
            })
        };
        let products = self.end * self.end_block.reach * self.end_block.reach;
        let halves = (|| one(&self.left, &forwards, false), || one(&self.right, &backwards, true));
        let (left, right) = crate::threads::join_if_long(products, halves.0, halves.1);
        sum + left + right
    }

    /// One end's part of the trace. `middle(i, k)` gives the inverse among the unknowns of the middle, in the end's own
    /// numbering.
    fn end_products(&self, isa: Isa, part: &Part, b: &Numbering, middle: impl Fn(usize, usize) -> f64) -> f64 {
        let mut ring = Ring::new(self.end_block, part.count, false);
        let known = self.middle.min(ring.order());
        let (order, stand) = (ring.order(), (0..known).map(|k| ring.at(self.end + k)).collect::<Vec<usize>>());
        for i in 0..known {
            for k in 0..known {
                ring.values[place(order, stand[i], stand[k])] = middle(i, k);
            }
        }
        let mut sum = 0.0;
        for k in (0..self.end / WIDTH).rev() {
            ring.advance(isa, self.end_block, part.block(k, self.end_block), k, part.count);
            sum += ring.products(k, self.end + self.middle, |number, put| b.column(number, put));
            ring.keep(k);
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::TensorShape;

    fn matrix(shape: TensorShape, diagonal: f64, seed: f64) -> StencilMatrix {
        let mut a = StencilMatrix::zeros(shape);
        let mut places = Vec::new();
        a.for_each_lower(|row, column, position| places.push((row, column, position)));
        for (row, column, position) in places {
            let wave = ((row * 7 + column * 13) as f64 * seed).sin();
            a.values_mut()[position] = if row == column { diagonal + wave } else { wave };
        }
        a
    }

    /// The same trace with one solve for each unknown.
    fn by_unit_vectors(band: &BandCholesky, b: &StencilMatrix, scale: &[f64]) -> f64 {
        let mut sum = 0.0;
        for u in 0..b.order() {
            let mut unit = vec![0.0; b.order()];
            unit[u] = scale[u];
            let mut product = vec![0.0; b.order()];
            b.multiply(&unit, &mut product);
            product.iter_mut().zip(scale).for_each(|(p, d)| *p *= d);
            band.solve(&mut product);
            sum += product[u];
        }
        sum
    }

    #[test]
    fn the_trace_is_that_of_unit_vectors_at_every_size() {
        let shapes = [
            ([4, 4], [3, 3]),
            ([9, 9], [2, 2]),
            ([21, 20], [3, 3]),
            ([67, 9], [3, 3]),
            ([80, 31], [3, 2]),
            ([31, 12], [1, 4]),
            ([120, 5], [1, 1]),
        ];
        for (basis, degree) in shapes {
            let shape = TensorShape { basis, degree };
            let (a, b) = (matrix(shape, 30.0, 1.0), matrix(shape, 1.0, 0.37));
            let factor_scale: Vec<f64> = a.diagonal().iter().map(|d| 1.0 / d.sqrt()).collect();
            let mut band = BandCholesky::plan(shape);
            band.factor(&a, &factor_scale).unwrap();
            // leaves out some unknowns, as fits do with free ones
            let scale: Vec<f64> =
                factor_scale.iter().enumerate().map(|(u, d)| if u % 11 == 3 { 0.0 } else { *d }).collect();
            for scale in [&factor_scale, &scale] {
                let (found, expected) = (band.inverse_trace(&b, scale), by_unit_vectors(&band, &b, scale));
                assert!((found - expected).abs() < 1e-12 * shape.unknowns() as f64, "{basis:?}: {found} {expected}");
            }
            // for B = A the trace is the number of unknowns
            let order = shape.unknowns() as f64;
            assert!((band.inverse_trace(&a, &factor_scale) - order).abs() < 1e-13 * order, "{basis:?}");
        }
    }

    #[test]
    #[cfg(feature = "threads")]
    fn one_and_two_threads_give_the_same_bits() {
        let shape = TensorShape { basis: [67, 23], degree: [3, 3] };
        let (a, b) = (matrix(shape, 30.0, 1.0), matrix(shape, 1.0, 0.37));
        let scale = vec![0.2; a.order()];
        let run = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let mut band = BandCholesky::plan(shape);
            band.factor(&a, &scale).unwrap();
            pool.install(|| band.inverse_trace(&b, &scale))
        };
        assert_eq!(run(1).to_bits(), run(2).to_bits());
    }
}
