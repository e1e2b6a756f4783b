//! `palpate.diff/1`: two saved surfaces compared, as a document, a table and CSV.
//!
//! ```text
//! Comparison -> DiffDocument -> JSON (report/json.rs), a table, diff.csv; the picture in diff_picture.rs
//! ```

use std::fmt::Write as _;
use std::io::Write;

use schemars::JsonSchema;
use serde::Serialize;

use crate::comparison::{Comparison, QUANTITIES, QuantitySummary};

use super::fold::folded;
use super::table::significant;

/// Schema name.
pub(crate) const DIFF_SCHEMA: &str = "palpate.diff/1";

/// What the four quantities are called in the table, and their units.
const NAMES: [(&str, &str); QUANTITIES] = [("height", ""), ("normal", " deg"), ("S", ""), ("R", "")];

/// One of the two.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub(crate) struct SurfacePart {
    /// Name of the file.
    pub(crate) file: String,
    /// `height` or `parametric`.
    pub(crate) kind: String,
    /// Whether the file carries uncertainties point by point.
    pub(crate) uncertainty: bool,
    /// Whether the surface was recognised; the uncertainties of a named model know less of other kinds of surface.
    pub(crate) recognised: bool,
}

/// One quantity over all points compared.
#[derive(Clone, Debug, Default, Serialize, JsonSchema)]
pub(crate) struct DifferencePart {
    /// Points at which both surfaces have it.
    pub(crate) points: usize,
    /// Mean of B less A.
    pub(crate) mean: Option<f64>,
    /// Root mean square difference.
    pub(crate) rms: Option<f64>,
    /// The difference that is largest in size.
    pub(crate) largest: Option<f64>,
    /// Where that is, on A.
    pub(crate) largest_at: Option<[f64; 3]>,
    /// Mean standard uncertainty of the difference.
    pub(crate) u: Option<f64>,
    /// Largest difference in units of its own uncertainty.
    pub(crate) ratio: Option<f64>,
    /// Where that is, on A.
    pub(crate) ratio_at: Option<[f64; 3]>,
    /// Points that have an uncertainty.
    pub(crate) judged: usize,
    /// Of these, points whose difference chance does not explain.
    pub(crate) beyond: usize,
}

/// All four.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub(crate) struct DifferencesPart {
    /// Height along z, or distance along A's normal.
    pub(crate) height: DifferencePart,
    /// Angle between the normals, degrees.
    pub(crate) normal_deg: DifferencePart,
    /// Shape index.
    #[serde(rename = "S")]
    pub(crate) shape_index: DifferencePart,
    /// Curvedness.
    #[serde(rename = "R")]
    pub(crate) curvedness: DifferencePart,
}

/// Two surfaces compared.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub(crate) struct DiffDocument {
    /// `palpate.diff/1`.
    pub(crate) schema: &'static str,
    /// The first surface.
    pub(crate) a: SurfacePart,
    /// The second.
    pub(crate) b: SurfacePart,
    /// `z` where heights over the same axes were compared, `normal` where distances along A's normal were.
    pub(crate) along: &'static str,
    /// Points each way.
    pub(crate) grid: [usize; 2],
    /// Points at which both surfaces are and contacts support both.
    pub(crate) compared: usize,
    /// Whether they are the same within what the data tell; `null` where neither carries uncertainties.
    pub(crate) same: Option<bool>,
    /// Ratio of a difference to its uncertainty that chance does not exceed.
    pub(crate) threshold: f64,
    /// Confidence of that, over all points and quantities at once.
    pub(crate) level: f64,
    /// The differences.
    pub(crate) differences: DifferencesPart,
    /// What the user should know.
    pub(crate) notes: Vec<String>,
}

impl DiffDocument {
    /// Of a comparison.
    pub(crate) fn of(found: &Comparison, a: SurfacePart, b: SurfacePart) -> DiffDocument {
        let [height, normal_deg, shape_index, curvedness] = found.quantities.each_ref().map(part);
        let notes = notes(&a, &b);
        DiffDocument {
            schema: DIFF_SCHEMA,
            a,
            b,
            along: if found.heights { "z" } else { "normal" },
            grid: [found.at[0].len(), found.at[1].len()],
            compared: found.points.iter().flatten().count(),
            same: found.same,
            threshold: found.threshold,
            level: 0.95,
            differences: DifferencesPart { height, normal_deg, shape_index, curvedness },
            notes,
        }
    }

    fn parts(&self) -> [&DifferencePart; QUANTITIES] {
        let all = &self.differences;
        [&all.height, &all.normal_deg, &all.shape_index, &all.curvedness]
    }

