//! Normal rows: the maximum likelihood fit of heights and unit normals.
//!
//! ```text
//! minimise  sum ((z - S)/Z)^2 + |n - n^(S_x, S_y)|^2 / sigma^2,      Z, sigma declared or estimated with the fit
//! ```

use std::cell::RefCell;

use crate::fit::noise::components::{CONVERGED, Estimate, Trial, TrialRequest, variance_components};
use crate::fit::noise::record::NoiseRecord;
use crate::fit::noise::sds::{NoiseSds, NoiseSource, RowSds};
use crate::fit::notes::Note;
use crate::fit::objective::Course;
use crate::fit::objective::fitted::{Fitted, Iteration};
use crate::fit::objective::gauss_newton::{AT_ROUNDING, Minimum, NormalProblem};
use crate::fit::objective::setting::{Setting, check_count};
use crate::fit::{FitError, NormalSigma};
use palpate_numeric::linalg::Sites;

/// A move of this share of the largest coefficient ends a fit that a loop repeats: it changes a weight by less than the loop asks for.
const BETWEEN: f64 = 1e-8;

/// Fits heights and normals with these noise sds.
///
/// # Errors
/// Where a normal points down, the rows are too few, or Gauss-Newton does not converge.
pub(super) fn fit_normals(setting: &Setting, sigma: NormalSigma, course: Course) -> Result<Fitted, FitError> {
    setting.data.check_normals()?;
    let measured = setting.data.measured();
    let spare = RefCell::new(None);
    let at = |sds: RowSds| NormalProblem {
        spare: &spare,
        sites: &setting.sites,
        measured: &measured,
        sds,
        roughness: setting.roughness.clone(),
        method: setting.method,
        budget: setting.budget,
    };
    let any_sds = RowSds { z: 1.0, slope: 1.0 };
    let first = at(any_sds).linearised(&vec![0.0; setting.sites.shape().unknowns()]);
    check_count(&first)?;
    spare.replace(Some(first));
    let trial_at = |request: TrialRequest| trial(&at(request.sds), request);
    let (Estimate { sds, trial, steps, note, dof }, source) = match sigma {
        NormalSigma::Known { z, normal_deg } => {
            let sds = RowSds { z: z / setting.scale, slope: normal_deg.to_radians() };
            let (start, tolerance) = match course {
                Course::Answer => (None, CONVERGED),
                Course::From(start) => (Some(start), BETWEEN),
            };
            let trial = trial_at(TrialRequest { sds, start, tolerance })?;
            let steps = trial.steps;
            (Estimate { sds, trial, steps, note: None, dof: [f64::INFINITY; 2] }, NoiseSource::Sigma)
        }
        NormalSigma::Auto => (variance_components(setting.budget, trial_at)?, NoiseSource::Estimated),
    };
    let Trial { equations, solution, .. } = trial;
    let problem = at(sds);
    let found = Minimum { equations, solution, steps, moved: 0.0, step: Vec::new() };
    let (found, iteration) = match course {
        Course::From(_) => (found, Iteration::NONE),
        Course::Answer => {
            let polished = problem.polish(found)?;
            let iteration = problem.iteration(&polished);
            (polished, iteration)
        }
    };
    let Minimum { equations, solution, steps, moved, .. } = found;
    let mut notes = Vec::from_iter(note);
    if measured.z_weight.iter().all(|w| *w == 0.0) {
        notes.push(Note::SlopesOnly);
    }
    notes.push(Note::GaussNewton { steps });
    if moved > AT_ROUNDING {
        notes.push(Note::NotAtRest { moved });
    }
    let noise = NoiseSds {
        source,
        weights: None,
        sigma_z: Some(sds.z * setting.scale),
        sigma_normal_deg: Some(sds.slope.to_degrees()),
        sigma_slope: None,
        row_variances: [1.0, 1.0],
        dof,
        efficiency: 1.0,
    };
    let noise = NoiseRecord::Known(noise);
    Ok(Fitted { equations, solution, noise, notes, iteration, loss_weights: None, moved: None })
}

fn trial(problem: &NormalProblem, request: TrialRequest) -> Result<Trial, FitError> {
    let Minimum { equations, solution, steps, moved, .. } = problem.minimise(request.start, request.tolerance)?;
    let squares = problem.squares(&solution.coefficients);
    Ok(Trial { equations, solution, squares, moved, steps })
}
