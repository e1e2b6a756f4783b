//! What the intervals of a named height field count, in words that somebody can act on.
//!
//! ```text
//! R 0.1018, 95 % interval 0.1018 to 0.1071: noise 1.2e-6, model 0.0027; a cylinder explains the contacts too ...
//! ```

use palpate_fitting::fit::{Fit, ModelReading, Reading, Statistic};
use palpate_geometry::curvature::ShapeClass;

use super::percent::percent;
use super::table::significant;

/// What a user can do about the kind of surface.
const REMEDY: &str =
    "explains the contacts too and would differ; palpate fit without a named model chooses between such surfaces";

/// The notes on intervals.
pub(super) fn interval_words(fit: &Fit) -> Vec<String> {
    let found = &fit.shape().curvedness;
    if found.mean.is_some() && found.u.is_none() {
        let (measured, unknowns) = (fit.equations().count(), fit.solution().rank);
        return vec![format!(
            "no intervals: {measured} measurements for {unknowns} unknowns leave nothing to tell noise from; \
             declare --sigma, or take more contacts"
        )];
    }
    // that a plane has no other curvature than noise is said by its interval
    if fit.shape().class == ShapeClass::Plane {
        return Vec::new();
    }
    match fit.model_reading() {
        ModelReading::NotAsked => Vec::new(),
        ModelReading::Unknown { why } => vec![format!("the intervals count noise alone: {why}")],
        ModelReading::Found(other) => beyond_noise(fit, other),
    }
}

/// S and R whose intervals another kind of surface widens beyond noise.
fn beyond_noise(fit: &Fit, other: &Reading) -> Vec<String> {
    let both = [("S", &fit.shape().shape_index), ("R", &fit.shape().curvedness)];
    let found: Vec<String> = both.iter().filter_map(|(name, found)| parts(name, found, fit.options().level)).collect();
    if found.is_empty() {
        return found;
    }
    let shared = other.shared.map(|[sd, length]| {
        let [sd, length] = [sd, length].map(|v| significant(v, 2));
        format!(
            "neighbouring contacts share errors of {sd} over a distance of {length}: they count as fewer, \
             in the model part of the intervals"
        )
    });
    std::iter::once(format!("{}; {} {REMEDY}", found.join("; "), other.name)).chain(shared).collect()
}

fn parts(name: &str, found: &Statistic, level: f64) -> Option<String> {
    let (mean, interval, noise) = (found.mean?, found.interval?, found.u_noise?);
    let model = found.u_model.filter(|model| *model > noise)?;
    let [mean, lo, hi] = [mean, interval.lo, interval.hi].map(|v| significant(v, 4));
    let [noise, model] = [noise, model].map(|v| significant(v, 2));
    let level = percent(level);
    Some(format!("{name} {mean}, {level} interval {lo} to {hi}: noise {noise}, model {model}"))
}
