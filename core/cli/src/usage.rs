//! The memory that the program takes, where the system reports it.

/// File that makes the system forget the peak, if this is written to it.
const FORGET: (&str, &str) = ("/proc/self/clear_refs", "5");

/// Lets the peak begin anew.
pub fn forget_peak() {
    // Without it the peak is that of all steps so far.
    let _ = std::fs::write(FORGET.0, FORGET.1);
}

/// The most memory in bytes that the process has held; 0 where the system does not report it.
pub fn peak() -> u64 {
    rototoon_batch::peak::of("self")
}
