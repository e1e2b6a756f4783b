//! Several fits side by side: `palpate.fits/1`, a CSV of one row a file, and a line each for people.

use std::io::Write;

use schemars::JsonSchema;
use serde::Serialize;

use palpate_geometry::curvature::ShapeClass;

use super::document::{FitDocument, MeasurePart, Shares};
use super::table::significant;
use super::words::chance;

/// Schema name.
pub(crate) const FITS_SCHEMA: &str = "palpate.fits/1";

/// S or R of one file.
#[derive(Clone, Copy, Debug, Default, Serialize, JsonSchema)]
pub(crate) struct FitsMeasure {
    /// Mean over the patch.
    pub(crate) mean: Option<f64>,
    /// Its standard uncertainty.
    pub(crate) u: Option<f64>,
    /// Lower end of the interval.
    pub(crate) lo: Option<f64>,
    /// Upper end of the interval.
    pub(crate) hi: Option<f64>,
}

/// What one file gave.
#[derive(Clone, Debug, Default, Serialize, JsonSchema)]
pub(crate) struct FitsRow {
    /// As it was typed.
    pub(crate) file: String,
    /// Contacts, or measured pixels; `null` without an answer.
    pub(crate) contacts: Option<usize>,
    /// One of the nine classes, or plane.
    pub(crate) class: Option<String>,
    /// Probability of each class, where it is known.
    #[schemars(extend("required" = ShapeClass::CURVED.map(ShapeClass::name)))]
    pub(crate) class_probability: Option<Shares>,
    /// Shape index.
    #[serde(rename = "S")]
    pub(crate) shape_index: FitsMeasure,
    /// Curvedness.
    #[serde(rename = "R")]
    pub(crate) curvedness: FitsMeasure,
    /// Of spheres and cylinders.
    pub(crate) radius: Option<f64>,
    /// What the user should know.
    pub(crate) notes: Vec<String>,
    /// Why there is no answer.
    pub(crate) error: Option<String>,
}

/// All files.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub(crate) struct FitsDocument {
    /// `palpate.fits/1`.
    pub(crate) schema: &'static str,
    /// In the order in which they were typed.
    pub(crate) files: Vec<FitsRow>,
}

impl FitsDocument {
    pub(crate) fn of(files: Vec<FitsRow>) -> FitsDocument {
        FitsDocument { schema: FITS_SCHEMA, files }
    }
}

impl FitsRow {
    /// Of an answer.
    pub(crate) fn of(file: String, document: &FitDocument) -> FitsRow {
        let measure = |part: &MeasurePart| FitsMeasure {
            mean: part.mean,
            u: part.u,
            lo: part.interval.map(|i| i[0]),
            hi: part.interval.map(|i| i[1]),
        };
        FitsRow {
            file,
            contacts: Some(document.contacts),
            class: document.shape.class.clone(),
            class_probability: document.shape.class_probability.clone(),
            shape_index: measure(&document.shape.shape_index),
            curvedness: measure(&document.shape.curvedness),
            radius: document.shape.radius,
            notes: document.fit.notes.clone(),
            error: None,
        }
    }

    /// Probability of a class: a class that is not among those of an answer has none.
    fn chance_of(&self, class: &str) -> Option<f64> {
        let shares = self.class_probability.as_ref()?;
        Some(shares.0.iter().find(|(name, _)| name == class).map_or(0.0, |(_, p)| *p))
    }

    /// Of a file without an answer.
    pub(crate) fn failed(file: String, error: String) -> FitsRow {
        FitsRow { file, error: Some(error), ..FitsRow::default() }
    }
}

/// All classes, in the order of S, and the plane.
fn classes() -> impl Iterator<Item = &'static str> {
    ShapeClass::CURVED.into_iter().chain([ShapeClass::Plane]).map(ShapeClass::name)
}

/// Writes the header and a row a file; empty where undefined.
///
/// # Errors
/// What the system says.
pub(crate) fn write_fits_csv(rows: &[FitsRow], out: &mut dyn Write) -> std::io::Result<()> {
    let chances: Vec<String> = classes().map(|class| format!("p_{}", class.replace(' ', "_"))).collect();
    let chances = chances.join(",");
    let mut text = format!("file,contacts,class,S,u_S,lo_S,hi_S,R,u_R,lo_R,hi_R,radius,{chances},notes,error\n");
    for row in rows {
        let (s, r) = (row.shape_index, row.curvedness);
        let numbers = [s.mean, s.u, s.lo, s.hi, r.mean, r.u, r.lo, r.hi, row.radius];
        let number = |v: &Option<f64>| v.map_or(String::new(), |v| v.to_string());
        let mut fields = vec![
            quoted(&row.file),
            row.contacts.map_or(String::new(), |n| n.to_string()),
            row.class.clone().unwrap_or_default(),
        ];
        fields.extend(numbers.iter().map(number));
        fields.extend(classes().map(|class| number(&row.chance_of(class))));
        fields.push(quoted(&row.notes.join("; ")));
        fields.push(quoted(row.error.as_deref().unwrap_or_default()));
        text.push_str(&fields.join(","));
        text.push('\n');
    }
    out.write_all(text.as_bytes())
}

/// A field in quotes where it holds what would end it.
fn quoted(text: &str) -> String {
    let plain = !text.contains([',', '"', '\n', '\r']);
    if plain { text.into() } else { format!("\"{}\"", text.replace('"', "\"\"")) }
}

/// Writes one line; names are padded to `width` letters.
///
/// # Errors
/// What the system says.
pub(crate) fn write_fits_line(row: &FitsRow, width: usize, out: &mut dyn Write) -> std::io::Result<()> {
    let file = &row.file;
    if let Some(error) = &row.error {
        let own =
            error.strip_prefix(file.as_str()).map_or(error.as_str(), |rest| rest.trim_start_matches([':', ',', ' ']));
        return writeln!(out, "{file:<width$}  no answer: {own}");
    }
    let measure = |part: FitsMeasure| {
        let mean = part.mean.map_or("undefined".into(), |v| significant(v, 4));
        let between = part.lo.zip(part.hi).map(|(lo, hi)| format!(" [{}, {}]", significant(lo, 4), significant(hi, 4)));
        mean + &between.unwrap_or_default()
    };
    let radius = row.radius.map_or(String::new(), |r| format!("  radius {}", significant(r, 4)));
    let class = row.class.as_deref().unwrap_or("none");
    let (s, r) = (measure(row.shape_index), measure(row.curvedness));
    let sure = row.class.as_deref().and_then(|class| row.chance_of(class)).map_or(String::new(), chance);
    writeln!(out, "{file:<width$}  {class:<12}  {sure:<14}  S {s:<26}  R {r}{radius}")
}
