//! Pictures of what was found.
//!
//! - [`overlay`]: contours, control points, keys and confidence over the footage
//! - [`coverage`]: exact area coverage of unions of polygons
//! - [`mask`]: parts at a time, blurred by motion, grown and feathered
//! - [`matte`]: coverage of the closed parts, and what of the footage they cover
//! - [`visible`]: how much of each pixel every part shows, nearer parts over farther ones
//! - [`ids`]: the same as a colour for each part; mattes with a layer for each
//! - [`cryptomatte`]: the same as ranked ids, for keyers
//! - [`layers`]: OpenEXR files of any number of named channels
//! - [`motion`]: contours between frames
//! - [`grow`]: the outline moved outward or inward
//! - [`feather`]: soft borders
//! - [`line`](mod@line): lines of a width
//! - [`encode`]: pictures as bytes of a file

#![forbid(unsafe_code)]

pub mod coverage;
pub mod cryptomatte;
pub mod encode;
pub mod feather;
pub mod grow;
pub mod ids;
pub mod layers;
pub mod line;
pub mod mask;
pub mod matte;
pub mod motion;
pub mod overlay;
pub mod visible;

pub use encode::{EncodeError, Format};
pub use ids::{id_picture, matte_layers};
pub use matte::{cutout, matte};
pub use overlay::{OverlayOptions, overlay};
