//! Renders pictures of the results.
//!
//! - [`overlay`]: contours, control points, keys and confidence over the footage
//! - [`coverage`]: exact area coverage of unions of polygons
//! - [`mask`]: the parts at a time, with motion blur, growth and feathering
//! - [`matte`]: the matte of the closed parts, and the footage cut out by them
//! - [`visible`]: the visible area of every part in each pixel, nearer parts over farther ones
//! - [`ids`]: that area as a colour for each part; mattes with a layer for each part
//! - [`cryptomatte`]: that area as ranked ids, for keyers
//! - [`layers`]: OpenEXR files with any number of named channels
//! - [`motion`]: contours between frames
//! - [`grow`]: outlines moved outward or inward
//! - [`feather`]: soft borders
//! - [`line`](mod@line): lines of a given width
//! - [`encode`]: pictures as bytes of a file

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
