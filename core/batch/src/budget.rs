//! How many shots fit into the memory at a time.
//!
//! A shot asks for the bytes that it will need, and waits until they are free. A shot that needs more than the whole
//! budget runs alone.
//!
//! The need is what the shot's steps took last time. Of a shot that the system ended it is half more than it held then.
//! Of a new shot it is estimated.
//!
//! # The estimate
//!
//! A step holds the program itself, the pictures that a sequence keeps as floats, at most 268 MB, and what it works with.
//! The default tracker scales every picture to 540 lines, *working pixels*. It holds
//!
//! - three levels of colours and slopes of each frame, together 8 bytes for each working pixel,
//! - what it knows of the places where a part may be: up to 200 bytes for each working pixel within the part, on each frame,
//! - the pictures that each thread works on, up to 60 bytes for each working pixel.
//!
//! Drawing holds 70 bytes for each pixel and thread. The greater of tracking and drawing counts. Peaks were measured on
//! 28 November 2026, those of the walk on the 30th, as the resident set of `track`, in MB:
//!
//! | shot | size | frames | parts | pixels within parts | 1 thread | estimate | more threads | estimate |
//! | --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |
//! | walking boy | 420 × 540 | 15 | 12 | 18 % | 156 | 256 | 8: 215 | 352 |
//! | running figure | 640 × 539 | 6 | 7 | 13 % | 101 | 167 | 8: 190 | 312 |
//! | jumping girl | 540 × 540 | 34 | 12 | 16 % | 433 | 592 | 8: 554 | 715 |
//! | the same, half the size | 270 × 270 | 34 | 12 | 16 % | 339 | 503 | 8: 400 | 625 |
//! | the same, twice the size | 1080 × 1080 | 34 | 12 | 16 % | 631 | 742 | 8: 700 | 972 |
//! | the same, four times the size | 2160 × 2160 | 34 | 12 | 16 % | 547 | 742 | 4: 572 | 1625 |
//! | Anubis | 540 × 540 | 28 | 12 | 12 % | 375 | 430 | 4: 410 | 482 |
//! | penguin | 540 × 540 | 29 | 5 | 7 % | 273 | 351 | 4: 330 | 404 |
//! | jumping jacks | 540 × 540 | 20 | 1 | 17 % | 185 | 381 | 8: 207 | 503 |
//! | a walk in pencil | 1920 × 1080 | 60 | 11 | 11 % | 1100 | 1300 | 2: 961 | 1330 |
//! | the same, longer | 1920 × 1080 | 120 | 12 | 12 % | 1898 | 2320 | 2: 1861 | 2350 |
//! | the whole of it | 1920 × 1080 | 240 | 12 | 12 % | | 4290 | 2: 3700 | 4320 |
//!
//! The estimate is the higher of the two figures everywhere. One that is too high costs some shots at a time on the first run;
//! one that is too low may cost the shot.
//!
//! Limit: filling of large line drawings takes 320 bytes for each pixel and may take more than the estimate at its first run.
//!
//! # Frames
//!
//! Decoded frames are kept from one step of a shot to the next as far as its part of the budget has room for them
//! beside the steps.

use rototoon::geometry::polygon::signed_area;
use rototoon::limits;
use rototoon::pictures::decode::kept_size;
use rototoon::pictures::sequence::KEPT_BYTES;
use rototoon::scene::{Colour, Footage, FramePattern, Part, Scene};
use std::path::Path;
use std::sync::{Condvar, Mutex, PoisonError};

/// Lines of a picture in working pixels.
const WORKING_LINES: f64 = 540.0;
/// Bytes for each working pixel of each frame.
const FRAME: f64 = 8.0;
/// Bytes for each working pixel within a part, of each frame.
const PART: f64 = 200.0;
/// Bytes for each working pixel and thread of tracking.
const TRACK: f64 = 60.0;
/// Bytes for each pixel and thread of drawing.
const DRAW: f64 = 70.0;
/// Bytes of the program itself.
const BASE: f64 = 50e6;
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

    /// Four fifths of the memory that is free now, or of a container's limit.
    pub fn of_machine() -> Self {
        Self::new(limits::free().map_or(UNKNOWN, |bytes| (bytes as f64 * SHARE) as u64))
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

/// Estimate of the bytes that the steps of a shot need with so many threads.
pub fn estimate(scene: &Scene, threads: usize) -> u64 {
    let footage = &scene.footage;
    let (pixels, frames) = (footage.width as f64 * footage.height as f64, frames(footage) as f64);
    let (working, threads) = ((WORKING_LINES / footage.height.max(1) as f64).powi(2), threads.max(1) as f64);
    // The greatest of all keys: a part may come near between them.
    let area = |part: &Part| part.keys.values().map(|key| signed_area(key).abs()).fold(0.0, f64::max);
    // No part is larger than the picture; some reach far out of it.
    let parts: f64 = scene.parts.iter().map(|part| area(part).min(pixels)).sum();
    let pictures = (pixels * size_of::<Colour>() as f64 * frames).min(KEPT_BYTES as f64);
    let track = working * (frames * (FRAME * pixels + PART * parts) + TRACK * pixels * threads);
    (BASE + pictures + track.max(DRAW * pixels * threads)) as u64
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

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon::geometry::Point;
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

    /// A scene with one part of a share of the picture.
    fn scene(width: usize, height: usize, frames: i32, share: f64) -> Scene {
        let footage = Footage { pattern: String::new(), first: 1, last: frames, fps: 24.0, width, height, held: false };
        let (right, bottom) = (width as f64, height as f64 * share);
        let corners = [(0.0, 0.0), (right, 0.0), (right, bottom), (0.0, bottom)].map(|(x, y)| Point::new(x, y));
        let part = Part { keys: [(1, corners.to_vec())].into(), ..Part::default() };
        Scene { footage, parts: vec![part] }
    }

    #[test]
    fn the_estimate_covers_what_was_measured() {
        for (width, height, frames, share, threads, measured) in [
            (420, 540, 15, 0.18, 1, 156e6),
            (420, 540, 15, 0.18, 8, 215e6),
            (640, 539, 6, 0.13, 1, 101e6),
            (640, 539, 6, 0.13, 8, 190e6),
            (540, 540, 34, 0.16, 1, 433e6),
            (540, 540, 34, 0.16, 8, 554e6),
            (270, 270, 34, 0.16, 8, 400e6),
            (1080, 1080, 34, 0.16, 1, 631e6),
            (2160, 2160, 34, 0.16, 1, 547e6),
            (540, 540, 28, 0.12, 1, 375e6),
            (540, 540, 29, 0.07, 4, 330e6),
            (540, 540, 20, 0.17, 8, 207e6),
        ] {
            let bytes = estimate(&scene(width, height, frames, share), threads) as f64;
            assert!((measured..2.5 * measured).contains(&bytes), "{width} × {height} × {frames}: {bytes}");
        }
        let mut huge = scene(9, 9, 9, 1.0);
        huge.footage = Footage { first: i32::MIN, last: i32::MAX, width: usize::MAX, ..huge.footage };
        assert_eq!(estimate(&huge, 8), u64::MAX);
    }
}
