//! A sweep: S, R and class shares against keys of the scene, as table and CSV; the picture is in `sweep_picture.rs`.

use std::fmt::Write as _;
use std::io::Write;

use serde::Serialize;

use super::document::Shares;
use super::study::{QuantityPart, StudyDocument};
use super::table::significant;

/// One point of a sweep.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct SweepPoint {
    /// Values of the keys.
    pub at: Vec<f64>,
    /// S.
    #[serde(rename = "S")]
    pub shape_index: QuantityPart,
    /// R.
    #[serde(rename = "R")]
    pub curvedness: QuantityPart,
    /// Class shares.
    pub class: Shares,
    /// Replicates whose fit failed.
    pub failed: u64,
}

impl SweepPoint {
    /// From a study at these values of the keys.
    pub(crate) fn new(at: Vec<f64>, study: &StudyDocument) -> SweepPoint {
        SweepPoint {
            at,
            shape_index: study.shape_index.clone(),
            curvedness: study.curvedness.clone(),
            class: study.class.clone(),
            failed: study.failed,
        }
    }

    fn best(&self) -> Option<&(String, f64)> {
        self.class.0.iter().max_by(|a, b| a.1.total_cmp(&b.1))
    }
}

/// A table for people.
///
/// # Errors
/// What the system says.
pub(crate) fn write_sweep_table(keys: &[&str], points: &[SweepPoint], out: &mut dyn Write) -> std::io::Result<()> {
    let mut text = keys.join("  ");
    let _ = writeln!(
        text,
        "\n{:<width$} {:>10} {:>22} {:>9}   {:>10} {:>24} {:>9}   class",
        "",
        "S",
        "interval",
        "truth",
        "R",
        "interval",
        "truth",
        width = 12 * keys.len()
    );
    for point in points {
        let at: String = point.at.iter().map(|v| format!("{:<12}", significant(*v, 4))).collect();
        let word = |v: Option<f64>| v.map_or("-".into(), |v| significant(v, 4));
        let interval = |part: &QuantityPart| format!("[{}, {}]", word(part.lo), word(part.hi));
        let (s, r) = (&point.shape_index, &point.curvedness);
        let class = point.best().map_or(String::new(), |(name, share)| format!("{name} {share:.3}"));
        let _ = writeln!(
            text,
            "{at} {:>10} {:>22} {:>9}   {:>10} {:>24} {:>9}   {class}",
            word(s.mean),
            interval(s),
            word(s.truth),
            word(r.mean),
            interval(r),
            word(r.truth)
        );
    }
    out.write_all(text.as_bytes())
}

/// Names and columns of the table of a sweep: the keys, what S and R came to, failed replicates, class shares; NaN where
/// undefined.
pub(crate) fn sweep_columns(keys: &[&str], points: &[SweepPoint]) -> (Vec<String>, Vec<Vec<f64>>) {
    let of = |name: &str| ["mean", "sd", "bias", "lo", "hi", "truth"].map(|what| format!("{name}_{what}"));
    let mut names: Vec<String> = keys.iter().map(ToString::to_string).collect();
    names.extend(of("S").into_iter().chain(of("R")).chain(["failed".to_string()]));
    names.extend(points.iter().take(1).flat_map(|point| point.class.0.iter().map(|(name, _)| name.replace(' ', "_"))));
    let mut columns = vec![Vec::with_capacity(points.len()); names.len()];
    for point in points {
        let parts = [&point.shape_index, &point.curvedness];
        let values = parts.into_iter().flat_map(|part| [part.mean, part.sd, part.bias, part.lo, part.hi, part.truth]);
        let values = values.map(|v| v.unwrap_or(f64::NAN)).chain([point.failed as f64]);
        let values = point.at.iter().copied().chain(values).chain(point.class.0.iter().map(|(_, share)| *share));
        columns.iter_mut().zip(values).for_each(|(column, value)| column.push(value));
    }
    (names, columns)
}

/// One line a point.
///
/// # Errors
/// What the system says.
pub(crate) fn write_sweep_csv(keys: &[&str], points: &[SweepPoint], out: &mut dyn Write) -> std::io::Result<()> {
    let (names, columns) = sweep_columns(keys, points);
    writeln!(out, "{}", names.join(","))?;
    for k in 0..points.len() {
        let words: Vec<String> = columns.iter().map(|column| column[k].to_string()).collect();
        writeln!(out, "{}", words.join(","))?;
    }
    Ok(())
}
