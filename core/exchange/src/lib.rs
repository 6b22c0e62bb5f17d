//! Shapes and motions from and to other programs.
//!
//! This crate translates between texts and scenes. It opens no files, and it neither changes nor checks a project document;
//! that is the work of `rototoon-document`.
//!
//! - [`import`]: Silhouette, Nuke and Natron shapes, SVG drawings and animations, BVH motion capture
//! - [`export`]: Silhouette shapes, SVG, Nuke RotoPaint nodes, scripts for Natron and After Effects
//!
//! The two modules do not use each other.
//!
//! # Example
//!
//! An animated contour goes to SVG and comes back.
//!
//! ```
//! use rototoon_base::geometry::Point;
//! use rototoon_base::scene::{Footage, Part, Scene};
//! use rototoon_exchange::export::{SvgOptions, svg};
//! use rototoon_exchange::import;
//!
//! let corners = [(0.0, 0.0), (20.0, 0.0), (20.0, 20.0), (0.0, 20.0)];
//! let square = |left: f64| corners.map(|(x, y)| Point::new(left + x, y)).to_vec();
//! let keys = [(1, square(10.0)), (2, square(30.0))].into();
//! let footage = Footage { pattern: "%d.png".into(), first: 1, last: 2, fps: 12.0, width: 64, height: 36, held: false };
//! let part = Part { name: "box & lid".into(), closed: true, keys, ..Part::default() };
//! let scene = Scene { footage, parts: vec![part] };
//!
//! let text = svg(&scene, &SvgOptions::default());
//! assert!(text.contains("<title>box &amp; lid</title>"));
//!
//! let found = import::svg::svg(&text, &scene.footage, 1)?;
//! assert!(found.warnings.is_empty());
//! assert_eq!(found.shapes[0].name, "box & lid");
//! assert_eq!(found.shapes[0].keys, scene.parts[0].keys);
//! # Ok::<(), import::ImportError>(())
//! ```

#![forbid(unsafe_code)]

mod between;
pub mod export;
pub mod import;
