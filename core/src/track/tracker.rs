//! Order, memory and progress of tracking jobs.

use super::job::{Correction, Job, SpanSolver, SpanSummary, SpanTrack};
use crate::geometry::{Point, polygon};
use crate::scene::{Cancelled, FrameError, FrameNumber, FrameSource, Part, Progress, Scene, Span};
use std::collections::BTreeMap;

/// Which method tracks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Preset {
    /// The best that Rototoon knows.
    #[default]
    Rototoon,
    /// Zhou & Xiao 2011 as printed.
    Zhou2011,
}

impl Preset {
    /// Every preset with its id in documents, parameters and on the command line.
    pub const ALL: [(Self, &str); 2] = [(Self::Rototoon, "rototoon"), (Self::Zhou2011, "zhou2011")];

    /// The preset of an id.
    pub fn from_id(id: &str) -> Option<Self> {
        Self::ALL.iter().find(|(_, name)| *name == id).map(|(preset, _)| *preset)
    }
}

/// How to track.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TrackOptions {
    /// The method.
    pub preset: Preset,
}

/// Why tracking failed. Nothing was changed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TrackError {
    /// A picture could not be had.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// What tracking found, in the order of the scene's parts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tracking {
    /// One entry a part.
    pub parts: Vec<PartTrack>,
    /// One entry a job, in the order of parts, then spans: part index, span, how its solver fared, and whether it was
    /// solved now (or was known from the run before).
    pub jobs: Vec<(usize, Span, SpanSummary, bool)>,
}

/// The track of one part.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PartTrack {
    /// Control points by frame, from the first key to the last.
    pub tracks: BTreeMap<FrameNumber, Vec<Point>>,
    /// Confidence by frame and point.
    pub confidence: BTreeMap<FrameNumber, Vec<f64>>,
}
