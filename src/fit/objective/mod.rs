//! Step 3a: which rows with which weights; each driver calls the next, and none calls back.
//!
//! ```text
//! located.rs (errors in x and y)
//!     |
//! smoothing.rs  ->  robust.rs  ->  least_squares.rs  ->  slopes.rs, linear        (Objective::Slopes)
//!                                                    ->  normals.rs, Gauss-Newton (Objective::Normals)
//! ```
//!
//! Preset weights hold in patch units, where the height residual is in units of half the domain's larger side; explicit
//! weights and sds are in input units, so their lengths are multiplied or divided by the patch's scale.

pub(super) mod fitted;
mod gauss_newton;
mod least_squares;
mod located;
mod normals;
pub(super) mod robust;
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
    let fit_at = |data: &Data| fit_in_place(patch, data, options);
    if options.sigma_xy > 0.0 { located::fit_located(patch, data, options.sigma_xy, fit_at) } else { fit_at(data) }
}

/// The same for contacts that lie where they are said to lie.
fn fit_in_place(patch: &Patch, data: &Data, options: &FitOptions) -> Result<Fitted, FitError> {
    match (options.smooth, options.robust) {
        (Smooth::Auto, _) => smoothing::fit_smoothed(patch, data, options),
        (Smooth::None | Smooth::Lambda(_), Robust::None) => least_squares::fit_plain(patch, data, options),
        (Smooth::None | Smooth::Lambda(_), Robust::Huber | Robust::Tukey) => {
            robust::fit_with_loss(patch, data, options)
        }
    }
}
