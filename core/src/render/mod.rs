//! Pictures of what was found.
//!
//! - [`overlay`]: contours, control points, keys and confidence over the footage
//! - [`coverage`]: exact area coverage of unions of polygons
//! - [`mask`]: parts at a time, blurred by motion, grown and feathered
//! - [`matte`]: coverage of the closed parts
//! - [`motion`]: contours between frames
//! - [`grow`]: the outline moved outward or inward
//! - [`feather`]: soft borders
//! - [`line`](mod@line): lines of a width
//! - [`encode`]: pictures as bytes of a file

pub mod coverage;
pub mod encode;
pub mod feather;
pub mod grow;
pub mod line;
pub mod mask;
pub mod matte;
pub mod motion;
pub mod overlay;

pub use encode::{EncodeError, Format};
pub use matte::matte;
pub use overlay::{OverlayOptions, overlay};
