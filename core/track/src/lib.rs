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

#![forbid(unsafe_code)]

pub mod contract;
pub mod rotoscope;
pub mod rototoon;
pub mod shared;
pub mod tracker;
pub mod zhou2011;

pub use contract::error::TrackError;
pub use contract::job::{Correction, Job, SpanSolver, SpanSummary, SpanTrack, Termination};
pub use contract::tracking::{Ending, JobReport, PartTrack, SceneSolver, TrackEnd, Tracking};
pub use rototoon::mechanisms::{Mechanism, Mechanisms};
pub use shared::weakest::{WeakestFrame, weakest_frame};
pub use tracker::{Preset, TrackOptions, Tracker};

#[cfg(test)]
mod tests;
