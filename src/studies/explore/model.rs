//! The splines by which touches are planned: a height field as rich as the contacts were found to be.
//!
//! ```text
//! simple   degree 2, one segment         what two constant curvatures look like over a patch
//! rich     degree 3, one segment         where the recognition needs more than that, and for comparing models
//! ```
//!
//! S and R are not taken from these fits. They say how a touch at a place would change what is known, where the recognition does not:
//! for `variance` and `probe-model`, and for how far noise could still be brought down.

use palpate_fitting::fit::{Fit, FitOptions, FrameChoice, NormalSigma, Objective, fit_contacts};
use palpate_geometry::contact::Contacts;
use palpate_inference::recognition::{Hypothesis, Recognition};

/// Least sds for planning: of a height as a share of the patch's size, of a normal in degrees. A world without noise
/// would leave nothing to plan for.
const LEAST_HEIGHT: f64 = 1e-7;
const LEAST_NORMAL_DEG: f64 = 1e-4;

/// Normals that are not believed count as good as this, in degrees: next to nothing.
const UNKNOWN_NORMAL_DEG: f64 = 30.0;

/// The fit for planning; `None` where the contacts are too few for it.
pub fn planning_fit(contacts: &Contacts, found: Option<&Recognition>) -> Option<Fit> {
    let departs = |h: Hypothesis| matches!(h, Hypothesis::Displaced | Hypothesis::Quadric | Hypothesis::Torus);
    let rich = found.is_some_and(|found| departs(found.hypothesis));
    rich.then(|| fit_of(contacts, found, 3)).flatten().or_else(|| fit_of(contacts, found, 2))
}

/// Sds of a touch's height, in units of the input, and of its normal, degrees, as the recognition found them.
pub(super) fn touch_sds(found: &Recognition) -> [f64; 2] {
    let height = found.noise.sd_z.max(LEAST_HEIGHT * found.frame.scale);
    [height, found.noise.sd_normal_deg.unwrap_or(UNKNOWN_NORMAL_DEG).max(LEAST_NORMAL_DEG)]
}

/// A fit of one segment with the noise that the recognition found.
pub(super) fn fit_of(contacts: &Contacts, found: Option<&Recognition>, degree: usize) -> Option<Fit> {
    let sigma = found.map_or(NormalSigma::Auto, |found| {
        let [z, normal_deg] = touch_sds(found);
        NormalSigma::Known { z, normal_deg }
    });
    let options = FitOptions::default()
        .with_degree(degree)
        .with_frame(FrameChoice::Keep)
        .with_objective(Objective::Normals(sigma));
    fit_contacts(contacts, &options).ok().filter(|fit| fit.solution().unsupported.is_empty())
}
