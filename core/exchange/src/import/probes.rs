//! What the tests of several formats share.

use super::Shape;
use rototoon_base::geometry::Point;
use rototoon_base::scene::{Footage, FrameNumber};

/// Footage of 200 × 100 pixels.
pub fn footage() -> Footage {
    Footage { pattern: "%d".into(), first: 1, last: 9, fps: 24.0, width: 200, height: 100, held: false }
}

/// Checks the four corners of a shape on a frame. `wanted` has y up.
#[track_caller]
pub fn corners(shape: &Shape, frame: FrameNumber, wanted: [(f64, f64); 4]) {
    let found = &shape.keys[&frame];
    assert_eq!(found.len(), 4, "{found:?}");
    for (p, (x, y)) in found.iter().zip(wanted) {
        // y points down in the footage.
        assert!(p.distance(Point::new(x, f64::from(footage().height as u32) - y)) < 1e-9, "frame {frame}: {found:?}");
    }
}
