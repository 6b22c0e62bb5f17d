//! Rototoon's core: contour capture for drawn animation.
//!
//! # Reading order
//!
//! 1. [`scene`]: what the stages hand to each other (footage, parts, pictures, progress).
//! 2. [`image`]: pictures from files and what is computed on them.
//! 3. [`track`]: contours from key frames to every frame.
//! 4. [`snap`]: contours onto the drawn ink.
//! 5. [`tween`]: the drawings between drawings on key frames, hidden lines.
//! 6. [`style`]: a motion re-made in another character's manner.
//! 7. [`reshape`]: a drawing that follows a skeleton, and which part is in front.
//! 8. [`render`]: pictures of what was found. [`export`]: the same for other programs, and [`import`] their shapes and motions.
//! 9. [`project`]: the document that holds all of it.
//! 10. [`pipeline`]: the stages joined.
//!
//! [`geometry`] and [`numeric`] serve them all; [`curve`] holds quadratic B-splines, and [`fit`] makes them from points.
//!
//! # Coordinates
//!
//! Pixels, x right, y down, origin at the outer top-left corner of the picture: a pixel's centre lies at +0.5.
//! Hosts convert at their border.

pub mod curve;
pub mod export;
pub mod fit;
pub mod geometry;
pub mod image;
pub mod import;
pub mod numeric;
pub mod pipeline;
pub mod project;
pub mod render;
pub mod reshape;
pub mod scene;
pub mod snap;
pub mod style;
pub mod track;
pub mod tween;
