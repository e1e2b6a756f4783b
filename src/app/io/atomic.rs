//! Outputs appear whole or not at all: written beside the target under another name, then renamed.
//!
//! A process ended by Ctrl-C calls [`remove_unfinished`] first, so that it leaves neither half a file nor a temporary one.

use std::collections::BTreeSet;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::IoError;
use super::abandoned::{remove_abandoned, temporary_prefix};

static UNFINISHED: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// How often the removal of what is unfinished is tried.
const REMOVALS: usize = 20;

fn unfinished() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Writes `path` through `fill`: complete under its name, or untouched. `-` is standard output.
///
/// What is no regular file (a pipe, `/dev/null`) is written in place; renaming over it would destroy it.
///
/// # Errors
/// [`IoError::Write`] with the target's path.
pub(crate) fn write_atomically(
    path: &Path,
    fill: &mut dyn FnMut(&mut dyn Write) -> std::io::Result<()>,
) -> Result<(), IoError> {
    let outcome = if path == Path::new("-") {
        let mut out = std::io::stdout().lock();
        fill(&mut out).and_then(|()| out.flush())
    } else {
        match std::fs::metadata(path) {
            Ok(found) if found.is_dir() => Err(std::io::Error::other("it is a directory; name a file in it")),
            Ok(found) if !found.is_file() => in_place(path, fill),
            // through a link to the file it names, so that the link stays a link
            Ok(_) => std::fs::canonicalize(path).and_then(|target| by_rename(&target, fill)),
            Err(_) => by_rename(path, fill),
        }
    };
    outcome.map_err(|source| IoError::Write { path: path.into(), source })
}

fn in_place(path: &Path, fill: &mut dyn FnMut(&mut dyn Write) -> std::io::Result<()>) -> std::io::Result<()> {
    let mut out = BufWriter::new(std::fs::OpenOptions::new().write(true).open(path)?);
    fill(&mut out)?;
    out.flush()
}

fn by_rename(path: &Path, fill: &mut dyn FnMut(&mut dyn Write) -> std::io::Result<()>) -> std::io::Result<()> {
    let directory = path.parent().filter(|d| !d.as_os_str().is_empty()).unwrap_or(Path::new("."));
    remove_abandoned(directory);
    let prefix = temporary_prefix();
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix);
    #[cfg(unix)]
    {
        // as any new file: readable by all that the umask lets
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let temporary = hold(|| builder.tempfile_in(directory), |made| made.path().to_path_buf())?;
    let name = temporary.path().to_path_buf();
    let mut out = BufWriter::new(temporary);
    let outcome = fill(&mut out).and_then(|()| out.into_inner().map_err(|e| e.into_error()));
    let mut unfinished = unfinished();
    unfinished.remove(&name);
    outcome?.persist(path).map(drop).map_err(|e| e.error)
}

/// Makes something temporary that [`remove_unfinished`] shall remove until it is released.
pub(super) fn hold<T>(make: impl FnOnce() -> std::io::Result<T>, path: impl Fn(&T) -> PathBuf) -> std::io::Result<T> {
    let mut unfinished = unfinished();
    let made = make()?;
    unfinished.insert(path(&made));
    Ok(made)
}

/// What was held is whole, or gone.
pub(super) fn release(path: &Path) {
    unfinished().remove(path);
}

/// Removes every temporary file and prevents new ones: the caller is about to end the process.
pub(crate) fn remove_unfinished() {
    let mut unfinished = unfinished();
    for path in std::mem::take(&mut *unfinished) {
        // a thread may still put files into a folder; nothing can be done about what stays, and the process is ending
        let remove = || if path.is_dir() { std::fs::remove_dir_all(&path) } else { std::fs::remove_file(&path) };
        let _ = (0..REMOVALS).any(|_| remove().is_ok());
    }
    std::mem::forget(unfinished);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failing_writer_leaves_the_old_file_and_nothing_else() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("out.csv");
        write_atomically(&path, &mut |out| out.write_all(b"old")).unwrap();
        let failed = write_atomically(&path, &mut |out| {
            out.write_all(b"half")?;
            Err(std::io::Error::other("no more"))
        });
        assert!(matches!(failed, Err(IoError::Write { .. })));
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
        assert_eq!(std::fs::read_dir(directory.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_directory_that_is_not_there_is_named() {
        let path = Path::new("no/such/directory/out.csv");
        let error = write_atomically(path, &mut |out| out.write_all(b"x")).unwrap_err();
        assert!(error.to_string().contains("no/such/directory/out.csv"));
    }

    #[cfg(unix)]
    #[test]
    fn links_stay_links_and_devices_stay_devices() {
        let directory = tempfile::tempdir().unwrap();
        let (file, link) = (directory.path().join("file"), directory.path().join("link"));
        std::fs::write(&file, b"old").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        write_atomically(&link, &mut |out| out.write_all(b"new")).unwrap();
        assert!(std::fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(std::fs::read(&file).unwrap(), b"new");
        write_atomically(Path::new("/dev/null"), &mut |out| out.write_all(b"gone")).unwrap();
        assert!(!std::fs::metadata("/dev/null").unwrap().is_file());
    }
}
