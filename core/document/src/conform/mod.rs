//! A document moved to new footage.
//!
//! What the artist made goes with its drawing: keys, pins, centres, absences, drawings, pegs, clicks, limbs. It stays also where the drawing
//! was drawn again, because nobody else can say whether it still fits; a [`Note`] names it. What was computed goes to all frames that
//! show its drawing, and nowhere else. Where the drawing of a part's first or last key is gone, the nearest contour that was tracked becomes
//! the key, so that the part does not end early.
//!
//! Lengths and places are scaled and shifted. Fields that this version does not know stay as they are.
//!
//! - `part`: contours and everything by frame of a part
//! - `drawn`: strokes, pegs, clicks and limbs, in the lists beside the parts

mod drawn;
mod limbs;
mod part;

use super::{Document, FieldError};
use rototoon_base::scene::conform::Conform;
use rototoon_base::scene::{Footage, FrameNumber};
use std::fmt;

/// What became of something in a document that could not simply go with its drawing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Note {
    /// It lies on a drawing that was drawn again.
    Redrawn {
        /// What: a part's key, a drawing, clicks.
        what: String,
        /// Its frame in the new footage.
        frame: FrameNumber,
    },
    /// Its drawing is gone, so it is left out.
    Gone {
        /// What.
        what: String,
        /// Its frame in the old footage.
        frame: FrameNumber,
    },
    /// Its drawing and another one are one drawing now, and the other one's stays.
    Met {
        /// What.
        what: String,
        /// Its frame in the old footage.
        frame: FrameNumber,
        /// The frame in the new footage where they meet.
        by: FrameNumber,
    },
    /// The drawing of a key is gone, and the nearest tracked contour is the key now.
    Replaced {
        /// The part.
        part: String,
        /// The frame of the key in the old footage.
        frame: FrameNumber,
        /// The frame of the new key in the new footage.
        by: FrameNumber,
    },
    /// Results are left out because frames changed between them.
    Again {
        /// What they are.
        what: &'static str,
        /// The command that makes them again.
        command: &'static str,
    },
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Redrawn { what, frame } => {
                write!(f, "{what} on {frame}: the drawing was drawn again; look whether it still fits")
            }
            Self::Gone { what, frame } => {
                write!(f, "{what} on {frame} of the old footage: left out, its drawing is gone")
            }
            Self::Met { what, frame, by } => {
                write!(f, "{what} on {frame} of the old footage: left out, that of another frame stays on {by}")
            }
            Self::Replaced { part, frame, by } => write!(
                f,
                "part {part:?}: the drawing of its key on {frame} of the old footage is gone; the contour tracked on {by} is its key now"
            ),
            Self::Again { what, command } => {
                write!(f, "{what}: left out, because frames between have changed; run `rototoon {command}` again")
            }
        }
    }
}

impl Document {
    /// The document for new footage, and what did not simply go with its drawing.
    ///
    /// # Errors
    ///
    /// A list beside the parts that cannot be read.
    pub fn conformed(&self, conform: &Conform, footage: Footage) -> Result<(Self, Vec<Note>), FieldError> {
        let (mut moved, mut notes) = (self.clone(), Vec::new());
        moved.scene.footage = footage;
        // Results go with their drawings, and the pictures of these are other ones now.
        moved.forget_seen();
        moved.forget_reshaped();
        moved.scene.parts = self.scene.parts.iter().map(|part| part::moved(part, conform, &mut notes)).collect();
        drawn::moved(&mut moved, &self.scene.parts, conform, &mut notes)?;
        Ok((moved, notes))
    }
}

#[cfg(test)]
mod tests;
