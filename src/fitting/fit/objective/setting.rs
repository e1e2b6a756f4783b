//! What every least squares fit of one call starts from.

use crate::fit::linear::equations::Equations;
use crate::fit::objective::budget::Budget;
use crate::fit::placing::Patch;
use crate::fit::placing::sites::DataSites;
use crate::fit::{FitError, FitOptions, Method, Smooth};
use crate::observation::{Data, Roughness, RoughnessOrder};
use palpate_numeric::linalg::Sites;

/// Data, their sites, and how their rows are solved.
pub(super) struct Setting<'a> {
    /// The data.
    pub data: &'a Data,
    /// Where they lie under the knots.
    pub sites: DataSites,
    /// Length unit of the patch.
    pub scale: f64,
    /// `lambda` and `P` of the roughness penalty.
    pub roughness: Option<Roughness>,
    /// Linear solver.
    pub method: Method,
    /// Steps that are left to all loops of the fit.
    pub budget: &'a Budget,
}

impl Setting<'_> {
    /// The setting of one fit, its method checked against the kind of data.
    ///
    /// # Errors
    /// [`FitError::Method`].
    pub(super) fn new<'a>(
        patch: &Patch,
        data: &'a Data,
        options: &FitOptions,
        budget: &'a Budget,
    ) -> Result<Setting<'a>, FitError> {
        match (options.method, data) {
            (Method::Kronecker, Data::Scattered { .. }) => {
                return Err(FitError::Method { method: "kronecker", why: "needs a complete grid" });
            }
            (Method::Pcg, Data::Scattered { .. }) => {
                return Err(FitError::Method { method: "pcg", why: "needs a grid" });
            }
            _ => {}
        }
        let sites = data.sites(patch);
        // the penalty is the same number in patch and input units: S_xx squared scales by 1/L^2, the area by L^2
        let roughness = match options.smooth {
            Smooth::Lambda(lambda) if lambda > 0.0 => {
                Some(Roughness::new(lambda, &patch.knots, RoughnessOrder::Second))
            }
            Smooth::Third(lambda) if lambda > 0.0 => Some(Roughness::new(lambda, &patch.knots, RoughnessOrder::Third)),
            Smooth::Stretched { lambda, aspect } if lambda > 0.0 => {
                Some(Roughness::stretched(lambda, &patch.knots, RoughnessOrder::Third, aspect))
            }
            _ => None,
        };
        Ok(Setting { data, sites, scale: patch.frame.scale, roughness, method: options.method, budget })
    }
}

/// Refuses fewer equations than unknowns, unless roughness makes up for them.
///
/// # Errors
/// [`FitError::NoWeight`], [`FitError::TooFew`].
pub(super) fn check_count(equations: &Equations) -> Result<(), FitError> {
    let [z, slopes] = equations.row_weights.row_counts(equations.sites.len());
    if z + slopes == 0 {
        return Err(FitError::NoWeight);
    }
    if z + slopes < equations.unknowns() && equations.roughness.is_none() {
        return Err(FitError::TooFew {
            contacts: equations.sites.len(),
            equations: z + slopes,
            unknowns: equations.unknowns(),
        });
    }
    Ok(())
}
