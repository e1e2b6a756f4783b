//! `D A D = L L'` with `D = diag(A)^(-1/2)`: the equilibrated normal matrix, factored dense if it is small, else as a band
//! or by faer's sparse LLT.
//!
//! Forming `A = E'E` squares the condition; the certificate reports the digits that remain. LDL' is not used, because it
//! accepts indefinite matrices, whereas a failing pivot of LLT shows a rank below the number of unknowns.

use std::sync::Arc;

use faer::Par;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::perm::PermRef;
use faer::sparse::linalg::cholesky::{LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky};
use faer::sparse::{SparseColMat, SymbolicSparseColMat};
use faer::{Conj, MatMut, Side};

use super::SolveError;
use super::band::{BandCholesky, band_flops};
use super::factor::Factor;
use super::ordering::nested_dissection;
use super::patch::PatchCholesky;
use super::small::PackedCholesky;
use crate::linalg::{StencilMatrix, TensorShape, inverse_norm1_estimate};
use crate::work;

/// Up to this many unknowns, unless they are a patch of one cell, a packed dense factor takes less time than setting up a
/// band. Beyond it the band's panels are faster, and entries of its inverse give traces without a solve for every unknown.
pub(super) const DENSE_LIMIT: usize = 30;

/// The band does a multiply-add this many times faster than the sparse factor of a nested dissection, because it has no
/// small fronts, no indices and no symbolic step. At 4,489 unknowns (counted ratio 0.7) a whole fit with the sparse
/// factor takes a quarter longer; at 17,161 (1.8) they are equal on one thread, and the band's two ends take two.
const BAND_ADVANTAGE: f64 = 2.5;

/// Number of products of the nested dissection's top separators, which make nearly all of the work. A front of s unknowns
/// with a border of b costs `s^3/3 + s^2 b + s b^2`.
fn dissection_flops(shape: TensorShape) -> f64 {
    fn part(wide: f64, high: f64, degree: [f64; 2], border: f64) -> f64 {
        let cut_x = degree[0] * high <= degree[1] * wide;
        let (s, half) = if cut_x {
            (degree[0] * high, [(wide - degree[0]) / 2.0, high])
        } else {
            (degree[1] * wide, [wide, (high - degree[1]) / 2.0])
        };
        if half[0] < 3.0 * degree[0] || half[1] < 3.0 * degree[1] {
            let s = wide * high;
            return s * s * s / 3.0 + s * s * border + s * border * border;
        }
        let front = s * s * s / 3.0 + s * s * border + s * border * border;
        front + 2.0 * part(half[0], half[1], degree, 0.5 * border + s)
    }
    let [n, m] = shape.basis.map(|n| n as f64);
    part(n, m, shape.degree.map(|d| d as f64), 0.0)
}

/// A reusable Cholesky solver for one pattern: `factor` as often as the values change, `solve` as often as the data do.
///
/// [`Cholesky::plan`] is the symbolic factorisation of other libraries, and every further [`Cholesky::factor`] their
/// refactorisation. Symmetry cannot be violated, because a [`StencilMatrix`] stores one half.
#[derive(Clone, Debug)]
pub struct Cholesky {
    shape: TensorShape,
    scale: Vec<f64>,
    /// Column sums, for the norm.
    sums: Vec<f64>,
    norm: f64,
    smallest_pivot: f64,
    kind: Kind,
}

#[derive(Clone, Debug)]
enum Kind {
    Patch(PatchCholesky),
    Dense(PackedCholesky),
    Band(Box<BandCholesky>),
    Sparse(Box<Sparse>),
}

#[derive(Clone, Debug)]
struct Sparse {
    upper: Upper,
    /// Shared between clones: it depends on the pattern alone and never changes.
    symbolic: Arc<SymbolicCholesky<usize>>,
    factor: Vec<f64>,
}

/// The upper triangle of the equilibrated matrix, and where each entry stands in the stencil.
#[derive(Clone, Debug)]
struct Upper {
    matrix: SparseColMat<usize, f64>,
    positions: Vec<usize>,
}

