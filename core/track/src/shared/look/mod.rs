//! Looks: what the default tracker compares of a picture, by the kind of drawing that the footage shows.
//!
//! **Why.** The tracker compares colours. That is right for flat painted cartoons, whose colours say which part is which.
//! Of a pencil drawing the colours say nothing: nearly all is paper, and a line is a little darker. Costs that are made
//! for paint then see no difference between a right and a wrong place. Under light that moves over the figure a part's
//! brightness changes from drawing to drawing, but its tone does not.
//!
//! **How.** The pictures at the keys decide the [`Kind`] of the footage ([`kind`](mod@kind)). A look is a picture again,
//! of three values between 0 and 1, so that everything after it is the same for all kinds:
//!
//! | kind | the three values |
//! | --- | --- |
//! | painted | red, green, blue |
//! | shaded | two of the tone, and the brightness with a low weight ([`shade`]) |
//! | lines | ink, ink once more, and the hue of the ink ([`lines`]) |
//!
//! Whether a drawing is held, and where a shot ends, is always read from the colours.
//!
//! **Limits.** The kind is one for all of the footage. Footage that changes from pencil to paint is of the kind that most
//! of its keyed drawings have.

pub mod kind;
pub mod lines;
pub mod shade;

pub use kind::Kind;

use rototoon_base::scene::{Colour, FrameError, FrameNumber, FrameSource, Raster};
use std::sync::Arc;

/// The looks of a footage's pictures.
#[derive(Clone, Copy)]
pub struct Looks<'a> {
    /// The pictures.
    pub frames: &'a dyn FrameSource,
    /// The kind of drawing that they show.
    pub kind: Kind,
}

impl FrameSource for Looks<'_> {
    fn picture(&self, frame: FrameNumber) -> Result<Arc<Raster<Colour>>, FrameError> {
        let picture = self.frames.picture(frame)?;
        Ok(match self.kind {
            Kind::Painted => picture,
            Kind::Shaded => Arc::new(picture.map(shade::look)),
            Kind::Lines => Arc::new(lines::look(&picture)),
        })
    }
}