    /// The verdict in one sentence.
    pub(super) fn verdict(&self) -> String {
        let threshold = significant(self.threshold, 2);
        match self.same {
            None => "no verdict: neither file carries uncertainties".into(),
            Some(true) => format!(
                "the same surface within what the data tell: no difference exceeds {threshold} times its uncertainty"
            ),
            Some(false) => {
                let beyond = self.parts().into_iter().zip(NAMES).filter(|(part, _)| part.beyond > 0);
                let names: Vec<&str> = beyond.map(|(_, (name, _))| name).collect();
                let names = names.join(", ");
                format!("not the same surface: more than {threshold} times the uncertainty apart in {names}")
            }
        }
    }
}

fn part(found: &QuantitySummary) -> DifferencePart {
    DifferencePart {
        points: found.points,
        mean: found.mean,
        rms: found.rms,
        largest: found.largest.map(|(d, _)| d),
        largest_at: found.largest.map(|(_, at)| at),
        u: found.u,
        ratio: found.worst.map(|(r, _)| r).filter(|r| r.is_finite()),
        ratio_at: found.worst.map(|(_, at)| at),
        judged: found.beyond[1],
        beyond: found.beyond[0],
    }
}

/// What every judgement rests on.
const INDEPENDENT: &str =
    "the two are taken as independent: for two fits of the same contacts the uncertainties are too large";

fn named(part: &SurfacePart) -> String {
    format!(
        "the uncertainties of {} are those of its named model: of heights and normals noise alone, of S and R what the means \
         say of other kinds of surface",
        part.file
    )
}

fn notes(a: &SurfacePart, b: &SurfacePart) -> Vec<String> {
    let lacks = |part: &SurfacePart| {
        format!(
            "{} carries no uncertainties (CAD files and fits by --bare do not): those of the other one are counted",
            part.file
        )
    };
    let mut notes = match (a.uncertainty, b.uncertainty) {
        (true, true) => vec![INDEPENDENT.to_string()],
        (true, false) => vec![lacks(b)],
        (false, true) => vec![lacks(a)],
        (false, false) => vec!["save both by --save F.json without --bare to judge the differences".into()],
    };
    notes.extend([a, b].into_iter().filter(|part| part.uncertainty && !part.recognised).map(named));
    notes
}

/// Writes the table for people.
///
/// # Errors
/// What the system says.
pub(crate) fn write_diff_table(document: &DiffDocument, width: usize, out: &mut dyn Write) -> std::io::Result<()> {
    let mut text = String::new();
    let [n, m] = document.grid;
    let along = if document.along == "z" { "heights along z" } else { "distances along the normals of A" };
    // writing to a string cannot fail
    let _ = writeln!(text, "A          {}\nB          {}", document.a.file, document.b.file);
    let _ = writeln!(text, "verdict    {}", document.verdict());
    let _ = writeln!(text, "compared   {} of {n} x {m} points, B less A, {along}", document.compared);
    let _ = writeln!(
        text,
        "\n{:<10} {:>12} {:>12} {:>12} {:>12} {:>10}",
        "", "rms", "largest", "u (mean)", "largest/u", "beyond"
    );
    for (part, (name, unit)) in document.parts().into_iter().zip(NAMES) {
        let number = |value: Option<f64>| value.map_or("-".into(), |v| format!("{}{unit}", significant(v, 3)));
        let ratio = part.ratio.map_or("-".into(), |r| significant(r, 2));
        let beyond = if part.judged == 0 { "-".into() } else { format!("{} of {}", part.beyond, part.judged) };
        let (rms, largest, u) = (number(part.rms), number(part.largest), number(part.u));
        let _ = writeln!(text, "{name:<10} {rms:>12} {largest:>12} {u:>12} {ratio:>12} {beyond:>10}");
    }
    text.push('\n');
    for (part, (name, _)) in document.parts().into_iter().zip(NAMES).filter(|(part, _)| part.beyond > 0) {
        if let (Some(ratio), Some([x, y, z])) = (part.ratio, part.ratio_at) {
            let place = [x, y, z].map(|v| significant(v, 4)).join(", ");
            let _ = writeln!(
                text,
                "where      {name} differs most at ({place}): {} times its uncertainty",
                significant(ratio, 2)
            );
        }
    }
    for note in &document.notes {
        let _ = writeln!(text, "note       {note}");
    }
    out.write_all(folded(&text, Some(11), width).as_bytes())
}

/// Writes one row a point compared: its place on A, differences and their uncertainties, empty where undefined.
///
/// # Errors
/// What the system says.
pub(crate) fn write_diff_csv(found: &Comparison, out: &mut dyn Write) -> std::io::Result<()> {
    let mut text = String::from("x,y,z,height,normal_deg,S,R,u_height,u_normal_deg,u_S,u_R\n");
    for point in found.points.iter().flatten() {
        let [x, y, z] = point.place;
        let _ = write!(text, "{x},{y},{z}");
        for value in point.difference.iter().chain(&point.u) {
            let _ = write!(text, ",{}", value.map_or(String::new(), |v| v.to_string()));
        }
        text.push('\n');
    }
    out.write_all(text.as_bytes())
}
