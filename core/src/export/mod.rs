//! What was found, for other programs.
//!
//! - [`svg`]: one animated path a part

pub mod svg;

pub use svg::{Motion, SvgOptions, svg};
