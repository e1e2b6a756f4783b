//! Whether declared noise sds agree with the residuals.
//!
//! ```text
//! factor_b^2 = |weighted residuals of kind b|^2 / nu_b,   nu_b = rows_b - trace H_b       chi-square/nu where the sd is right
//! ```
//!
//! A factor above 1 may have another cause than noise: a surface that bends too little leaves larger residuals. The
//! message therefore names both causes.

use crate::fit::noise::sds::NoiseSource;
use crate::fit::noise::traces::hat_traces;
use crate::fit::solved::Solved;
use crate::linalg::Sites;
use crate::shape::chi_square_upper_tail;

/// Probability below which a difference is reported.
const CHANCE: f64 = 1e-3;

/// A factor closer to 1 than this changes no decision, however certain it is.
const SMALL: f64 = 1.25;

/// How far the residuals of heights and of normals are from the declared sds: `Some` where they differ for certain.
pub(crate) fn declared_off(solved: &Solved) -> [Option<f64>; 2] {
    let fitted = &solved.fitted;
    let equations = &fitted.equations;
    if solved.noise().source != NoiseSource::Sigma {
        return [None; 2];
    }
    let squares = equations.residual_squares(&fitted.solution.coefficients);
    let rows = equations.row_weights.row_counts(equations.sites.len()).map(|r| r as f64);
    let traces = hat_traces(equations, &fitted.solution);
    [0, 1].map(|b| {
        let freedom = rows[b] - traces[b];
        if freedom < 1.0 {
            return None;
        }
        let factor = (squares[b] / freedom).sqrt();
        let above = chi_square_upper_tail(squares[b], freedom);
        let off = !(CHANCE..=1.0 - CHANCE).contains(&above);
        (off && !(1.0 / SMALL..=SMALL).contains(&factor)).then_some(factor)
    })
}
