//! Peak memory of this process.
//!
//! The kernel records the largest resident size that a process has had (`VmHWM` in `/proc/self/status`). It never falls, so
//! measuring one piece of work needs a process of its own. `cargo xtask bench-tracking` starts one for each measurement.

/// The largest resident size so far, in MB of 10⁶ bytes. `None` if the system does not report it.
pub fn peak_mb() -> Option<f64> {
    of_status(&std::fs::read_to_string("/proc/self/status").ok()?)
}

fn of_status(status: &str) -> Option<f64> {
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib * 1024.0 / 1e6)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_status_is_read() {
        assert_eq!(of_status("Name:\tx\nVmHWM:\t   12500 kB\nVmRSS:\t 7 kB\n"), Some(12.8));
        assert_eq!(of_status("Name:\tx\n"), None);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn the_peak_includes_used_memory() {
        let before = peak_mb().unwrap();
        let block = vec![1_u8; 60 << 20];
        let with = peak_mb().unwrap();
        assert!(with > 62.0 && with >= before, "{with} MB with {} MiB", block.len() >> 20);
    }
}
