//! In-betweens: from drawings on key frames to the drawings between them.
//!
//! - [`stroke`]: a stroke of a drawing
//! - [`matching`]: which stroke of one drawing is which of the next
//! - [`peg`]: pivots that shift, turn and scale over time, given or found
//! - [`between`]: the drawings between
//! - [`hidden`]: which parts of lines a filled shape in front covers
//! - `grid`: nearest places among many, `line`: strokes by shares of their length

#![forbid(unsafe_code)]

pub mod between;
mod grid;
pub mod hidden;
mod line;
pub mod matching;
pub mod peg;
pub mod stroke;

pub use stroke::{BadPoint, Stroke};
