//! In-betweens: from drawings on key frames to the drawings between them.
//!
//! - [`stroke`]: a stroke of a drawing
//! - [`matching`]: which stroke of one drawing is which of the next

pub mod matching;
pub mod stroke;

pub use stroke::{BadPoint, Stroke};
