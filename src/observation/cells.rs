//! The normal equations of scattered contacts, cell by cell, from moments.
//!
//! ```text
//! on a cell, with u, v in [-1, 1]:   N_a N_k = sum_i P_ak,i u^i     M_b M_l = sum_j Q_bl,j v^j     (degrees 2p, 2q)
//! A_(ab)(kl) = sum_t sum_ij  X_t,ak,i  G_t,ij  Y_t,bl,j       G_t,ij = sum_r w_t,r u_r^i v_r^j
//!     t: values  wz^2  (N N, M M);   slopes  a^2 (N'N', M M),  a b (N'N, M M') + (N N', M'M),  b^2 + d^2 (N N, M'M')
//! ```
//!
//! Contacts are put into stripes (one x segment each) by a stable counting sort fused with the gather, and within a
//! stripe into cells by their number alone, so each is moved once. Stripes are summed in a fixed number of panels whose
//! overlaps are added in order: the bits do not depend on the number of threads.

use std::sync::Mutex;

use crate::bspline::Knots;
use crate::linalg::{RowMetric, StencilMatrix, TensorShape};
use crate::simd::{BilinearTerm, CellMoments, Level, MAX_MOMENT_DEGREE, bilinear, moments};

/// Panels that the stripes are shared into: enough for the threads of a desktop, few enough that their overlaps are
/// a small part of the matrix.
const PANELS: usize = 8;
/// Contacts whose local coordinates are formed at once; they stay in the first-level cache.
const BATCH: usize = 64;
/// Numbers that a contact takes along: x, y and the three loads, and then the four squares of its metric.
const UNIFORM: usize = 5;
const WEIGHTED: usize = 9;

/// One contact as the assembly sees it: where, what its rows are multiplied by, and what they should be.
#[derive(Clone, Copy, Debug)]
pub struct CellDatum {
    /// x and y, the knots' coordinates.
    pub at: [f64; 2],
    /// `E'b`'s multipliers of `N M`, `N'M`, `N M'`: `wz b_z`, `a b_1`, `b b_1 + d b_2`.
    pub loads: [f64; 3],
}

/// Reusable buffers and tables for all contacts under one pair of knot vectors.
#[derive(Debug)]
pub struct CellAssembly {
    shape: TensorShape,
    x: Axis<XTables>,
    y: Axis<YTables>,
    knots: [Knots; 2],
    stripe_of: Vec<u32>,
    stripe_starts: Vec<usize>,
    records: Vec<f64>,
    overlaps: Vec<Overlap>,
    /// First stripe of every panel, and the number of stripes at the end.
    panels: Vec<usize>,
    scratch: Mutex<Vec<Scratch>>,
}

/// What a panel adds to the first lines of the next one.
#[derive(Debug, Default)]
struct Overlap {
    values: Vec<f64>,
    right: Vec<f64>,
}

#[derive(Debug, Default)]
struct Scratch {
    counts: Vec<u32>,
    order: Vec<u32>,
    local: Vec<f64>,
    block: Vec<[f64; 16]>,
    combined: Combined,
}

/// Products of the basis functions of every segment of one axis, as polynomials of the local coordinate.
#[derive(Debug)]
struct AxisTables {
    first: Vec<usize>,
    centre: Vec<f64>,
    inverse_half: Vec<f64>,
    /// `values[segment][a]`, `slopes[segment][a]`: the functions themselves.
    values: Vec<Vec<[f64; 8]>>,
    slopes: Vec<Vec<[f64; 8]>>,
}

/// Tables of one axis, segment by segment.
#[derive(Debug)]
struct Axis<T> {
    basis: AxisTables,
    products: Vec<T>,
}

