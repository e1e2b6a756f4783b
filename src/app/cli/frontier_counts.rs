//! Instructions of every call of a frontier, by callgrind: the same in every run, whatever else the machine does.
//!
//! ```text
//! palpate frontier SCENE --count    starts     valgrind --tool=callgrind palpate frontier SCENE --counted
//! palpate frontier SCENE --counted  makes every call once, in the order of the frontier; callgrind dumps after each
//! ```
//!
//! valgrind has no AVX-512, so that these are the instructions of the AVX2 path.

use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};

use palpate_studies::frontier::counted_region;

use super::until::{LOOK, Until};

/// What callgrind found: instructions call by call, or why there are none.
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

/// Counts the calls of `palpate ARGUMENTS --counted`, of which there are `calls`.
pub(super) fn count(arguments: &[&str], calls: usize) -> Counts {
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
        .map(|child| ended(child, Until::interrupted()));
    let outcome = match outcome {
        Ok(Some(status)) => status,
        Ok(None) => return Err("not counted: interrupted".into()),
        Err(error) => Err(error),
    };
    match outcome {
        Err(_) => Err("not counted: valgrind is not installed".into()),
        Ok(status) if !status.success() => Err(format!("not counted: valgrind ended with {status}")),
        Ok(_) => (1..=calls).map(|number| dumped(folder.path(), number)).collect(),
    }
}

/// How the counter ended; `None` where Ctrl-C came before, which may have been sent to this process alone.
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

/// Instructions in the dump after call `number`.
fn dumped(folder: &Path, number: usize) -> Result<u64, String> {
    let path = folder.join(format!("counts.{number}"));
    let text = std::fs::read_to_string(&path).map_err(|_| "not counted: callgrind found no call".to_string())?;
    let total = text.lines().rev().find_map(|line| line.strip_prefix("totals:").or(line.strip_prefix("summary:")));
    let total = total.and_then(|words| words.trim().parse::<u64>().ok()).filter(|count| *count > 0);
    total.ok_or_else(|| "not counted: callgrind counted nothing".to_string())
}
