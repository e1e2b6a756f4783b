//! Slope rows: linear least squares of heights and slopes (the paper's Eq. 14).
//!
//! ```text
//! minimise  |wz (z - S)|^2 + |wx (zx - S_x)|^2 + |wy (zy - S_y)|^2 + lambda c'Pc
//! ```

use crate::fit::linear;
use crate::fit::linear::equations::Equations;
use crate::fit::noise::components::{Estimate, Trial, TrialRequest, variance_components};
use crate::fit::noise::record::{NoiseRecord, sds_of_weights};
use crate::fit::noise::sds::{NoiseSds, NoiseSource};
use crate::fit::notes::Note;
use crate::fit::objective::Course;
use crate::fit::objective::fitted::{Fitted, Iteration};
use crate::fit::objective::setting::{Setting, check_count};
use crate::fit::{FitError, SlopeWeights};
use palpate_numeric::linalg::{RowWeights, SiteWeights, Sites};

/// Weights beyond this (or below its inverse) have squares near overflow (or underflow).
const EXTREME: f64 = 1e100;

/// Fits heights and slopes under these weights.
///
/// # Errors
/// Where the rows are too few or determine no surface.
pub(super) fn fit_slopes(setting: &Setting, weights: SlopeWeights, course: Course) -> Result<Fitted, FitError> {
    let mut notes = Vec::new();
    let (trial, noise) = if weights == SlopeWeights::Auto && setting.data.has_orientation() {
        let (trial, noise, note) = fit_estimated(setting)?;
        notes.extend(note);
        (trial, noise)
    } else {
        fit_weighted(setting, weights, course)?
    };
    let [heights, _] = trial.equations.row_weights.row_counts(setting.sites.len());
    if heights == 0 {
        notes.push(Note::SlopesOnly);
    }
    Ok(Fitted {
        equations: trial.equations,
        solution: trial.solution,
        noise,
        notes,
        iteration: Iteration::NONE,
        loss_weights: None,
        moved: None,
    })
}

/// `--weights auto`: the inverse noise sds, estimated with the fit.
fn fit_estimated(setting: &Setting) -> Result<(Trial, NoiseRecord, Option<Note>), FitError> {
    let at = |TrialRequest { sds, .. }: TrialRequest| {
        trial(setting, [1.0 / sds.z, 1.0 / sds.slope, 1.0 / sds.slope], Course::Answer).map(|(trial, _)| trial)
    };
    let Estimate { sds, trial, note, dof, .. } = variance_components(setting.budget, at)?;
    let weights = [1.0 / (sds.z * setting.scale), 1.0 / sds.slope, 1.0 / sds.slope];
    let counts = trial.equations.row_weights.row_counts(setting.sites.len());
    let sds = sds_of_weights(SlopeWeights::Auto, weights, 1.0, [1.0, 1.0], counts);
    let noise = NoiseRecord::Known(NoiseSds { source: NoiseSource::Estimated, dof, ..sds });
    Ok((trial, noise, note))
}

/// Given weights; the noise sds follow from the residuals.
fn fit_weighted(setting: &Setting, word: SlopeWeights, course: Course) -> Result<(Trial, NoiseRecord), FitError> {
    let patch_weights = in_patch_units(word, setting.scale);
    let (trial, unit) = trial(setting, patch_weights, course)?;
    let weights = [patch_weights[0] / setting.scale, patch_weights[1], patch_weights[2]];
    let noise = NoiseRecord::Weighted { word, weights, unit, squares: trial.squares };
    Ok((trial, noise))
}

/// One linear fit under weights in patch units, and the power of two that they were multiplied by.
fn trial(setting: &Setting, weights: [f64; 3], course: Course) -> Result<(Trial, f64), FitError> {
    let (mut row_weights, mut targets) = setting.data.slope_rows(weights);
    let unit = power_towards_one(&row_weights);
    if unit != 1.0 {
        (row_weights, targets) = setting.data.slope_rows(weights.map(|w| w * unit));
    }
    let roughness = setting.roughness.as_ref().map(|rough| rough.weighing(rough.lambda * unit * unit));
    let equations = Equations::new(setting.sites.clone(), row_weights, targets, roughness);
    check_count(&equations)?;
    let solution = match course {
        Course::Answer => linear::solve(&equations, setting.method)?,
        Course::From(_) => linear::solve_intermediate(&equations, setting.method)?,
    };
    setting.budget.take(&equations, &solution);
    let squares = equations.residual_squares(&solution.coefficients);
    Ok((Trial { equations, solution, squares, moved: 0.0, steps: 0 }, unit))
}

/// `[wz, wx, wy]` in patch units: presets as they are, explicit ones with the height's length.
fn in_patch_units(weights: SlopeWeights, scale: f64) -> [f64; 3] {
    match weights {
        SlopeWeights::Auto | SlopeWeights::Equal => [1.0, 1.0, 1.0],
        SlopeWeights::Tangent => [1.0, 10.0, 10.0],
        SlopeWeights::Position => [10.0, 1.0, 1.0],
        SlopeWeights::Explicit([z, x, y]) => [z * scale, x, y],
    }
}

/// The power of two that brings the largest of extreme weights near one, and 1 for all other weights, whose bits it must
/// not change. A factor common to all weights changes no coefficient.
fn power_towards_one(row_weights: &RowWeights) -> f64 {
    let of = |m: &SiteWeights| m.z.abs().max(m.a.abs()).max(m.d.abs());
    let largest = match row_weights {
        RowWeights::Uniform(m) => of(m),
        RowWeights::PerSite(all) => all.iter().fold(0.0_f64, |most, m| most.max(of(m))),
    };
    if largest == 0.0 || !largest.is_finite() || (1.0 / EXTREME..EXTREME).contains(&largest) {
        1.0
    } else {
        (-largest.log2().round()).exp2()
    }
}
