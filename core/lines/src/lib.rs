//! Drawn lines as strokes: ink, centre lines, and the same strokes on every drawing.
//!
//! [`trace`] turns a picture of a line drawing into strokes with width and colour, as long and as few as a person would
//! draw. [`carry()`] finds the same strokes on the next drawing: a stroke keeps its number, ink that no stroke explains gets
//! a new one, and a stroke without ink ends. [`identify`] gives the numbers to strokes that an artist drew there, and
//! [`between()`] carries strokes from two drawings of the artist to those between them.
//!
//! This crate finds lines in pictures. It does not follow contours of painted parts (`rototoon-track`) and makes no
//! in-betweens (`rototoon-tween`).
//!
//! # How
//!
//! Files, in reading order:
//!
//! - [`ink`]: which pixels are ink; `paper` behind them, `distance` within them
//! - `thin`: the skeleton of the ink
//! - `graph`: branches and junctions
//! - `solid`: solid blacks as outlines, with `outline`
//! - `centre`: branches on the ink's centre of gravity
//! - `pairing`: which branch goes on in which, with `direction`, `cluster`, `outside` and `corner`
//! - `strokes`: paired branches as strokes
//! - `sketch`, `economy`: rough drawings, and strokes that nobody would draw
//! - `drawing`, `stroke`: all of this for one picture
//! - `width`: how wide a line is at each point
//! - `finish`: fitted curves, widths, colours
//! - `carry`: the next drawing
//! - [`displaced`]: where the lines of one drawing are on another one
//! - [`apart`]: how far drawn lines are from what a picture shows
//!
//! Methods that solve for a frame field over the ink (Favreau et al. 2016, Bessmeltsev & Solomon 2019, Puhachov et al.
//! 2021) place junctions better in blots, but take minutes for a drawing. A skeleton takes a tenth of a second. What it gets
//! wrong lies within blots: spurs, split crossings, bends. These are mended on the graph, with the blot's size as the
//! measure. So no number of pixels decides, and lines of any width are treated alike.
//!
//! # Limits
//!
//! A solid black that is long against its width becomes a stroke along its middle. Lines of one pixel look up to two
//! pixels broader. Which line is in front is not known. Limbs that pass each other exchange or lose their numbers.
//!
//! # Example
//!
//! Two lines cross. They become two strokes, and on the next drawing, 6 px to the right, they are the same two.
//!
//! ```
//! use rototoon_base::scene::Raster;
//! use rototoon_lines::{Drawing, Options, Tracked, carry};
//! use std::sync::Arc;
//!
//! let cross = |shift: usize| {
//!     let ink = |x: usize, y: usize| (48..51).contains(&y) && (10..80).contains(&x) || (39..42).contains(&x) && y > 9 && y < 90;
//!     Arc::new(Raster::from_fn(100, 100, |x, y| if x >= shift && ink(x - shift, y) { [0.1; 3] } else { [1.0; 3] }))
//! };
//! let [first, second] = [0, 6].map(|shift| Drawing::new(cross(shift), &Options::default()));
//! let strokes: Vec<Tracked> =
//!     first.strokes().into_iter().enumerate().map(|(track, stroke)| Tracked::sure(track, stroke)).collect();
//! assert_eq!(strokes.len(), 2);
//!
//! let mut next = 2;
//! let carried = carry(&first, &strokes, &second, &mut next);
//! assert_eq!((carried.len(), next), (2, 2), "no stroke is new");
//! for (before, after) in strokes.iter().zip(&carried) {
//!     let middle = |s: &Tracked| s.stroke.points.iter().sum::<rototoon_base::geometry::Point>() / s.stroke.points.len() as f64;
//!     assert!((middle(after) - middle(before)).distance((6.0, 0.0).into()) < 1.5);
//! }
//! ```

#![forbid(unsafe_code)]

pub mod apart;
mod carry;
mod centre;
mod cluster;
mod corner;
mod direction;
mod drawing;
mod economy;
mod finish;
mod graph;
pub mod ink;
pub mod outline;
mod outside;
mod pairing;
mod sketch;
mod solid;
mod stroke;
mod strokes;
mod thin;
mod width;

pub use carry::{Bound, Displaced, Key, Shown, between, bind, bound, carry, carry_known, displaced, identify, is_same};
pub use drawing::Drawing;
pub use stroke::{Options, Stroke, Style, Tracked};

use rototoon_base::scene::{Colour, Raster};
use std::sync::Arc;

/// Traces one drawing.
pub fn trace(picture: Arc<Raster<Colour>>, options: &Options) -> Vec<Stroke> {
    Drawing::new(picture, options).strokes()
}
