//! S and R at every point of a whole object: a table of columns in four formats, and a summary for people.
//!
//! ```text
//! x,y,z,nx,ny,nz,k1,k2,S,R,u_S,u_R        one row a point, in the input's order and unit
//! .csv empty where undefined        .npz one array a column        .ply vertices, double        .parquet DOUBLE, after the number
//! ```

use std::fmt::Write as _;
use std::io::{Cursor, Write};
use std::path::Path;

use super::table::significant;
use crate::io::{NpzWriter, write_parquet};
use palpate_geometry::contact::Contacts;
use palpate_inference::parts::PointShapes;
use palpate_numeric::statistics::{Rank, quantile};

/// Names of the columns.
const COLUMNS: [&str; 12] = ["x", "y", "z", "nx", "ny", "nz", "k1", "k2", "S", "R", "u_S", "u_R"];

/// What the columns are written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PointShapesFormat {
    /// Text.
    Csv,
    /// NumPy's archive.
    Npz,
    /// A cloud with further numbers at each vertex.
    Ply,
    /// Columns.
    Parquet,
}

impl PointShapesFormat {
    /// By the ending; `-` is CSV.
    ///
    /// # Errors
    /// Another ending, in words.
    pub(crate) fn of(path: &Path) -> Result<PointShapesFormat, String> {
        if path.as_os_str() == "-" {
            return Ok(PointShapesFormat::Csv);
        }
        let ending = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
        match ending.as_deref() {
            Some("csv") => Ok(PointShapesFormat::Csv),
            Some("npz") => Ok(PointShapesFormat::Npz),
            Some("ply") => Ok(PointShapesFormat::Ply),
            Some("parquet") => Ok(PointShapesFormat::Parquet),
            _ => Err(format!(
                "{}: the shape of points is written as .csv, .npz, .ply or .parquet; end the name in one of them",
                path.display()
            )),
        }
    }
}

/// The values of row `r`.
fn row(contacts: &Contacts, found: &PointShapes, r: usize) -> [f64; 12] {
    let [nx, ny, nz] = found.normals[r];
    let place = [contacts.x[r], contacts.y[r], contacts.z[r], nx, ny, nz];
    let shape = [found.k1[r], found.k2[r], found.shape_index[r], found.curvedness[r]];
    let [s, r] = [found.u_shape_index[r], found.u_curvedness[r]];
    let mut all = [0.0; 12];
    all.iter_mut().zip(place.into_iter().chain(shape).chain([s, r])).for_each(|(entry, value)| *entry = value);
    all
}

/// All points.
///
/// # Errors
/// What the system says.
pub(crate) fn write_point_shapes(
    contacts: &Contacts,
    found: &PointShapes,
    format: PointShapesFormat,
    out: &mut dyn Write,
) -> std::io::Result<()> {
    let rows = || (0..contacts.len()).map(|r| row(contacts, found, r));
    let column = |k: usize| rows().map(move |row| row[k]);
    match format {
        PointShapesFormat::Csv => write_csv(rows(), out),
        PointShapesFormat::Npz => {
            let mut archive = NpzWriter::stored(Cursor::new(Vec::new()));
            for (k, name) in COLUMNS.into_iter().enumerate() {
                archive.add(name, &[contacts.len()], column(k))?;
            }
            out.write_all(archive.finish()?.get_ref())
        }
        PointShapesFormat::Ply => {
            let head = "ply\nformat binary_little_endian 1.0\ncomment shape at points by palpate\n";
            writeln!(out, "{head}element vertex {}", contacts.len())?;
            COLUMNS.iter().try_for_each(|name| writeln!(out, "property double {name}"))?;
            writeln!(out, "end_header")?;
            rows().flatten().try_for_each(|value| out.write_all(&value.to_le_bytes()))
        }
        PointShapesFormat::Parquet => {
            let columns: Vec<Vec<f64>> = (0..COLUMNS.len()).map(|k| column(k).collect()).collect();
            write_parquet("point", &COLUMNS.map(String::from), &columns, out)
        }
    }
}

fn write_csv(rows: impl Iterator<Item = [f64; 12]>, out: &mut dyn Write) -> std::io::Result<()> {
    writeln!(out, "{}", COLUMNS.join(","))?;
    let mut line = String::new();
    for row in rows {
        line.clear();
        for (k, value) in row.iter().enumerate() {
            if k > 0 {
                line.push(',');
            }
            if value.is_finite() {
                let _ = write!(line, "{value}");
            }
        }
        line.push('\n');
        out.write_all(line.as_bytes())?;
    }
    Ok(())
}

/// A few lines for people.
///
/// # Errors
/// What the system says.
pub(crate) fn write_point_shapes_summary(
    input: &str,
    found: &PointShapes,
    notes: &[String],
    out: &mut dyn Write,
) -> std::io::Result<()> {
    let mut text = format!(
        "points     {} of {input}, some {} apart; the shape at each is that of {} neighbours\n",
        found.curvedness.len(),
        significant(found.spacing, 2),
        found.neighbours
    );
    let normals = found.normal_noise_deg.map_or(String::new(), |d| format!(", normals {} degrees", significant(d, 2)));
    let _ = writeln!(text, "noise      {} along the normal{normals}", significant(found.noise, 2));
    for (name, values, u) in
        [("S", &found.shape_index, &found.u_shape_index), ("R", &found.curvedness, &found.u_curvedness)]
    {
        let Some([low, middle, high]) = quantiles(values) else { continue };
        let doubt = quantiles(u).map_or(String::new(), |[_, u, _]| format!("; median u {}", significant(u, 2)));
        let _ = writeln!(
            text,
            "{name:<10} median {}, nine points in ten between {} and {}{doubt}",
            significant(middle, 4),
            significant(low, 4),
            significant(high, 4)
        );
    }
    for note in notes.iter().chain(&found.notes) {
        let _ = writeln!(text, "note       {note}");
    }
    out.write_all(text.as_bytes())
}

/// The 5th, 50th and 95th percentile of what is defined.
fn quantiles(values: &[f64]) -> Option<[f64; 3]> {
    let mut known: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    let [low, middle, high] = [0.05, 0.5, 0.95].map(|share| quantile(&mut known, share, Rank::FloorOfSteps));
    Some([low?, middle?, high?])
}
