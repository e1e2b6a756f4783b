//! Standard output, the output directory, and a spinner for people who wait.

use std::io::Write;
use std::path::Path;
use std::time::Duration;

use indicatif::ProgressBar;

use crate::io::write_atomically;

use super::failure::Failure;
use super::options::OutputFlags;

/// Fills one output.
pub(super) type Fill<'a> = &'a mut dyn FnMut(&mut dyn Write) -> std::io::Result<()>;

impl OutputFlags {
    /// Makes sure of the output directory before any work is done for it.
    pub(super) fn prepare(&self) -> Result<(), Failure> {
        let Some(directory) = &self.out else { return Ok(()) };
        std::fs::create_dir_all(directory)
            .map_err(|e| Failure::Input(format!("--out {}: cannot be made a directory: {e}", directory.display())))
    }

    /// Writes `name` into the output directory, if one is asked for.
    pub(super) fn file(&self, name: &str, fill: Fill) -> Result<(), Failure> {
        match &self.out {
            Some(directory) => Ok(write_atomically(&directory.join(name), fill)?),
            None => Ok(()),
        }
    }

    /// A spinner on a terminal's standard error; nothing elsewhere.
    pub(super) fn spinner(&self, what: impl Into<String>) -> Spinner {
        if self.quiet {
            return Spinner(ProgressBar::hidden());
        }
        let bar = ProgressBar::new_spinner().with_message(what.into());
        // short work ends before the first tick and shows nothing
        bar.enable_steady_tick(Duration::from_millis(250));
        Spinner(bar)
    }
}

/// Goes away when dropped.
pub(super) struct Spinner(ProgressBar);

impl Drop for Spinner {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

/// Writes to standard output, whole.
pub(super) fn print(fill: Fill) -> Result<(), Failure> {
    Ok(write_atomically(Path::new("-"), fill)?)
}
