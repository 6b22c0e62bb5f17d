//! The memory that the program takes, where the system reports it.

/// File that tells it.
const STATUS: &str = "/proc/self/status";
/// File that makes the system forget the peak, if this is written to it.
const FORGET: (&str, &str) = ("/proc/self/clear_refs", "5");

/// Lets the peak begin anew.
pub fn forget_peak() {
    // Without it the peak is that of all steps so far.
    let _ = std::fs::write(FORGET.0, FORGET.1);
}

/// The most memory in bytes that the process has held; 0 where the system does not report it.
pub fn peak() -> u64 {
    std::fs::read_to_string(STATUS).ok().and_then(|status| peak_bytes(&status)).unwrap_or(0)
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
