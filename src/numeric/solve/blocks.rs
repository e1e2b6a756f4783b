//! `D (A + mu diag A) D = L L'` for a matrix of 3 x 3 blocks: dense if it is small, else by faer's sparse LLT with an AMD
//! ordering.
//!
//! `mu` is the damping of a Levenberg-Marquardt step, 0 for the plain matrix; D equilibrates the diagonal.

use std::sync::Arc;

use faer::Par;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::cholesky::{LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky};
use faer::sparse::{SparseColMat, SymbolicSparseColMat};
use faer::{Conj, MatMut, Side};

use super::SolveError;
use crate::linalg::{BlockMatrix, inverse_norm1_estimate, partial_dots};
use crate::simd::{Isa, factor_dense};
use crate::work;

/// Up to this many unknowns the dense factor is faster: its 4.5 million multiply-adds take as long as a symbolic step.
const DENSE_LIMIT: usize = 300;

/// A reusable Cholesky solver for matrices of one block pattern.
#[derive(Clone, Debug)]
pub struct BlockCholesky {
    scale: Vec<f64>,
    sums: Vec<f64>,
    norm: f64,
    kind: Kind,
}

#[derive(Clone, Debug)]
enum Kind {
    Dense(Dense),
    Sparse(Box<Sparse>),
}

/// Columns of L, padded to whole sets of lanes.
#[derive(Clone, Debug)]
struct Dense {
    stride: usize,
    columns: Vec<f64>,
}

#[derive(Clone, Debug)]
struct Sparse {
    /// The upper triangle of the equilibrated matrix.
    matrix: SparseColMat<usize, f64>,
    /// Shared between clones: it depends on the pattern alone and never changes.
    symbolic: Arc<SymbolicCholesky<usize>>,
    factor: Vec<f64>,
}

impl BlockCholesky {
    /// Plans the factorisation of every matrix with the pattern of `matrix`.
    ///
    /// # Errors
    /// [`SolveError::Memory`].
    pub fn plan(matrix: &BlockMatrix) -> Result<BlockCholesky, SolveError> {
        let order = matrix.order();
        let kind = if order <= DENSE_LIMIT {
            let stride = order.next_multiple_of(8);
            Kind::Dense(Dense { stride, columns: vec![0.0; order * stride] })
        } else {
            Kind::Sparse(Box::new(Sparse::plan(matrix)?))
        };
        Ok(BlockCholesky { scale: vec![1.0; order], sums: vec![0.0; order], norm: 0.0, kind })
    }

    /// Factors `matrix + damping diag(matrix)`, reusing all memory.
    ///
    /// # Errors
    /// Empty columns, overflow, and pivots that are not positive.
    pub fn factor(&mut self, matrix: &BlockMatrix, damping: f64) -> Result<(), SolveError> {
        for (unknown, (scale, diagonal)) in self.scale.iter_mut().zip(matrix.diagonal()).enumerate() {
            if diagonal == 0.0 {
                return Err(SolveError::EmptyColumn { unknown });
            }
            if !diagonal.is_finite() || diagonal < 0.0 {
                return Err(SolveError::NotFinite { unknown });
            }
            *scale = 1.0 / diagonal.sqrt();
        }
        let (scale, sums) = (&self.scale, &mut self.sums);
        sums.fill(0.0);
        let (values, stride) = match &mut self.kind {
            Kind::Dense(dense) => {
                // blocks of basis functions that do not overlap stay zero
                dense.columns.fill(0.0);
                (dense.columns.as_mut_slice(), Some(dense.stride))
            }
            Kind::Sparse(sparse) => (sparse.matrix.parts_mut().1, None),
        };
        let mut next = 0;
        for_each_lower(matrix, |row, column, value| {
            let scaled = if row == column { 1.0 + damping } else { value * scale[row] * scale[column] };
            values[stride.map_or(next, |stride| column * stride + row)] = scaled;
            next += 1;
            sums[row] += scaled.abs();
            if row != column {
                sums[column] += scaled.abs();
            }
        });
        self.norm = sums.iter().copied().fold(0.0, f64::max);
        if !self.norm.is_finite() {
            return Err(SolveError::NotFinite { unknown: 0 });
        }
        work::add(self.multiply_adds());
        match &mut self.kind {
            Kind::Dense(dense) => factor_dense(Isa::active(), scale.len(), dense.stride, &mut dense.columns)
                .map(|_| ())
                .map_err(|unknown| SolveError::NotPositiveDefinite { unknown }),
            Kind::Sparse(sparse) => sparse.factor(),
        }
    }

    /// `v <- A^-1 v`.
    pub fn solve(&self, v: &mut [f64]) {
        v.iter_mut().zip(&self.scale).for_each(|(w, d)| *w *= d);
        self.solve_equilibrated(v);
        v.iter_mut().zip(&self.scale).for_each(|(w, d)| *w *= d);
    }

    /// Multiply-adds of one factorisation; of a sparse one as if its columns were equally long, which is less than there are.
    fn multiply_adds(&self) -> usize {
        match &self.kind {
            Kind::Dense(_) => self.scale.len().pow(3) / 6,
            Kind::Sparse(sparse) => sparse.factor.len().pow(2) / (2 * self.scale.len().max(1)),
        }
    }

