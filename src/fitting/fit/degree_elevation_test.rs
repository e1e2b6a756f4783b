//! What a height field of higher degree says of the same points, where the contacts call for one.
//!
//! ```text
//! F = [(rss(p) - rss(p + 2)) / (unknowns(p + 2) - unknowns(p))] / [rss(p + 2) / (rows - unknowns(p + 2))]
//! ```
//!
//! Both sums of squares are taken under the noise that the richer field finds, and under the weights that a robust loss gives
//! it. While F rejects the poorer field at 1 %, the degree is raised, twice at most: a degree of 8 follows the sensor's errors
//! at the edges. The step is 2, because over a patch that is touched evenly an odd degree adds next to nothing to means.

use std::borrow::Cow;

use crate::fit::{
    Fit, FitOptions, FrameChoice, NormalSigma, Note, Objective, Reading, Robust, SlopeWeights, fit_contacts,
};
use palpate_geometry::contact::{ContactWeights, Contacts, Orientation};
use palpate_geometry::shape::{Interval, f_upper_tail};

/// Contacts that are fitted at most. A richer field of 49 unknowns over 5,000 contacts with normals took longer than most fits.
const MOST_CONTACTS: usize = 1_000;
/// Points of the shape grid each way.
const MOST_POINTS: usize = 16;
/// Significance at which the poorer field is rejected.
const SIGNIFICANCE: f64 = 0.01;
/// How often the degree is raised.
const RAISES: usize = 2;
/// Rows for every unknown of the richer field.
const ROWS_PER_UNKNOWN: usize = 2;
const HIGHEST_DEGREE: usize = 9;

/// S and R by the richest field that the contacts call for; `None` where they call for none richer than the fit.
pub fn richer_reading(fit: &Fit) -> Option<Reading> {
    let contacts = fit.contacts_in_patch(MOST_CONTACTS)?;
    let options = fit.options();
    let knots = &fit.patch().knots;
    let base = FitOptions {
        degree: [0, 1].map(|k| knots[k].degree()),
        segments: [0, 1].map(|k| knots[k].n_segments()),
        grid: options.grid.map(|n| n.min(MOST_POINTS)),
        inset: options.inset,
        robust: options.robust,
        sigma_xy: options.sigma_xy / fit.frame().scale,
        level: options.level,
        steps: options.steps,
        frame: Some(FrameChoice::Keep),
        ..FitOptions::default()
    };
    let mut richest: Option<Fit> = None;
    let mut degree = base.degree;
    for _ in 0..RAISES {
        let Some(next) = called_for(&contacts, &base, degree) else { break };
        degree = next.options().degree;
        richest = Some(next);
    }
    reading(&richest?, fit.frame().scale)
}

/// The field of the next degree, where it explains the contacts significantly better.
fn called_for(contacts: &Contacts, base: &FitOptions, degree: [usize; 2]) -> Option<Fit> {
    let raised = degree.map(|p| p + 2);
    if raised.iter().any(|p| *p > HIGHEST_DEGREE) {
        return None;
    }
    let richer = fit_contacts(contacts, &FitOptions { degree: raised, ..base.clone() }).ok()?;
    // what had not settled says nothing of the poorer field
    let settled = !richer.notes().iter().any(|note| matches!(note, Note::StepsSpent { .. }));
    let (rows, unknowns) = (richer.equations().count(), richer.equations().unknowns());
    if !settled || richer.solution().rank < unknowns || rows < ROWS_PER_UNKNOWN * unknowns {
        return None;
    }
    let objective = same_noise(&richer, contacts);
    let poorer = FitOptions { degree, objective, robust: Robust::None, ..base.clone() };
    let poorer = fit_contacts(&weighed(contacts, &richer), &poorer).ok()?;
    (improvement(&poorer, &richer) < SIGNIFICANCE).then_some(richer)
}

/// The contacts with the weights that a robust loss gave them in a fit.
fn weighed<'a>(contacts: &'a Contacts, fit: &Fit) -> Cow<'a, Contacts> {
    let Some([heights, slopes]) = fit.loss_weights() else { return Cow::Borrowed(contacts) };
    let weights = ContactWeights { z: Some(heights.clone()), x: Some(slopes.clone()), y: Some(slopes.clone()) };
    Cow::Owned(Contacts { weights, ..contacts.clone() })
}

/// The rows of a fit with the noise that it found declared, in the units of the contacts.
fn same_noise(fit: &Fit, contacts: &Contacts) -> Objective {
    let noise = fit.noise();
    let has_normals = matches!(contacts.orientation, Orientation::Normals { .. });
    match (noise.sigma_z, noise.sigma_normal_deg, noise.sigma_slope) {
        (Some(z), Some(normal_deg), _) if has_normals => Objective::Normals(NormalSigma::Known { z, normal_deg }),
        (Some(z), _, Some(slope)) if z > 0.0 && slope > 0.0 => {
            Objective::Slopes(SlopeWeights::Explicit([1.0 / z, 1.0 / slope, 1.0 / slope]))
        }
        _ => Objective::Auto,
    }
}

/// p-value of the poorer field against the richer one.
fn improvement(poorer: &Fit, richer: &Fit) -> f64 {
    let squares = |fit: &Fit| fit.equations().residual_squares(&fit.solution().coefficients).iter().sum::<f64>();
    let rows = richer.equations().count() as f64;
    let [few, many] = [poorer, richer].map(|fit| fit.solution().rank as f64);
    let (rise, rest) = ((squares(poorer) - squares(richer)).max(0.0), squares(richer) / (rows - many));
    f_upper_tail(rise / (many - few) / rest, many - few, rows - many)
}

fn reading(fit: &Fit, scale: f64) -> Option<Reading> {
    let shape = fit.shape();
    let interval = |found: Interval| [found.lo, found.hi];
    Some(Reading {
        name: "a height field of higher degree",
        shape_index: shape.shape_index.interval.map(interval),
        curvedness: interval(shape.curvedness.interval?).map(|r| r / scale),
        shared: None,
        seed: None,
        classes: shape.class_probability.clone(),
    })
}
