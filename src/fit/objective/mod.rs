//! Step 3a: which rows with which weights; each driver calls the next, and none calls back.
//!
//! ```text
//! smoothing.rs  ->  robust.rs  ->  least_squares.rs  ->  slopes.rs, linear        (Objective::Slopes)
//!                                                    ->  normals.rs, Gauss-Newton (Objective::Normals)
//! ```
//!
//! Preset weights hold in patch units, where the height residual is in units of half the domain's larger side; explicit
//! weights and sds are in input units, so their lengths are multiplied or divided by the patch's scale.

pub(super) mod fitted;
mod gauss_newton;
mod least_squares;
mod normals;
mod robust;
mod setting;
mod slopes;
mod smoothing;

use crate::fit::placing::data::Data;
use crate::fit::placing::patch::Patch;
use crate::fit::{FitError, FitOptions, Robust, Smooth};
use fitted::Fitted;

/// Forms and solves the rows, with the smoothing and the loss that the options ask for.
///
/// # Errors
/// Where the data do not suit the objective or the method, or determine no surface.
pub(super) fn fit_rows(patch: &Patch, data: &Data, options: &FitOptions) -> Result<Fitted, FitError> {
    match (options.smooth, options.robust) {
        (Smooth::Auto, _) => smoothing::fit_smoothed(patch, data, options),
        (Smooth::None | Smooth::Lambda(_), Robust::None) => least_squares::fit_plain(patch, data, options),
        (Smooth::None | Smooth::Lambda(_), Robust::Huber | Robust::Tukey) => {
            robust::fit_with_loss(patch, data, options)
        }
    }
}