impl Upper {
    fn of(matrix: &StencilMatrix) -> Upper {
        let (mut starts, mut rows, mut positions) = (vec![0], Vec::new(), Vec::new());
        let mut current = 0;
        // the lower triangle by rows is the upper triangle by columns
        matrix.for_each_lower(|row, column, position| {
            while current < row {
                starts.push(rows.len());
                current += 1;
            }
            rows.push(column);
            positions.push(position);
        });
        starts.push(rows.len());
        let order = starts.len() - 1;
        let values = vec![0.0; rows.len()];
        let pattern = SymbolicSparseColMat::new_checked(order, order, starts, None, rows);
        Upper { matrix: SparseColMat::new(pattern, values), positions }
    }
}

impl Cholesky {
    /// Plans the factorisation of every stencil matrix of this shape.
    ///
    /// # Errors
    /// [`SolveError::Memory`].
    pub fn plan(shape: TensorShape) -> Result<Cholesky, SolveError> {
        let unknowns = shape.unknowns();
        let kind = if let Some(patch) = PatchCholesky::plan(shape) {
            Kind::Patch(patch)
        } else if unknowns <= DENSE_LIMIT {
            Kind::Dense(PackedCholesky::default())
        } else if band_flops(shape) < BAND_ADVANTAGE * dissection_flops(shape) {
            Kind::Band(Box::new(BandCholesky::plan(shape)))
        } else {
            Kind::Sparse(Box::new(Sparse::plan(shape)?))
        };
        let sums = vec![0.0; unknowns];
        Ok(Cholesky { shape, scale: vec![1.0; unknowns], sums, norm: 0.0, smallest_pivot: 0.0, kind })
    }

    /// Factors `matrix`, reusing all memory.
    ///
    /// # Errors
    /// Empty columns, overflow, and pivots that are not positive, by the unknown's number.
    pub fn factor(&mut self, matrix: &StencilMatrix) -> Result<(), SolveError> {
        self.equilibrate(matrix)?;
        self.factor_equilibrated(matrix, None)
    }

    /// Factors `matrix` and solves, `v <- A^-1 v`, in the same pass, which saves a pass over the factor.
    ///
    /// # Errors
    /// As [`Cholesky::factor`].
    pub fn factor_and_solve(&mut self, matrix: &StencilMatrix, v: &mut [f64]) -> Result<(), SolveError> {
        self.equilibrate(matrix)?;
        v.iter_mut().zip(&self.scale).for_each(|(w, d)| *w *= d);
        self.factor_equilibrated(matrix, Some(v))?;
        v.iter_mut().zip(&self.scale).for_each(|(w, d)| *w *= d);
        Ok(())
    }

    fn equilibrate(&mut self, matrix: &StencilMatrix) -> Result<(), SolveError> {
        debug_assert_eq!(matrix.shape(), self.shape);
        for (unknown, scale) in self.scale.iter_mut().enumerate() {
            let diagonal = matrix.values()[matrix.position(unknown, 0, self.shape.degree[1])];
            if diagonal == 0.0 {
                return Err(SolveError::EmptyColumn { unknown });
            }
            if !diagonal.is_finite() || diagonal < 0.0 {
                return Err(SolveError::NotFinite { unknown });
            }
            *scale = 1.0 / diagonal.sqrt();
        }
        if matches!(self.kind, Kind::Patch(_)) {
            return Ok(()); // the patch's norm is computed with its factor
        }
        self.norm = matrix.norm1_scaled_with(&self.scale, &mut self.sums);
        if self.norm.is_finite() { Ok(()) } else { Err(SolveError::NotFinite { unknown: 0 }) }
    }

