//! Documents of a study with everything in them, and with nothing: what the schema is made of.

use super::study::*;

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
        control: both,
        resolution: 0.5,
    };
    let linear = LinearQuantity { sd: half, lo: half, hi: half, valid: true };
    let effect = EffectPart {
        name: "row_noise".into(),
        share_S: half,
        share_R: half,
        interval_S: both,
        interval_R: both,
        first_S: half,
        first_R: half,
        first_interval_S: both,
        first_interval_R: both,
        total_S: half,
        total_R: half,
        total_interval_S: both,
        total_interval_R: both,
        alone_S: half,
        alone_R: half,
        linear_S: half,
        linear_R: half,
    };
    let classes = palpate_geometry::curvature::ShapeClass::CURVED.iter().map(|class| (class.name().to_string(), 0.5));
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
