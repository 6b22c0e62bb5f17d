//! Points, polylines and polygons.
//!
//! - [`polyline`]: length, resampling, distance
//! - [`polygon`]: area, centre, inside test, coverage mask
//! - [`similarity`]: least-squares similarity between two point sets

pub mod polygon;
pub mod polyline;
pub mod similarity;

/// A point or vector of the picture plane, in pixels.
pub type Point = glam::DVec2;
