//! `P D A D P' = L L'` with `D = diag(A)^(-1/2)` and a fill-reducing order P, by faer's supernodal factorisation.
//!
//! The order and the places of the nonzeros of L depend on the pattern alone: they are planned once and kept while the knots stay.
//! Every factorisation after that is of numbers.

use std::sync::Arc;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltError;
use faer::perm::PermRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::supernodal::{SupernodalLltRef, SymbolicSupernodalCholesky};
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};

use super::nested_dissection::nested_dissection;
use crate::error::HierarchyError;
use palpate_numeric::linalg::inverse_norm1_estimate;

/// In which order unknowns are eliminated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EliminationOrder<'a> {
    /// That of approximate minimum degree (P. Amestoy, T. Davis, I. Duff, *SIAM J. Matrix Anal. Appl.* 17 (1996) 886).
    MinimumDegree,
    /// Nested dissection by the places of the unknowns.
    NestedDissection(&'a [[f64; 2]]),
}

/// A factorisation of symmetric matrices of one pattern.
#[derive(Clone, Debug)]
pub struct SparseCholesky {
    /// Upper triangle in compressed columns.
    starts: Arc<[usize]>,
    rows: Arc<[usize]>,
    symbolic: Arc<SymbolicCholesky<usize>>,
    scale: Vec<f64>,
    equilibrated: Vec<f64>,
    factor: Vec<f64>,
    norm: f64,
}

