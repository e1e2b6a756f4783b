//! Sums of the assembly: cells are added to their stripe, stripes to their panel, panels to the matrix.

use super::sorting::CellOrder;
use super::tables::{Combined, XTables, YTables, squares_of};
use super::target::{Overlap, Target};
use super::{CellAssembly, CellRows, PackedCells, WEIGHTED};
use palpate_numeric::linalg::{RowWeights, StencilMatrix, TensorShape};
use palpate_numeric::simd::{BilinearTerm, CellMoments, Isa, MomentPowers, bilinear, moments};

/// Contacts whose local coordinates are computed together; they stay in the first-level cache.
const BATCH: usize = 64;

/// Buffers of one panel.
#[derive(Debug)]
pub(super) struct Scratch {
    cells: CellOrder,
    local: Vec<f64>,
    batch: MomentPowers,
    sums: [CellMoments; 4],
    work: Work,
}

/// One cell's part of the matrix, and the tables of its stripe from which it is computed.
#[derive(Debug, Default)]
struct Work {
    combined: Combined,
    block: Vec<[f64; 16]>,
}

impl Default for Scratch {
    fn default() -> Scratch {
        Scratch {
            cells: CellOrder::default(),
            local: Vec::new(),
            batch: MomentPowers::default(),
            sums: [CellMoments::ZERO; 4],
            work: Work::default(),
        }
    }
}

impl Work {
    /// Prepares what is the same for all cells of a stripe.
    fn start(&mut self, x: &XTables, shape: TensorShape, squares: Option<[f64; 4]>) {
        let width = shape.degree[0] + 1;
        self.block.resize(width * (width + 1) / 2, [0.0; 16]);
        if let Some(squares) = squares {
            self.combined.take_in(x, squares);
        }
    }
}

