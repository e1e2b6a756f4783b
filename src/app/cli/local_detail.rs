//! Small features on a free surface that many contacts show: an adaptive surface takes the place of a smooth one.
//!
//! ```text
//! N ln(s_smooth / s_adaptive) > (f / 2) ln N       s root mean square residuals of N contacts, f degrees of freedom of the adaptive surface
//! ```
//!
//! The criterion is G. Schwarz's (*Ann. Stat.* 6 (1978) 461). It takes errors for independent, and a sensor whose neighbouring errors are
//! alike would pass: such errors are everywhere, features are not. So small cells have to cover less than half of the patch.

use crate::report::Answer;
use palpate_fitting::fit::FitOptions;
use palpate_fitting::parametric::FittedSurface;
use palpate_geometry::contact::Contacts;
use palpate_hierarchical::adaptive::{AdaptiveFit, AdaptiveOptions, DetailRule, fit_adaptive};
use palpate_hierarchical::field::HierarchicalField;
use palpate_inference::recognition::{Hypothesis, Recognition};

/// Whether a surface is of no simple form and stands level over x and y, so that an adaptive one can say more.
pub(super) fn is_free_form(smooth: &Answer) -> bool {
    match smooth {
        Answer::Recognised(found) => {
            found.hypothesis == Hypothesis::Displaced && found.frame.axes[2][2].abs() >= DetailRule::default().level
        }
        Answer::Fitted(FittedSurface::Height(fit)) => fit.frame().keeps_axes(),
        _ => false,
    }
}

/// The adaptive surface that says more of the contacts than `smooth`, a free form, does, where there is one.
pub(super) fn local_detail(contacts: &Contacts, smooth: &Answer, options: &FitOptions) -> Option<AdaptiveFit> {
    let rule = DetailRule::default();
    if contacts.len() < rule.fewest_contacts {
        return None;
    }
    let scatter = match smooth {
        Answer::Recognised(found) => residuals_of(found, contacts),
        Answer::Fitted(FittedSurface::Height(fit)) => fit.rms().z?,
        _ => return None,
    };
    let domain = options.domain.map(|[x0, x1, y0, y1]| [[x0, x1], [y0, y1]]);
    let fit = fit_adaptive(contacts, &AdaptiveOptions { domain, ..AdaptiveOptions::default() }).ok()?;
    let (report, count) = (fit.report(), contacts.len() as f64);
    let gain = count * (scatter / report.rms).ln();
    let local = (0.0..rule.most_covered).contains(&covered(fit.field())) && report.rounds.len() > 1;
    (local && gain > 0.5 * report.freedom? * count.ln()).then_some(fit)
}

/// Root mean square distance of the contacts that belong to a surface.
fn residuals_of(found: &Recognition, contacts: &Contacts) -> f64 {
    let belonging = found.belonging(contacts);
    (belonging.iter().map(|(d, _)| d * d).sum::<f64>() / belonging.len().max(1) as f64).sqrt()
}

/// Share of the domain in cells that were split.
fn covered(field: &HierarchicalField) -> f64 {
    let mesh = field.space().mesh();
    let [n, m] = mesh.tree().base();
    let whole = field.space().leaves().iter().filter(|cell| cell.level == 0).count();
    1.0 - whole as f64 / (n * m) as f64
}
