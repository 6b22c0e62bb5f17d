//! Editing with the pen, without a host: what events do to a selection and to a document.
//!
//! - `lens`: distances on the screen
//! - `selection`: the selected points
//! - `hit`: what is under the pen
//! - [`handles`]: the box around the selection, with which it is moved, scaled and rotated
//! - [`change`]: moves points, makes and deletes keys
//! - [`absence`]: marks parts as hidden
//! - [`feather`]: gives points a feather
//! - [`naming`]: gives a part another name
//! - [`order`]: brings parts nearer or farther away
//! - [`points`]: inserts and deletes points
//! - [`contour`]: makes keys of drawn contours
//! - [`editor`]: the pen's unfinished work, and what each event makes of it
//!
//! Nothing here calls the host. An event yields an [`editor::Outcome`]; a finished edit is a whole new document with the
//! name of its undo step. A drag is one edit, made when the pen goes up.
//!
//! Points are in pixels of the footage, y down.

pub mod absence;
pub mod change;
pub mod contour;
pub mod editor;
pub mod feather;
pub mod handles;
mod hit;
mod lens;
pub mod naming;
pub mod order;
pub mod points;
mod selection;

pub use editor::{Edit, Editor, Key, Outcome, Tool, Work};
pub use lens::Lens;
pub use selection::{Place, Selection};

/// Why an edit cannot be made, as a message for the user.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct Refused(pub String);

impl Refused {
    fn new(text: impl Into<String>) -> Self {
        Self(text.into())
    }

    /// The part with a name must not be changed.
    pub fn protected(name: &str) -> Self {
        Self(format!("{name:?} is locked or not among Parts"))
    }
}
