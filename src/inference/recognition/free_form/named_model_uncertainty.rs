//! What the kind of surface adds to the uncertainty of a named fit: the same contacts recognised, over the same points.
//!
//! ```text
//! named         mean +- k u_noise       right where the true surface is of the kind that was named
//! recognised    [lo, hi]                plane, sphere, cylinder, general, paraboloid, displaced, weighed by their evidence
//! richer        [lo, hi]                height fields of higher degree, where they explain the contacts significantly better
//! total         the hull of all         u_model from how far it reaches beyond noise
//! ```
//!
//! A paraboloid bends less at its edges than the ball or cylinder that was touched, and its residuals need not show that.
//! The kinds that are recognised do not have this bias in common.

use crate::bodies::Tuning;
use crate::recognition::{Recognition, RecognitionError, RecognitionOptions};
use palpate_fitting::fit::{Fit, ModelReading, Reading, richer_reading};
use palpate_numeric::vector::Vector;

/// Contacts that are recognised at most. More would narrow a reading that is dominated by the kind of surface, and
/// would take longer than the fit.
const MOST_CONTACTS: usize = 5_000;

/// Points of the shape grid each way over which the recognised surface is averaged at most.
const MOST_POINTS: usize = 16;

impl Recognition {
    /// A fit of a named model whose intervals of S and R count that the surface may be of another kind: `u`, intervals and
    /// class probabilities of the fit's shape then cover what [`Recognition::of`] says of the same contacts over
    /// the same points. Means, spreads, curvatures and the surface stay as they are.
    ///
    /// ```
    /// # use palpate_inference::facade as palpate;
    /// use palpate::recognition::Recognition;
    /// use palpate::{Contacts, FitOptions, fit_contacts};
    ///
    /// // a ridge of radius 6 along y: a biquadratic height field makes R too small, whatever the noise
    /// let (x, y): (Vec<f64>, Vec<f64>) = (0..36).map(|r| ((r % 6) as f64 - 2.5, (r / 6) as f64 - 2.5)).unzip();
    /// let z = x.iter().map(|x| (36.0 - x * x).sqrt() - 6.0).collect();
    /// let fit = fit_contacts(&Contacts::from_positions(x, y, z), &FitOptions::default())?;
    /// let fit = Recognition::beside(fit);
    /// let interval = fit.shape().curvedness.interval.unwrap();
    /// let truth = 1.0 / (6.0 * 2.0_f64.sqrt());
    /// assert!(interval.lo < truth && truth < interval.hi);
    /// # Ok::<(), palpate::fit::FitError>(())
    /// ```
    pub fn beside(fit: Fit) -> Fit {
        let recognised = match read(&fit) {
            Ok(found) => found,
            Err(error) => ModelReading::Unknown { why: error.to_string() },
        };
        let reading = match (richer_reading(&fit), recognised) {
            (Some(richer), ModelReading::Found(simple)) => ModelReading::Found(richer.or(simple)),
            (Some(richer), _) => ModelReading::Found(richer),
            (None, recognised) => recognised,
        };
        fit.with_model_reading(reading)
    }
}

fn read(fit: &Fit) -> Result<ModelReading, RecognitionError> {
    let unknown = |why: &str| Ok(ModelReading::Unknown { why: why.into() });
    let Some(contacts) = fit.contacts_in_patch(MOST_CONTACTS) else {
        return unknown("there are no heights from which another surface could be told");
    };
    let places: Vec<Vector> = fit.shape_places(MOST_POINTS);
    if places.is_empty() {
        return unknown("the contacts support no point of the grid");
    }
    let options = RecognitionOptions {
        level: fit.options().level,
        grid: [2, 2],
        up: Some([0.0, 0.0, 1.0]),
        sigma_xy: fit.options().sigma_xy / fit.frame().scale,
        ..RecognitionOptions::default()
    };
    let found = Recognition::over(&contacts, &places, &options)?;
    // errors in x and y blur a patch, and that leaves a slight pattern below much noise
    let is_unsaid = pattern_of_relief(&found) > 100.0 * options.tuning.unsaid_of_relief;
    if is_unsaid && leaves_much_unsaid(&found, &options.tuning) {
        return unknown("the contacts show no simple shape");
    }
    if found.frame.rotate_back([0.0, 0.0, 1.0])[2] < 0.0 {
        return unknown("the normals show another free side than the fit has");
    }
    Ok(ModelReading::Found(Reading { seed: Some(options.seed), ..reading(&found, fit.frame().scale) }))
}

/// The intervals in input units; curvatures in the patch are larger by its length.
fn reading(found: &Recognition, scale: f64) -> Reading {
    Reading {
        name: found.hypothesis.described(),
        shape_index: found.shape_index.map(|s| s.interval),
        curvedness: found.curvedness.interval.map(|r| r / scale),
        shared: found.noise.correlation_length.map(|length| [found.noise.sd_correlated * scale, length * scale]),
        seed: None,
        classes: found.class_probability.clone(),
    }
}

/// Whether much of the relief has a pattern that the simple shape leaves unsaid.
pub(crate) fn leaves_much_unsaid(found: &Recognition, tuning: &Tuning) -> bool {
    found.misfit.percent_of_relief > 100.0 * tuning.unsaid_of_relief && found.misfit.p < tuning.pattern_by_chance
}

/// Root mean square of what neighbouring residuals share, in percent of the relief: their correlation is its part of the square.
fn pattern_of_relief(found: &Recognition) -> f64 {
    found.misfit.percent_of_relief * found.misfit.neighbour_correlation.max(0.0).sqrt()
}
