//! Which path a scene's replicates take, and why.
//!
//! ```text
//! sites stand still?  rows linear with known weights?      yes, yes: one factor     no, yes: small fits     no: whole fits
//! ```

use std::fmt;

use super::fixed_sites::ROW_NOISE;
use super::problem::{Problem, Rows};
use palpate_fitting::fit::{FitOptions, NormalSigma, Objective, Robust, SlopeWeights, Smooth, SurfaceKind};
use palpate_numeric::draws::NoiseLaw;
use palpate_world::scene::Simulator;

/// Which of the paths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Path {
    /// One factor for all replicates, rows linear as they are.
    FixedSites,
    /// One factor, normal rows linearised at the nominal surface.
    Linearised,
    /// One small fit with a known pattern each.
    Refit,
    /// One whole fit each.
    Whole,
}

impl Path {
    /// The word on the command line and in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Path::FixedSites => "fixed sites",
            Path::Linearised => "fixed sites, linearised",
            Path::Refit => "refit",
            Path::Whole => "whole fits",
        }
    }

    /// Replicates between two reports: a tenth of a second's work or so.
    pub fn chunk(self) -> u64 {
        match self {
            Path::FixedSites | Path::Linearised => 1 << 17,
            Path::Refit => 1 << 14,
            // an interrupt in the middle of a chunk loses it, and a whole fit may take seconds
            Path::Whole => 1 << 5,
        }
    }
}

impl fmt::Display for Path {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// What the scene calls for, before the nominal fit is looked at.
pub(super) fn choose(simulator: &Simulator, options: &FitOptions) -> (Path, String) {
    let whole = |why: &str| (Path::Whole, why.to_string());
    if options.surface != SurfaceKind::Height {
        return whole("the surface is parametric, or may be");
    }
    if options.robust != Robust::None {
        return whole("a robust loss weights every replicate's contacts anew");
    }
    if options.sigma_xy > 0.0 {
        return whole("errors in x and y move every replicate's contacts");
    }
    if options.smooth == Smooth::Auto {
        return whole("the smoothing is found with every fit");
    }
    let normals = match options.objective {
        Objective::Slopes(SlopeWeights::Auto) => return whole("the weights are found with every fit"),
        Objective::Auto | Objective::Normals(NormalSigma::Auto) => {
            return whole("the noise levels are found with every fit");
        }
        Objective::Slopes(_) => false,
        Objective::Normals(NormalSigma::Known { .. }) => true,
    };
    match (moving(simulator), normals) {
        (None, false) => {
            (Path::FixedSites, "no effect moves a site or loses a reading, and slope rows are linear".into())
        }
        (None, true) => (
            Path::Linearised,
            "no effect moves a site or loses a reading; normal rows are linearised at the nominal surface".into(),
        ),
        (Some(stage), false) => (Path::Refit, format!("{stage} moves sites or loses readings; slope rows are linear")),
        (Some(stage), true) => {
            (Path::Whole, format!("{stage} moves sites or loses readings, and normal rows take Gauss-Newton steps"))
        }
    }
}

/// The first stage by which sites differ between replicates.
fn moving(simulator: &Simulator) -> Option<&'static str> {
    let mut random = false;
    for stage in simulator.stages() {
        let own = stage.draws_per_contact() > 0;
        if !stage.keeps_sites() && (own || random) {
            return Some(stage.name());
        }
        random |= own;
    }
    None
}

/// Sds of z and slopes, where row noise of the normal law is the only effect and the rows are slopes.
pub(super) fn row_noise(simulator: &Simulator, problem: &Problem) -> Option<[f64; 2]> {
    let [stage] = simulator.stages() else { return None };
    let plain = stage.name() == ROW_NOISE && simulator.laws() == [NoiseLaw::Normal];
    let slopes = matches!(problem.rows(), Rows::Slopes(_));
    stage.row_sds().filter(|_| plain && slopes)
}
