//! Instructions of one pass, free of the machine's noise: `(I(n + 1 passes) - I(1 pass)) / n`, counted by callgrind on
//! this executable run again with the name of the workload.

use std::process::Command;

/// Enough that the start of the process, which the difference removes, is no longer seen in the last digit.
const PASSES: u64 = 20;

/// Instructions of one pass of `workload`; `None` where valgrind is not installed.
pub(crate) fn per_pass(workload: &str) -> Option<f64> {
    let (once, often) = (total(workload, 1)?, total(workload, PASSES + 1)?);
    Some((often - once) as f64 / PASSES as f64)
}

fn total(workload: &str, passes: u64) -> Option<u64> {
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(std::env::current_exe().ok()?)
        .args(["--passes", workload, &passes.to_string()])
        .output()
        .ok()?;
    let said = String::from_utf8_lossy(&output.stderr);
    let line = said.lines().find(|line| line.contains("Collected :"))?;
    line.rsplit(':').next()?.trim().parse().ok()
}