impl AxisTables {
    fn new(knots: &Knots) -> AxisTables {
        let width = knots.degree() + 1;
        let mut made = AxisTables {
            first: Vec::new(),
            centre: Vec::new(),
            inverse_half: Vec::new(),
            values: Vec::new(),
            slopes: Vec::new(),
        };
        let mut taylor = vec![0.0; width * width];
        for segment in 0..knots.n_segments() {
            let [lo, hi] = knots.segment(segment);
            let (centre, half) = (0.5 * (lo + hi), 0.5 * (hi - lo));
            knots.derivatives_on(segment, centre, width - 1, &mut taylor);
            let mut values = vec![[0.0; 8]; width];
            let mut slopes = vec![[0.0; 8]; width];
            let mut factor = 1.0;
            for k in 0..width {
                for a in 0..width {
                    values[a][k] = taylor[k * width + a] * factor;
                    if k > 0 {
                        slopes[a][k - 1] = values[a][k] * k as f64 / half;
                    }
                }
                factor *= half / (k + 1) as f64;
            }
            made.first.push(knots.first_basis(segment));
            made.centre.push(centre);
            made.inverse_half.push(1.0 / half);
            made.values.push(values);
            made.slopes.push(slopes);
        }
        made
    }
}

/// Product of two polynomials of degree at most 3.
fn product(a: &[f64; 8], b: &[f64; 8]) -> [f64; 8] {
    let mut out = [0.0; 8];
    for i in 0..4 {
        for j in 0..4 {
            out[i + j] += a[i] * b[j];
        }
    }
    out
}

/// `left[pair]` of one x segment: N N, N'N', N'N, N N' for the pairs (a, k <= a).
#[derive(Debug)]
struct XTables {
    kinds: [Vec<[f64; 8]>; 4],
}

/// `right[power][b (q + 1) + l]` of every y segment: M M, M'M', M M', M'M.
#[derive(Debug)]
struct YTables {
    kinds: [[[f64; 16]; 8]; 4],
}

impl XTables {
    fn of(axis: &AxisTables, segment: usize) -> XTables {
        let (n, d) = (&axis.values[segment], &axis.slopes[segment]);
        let pairs = |f: &dyn Fn(usize, usize) -> [f64; 8]| {
            (0..n.len()).flat_map(|a| (0..=a).map(move |k| (a, k))).map(|(a, k)| f(a, k)).collect()
        };
        XTables {
            kinds: [
                pairs(&|a, k| product(&n[a], &n[k])),
                pairs(&|a, k| product(&d[a], &d[k])),
                pairs(&|a, k| product(&d[a], &n[k])),
                pairs(&|a, k| product(&n[a], &d[k])),
            ],
        }
    }
}

impl YTables {
    fn of(axis: &AxisTables, segment: usize) -> YTables {
        let (m, d) = (&axis.values[segment], &axis.slopes[segment]);
        let width = m.len();
        let table = |left: &Vec<[f64; 8]>, right: &Vec<[f64; 8]>| {
            let mut out = [[0.0; 16]; 8];
            for b in 0..width {
                for l in 0..width {
                    for (power, value) in product(&left[b], &right[l]).into_iter().enumerate() {
                        out[power][b * width + l] = value;
                    }
                }
            }
            out
        };
        YTables { kinds: [table(m, m), table(d, d), table(m, d), table(d, m)] }
    }
}

