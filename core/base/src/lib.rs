//! The numerics, plane geometry, spline curves and common types on which all stages of Rototoon are built.
//!
//! This crate computes with numbers, points and curves, and says what the machine has to offer. It does not process pictures: decoding and
//! filters are in `rototoon-image`, the project document is in `rototoon-document`.
//!
//! # Modules, from the bottom up
//!
//! - [`mod@file`], [`memory`], [`limits`]: reading within bounds, whether memory can be had, and how much is free
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
//!
//! # Example
//!
//! A closed spline passes the midpoints between its guiding points, not the points themselves. Its pieces are parabolas,
//! so areas and nearest points are exact.
//!
//! ```
//! use rototoon_base::curve::Spline;
//! use rototoon_base::geometry::{Point, polygon};
//!
//! let square = vec![Point::new(0.0, 0.0), Point::new(6.0, 0.0), Point::new(6.0, 6.0), Point::new(0.0, 6.0)];
//! assert_eq!(polygon::signed_area(&square), 36.0, "positive: clockwise on the screen");
//!
//! let spline = Spline::new(square, true)?;
//! assert!((spline.area() - 30.0).abs() < 1e-9, "each rounded corner takes 1.5 px² away");
//! let nearest = spline.nearest(Point::new(0.0, 0.0));
//! assert!(nearest.point.distance(Point::new(0.75, 0.75)) < 1e-9, "the curve stays clear of the guiding point");
//! # Ok::<(), rototoon_base::curve::SplineError>(())
//! ```

#![forbid(unsafe_code)]

pub mod curve;
pub mod file;
pub mod geometry;
pub mod limits;
pub mod memory;
pub mod numeric;
pub mod scene;
