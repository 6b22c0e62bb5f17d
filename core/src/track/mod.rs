//! Tracking: carries contours from key frames to every frame.
//!
//! The work is divided into **jobs**: one part over one span between two of its keys. A preset decides how jobs are
//! solved, one by one or together. Its solver keeps its results, so that after an edit only the affected jobs are
//! solved again.
//!
//! - [`job`]: the input and output of a solver
//! - [`tracker`]: presets, options, results and errors
//! - [`part_by_part`]: order and memory of jobs that are solved one by one
//! - [`weakest`]: the frame where the next key helps most
//!
//! The default preset:
//! - [`rototoon`]: its steps joined
//! - [`features`], [`store`]: data computed once per picture, and a cache for it
//! - [`drawings`]: the distinct drawings of a span; held frames are solved once
//! - [`lattice`]: a part's appearance at a key, on a lattice that bends
//! - [`stage`]: the prepared data of a job
//! - [`propagate`]: poses from a neighbouring drawing
//! - [`search`]: poses from the complete picture
//! - [`pool`]: the hypotheses from both
//! - `corrected`: hypotheses from the artist's corrections
//! - [`select`]: the path of a single part through its hypotheses
//! - [`joint`]: the paths of all parts together
//! - `mend`: hypotheses that follow from the joint choice
//! - `finish`: tracks from the chosen poses, with [`refine`]: contours moved onto the drawing by its colours
//! - [`confidence`]: how sure a point is
//! - [`outward`]: parts with a single key, followed until they are lost
//! - [`mechanisms`]: parts of the method that can be switched off for measurements
//! - [`cuts`]: where the footage changes to another shot
//!
//! The preset of Zhou & Xiao 2011:
//! - [`zhou2011`]: its steps joined
//! - [`edge_maps`]: edges of frames and distances to them, with a cache
//! - [`region`]: the part's centre between keys
//! - [`energy`]: the space-time energy, one file per term
//!
//! The presets of Agarwala et al. 2004 and Liang et al. 2012:
//! - [`agarwala2004`], [`liang2012`]: the choices of each preset
//! - [`rotoscope`]: the space-time energy of both, one file per term, and its minimisation

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
