//! A folder for what is too large for memory: gone when it is dropped, and on Ctrl-C.
//!
//! ```text
//! TMPDIR, else /var/tmp on Unix, else the system's temporary folder       .palpate-PID-XXXXXX
//! ```
//!
//! `/tmp` lies in memory on many systems, which is what such files are to spare; `/var/tmp` is meant for large ones.

use std::path::{Path, PathBuf};

use tempfile::TempDir;

use super::IoError;
use super::abandoned::{remove_abandoned, temporary_prefix};
use super::atomic::{hold, release};

/// A folder that is removed with all that is in it.
#[derive(Debug)]
pub(crate) struct TemporaryFolder {
    folder: TempDir,
}

/// Where such folders are made.
fn place() -> PathBuf {
    let large = Path::new("/var/tmp");
    if std::env::var_os("TMPDIR").is_none() && cfg!(unix) && large.is_dir() {
        large.into()
    } else {
        std::env::temp_dir()
    }
}

impl TemporaryFolder {
    /// A new one; what killed processes have left beside it is removed.
    ///
    /// # Errors
    /// [`IoError::Write`].
    pub(crate) fn new() -> Result<TemporaryFolder, IoError> {
        let place = place();
        remove_abandoned(&place);
        let make = || tempfile::Builder::new().prefix(&temporary_prefix()).tempdir_in(&place);
        let folder = hold(make, |made: &TempDir| made.path().to_path_buf());
        Ok(TemporaryFolder { folder: folder.map_err(|source| IoError::Write { path: place, source })? })
    }

    /// Where it is.
    pub(crate) fn path(&self) -> &Path {
        self.folder.path()
    }
}

impl Drop for TemporaryFolder {
    fn drop(&mut self) {
        release(self.folder.path());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_gone_with_all_that_is_in_it() {
        let folder = TemporaryFolder::new().unwrap();
        let path = folder.path().to_path_buf();
        std::fs::write(path.join("tile"), "contacts").unwrap();
        drop(folder);
        assert!(!path.exists());
    }
}
