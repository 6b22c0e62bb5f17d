//! Why tracking failed.

use rototoon_base::geometry::Point;
use rototoon_base::scene::{Cancelled, FrameError, FrameNumber};

/// Why tracking failed. Nothing was changed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TrackError {
    /// A picture could not be had.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// Keys of one part differ in their number of points.
    #[error("part {part:?}: the key on frame {frame} has {found} points, but the first key has {expected}")]
    UnequalKeys {
        /// Name of the part.
        part: String,
        /// Frame of the differing key.
        frame: FrameNumber,
        /// Its number of points.
        found: usize,
        /// The number on the first key.
        expected: usize,
    },
    /// A coordinate is no number, or far from any picture.
    #[error("part {part:?}, frame {frame}: found the point {found}, expected pixel coordinates within ±{limit}")]
    OutOfRange {
        /// Name of the part.
        part: String,
        /// Frame of the key, pin or centre.
        frame: FrameNumber,
        /// The point.
        found: Point,
        /// The largest coordinate allowed.
        limit: f64,
    },
    /// A pin names a control point that the part does not have.
    #[error("part {part:?}, frame {frame}: pin of point {index}, but the part has {count} points")]
    NoSuchPoint {
        /// Name of the part.
        part: String,
        /// Frame of the pin.
        frame: FrameNumber,
        /// Index of the point, from 0.
        index: usize,
        /// Number of points of the part.
        count: usize,
    },
    /// Pictures of a shape that no scene has: scaled to the lines that the tracker works on they would fill the memory.
    #[error("footage: found pictures of {width}x{height} pixels, expected at most {limit} times as wide as high")]
    TooWide {
        /// Width of the footage.
        width: usize,
        /// Height of the footage.
        height: usize,
        /// The largest quotient of both.
        limit: usize,
    },
}