    fn solve_equilibrated(&self, v: &mut [f64]) {
        work::add(match &self.kind {
            Kind::Dense(_) => v.len() * v.len(),
            Kind::Sparse(sparse) => 2 * sparse.factor.len(),
        });
        match &self.kind {
            Kind::Dense(dense) => dense.solve(v),
            Kind::Sparse(sparse) => sparse.solve(v),
        }
    }

    /// Condition of the equilibrated rows in the 1-norm: root of the estimate for the normal matrix.
    pub fn condition(&self) -> f64 {
        let solve = |v: &mut [f64]| self.solve_equilibrated(v);
        (self.norm * inverse_norm1_estimate(self.scale.len(), solve, solve)).sqrt()
    }
}

/// Entries of the lower triangle in the order of a compressed row form: row after row, columns ascending.
fn for_each_lower(matrix: &BlockMatrix, mut visit: impl FnMut(usize, usize, f64)) {
    for row in 0..matrix.coefficients() {
        let (columns, blocks) = matrix.row(row);
        for a in 0..3 {
            for (column, block) in columns.iter().zip(blocks) {
                let width = if *column == row { a + 1 } else { 3 };
                (0..width).for_each(|b| visit(3 * row + a, 3 * column + b, block[a][b]));
            }
        }
    }
}

impl Dense {
    fn solve(&self, v: &mut [f64]) {
        let n = v.len();
        for k in 0..n {
            let column = &self.columns[k * self.stride..k * self.stride + n];
            let value = v[k] / column[k];
            v[k] = value;
            v[k + 1..].iter_mut().zip(&column[k + 1..]).for_each(|(w, l)| *w -= value * l);
        }
        for k in (0..n).rev() {
            let column = &self.columns[k * self.stride..k * self.stride + n];
            v[k] = (v[k] - dot(&column[k + 1..], &v[k + 1..])) / column[k];
        }
    }
}

/// `a . b` in four independent sums.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (sums, rest) = partial_dots::<4>(a, b);
    (sums[0] + sums[2]) + (sums[1] + sums[3]) + rest
}

impl Sparse {
    fn plan(matrix: &BlockMatrix) -> Result<Sparse, SolveError> {
        let unknowns = matrix.order();
        let (mut starts, mut rows) = (vec![0], Vec::new());
        // the lower triangle by rows is the upper triangle by columns
        for_each_lower(matrix, |row, column, _| {
            if starts.len() <= row {
                starts.push(rows.len());
            }
            rows.push(column);
        });
        starts.push(rows.len());
        let count = rows.len();
        let pattern = SymbolicSparseColMat::new_checked(unknowns, unknowns, starts, None, rows);
        let symbolic =
            factorize_symbolic_cholesky(pattern.as_ref(), Side::Upper, SymmetricOrdering::Amd, Default::default())
                .map_err(|_| SolveError::Memory { unknowns })?;
        let (matrix, factor) = (SparseColMat::new(pattern, vec![0.0; count]), vec![0.0; symbolic.len_val()]);
        Ok(Sparse { matrix, symbolic: Arc::new(symbolic), factor })
    }

    /// Factors the matrix.
    fn factor(&mut self) -> Result<(), SolveError> {
        let unknowns = self.matrix.ncols();
        let scratch = self.symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| SolveError::Memory { unknowns })?;
        self.symbolic
            .factorize_numeric_llt(
                &mut self.factor,
                self.matrix.as_ref(),
                Side::Upper,
                Default::default(),
                Par::Seq,
                MemStack::new(&mut memory),
                Default::default(),
            )
            .map(|_| ())
            .map_err(|_| SolveError::NotPositiveDefinite { unknown: 0 })
    }

    fn solve(&self, v: &mut [f64]) {
        let scratch = self.symbolic.solve_in_place_scratch::<f64>(1, Par::Seq);
        let mut memory = MemBuffer::new(scratch);
        let order = v.len();
        let rhs = MatMut::from_column_major_slice_mut(v, order, 1);
        LltRef::new(&self.symbolic, &self.factor).solve_in_place_with_conj(
            Conj::No,
            rhs,
            Par::Seq,
            MemStack::new(&mut memory),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::MapShape;

    #[test]
    fn dense_and_sparse_factors_solve_the_same_closed_system() {
        for free in [[6, 5], [13, 11]] {
            let shape = MapShape { free, degree: [2, 2], closed: [true, false] };
            let mut matrix = BlockMatrix::zeros(shape);
            let mut pairs = Vec::new();
            matrix.for_each(|row, column, _| pairs.push((row, column)));
            for (row, column) in pairs {
                let wave = |a: usize, b: usize| ((3 * row + a + 3 * column + b) as f64).sin();
                let mut block = [0, 1, 2].map(|a| [0, 1, 2].map(|b| wave(a, b)));
                if row == column {
                    (0..3).for_each(|a| block[a][a] += 90.0);
                }
                matrix.add(row, column, &block);
            }
            let mut factor = BlockCholesky::plan(&matrix).unwrap();
            factor.factor(&matrix, 0.0).unwrap();
            let truth: Vec<f64> = (0..matrix.order()).map(|k| (k as f64).cos()).collect();
            let mut v = vec![0.0; matrix.order()];
            matrix.multiply(&truth, &mut v);
            factor.solve(&mut v);
            assert!(v.iter().zip(&truth).all(|(a, b)| (a - b).abs() < 1e-12));
            assert!(factor.condition() >= 1.0 && factor.condition() < 10.0);
        }
    }
}
