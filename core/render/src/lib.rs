//! Pictures of what was found: mattes, cut-outs, overlays and id pictures of the parts of a scene, and painted drawings.
//!
//! This crate draws contours that are there already. It finds none, and it decodes no footage (`rototoon-image`).
//!
//! - [`overlay`](mod@overlay): contours, control points, keys and confidence over the footage
//! - [`coverage`]: exact area coverage of unions of polygons
//! - [`mask`]: parts at a time, blurred by motion, grown and feathered
//! - [`rows`]: a mask row by row
//! - [`composite`]: several masks as one
//! - [`matte`](mod@matte): coverage of the closed parts, and what of the footage they cover
//! - [`visible`]: how much of each pixel every part shows, nearer parts over farther ones
//! - [`ids`]: the same as a colour for each part; mattes with a layer for each
//! - [`cryptomatte`]: the same as ranked ids, for keyers
//! - [`paint`](mod@paint): painted regions and strokes, alone and below their drawing
//! - [`stroke`]: strokes of varying width as areas
//! - [`layers`]: OpenEXR files of any number of named channels
//! - [`form`]: bits and compression of OpenEXR files
//! - [`header`]: the headers of OpenEXR files
//! - [`motion`]: contours between frames
//! - [`grow`]: the outline moved outward or inward
//! - [`feather`]: soft borders
//! - [`widths`]: the feather at any place, from widths along contours
//! - [`line`](mod@line): lines of a width
//! - `streamed`: the same files, line by line
//! - `cells`: the areas of a pixel that several regions divide
//! - `near`: distances where they decide something
//! - [`encode`]: pictures as bytes of a file
//!
//! # Example
//!
//! The matte of a rectangle whose borders cut through pixels. The value of a pixel is exactly the share of it that the
//! rectangle covers.
//!
//! ```
//! use rototoon_base::geometry::Point;
//! use rototoon_base::scene::{Footage, Part, Scene};
//! use rototoon_render::matte;
//!
//! let rectangle = [(1.5, 1.5), (4.25, 1.5), (4.25, 4.0), (1.5, 4.0)].map(|(x, y)| Point::new(x, y)).to_vec();
//! let footage = Footage { pattern: "%d.png".into(), first: 1, last: 1, fps: 24.0, width: 8, height: 6, held: false };
//! let part = Part { name: "card".into(), closed: true, keys: [(1, rectangle)].into(), ..Part::default() };
//! let matte = matte(&Scene { footage, parts: vec![part] }, 1, None);
//!
//! assert_eq!(matte.get(2, 2), 1.0, "inside");
//! assert_eq!(matte.get(1, 2), 0.5, "half of the pixel");
//! assert_eq!(matte.get(4, 1), 0.125, "a quarter of its width times half of its height");
//! assert_eq!(matte.get(5, 2), 0.0, "outside");
//! assert_eq!(matte.data().iter().sum::<f32>(), 2.75 * 2.5, "together the area of the rectangle");
//! ```

#![forbid(unsafe_code)]

mod cells;
pub mod composite;
pub mod coverage;
pub mod cryptomatte;
pub mod encode;
pub mod feather;
pub mod form;
pub mod grow;
pub mod header;
pub mod ids;
pub mod layers;
pub mod line;
pub mod mask;
pub mod matte;
pub mod motion;
mod near;
pub mod overlay;
pub mod paint;
pub mod rows;
mod streamed;
pub mod stroke;
pub mod visible;
pub mod widths;

pub use encode::{EncodeError, Format};
pub use ids::{id_picture, matte_layers, matte_parts};
pub use matte::{cutout, matte};
pub use overlay::{OverlayOptions, overlay};
pub use paint::{paint_picture, painted};