    fn factor_equilibrated(&mut self, matrix: &StencilMatrix, v: Option<&mut [f64]>) -> Result<(), SolveError> {
        work::add(self.multiply_adds() as usize + if v.is_some() { 2 * self.factor_entries() } else { 0 });
        let scale = &self.scale;
        match &mut self.kind {
            Kind::Patch(patch) => {
                let [pivot, norm] =
                    patch.factor(matrix, scale, v).map_err(|unknown| SolveError::NotPositiveDefinite { unknown })?;
                if !norm.is_finite() {
                    return Err(SolveError::NotFinite { unknown: 0 });
                }
                (self.smallest_pivot, self.norm) = (pivot, norm);
            }
            Kind::Dense(dense) => {
                dense.reset(matrix.order());
                matrix.for_each_lower(|row, column, position| {
                    dense.set(row, column, matrix.values()[position] * scale[row] * scale[column]);
                });
                dense.factor().map_err(|unknown| SolveError::NotPositiveDefinite { unknown })?;
                self.smallest_pivot = dense.smallest_pivot();
                if let Some(v) = v {
                    dense.solve(v);
                }
            }
            Kind::Band(band) => {
                let pivot = match v {
                    Some(v) => band.factor_and_solve(matrix, scale, v),
                    None => band.factor(matrix, scale),
                };
                self.smallest_pivot = pivot.map_err(|unknown| SolveError::NotPositiveDefinite { unknown })?;
            }
            Kind::Sparse(sparse) => {
                self.smallest_pivot = sparse.factor(matrix, scale)?;
                if let Some(v) = v {
                    sparse.solve(v);
                }
            }
        }
        Ok(())
    }

    /// `v <- A^-1 v`.
    pub fn solve(&self, v: &mut [f64]) {
        v.iter_mut().zip(&self.scale).for_each(|(w, d)| *w *= d);
        self.solve_equilibrated(v);
        v.iter_mut().zip(&self.scale).for_each(|(w, d)| *w *= d);
    }

    fn solve_equilibrated(&self, v: &mut [f64]) {
        work::add(2 * self.factor_entries());
        match &self.kind {
            Kind::Patch(patch) => patch.solve(v),
            Kind::Dense(dense) => dense.solve(v),
            Kind::Band(band) => band.solve(v),
            Kind::Sparse(sparse) => sparse.solve(v),
        }
    }

    /// Smallest squared pivot of the equilibrated factor. If it is near the unit roundoff, the rank is in doubt.
    pub fn smallest_pivot(&self) -> f64 {
        self.smallest_pivot
    }

    /// Condition of `E D` in the 1-norm: root of the estimate for `D A D`.
    pub fn condition(&self) -> f64 {
        let inverse =
            inverse_norm1_estimate(self.scale.len(), |v| self.solve_equilibrated(v), |v| self.solve_equilibrated(v));
        (self.norm * inverse).sqrt()
    }

    /// Multiply-adds of one factorisation (sparse: of the dissection's fronts).
    pub fn multiply_adds(&self) -> f64 {
        match &self.kind {
            Kind::Patch(_) | Kind::Dense(_) => (self.scale.len() as f64).powi(3) / 6.0,
            Kind::Band(_) => 0.5 * band_flops(self.shape),
            Kind::Sparse(_) => 0.5 * dissection_flops(self.shape),
        }
    }

    /// Stored entries of the factor (dense: the triangle).
    pub fn factor_entries(&self) -> usize {
        match &self.kind {
            Kind::Patch(_) | Kind::Dense(_) => self.scale.len() * (self.scale.len() + 1) / 2,
            Kind::Band(band) => band.entries(),
            Kind::Sparse(sparse) => sparse.factor.len(),
        }
    }
}

impl Factor for Cholesky {
    fn solve(&self, v: &mut [f64]) {
        Cholesky::solve(self, v);
    }

    fn condition(&self) -> f64 {
        Cholesky::condition(self)
    }

    /// Directly where the factor is a band. A must not couple the unknowns with those left out.
    fn inverse_trace(&self, b: &StencilMatrix, out: &dyn Fn(usize) -> bool) -> Option<f64> {
        let Kind::Band(band) = &self.kind else { return None };
        let scale: Vec<f64> = self.scale.iter().enumerate().map(|(u, d)| if out(u) { 0.0 } else { *d }).collect();
        Some(band.inverse_trace(b, &scale))
    }

    /// For a patch of one cell with n^3/3 multiply-adds, where solving for the columns one by one takes n^3.
    fn write_inverse(&self, out: &mut [f64]) {
        let Kind::Patch(patch) = &self.kind else { return self.write_inverse_by_solving(out) };
        patch.write_inverse(out);
        for (row, d) in out.chunks_exact_mut(self.scale.len()).zip(&self.scale) {
            row.iter_mut().zip(&self.scale).for_each(|(v, e)| *v *= d * e);
        }
    }

