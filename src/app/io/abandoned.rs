//! Temporary files of processes that were killed before they could remove them.
//!
//! ```text
//! .palpate-PID-XXXXXX        removed by the next run that writes into the directory, once no process PID is there
//! ```

use std::path::Path;
use std::time::Duration;

/// How a temporary file's name begins.
const PREFIX: &str = ".palpate-";

/// Where the system does not tell which processes there are, a temporary file is abandoned after a day.
const ABANDONED_AFTER: Duration = Duration::from_secs(24 * 3600);

/// How this process begins the names of its temporary files.
pub(super) fn temporary_prefix() -> String {
    format!("{PREFIX}{}-", std::process::id())
}

/// Removes what ended processes have left in a directory. What cannot be removed stays; it is in nobody's way.
pub(super) fn remove_abandoned(directory: &Path) {
    let Ok(entries) = std::fs::read_dir(directory) else { return };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let Some(process) = name.to_str().and_then(process_of) else { continue };
        if process != std::process::id() && !is_running(process, &entry) {
            let path = entry.path();
            let _ = if path.is_dir() { std::fs::remove_dir_all(path) } else { std::fs::remove_file(path) };
        }
    }
}

/// The process that a temporary file's name tells.
fn process_of(name: &str) -> Option<u32> {
    name.strip_prefix(PREFIX)?.split_once('-')?.0.parse().ok()
}

fn is_running(process: u32, entry: &std::fs::DirEntry) -> bool {
    let processes = Path::new("/proc");
    if processes.join("self").exists() {
        return processes.join(process.to_string()).exists();
    }
    let age = entry.metadata().and_then(|found| found.modified()).ok().and_then(|changed| changed.elapsed().ok());
    age.is_none_or(|age| age < ABANDONED_AFTER)
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn what_a_killed_process_left_is_removed_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        // above the largest number that Linux gives a process
        let gone = u32::MAX;
        std::fs::write(at(&format!(".palpate-{gone}-abcdef")), "half").unwrap();
        std::fs::create_dir(at(&format!(".palpate-{gone}-ghijkl"))).unwrap();
        let mine = format!("{}abcdef", temporary_prefix());
        // process 1 is there on every Linux
        let kept = [mine.as_str(), ".palpate-1-abcdef", ".palpate-notes", "out.csv"];
        kept.iter().for_each(|name| std::fs::write(at(name), "").unwrap());
        remove_abandoned(folder.path());
        let mut left: Vec<String> =
            std::fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        left.sort();
        let mut kept = kept.map(String::from).to_vec();
        kept.sort();
        assert_eq!(left, kept);
    }
}
