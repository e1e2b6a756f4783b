//! `palpate diff A B`: two saved surfaces compared, each difference against its uncertainty.

use std::path::{Path, PathBuf};

use clap::Args;

use crate::comparison::{ComparedSurface, Comparison, NotComparable, Quantities, Side, compare};
use crate::io::{AnySurface, MOST_GRID_POINTS, Saved, exceeds, read_bytes, read_surface_bytes};
use crate::report::{
    DiffDocument, FitDocument, PAGE_WIDTH, SurfacePart, TablePage, write_diff_csv, write_diff_picture,
    write_diff_table, write_json, write_table_page,
};

use super::failure::Failure;
use super::options::OutputFlags;
use super::output::{columns, print};
use super::provenance::provenance;
use super::values;

/// Points each way where nothing says.
pub(super) const DEFAULT_DIFF_GRID: [usize; 2] = [25, 25];

/// Arguments of `palpate diff`.
#[derive(Args)]
pub(super) struct DiffArgs {
    /// A surface that `--save` wrote (.json, .step, .igs); - for standard input
    a: PathBuf,
    /// The surface that it is compared with
    b: PathBuf,
    /// Points of the common domain at which the two are compared [default: 25x25]
    #[arg(long, value_name = "NxM", value_parser = values::grid_points)]
    grid: Option<[usize; 2]>,
    #[command(flatten)]
    output: OutputFlags,
}

pub(super) fn diff(args: &DiffArgs) -> Result<(), Failure> {
    if args.a.as_os_str() == "-" && args.b.as_os_str() == "-" {
        return Err(Failure::Input("A and B cannot both be standard input".into()));
    }
    let (a, b) = (ComparedFile::read(&args.a)?, ComparedFile::read(&args.b)?);
    args.output.prepare(&[&args.a, &args.b], &[])?;
    let (found, document) = compared(&a, &b, args.grid.unwrap_or(DEFAULT_DIFF_GRID))?;
    args.output.file("diff.json", &mut |out| write_json(&document, out))?;
    args.output.file("diff.csv", &mut |out| write_diff_csv(&found, out))?;
    args.output.file("diff.svg", &mut |out| write_diff_picture(&document, &found, out))?;
    let (mut json, mut table) = (Vec::new(), Vec::new());
    // a Vec takes every byte
    let _ = write_json(&document, &mut json).and_then(|()| write_diff_table(&document, PAGE_WIDTH, &mut table));
    let both = format!("{} and {}", a.saved.file, b.saved.file);
    let page = TablePage {
        kind: "two saved surfaces compared",
        title: &both,
        lead: "Heights, normals, S and R of both surfaces at the same points, each difference against its uncertainty.",
        document: &json,
        table: &table,
    };
    let provenance = provenance(&both, None, None);
    args.output.file("report.html", &mut |out| write_table_page(&page, &provenance, out))?;
    args.output.publish()?;
    if args.output.json {
        return print(&mut |out| write_json(&document, out));
    }
    if args.output.quiet {
        return Ok(());
    }
    args.output.tell(&mut |out| write_diff_table(&document, columns(), out))
}

/// The two compared at so many points each way, and the document that says so.
pub(super) fn compared(
    a: &ComparedFile,
    b: &ComparedFile,
    grid: [usize; 2],
) -> Result<(Comparison, DiffDocument), Failure> {
    if exceeds(grid, MOST_GRID_POINTS) || grid.iter().any(|n| *n < 2) {
        let [n, m] = grid;
        return Err(Failure::Input(format!(
            "--grid {n}x{m}: give 2 or more points each way, at most {MOST_GRID_POINTS} in all"
        )));
    }
    if let (Some(first), Some(second)) = (&a.unit, &b.unit)
        && first != second
    {
        return Err(Failure::Input(format!(
            "{} is in {first} and {} in {second}: fit both in one unit",
            a.saved.file, b.saved.file
        )));
    }
    let found = a.with(|a| b.with(|b| compare(a, b, grid))).map_err(|why| refusal(a, b, why))?;
    let document = DiffDocument::of(&found, a.part(), b.part());
    Ok((found, document))
}

