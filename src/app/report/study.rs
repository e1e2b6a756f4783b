//! `palpate.study/1`: what a study says, as a document.
//!
//! ```text
//! Summary, LinearLaw, Attribution -> StudyDocument -> JSON (report/json.rs), or a table (report/study_table.rs)
//! ```

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

use super::document::Shares;
use super::table::significant;
use palpate_geometry::curvature::ShapeClass;
use palpate_studies::montecarlo::{Attribution, LinearLaw, Share, StudyResult, Summary};

/// Schema name.
pub(crate) const STUDY_SCHEMA: &str = "palpate.study/1";

/// Standard errors.
#[derive(Clone, Debug, Default, Serialize, JsonSchema)]
pub(crate) struct StandardErrors {
    /// Of the mean.
    pub mean: Option<f64>,
    /// Of the lower end.
    pub lo: Option<f64>,
    /// Of the upper end.
    pub hi: Option<f64>,
    /// Of the shortest interval's ends.
    pub shortest: Option<[f64; 2]>,
}

/// One quantity.
#[derive(Clone, Debug, Default, Serialize, JsonSchema)]
pub(crate) struct QuantityPart {
    /// Mean over the replicates.
    pub mean: Option<f64>,
    /// Sample sd.
    pub sd: Option<f64>,
    /// Mean less truth.
    pub bias: Option<f64>,
    /// Truth, where the surface has one.
    pub truth: Option<f64>,
    /// Value without noise.
    pub nominal: Option<f64>,
    /// Lower end of the probabilistically symmetric interval.
    pub lo: Option<f64>,
    /// Its upper end.
    pub hi: Option<f64>,
    /// Shortest interval.
    pub shortest: Option<[f64; 2]>,
    /// How far all that is converged.
    pub standard_error: StandardErrors,
    /// Quantiles asked for.
    pub quantiles: Vec<QuantilePart>,
    /// Replicates in which it is undefined.
    pub undefined: u64,
    /// The replicates count so many times over at the lower and the upper end, by the control; null: once.
    pub control: Option<[f64; 2]>,
    /// Width of the bins at the ends; 0: every value was kept.
    pub resolution: f64,
}

/// One quantile.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub(crate) struct QuantilePart {
    /// Share.
    pub share: f64,
    /// Value.
    pub value: f64,
    /// Its standard error.
    pub standard_error: f64,
}

/// The linear law of one quantity.
#[derive(Clone, Debug, Default, Serialize, JsonSchema)]
pub(crate) struct LinearQuantity {
    /// Standard uncertainty.
    pub sd: Option<f64>,
    /// Lower end.
    pub lo: Option<f64>,
    /// Upper end.
    pub hi: Option<f64>,
    /// It agrees with the Monte Carlo.
    pub valid: bool,
}

/// The linear law.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub(crate) struct LinearDocument {
    /// Of S.
    #[serde(rename = "S")]
    pub shape_index: LinearQuantity,
    /// Of R.
    #[serde(rename = "R")]
    pub curvedness: LinearQuantity,
    /// Both agree.
    pub valid: bool,
    /// Why, or why not.
    pub why: String,
}

/// One effect's shares of the variance.
#[derive(Clone, Debug, Default, Serialize, JsonSchema)]
#[allow(non_snake_case, reason = "keys of the document")]
pub(crate) struct EffectPart {
    /// Its name.
    pub name: String,
    /// First-order share of the variance of S.
    pub share_S: Option<f64>,
    /// Of R.
    pub share_R: Option<f64>,
    /// Its interval.
    pub interval_S: Option<[f64; 2]>,
    /// Its interval.
    pub interval_R: Option<[f64; 2]>,
    /// First-order share: what the effect brings alone.
    pub first_S: Option<f64>,
    /// Of R.
    pub first_R: Option<f64>,
    /// Its interval.
    pub first_interval_S: Option<[f64; 2]>,
    /// Its interval.
    pub first_interval_R: Option<[f64; 2]>,
    /// Total share: with all that it brings together with others.
    pub total_S: Option<f64>,
    /// Of R.
    pub total_R: Option<f64>,
    /// Its interval.
    pub total_interval_S: Option<[f64; 2]>,
    /// Its interval.
    pub total_interval_R: Option<[f64; 2]>,
    /// Sd of S with this effect alone.
    pub alone_S: Option<f64>,
    /// Of R.
    pub alone_R: Option<f64>,
    /// Share of S by the linear law.
    pub linear_S: Option<f64>,
    /// Of R.
    pub linear_R: Option<f64>,
}

