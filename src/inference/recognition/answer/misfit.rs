//! Whether the residuals still hold a pattern, in numbers and in one sentence.
//!
//! ```text
//! r = sum over pairs d_i d_j / mean d^2 / pairs       pairs of nearest cells, each counted once
//! p = P(Z > r sqrt(pairs))                            for independent residuals
//! ```
//!
//! A correlation of neighbours in the manner of P. A. P. Moran, *Biometrika* 37 (1950) 17.

use statrs::function::erf;

use crate::recognition::Misfit;
use crate::recognition::contacts::Cells;
use palpate_geometry::neighbours::Neighbours;

/// What the sentence needs to know besides the residuals.
pub(super) struct Findings {
    /// Root mean square misfit over relief.
    pub(super) of_relief: f64,
    /// Posterior probability that neighbours share errors.
    pub(super) correlated: f64,
    /// Size of those errors over relief.
    pub(crate) tau: f64,
    /// Displacement over relief, where it was read as shape and is certain.
    pub(super) displacement: Option<f64>,
    /// Probability from which on either is spoken of.
    pub(super) certain: f64,
}

/// Tests the final residuals at the cells.
pub(super) fn misfit(cells: &Cells, residuals: &[f64], findings: &Findings) -> Misfit {
    let tree = Neighbours::new(&cells.feet);
    let nearest: Vec<Option<usize>> = (0..residuals.len()).map(|i| tree.nearest_other(i).map(|(_, j)| j)).collect();
    let counts_once = |i: usize, j: usize| nearest[j] != Some(i) || i < j;
    let (mut sum, mut pairs) = (0.0, 0.0_f64);
    for (i, j) in nearest.iter().enumerate().filter_map(|(i, j)| j.map(|j| (i, j))) {
        if counts_once(i, j) {
            sum += residuals[i] * residuals[j];
            pairs += 1.0;
        }
    }
    let square = residuals.iter().map(|d| d * d).sum::<f64>() / residuals.len().max(1) as f64;
    let neighbour_correlation = if pairs > 0.0 && square > 0.0 { (sum / pairs / square).clamp(-1.0, 1.0) } else { 0.0 };
    let p = chance(neighbour_correlation, pairs);
    Misfit { neighbour_correlation, p, percent_of_relief: 100.0 * findings.of_relief, words: words(findings, p) }
}

/// Probability of at least this correlation among so many pairs of independent residuals.
pub(super) fn chance(correlation: f64, pairs: f64) -> f64 {
    0.5 * erf::erfc(correlation * (0.5 * pairs).sqrt())
}

/// One sentence.
pub(super) fn words(findings: &Findings, p: f64) -> String {
    if let Some(size) = findings.displacement {
        return format!(
            "the surface is not of constant curvature: it departs from it by {:.1} % of its relief",
            100.0 * size
        );
    }
    if findings.correlated > findings.certain {
        return format!(
            "the misfit is patterned: neighbouring contacts share errors of {:.1} % of the relief",
            100.0 * findings.tau
        );
    }
    if p < 0.01 {
        return "neighbouring residuals are alike, more than chance allows".to_string();
    }
    "the residuals hold no pattern".to_string()
}
