//! Tells a batch how much memory this program took.

use crate::failure::line;
use rototoon_batch::child::{USAGE, USAGE_LINE};

/// Prints the most memory that the process has held, if the environment asks for it and the system reports it.
pub fn tell() {
    if std::env::var_os(USAGE).is_none() {
        return;
    }
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    if let Some(bytes) = peak_bytes(&status) {
        let (kind, text) = USAGE_LINE.split_once(": ").unwrap_or_default();
        line(kind, &format!("{text}{bytes}"));
    }
}

/// The most memory in bytes, by the text of `/proc/self/status`.
fn peak_bytes(status: &str) -> Option<u64> {
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_peak_is_read() {
        assert_eq!(peak_bytes("Name:\tx\nVmHWM:\t   12500 kB\n"), Some(12_800_000));
        assert_eq!(peak_bytes("Name:\tx\n"), None);
    }
}
