//! `palpate.study/1`: what a study says, as JSON and as a table for people.

use std::fmt::Write as _;
use std::io::Write;

use serde::Serialize;

use super::table::significant;
use crate::montecarlo::{Attribution, LinearLaw, Share, Stopped, StudyResult, Summary};

/// Schema name.
pub(crate) const STUDY_SCHEMA: &str = "palpate.study/1";

/// Standard errors.
#[derive(Clone, Debug, Default, Serialize)]
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
#[derive(Clone, Debug, Default, Serialize)]
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
    /// Width of the bins at the ends; 0: every value was kept.
    pub resolution: f64,
}

/// One quantile.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct QuantilePart {
    /// Share.
    pub share: f64,
    /// Value.
    pub value: f64,
    /// Its standard error.
    pub standard_error: f64,
}

/// The linear law of one quantity.
#[derive(Clone, Debug, Default, Serialize)]
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
#[derive(Clone, Debug, Serialize)]
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
#[derive(Clone, Debug, Default, Serialize)]
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
    /// Share with all its company.
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

/// Shares in the order of S.
#[derive(Clone, Debug, Default)]
pub(crate) struct NamedShares(pub Vec<(String, f64)>);

impl Serialize for NamedShares {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(name, share)| (name, share)))
    }
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
#[derive(Clone, Debug, Serialize)]
pub(crate) struct StudyDocument {
    /// [`STUDY_SCHEMA`].
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
    /// The way to S and R.
    pub path: String,
    /// Why that way.
    pub path_why: String,
    /// S.
    #[serde(rename = "S")]
    pub shape_index: QuantityPart,
    /// R.
    #[serde(rename = "R")]
    pub curvedness: QuantityPart,
    /// Others that were asked for.
    pub quantities: NamedQuantities,
    /// Shares of the classes; those without a class under `none`.
    pub class: NamedShares,
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
#[derive(Clone, Debug, Serialize)]
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
            resolution: summary.resolution,
        }
    }
}

