//! How much memory contacts may take before they are fitted from files.
//!
//! ```text
//! half of what the machine has, or of what its container may use
//! ```
//!
//! What is free at the moment is not asked: the same file is then read the same way, whatever else runs.

use clap::Args;

/// Megabytes where the system does not tell.
const UNTOLD: u64 = 4096;
/// Bytes of a megabyte.
const MEGABYTE: u64 = 1 << 20;

/// What contacts may take.
#[derive(Args, Clone, Copy, Debug, Default)]
#[command(next_help_heading = "Input")]
pub(super) struct MemoryFlags {
    /// Memory for the contacts: a table that takes more is fitted from temporary files, by an adaptive surface [default: half of the machine's]
    ///
    /// The surface is to the bit that of --adaptive in memory. The files stand in the folder that TMPDIR names, or in /var/tmp, and take as much as the table. Tables of text come in pieces, plain, packed as .gz or from a pipe; other formats are read whole
    #[arg(long, hide_short_help = true, value_name = "MB")]
    pub(super) memory: Option<u64>,
}

impl MemoryFlags {
    /// Bytes.
    pub(super) fn bytes(self) -> u64 {
        self.memory.unwrap_or_else(|| of_machine().map_or(UNTOLD, |all| all / MEGABYTE / 2)).saturating_mul(MEGABYTE)
    }
}

/// Bytes of the machine, or of the container that this process is held in.
fn of_machine() -> Option<u64> {
    let number = |path: &str| std::fs::read_to_string(path).ok()?.trim().parse::<u64>().ok();
    let of_container = ["/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"].map(number);
    let about = std::fs::read_to_string("/proc/meminfo").ok();
    let kilobytes = about.as_deref().and_then(kilobytes_in);
    of_container.into_iter().flatten().chain(kilobytes.map(|kilobytes| kilobytes << 10)).min()
}

/// The total of what Linux says of its memory.
fn kilobytes_in(about: &str) -> Option<u64> {
    let line = about.lines().find_map(|line| line.strip_prefix("MemTotal:"))?;
    line.trim().strip_suffix("kB")?.trim().parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_linux_says_is_read() {
        assert_eq!(kilobytes_in("MemTotal:       24606420 kB\nMemFree: 12 kB\n"), Some(24_606_420));
        assert_eq!(kilobytes_in("MemFree: 12 kB\n"), None);
        assert_eq!(MemoryFlags { memory: Some(3) }.bytes(), 3 << 20);
        assert!(MemoryFlags::default().bytes() >= MEGABYTE);
    }
}
