//! Sums over the rows of either kind, all that a ratio of the noise sds needs to know of a fit.
//!
//! ```text
//! A_b = E_b' C^-1 E_b     E_b' C^-1 r     r' C^-1 r     log det C        b: heights, or slopes and normals
//! C = 1 for independent errors, rho^|i - j| along a finger's touches for errors that they share
//! ```

use crate::fit::linear::equations::{Equations, RowKind, data_normal_matrix, only};
use crate::fit::noise::fingers::Fingers;
use palpate_numeric::linalg::{Sites, StencilMatrix, Targets, apply_rows, normal_rhs};

/// Sums over the rows of heights and of slopes, with independent errors of equal variance in each kind.
pub(super) struct Sums {
    /// Lower halves of the normal matrices.
    pub matrices: [Vec<Vec<f64>>; 2],
    /// `E'r` for the residuals r of the fit.
    pub right: [Vec<f64>; 2],
    /// `r'r`.
    pub squares: [f64; 2],
    /// Number of rows.
    pub rows: [f64; 2],
    /// Log of the determinant of the errors' correlations.
    pub log_det: f64,
}

/// The sums of independent errors.
pub(super) fn independent(equations: &Equations, residuals: &Targets, units: [f64; 2], rows: [f64; 2]) -> Sums {
    let kinds = [RowKind::Heights, RowKind::Slopes].map(|kind| only(&equations.row_weights, kind));
    let matrices = [0, 1].map(|b| lower_bands(&data_normal_matrix(&equations.sites, &kinds[b]), units[b]));
    let right = [0, 1].map(|b| {
        let mut out = vec![0.0; equations.unknowns()];
        normal_rhs(&equations.sites, &kinds[b], residuals, &mut out);
        out.iter().map(|v| units[b] * v).collect::<Vec<f64>>()
    });
    let square = |r: &[f64; 3]| [r[0] * r[0], r[1] * r[1] + r[2] * r[2]];
    let squares = residuals.iter().map(square).fold([0.0; 2], |s, r| [s[0] + r[0], s[1] + r[1]]);
    Sums { matrices, right, squares: [0, 1].map(|b| units[b] * squares[b]), rows, log_det: 0.0 }
}

/// All rows written out, with the residual behind the unknowns.
pub(super) struct DenseRows {
    columns: usize,
    /// Heights, first and second rows of slopes.
    blocks: [Vec<f64>; 3],
}

impl DenseRows {
    pub(super) fn new(equations: &Equations, residuals: &Targets) -> DenseRows {
        let (sites, unknowns) = (equations.sites.len(), equations.unknowns());
        let columns = unknowns + 1;
        let mut blocks = [0, 1, 2].map(|_| vec![0.0; sites * columns]);
        let (mut unit, mut rows) = (vec![0.0; unknowns], Targets::new());
        for j in 0..columns {
            if j < unknowns {
                unit[j] = 1.0;
                apply_rows(&equations.sites, &equations.row_weights, &unit, &mut rows);
                unit[j] = 0.0;
            }
            let column = if j < unknowns { &rows } else { residuals };
            column.iter().enumerate().for_each(|(r, row)| (0..3).for_each(|b| blocks[b][r * columns + j] = row[b]));
        }
        DenseRows { columns, blocks }
    }

    /// The sums of rows whose errors neighbours share.
    pub(super) fn sums(&self, fingers: &Fingers, correlations: [f64; 2], units: [f64; 2], rows: [f64; 2]) -> Sums {
        let unknowns = self.columns - 1;
        let mut matrices = [0, 1].map(|_| (0..unknowns).map(|i| vec![0.0; i + 1]).collect::<Vec<Vec<f64>>>());
        let mut right = [0, 1].map(|_| vec![0.0; unknowns]);
        let mut squares = [0.0; 2];
        for (k, block) in self.blocks.iter().enumerate() {
            let b = usize::from(k > 0);
            let mut white = block.clone();
            if correlations[b] > 0.0 {
                fingers.whiten_rows(correlations[b], self.columns, &mut white);
            }
            for row in white.chunks_exact(self.columns) {
                let residual = units[b] * row[unknowns];
                squares[b] += residual * row[unknowns];
                for i in (0..unknowns).filter(|&i| row[i] != 0.0) {
                    right[b][i] += residual * row[i];
                    let scaled = units[b] * row[i];
                    (0..=i).for_each(|j| matrices[b][i][i - j] += scaled * row[j]);
                }
            }
        }
        let log_det = fingers.log_det(correlations[0]) + 2.0 * fingers.log_det(correlations[1]);
        Sums { matrices, right, squares, rows, log_det }
    }
}

/// Row i of the lower half as `[a_ii, a_i,i-1, ..]`, times `factor`.
fn lower_bands(matrix: &StencilMatrix, factor: f64) -> Vec<Vec<f64>> {
    let mut bands: Vec<Vec<f64>> = (0..matrix.order()).map(|i| vec![0.0; i + 1]).collect();
    matrix.for_each_lower(|row, column, at| bands[row][row - column] = factor * matrix.values()[at]);
    bands
}
