//! The files of one run in a directory: all of them or none.
//!
//! They are written into a temporary directory inside it and moved out together when the last is whole. A run that fails, or
//! is ended by Ctrl-C, leaves the directory as it was.

use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::TempDir;

use super::IoError;
use super::abandoned::{remove_abandoned, temporary_prefix};
use super::atomic::{hold, release};

/// Files that belong together; dropped without [`Together::publish`], they were never there.
#[derive(Debug)]
pub(crate) struct Together {
    directory: PathBuf,
    temporary: Option<TempDir>,
    names: Vec<String>,
}

impl Together {
    /// Files for a directory that is there.
    ///
    /// # Errors
    /// [`IoError::Write`].
    pub(crate) fn new(directory: &Path) -> Result<Together, IoError> {
        remove_abandoned(directory);
        let make = || tempfile::Builder::new().prefix(&temporary_prefix()).tempdir_in(directory);
        let temporary = hold(make, |made: &TempDir| made.path().to_path_buf());
        let temporary = temporary.map_err(|source| IoError::Write { path: directory.into(), source })?;
        Ok(Together { directory: directory.into(), temporary: Some(temporary), names: Vec::new() })
    }

    /// Writes one of the files, out of sight.
    ///
    /// # Errors
    /// [`IoError::Write`] with the name that the file was to have.
    pub(crate) fn write(
        &mut self,
        name: &str,
        fill: &mut dyn FnMut(&mut dyn Write) -> std::io::Result<()>,
    ) -> Result<(), IoError> {
        let Some(temporary) = &self.temporary else { return Ok(()) };
        if self.names.iter().any(|written| written == name) {
            let twice = std::io::Error::other("two outputs of one run have this name");
            return Err(IoError::Write { path: self.directory.join(name), source: twice });
        }
        let written = std::fs::File::create(temporary.path().join(name)).and_then(|file| {
            let mut out = BufWriter::new(file);
            fill(&mut out)?;
            out.flush()
        });
        written.map_err(|source| IoError::Write { path: self.directory.join(name), source })?;
        self.names.push(name.into());
        Ok(())
    }

    /// Names of the files that are written.
    pub(crate) fn names(&self) -> &[String] {
        &self.names
    }

    /// Moves all files to their place. Files that they replace are kept aside until the last has arrived, and come back
    /// where one cannot be moved.
    ///
    /// # Errors
    /// [`IoError::Write`]; the directory is then as it was.
    pub(crate) fn publish(mut self) -> Result<(), IoError> {
        let Some(temporary) = self.temporary.take() else { return Ok(()) };
        let targets: Vec<PathBuf> = self.names.iter().map(|name| self.directory.join(name)).collect();
        let moved = match targets.iter().find(|target| target.is_dir()) {
            Some(target) => Err((target, std::io::Error::other("a directory of this name stands there"))),
            None => self.move_all(temporary.path(), &targets),
        };
        release(temporary.path());
        moved.map_err(|(path, source)| IoError::Write { path: path.clone(), source })
    }

    /// Puts every file to its target, or none of them.
    fn move_all<'t>(&self, temporary: &Path, targets: &'t [PathBuf]) -> Result<(), (&'t PathBuf, std::io::Error)> {
        let mut done: Vec<(&Path, Option<PathBuf>)> = Vec::new();
        for (k, (name, target)) in self.names.iter().zip(targets).enumerate() {
            let aside = temporary.join(format!(".replaced-{k}"));
            let outcome = keep_aside(target, &aside).and_then(|kept| {
                let kept = kept.then_some(aside);
                done.push((target, kept));
                put(&temporary.join(name), target)
            });
            if let Err(source) = outcome {
                done.iter().rev().for_each(|(target, kept)| put_back(target, kept.as_deref()));
                return Err((target, source));
            }
        }
        Ok(())
    }
}

/// A copy of the regular file that is about to be replaced, by a link where the file system has them. `false`: there is none.
fn keep_aside(target: &Path, aside: &Path) -> std::io::Result<bool> {
    match std::fs::canonicalize(target) {
        Ok(named) if named.is_file() => {
            std::fs::hard_link(&named, aside).or_else(|_| std::fs::copy(&named, aside).map(drop))?;
            Ok(true)
        }
        _ => Ok(false),
    }
}

/// The target as it was. What fails here cannot be mended, and the error that led here is told.
fn put_back(target: &Path, kept: Option<&Path>) {
    let _ = match kept {
        Some(kept) => put(kept, target),
        None if target.is_file() => std::fs::remove_file(target),
        None => Ok(()),
    };
}

impl Drop for Together {
    fn drop(&mut self) {
        if let Some(temporary) = self.temporary.take() {
            release(temporary.path());
        }
    }
}

/// Moves a file to its place, through a link to the file it names, so that the link stays a link.
fn put(from: &Path, target: &Path) -> std::io::Result<()> {
    match std::fs::metadata(target) {
        Ok(found) if !found.is_file() => std::fs::copy(from, target).map(drop),
        Ok(_) => {
            let named = std::fs::canonicalize(target)?;
            // another file system, behind a link, takes a copy
            std::fs::rename(from, &named).or_else(|_| std::fs::copy(from, &named).map(drop))
        }
        Err(_) => std::fs::rename(from, target),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn content(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> =
            std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn all_files_appear_or_none() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("a"), "old").unwrap();
        let mut lost = Together::new(folder.path()).unwrap();
        lost.write("a", &mut |out| out.write_all(b"half")).unwrap();
        assert!(lost.write("b", &mut |_| Err(std::io::Error::other("no more"))).is_err());
        drop(lost);
        assert_eq!(content(folder.path()), ["a"]);
        assert_eq!(std::fs::read(folder.path().join("a")).unwrap(), b"old");
        let mut kept = Together::new(folder.path()).unwrap();
        kept.write("a", &mut |out| out.write_all(b"new")).unwrap();
        kept.write("b", &mut |out| out.write_all(b"new")).unwrap();
        kept.publish().unwrap();
        assert_eq!(content(folder.path()), ["a", "b"]);
        assert_eq!(std::fs::read(folder.path().join("a")).unwrap(), b"new");
    }

    #[test]
    fn a_move_that_fails_midway_leaves_the_directory_as_it_was() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("a"), "old").unwrap();
        let mut files = Together::new(folder.path()).unwrap();
        for name in ["a", "b", "c"] {
            files.write(name, &mut |out| out.write_all(b"new")).unwrap();
        }
        // the last of the files is lost on its way
        std::fs::remove_file(files.temporary.as_ref().unwrap().path().join("c")).unwrap();
        assert!(files.publish().unwrap_err().to_string().contains("c\""));
        assert_eq!(content(folder.path()), ["a"]);
        assert_eq!(std::fs::read(folder.path().join("a")).unwrap(), b"old");
    }

    #[test]
    fn two_outputs_of_one_name_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let mut files = Together::new(folder.path()).unwrap();
        files.write("a", &mut |out| out.write_all(b"one")).unwrap();
        assert!(files.write("a", &mut |out| out.write_all(b"two")).unwrap_err().to_string().contains("two outputs"));
    }

    #[test]
    fn a_directory_in_the_way_stops_all() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("b")).unwrap();
        let mut files = Together::new(folder.path()).unwrap();
        files.write("a", &mut |out| out.write_all(b"new")).unwrap();
        files.write("b", &mut |out| out.write_all(b"new")).unwrap();
        assert!(files.publish().unwrap_err().to_string().contains("b\""));
        assert_eq!(content(folder.path()), ["b"]);
    }
}
