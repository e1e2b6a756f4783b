//! Which signals end a command tidily: Ctrl-C, and on Unix termination and hang-up as well.
//!
//! Whoever starts the program with a signal ignored, as `nohup` does with hang-up and a shell script with Ctrl-C of what runs behind
//! it, wants that one ignored, and the others heeded.

use super::interrupt;

/// From now on a signal asks the command to come to an end, or ends the process without leaving unfinished files.
/// Where a handler cannot be set, a signal still ends the process, only less tidily.
#[cfg(unix)]
pub(super) fn heed() {
    use signal_hook::consts::signal::{SIGHUP, SIGINT, SIGTERM};
    let ignored = ignored();
    let heeded = [SIGINT, SIGTERM, SIGHUP].into_iter().filter(|signal| ignored >> (signal - 1) & 1 == 0);
    let Ok(mut signals) = signal_hook::iterator::Signals::new(heeded) else { return };
    let _ = std::thread::Builder::new().name("signals".into()).spawn(move || signals.forever().for_each(|_| came()));
}

/// As above, by the one signal that other systems have.
#[cfg(not(unix))]
pub(super) fn heed() {
    let _ = ctrlc::try_set_handler(came);
}

fn came() {
    if !interrupt::caught() {
        crate::io::remove_unfinished();
        std::process::exit(130)
    }
}

/// The signals that this process was started to ignore, signal `n` as bit `n - 1`, as Linux tells it. Other systems tell it by calls
/// alone that are not safe; there hang-up is taken to be ignored, which leaves it to the system.
#[cfg(unix)]
fn ignored() -> u64 {
    const HANG_UP: u64 = 1 << (signal_hook::consts::signal::SIGHUP - 1);
    let Ok(status) = std::fs::read_to_string("/proc/self/status") else { return HANG_UP };
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(HANG_UP)
}
