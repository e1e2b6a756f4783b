//! `palpate.parts/1`: the parts of a body as a document, a table and CSV.
//!
//! ```text
//! Parts, Agreement -> PartsDocument -> JSON (report/json.rs), a table; parts.csv; the picture in parts_picture.rs
//! ```

use std::fmt::Write as _;
use std::io::Write;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::fold::folded;
use super::objects::{ObjectRecord, object_line};
use super::relations::{RelationRecord, relation_lines};
use super::table::significant;
use palpate_geometry::contact::{Contacts, counted};
use palpate_inference::parts::{
    Agreement, ObjectMatch, Part, PartGeometry, PartKind, PartUncertainty, Parts, RelationPrior,
};

/// Schema name.
pub(crate) const PARTS_SCHEMA: &str = "palpate.parts/1";

/// Digits of lengths in the table.
const DIGITS: i32 = 4;

/// One part.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub(crate) struct PartRecord {
    /// Its number.
    pub id: usize,
    /// Kind of primitive, or `patch`.
    pub kind: String,
    /// Seen from inside.
    pub hollow: bool,
    /// Where it lies and how large it is.
    pub parameters: PartGeometry,
    /// Standard uncertainties.
    pub u: PartUncertainty,
    /// Class by the mean S.
    pub class: Option<String>,
    /// What it is from the other side, where nothing tells which is free.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub other_class: Option<String>,
    /// Mean S.
    #[serde(rename = "S")]
    pub shape_index: Option<f64>,
    /// Mean R.
    #[serde(rename = "R")]
    pub curvedness: f64,
    /// Contacts.
    pub points: usize,
    /// How far they reach.
    pub extent: f64,
    /// Root mean square distance.
    pub misfit: f64,
    /// Whether the data reject it at 1 %.
    pub rejected: Option<bool>,
    /// Probability of so large a lack of fit by chance.
    pub p: Option<f64>,
    /// Root mean square of what noise does not explain.
    pub departure: f64,
}

/// Two parts that meet.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub(crate) struct JointPart {
    /// Their ids.
    pub parts: [usize; 2],
    /// `convex`, `concave` or `smooth`.
    pub kind: String,
    /// By how much the normal turns.
    pub angle_deg: f64,
    /// Standard uncertainty of that; none where one of the parts is no primitive.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub u_angle_deg: Option<f64>,
}

impl JointPart {
    /// `88.31 +- 0.20`: down to the second digit of the uncertainty, between one decimal and four.
    pub(crate) fn angle_words(&self) -> String {
        let Some(u) = self.u_angle_deg else { return format!("{:.1}", self.angle_deg) };
        let digits = if u > 0.0 { (1.0 - u.log10().floor()).clamp(1.0, 4.0) as usize } else { 4 };
        format!("{:.digits$} +- {}", self.angle_deg, significant(u, 2))
    }
}

/// Noise as neighbourhoods show it.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub(crate) struct PartsNoisePart {
    /// Along the normal.
    pub distance: f64,
    /// Of normals, in each tangent direction.
    pub normal_deg: f64,
}

/// One true face.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub(crate) struct FacePart {
    /// Its kind.
    pub kind: String,
    /// The part that it became, if it became one.
    pub part: Option<usize>,
    /// Its contacts.
    pub contacts: usize,
    /// Its contacts in each part; the last number counts those in none.
    pub in_parts: Vec<usize>,
}

/// The truth of a scene beside the parts.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub(crate) struct PartsTruthPart {
    /// Every face that was seen.
    pub faces: Vec<FacePart>,
    /// Share of the contacts in the part that their face became.
    pub right: f64,
    /// Mean distance between found and true boundaries, in spacings.
    pub boundary_error: Option<f64>,
}

/// The whole answer.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub(crate) struct PartsDocument {
    /// `palpate.parts/1`.
    pub schema: &'static str,
    /// File or scene.
    pub input: String,
    /// Contacts in all.
    pub contacts: usize,
    /// Median distance between neighbours.
    pub spacing: f64,
    /// Noise.
    pub noise: PartsNoisePart,
    /// Departures that were let pass while parts were looked for.
    pub tolerance: f64,
    /// Largest first.
    pub parts: Vec<PartRecord>,
    /// Where they meet.
    pub joints: Vec<JointPart>,
    /// What probably ties them, whether they meet or not.
    pub relations: Vec<RelationRecord>,
    /// Of a library, the most probable first.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub objects: Option<Vec<ObjectRecord>>,
    /// Contacts in no part.
    pub unassigned: usize,
    /// Of a scene.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub truth: Option<PartsTruthPart>,
    /// What a user should know.
    pub notes: Vec<String>,
    /// Time taken.
    pub seconds: f64,
}

