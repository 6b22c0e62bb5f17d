//! Filters of pictures, and the edges and motion fields that are computed from them.
//!
//! This crate knows pixels only. It reads no files (`rototoon-pictures`), follows no contours (`rototoon-track`), and draws and
//! writes no pictures (`rototoon-render`).
//!
//! - [`canny`]: edges of the luma
//! - [`colour`]: sRGB, luma and CIE Lab
//! - [`correlation`]: correlation by the fast Fourier transform
//! - [`distance_transform`]: Manhattan distance to the nearest edge
//! - [`flow`]: dense optical flow by inverse search
//! - [`gaussian`]: separable blur
//! - [`mean_shift`]: the filter that flattens colours and keeps edges
//! - [`pixel`]: the pixel types of the filters
//! - [`pyramid`]: a picture at halved sizes
//! - [`resize`]: area reduction and bilinear enlargement
//! - [`sample`]: bilinear reading with derivatives
//!
//! # Example
//!
//! ```
//! use rototoon_base::scene::Raster;
//! use rototoon_image::canny::{CannyOptions, canny};
//! use rototoon_image::distance_transform::manhattan;
//!
//! // A black disc of radius 12 on white paper; pixel centres are at +0.5.
//! let from_centre = |x: usize, y: usize| (x as f64 + 0.5 - 20.0).hypot(y as f64 + 0.5 - 20.0);
//! let drawing = Raster::from_fn(40, 40, |x, y| if from_centre(x, y) < 12.0 { [0.0; 3] } else { [1.0; 3] });
//!
//! let edges = canny(&drawing, &CannyOptions::default());
//! let found = (0..40).flat_map(|y| (0..40).map(move |x| (x, y))).filter(|&(x, y)| edges.get(x, y));
//! let farthest = found.map(|(x, y)| (from_centre(x, y) - 12.0).abs()).fold(0.0, f64::max);
//! assert!(farthest < 1.0, "all edges are on the outline");
//!
//! let distances = manhattan(&edges);
//! assert!((11.0..=13.0).contains(&distances.get(20, 20)), "the centre is one radius away from the nearest edge");
//! ```

#![forbid(unsafe_code)]

pub mod canny;
pub mod colour;
pub mod correlation;
pub mod distance_transform;
pub mod flow;
pub mod gaussian;
pub mod mean_shift;
pub mod pixel;
pub mod pyramid;
pub mod resize;
pub mod sample;
