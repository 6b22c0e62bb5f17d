//! Drawn characters follow a skeleton.
//!
//! - [`capture`]: key points from contours
//! - [`limb`]: quadratic Bézier limbs, sub-key points
//! - [`triangulate`]: a triangle mesh of what outlines enclose
//! - [`puppet`]: a drawn part that follows its limbs
//! - [`arap`]: as-rigid-as-possible manipulation of a triangle mesh in two linear steps (Igarashi et al. 2005)
//! - [`depth`]: which part is in front, from a few marks (Sýkora et al. 2010)

#![forbid(unsafe_code)]

pub mod arap;
pub mod capture;
pub mod depth;
pub mod limb;
pub mod puppet;
pub mod triangulate;