impl PartsDocument {
    /// From an answer; `notes` come before its own.
    pub(crate) fn new(input: &str, found: &Parts, notes: Vec<String>, seconds: f64) -> PartsDocument {
        PartsDocument {
            schema: PARTS_SCHEMA,
            input: input.into(),
            contacts: found.labels.len(),
            spacing: found.spacing,
            noise: PartsNoisePart { distance: found.noise, normal_deg: found.normal_noise_deg },
            tolerance: found.tolerance,
            parts: found.parts.iter().map(part).collect(),
            joints: found
                .joints
                .iter()
                .map(|j| JointPart {
                    parts: j.parts,
                    kind: j.kind.name().into(),
                    angle_deg: j.angle_deg,
                    u_angle_deg: j.u_angle_deg,
                })
                .collect(),
            relations: found.relations(&RelationPrior::default()).iter().map(RelationRecord::of).collect(),
            objects: None,
            unassigned: found.labels.iter().filter(|label| label.is_none()).count(),
            truth: None,
            notes: notes.into_iter().chain(found.notes.iter().cloned()).collect(),
            seconds,
        }
    }

    /// The same with what it may be of a library.
    pub(crate) fn with_objects(mut self, found: Vec<ObjectMatch>) -> PartsDocument {
        self.objects = Some(found.into_iter().map(ObjectRecord::of).collect());
        self
    }

    /// The same with the truth beside it.
    pub(crate) fn with_truth(mut self, agreement: &Agreement, kinds: &[&str]) -> PartsDocument {
        let face = |(k, row): (usize, &Vec<usize>)| FacePart {
            kind: kinds.get(k).map_or(String::new(), |kind| (*kind).to_string()),
            part: agreement.part_of_face[k],
            contacts: row.iter().sum(),
            in_parts: row.clone(),
        };
        let faces = agreement.table.iter().enumerate().map(face).filter(|face| face.contacts > 0).collect();
        self.truth = Some(PartsTruthPart { faces, right: agreement.right, boundary_error: agreement.boundary_error });
        self
    }
}

fn part(part: &Part) -> PartRecord {
    PartRecord {
        id: part.id,
        kind: part.kind.name().into(),
        hollow: part.hollow,
        parameters: part.geometry,
        u: part.u,
        class: part.class.map(|class| class.name().into()),
        other_class: part.other_class.map(|class| class.name().into()),
        shape_index: part.shape_index,
        curvedness: part.curvedness,
        points: part.points,
        extent: part.extent,
        misfit: part.misfit,
        rejected: part.rejected,
        p: part.p,
        departure: part.departure,
    }
}

/// The class, with what it is from the other side where nothing tells which is free.
pub(super) fn class_words(part: &PartRecord) -> String {
    let class = part.class.as_deref().unwrap_or("-");
    part.other_class.as_ref().map_or(class.into(), |other| format!("{class} or {other}"))
}

/// A table for people: parts, joints, and the truth of a scene.
///
/// # Errors
/// What the system says.
pub(crate) fn write_parts_table(document: &PartsDocument, width: usize, out: &mut dyn Write) -> std::io::Result<()> {
    let mut text = format!(
        "parts      {} of {}: {} contacts, some {} apart\n",
        document.parts.len(),
        document.input,
        document.contacts,
        significant(document.spacing, 2)
    );
    if let Some(objects) = &document.objects {
        text.push_str(&folded(&format!("object     {}", object_line(objects)), Some(11), width));
    }
    let _ = writeln!(
        text,
        "noise      {} along the normal, normals {} degrees; departures up to {} make no part of their own",
        significant(document.noise.distance, 2),
        significant(document.noise.normal_deg, 2),
        significant(document.tolerance, 2)
    );
    let _ = writeln!(text, "{:>4}  {:<9} {:<13} {:>8}  {:<44} fit", "part", "kind", "class", "contacts", "size");
    for part in &document.parts {
        let class = class_words(part);
        let kind = if part.hollow { format!("{} *", part.kind) } else { part.kind.clone() };
        let _ = writeln!(
            text,
            "{:>4}  {kind:<9} {class:<13} {:>8}  {:<44} {}",
            part.id,
            part.points,
            size_words(part),
            fit_words(part)
        );
    }
    if document.parts.iter().any(|part| part.hollow) {
        text.push_str("      * seen from inside\n");
    }
    if document.unassigned > 0 {
        let _ = writeln!(
            text,
            "{:>4}  {} in no part: off every part, and too few side by side for a part of their own",
            "-",
            counted(document.unassigned, "contact")
        );
    }
    for joint in &document.joints {
        let [a, b] = joint.parts;
        let _ = writeln!(
            text,
            "joint      {a} and {b}: {}, the normal turns by {} degrees",
            joint.kind,
            joint.angle_words()
        );
    }
    for line in relation_lines(&document.relations) {
        text.push_str(&folded(&format!("relation   {line}"), Some(11), width));
    }
    truth_lines(document, &mut text);
    for note in &document.notes {
        text.push_str(&folded(&format!("note       {note}"), Some(11), width));
    }
    out.write_all(text.as_bytes())
}

