//! Whether a large amount of memory can be had, asked before the work that needs it.
//!
//! A failed allocation ends the process, and with it the host: Blender or a compositor, with all that is not saved. Work
//! whose memory grows with a number in a file therefore asks first and returns an error. The question is a trial: the
//! bytes are reserved at once and released. That respects the limits of the process (`ulimit -v`) and the system's own
//! rule, without code for each system.
//!
//! Limits: another thread may take the memory between question and work. A system that grants more than it has may
//! still end the process; a container's limit is of this kind.

use std::fmt;

/// More bytes are needed than the system grants.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{} of memory are needed, more than the system grants", Bytes(*needed))]
pub struct TooMuch {
    /// Number of bytes needed.
    pub needed: u64,
}

/// An error if `needed` bytes cannot be allocated now.
///
/// # Errors
///
/// [`TooMuch`].
pub fn ask(needed: u64) -> Result<(), TooMuch> {
    let mut trial = Vec::<u8>::new();
    let granted = usize::try_from(needed).is_ok_and(|bytes| trial.try_reserve_exact(bytes).is_ok());
    // Without this line the compiler may leave out an allocation that nothing uses.
    std::hint::black_box(&mut trial);
    if granted { Ok(()) } else { Err(TooMuch { needed }) }
}

/// A number of bytes, displayed in MB or GB.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bytes(pub u64);

impl fmt::Display for Bytes {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        let millions = self.0.div_ceil(1_000_000);
        if millions < 1000 { write!(out, "{millions} MB") } else { write!(out, "{:.1} GB", self.0 as f64 / 1e9) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn little_is_granted_and_more_than_the_address_space_is_not() {
        assert_eq!(ask(0), Ok(()));
        assert_eq!(ask(1 << 20), Ok(()));
        assert_eq!(ask(u64::MAX), Err(TooMuch { needed: u64::MAX }));
        assert_eq!(ask(1 << 62), Err(TooMuch { needed: 1 << 62 }));
    }

    #[test]
    fn numbers_are_readable() {
        assert_eq!(Bytes(1).to_string(), "1 MB");
        assert_eq!(Bytes(34_000_000_000).to_string(), "34.0 GB");
        let message = TooMuch { needed: 2_500_000_000 }.to_string();
        assert_eq!(message, "2.5 GB of memory are needed, more than the system grants");
    }
}
