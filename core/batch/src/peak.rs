//! The most memory that a process has held, where the system reports it.
//!
//! A program tells it of itself at the end of each step. One that the system ends tells nothing any more, so the batch looks
//! at it from outside while it runs.

/// The most memory in bytes that a process has held, by its number or `self`; 0 where the system does not say it.
pub fn of(process: &str) -> u64 {
    let status = std::fs::read_to_string(format!("/proc/{process}/status"));
    status.ok().and_then(|status| peak_bytes(&status)).unwrap_or(0)
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
        assert!(of("self") > 1_000_000 || cfg!(not(target_os = "linux")));
        assert_eq!(of("none"), 0);
    }
}