impl CellAssembly {
    /// Tables for these knots; `None` where a degree is above [`MAX_MOMENT_DEGREE`] (then the rows are summed).
    pub fn new(knots: [Knots; 2]) -> Option<CellAssembly> {
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
            stripe_of: Vec::new(),
            stripe_starts: Vec::new(),
            records: Vec::new(),
            overlaps,
            panels,
            scratch: Mutex::new(Vec::new()),
        })
    }

    /// Shape of the spline.
    pub fn shape(&self) -> TensorShape {
        self.shape
    }

    /// `matrix = E'E` and `right = E'b` of `count` contacts with one metric for all.
    ///
    /// `datum` is called twice for each contact, in order. Coordinates outside the domain use the end cells.
    pub fn assemble(
        &mut self,
        count: usize,
        metric: RowMetric,
        datum: impl Fn(usize) -> CellDatum,
        matrix: &mut StencilMatrix,
        right: &mut [f64],
    ) {
        let squares = squares_of(metric);
        self.sort::<UNIFORM>(
            count,
            |r| datum(r).at[0],
            |r, record| {
                let CellDatum { at, loads } = datum(r);
                record.copy_from_slice(&[at[0], at[1], loads[0], loads[1], loads[2]]);
            },
        );
        self.sum_panels::<UNIFORM>(Some(squares), matrix, right);
    }

    /// The same with a metric for every contact.
    pub fn assemble_weighted(
        &mut self,
        count: usize,
        datum: impl Fn(usize) -> (CellDatum, RowMetric),
        matrix: &mut StencilMatrix,
        right: &mut [f64],
    ) {
        self.sort::<WEIGHTED>(
            count,
            |r| datum(r).0.at[0],
            |r, record| {
                let (CellDatum { at, loads }, metric) = datum(r);
                let [zz, aa, ab, dd] = squares_of(metric);
                record.copy_from_slice(&[at[0], at[1], loads[0], loads[1], loads[2], zz, aa, ab, dd]);
            },
        );
        self.sum_panels::<WEIGHTED>(None, matrix, right);
    }

    /// Stable counting sort by stripe; `x` gives a contact's abscissa, `write` its record.
    fn sort<const RECORD: usize>(&mut self, count: usize, x: impl Fn(usize) -> f64, write: impl Fn(usize, &mut [f64])) {
        let stripes = self.knots[0].n_segments();
        self.stripe_starts.clear();
        self.stripe_starts.resize(stripes + 1, 0);
        self.stripe_of.clear();
        self.stripe_of.extend((0..count).map(|r| self.knots[0].segment_of(x(r)) as u32));
        for &stripe in &self.stripe_of {
            self.stripe_starts[stripe as usize + 1] += 1;
        }
        for stripe in 0..stripes {
            self.stripe_starts[stripe + 1] += self.stripe_starts[stripe];
        }
        if self.records.len() < count * RECORD {
            self.records.resize(count * RECORD, 0.0);
        }
        for r in 0..count {
            let place = &mut self.stripe_starts[self.stripe_of[r] as usize];
            write(r, &mut self.records[*place * RECORD..(*place + 1) * RECORD]);
            *place += 1;
        }
        // every start has moved to the next one's place
        self.stripe_starts.copy_within(0..stripes, 1);
        self.stripe_starts[0] = 0;
    }

    fn sum_panels<const RECORD: usize>(
        &mut self,
        squares: Option<[f64; 4]>,
        matrix: &mut StencilMatrix,
        right: &mut [f64],
    ) {
        matrix.clear();
        right.fill(0.0);
        let line = self.shape.basis[1] * self.shape.stencil_width();
        let mut overlaps = std::mem::take(&mut self.overlaps);
        let count = overlaps.len();
        self.panel_range::<RECORD>(0..count, squares, matrix.values_mut(), right, &mut overlaps);
        for (panel, overlap) in overlaps[..count - 1].iter().enumerate() {
            let start = self.x.basis.first[self.panels[panel + 1]];
            let add = |to: &mut [f64], from: &[f64]| to.iter_mut().zip(from).for_each(|(t, f)| *t += f);
            add(&mut matrix.values_mut()[start * line..], &overlap.values);
            add(&mut right[start * self.shape.basis[1]..], &overlap.right);
        }
        self.overlaps = overlaps;
    }

    /// Halves the range until one panel is left; `values` and `right` start at the range's first line of coefficients.
    fn panel_range<const RECORD: usize>(
        &self,
        range: std::ops::Range<usize>,
        squares: Option<[f64; 4]>,
        values: &mut [f64],
        right: &mut [f64],
        overlaps: &mut [Overlap],
    ) {
        if range.len() == 1 {
            self.one_panel::<RECORD>(range.start, squares, values, right, &mut overlaps[0]);
            return;
        }
        let middle = range.start + range.len() / 2;
        let lines = self.x.basis.first[self.panels[middle]] - self.x.basis.first[self.panels[range.start]];
        let unknowns = lines * self.shape.basis[1];
        let (values_a, values_b) = values.split_at_mut(unknowns * self.shape.stencil_width());
        let (right_a, right_b) = right.split_at_mut(unknowns);
        let (overlaps_a, overlaps_b) = overlaps.split_at_mut(middle - range.start);
        rayon::join(
            || self.panel_range::<RECORD>(range.start..middle, squares, values_a, right_a, overlaps_a),
            || self.panel_range::<RECORD>(middle..range.end, squares, values_b, right_b, overlaps_b),
        );
    }

    fn one_panel<const RECORD: usize>(
        &self,
        panel: usize,
        squares: Option<[f64; 4]>,
        values: &mut [f64],
        right: &mut [f64],
        overlap: &mut Overlap,
    ) {
        overlap.values.fill(0.0);
        overlap.right.fill(0.0);
        let mut scratch = self.scratch.lock().ok().and_then(|mut pool| pool.pop()).unwrap_or_default();
        let stripes = self.panels[panel]..self.panels[panel + 1];
        let origin = self.x.basis.first[stripes.start];
        for stripe in stripes {
            let mut target = Target { shape: self.shape, origin, values, right, overlap };
            self.one_stripe::<RECORD>(stripe, squares, &mut scratch, &mut target);
        }
        if let Ok(mut pool) = self.scratch.lock() {
            pool.push(scratch);
        }
    }

    fn one_stripe<const RECORD: usize>(
        &self,
        stripe: usize,
        squares: Option<[f64; 4]>,
        scratch: &mut Scratch,
        target: &mut Target<'_>,
    ) {
        let records = &self.records[self.stripe_starts[stripe] * RECORD..self.stripe_starts[stripe + 1] * RECORD];
        if records.is_empty() {
            return;
        }
        self.sort_cells::<RECORD>(records, scratch);
        let x_tables = &self.x.products[stripe];
        if let Some(squares) = squares {
            scratch.combined.take_in(x_tables, squares);
        }
        for cell in 0..self.knots[1].n_segments() {
            let range = scratch.counts[cell] as usize..scratch.counts[cell + 1] as usize;
            if range.is_empty() {
                continue;
            }
            let y_tables = &self.y.products[cell];
            let Scratch { order, local, block, combined, .. } = scratch;
            let sums = self.sum_cell::<RECORD>(stripe, cell, records, &order[range], local, squares.is_some());
            block.fill([0.0; 16]);
            if squares.is_some() {
                self.uniform_block(combined, &sums[0], y_tables, block);
            } else {
                self.weighted_block(x_tables, &sums, y_tables, block);
            }
            let first = [self.x.basis.first[stripe], self.y.basis.first[cell]];
            target.add_block(first, block);
            self.add_loads([stripe, cell], &sums[0], target);
        }
    }

    /// `scratch.order`: the stripe's contacts by cell, stable; `scratch.counts`: where each cell starts.
    fn sort_cells<const RECORD: usize>(&self, records: &[f64], scratch: &mut Scratch) {
        let cells = self.knots[1].n_segments();
        let pairs = self.shape.degree[0] + 1;
        scratch.block.resize(pairs * (pairs + 1) / 2, [0.0; 16]);
        scratch.local.resize(WEIGHTED * BATCH, 0.0);
        scratch.counts.clear();
        scratch.counts.resize(cells + 1, 0);
        let count = records.len() / RECORD;
        // the second half of `order` remembers the cells
        scratch.order.resize(2 * count, 0);
        let (order, cell_of) = scratch.order.split_at_mut(count);
        for (cell, record) in cell_of.iter_mut().zip(records.chunks_exact(RECORD)) {
            *cell = self.knots[1].segment_of(record[1]) as u32;
            scratch.counts[*cell as usize + 1] += 1;
        }
        for cell in 0..cells {
            scratch.counts[cell + 1] += scratch.counts[cell];
        }
        for (r, &cell) in cell_of.iter().enumerate() {
            let place = &mut scratch.counts[cell as usize];
            order[*place as usize] = r as u32;
            *place += 1;
        }
        scratch.counts.copy_within(0..cells, 1);
        scratch.counts[0] = 0;
    }

    /// G (for a uniform metric one with weight 1, else four) and F of one cell.
    fn sum_cell<const RECORD: usize>(
        &self,
        stripe: usize,
        cell: usize,
        records: &[f64],
        order: &[u32],
        local: &mut [f64],
        uniform: bool,
    ) -> [CellMoments; 4] {
        let level = Level::active();
        let degree = self.shape.degree[0].max(self.shape.degree[1]);
        let mut sums = [CellMoments::ZERO; 4];
        let (cx, hx) = (self.x.basis.centre[stripe], self.x.basis.inverse_half[stripe]);
        let (cy, hy) = (self.y.basis.centre[cell], self.y.basis.inverse_half[cell]);
        let columns: &mut [[f64; BATCH]] = local.as_chunks_mut::<BATCH>().0;
        for batch in order.chunks(BATCH) {
            for (k, &r) in batch.iter().enumerate() {
                let record = &records[r as usize * RECORD..(r as usize + 1) * RECORD];
                columns[0][k] = (record[0] - cx) * hx;
                columns[1][k] = (record[1] - cy) * hy;
                for c in 2..RECORD {
                    columns[c][k] = record[c];
                }
            }
            let n = batch.len();
            let (u, v) = (&columns[0][..n], &columns[1][..n]);
            let data = Some([&columns[2][..n], &columns[3][..n], &columns[4][..n]]);
            if uniform {
                moments(level, degree, [u, v], None, data, &mut sums[0]);
            } else {
                moments(level, degree, [u, v], Some(&columns[5][..n]), data, &mut sums[0]);
                for t in 1..4 {
                    moments(level, degree, [u, v], Some(&columns[5 + t][..n]), None, &mut sums[t]);
                }
            }
        }
        sums
    }

    fn uniform_block(&self, combined: &Combined, sums: &CellMoments, y: &YTables, block: &mut [[f64; 16]]) {
        let powers = self.shape.degree.map(|d| 2 * d + 1);
        let term = |left, kind: usize| BilinearTerm { left, middle: &sums.weights, right: &y.kinds[kind], powers };
        let [mm, dd] = [term(&combined.values[..], 0), term(&combined.across[..], 1)];
        if combined.coupled {
            let [left, right] = [&combined.coupling[0][..], &combined.coupling[1][..]];
            bilinear(Level::active(), &[mm, dd, term(left, 2), term(right, 3)], block);
        } else {
            bilinear(Level::active(), &[mm, dd], block);
        }
    }

    fn weighted_block(&self, x: &XTables, sums: &[CellMoments; 4], y: &YTables, block: &mut [[f64; 16]]) {
        let powers = self.shape.degree.map(|d| 2 * d + 1);
        let term = |left: usize, sum: usize, right: usize| BilinearTerm {
            left: &x.kinds[left],
            middle: &sums[sum].weights,
            right: &y.kinds[right],
            powers,
        };
        let terms = [term(0, 0, 0), term(1, 1, 0), term(0, 3, 1), term(2, 2, 2), term(3, 2, 3)];
        bilinear(Level::active(), &terms, block);
    }

    /// `right += N' F_z M + N'' F_x M + N' F_y M'` of one cell.
    fn add_loads(&self, [stripe, cell]: [usize; 2], sums: &CellMoments, target: &mut Target<'_>) {
        let (x, y) = (&self.x.basis, &self.y.basis);
        let [p, q] = self.shape.degree;
        let functions = [
            (&x.values[stripe], &y.values[cell]),
            (&x.slopes[stripe], &y.values[cell]),
            (&x.values[stripe], &y.slopes[cell]),
        ];
        for a in 0..=p {
            let row = target.right_row(x.first[stripe] + a, y.first[cell]);
            for ((nx, my), loads) in functions.iter().zip(&sums.loads) {
                let mut half = [0.0; 4];
                for (power, load) in loads[..=p].iter().enumerate() {
                    for (h, l) in half.iter_mut().zip(load) {
                        *h += nx[a][power] * l;
                    }
                }
                for (b, value) in row[..=q].iter_mut().enumerate() {
                    *value += (0..=q).map(|k| half[k] * my[b][k]).sum::<f64>();
                }
            }
        }
    }
}

