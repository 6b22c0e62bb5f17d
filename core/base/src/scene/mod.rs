//! The types that stages hand to each other.
//!
//! - [`clip`]: a character's motion as key points over time
//! - [`correspondence`]: contours drawn afresh, matched to the parts
//! - [`effects`]: the parameters of the effects for compositing hosts
//! - [`footage`]: which frames there are and where their pictures come from
//! - [`limbs`]: which places of contours tell where key points are
//! - [`palette`]: colours that tell parts apart
//! - [`parameters`]: what a user may set, described once
//! - [`part`]: a tracked contour with its keys, corrections and results
//! - [`pattern`]: file names of a numbered sequence
//! - [`progress`]: how long work reports and is cancelled
//! - [`proportions`]: limb lengths of a character, postures in another's
//! - [`raster`]: a rectangle of pixels
//! - [`skeleton`]: the key points of a posture and how they hang together

pub mod clip;
pub mod correspondence;
pub mod effects;
pub mod footage;
pub mod limbs;
pub mod palette;
pub mod parameters;
pub mod part;
pub mod pattern;
pub mod progress;
pub mod proportions;
pub mod raster;
pub mod skeleton;

pub use clip::Clip;
pub use footage::{Footage, FrameError, FrameNumber, FrameSource};
pub use part::{Part, Span};
pub use pattern::{FramePattern, PatternError};
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
