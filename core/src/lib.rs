//! Rototoon: contour capture, in-betweening and style transfer for drawn animation.
//!
//! This crate joins the stages ([`pipeline`]) and names all of them in one place. Each stage is a crate of its own:
//!
//! | name here | crate | what it does |
//! | --- | --- | --- |
//! | [`numeric`], [`geometry`], [`curve`], [`scene`] | `rototoon-base` | what all stages share |
//! | [`image`] | `rototoon-image` | pictures from files, filters, optical flow |
//! | [`fit`] | `rototoon-fit` | quadratic B-splines from points |
//! | [`track`] | `rototoon-track` | contours from key frames to every frame |
//! | [`snap`] | `rototoon-snap` | tracked contours onto the drawn ink |
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

#![forbid(unsafe_code)]

pub mod pipeline;

pub use rototoon_base::{curve, geometry, numeric, scene};
pub use rototoon_document as project;
pub use rototoon_exchange::{export, import};
pub use rototoon_fit as fit;
pub use rototoon_image as image;
pub use rototoon_render as render;
pub use rototoon_reshape as reshape;
pub use rototoon_snap as snap;
pub use rototoon_style as style;
pub use rototoon_track as track;
pub use rototoon_tween as tween;