/// Squares that the metric enters with: `wz^2, a^2, a b, b^2 + d^2`.
fn squares_of(m: RowMetric) -> [f64; 4] {
    [m.z * m.z, m.a * m.a, m.a * m.b, m.b * m.b + m.d * m.d]
}

/// The x tables of one stripe with a uniform metric taken in.
#[derive(Debug, Default)]
struct Combined {
    values: Vec<[f64; 8]>,
    across: Vec<[f64; 8]>,
    coupling: [Vec<[f64; 8]>; 2],
    coupled: bool,
}

impl Combined {
    fn take_in(&mut self, x: &XTables, [zz, aa, ab, dd]: [f64; 4]) {
        let set = |target: &mut Vec<[f64; 8]>, table: &[[f64; 8]], w: f64| {
            target.clear();
            target.extend(table.iter().map(|row| row.map(|v| w * v)));
        };
        set(&mut self.values, &x.kinds[0], zz);
        for (row, slopes) in self.values.iter_mut().zip(&x.kinds[1]) {
            row.iter_mut().zip(slopes).for_each(|(v, d)| *v += aa * d);
        }
        set(&mut self.across, &x.kinds[0], dd);
        self.coupled = ab != 0.0;
        if self.coupled {
            set(&mut self.coupling[0], &x.kinds[2], ab);
            set(&mut self.coupling[1], &x.kinds[3], ab);
        }
    }
}

