//! How many shots fit into the memory at a time.
//!
//! A shot asks for the bytes that it will need, and waits until they are free. A shot that needs more than the whole
//! budget runs alone.
//!
//! The need is what the shot's steps took last time. Of a new shot it is estimated from the size and number of its
//! frames. Tracking takes most: 100 frames of 1920 × 1080 with 16 parts took 1.3 GB.
//!
//! Decoded frames are kept from one step of a shot to the next as far as its part of the budget has room for them
//! beside the steps.

use rototoon::pictures::decode::kept_size;
use rototoon::scene::{Footage, FramePattern};
use std::path::Path;
use std::sync::{Condvar, Mutex, PoisonError};

/// Bytes for each pixel, whatever the number of frames.
const PIXEL: u64 = 70;
/// Bytes for each pixel of each frame.
const FRAME: u64 = 6;
/// Bytes of the program itself.
const BASE: u64 = 100_000_000;
/// Default budget where the system does not report its memory.
const UNKNOWN: u64 = 4_000_000_000;
/// Share of the free memory that is taken by default.
const SHARE: f64 = 0.8;

/// Bytes that are free for shots.
#[derive(Debug)]
pub struct Budget {
    all: u64,
    free: Mutex<u64>,
    changed: Condvar,
}

/// Bytes that a shot holds until this is dropped.
#[derive(Debug)]
pub struct Share<'a> {
    budget: &'a Budget,
    bytes: u64,
}

impl Budget {
    /// A budget of so many bytes.
    pub fn new(bytes: u64) -> Self {
        Self { all: bytes, free: Mutex::new(bytes), changed: Condvar::new() }
    }

    /// Four fifths of the memory that is free now.
    pub fn of_machine() -> Self {
        let free = std::fs::read_to_string("/proc/meminfo").ok().and_then(|text| available(&text));
        Self::new(free.map_or(UNKNOWN, |bytes| (bytes as f64 * SHARE) as u64))
    }

    /// All bytes of the budget.
    pub fn bytes(&self) -> u64 {
        self.all
    }

    /// Waits until `bytes` are free, and takes them.
    pub fn take(&self, bytes: u64) -> Share<'_> {
        let bytes = bytes.min(self.all);
        let mut free = self.free.lock().unwrap_or_else(PoisonError::into_inner);
        while *free < bytes {
            free = self.changed.wait(free).unwrap_or_else(PoisonError::into_inner);
        }
        *free -= bytes;
        Share { budget: self, bytes }
    }
}

impl Drop for Share<'_> {
    fn drop(&mut self) {
        *self.budget.free.lock().unwrap_or_else(PoisonError::into_inner) += self.bytes;
        self.budget.changed.notify_all();
    }
}

/// Estimate of the bytes that the steps of a shot need.
pub fn estimate(footage: &Footage) -> u64 {
    let pixels = (footage.width as u64).saturating_mul(footage.height as u64);
    BASE.saturating_add(pixels.saturating_mul(PIXEL.saturating_add(FRAME.saturating_mul(frames(footage)))))
}

/// Bytes of all frames of a footage in `folder`, decoded as their files have them; by the first frame, 0 if it cannot be read.
pub fn kept(footage: &Footage, folder: &Path) -> u64 {
    let first = FramePattern::parse(&footage.pattern).ok().map(|pattern| folder.join(pattern.path(footage.first)));
    let one = first.and_then(|path| kept_size(&path).ok()).unwrap_or(0);
    one.saturating_mul(frames(footage))
}

fn frames(footage: &Footage) -> u64 {
    (i64::from(footage.last) - i64::from(footage.first) + 1).max(1) as u64
}

/// The free memory by the text of `/proc/meminfo`.
fn available(text: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicU64, Ordering};

    #[test]
    fn shots_never_take_more_than_the_budget() {
        let budget = Budget::new(10);
        let (held, most) = (AtomicU64::new(0), AtomicU64::new(0));
        std::thread::scope(|scope| {
            for k in 0..8u64 {
                let (budget, held, most) = (&budget, &held, &most);
                scope.spawn(move || {
                    for n in 0..50 {
                        let bytes = (k * 7 + n) % 14;
                        let share = budget.take(bytes);
                        most.fetch_max(held.fetch_add(share.bytes, Ordering::SeqCst) + share.bytes, Ordering::SeqCst);
                        held.fetch_sub(share.bytes, Ordering::SeqCst);
                    }
                });
            }
        });
        assert!(most.load(Ordering::SeqCst) <= 10);
        assert_eq!(*budget.free.lock().unwrap(), 10);
    }

    #[test]
    fn the_estimate_covers_what_was_measured() {
        let footage = Footage { pattern: String::new(), first: 1, last: 100, fps: 24.0, width: 1920, height: 1080 };
        assert!((1_300_000_000..2_000_000_000).contains(&estimate(&footage)), "{}", estimate(&footage));
        let huge = Footage { first: i32::MIN, last: i32::MAX, width: usize::MAX, ..footage };
        assert_eq!(estimate(&huge), u64::MAX);
    }

    #[test]
    fn free_memory_is_read() {
        assert_eq!(available("MemTotal: 9 kB\nMemAvailable:    1000 kB\n"), Some(1_024_000));
        assert_eq!(available("MemTotal: 9 kB\n"), None);
    }
}
