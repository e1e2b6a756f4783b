//! `palpate fit A B C --table F.csv`: several files, a row of each; what fails has its reason in its row, and the others go on.

use std::path::{Path, PathBuf};

use crate::io::{visible, write_atomically};
use crate::report::{FitDocument, FitsDocument, FitsRow, write_fits_csv, write_fits_line, write_json};

use super::failure::Failure;
use super::options::OutputFlags;
use super::output::print;

/// Fits file after file by `fit`.
pub(super) fn fit_several(
    inputs: &[PathBuf],
    table: Option<&Path>,
    output: &OutputFlags,
    fit: impl Fn(&Path) -> Result<FitDocument, Failure>,
) -> Result<(), Failure> {
    let to_stdout = table.is_some_and(|table| table.as_os_str() == "-");
    if to_stdout && output.json {
        return Err(Failure::Input("--table - and --json both want standard output; give --table a file".into()));
    }
    let files: Vec<&Path> = inputs.iter().map(PathBuf::as_path).collect();
    let tables: Vec<PathBuf> = table.into_iter().map(Path::to_path_buf).collect();
    output.prepare(&files, &tables)?;
    let width = inputs.iter().map(|input| name(input).chars().count()).max().unwrap_or(0);
    let (mut rows, mut nobody_reads) = (Vec::new(), false);
    for input in inputs {
        let spinner = output.spinner(format!("fitting {}", input.display()));
        let outcome = fit(input);
        drop(spinner);
        let row = match outcome {
            Ok(document) => FitsRow::of(name(input), &document),
            Err(Failure::ClosedPipe) => return Err(Failure::ClosedPipe),
            Err(failure) => FitsRow::failed(name(input), visible(&failure.into_message())),
        };
        if !(output.json || output.quiet || to_stdout || nobody_reads) {
            match print(&mut |out| write_fits_line(&row, width, out)) {
                // the table is still wanted
                Err(Failure::ClosedPipe) if table.is_some() => nobody_reads = true,
                printed => printed?,
            }
        }
        rows.push(row);
    }
    let failed = rows.iter().filter(|row| row.error.is_some()).count();
    let document = FitsDocument::of(rows);
    if let Some(table) = table {
        write_atomically(table, &mut |out| write_fits_csv(&document.files, out))?;
    }
    if output.json {
        print(&mut |out| write_json(&document, out))?;
    }
    if failed == 0 {
        return Ok(());
    }
    Err(Failure::Input(format!(
        "{failed} of {} files have no answer; the reason stands in the row of each",
        inputs.len()
    )))
}

fn name(input: &Path) -> String {
    visible(&input.display().to_string())
}