/// Where a panel's sums go: its own lines, and past their end the overlap.
struct Target<'a> {
    shape: TensorShape,
    /// First line of coefficients of the panel.
    origin: usize,
    values: &'a mut [f64],
    right: &'a mut [f64],
    overlap: &'a mut Overlap,
}

impl Target<'_> {
    /// Lines that the panel owns; the last panel owns all that are left.
    fn own_lines(&self) -> usize {
        self.right.len() / self.shape.basis[1]
    }

    fn add_block(&mut self, first: [usize; 2], block: &[[f64; 16]]) {
        let (q, m, stencil) = (self.shape.degree[1], self.shape.basis[1], self.shape.stencil_width());
        let (width, own) = (q + 1, self.own_lines());
        let mut pairs = block.iter();
        for a in 0..=self.shape.degree[0] {
            let line = first[0] + a - self.origin;
            let values = if line < own {
                &mut self.values[line * m * stencil..]
            } else {
                &mut self.overlap.values[(line - own) * m * stencil..]
            };
            for k in 0..=a {
                let Some(entries) = pairs.next() else { return };
                for b in 0..width {
                    // on the diagonal block only the lower half is stored
                    let take = if a == k { b + 1 } else { width };
                    let start = (first[1] + b) * stencil + (a - k) * (2 * q + 1) + q - b;
                    let row = &mut values[start..start + take];
                    for (value, entry) in row.iter_mut().zip(&entries[b * width..b * width + take]) {
                        *value += entry;
                    }
                }
            }
        }
    }

    fn right_row(&mut self, line: usize, column: usize) -> &mut [f64] {
        let (m, own, line) = (self.shape.basis[1], self.own_lines(), line - self.origin);
        if line < own {
            &mut self.right[line * m + column..(line + 1) * m]
        } else {
            &mut self.overlap.right[(line - own) * m + column..(line - own + 1) * m]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::{Metric, assemble, normal_rhs};
    use crate::observation::ScatteredSites;

    fn points(count: usize) -> Vec<[f64; 2]> {
        (0..count)
            .map(|r| [(r as f64 * 0.754_877_666).fract(), (r as f64 * 0.569_840_291).fract() * 2.0 - 1.0])
            .collect()
    }

    fn check(
        degree: [usize; 2],
        segments: [usize; 2],
        count: usize,
        metric: impl Fn(usize) -> RowMetric,
        uniform: bool,
    ) {
        let knots = [
            Knots::uniform(degree[0], segments[0], 0.0, 1.0).unwrap(),
            Knots::uniform(degree[1], segments[1], -1.0, 1.0).unwrap(),
        ];
        let points = points(count);
        let rows: Vec<[f64; 3]> = (0..count).map(|r| [1.0, 2.0, 3.0].map(|k| (k * r as f64).sin())).collect();
        let sites = ScatteredSites::new(knots.clone(), points.clone());
        let metrics =
            if uniform { Metric::Uniform(metric(0)) } else { Metric::PerSite((0..count).map(&metric).collect()) };
        let mut cells = CellAssembly::new(knots).unwrap();
        let shape = cells.shape();
        let mut expected = StencilMatrix::zeros(shape);
        assemble(&sites, &metrics, &mut expected);
        let mut expected_right = vec![0.0; shape.unknowns()];
        normal_rhs(&sites, &metrics, &rows, &mut expected_right);
        let datum = |r: usize| {
            let (m, b) = (metrics.at(r), rows[r]);
            CellDatum { at: points[r], loads: [m.z * b[0], m.a * b[1], m.b * b[1] + m.d * b[2]] }
        };
        let (mut matrix, mut right) = (StencilMatrix::zeros(shape), vec![1.0; shape.unknowns()]);
        for _ in 0..2 {
            if uniform {
                cells.assemble(count, metric(0), datum, &mut matrix, &mut right);
            } else {
                cells.assemble_weighted(count, |r| (datum(r), metrics.at(r)), &mut matrix, &mut right);
            }
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
        // measured 2e-15: centred powers up to the sixth cost a few roundings, no more
        assert!(worst < 1e-14 && worst_right < 1e-14, "{worst:e} {worst_right:e}");
    }

    #[test]
    fn moments_and_rows_give_the_same_equations() {
        for (degree, segments) in
            [([3, 3], [5, 4]), ([2, 2], [1, 1]), ([2, 3], [12, 3]), ([1, 2], [3, 9]), ([3, 1], [9, 2])]
        {
            check(degree, segments, 3000, |_| RowMetric { z: 2.0, a: 0.5, b: 0.0, d: 0.7 }, true);
            check(degree, segments, 700, |_| RowMetric { z: 1.0, a: 0.5, b: -0.3, d: 0.7 }, true);
            let varied = |r: usize| {
                let w = 1.0 + 0.5 * (r as f64).sin();
                RowMetric { z: w, a: 0.5 * w, b: 0.2 * (r as f64).cos(), d: 2.0 - w }
            };
            check(degree, segments, 700, varied, false);
        }
    }

    #[test]
    fn one_and_two_threads_give_the_same_bits() {
        let knots = [Knots::uniform(3, 17, 0.0, 1.0).unwrap(), Knots::uniform(3, 9, -1.0, 1.0).unwrap()];
        let points = points(5000);
        let run = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let mut cells = CellAssembly::new(knots.clone()).unwrap();
            let mut matrix = StencilMatrix::zeros(cells.shape());
            let mut right = vec![0.0; matrix.order()];
            let metric = RowMetric { z: 1.0, a: 1.0, b: 0.0, d: 1.0 };
            let datum = |r: usize| CellDatum {
                at: points[r],
                loads: points[r].map(f64::sin).into_iter().chain([1.0]).collect::<Vec<_>>().try_into().unwrap(),
            };
            pool.install(|| cells.assemble(points.len(), metric, datum, &mut matrix, &mut right));
            (matrix, right)
        };
        assert!(run(1) == run(2));
    }
}