/// Quantities beside S and R, by name.
#[derive(Clone, Debug, Default)]
pub(crate) struct NamedQuantities(pub Vec<(String, QuantityPart)>);

impl Serialize for NamedQuantities {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(name, part)| (name, part)))
    }
}

/// The whole document.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub(crate) struct StudyDocument {
    /// `palpate.study/1`.
    pub schema: &'static str,
    /// Name of the scene.
    pub scene: String,
    /// Seed.
    pub seed: u64,
    /// Hash of the scene and its options.
    pub scene_hash: String,
    /// Version of the program.
    pub build: String,
    /// Instruction set of the kernels.
    pub isa: String,
    /// First replicate and one past the last.
    pub range: [u64; 2],
    /// Replicates.
    pub replicates: u64,
    /// Why no more.
    pub stopped: String,
    /// Level of the intervals.
    pub level: f64,
    /// The path to S and R.
    pub path: String,
    /// Why that path.
    pub path_why: String,
    /// S.
    #[serde(rename = "S")]
    pub shape_index: QuantityPart,
    /// R.
    #[serde(rename = "R")]
    pub curvedness: QuantityPart,
    /// Others that were asked for.
    #[schemars(with = "BTreeMap<String, QuantityPart>")]
    pub quantities: NamedQuantities,
    /// Shares of the classes; those without a class under `none`.
    #[schemars(extend("required" = ShapeClass::CURVED.map(ShapeClass::name)))]
    pub class: Shares,
    /// The class that reaches the level; null: none does.
    pub verdict: Option<String>,
    /// Replicates whose fit failed.
    pub failed: u64,
    /// Replicates that a whole fit could not tell from a plane.
    pub planes: u64,
    /// The linear law beside it.
    pub linear: LinearDocument,
    /// Shares of the effects.
    pub effects: Vec<EffectPart>,
    /// Replicates of each design that the shares come from.
    pub effects_replicates: u64,
    /// Sums of the first-order shares of S and of R, with intervals.
    pub effects_sum: Vec<SumPart>,
    /// Remarks.
    pub notes: Vec<String>,
    /// Seconds of the replicates.
    pub seconds: f64,
    /// Replicates per second.
    pub replicates_per_second: Option<f64>,
}

/// A sum of shares.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub(crate) struct SumPart {
    /// Of which quantity.
    pub quantity: String,
    /// The sum.
    pub sum: Option<f64>,
    /// Its interval.
    pub interval: Option<[f64; 2]>,
}

impl From<&Summary> for QuantityPart {
    fn from(summary: &Summary) -> QuantityPart {
        let (symmetric, shortest) = (summary.symmetric, summary.shortest);
        QuantityPart {
            mean: summary.mean,
            sd: summary.sd,
            bias: summary.bias,
            truth: summary.truth,
            nominal: summary.nominal,
            lo: symmetric.map(|c| c.interval.lo),
            hi: symmetric.map(|c| c.interval.hi),
            shortest: shortest.map(|c| [c.interval.lo, c.interval.hi]),
            standard_error: StandardErrors {
                mean: summary.standard_error,
                lo: symmetric.map(|c| c.standard_error[0]),
                hi: symmetric.map(|c| c.standard_error[1]),
                shortest: shortest.map(|c| c.standard_error),
            },
            quantiles: summary
                .quantiles
                .iter()
                .map(|[share, value, standard_error]| QuantilePart {
                    share: *share,
                    value: *value,
                    standard_error: *standard_error,
                })
                .collect(),
            undefined: summary.undefined,
            control: summary.control.map(|beta| beta.map(|beta| 1.0 / (1.0 - beta * beta).max(f64::EPSILON))),
            resolution: summary.resolution,
        }
    }
}

