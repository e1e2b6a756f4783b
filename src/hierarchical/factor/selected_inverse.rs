//! Entries of the inverse wherever the factor has entries (K. Takahashi, J. Fagan, M.-S. Chen, *8th PICA Conf.* (1973) 63), by supernodes
//! J with R the rows below them:
//!
//! ```text
//! M = L_RJ L_JJ^-1       Z_RJ = -Z_RR M       Z_JJ = L_JJ^-T L_JJ^-1 - M' Z_RJ       Z = A^-1 where L is not zero
//! ```
//!
//! Supernodes are taken backwards. All entries of `Z_RR` belong to later supernodes and are known: R is a clique of the factor. The
//! work is twice that of the factorisation.

use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;
use faer::{Accum, Mat, MatMut, MatRef, Par};

use super::sparse_cholesky::SparseCholesky;

/// The entries of `A^-1` among unknowns that meet.
#[derive(Clone, Debug)]
pub struct SelectedInverse {
    /// Start of the columns of every supernode, and the end.
    begins: Vec<usize>,
    /// Rows below the columns of every supernode.
    below_starts: Vec<usize>,
    below: Vec<usize>,
    value_starts: Vec<usize>,
    /// Supernode by supernode, column by column: its own rows, then those below.
    values: Vec<f64>,
    /// Position of every unknown in the order of elimination.
    positions: Vec<usize>,
    /// Supernode of every position.
    supernode_of: Vec<u32>,
    scale: Vec<f64>,
}

impl SelectedInverse {
    /// From a factor. `None` where faer chose another kind of factor, which it never does for a plan of ours.
    pub fn of(factor: &SparseCholesky) -> Option<SelectedInverse> {
        let (symbolic, llt) = factor.supernodal()?;
        let mut inverse = SelectedInverse::shaped(factor, symbolic);
        let mut scratch = GatherMemory::default();
        for s in (0..symbolic.n_supernodes()).rev() {
            inverse.advance(s, llt.supernode(s).val(), &mut scratch);
        }
        Some(inverse)
    }

    fn shaped(factor: &SparseCholesky, symbolic: &SymbolicSupernodalCholesky<usize>) -> SelectedInverse {
        let count = symbolic.n_supernodes();
        let order = factor.order();
        let mut positions = vec![0; order.len()];
        order.iter().enumerate().for_each(|(k, unknown)| positions[*unknown] = k);
        let mut begins = symbolic.supernode_begin().to_vec();
        begins.push(order.len());
        let (mut below_starts, mut below, mut value_starts) = (vec![0], Vec::new(), vec![0]);
        let mut supernode_of = vec![0u32; order.len()];
        for s in 0..count {
            supernode_of[begins[s]..begins[s + 1]].fill(s as u32);
            below.extend_from_slice(symbolic.supernode(s).pattern());
            let columns = begins[s + 1] - begins[s];
            let rows = columns + below.len() - below_starts[s];
            below_starts.push(below.len());
            value_starts.push(value_starts[s] + rows * columns);
        }
        let values = vec![0.0; value_starts[count]];
        let scale = factor.scale().to_vec();
        SelectedInverse { begins, below_starts, below, value_starts, values, positions, supernode_of, scale }
    }

    fn below(&self, s: usize) -> &[usize] {
        &self.below[self.below_starts[s]..self.below_starts[s + 1]]
    }