impl From<&LinearLaw> for LinearDocument {
    fn from(law: &LinearLaw) -> LinearDocument {
        let part = |q: usize| LinearQuantity {
            sd: law.parts[q].sd,
            lo: law.parts[q].lo,
            hi: law.parts[q].hi,
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
        share_S: effect.first[0].share,
        share_R: effect.first[1].share,
        interval_S: ends(&effect.first[0]),
        interval_R: ends(&effect.first[1]),
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
        && truth.abs() + 3.0 * sd > 1.0
    {
        notes.push(format!(
            "the true S is {}, at the edge of its range: noise can only take it inwards, here by {} on average",
            significant(truth, 4),
            significant(bias.abs(), 2)
        ));
    }
    if failed > 0 {
        notes.push(format!("{failed} replicates could not be fitted; the first: {}", first_failure.unwrap_or("")));
    }
    notes
}

/// The word for why a study ended.
pub(crate) fn stopped_words(stopped: Stopped) -> &'static str {
    match stopped {
        Stopped::Replicates => "all replicates done",
        Stopped::Tolerance => "the digits asked for are there",
        Stopped::Budget => "the time is up",
    }
}

/// Writes the table of one study.
///
/// # Errors
/// What the system says.
pub(crate) fn write_study_table(document: &StudyDocument, out: &mut dyn Write) -> std::io::Result<()> {
    let mut text = String::new();
    let mut line = |label: &str, words: String| {
        let _ = writeln!(text, "{label:<10} {}", words.trim_end());
    };
    line("study", format!("{} replicates of {}, seed {}", document.replicates, document.scene, document.seed));
    let rate = document.replicates_per_second.map_or(String::new(), |r| format!(", {} a second", significant(r, 3)));
    line("stopped", format!("{}{rate}", document.stopped));
    line("path", format!("{}: {}", document.path, document.path_why));
    let quantities = [("S", &document.shape_index), ("R", &document.curvedness)];
    let others = document.quantities.0.iter().map(|(name, part)| (name.as_str(), part));
    for (name, part) in quantities.into_iter().chain(others) {
        quantity_lines(name, part, document.level, &mut line);
    }
    let shares = document.class.0.iter().filter(|(_, share)| *share > 0.0);
    let shares: Vec<String> = shares.map(|(name, share)| format!("{name} {share:.4}")).collect();
    line("class", shares.join("   "));
    let verdict = document.verdict.as_ref().map_or_else(
        || format!("none: no class has a share of {}", document.level),
        |class| format!("{class}, with a share of {} or more", document.level),
    );
    line("verdict", verdict);
    let linear = |part: &LinearQuantity| match (part.sd, part.lo, part.hi) {
        (Some(sd), Some(lo), Some(hi)) => {
            format!("sd {} [{}, {}]", significant(sd, 3), significant(lo, 4), significant(hi, 4))
        }
        _ => "undefined".into(),
    };
    let law = &document.linear;
    line("linear", format!("S {}   R {}", linear(&law.shape_index), linear(&law.curvedness)));
    line("", format!("{}: {}", if law.valid { "valid" } else { "not valid" }, law.why));
    if !document.effects.is_empty() {
        line(
            "effects",
            format!("{:<18} {:>22} {:>22} {:>10} {:>10}", "", "share of var S", "share of var R", "S alone", "R alone"),
        );
        for effect in &document.effects {
            line("", effect_words(effect));
        }
        let sums = document.effects_sum.iter().map(|sum| share_words(sum.sum, sum.interval));
        let sums: Vec<String> = sums.map(|words| format!("{words:>22}")).collect();
        line("", format!("{:<18} {}", "sum", sums.join(" ")));
    }
    for note in &document.notes {
        line("note", note.clone());
    }
    out.write_all(text.as_bytes())
}

fn quantity_lines(name: &str, part: &QuantityPart, level: f64, line: &mut dyn FnMut(&str, String)) {
    let (Some(mean), Some(sd)) = (part.mean, part.sd) else {
        line(name, "undefined in every replicate".into());
        return;
    };
    let mut words = format!("{} +- {}", significant(mean, 5), significant(sd, 3));
    if let (Some(truth), Some(bias)) = (part.truth, part.bias) {
        let _ = write!(words, "   truth {}, bias {}", significant(truth, 5), significant(bias, 2));
    }
    if part.undefined > 0 {
        let _ = write!(words, "   undefined in {}", part.undefined);
    }
    line(name, words);
    if let (Some(lo), Some(hi), Some([a, b])) = (part.lo, part.hi, part.shortest) {
        let error = |e: Option<f64>| e.map_or("?".into(), |e| significant(e, 1));
        let (e, f) = (error(part.standard_error.lo), error(part.standard_error.hi));
        line(
            "",
            format!(
                "{} %: [{}, {}] to {e}, {f};  shortest [{}, {}]",
                100.0 * level,
                significant(lo, 5),
                significant(hi, 5),
                significant(a, 5),
                significant(b, 5)
            ),
        );
    }
    for quantile in &part.quantiles {
        let value = significant(quantile.value, 5);
        line("", format!("quantile {}: {value} to {}", quantile.share, significant(quantile.standard_error, 1)));
    }
}

fn share_words(share: Option<f64>, interval: Option<[f64; 2]>) -> String {
    match (share, interval) {
        (Some(share), Some([lo, hi])) => format!("{share:.3} [{lo:.3}, {hi:.3}]"),
        _ => "-".into(),
    }
}

fn effect_words(effect: &EffectPart) -> String {
    let alone = |v: Option<f64>| v.map_or("-".into(), |v| significant(v, 2));
    format!(
        "{:<18} {:>22} {:>22} {:>10} {:>10}",
        effect.name,
        share_words(effect.share_S, effect.interval_S),
        share_words(effect.share_R, effect.interval_R),
        alone(effect.alone_S),
        alone(effect.alone_R)
    )
}

/// A document in which everything is there, for the schema.
pub(super) fn full_study() -> StudyDocument {
    let half = Some(0.5);
    let both = Some([0.5; 2]);
    let part = QuantityPart {
        mean: half,
        sd: half,
        bias: half,
        truth: half,
        nominal: half,
        lo: half,
        hi: half,
        shortest: both,
        standard_error: StandardErrors { mean: half, lo: half, hi: half, shortest: both },
        quantiles: vec![QuantilePart { share: 0.5, value: 0.5, standard_error: 0.5 }],
        undefined: 1,
        resolution: 0.5,
    };
    let linear = LinearQuantity { sd: half, lo: half, hi: half, valid: true };
    let effect = EffectPart {
        name: "row_noise".into(),
        share_S: half,
        share_R: half,
        interval_S: both,
        interval_R: both,
        total_S: half,
        total_R: half,
        total_interval_S: both,
        total_interval_R: both,
        alone_S: half,
        alone_R: half,
        linear_S: half,
        linear_R: half,
    };
    let classes = crate::curvature::ShapeClass::CURVED.iter().map(|class| (class.name().to_string(), 0.5));
    StudyDocument {
        schema: STUDY_SCHEMA,
        scene: "a scene".into(),
        seed: 1,
        scene_hash: "0".into(),
        build: "0".into(),
        isa: "portable".into(),
        range: [0, 1],
        replicates: 1,
        stopped: "replicates".into(),
        level: 0.95,
        path: "fixed sites".into(),
        path_why: "asked for".into(),
        shape_index: part.clone(),
        curvedness: part,
        quantities: NamedQuantities::default(),
        class: NamedShares(classes.chain([("none".to_string(), 0.5)]).collect()),
        verdict: Some("ridge".into()),
        failed: 1,
        planes: 1,
        linear: LinearDocument { shape_index: linear.clone(), curvedness: linear, valid: true, why: "so".into() },
        effects: vec![effect],
        effects_replicates: 1,
        effects_sum: vec![SumPart { quantity: "S".into(), sum: half, interval: both }],
        notes: vec!["a note".into()],
        seconds: 0.5,
        replicates_per_second: half,
    }
}

/// The same with every value missing that may be.
pub(super) fn empty_study() -> StudyDocument {
    let mut document = full_study();
    let part = QuantityPart { quantiles: document.shape_index.quantiles.clone(), ..QuantityPart::default() };
    (document.shape_index, document.curvedness) = (part.clone(), part);
    let none = LinearQuantity::default();
    (document.linear.shape_index, document.linear.curvedness) = (none.clone(), none);
    document.effects = vec![EffectPart { name: "row_noise".into(), ..EffectPart::default() }];
    document.effects_sum = vec![SumPart { quantity: "S".into(), sum: None, interval: None }];
    document.verdict = None;
    document.replicates_per_second = None;
    document
}
