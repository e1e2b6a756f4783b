//! The document of a surface of which nothing but the spline is known, as a CAD file holds it.

use crate::io::{FIT_SCHEMA, Saved, SavedFrame};

use super::document::{FitDocument, FitPart, MeasurePart, RmsPart, Seconds, ShapePart, SpreadPart};

/// What is said of the fit behind it.
const UNKNOWN: &str = "read from a CAD file: contacts, noise and certificate are not in it";

/// The document, without a shape, which [`describe_saved`](super::describe_saved) takes over a grid.
pub(crate) fn document_of_surface(saved: &Saved) -> FitDocument {
    let (surface, knots) = (saved.surface.saved_form(&saved.unsupported), saved.surface.knots());
    let unknowns = knots[0].n_basis() * knots[1].n_basis();
    FitDocument {
        schema: FIT_SCHEMA.into(),
        unit: None,
        contacts: 0,
        frame: SavedFrame::of(&saved.frame),
        fit: FitPart {
            degree: surface.degree,
            segments: [0, 1].map(|k| knots[k].n_segments()),
            weights: None,
            chosen: None,
            lack_of_fit: None,
            parametric: None,
            adaptive: None,
            sigma: None,
            method: "none".into(),
            reason: UNKNOWN.into(),
            equations: 0,
            unknowns,
            rank: 0,
            condition: None,
            backward_error: None,
            promise: None,
            refinements: 0,
            smooth: 0.0,
            rms: RmsPart::default(),
            notes: vec![UNKNOWN.into()],
            technical_notes: Vec::new(),
        },
        shape: ShapePart {
            grid: [8, 8],
            shape_index: MeasurePart::default(),
            curvedness: MeasurePart::default(),
            radius: None,
            radius_interval: None,
            radii: None,
            class: None,
            other_class: None,
            class_probability: None,
            class_by_area: None,
            k1: SpreadPart::default(),
            k2: SpreadPart::default(),
            direction_deg: None,
            direction: None,
            axis_deg: None,
            axis: None,
            axis_within_deg: None,
            centre: None,
            support: 1.0,
            plane_p: None,
            covariance: None,
            intervals: None,
        },
        truth: None,
        surface,
        uncertainty: None,
        seconds: Seconds::default(),
    }
}
