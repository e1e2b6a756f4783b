//! Step 3a: which rows with which weights. A plain fit chooses between two kinds of rows; what is asked for beyond it repeats
//! plain fits, which it is handed as a function.
//!
//! ```text
//! fit_plain:  slopes.rs, linear         (Objective::Slopes)
//!             normals.rs, Gauss-Newton  (Objective::Normals)
//! repeated by:  errors_in_variables.rs (x and y)  ->  smoothing.rs (lambda)  ->  robust.rs (weights)  ->  fit_plain
//! ```
//!
//! Preset weights hold in patch units, where the height residual is in units of half the domain's larger side; explicit
//! weights and sds are in input units, so their lengths are multiplied or divided by the patch's scale.

pub(super) mod budget;
mod contraction;
mod errors_in_variables;
mod extrapolation;
pub(super) mod fitted;
mod gauss_newton;
mod normals;
pub(super) mod robust;
mod setting;
mod slopes;
mod smoothing;

use crate::fit::notes::Note;
use crate::fit::placing::Patch;
use crate::fit::{FitError, FitOptions, NormalSigma, Objective, Robust, SlopeWeights, Smooth};
use crate::observation::Data;
use budget::Budget;
use fitted::Fitted;
use normals::fit_normals;
use setting::Setting;
use slopes::fit_slopes;

/// A plain least squares fit, as smoothing and losses repeat it.
type PlainFit = fn(&Patch, &Data, &FitOptions, &Budget, Course) -> Result<Fitted, FitError>;

/// How far a plain fit is taken.
#[derive(Clone, Copy, Debug)]
enum Course<'a> {
    /// To the answer: its steps become rounding, and what they leave is bounded.
    Answer,
    /// From the coefficients of one like it, to where a loop that repeats it can go on.
    From(&'a [f64]),
}

/// Forms and solves the rows, with the smoothing and the loss that the options ask for.
///
/// # Errors
/// Where the data do not suit the objective or the method, or determine no surface.
pub(super) fn fit_rows(patch: &Patch, data: &Data, options: &FitOptions) -> Result<Fitted, FitError> {
    let budget = Budget::new(options.steps);
    let fit_at = |data: &Data| fit_in_place(patch, data, options, &budget);
    let fitted = if options.sigma_xy > 0.0 {
        errors_in_variables::fit_located(patch, data, options.sigma_xy, &budget, fit_at)?
    } else {
        fit_at(data)?
    };
    budget.judged(fitted)
}

/// The same for contacts that lie where they are said to lie.
fn fit_in_place(patch: &Patch, data: &Data, options: &FitOptions, budget: &Budget) -> Result<Fitted, FitError> {
    match (options.smooth, options.robust) {
        (Smooth::Auto, _) => smoothing::fit_smoothed(patch, data, options, (fit_plain, budget)),
        (_, Robust::None) => fit_plain(patch, data, options, budget, Course::Answer),
        (_, Robust::Huber | Robust::Tukey) => robust::fit_with_loss(patch, data, options, (fit_plain, budget)),
    }
}

/// The rows that the data and the options call for.
enum Rows {
    Slopes(SlopeWeights),
    Normals(NormalSigma),
}

/// One plain least squares fit.
///
/// # Errors
/// Where the data do not suit the objective or the method, or determine no surface.
fn fit_plain(
    patch: &Patch,
    data: &Data,
    options: &FitOptions,
    budget: &Budget,
    course: Course,
) -> Result<Fitted, FitError> {
    let setting = Setting::new(patch, data, options, budget)?;
    let mut fitted = match choose_rows(data, options)? {
        Rows::Normals(sigma) => fit_normals(&setting, sigma, course)?,
        Rows::Slopes(weights) => {
            data.check_slopes()?;
            fit_slopes(&setting, weights, course)?
        }
    };
    if !patch.frame.keeps_axes() {
        fitted.notes.push(Note::Rotated);
    }
    if !fitted.solution.unsupported.is_empty() {
        fitted.notes.push(Note::Unsupported { coefficients: fitted.solution.unsupported.len() });
    }
    Ok(fitted)
}

fn choose_rows(data: &Data, options: &FitOptions) -> Result<Rows, FitError> {
    let rows = match options.objective {
        Objective::Auto if data.has_normals() => Rows::Normals(NormalSigma::Auto),
        Objective::Auto => Rows::Slopes(SlopeWeights::Auto),
        Objective::Slopes(weights) => Rows::Slopes(weights),
        Objective::Normals(sigma) => Rows::Normals(sigma),
    };
    if matches!(rows, Rows::Normals(_)) && !data.has_orientation() {
        return Err(FitError::Objective { objective: "sigma", needed: "normals or slopes" });
    }
    Ok(rows)
}