impl From<&LinearLaw> for LinearDocument {
    fn from(law: &LinearLaw) -> LinearDocument {
        let part = |q: usize| LinearQuantity {
            sd: law.sd[q],
            lo: law.interval[q].map(|i| i.lo),
            hi: law.interval[q].map(|i| i.hi),
            valid: law.valid_parts[q],
        };
        LinearDocument { shape_index: part(0), curvedness: part(1), valid: law.valid(), why: law.why.clone() }
    }
}

fn ends(share: &Share) -> Option<[f64; 2]> {
    share.interval.map(|i| [i.lo, i.hi])
}

/// Shares of the effects, those of the scene that are off among them.
pub(crate) fn effect_parts(attribution: &Attribution, off: &[&str]) -> Vec<EffectPart> {
    let on = attribution.effects.iter().map(|effect| EffectPart {
        name: effect.name.clone(),
        share_S: effect.share[0].share,
        share_R: effect.share[1].share,
        interval_S: ends(&effect.share[0]),
        interval_R: ends(&effect.share[1]),
        first_S: effect.first[0].share,
        first_R: effect.first[1].share,
        first_interval_S: ends(&effect.first[0]),
        first_interval_R: ends(&effect.first[1]),
        total_S: effect.total[0].share,
        total_R: effect.total[1].share,
        total_interval_S: ends(&effect.total[0]),
        total_interval_R: ends(&effect.total[1]),
        alone_S: effect.alone[0],
        alone_R: effect.alone[1],
        linear_S: effect.linear[0],
        linear_R: effect.linear[1],
    });
    let nothing = Some(0.0);
    let none = Some([0.0, 0.0]);
    let off = off.iter().map(|name| EffectPart {
        name: (*name).to_string(),
        share_S: nothing,
        share_R: nothing,
        interval_S: none,
        interval_R: none,
        first_S: nothing,
        first_R: nothing,
        first_interval_S: none,
        first_interval_R: none,
        total_S: nothing,
        total_R: nothing,
        total_interval_S: none,
        total_interval_R: none,
        alone_S: nothing,
        alone_R: nothing,
        linear_S: nothing,
        linear_R: nothing,
    });
    on.chain(off).collect()
}

/// Sums of shares for the document.
pub(crate) fn sum_parts(attribution: &Attribution) -> Vec<SumPart> {
    let named = ["S", "R"].into_iter().zip(&attribution.sum);
    named.map(|(name, sum)| SumPart { quantity: name.into(), sum: sum.share, interval: ends(sum) }).collect()
}

/// Remarks on a result that its numbers alone do not make.
pub(crate) fn study_notes(result: &StudyResult, failed: u64, first_failure: Option<&str>) -> Vec<String> {
    let mut notes = Vec::new();
    if let Some(summary) = result.quantities.first()
        && let (Some(truth), Some(sd), Some(bias)) = (summary.truth, summary.sd, summary.bias)
        // S ends at 1: where that is nearer than the noise reaches, and the shape is a cap or a cup
        && truth.abs() > 0.875
        && truth.abs() + 3.0 * sd > 1.0
    {
        notes.push(format!(
            "the true S is {}, at the edge of its range: noise can only take it inwards, here by {} on average",
            significant(truth, 4),
            significant(bias.abs(), 2)
        ));
    }
    if result.quantities.iter().any(|summary| summary.control.is_some()) {
        notes.push(
            "means, u and the symmetric interval lean on the linear law, whose distribution is known here (control)"
                .into(),
        );
    }
    if failed > 0 {
        notes.push(format!("{failed} replicates could not be fitted; the first: {}", first_failure.unwrap_or("")));
    }
    notes
}
