//! Reshaping: drawn characters follow a skeleton clip.
//!
//! - [`capture`]: key points from tracked contours
//! - [`limb`]: limbs as quadratic Bézier splines, sub-key points
//! - [`triangulate`]: a triangle mesh of the area within outlines
//! - [`puppet`]: a drawn part that follows its limbs
//! - [`arap`]: as-rigid-as-possible manipulation of a triangle mesh in two linear steps (Igarashi et al. 2005)
//! - [`depth`]: the order of parts in depth, from a few marks (Sýkora et al. 2010)
//!
//! The method is that of Liang et al. 2012, section 5; each module says where it departs from the paper. All
//! coordinates are picture coordinates with x right and y down.

pub mod arap;
pub mod capture;
pub mod depth;
pub mod limb;
pub mod puppet;
pub mod triangulate;
