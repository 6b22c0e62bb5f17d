//! Drawings between drawings.
//!
//! - [`hidden`]: which parts of the lines a filled shape in front covers

pub mod hidden;
