//! Cells that are finished, one JSON line each, so that a run that was ended goes on where it stopped.

use std::fs::OpenOptions;
use std::io::Write;
use std::path::{Path, PathBuf};

use crate::cells::cell::Cell;

/// The finished cells and the file that keeps them.
pub(crate) struct State {
    path: Option<PathBuf>,
    cells: Vec<Cell>,
}

impl State {
    /// Reads the file if there is one. A last line that a kill cut short is left out.
    pub(crate) fn open(path: Option<&Path>) -> State {
        let text = path.and_then(|path| std::fs::read_to_string(path).ok()).unwrap_or_default();
        let whole = text.lines().filter_map(|line| serde_json::from_str(line).ok());
        State { path: path.map(Path::to_path_buf), cells: whole.collect() }
    }

    /// The finished cell of this scene, if its seed and its number of fits are the same.
    pub(crate) fn finished(&self, scene: &str, seed: u64, replicates: u64) -> Option<&Cell> {
        self.cells.iter().find(|c| c.scene == scene && c.seed == seed && c.replicates == replicates)
    }

    /// Appends a cell, and its line.
    pub(crate) fn keep(&mut self, cell: Cell) -> std::io::Result<()> {
        if let Some(path) = &self.path {
            let mut file = OpenOptions::new().create(true).append(true).open(path)?;
            // the line break first ends a line that was cut short
            writeln!(file, "\n{}", serde_json::to_string(&cell)?)?;
        }
        self.cells.push(cell);
        Ok(())
    }
}
