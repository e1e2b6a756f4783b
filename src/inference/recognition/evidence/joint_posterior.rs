//! The surfaces of one node: the likeliest one, all others beside it, and how well the likeliest one fits.
//!
//! ```text
//! precision = [J Z]'[J Z] + D,  mean = -precision^-1 [J Z]'y        D: 1 for every column of the displacement, which it scales so
//! log likelihood = -(log det Sigma + |y + J x + Z z|^2)/2           whitened rows of positions and normals
//! ```

use faer::Mat;

use crate::dense;
use crate::recognition::discrepancy::Displacement;
use crate::recognition::equations::{Columns, Grams, column_of, first_of_displacement, joint};
use crate::recognition::noise::Factors;

use super::marginal_likelihood::Evidence;
use super::node::Node;

impl Evidence<'_> {
    /// Half the sum of squares of the normals' whitened residuals under a node's likeliest surface; `None` without normals.
    pub(crate) fn misfit_of_normals(&self, node: &Node) -> Option<f64> {
        Some(half_square(self.normals?, &self.coefficients(node)?))
    }

    /// Log likelihood of positions and normals under a node's likeliest surface, but for what the normals' errors add.
    pub(super) fn log_likelihood(&self, node: &Node, factors: &Factors) -> Option<f64> {
        let at = self.coefficients(node)?;
        let misfit = half_square(self.grams[node.kernel].as_ref()?, &at) / node.variance
            + self.normals.map_or(0.0, |gram| half_square(gram, &at));
        let log_det = dense::log_det(factors.of(node.kernel)?) + self.cells.points.len() as f64 * node.variance.ln();
        Some(-0.5 * log_det - misfit)
    }

    /// What every column of the equations is multiplied by in the residuals of a node's likeliest surface.
    pub(crate) fn coefficients(&self, node: &Node) -> Option<Vec<f64>> {
        let (y, p, first) = (column_of(node.kind), node.kind.unknowns(), first_of_displacement());
        let mut at = vec![0.0; first + self.displacement.map_or(0, Displacement::columns)];
        at[y] = 1.0;
        if node.is_displaced() {
            let (mean, _) = self.joint_posterior(node)?;
            at[y + 1..=y + p].copy_from_slice(&mean[..p]);
            at[first..].copy_from_slice(&self.weights_of(node, &mean[p..]));
        } else {
            at[y + 1..=y + p].copy_from_slice(&node.x);
        }
        Some(at)
    }

    /// Weights of all columns of the displacement, from those of a node's own columns in units of their prior.
    pub(crate) fn weights_of(&self, node: &Node, own: &[f64]) -> Vec<f64> {
        let first = first_of_displacement();
        let Columns { z: (start, _), fixed, rough, factors: [of_spline, of_natural], .. } = self.columns_of(node);
        let mut out = vec![0.0; self.displacement.map_or(0, Displacement::columns)];
        if let Some(fixed) = fixed {
            out[fixed - first] = 1.0;
        }
        for (k, (out, w)) in out[start - first..].iter_mut().zip(own).enumerate() {
            *out = w * if k < rough { of_spline } else { of_natural };
        }
        out
    }

    /// Spline coefficients of many displacements of one node, one a column: weights of the node's own columns, in units of their prior,
    /// stand below its parameters in `drawn`.
    pub(crate) fn splines_of(&self, node: &Node, drawn: &Mat<f64>) -> Option<Mat<f64>> {
        let Columns { z: (start, count), fixed, rough, factors: [of_spline, of_natural], .. } = self.columns_of(node);
        let own =
            |i: usize, k: usize| drawn[(node.kind.unknowns() + i, k)] * if i < rough { of_spline } else { of_natural };
        // a body's fixed column is the one before its others
        let ahead = usize::from(fixed.is_some());
        let weights =
            Mat::from_fn(ahead + count, drawn.ncols(), |i, k| if i < ahead { 1.0 } else { own(i - ahead, k) });
        Some(self.displacement?.coefficients_of_many(start - ahead - first_of_displacement(), &weights))
    }

    /// The equations of a node.
    fn columns_of(&self, node: &Node) -> Columns {
        self.columns(node.kind, node.departure, [(node.departure.of_spline() * node.variance).sqrt(), 1.0])
    }

    /// Posterior of parameters and displacement together under one node: its mean and the lower factor of its
    /// precision. The displacement's columns are scaled to unit prior variance.
    pub(crate) fn joint_posterior(&self, node: &Node) -> Option<(Vec<f64>, Mat<f64>)> {
        let gram = self.grams[node.kernel].as_ref()?;
        let columns = self.columns_of(node);
        let grams = Grams { positions: gram, variance: node.variance, normals: self.normals };
        let (precision, mut mean) = joint(columns, grams);
        let lower = dense::cholesky(&precision)?;
        dense::solve(&lower, &mut mean);
        Some((mean, lower))
    }
}

/// Half the square of what the columns of this Gram matrix give with these coefficients.
fn half_square(gram: &Mat<f64>, at: &[f64]) -> f64 {
    let used: Vec<usize> = (0..at.len()).filter(|&i| at[i] != 0.0).collect();
    0.5 * used.iter().map(|&i| used.iter().map(|&j| at[i] * gram[(i, j)] * at[j]).sum::<f64>()).sum::<f64>()
}
