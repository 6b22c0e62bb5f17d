//! What all stages of Rototoon share: numerics, plane geometry, spline curves, and the types that stages exchange.
//!
//! # Modules, from the bottom up
//!
//! - [`numeric`]: numerical methods that know nothing of pictures or contours
//! - [`geometry`]: points, polylines, polygons, similarities
//! - [`curve`]: quadratic B-splines
//! - [`scene`]: footage, parts, pictures, progress, parameters
//!
//! Each module uses only those above it in this list; `curve` and `scene` do not use each other.
//!
//! # Coordinates
//!
//! Pixels, x right, y down. The origin is the outer top-left corner of the picture, so the centre of a pixel lies at +0.5.

#![forbid(unsafe_code)]

pub mod curve;
pub mod geometry;
pub mod numeric;
pub mod scene;
