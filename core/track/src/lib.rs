//! Contours from key frames to every frame.
//!
//! The work is cut into **jobs**: one part over one span between two of its keys. A preset decides how jobs are solved, one
//! by one or together; its solver keeps what it computed, so that after an edit only what the edit touches is solved again.
//!
//! - [`contract`]: what every preset is given, and what it answers
//! - [`shared`]: what belongs to no single preset: features of pictures, jobs solved one by one, the weakest frame
//! - [`rototoon`]: the default preset
//! - [`zhou2011`]: the preset of Zhou & Xiao 2011
//! - [`rotoscope`]: the presets of Agarwala et al. 2004 and Liang et al. 2012
//! - [`tracker`]: the tracker that other crates call; it chooses the preset
//!
//! `contract` uses none of the others. `shared` uses `contract`. A preset uses both, but no other preset. `tracker` uses all.
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
//! let footage = Footage { pattern: "%d.png".into(), first: 0, last: 8, fps: 12.0, width: 96, height: 72, held: false };
//! let scene = Scene { footage, parts: vec![Part { name: "square".into(), closed: true, keys, ..Part::default() }] };
//!
//! let tracking = Tracker::new(TrackOptions::default()).track(&scene, &Cartoon, &Silent)?;
//! let found = tracking.parts[0].tracks[&4][0];
//! assert!(found.distance(corner(4)) < 2.0, "a blend of the keys would be 32 px too low");
//! # Ok::<(), rototoon_track::TrackError>(())
//! ```

#![forbid(unsafe_code)]

pub mod contract;
pub mod rotoscope;
pub mod rototoon;
pub mod shared;
pub mod tracker;
pub mod zhou2011;

pub use contract::cache::{self, Cache};
pub use contract::error::TrackError;
pub use contract::job::{Correction, Job, SpanSolver, SpanSummary, SpanTrack, Termination};
pub use contract::tracking::{Ending, Exchange, JobReport, PartTrack, SceneSolver, TrackEnd, Tracking};
pub use rototoon::mechanisms::{Mechanism, Mechanisms};
pub use shared::compared::{began, drawings};
pub use shared::hidden::{covers, hidden_share, is_under};
pub use shared::twins::twins;
pub use shared::weakest::{WeakestFrame, weakest_frame};
pub use tracker::{Preset, TrackOptions, Tracker};

#[cfg(test)]
mod tests;
