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
use palpate_geometry::shape::chi_square_upper_tail;
use palpate_numeric::linalg::Sites;

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

#[cfg(test)]
mod tests {
    use crate::fit::{FitOptions, NormalSigma, Objective, fit_contacts};
    use palpate_geometry::contact::Contacts;
    use palpate_numeric::draws::EffectDraws;

    /// Heights of a bowl with normals along its slopes, touched `n` x `n` times with these errors.
    fn bowl(n: usize, sds: [f64; 2], seed: u64) -> Contacts {
        let mut errors = vec![0.0; 3 * n * n];
        for (block, part) in errors.chunks_mut(48).enumerate() {
            EffectDraws::new(seed, "declared").gaussians(0, block as u64, part.len(), part);
        }
        let place = |k: usize| 2.0 * k as f64 / (n as f64 - 1.0) - 1.0;
        let (x, y): (Vec<f64>, Vec<f64>) = (0..n * n).map(|r| (place(r % n), place(r / n))).unzip();
        let z = (0..n * n).map(|r| 0.05 * (x[r] * x[r] + y[r] * y[r]) + sds[0] * errors[r]).collect();
        let [nx, ny] = [&x, &y].map(|k| k.iter().map(|k| -0.1 * k).collect::<Vec<f64>>());
        let tilted =
            |k: &[f64], from: usize| (0..n * n).map(|r| k[r] + sds[1] * errors[from + r]).collect::<Vec<f64>>();
        let (nx, ny) = (tilted(&nx, n * n), tilted(&ny, 2 * n * n));
        let vectors: Vec<[f64; 3]> = nx.iter().zip(&ny).map(|(a, b)| [*a, *b, 1.0]).collect();
        Contacts::from_positions(x, y, z).with_normal_vectors(&vectors)
    }

    /// By what factors residuals are off, where they are for certain and by more than a quarter.
    #[test]
    fn declared_sds_are_off_by_the_factor_that_they_are_wrong_by() {
        let off = |n: usize, declared: [f64; 2], seed: u64| {
            let sigma = NormalSigma::Known { z: declared[0], normal_deg: declared[1].to_degrees() };
            let options = FitOptions::default().with_objective(Objective::Normals(sigma));
            fit_contacts(&bowl(n, [0.01, 0.02], seed), &options).unwrap().declared_sigma_off()
        };
        for seed in 0..3 {
            assert_eq!(off(8, [0.01, 0.02], seed), [None; 2]);
            let [heights, normals] = off(8, [0.005, 0.02], seed);
            assert!((heights.unwrap() - 2.0).abs() < 0.5 && normals.is_none(), "{heights:?} {normals:?}");
            let [heights, normals] = off(8, [0.01, 0.04], seed);
            assert!((normals.unwrap() - 0.5).abs() < 0.1 && heights.is_none(), "{heights:?} {normals:?}");
            // a fifth is certain of 900 contacts, and changes no decision
            assert_eq!(off(30, [0.01 / 1.15, 0.02 * 1.15], seed), [None; 2]);
            let [heights, normals] = off(30, [0.01 / 1.5, 0.02 * 1.5], seed);
            assert!((heights.unwrap() - 1.5).abs() < 0.1 && (normals.unwrap() - 1.0 / 1.5).abs() < 0.05);
            // of nine contacts a half may be chance
            assert_eq!(off(3, [0.01 / 1.3, 0.02 / 1.3], seed), [None; 2]);
        }
        let weighted = fit_contacts(&bowl(8, [0.01, 0.02], 0), &FitOptions::default()).unwrap();
        assert_eq!(weighted.declared_sigma_off(), [None; 2]);
    }
}
