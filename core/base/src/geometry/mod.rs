//! Points, polylines and polygons.
//!
//! - [`moving`]: the plane deformed as a line in it is
//! - [`polyline`]: length, resampling, distance
//! - [`polygon`]: area, centre, inside test, coverage mask
//! - [`similarity`]: least-squares similarity between two point sets

pub mod moving;
pub mod polygon;
pub mod polyline;
pub mod similarity;

/// A point or vector of the picture plane, in pixels.
pub type Point = glam::DVec2;
