//! Why tracking failed.

use rototoon_base::geometry::Point;
use rototoon_base::scene::{Cancelled, FrameError, FrameNumber};

/// Why tracking failed. The scene is not changed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TrackError {
    /// A picture could not be read.
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
        /// Frame of the key that differs.
        frame: FrameNumber,
        /// Its number of points.
        found: usize,
        /// The number of points of the first key.
        expected: usize,
    },
    /// A coordinate is NaN, infinite, or far outside any picture.
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
    #[error("part {part:?}, frame {frame}: found a pin of point {index}, expected an index below {count}")]
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
    /// The pictures are too wide for their height. Scaled to the lines of the tracker they would fill the memory.
    #[error("footage: found pictures of {width}x{height} pixels, expected at most {limit} times as wide as high")]
    TooWide {
        /// Width of the footage.
        width: usize,
        /// Height of the footage.
        height: usize,
        /// The largest allowed ratio of width to height.
        limit: usize,
    },
}
