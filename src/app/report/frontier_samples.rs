//! Documents of a frontier with everything in them, and with nothing: what the schema is made of.

use super::frontier::*;
use palpate_studies::frontier::{Clocked, Errors, Share};

/// A document in which everything is there, for the schema.
pub(super) fn full_frontier() -> FrontierDocument {
    let half = Some(0.5);
    let seconds = Clocked { median: 0.5, lo: 0.5, hi: 0.5, least: 0.5 };
    let errors = Some(Errors { rms: 0.5, interval: [0.5; 2], worst: 0.5, bias: 0.5, sd: 0.5, upper: Some(0.5) });
    let share = Some(Share { share: 0.5, lo: 0.5, hi: 0.5, asked: 1 });
    let record = FrontierRecord {
        frontier: "discretisation".into(),
        case: "a scene".into(),
        program: "palpate".into(),
        label: "height degree 2, 1x1, weights tangent".into(),
        method: "auto".into(),
        surface: "height".into(),
        weights: "weights tangent".into(),
        degree: [2, 2],
        segments: [1, 1],
        stations: Some(9),
        contacts: 27,
        replicates: 96,
        error_S: half,
        error_R: half,
        error: half,
        error_interval: Some([0.5; 2]),
        errors: AllErrorsPart {
            shape_index: errors,
            curvedness: errors,
            k1: errors,
            height: errors,
            slope: errors,
            normal_deg: errors,
        },
        condition: half,
        digits: half,
        u: PosteriorSpreadPart { shape_index: half, curvedness: half },
        coverage: CoveragePart { shape_index: share, curvedness: share },
        seconds: Some(seconds),
        seconds_interval: Some(seconds),
        multiply_adds: Some(1),
        instructions: Some(1),
        instructions_interval: Some(1),
        memory_bytes: Some(1),
        support: half,
        on_frontier: true,
        on_instructions_frontier: true,
        failed: Some("why".into()),
    };
    let asked = AskedPart { error_S: half, error_R: half, budget: half };
    FrontierDocument {
        schema: FRONTIER_SCHEMA,
        scene: "a scene".into(),
        reference: "truth".into(),
        seed: 1,
        build: "0".into(),
        isa: "portable".into(),
        threads: 1,
        counter: "callgrind".into(),
        points: vec![record],
        shortlist: vec![0],
        recommended: Some(RecommendedPart { point: 0, label: "a label".into(), why: "why".into() }),
        beside: vec![BesidePart {
            program: "another".into(),
            label: "its way".into(),
            error: 0.5,
            error_S: half,
            error_R: half,
            seconds: 0.5,
        }],
        stages: vec![StagePart {
            of: "fit".into(),
            stage: "rows".into(),
            seconds,
            share: 0.5,
            saved_by: "a plan".into(),
        }],
        pick: Some(PickPart {
            label: "a label".into(),
            error_S: half,
            error_R: half,
            replicates: 96,
            seconds: 0.5,
            asked,
            met: true,
            obstacle: Some("noise".into()),
            scene: Some("[surface]".into()),
        }),
        notes: vec!["a note".into()],
        seconds: 0.5,
    }
}

/// The same with every value missing that may be.
pub(super) fn empty_frontier() -> FrontierDocument {
    let mut document = full_frontier();
    for record in &mut document.points {
        (record.stations, record.digits, record.support, record.failed) = (None, None, None, None);
        record.condition = None;
        record.u = PosteriorSpreadPart::default();
        (record.error_S, record.error_R, record.error, record.error_interval) = (None, None, None, None);
        (record.errors, record.coverage) = (AllErrorsPart::default(), CoveragePart::default());
        (record.seconds, record.seconds_interval) = (None, None);
        (record.instructions, record.instructions_interval, record.memory_bytes) = (None, None, None);
        record.multiply_adds = None;
    }
    document.beside.iter_mut().for_each(|part| (part.error_S, part.error_R) = (None, None));
    document.recommended = None;
    if let Some(pick) = &mut document.pick {
        (pick.error_S, pick.error_R, pick.obstacle, pick.scene) = (None, None, None, None);
        pick.asked = AskedPart::default();
    }
    document
}

/// A document without a request.
pub(super) fn frontier_without_pick() -> FrontierDocument {
    let mut document = full_frontier();
    for record in &mut document.points {
        let errors = &mut record.errors;
        for errors in [
            &mut errors.shape_index,
            &mut errors.curvedness,
            &mut errors.k1,
            &mut errors.height,
            &mut errors.slope,
            &mut errors.normal_deg,
        ] {
            errors.iter_mut().for_each(|errors| errors.upper = None);
        }
    }
    FrontierDocument { pick: None, ..document }
}
