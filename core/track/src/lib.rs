//! Contours from key frames to every frame.
//!
//! The work is cut into **jobs**: one part over one span between two of its keys. A preset decides how jobs are solved, one
//! by one or together; its solver keeps what it computed, so that after an edit only what the edit touches is solved again.
//!
//! - [`job`]: what a solver is given and what it returns
//! - [`tracker`]: what is asked, and who answers
//! - [`part_by_part`]: order and memory of jobs that are solved singly
//! - [`weakest`]: where the next key helps most
//!
//! The default preset:
//! - [`rototoon`]: its pieces joined
//! - [`features`], [`store`]: what is computed once from pictures, and kept
//! - [`drawings`]: held frames are worked on once
//! - [`lattice`]: a part's look at a key on a lattice that bends
//! - [`stage`]: what a job is solved with
//! - [`propagate`]: motion from a neighbour
//! - [`search`]: motion from nowhere, by comparing everywhere
//! - [`pool`]: the hypotheses of both
//! - `corrected`: what the artist's corrections add to them
//! - [`select`]: which hypothesis a part alone follows
//! - [`joint`]: which hypotheses all parts follow together
//! - `mend`: what that choice adds to the pools
//! - `finish`: the chosen poses made into tracks, with [`refine`]: contours brought onto the drawing by its colours
//! - [`confidence`]: how sure a point is
//! - [`outward`]: parts with one key, followed until they are lost
//! - [`mechanisms`]: what can be switched off to measure it
//! - [`cuts`]: where the footage goes over to another shot
//!
//! The preset of Zhou & Xiao 2011:
//! - [`zhou2011`]: its pieces joined
//! - [`edge_maps`]: edges of frames and distances to them, kept
//! - [`region`]: where a part's centre lies between keys
//! - [`energy`]: the space-time energy, a file a term
//!
//! The presets of Agarwala et al. 2004 and Liang et al. 2012:
//! - [`agarwala2004`], [`liang2012`]: what each chooses
//! - [`rotoscope`]: the space-time energy of both, a file a term, and its solution
//!
//! # Example
//!
//! A square flies in a bow from the left to the right. It has a key on the first and on the last frame. Both keys have the
//! same height, so the tracker has to find the bow in the pictures.
//!
//! ```
//! use rototoon_base::geometry::Point;
//! use rototoon_base::scene::{Colour, Footage, FrameError, FrameNumber, FrameSource, Part, Raster, Scene, Silent};
//! use rototoon_track::{TrackOptions, Tracker};
//! use std::sync::Arc;
//!
//! fn corner(frame: FrameNumber) -> Point {
//!     Point::new(f64::from(10 + 5 * frame), f64::from(40 - 2 * frame * (8 - frame)))
//! }
//!
//! struct Cartoon;
//! impl FrameSource for Cartoon {
//!     fn picture(&self, frame: FrameNumber) -> Result<Arc<Raster<Colour>>, FrameError> {
//!         Ok(Arc::new(Raster::from_fn(96, 72, |x, y| {
//!             let p = Point::new(x as f64, y as f64) - corner(frame);
//!             let inside = p.min_element() >= 0.0 && p.max_element() < 16.0;
//!             if inside { [0.8, 0.2, 0.1] } else { [0.9, 0.9, 0.8] }
//!         })))
//!     }
//! }
//!
//! let corners = [(0.0, 0.0), (16.0, 0.0), (16.0, 16.0), (0.0, 16.0)];
//! let square = |frame| corners.map(|(x, y)| corner(frame) + Point::new(x, y));
//! let keys = [0, 8].map(|frame| (frame, square(frame).to_vec())).into();
//! let footage = Footage { pattern: "%d.png".into(), first: 0, last: 8, fps: 12.0, width: 96, height: 72 };
//! let scene = Scene { footage, parts: vec![Part { name: "square".into(), closed: true, keys, ..Part::default() }] };
//!
//! let tracking = Tracker::new(TrackOptions::default()).track(&scene, &Cartoon, &Silent)?;
//! let found = tracking.parts[0].tracks[&4][0];
//! assert!(found.distance(corner(4)) < 2.0, "a blend of the keys would be 32 px too low");
//! # Ok::<(), rototoon_track::TrackError>(())
//! ```

#![forbid(unsafe_code)]

pub mod agarwala2004;
pub mod confidence;
mod corrected;
pub mod cuts;
pub mod drawings;
pub mod edge_maps;
pub mod energy;
pub mod features;
mod finish;
pub mod job;
pub mod joint;
pub mod lattice;
pub mod liang2012;
pub mod mechanisms;
mod mend;
pub mod outward;
pub mod part_by_part;
pub mod pool;
pub mod propagate;
pub mod refine;
pub mod region;
pub mod rotoscope;
pub mod rototoon;
pub mod search;
pub mod select;
pub mod stage;
pub mod store;
mod tasks;
pub mod tracker;
pub mod weakest;
pub mod zhou2011;

pub use job::{Correction, Job, SpanSolver, SpanSummary, SpanTrack, Termination};
pub use mechanisms::{Mechanism, Mechanisms};
pub use outward::{Ending, TrackEnd};
pub use tracker::{JobReport, PartTrack, Preset, SceneSolver, TrackError, TrackOptions, Tracker, Tracking};
pub use weakest::{WeakestFrame, weakest_frame};

#[cfg(test)]
mod tests;