fn truth_lines(document: &PartsDocument, text: &mut String) {
    let Some(truth) = &document.truth else { return };
    let boundary =
        truth.boundary_error.map_or(String::new(), |e| format!(", boundaries {} spacings off", significant(e, 2)));
    let _ =
        writeln!(text, "truth      {:.2} % of the contacts in the part of their face{boundary}", 100.0 * truth.right);
    let _ = write!(text, "           {:<16}", "true face");
    (0..document.parts.len()).for_each(|k| {
        let _ = write!(text, "{:>7}", format!("part {k}"));
    });
    let _ = writeln!(text, "{:>7}", "none");
    for (k, face) in truth.faces.iter().enumerate() {
        let _ = write!(text, "           {:<16}", format!("{k} {}", face.kind));
        face.in_parts.iter().for_each(|n| {
            let _ = write!(text, "{n:>7}");
        });
        text.push('\n');
    }
}

/// `radius 5.001 +- 0.002`, and what else the kind has.
pub(super) fn size_words(part: &PartRecord) -> String {
    let (g, u) = (&part.parameters, &part.u);
    let with = |name: &str, value: Option<f64>, u: Option<f64>| {
        let value = value?;
        let u = u.map_or(String::new(), |u| format!(" +- {}", significant(u, 2)));
        Some(format!("{name} {}{u}", significant(value, DIGITS)))
    };
    let words: Vec<String> = [
        with(if g.minor_radius.is_some() { "ring" } else { "radius" }, g.radius, u.radius),
        with("tube", g.minor_radius, u.minor_radius),
        with("half angle", g.half_angle_deg, u.half_angle_deg),
    ]
    .into_iter()
    .flatten()
    .collect();
    if words.is_empty()
        && let Some([x, y, z]) = g.axis
    {
        return format!("normal ({x:.3}, {y:.3}, {z:.3})");
    }
    if !words.is_empty() {
        return words.join(", ");
    }
    let of_shape = [with("S", part.shape_index, u.shape_index), with("R", Some(part.curvedness), u.curvedness)];
    of_shape.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

fn fit_words(part: &PartRecord) -> String {
    let rms = format!("rms {}", significant(part.misfit, 2));
    match part.rejected {
        Some(true) => format!("{rms}, rejected: off by {}", significant(part.departure, 2)),
        Some(false) => rms,
        None if part.kind == PartKind::Patch.name() => format!("{rms}, no primitive"),
        None => format!("{rms}, too few contacts for a test"),
    }
}

/// `x,y,z,part`, one row a contact, the part empty where there is none.
///
/// # Errors
/// What the system says.
pub(crate) fn write_parts_csv(contacts: &Contacts, found: &Parts, out: &mut dyn Write) -> std::io::Result<()> {
    let mut text = String::from("x,y,z,part,kind\n");
    for (r, label) in found.labels.iter().enumerate() {
        let _ = write!(text, "{},{},{},", contacts.x[r], contacts.y[r], contacts.z[r]);
        match label {
            Some(part) => {
                let kind = found.parts.get(*part as usize).map_or("", |part| part.kind.name());
                let _ = writeln!(text, "{part},{kind}");
            }
            None => text.push_str(",\n"),
        }
    }
    out.write_all(text.as_bytes())
}
