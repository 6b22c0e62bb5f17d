//! Contours from key frames to every frame.
//!
//! The tracker cuts the work into **jobs**: one part over one span between two of its keys. Nearer parts come first, so
//! that a job knows what hides its part. A preset decides how a job is solved; [`Tracker`] keeps the jobs that it has
//! solved, so that after an edit only those are solved again whose keys, corrections or occluders changed.
//!
//! - [`job`]: what a solver is given and what it returns
//! - [`tracker`]: order, memory and progress of the jobs
//! - [`weakest`]: where the next key helps most

pub mod job;
pub mod tracker;
pub mod weakest;

pub use job::{Correction, Job, SpanSolver, SpanSummary, SpanTrack, Termination};
pub use tracker::{Preset, TrackError, TrackOptions, Tracker, Tracking};
pub use weakest::{WeakestFrame, weakest_frame};
