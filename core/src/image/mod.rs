//! Image processing: reading pictures from files, and computations on them.
//!
//! - [`canny`]: edges of the luma
//! - [`colour`]: sRGB, luma and CIE Lab
//! - [`correlation`]: correlation by the fast Fourier transform
//! - [`decode`]: a picture from a file
//! - [`distance_transform`]: Manhattan distance to the nearest edge
//! - [`flow`]: dense optical flow by inverse search
//! - [`gaussian`]: separable blur
//! - [`mean_shift`]: the filter that flattens colours and keeps edges
//! - [`pixel`]: the pixel types of the filters
//! - [`pyramid`]: a picture at halved sizes
//! - [`resize`]: area reduction and bilinear enlargement
//! - [`sample`]: bilinear reading with derivatives
//! - [`sequence`]: the pictures of a footage, decoded in parallel, with a cache
//!
//! Picture coordinates are pixels, x to the right, y down. The origin is the outer corner of the top left pixel, so a
//! pixel's centre is at +0.5.

pub mod canny;
pub mod colour;
pub mod correlation;
pub mod decode;
pub mod distance_transform;
pub mod flow;
pub mod gaussian;
pub mod mean_shift;
pub mod pixel;
pub mod pyramid;
pub mod resize;
pub mod sample;
pub mod sequence;

pub use decode::{DecodeError, decode, probe};
pub use sequence::Sequence;