impl CellAssembly {
    pub(super) fn sum_panels(
        &mut self,
        matrix: &mut StencilMatrix,
        right: &mut [f64],
        one_stripe: &(impl Fn(&CellAssembly, usize, &mut Scratch, &mut Target<'_>) + Sync),
    ) {
        let line = self.shape.basis[1] * self.shape.stencil_width();
        let mut overlaps = std::mem::take(&mut self.overlaps);
        let count = overlaps.len();
        self.panel_range(0..count, one_stripe, matrix.values_mut(), right, &mut overlaps);
        for (panel, overlap) in overlaps[..count - 1].iter().enumerate() {
            let start = self.x.basis.first[self.panels[panel + 1]];
            let add = |to: &mut [f64], from: &[f64]| to.iter_mut().zip(from).for_each(|(t, f)| *t += f);
            add(&mut matrix.values_mut()[start * line..], &overlap.values);
            add(&mut right[start * self.shape.basis[1]..], &overlap.right);
        }
        self.overlaps = overlaps;
    }

    /// Sums a range of panels by halving it, on two threads. `values` and `right` start at the range's first line of
    /// coefficients.
    fn panel_range(
        &self,
        range: std::ops::Range<usize>,
        one_stripe: &(impl Fn(&CellAssembly, usize, &mut Scratch, &mut Target<'_>) + Sync),
        values: &mut [f64],
        right: &mut [f64],
        overlaps: &mut [Overlap],
    ) {
        if range.len() == 1 {
            self.one_panel(range.start, one_stripe, values, right, &mut overlaps[0]);
            return;
        }
        let middle = range.start + range.len() / 2;
        let lines = self.x.basis.first[self.panels[middle]] - self.x.basis.first[self.panels[range.start]];
        let unknowns = lines * self.shape.basis[1];
        let (values_a, values_b) = values.split_at_mut(unknowns * self.shape.stencil_width());
        let (right_a, right_b) = right.split_at_mut(unknowns);
        let (overlaps_a, overlaps_b) = overlaps.split_at_mut(middle - range.start);
        palpate_numeric::threads::join(
            || self.panel_range(range.start..middle, one_stripe, values_a, right_a, overlaps_a),
            || self.panel_range(middle..range.end, one_stripe, values_b, right_b, overlaps_b),
        );
    }

    fn one_panel(
        &self,
        panel: usize,
        one_stripe: &impl Fn(&CellAssembly, usize, &mut Scratch, &mut Target<'_>),
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
            one_stripe(self, stripe, &mut scratch, &mut target);
        }
        if let Ok(mut pool) = self.scratch.lock() {
            pool.push(scratch);
        }
    }

    /// Sums one stripe of packed cells.
    pub(super) fn packed_stripe(
        &self,
        stripe: usize,
        row_weights: &RowWeights,
        packed: &PackedCells,
        scratch: &mut Scratch,
        target: &mut Target<'_>,
    ) {
        let Scratch { local, batch, sums, work, .. } = scratch;
        let uniform = match row_weights {
            RowWeights::Uniform(m) => Some(squares_of(*m)),
            RowWeights::PerSite(_) => None,
        };
        work.start(&self.x.products[stripe], self.shape, uniform);
        local.resize(WEIGHTED * BATCH, 0.0);
        let columns: &mut [[f64; BATCH]] = local.as_chunks_mut::<BATCH>().0;
        let (isa, degree) = (Isa::active(), self.shape.degree[0].max(self.shape.degree[1]));
        for cell in 0..self.knots[1].n_segments() {
            let ([u, v], numbers) = packed.contacts([stripe, cell]);
            if numbers.is_empty() {
                continue;
            }
            let sums = if uniform.is_some() { &mut sums[..1] } else { &mut sums[..] };
            sums.fill(CellMoments::ZERO);
            for (numbers, (u, v)) in numbers.chunks(BATCH).zip(u.chunks(BATCH).zip(v.chunks(BATCH))) {
                let RowWeights::PerSite(site_weights) = row_weights else {
                    moments(isa, degree, [u, v], None, None, batch, &mut sums[0]);
                    continue;
                };
                for (k, &number) in numbers.iter().enumerate() {
                    squares_of(site_weights[number as usize]).iter().zip(&mut *columns).for_each(|(w, c)| c[k] = *w);
                }
                for (sum, weights) in sums.iter_mut().zip(&*columns) {
                    moments(isa, degree, [u, v], Some(&weights[..u.len()]), None, batch, sum);
                }
            }
            self.add_matrix([stripe, cell], sums, work, target);
        }
    }

    pub(super) fn one_stripe<const RECORD: usize>(
        &self,
        stripe: usize,
        squares: Option<[f64; 4]>,
        scratch: &mut Scratch,
        target: &mut Target<'_>,
    ) {
        let Scratch { cells, local, batch, sums, work } = scratch;
        if !self.stripes.sort_cells::<RECORD>(stripe, &self.knots[1], cells) {
            return;
        }
        work.start(&self.x.products[stripe], self.shape, squares);
        local.resize(WEIGHTED * BATCH, 0.0);
        for cell in 0..self.knots[1].n_segments() {
            let range = cells.starts[cell] as usize..cells.starts[cell + 1] as usize;
            if range.is_empty() {
                continue;
            }
            let sums = if squares.is_some() { &mut sums[..1] } else { &mut sums[..] };
            sums.fill(CellMoments::ZERO);
            for numbers in cells.order[range].chunks(BATCH) {
                self.add_batch(
                    [stripe, cell],
                    numbers.iter().map(|&r| self.stripes.record::<RECORD>(r)),
                    local,
                    batch,
                    sums,
                );
            }
            self.add_cell([stripe, cell], sums, work, target);
        }
    }

    /// Sums all contacts of a patch with a single cell, which need no sorting.
    pub(super) fn sum_one_cell(
        &mut self,
        rows: &impl CellRows,
        squares: [f64; 4],
        matrix: &mut StencilMatrix,
        right: &mut [f64],
    ) {
        let mut scratch = self.scratch.lock().ok().and_then(|mut pool| pool.pop()).unwrap_or_default();
        let Scratch { local, batch, sums, work, .. } = &mut *scratch;
        work.start(&self.x.products[0], self.shape, Some(squares));
        local.resize(WEIGHTED * BATCH, 0.0);
        sums[0] = CellMoments::ZERO;
        for from in (0..rows.len()).step_by(BATCH) {
            let records = (from..rows.len().min(from + BATCH)).map(|r| {
                let ([x, y], [z, zx, zy]) = (rows.at(r), rows.loads(r));
                [x, y, z, zx, zy]
            });
            self.add_batch([0, 0], records, local, batch, &mut sums[..1]);
        }
        let mut overlap = Overlap::default();
        let values = matrix.values_mut();
        let mut target = Target { shape: self.shape, origin: 0, values, right, overlap: &mut overlap };
        self.add_cell([0, 0], &sums[..1], work, &mut target);
        if let Ok(mut pool) = self.scratch.lock() {
            pool.push(scratch);
        }
    }

    /// Adds at most [`BATCH`] contacts of one cell to G (one G with weights 1 if the row weights are uniform, else four) and F.
    #[inline]
    fn add_batch<const RECORD: usize>(
        &self,
        [stripe, cell]: [usize; 2],
        records: impl Iterator<Item = impl std::borrow::Borrow<[f64; RECORD]>>,
        local: &mut [f64],
        powers: &mut MomentPowers,
        sums: &mut [CellMoments],
    ) {
        let (cx, hx) = (self.x.basis.centre[stripe], self.x.basis.inverse_half[stripe]);
        let (cy, hy) = (self.y.basis.centre[cell], self.y.basis.inverse_half[cell]);
        let columns: &mut [[f64; BATCH]] = local.as_chunks_mut::<BATCH>().0;
        let mut n = 0;
        for (k, record) in records.enumerate().take(BATCH) {
            let record = record.borrow();
            columns[0][k] = (record[0] - cx) * hx;
            columns[1][k] = (record[1] - cy) * hy;
            for c in 2..RECORD {
                columns[c][k] = record[c];
            }
            n = k + 1;
        }
        let isa = Isa::active();
        let degree = self.shape.degree[0].max(self.shape.degree[1]);
        let (u, v) = (&columns[0][..n], &columns[1][..n]);
        let data = Some([&columns[2][..n], &columns[3][..n], &columns[4][..n]]);
        if let [sum] = sums {
            moments(isa, degree, [u, v], None, data, powers, sum);
            return;
        }
        for (t, sum) in sums.iter_mut().enumerate() {
            let data = if t == 0 { data } else { None };
            moments(isa, degree, [u, v], Some(&columns[5 + t][..n]), data, powers, sum);
        }
    }

    /// Adds one cell's moments to the equations.
    fn add_cell(&self, segment: [usize; 2], sums: &[CellMoments], work: &mut Work, target: &mut Target<'_>) {
        self.add_matrix(segment, sums, work, target);
        self.add_loads(segment, &sums[0], target);
    }

    #[inline(always)]
    fn add_matrix(&self, [stripe, cell]: [usize; 2], sums: &[CellMoments], work: &mut Work, target: &mut Target<'_>) {
        let Work { combined, block } = work;
        let (x_tables, y_tables) = (&self.x.products[stripe], &self.y.products[cell]);
        block.fill([0.0; 16]);
        match sums {
            [alone] => self.uniform_block(combined, alone, y_tables, block),
            sums => self.weighted_block(x_tables, sums, y_tables, block),
        }
        target.add_block([self.x.basis.first[stripe], self.y.basis.first[cell]], block);
    }

    fn uniform_block(&self, combined: &Combined, sums: &CellMoments, y: &YTables, block: &mut [[f64; 16]]) {
        let powers = self.shape.degree.map(|d| 2 * d + 1);
        let term = |left, kind: usize| BilinearTerm { left, middle: &sums.weights, right: &y.kinds[kind], powers };
        let [mm, dd] = [term(&combined.values[..], 0), term(&combined.across[..], 1)];
        if combined.coupled {
            let [left, right] = [&combined.coupling[0][..], &combined.coupling[1][..]];
            bilinear(Isa::active(), &[mm, dd, term(left, 2), term(right, 3)], block);
        } else {
            bilinear(Isa::active(), &[mm, dd], block);
        }
    }

    fn weighted_block(&self, x: &XTables, sums: &[CellMoments], y: &YTables, block: &mut [[f64; 16]]) {
        let powers = self.shape.degree.map(|d| 2 * d + 1);
        let term = |left: usize, sum: usize, right: usize| BilinearTerm {
            left: &x.kinds[left],
            middle: &sums[sum].weights,
            right: &y.kinds[right],
            powers,
        };
        let terms = [term(0, 0, 0), term(1, 1, 0), term(0, 3, 1), term(2, 2, 2), term(3, 2, 3)];
        bilinear(Isa::active(), &terms, block);
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
