//! Points, polylines and polygons.
//!
//! - [`moving`]: deformation of the plane that follows a line
//! - [`polyline`]: length, resampling, distance
//! - [`polygon`]: area, centre, inside test, coverage mask
//! - [`similarity`]: least-squares similarity between two point sets
//!
//! Coordinates are pixels, x to the right, y down. The origin is the outer corner of the top left pixel, so a pixel's
//! centre is at +0.5.

pub mod moving;
pub mod polygon;
pub mod polyline;
pub mod similarity;

/// A point or vector of the picture plane, in pixels.
pub type Point = glam::DVec2;
