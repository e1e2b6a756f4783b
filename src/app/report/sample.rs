//! A document in which everything is there, for the tests of those that read one.

use super::document::*;
use super::truth_part::TruthPart;
use crate::io::{FIT_SCHEMA, SavedFrame, SavedSurface};
use palpate_geometry::curvature::ShapeClass;

/// A document in which everything is there.
pub(super) fn full_document() -> FitDocument {
    let measure = MeasurePart {
        mean: Some(0.5),
        sd: Some(0.5),
        u: Some(0.5),
        interval: Some([0.5, 0.5]),
        u_noise: Some(0.5),
        u_model: Some(0.5),
        level: Some(0.5),
        coverage_factor: Some(0.5),
        dof: Some(0.5),
    };
    let spread = SpreadPart { mean: Some(0.5), sd: Some(0.5) };
    let classes = ShapeClass::CURVED.into_iter().chain([ShapeClass::Plane]);
    let shares = classes.map(|class| (class.name().to_string(), 0.5)).collect();
    FitDocument {
        schema: FIT_SCHEMA.into(),
        unit: Some("mm".into()),
        contacts: 1,
        frame: SavedFrame { origin: [0.5; 3], axes: [[0.5; 3]; 3], scale: 0.5 },
        fit: FitPart {
            degree: [2, 2],
            segments: [1, 1],
            weights: Some([0.5; 3]),
            chosen: Some(ChosenPart {
                surface: "height".into(),
                why: "asked for".into(),
                reason: "asked for".into(),
                degree: Some([4, 4]),
                segments: Some([2, 2]),
                frame: Some("keep".into()),
                hypothesis: Some("cylinder".into()),
                tried: vec![TriedPart::default()],
            }),
            lack_of_fit: Some(LackOfFitPart { p: Some(0.5), percent_of_relief: Some(0.5), words: "no pattern".into() }),
            parametric: None,
            adaptive: None,
            sigma: Some(SigmaPart {
                z: Some(0.5),
                normal_deg: Some(0.5),
                slope: Some(0.5),
                shared: Some(0.5),
                shared_over: Some(0.5),
            }),
            method: "cholesky".into(),
            reason: "asked for".into(),
            equations: 1,
            unknowns: 1,
            rank: 1,
            condition: Some(0.5),
            backward_error: Some(0.5),
            promise: Some(PromisePart { coefficients: 0.5, shape_index: 0.5, curvedness: 0.5 }),
            refinements: 1,
            smooth: 0.5,
            rms: RmsPart { z: Some(0.5), zx: Some(0.5), zy: Some(0.5), normal_deg: Some(0.5) },
            notes: vec!["a note".into()],
            technical_notes: vec!["a note".into()],
        },
        shape: ShapePart {
            grid: [8, 8],
            shape_index: measure.clone(),
            curvedness: measure,
            radius: Some(0.5),
            radius_interval: Some([0.5, 0.5]),
            radii: Some([0.5, 0.5]),
            class: Some("ridge".into()),
            other_class: Some("cup".into()),
            class_probability: Some(Shares(shares)),
            class_by_area: Some(Shares(vec![("ridge".into(), 0.5)])),
            k1: spread.clone(),
            k2: spread,
            direction_deg: Some(0.5),
            direction: Some([0.5; 3]),
            axis_deg: Some(0.5),
            axis: Some([0.5; 3]),
            axis_within_deg: Some(0.5),
            centre: Some([0.5; 3]),
            support: 0.5,
            plane_p: Some(0.5),
            covariance: Some(0.5),
            intervals: Some(IntervalsPart {
                law: "student_t".into(),
                beside: Some("a cylinder".into()),
                seed: Some(1),
                isa: "portable".into(),
            }),
        },
        truth: Some(TruthPart {
            shape_index: Some(0.5),
            curvedness: Some(0.5),
            error_shape_index: Some(0.5),
            error_curvedness: Some(0.5),
            class: Some("ridge".into()),
            radius: Some(0.5),
            radii: Some([0.5; 2]),
            direction_deg: Some(0.5),
            direction: Some([0.5; 3]),
            axis_deg: Some(0.5),
            axis: Some([0.5; 3]),
        }),
        surface: SavedSurface {
            kind: "height".into(),
            degree: [2, 2],
            knots: [vec![0.5], vec![0.5]],
            coefficients: Vec::new(),
            closed: None,
            support: None,
            support_map: None,
            splits: None,
            unsupported: vec![1],
        },
        uncertainty: None,
        seconds: Seconds { read: 0.5, fit: 0.5, shape: 0.5, total: 0.5 },
    }
}
