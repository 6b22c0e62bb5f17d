//! The types that stages hand to each other.
//!
//! - [`raster`]: a rectangle of pixels
//! - [`footage`]: which frames there are and where their pictures come from
//! - [`part`]: a tracked contour with its keys, corrections and results
//! - [`pattern`]: file names with a place for the frame number
//! - [`progress`]: how long work reports and is cancelled

pub mod footage;
pub mod part;
pub mod pattern;
pub mod progress;
pub mod raster;

pub use footage::{Footage, FrameError, FrameNumber, FrameSource};
pub use part::{Part, Span};
pub use pattern::{Pattern, PatternError};
pub use progress::{Cancelled, Progress, Silent};
pub use raster::{Colour, Raster};

/// Footage and the parts that are captured from it: all that the tracker needs and all that it fills in.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// The frames.
    pub footage: Footage,
    /// The parts, in the document's order.
    pub parts: Vec<Part>,
}
