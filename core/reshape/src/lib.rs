//! Drawn characters follow a skeleton: a mesh of each part bends with its limbs, and parts are ordered from back to front.
//!
//! This crate takes contours that are there already. It does not find them in pictures (`rototoon-track`), and it does not
//! invent motions (`rototoon-style`).
//!
//! - [`capture`]: key points from contours
//! - [`fit`]: a clip in a drawing's proportions and place
//! - [`retarget`]: a clip of one body for another body, chain by chain
//! - [`contacts`]: when feet stand; [`stand`]: feet on the ground; [`reach`]: inverse kinematics
//! - [`limb`]: quadratic Bézier limbs, sub-key points
//! - [`triangulate`]: a triangle mesh of what outlines enclose
//! - [`puppet`]: a drawn part that follows its limbs
//! - [`examples`]: what other drawings of a part teach about its shape (Lewis et al. 2000); [`mean_value`] coordinates
//! - [`arap`]: as-rigid-as-possible manipulation of a triangle mesh in two linear steps (Igarashi et al. 2005)
//! - [`depth`]: which part is in front, from a few marks (Sýkora et al. 2010)
//!
//! # Example
//!
//! A square is made into a mesh and two neighbouring corners are turned by a quarter turn. The rest follows rigidly.
//!
//! ```
//! use rototoon_base::geometry::Point;
//! use rototoon_reshape::arap::{Mesh, Solver};
//! use rototoon_reshape::triangulate::triangulate;
//!
//! let square = [(0.0, 0.0), (60.0, 0.0), (60.0, 60.0), (0.0, 60.0)].map(|(x, y)| Point::new(x, y)).to_vec();
//! let mesh = triangulate(&[square], &[], 15.0)?;
//! let rest = mesh.vertices.clone();
//! let vertex = |p: Point| rest.iter().position(|v| v.distance(p) < 1e-6).expect("corners are vertices");
//! let held = [Point::ZERO, Point::new(60.0, 0.0)];
//!
//! let mut solver = Solver::new(Mesh::new(mesh.vertices, mesh.triangles)?, &held.map(vertex))?;
//! let posed = solver.solve(&held.map(|p| p.perp()))?;
//! assert!(rest.iter().zip(&posed).all(|(before, after)| after.distance(before.perp()) < 1e-6), "a pure turn");
//!
//! let stretched = solver.solve(&[held[0], held[1] + Point::new(15.0, 0.0)])?;
//! let far = stretched[vertex(Point::new(0.0, 60.0))];
//! assert!((far.y - 60.0).abs() < 6.0, "the far side keeps its distance: {far}");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![forbid(unsafe_code)]

pub mod arap;
pub mod capture;
pub mod contacts;
mod cycle;
pub mod depth;
pub mod examples;
pub mod facing;
pub mod fit;
pub mod foot;
pub mod limb;
pub mod mean_value;
mod pitch;
pub mod puppet;
pub mod reach;
pub mod retarget;
pub mod stand;
pub mod still;
pub mod triangulate;
