//! The data types that the stages exchange, and the descriptions of parameters.
//!
//! - [`clip`]: a character's motion as key points over time
//! - [`conform`]: where the frames and places of one footage are in another one
//! - [`correspondence`]: matching of freshly drawn contours to the parts
//! - [`effects`]: the parameters of the effects for compositing hosts
//! - [`facing`]: to which side a body looks in a clip, and clips in a mirror
//! - [`falloff`]: how soft borders fall off
//! - [`footage`]: the range of frames and the source of their pictures
//! - [`holds`]: clips on twos and threes, as the drawings that their frames show
//! - [`limbs`]: the points of contours that determine key points
//! - [`outcome`]: what became of a part on each frame: sure, doubtful or lost
//! - [`palette`]: colours that distinguish parts
//! - [`parameters`]: the parameters for users, described once
//! - [`part`]: a tracked contour with its keys, corrections and results
//! - [`pattern`]: file names of a numbered sequence
//! - [`progress`]: progress reports and cancelling of long work
//! - [`proportions`]: limb lengths of a character, and postures in other proportions
//! - [`raster`]: a rectangle of pixels
//! - [`skeleton`]: the key points of a human posture and the limbs between them
//! - [`spelling`]: how far names are apart
//! - [`template`]: the key points of any body, and its chains

pub mod clip;
pub mod conform;
pub mod correspondence;
pub mod effects;
pub mod facing;
pub mod falloff;
pub mod footage;
pub mod holds;
pub mod limbs;
pub mod outcome;
pub mod palette;
pub mod parameters;
pub mod part;
pub mod pattern;
pub mod progress;
pub mod proportions;
pub mod raster;
pub mod skeleton;
pub mod spelling;
pub mod template;

pub use clip::Clip;
pub use falloff::{Falloff, FalloffCurve};
pub use footage::{Footage, FrameError, FrameNumber, FrameSource, Mark};
pub use outcome::{Outcome, Verdict};
pub use part::{NoSuchPart, Part, Span};
pub use pattern::{FramePattern, PatternError};
pub use progress::{Cancelled, Progress, Silent};
pub use raster::{Colour, Raster};
pub use template::Template;

/// Footage and the parts captured from it: the complete input of the tracker, which also receives its results.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// The frames.
    pub footage: Footage,
    /// The parts, in the document's order.
    pub parts: Vec<Part>,
}

impl Scene {
    /// The index of the part that has this name.
    pub fn part_index(&self, name: &str) -> Result<usize, NoSuchPart> {
        self.parts.iter().position(|part| part.name == name).ok_or_else(|| NoSuchPart::of(&self.parts, name))
    }
}
