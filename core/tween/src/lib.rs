//! In-betweens: from drawings on key frames to the drawings between them.
//!
//! This crate works on strokes that are already points. It sees no pictures; where footage shows how something moves,
//! `rototoon-track` captures it and the in-betweens can follow that (see [`between::Captured`]).
//!
//! - [`stroke`]: a stroke of a drawing
//! - [`matching`]: which stroke of one drawing is which of the next
//! - [`peg`]: pivots that shift, turn and scale over time, given or found
//! - [`between`]: the drawings between
//! - [`breakdown`]: the frame on which one more drawing helps most
//! - [`hidden`]: which parts of lines a filled shape in front covers
//! - `flow`: the movement of ink that is not matched stroke by stroke
//! - `affine`: a map taken apart into its turn and its stretch
//! - `grid`: nearest places among many, `ink`: places along lines, `line`: strokes by shares of their length, `chain`:
//!   strokes end to end
//!
//! # Example
//!
//! An arm turns by a quarter turn between two drawings, in which its strokes have another order.
//!
//! ```
//! use rototoon_base::geometry::Point;
//! use rototoon_base::scene::Silent;
//! use rototoon_tween::Stroke;
//! use rototoon_tween::between::{GivenPegs, Key, Options, Sequence};
//! use rototoon_tween::matching::{self, match_strokes};
//!
//! let body = Stroke::new((0..=10).map(|i| Point::new(0.0, 10.0 * f64::from(i))).collect(), false);
//! let reach = |direction: Point| (0..=8).map(|i| direction * 10.0 * f64::from(i)).collect();
//! let first = vec![body.clone(), Stroke::new(reach(Point::new(1.0, 0.0)), false)];
//! let second = vec![Stroke::new(reach(Point::new(0.0, -1.0)), false), body];
//!
//! let matching = match_strokes(&first, &second, &[], &matching::Options::default(), &Silent)?;
//! assert_eq!(matching.pairs.iter().map(|pair| (pair.from, pair.to)).collect::<Vec<_>>(), [(0, 1), (1, 0)]);
//!
//! let keys = [(0, first), (4, second)].map(|(frame, strokes)| Key { frame, strokes, ..Key::default() });
//! let sequence = Sequence::new(keys.into(), &[matching], &GivenPegs::default(), &Options::default())?;
//! let arm = &sequence.at(2)[1].stroke;
//! assert!((arm.length() - 80.0).abs() < 1.0, "the arm turns; points on straight ways would shorten it to 57 px");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![forbid(unsafe_code)]

mod affine;
mod angle;
pub mod between;
pub mod breakdown;
mod chain;
mod flow;
mod grid;
pub mod hidden;
mod ink;
mod line;
pub mod matching;
pub mod peg;
pub mod stroke;

pub use stroke::{BadPoint, Stroke};