/// A surface that was read, with the degrees of freedom behind its uncertainties.
pub(super) struct ComparedFile {
    saved: Saved,
    dof: Option<f64>,
    recognised: bool,
    unit: Option<String>,
}

impl ComparedFile {
    fn read(path: &Path) -> Result<ComparedFile, Failure> {
        let (file, bytes) = read_bytes(path)?;
        ComparedFile::of(file, &bytes)
    }

    /// From the bytes of a file by its name.
    pub(super) fn of(file: String, bytes: &[u8]) -> Result<ComparedFile, Failure> {
        let saved = read_surface_bytes(&file, bytes)?;
        let document: Option<FitDocument> = serde_json::from_slice(bytes).ok();
        let dof = document.as_ref().and_then(|document| document.shape.curvedness.dof);
        let unit = document.as_ref().and_then(|document| document.unit.clone());
        let chosen = document.and_then(|document| document.fit.chosen);
        let recognised = chosen.is_some_and(|chosen| chosen.hypothesis.is_some());
        let dof = dof.filter(|_| saved.uncertainty.is_some());
        Ok(ComparedFile { saved, dof, recognised, unit })
    }

    fn part(&self) -> SurfacePart {
        SurfacePart {
            file: self.saved.file.clone(),
            kind: match self.saved.surface {
                AnySurface::Height(_) => "height".into(),
                AnySurface::Parametric(..) => "parametric".into(),
                AnySurface::Hierarchical(_) => "adaptive".into(),
            },
            uncertainty: self.saved.uncertainty.is_some(),
            recognised: self.recognised,
        }
    }

    /// Hands the surface to a comparison.
    fn with<T>(&self, compare: impl FnOnce(&Side) -> T) -> T {
        let saved = &self.saved;
        let surface = match &saved.surface {
            AnySurface::Height(field) => ComparedSurface::Height(field, &saved.frame),
            AnySurface::Parametric(map, _) => ComparedSurface::Space(map),
            AnySurface::Hierarchical(field) => ComparedSurface::Height(&**field, &saved.frame),
        };
        let supported = |place: [f64; 2]| saved.supports(place);
        let uncertainty = |place: [f64; 2]| -> Quantities {
            let Some(map) = &saved.uncertainty else { return [None; 4] };
            let u = map.at(place);
            [u.position, u.normal_deg, u.shape_index, u.curvedness]
        };
        compare(&Side { surface, supported: &supported, uncertainty: &uncertainty, dof: self.dof })
    }
}

fn refusal(a: &ComparedFile, b: &ComparedFile, why: NotComparable) -> Failure {
    let (first, second) = (&a.saved.file, &b.saved.file);
    Failure::Input(match why {
        NotComparable::OppositeSides => format!(
            "{first} and {second} have their free sides on opposite sides; fit one of them again with --flip-normals"
        ),
        NotComparable::Apart { a, b } => format!(
            "{first} and {second} have no part in common: A lies in {}, B in {}{}",
            extent(a),
            extent(b),
            unit_hint(a, b)
        ),
    })
}

fn extent([lo, hi]: [[f64; 3]; 2]) -> String {
    let axes = ["x", "y", "z"];
    (0..3).map(|k| format!("{} {:.4} .. {:.4}", axes[k], lo[k], hi[k])).collect::<Vec<_>>().join(", ")
}

/// Factors between units of length that are in use.
const UNITS: [(f64, &str); 4] = [
    (10.0, "one may be in mm and the other in cm"),
    (25.4, "one may be in mm and the other in inches"),
    (1000.0, "one may be in mm and the other in m"),
    (100.0, "one may be in cm and the other in m"),
];

/// Says that the units may differ where the sizes differ by a known factor.
fn unit_hint(a: [[f64; 3]; 2], b: [[f64; 3]; 2]) -> String {
    let size = |[lo, hi]: [[f64; 3]; 2]| (0..3).map(|k| hi[k] - lo[k]).fold(0.0, f64::max);
    let (a, b) = (size(a), size(b));
    let factor = (a / b).max(b / a);
    let known = UNITS.iter().find(|(f, _)| (factor / f - 1.0).abs() < 0.1);
    known.map_or("; they may be in different frames".into(), |(f, words)| {
        format!("; their sizes differ by a factor near {f}: {words}")
    })
}
