//! One plain least squares fit: the objective chosen, its rows formed and solved.

use crate::fit::notes::Note;
use crate::fit::objective::fitted::Fitted;
use crate::fit::objective::normals::fit_normals;
use crate::fit::objective::setting::Setting;
use crate::fit::objective::slopes::fit_slopes;
use crate::fit::placing::data::Data;
use crate::fit::placing::patch::Patch;
use crate::fit::{FitError, FitOptions, NormalSigma, Objective, SlopeWeights};

/// The rows that the data and the options call for.
enum Rows {
    Slopes(SlopeWeights),
    Normals(NormalSigma),
}

/// One plain least squares fit.
///
/// # Errors
/// Where the data do not suit the objective or the method, or determine no surface.
pub(super) fn fit_plain(patch: &Patch, data: &Data, options: &FitOptions) -> Result<Fitted, FitError> {
    let setting = Setting::new(patch, data, options)?;
    let mut fitted = match choose_rows(data, options)? {
        Rows::Normals(sigma) => fit_normals(&setting, sigma)?,
        Rows::Slopes(weights) => {
            data.check_slopes()?;
            fit_slopes(&setting, weights)?
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