impl SparseCholesky {
    /// Plans for a pattern: column starts, and the rows of each column up to its diagonal, ascending.
    ///
    /// # Errors
    /// [`HierarchyError::Memory`].
    ///
    /// # Panics
    /// When the pattern is no upper triangle in compressed columns, or there are not as many places as columns.
    pub fn plan(starts: &[usize], rows: &[usize], by: EliminationOrder<'_>) -> Result<SparseCholesky, HierarchyError> {
        let unknowns = starts.len().saturating_sub(1);
        let pattern = SymbolicSparseColMatRef::new_checked(unknowns, unknowns, starts, None, rows);
        // one kind of factor, so that its columns are read in one way; below 0, so that one unknown without any product has it, too
        let params = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold(-1.0),
            ..CholeskySymbolicParams::default()
        };
        let order = match by {
            EliminationOrder::MinimumDegree => None,
            EliminationOrder::NestedDissection(places) => Some(nested_dissection(starts, rows, places)),
        };
        let inverse = order.as_ref().map(|order| {
            let mut inverse = vec![0; unknowns];
            order.iter().enumerate().for_each(|(k, unknown)| inverse[*unknown] = k);
            inverse
        });
        let ordering = match (&order, &inverse) {
            (Some(order), Some(inverse)) => SymmetricOrdering::Custom(PermRef::new_checked(order, inverse, unknowns)),
            _ => SymmetricOrdering::Amd,
        };
        let symbolic = factorize_symbolic_cholesky(pattern, Side::Upper, ordering, params)
            .map_err(|_| HierarchyError::Memory { unknowns })?;
        let factor = vec![0.0; symbolic.len_val()];
        Ok(SparseCholesky {
            starts: starts.into(),
            rows: rows.into(),
            symbolic: Arc::new(symbolic),
            scale: vec![1.0; unknowns],
            equilibrated: vec![0.0; rows.len()],
            factor,
            norm: 0.0,
        })
    }

    /// Factors a matrix by the values of its upper triangle.
    ///
    /// # Errors
    /// [`HierarchyError::NotPositiveDefinite`] by the function's number, [`HierarchyError::Overflow`], [`HierarchyError::Memory`].
    ///
    /// # Panics
    /// When the values are not as many as the pattern's rows.
    pub fn factor(&mut self, values: &[f64]) -> Result<(), HierarchyError> {
        let unknowns = self.scale.len();
        self.equilibrate(values)?;
        let pattern = SymbolicSparseColMatRef::new_checked(unknowns, unknowns, &self.starts, None, &self.rows);
        let matrix = SparseColMatRef::new(pattern, &self.equilibrated);
        let scratch = self.symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| HierarchyError::Memory { unknowns })?;
        let outcome = self.symbolic.factorize_numeric_llt(
            &mut self.factor,
            matrix,
            Side::Upper,
            Default::default(),
            Par::Seq,
            MemStack::new(&mut memory),
            Default::default(),
        );
        match outcome.err() {
            None => Ok(()),
            // supernodal factors count permuted columns from 0
            Some(LltError::NonPositivePivot { index }) => {
                let unknown = self.order().get(index).copied().unwrap_or(index);
                Err(HierarchyError::NotPositiveDefinite { unknown, unknowns })
            }
        }
    }

    fn equilibrate(&mut self, values: &[f64]) -> Result<(), HierarchyError> {
        let unknowns = self.scale.len();
        for column in 0..unknowns {
            let diagonal = values[self.starts[column + 1] - 1];
            if !diagonal.is_finite() {
                return Err(HierarchyError::Overflow { unknown: column });
            }
            if diagonal <= 0.0 {
                return Err(HierarchyError::NotPositiveDefinite { unknown: column, unknowns });
            }
            self.scale[column] = 1.0 / diagonal.sqrt();
        }
        let mut sums = vec![0.0; unknowns];
        for column in 0..unknowns {
            for at in self.starts[column]..self.starts[column + 1] {
                let row = self.rows[at];
                let value = values[at] * self.scale[row] * self.scale[column];
                self.equilibrated[at] = value;
                sums[column] += value.abs();
                sums[row] += if row == column { 0.0 } else { value.abs() };
            }
        }
        self.norm = sums.iter().fold(0.0, |most, sum| sum.max(most));
        let overflown = sums.iter().position(|sum| !sum.is_finite());
        overflown.map_or(Ok(()), |unknown| Err(HierarchyError::Overflow { unknown }))
    }

    /// `v <- A^-1 v`.
    pub fn solve(&self, v: &mut [f64]) {
        v.iter_mut().zip(&self.scale).for_each(|(w, d)| *w *= d);
        self.solve_equilibrated(v);
        v.iter_mut().zip(&self.scale).for_each(|(w, d)| *w *= d);
    }

    fn solve_equilibrated(&self, v: &mut [f64]) {
        let mut memory = MemBuffer::new(self.symbolic.solve_in_place_scratch::<f64>(1, Par::Seq));
        let count = v.len();
        let rhs = MatMut::from_column_major_slice_mut(v, count, 1);
        let llt = LltRef::new(&self.symbolic, &self.factor);
        llt.solve_in_place_with_conj(Conj::No, rhs, Par::Seq, MemStack::new(&mut memory));
    }

    /// `log det A`.
    pub fn log_determinant(&self) -> f64 {
        let Some((symbolic, llt)) = self.supernodal() else { return f64::NAN };
        let mut sum = -self.scale.iter().map(|d| d.ln()).sum::<f64>();
        for s in 0..symbolic.n_supernodes() {
            let block = llt.supernode(s).val();
            (0..block.ncols()).for_each(|k| sum += block[(k, k)].ln());
        }
        2.0 * sum
    }

    /// Condition in the 1-norm of the equilibrated matrix, an estimate.
    pub fn condition(&self) -> f64 {
        let solve = |v: &mut [f64]| self.solve_equilibrated(v);
        self.norm * inverse_norm1_estimate(self.scale.len(), solve, solve)
    }

    /// Stored numbers of L, zeros inside of supernodes included.
    pub fn factor_entries(&self) -> usize {
        self.factor.len()
    }

    /// Multiply-adds of a factorisation: `sum over columns of (entries below)^2 / 2`.
    pub fn multiply_adds(&self) -> f64 {
        let Some((symbolic, _)) = self.supernodal() else { return 0.0 };
        let mut sum = 0.0;
        for s in 0..symbolic.n_supernodes() {
            let columns = symbolic.supernode_end()[s] - symbolic.supernode_begin()[s];
            let below = symbolic.supernode(s).pattern().len();
            sum += (0..columns).map(|k| ((columns - k + below) as f64).powi(2)).sum::<f64>();
        }
        0.5 * sum
    }

    /// Elimination order: entry k is the unknown eliminated k-th.
    pub(super) fn order(&self) -> Vec<usize> {
        self.symbolic.perm().map_or_else(|| (0..self.scale.len()).collect(), |perm| perm.arrays().0.to_vec())
    }

    pub(super) fn scale(&self) -> &[f64] {
        &self.scale
    }

    pub(super) fn supernodal(&self) -> Option<(&SymbolicSupernodalCholesky<usize>, SupernodalLltRef<'_, usize, f64>)> {
        match self.symbolic.raw() {
            SymbolicCholeskyRaw::Supernodal(symbolic) => {
                Some((symbolic, SupernodalLltRef::new(symbolic, &self.factor)))
            }
            SymbolicCholeskyRaw::Simplicial(_) => None,
        }
    }
}
