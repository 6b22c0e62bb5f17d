//! In-betweens: from drawings on key frames to the drawings between them.
//!
//! The stages work in this order. [`matching`] finds the counterpart of each stroke on the next key drawing.
//! [`between`] makes the drawings between two keys from these pairs. [`peg`] gives the shift, turn and scale of a group
//! of strokes over time. [`hidden`] then cuts away the parts of lines that a nearer shape covers.
//!
//! - [`stroke`]: a stroke of a drawing
//! - [`matching`]: the correspondence of strokes between two drawings
//! - [`peg`]: pivots that shift, turn and scale over time, given by the user or found
//! - [`between`]: the drawings between two key drawings
//! - [`hidden`]: the parts of lines that a filled shape in front covers
//! - `grid`: search for the nearest places among many
//! - `line`: a stroke parametrised by shares of its length
//!
//! Coordinates are pixels: x to the right, y down.

pub mod between;
mod grid;
pub mod hidden;
mod line;
pub mod matching;
pub mod peg;
pub mod stroke;

pub use stroke::{BadPoint, Stroke};
