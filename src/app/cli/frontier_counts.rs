//! Instructions of every call of a frontier, by callgrind: the same in every run, whatever else the machine does.
//!
//! ```text
//! palpate frontier SCENE --count    starts     valgrind --tool=callgrind palpate frontier SCENE --counted
//! palpate frontier SCENE --counted  makes every call once, in the order of the frontier; callgrind dumps after each
//! ```
//!
//! valgrind has no AVX-512, so that these are the instructions of the AVX2 path. It makes calls some fifty times as slow as they are, so
//! that the counts that are done when the time is over are all: callgrind writes each as its call ends.

use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::Instant;

use palpate_studies::frontier::counted_region;

use super::interrupt;
use super::until::{LOOK, Until};

/// What callgrind found: instructions call by call, of the first calls alone where its time was over, or why there are none.
pub(super) type Counts = Result<Vec<u64>, String>;

/// Makes every call once under whatever counts, after one that fills what is filled once in a process.
pub(super) fn make_calls<R>(calls: &mut [Box<dyn FnMut(u64) -> R + '_>]) {
    if let Some(first) = calls.first_mut() {
        drop(first(0));
    }
    for call in calls {
        drop(counted_region(&mut || call(0)));
    }
}

/// What is said of calls that were not counted in time.
pub(super) fn uncounted(counts: &Counts, calls: usize, seconds: f64) -> Option<String> {
    let done = counts.as_ref().map_or(calls, Vec::len);
    (done < calls).then(|| {
        format!("instructions of {done} of {calls} calls were counted: the {seconds} s for it were over; --count=S gives more")
    })
}

/// Counts the calls of `palpate ARGUMENTS --counted`, of which there are `calls`, for so many seconds.
pub(super) fn count(arguments: &[&str], calls: usize, seconds: f64) -> Counts {
    let folder = tempfile::tempdir().map_err(|e| format!("not counted: {e}"))?;
    let program = std::env::current_exe().map_err(|e| format!("not counted: {e}"))?;
    let outcome = Command::new("valgrind")
        .args([
            "--tool=callgrind",
            "--toggle-collect=*counted_region*",
            "--dump-after=palpate_studies::frontier::clock::counted_region",
        ])
        .args(["--compress-pos=yes", "--dump-line=no"])
        .arg(format!("--callgrind-out-file={}", folder.path().join("counts").display()))
        .arg(program)
        .args(arguments)
        .arg("--counted")
        // what stands in the environment moves the stack, and with it a few instructions
        .env_clear()
        .env("PATH", std::env::var_os("PATH").unwrap_or_default())
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .map(|child| ended(child, Until::seconds_after(Instant::now(), Some(seconds))));
    match outcome {
        Ok(None) if interrupt::asked() => Err("not counted: interrupted".into()),
        Ok(None) => Ok(first_dumped(folder.path(), calls)),
        Err(_) | Ok(Some(Err(_))) => Err("not counted: valgrind is not installed".into()),
        Ok(Some(Ok(status))) if !status.success() => Err(format!("not counted: valgrind ended with {status}")),
        Ok(Some(Ok(_))) => (1..=calls).map(|number| dumped(folder.path(), number)).collect(),
    }
}

/// How the counter ended; `None` where its time was over or Ctrl-C came before, which may have been sent to this process alone.
fn ended(mut child: Child, until: Until) -> Option<std::io::Result<ExitStatus>> {
    loop {
        match child.try_wait() {
            Ok(None) if until.is_over() => {
                // it may have ended by itself in the meantime
                let _ = child.kill().and_then(|()| child.wait());
                return None;
            }
            Ok(None) => std::thread::sleep(LOOK),
            Ok(Some(status)) => return Some(Ok(status)),
            Err(error) => return Some(Err(error)),
        }
    }
}

/// Instructions of the first calls, as many as were written before the counter was ended; the last one may be half written.
fn first_dumped(folder: &Path, calls: usize) -> Vec<u64> {
    (1..=calls).map_while(|number| dumped(folder, number).ok()).collect()
}

/// Instructions in the dump after call `number`.
fn dumped(folder: &Path, number: usize) -> Result<u64, String> {
    let path = folder.join(format!("counts.{number}"));
    let text = std::fs::read_to_string(&path).map_err(|_| "not counted: callgrind found no call".to_string())?;
    let total = text.lines().rev().find_map(|line| line.strip_prefix("totals:").or(line.strip_prefix("summary:")));
    let total = total.and_then(|words| words.trim().parse::<u64>().ok()).filter(|count| *count > 0);
    total.ok_or_else(|| "not counted: callgrind counted nothing".to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_that_were_written_in_time_are_kept_and_the_rest_is_said() {
        let folder = tempfile::tempdir().unwrap();
        let whole = |count: u64| format!("version: 1\nevents: Ir\nfn=(1)\n0 {count}\n\ntotals: {count}\n");
        for (number, text) in [(1, whole(900)), (2, whole(700)), (3, whole(500)[..30].to_string()), (4, whole(300))] {
            std::fs::write(folder.path().join(format!("counts.{number}")), text).unwrap();
        }
        let counts = Ok(first_dumped(folder.path(), 6));
        assert_eq!(counts, Ok(vec![900, 700]));
        assert!(uncounted(&counts, 6, 2.0).unwrap().starts_with("instructions of 2 of 6 calls were counted: the 2 s"));
        assert_eq!(uncounted(&counts, 2, 2.0), None);
        assert_eq!(uncounted(&Err("not counted: interrupted".into()), 6, 2.0), None);
    }
}
