//! Shapes and motions from and to other programs.
//!
//! - [`import`]: Silhouette shapes, SVG drawings and animations, BVH motion capture
//! - [`export`]: Silhouette shapes, SVG, Nuke RotoPaint nodes
//!
//! The two modules do not use each other.

#![forbid(unsafe_code)]

pub mod export;
pub mod import;