    /// `1 / |column|`: the equilibration D.
    fn column_scales(&self) -> Option<&[f64]> {
        Some(&self.scale)
    }
}

impl Sparse {
    fn plan(shape: TensorShape) -> Result<Sparse, SolveError> {
        let unknowns = shape.unknowns();
        let no_memory = SolveError::Memory { unknowns };
        let upper = Upper::of(&StencilMatrix::zeros(shape));
        let forward = nested_dissection(shape);
        let mut inverse = vec![0; unknowns];
        forward.iter().enumerate().for_each(|(k, &unknown)| inverse[unknown] = k);
        let permutation = PermRef::new_checked(&forward, &inverse, unknowns);
        let symbolic = factorize_symbolic_cholesky(
            upper.matrix.symbolic(),
            Side::Upper,
            SymmetricOrdering::Custom(permutation),
            Default::default(),
        )
        .map_err(|_| no_memory.clone())?;
        let factor = vec![0.0; symbolic.len_val()];
        Ok(Sparse { upper, symbolic: Arc::new(symbolic), factor })
    }

    fn factor(&mut self, matrix: &StencilMatrix, scale: &[f64]) -> Result<f64, SolveError> {
        let Upper { matrix: upper, positions } = &mut self.upper;
        let (pattern, values) = upper.parts_mut();
        let rows = pattern.row_idx();
        for column in 0..scale.len() {
            for k in pattern.col_range(column) {
                values[k] = matrix.values()[positions[k]] * scale[column] * scale[rows[k]];
            }
        }
        let scratch = self.symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| SolveError::Memory { unknowns: scale.len() })?;
        let outcome = self.symbolic.factorize_numeric_llt(
            &mut self.factor,
            upper.as_ref(),
            Side::Upper,
            Default::default(),
            Par::Seq,
            MemStack::new(&mut memory),
            Default::default(),
        );
        let failed = outcome.err();
        match failed {
            Some(error) => Err(self.failed_pivot(&error)),
            None => Ok(self.smallest_pivot()),
        }
    }

    /// faer counts permuted columns, from 1 in the simplicial and from 0 in the supernodal factor.
    fn failed_pivot(&self, error: &faer::linalg::cholesky::llt::factor::LltError) -> SolveError {
        use faer::linalg::cholesky::llt::factor::LltError;
        use faer::sparse::linalg::cholesky::SymbolicCholeskyRaw;
        let LltError::NonPositivePivot { index } = *error;
        let from = match self.symbolic.raw() {
            SymbolicCholeskyRaw::Simplicial(_) => 1,
            SymbolicCholeskyRaw::Supernodal(_) => 0,
        };
        let column = index.saturating_sub(from);
        let unknown = self.symbolic.perm().map_or(column, |p| p.arrays().0.get(column).copied().unwrap_or(column));
        SolveError::NotPositiveDefinite { unknown }
    }

    fn smallest_pivot(&self) -> f64 {
        use faer::sparse::linalg::cholesky::SymbolicCholeskyRaw;
        let mut smallest = f64::INFINITY;
        match self.symbolic.raw() {
            SymbolicCholeskyRaw::Simplicial(symbolic) => {
                for start in &symbolic.col_ptr()[..symbolic.ncols()] {
                    smallest = smallest.min(self.factor[*start]);
                }
            }
            SymbolicCholeskyRaw::Supernodal(symbolic) => {
                let llt = faer::sparse::linalg::cholesky::supernodal::SupernodalLltRef::new(symbolic, &self.factor);
                for s in 0..symbolic.n_supernodes() {
                    let block = llt.supernode(s).val();
                    for k in 0..block.ncols() {
                        smallest = smallest.min(block[(k, k)]);
                    }
                }
            }
        }
        smallest * smallest
    }

    fn solve(&self, v: &mut [f64]) {
        let scratch = self.symbolic.solve_in_place_scratch::<f64>(1, Par::Seq);
        let mut memory = MemBuffer::new(scratch);
        let llt = LltRef::new(&self.symbolic, &self.factor);
        let order = v.len();
        let rhs = MatMut::from_column_major_slice_mut(v, order, 1);
        llt.solve_in_place_with_conj(Conj::No, rhs, Par::Seq, MemStack::new(&mut memory));
    }
}
