//! Documents of `palpate.parts/1` from which its schema is made.

use super::objects::ObjectRecord;
use super::parts::{FacePart, JointPart, PARTS_SCHEMA, PartRecord, PartsDocument, PartsNoisePart, PartsTruthPart};
use super::relations::RelationRecord;
use palpate_inference::parts::{PartGeometry, PartUncertainty, RelationKind};

/// Documents in which everything is there, and in which nothing is, for the schema.
pub(super) fn parts_samples() -> [PartsDocument; 2] {
    let half = Some(0.5);
    let full = PartsDocument {
        schema: PARTS_SCHEMA,
        input: "a scene".into(),
        contacts: 1,
        spacing: 0.5,
        noise: PartsNoisePart { distance: 0.5, normal_deg: 0.5 },
        tolerance: 0.5,
        parts: vec![PartRecord {
            id: 0,
            kind: "cone".into(),
            hollow: false,
            parameters: PartGeometry {
                point: [0.5; 3],
                axis: Some([0.5; 3]),
                radius: half,
                minor_radius: half,
                half_angle_deg: half,
                apex: Some([0.5; 3]),
            },
            u: PartUncertainty {
                point: half,
                axis_deg: half,
                radius: half,
                minor_radius: half,
                half_angle_deg: half,
                shape_index: half,
                curvedness: half,
            },
            class: Some("ridge".into()),
            shape_index: half,
            curvedness: 0.5,
            points: 1,
            extent: 0.5,
            misfit: 0.5,
            rejected: Some(false),
            p: half,
            departure: 0.5,
        }],
        joints: vec![JointPart { parts: [0, 1], kind: "convex".into(), angle_deg: 0.5 }],
        relations: vec![RelationRecord {
            parts: [0, 1],
            kind: RelationKind::EqualRadius,
            probability: 0.5,
            missed_by: 0.5,
            u: 0.5,
        }],
        objects: Some(vec![
            ObjectRecord { name: Some("mug".into()), probability: 0.5, pairs: vec![[0, 1]] },
            ObjectRecord { name: None, probability: 0.5, pairs: vec![[0, 1]] },
        ]),
        unassigned: 0,
        truth: Some(PartsTruthPart {
            faces: vec![FacePart { kind: "cone".into(), part: Some(0), contacts: 1, in_parts: vec![1] }],
            right: 0.5,
            boundary_error: half,
        }),
        notes: vec!["a note".into()],
        seconds: 0.5,
    };
    let mut empty = full.clone();
    for part in &mut empty.parts {
        part.parameters = PartGeometry { point: [0.5; 3], ..PartGeometry::default() };
        part.u = PartUncertainty::default();
        (part.class, part.shape_index, part.rejected, part.p) = (None, None, None, None);
    }
    if let Some(truth) = &mut empty.truth {
        truth.boundary_error = None;
        truth.faces.iter_mut().for_each(|face| face.part = None);
    }
    let mut without = full.clone();
    (without.truth, without.objects) = (None, None);
    without.parts = empty.parts.clone();
    [full, without].map(|mut document| {
        // what may be missing in one sample is missing in the other
        if let (Some(truth), Some(emptied)) = (&mut document.truth, &empty.truth) {
            truth.faces.extend(emptied.faces.iter().cloned());
        }
        document
    })
}
