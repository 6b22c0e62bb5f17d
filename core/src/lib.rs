//! Rototoon: contour capture, in-betweening and style transfer for drawn animation.
//!
//! This crate joins the stages ([`pipeline`]) and names all of them in one place. Each stage is a crate of its own:
//!
//! | name here | crate | what it does |
//! | --- | --- | --- |
//! | [`numeric`], [`geometry`], [`curve`], [`scene`] | `rototoon-base` | what all stages share |
//! | [`image`] | `rototoon-image` | filters, optical flow |
//! | [`pictures`] | `rototoon-pictures` | pictures from files |
//! | [`fit`] | `rototoon-fit` | quadratic B-splines from points |
//! | [`lines`] | `rototoon-lines` | drawn lines as strokes, the same on all frames |
//! | [`fill`] | `rototoon-fill` | colours of regions, carried from painted drawings |
//! | [`track`] | `rototoon-track` | contours from key frames to every frame |
//! | [`snap`] | `rototoon-snap` | tracked contours onto the drawn ink |
//! | [`conform`] | `rototoon-conform` | old footage found again in new footage |
//! | [`tween`] | `rototoon-tween` | matched strokes, in-betweens, hidden lines |
//! | [`style`] | `rototoon-style` | a motion re-made in another character's manner |
//! | [`reshape`] | `rototoon-reshape` | a drawing that follows a skeleton |
//! | [`project`] | `rototoon-document` | the project document and the clip library |
//! | [`export`], [`import`] | `rototoon-exchange` | other programs' files |
//! | [`render`] | `rototoon-render` | mattes, overlays, id pictures |
//!
//! # Coordinates
//!
//! Pixels, x right, y down. The origin is the outer top-left corner of the picture, so the centre of a pixel lies at +0.5.
//! Hosts convert at their border.
//!
//! # Examples
//!
//! Track a document. A red square moves through a tiny cartoon. The artist has set a key on the first and on the last frame.
//! Tracking finds the square on the frames between.
//!
//! ```
//! use rototoon::geometry::Point;
//! use rototoon::render::{Format, encode};
//! use rototoon::scene::{Footage, Part, Raster, Scene, Silent};
//! use rototoon::{pipeline, project::Document, track::TrackOptions};
//!
//! // The top left corner of the square, which flies in a bow.
//! let corner = |frame: i32| Point::new(f64::from(10 + 5 * frame), f64::from(40 - 2 * frame * (8 - frame)));
//! let folder = tempfile::tempdir()?;
//! for frame in 0..=8 {
//!     let inside = |p: Point| p.min_element() >= 0.0 && p.max_element() < 16.0;
//!     let colour = |p: Point| if inside(p - corner(frame)) { [0.8, 0.2, 0.1] } else { [0.9, 0.9, 0.8] };
//!     let picture = Raster::from_fn(96, 72, |x, y| colour(Point::new(x as f64, y as f64)));
//!     std::fs::write(folder.path().join(format!("{frame:02}.png")), encode::colours(&picture, Format::Png)?)?;
//! }
//!
//! let footage = Footage { pattern: "%02d.png".into(), first: 0, last: 8, fps: 12.0, width: 96, height: 72, held: false };
//! let corners = [(0.0, 0.0), (16.0, 0.0), (16.0, 16.0), (0.0, 16.0)];
//! let square = |frame| corners.map(|(x, y)| corner(frame) + Point::new(x, y));
//! let keys = [0, 8].map(|frame| (frame, square(frame).to_vec())).into();
//! let part = Part { name: "square".into(), closed: true, keys, ..Part::default() };
//! let mut document = Document::new(Scene { footage, parts: vec![part] });
//!
//! pipeline::track(&mut document, folder.path(), &TrackOptions::default(), &Silent)?;
//! let found = document.scene.parts[0].tracks[&4][0];
//! assert!(found.distance(corner(4)) < 2.0, "the keys alone would put it 32 px too low");
//! document.save(&folder.path().join("shot.json"))?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Fit a line. The points of a circle become a closed spline with few guiding points that stays within the tolerance.
//!
//! ```
//! use rototoon::fit::{Options, fit};
//! use rototoon::geometry::Point;
//!
//! let circle: Vec<Point> = (0..360).map(|degree| 100.0 * Point::from_angle(f64::from(degree).to_radians())).collect();
//! let fitted = fit(&circle, true, &Options::new(0.5))?;
//! assert!(fitted.spline.guides().len() <= 10, "360 points became {}", fitted.spline.guides().len());
//! assert!(circle.iter().all(|&p| fitted.spline.nearest(p).distance <= 0.5));
//! # Ok::<(), rototoon::fit::FitError>(())
//! ```

#![forbid(unsafe_code)]

pub mod pipeline;

/// The version of this build, such as "0.2.0", or "0.2.1-dev20261201004020+h1a2b3c4d" between two releases. `cargo xtask` names it in the variable `ROTOTOON_BUILD`;
/// what cargo builds without it has the version of the workspace.
pub const VERSION: &str = match option_env!("ROTOTOON_BUILD") {
    Some(version) => version,
    None => env!("CARGO_PKG_VERSION"),
};

pub use rototoon_base::{curve, file, geometry, limits, memory, numeric, scene};
pub use rototoon_conform as conform;
pub use rototoon_document as project;
pub use rototoon_exchange::{export, import};
pub use rototoon_fill as fill;
pub use rototoon_fit as fit;
pub use rototoon_image as image;
pub use rototoon_lines as lines;
pub use rototoon_pictures as pictures;
pub use rototoon_render as render;
pub use rototoon_reshape as reshape;
pub use rototoon_snap as snap;
pub use rototoon_style as style;
pub use rototoon_track as track;
pub use rototoon_tween as tween;
