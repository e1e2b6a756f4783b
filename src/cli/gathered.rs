//! Files on their way into an output directory, which hold back until all of them are whole.

use std::io::Write;
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::io::{IoError, Together};

/// The files of one run; clones share them.
#[derive(Clone, Debug, Default)]
pub(super) struct Gathered(Arc<Mutex<Option<Together>>>);

impl Gathered {
    fn files(&self) -> MutexGuard<'_, Option<Together>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Writes one of the files for `directory`, out of sight.
    pub(super) fn write(
        &self,
        directory: &Path,
        name: &str,
        fill: &mut dyn FnMut(&mut dyn Write) -> std::io::Result<()>,
    ) -> Result<(), IoError> {
        let mut files = self.files();
        let mut gathered = match files.take() {
            Some(gathered) => gathered,
            None => Together::new(directory)?,
        };
        // a file that fails takes the others with it
        gathered.write(name, fill)?;
        *files = Some(gathered);
        Ok(())
    }

    /// All files, to be published.
    pub(super) fn take(&self) -> Option<Together> {
        self.files().take()
    }
}
