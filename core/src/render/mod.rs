//! Pictures of what was found.
//!
//! - [`overlay`]: contours, control points, keys and confidence over the footage
//! - [`matte`]: coverage of the closed parts
//! - [`encode`]: pictures as bytes of a file

pub mod encode;
pub mod matte;
pub mod overlay;

pub use encode::{EncodeError, Format};
pub use matte::matte;
pub use overlay::{OverlayOptions, overlay};
