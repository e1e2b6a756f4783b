//! What one scene's line of a coverage table and its part of the document hold.
//!
//! ```text
//! error of S: value - truth        error of R: (value - truth)/truth
//! ```

use serde::Serialize;

use palpate_numeric::statistics::{Rank, quantile};
use palpate_studies::montecarlo::{Coverages, Held};

use super::study_plan::Plan;

/// Errors of one quantity.
#[derive(Serialize)]
pub(super) struct ErrorPart {
    pub(super) median: Option<f64>,
    /// What the size of nine errors in ten does not exceed.
    pub(super) of_90_percent: Option<f64>,
}

impl ErrorPart {
    pub(super) fn new(all: Vec<f64>) -> ErrorPart {
        let sizes = all.iter().map(|e| e.abs()).collect();
        ErrorPart { median: reached(all, 0.5), of_90_percent: reached(sizes, 0.9) }
    }
}

/// The smallest value that a part `p` of the values does not exceed.
fn reached(values: Vec<f64>, p: f64) -> Option<f64> {
    quantile(values, p, Rank::Reached)
}

#[derive(Serialize)]
pub(super) struct HeldPart {
    pub(super) share: Option<f64>,
    pub(super) interval: Option<[f64; 2]>,
    pub(super) asked: u64,
}

#[derive(Serialize)]
pub(super) struct QuantityCoverage {
    pub(super) linear: HeldPart,
    pub(super) monte_carlo: HeldPart,
    pub(super) named: HeldPart,
    pub(super) named_half_width: Option<f64>,
    pub(super) chosen: HeldPart,
    pub(super) chosen_width: Option<f64>,
    pub(super) chosen_half_width: Option<f64>,
    /// Errors of the values in whose intervals `chosen` looks for the truth; those of R are relative.
    pub(super) chosen_error: ErrorPart,
    pub(super) bias_over_sd: Option<f64>,
    pub(super) u_over_sd: Option<f64>,
}

#[derive(Serialize)]
pub(super) struct SceneCoverage {
    pub(super) scene: String,
    pub(super) path: String,
    pub(super) fitted: u64,
    pub(super) failed: u64,
    pub(super) planes: u64,
    /// Mean probability given to the reported class, and the share in which it is the true one.
    pub(super) class_forecast: Option<[f64; 2]>,
    #[serde(rename = "S")]
    pub(super) shape_index: QuantityCoverage,
    #[serde(rename = "R")]
    pub(super) curvedness: QuantityCoverage,
}

impl HeldPart {
    pub(super) fn new(held: &Held) -> HeldPart {
        HeldPart { share: held.share(), interval: held.interval.map(|i| [i.lo, i.hi]), asked: held.asked }
    }

    pub(super) fn words(&self) -> String {
        match (self.share, self.interval) {
            (Some(share), Some([lo, hi])) => {
                format!("{:.1} [{:.1}, {:.1}]", 100.0 * share, 100.0 * lo, 100.0 * hi)
            }
            _ => "-".into(),
        }
    }
}

impl SceneCoverage {
    pub(super) fn new(plan: &Plan, found: &Coverages) -> SceneCoverage {
        let part = |q: usize| QuantityCoverage {
            linear: HeldPart::new(&found.linear[q]),
            monte_carlo: HeldPart::new(&found.monte_carlo[q]),
            named: HeldPart::new(&found.named[q]),
            named_half_width: found.named_half_width[q],
            chosen: HeldPart::new(&found.chosen[q]),
            chosen_width: found.chosen_width[q],
            chosen_half_width: found.chosen_half_width[q],
            chosen_error: ErrorPart::new(found.chosen_errors[q].clone()),
            bias_over_sd: found.bias[q],
            u_over_sd: found.u_ratio[q],
        };
        SceneCoverage {
            scene: plan.name.clone(),
            path: plan.study.engine().path().name().into(),
            fitted: found.fitted,
            failed: found.failed,
            planes: found.planes,
            class_forecast: found.class_forecast,
            shape_index: part(0),
            curvedness: part(1),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_values_of_the_sample() {
        let values: Vec<f64> = (1..=10).rev().map(f64::from).collect();
        assert_eq!((reached(values.clone(), 0.5), reached(values, 0.9)), (Some(5.0), Some(9.0)));
        assert_eq!((reached(vec![3.0], 0.9), reached(Vec::new(), 0.5)), (Some(3.0), None));
    }
}