    /// `Z_RJ` and `Z_JJ` of supernode s.
    fn advance(&mut self, s: usize, block: MatRef<'_, f64>, scratch: &mut GatherMemory) {
        let columns = self.begins[s + 1] - self.begins[s];
        let count = self.below(s).len();
        let lower = block.subrows(0, columns);
        // L_JJ^-1, then L_JJ^-T L_JJ^-1
        let mut inverse = Mat::<f64>::identity(columns, columns);
        solve_lower_triangular_in_place(lower, inverse.as_mut(), Par::Seq);
        let mut own = Mat::<f64>::zeros(columns, columns);
        matmul(own.as_mut(), Accum::Replace, inverse.transpose(), inverse.as_ref(), 1.0, Par::Seq);
        let mut product = Mat::<f64>::zeros(count, columns);
        if count > 0 {
            // M' = L_JJ^-T L_RJ'
            let mut multipliers = block.subrows(columns, count).transpose().to_owned();
            solve_upper_triangular_in_place(lower.transpose(), multipliers.as_mut(), Par::Seq);
            self.gather(s, scratch);
            let square = MatRef::from_column_major_slice(&scratch.square[..count * count], count, count);
            matmul(product.as_mut(), Accum::Replace, square, multipliers.transpose(), -1.0, Par::Seq);
            matmul(own.as_mut(), Accum::Add, multipliers.as_ref(), product.as_ref(), -1.0, Par::Seq);
        }
        let range = self.value_starts[s]..self.value_starts[s + 1];
        let mut target = MatMut::from_column_major_slice_mut(&mut self.values[range], columns + count, columns);
        target.as_mut().subrows_mut(0, columns).copy_from(&own);
        target.subrows_mut(columns, count).copy_from(&product);
    }

    /// `Z_RR` into a dense square: the columns of each later supernode that R meets hold all of R that lies at or below them.
    fn gather(&self, s: usize, scratch: &mut GatherMemory) {
        let rows = self.below(s);
        let count = rows.len();
        if scratch.square.len() < count * count {
            scratch.square.resize(count * count, 0.0);
        }
        let mut from = 0;
        while from < count {
            let other = self.supernode_of[rows[from]] as usize;
            let (begin, end) = (self.begins[other], self.begins[other + 1]);
            let to = from + rows[from..].partition_point(|row| *row < end);
            let (own, below) = (end - begin, self.below(other));
            let height = own + below.len();
            scratch.places.clear();
            scratch.places.extend(rows[from..to].iter().map(|row| row - begin));
            let mut at = 0;
            for row in &rows[to..] {
                while below[at] < *row {
                    at += 1;
                }
                scratch.places.push(own + at);
            }
            for (k, column) in rows[from..to].iter().enumerate() {
                let start = self.value_starts[other] + (column - begin) * height;
                for (i, place) in scratch.places.iter().enumerate() {
                    let value = self.values[start + place];
                    scratch.square[(from + k) * count + from + i] = value;
                    scratch.square[(from + i) * count + from + k] = value;
                }
            }
            from = to;
        }
    }

    /// `(A^-1)_ij`; `None` where the factor has no entry, which it has for all unknowns that meet in A.
    pub fn entry(&self, i: usize, j: usize) -> Option<f64> {
        let [p, q] = [self.positions[i], self.positions[j]];
        let (row, column) = (p.max(q), p.min(q));
        let s = self.supernode_of[column] as usize;
        let (begin, end) = (self.begins[s], self.begins[s + 1]);
        let below = self.below(s);
        let place = if row < end { row - begin } else { end - begin + below.binary_search(&row).ok()? };
        let height = end - begin + below.len();
        let value = self.values[self.value_starts[s] + (column - begin) * height + place];
        Some(value * (self.scale[i] * self.scale[j]))
    }

    /// `g'A^-1 g` of a functional whose unknowns all meet each other: `(unknown, derivative)`.
    pub fn quadratic(&self, gradient: impl Iterator<Item = (usize, f64)> + Clone) -> Option<f64> {
        let mut sum = 0.0;
        let mut rest = gradient;
        while let Some((i, g)) = rest.next() {
            sum += g * g * self.entry(i, i)?;
            for (j, h) in rest.clone() {
                sum += 2.0 * g * h * self.entry(i, j)?;
            }
        }
        Some(sum)
    }

    /// `tr A^-1 B` for a matrix B within the pattern, by the values of its upper triangle in compressed columns.
    pub fn trace_with(&self, starts: &[usize], rows: &[usize], values: &[f64]) -> f64 {
        let mut sum = 0.0;
        for column in 0..starts.len().saturating_sub(1) {
            for at in starts[column]..starts[column + 1] {
                let twice = if rows[at] == column { 1.0 } else { 2.0 };
                sum += twice * values[at] * self.entry(rows[at], column).unwrap_or(0.0);
            }
        }
        sum
    }
}

/// Memory that supernodes share.
#[derive(Default)]
struct GatherMemory {
    square: Vec<f64>,
    places: Vec<usize>,
}
