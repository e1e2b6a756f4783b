//! Whether two names are of one file, by whatever way: links, `..`, another working directory.

use std::path::Path;

/// Both are the same regular file. What is no regular file, such as a terminal, may be read and written.
pub(crate) fn same_file(a: &Path, b: &Path) -> bool {
    let (Ok(found_a), Ok(found_b)) = (std::fs::metadata(a), std::fs::metadata(b)) else { return false };
    if !(found_a.is_file() && found_b.is_file()) {
        return false;
    }
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        (found_a.dev(), found_a.ino()) == (found_b.dev(), found_b.ino())
    }
    #[cfg(not(unix))]
    {
        matches!((std::fs::canonicalize(a), std::fs::canonicalize(b)), (Ok(a), Ok(b)) if a == b)
    }
}

/// Both name one place: the same file, or the same name in the same directory where there is no file yet.
pub(crate) fn same_place(a: &Path, b: &Path) -> bool {
    let place = |path: &Path| {
        let directory = path.parent().filter(|d| !d.as_os_str().is_empty()).unwrap_or(Path::new("."));
        Some((std::fs::canonicalize(directory).ok()?, path.file_name()?.to_os_string()))
    };
    let is_device = |path: &Path| std::fs::metadata(path).is_ok_and(|found| !found.is_file() && !found.is_dir());
    same_file(a, b) || (!is_device(a) && place(a).is_some_and(|of_a| place(b) == Some(of_a)))
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn links_and_detours_lead_to_one_file() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::write(at("a"), "").unwrap();
        std::fs::write(at("b"), "").unwrap();
        std::fs::create_dir(at("d")).unwrap();
        std::fs::hard_link(at("a"), at("hard")).unwrap();
        std::os::unix::fs::symlink(at("a"), at("soft")).unwrap();
        for same in ["a", "hard", "soft", "d/../a"] {
            assert!(same_file(&at("a"), &at(same)), "{same}");
        }
        for other in ["b", "d", "nothing"] {
            assert!(!same_file(&at("a"), &at(other)), "{other}");
        }
        assert!(!same_file(Path::new("/dev/null"), Path::new("/dev/null")));
    }

    #[test]
    fn a_place_is_known_before_there_is_a_file() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::create_dir(at("d")).unwrap();
        assert!(same_place(&at("new"), &at("d/../new")) && same_place(&at("d/x"), &at("d/./x")));
        assert!(!same_place(&at("new"), &at("d/new")) && !same_place(&at("new"), &at("other")));
        assert!(!same_place(Path::new("/dev/null"), Path::new("/dev/null")));
    }
}
