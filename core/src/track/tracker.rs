//! Presets, options, results and errors of tracking, and the [`Tracker`], which passes the work to the solver of its
//! preset.
//!
//! A solver keeps its results, so that after an edit only the affected jobs are solved again. A result depends only on
//! the scene and the pictures. It does not depend on earlier runs or on the number of threads.

use super::agarwala2004::Agarwala2004;
use super::job::{SpanSolver, SpanSummary};
use super::liang2012::Liang2012;
use super::mechanisms::Mechanisms;
use super::outward::{Ending, TrackEnd};
use super::part_by_part::PartByPart;
use super::rototoon::Rototoon;
use super::zhou2011::Zhou2011;
use crate::geometry::Point;
use crate::scene::{Cancelled, Footage, FrameError, FrameNumber, FrameSource, Part, Progress, Scene, Span};
use std::collections::BTreeMap;

/// The tracking method.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Preset {
    /// The default method, the best one of Rototoon (module `rototoon`).
    #[default]
    Rototoon,
    /// Zhou & Xiao 2011 as printed (module `zhou2011`).
    Zhou2011,
    /// Agarwala et al. 2004 (module `agarwala2004`).
    Agarwala2004,
    /// Agarwala et al. 2004 with the ribbon and the colour penalty of Liang et al. 2012 (module `liang2012`).
    Liang2012,
}

impl Preset {
    /// Every preset with its id in documents, in parameters and on the command line.
    pub const ALL: [(Self, &str); 4] = [
        (Self::Rototoon, "rototoon"),
        (Self::Zhou2011, "zhou2011"),
        (Self::Agarwala2004, "agarwala2004"),
        (Self::Liang2012, "liang2012"),
    ];

    /// The preset with an id. `None` if there is no such preset.
    pub fn from_id(id: &str) -> Option<Self> {
        Self::ALL.iter().find(|(_, name)| *name == id).map(|(preset, _)| *preset)
    }

    fn solver(self, mechanisms: Mechanisms) -> Box<dyn SceneSolver> {
        match self {
            Self::Rototoon => Box::new(Rototoon::new(mechanisms)),
            Self::Zhou2011 => Box::new(PartByPart::new(Box::new(Zhou2011::default()))),
            Self::Agarwala2004 => Box::new(PartByPart::new(Box::new(Agarwala2004::default()))),
            Self::Liang2012 => Box::new(PartByPart::new(Box::new(Liang2012::default()))),
        }
    }
}

/// Options of tracking.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TrackOptions {
    /// The method.
    pub preset: Preset,
    /// The mechanisms of the default preset. The other presets ignore them.
    pub mechanisms: Mechanisms,
}

/// Why tracking failed. The scene is not changed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TrackError {
    /// A picture could not be read.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// Keys of one part differ in their number of points.
    #[error("part {part:?}: the key on frame {frame} has {found} points, but the first key has {expected}")]
    UnequalKeys {
        /// Name of the part.
        part: String,
        /// Frame of the key that differs.
        frame: FrameNumber,
        /// Its number of points.
        found: usize,
        /// The number of points of the first key.
        expected: usize,
    },
    /// A coordinate is NaN, infinite, or far outside any picture.
    #[error("part {part:?}, frame {frame}: found the point {found}, expected pixel coordinates within ±{limit}")]
    OutOfRange {
        /// Name of the part.
        part: String,
        /// Frame of the key, pin or centre.
        frame: FrameNumber,
        /// The point.
        found: Point,
        /// The largest coordinate allowed.
        limit: f64,
    },
    /// A pin names a control point that the part does not have.
    #[error("part {part:?}, frame {frame}: found a pin of point {index}, expected an index below {count}")]
    NoSuchPoint {
        /// Name of the part.
        part: String,
        /// Frame of the pin.
        frame: FrameNumber,
        /// Index of the point, from 0.
        index: usize,
        /// Number of points of the part.
        count: usize,
    },
    /// The pictures are too wide for their height. Scaled to the lines of the tracker they would fill the memory.
    #[error("footage: found pictures of {width}x{height} pixels, expected at most {limit} times as wide as high")]
    TooWide {
        /// Width of the footage.
        width: usize,
        /// Height of the footage.
        height: usize,
        /// The largest allowed ratio of width to height.
        limit: usize,
    },
}

/// The result of tracking.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tracking {
    /// One entry per part, in the order of the scene.
    pub parts: Vec<PartTrack>,
    /// One entry per job, ordered by part, then by span.
    pub jobs: Vec<JobReport>,
}

/// Report on one part over one span.
#[derive(Clone, Debug, PartialEq)]
pub struct JobReport {
    /// Index of the part in the scene.
    pub part: usize,
    /// The frames, with both keys.
    pub span: Span,
    /// The solver's summary.
    pub summary: SpanSummary,
    /// Whether the job was solved in this run, and not reused from an earlier one.
    pub solved: bool,
}

/// The track of one part.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PartTrack {
    /// Control points by frame, from the first key to the last, in pixels of the picture. For a part with one key, as
    /// far as it is trusted.
    pub tracks: BTreeMap<FrameNumber, Vec<Point>>,
    /// Confidence by frame and point, 0 to 1.
    pub confidence: BTreeMap<FrameNumber, Vec<f64>>,
    /// Ends of the track of a part with one key that are not ends of the footage, the backward one first.
    pub ends: Vec<TrackEnd>,
}

impl PartTrack {
    /// Frames on which the part needs a key, because it was lost there.
    pub fn wants_key(&self) -> Vec<FrameNumber> {
        self.ends.iter().filter(|end| end.reason == Ending::Lost).map(|end| end.frame).collect()
    }
}

/// Tracks all parts of a scene. A solver may keep its results for the next run.
pub trait SceneSolver: Send {
    /// Tracks every part between its first and its last key.
    ///
    /// The caller has checked the scene. Its footage is that of the last call, unless the caller has called
    /// [`SceneSolver::forget`]. After an error the solver still has its earlier results.
    ///
    /// # Errors
    ///
    /// See [`TrackError`].
    fn track(
        &mut self,
        scene: &Scene,
        frames: &dyn FrameSource,
        progress: &dyn Progress,
    ) -> Result<Tracking, TrackError>;

    /// Forgets all results and pictures.
    fn forget(&mut self);
}

/// Tracks scenes, and keeps its results from one run to the next.
pub struct Tracker {
    solver: Box<dyn SceneSolver>,
    footage: Option<Footage>,
}

impl Tracker {
    /// A tracker without any results yet.
    pub fn new(options: TrackOptions) -> Self {
        Self { solver: options.preset.solver(options.mechanisms), footage: None }
    }

    /// A tracker that solves part by part with the caller's solver.
    pub fn with_solver(solver: Box<dyn SpanSolver>) -> Self {
        Self { solver: Box::new(PartByPart::new(solver)), footage: None }
    }

    /// Tracks every part of `scene` between its first and its last key. It runs on the caller's rayon pool.
    ///
    /// The default preset follows parts with one key outward, as far as they can be trusted. With the other presets
    /// such a part has a track on its key frame only. After an error the tracker still has its earlier results.
    ///
    /// # Errors
    ///
    /// See [`TrackError`]: a picture that cannot be read, cancellation by `progress`, keys with different numbers of
    /// points, coordinates out of range, a pin of a point that does not exist, or, with the default preset, pictures
    /// that are too wide.
    pub fn track(
        &mut self,
        scene: &Scene,
        frames: &dyn FrameSource,
        progress: &dyn Progress,
    ) -> Result<Tracking, TrackError> {
        scene.parts.iter().try_for_each(check)?;
        if self.footage.as_ref() != Some(&scene.footage) {
            self.forget();
            self.footage = Some(scene.footage.clone());
        }
        let mut tracking = self.solver.track(scene, frames, progress)?;
        for (part, track) in scene.parts.iter().zip(&mut tracking.parts) {
            for (&frame, key) in &part.keys {
                track.tracks.insert(frame, key.clone());
                track.confidence.insert(frame, vec![1.0; key.len()]);
            }
        }
        Ok(tracking)
    }

    /// Forgets all results and pictures. Call it if the files of the footage have changed.
    pub fn forget(&mut self) {
        self.solver.forget();
    }
}

/// Largest coordinate that is accepted, in pixels: more than a hundred times the width of an 8k picture.
const FURTHEST: f64 = 1e6;

fn check(part: &Part) -> Result<(), TrackError> {
    let name = || part.name.clone();
    let expected = part.point_count();
    let in_range = |frame: FrameNumber, points: Vec<Point>| {
        // Written so that NaN fails the comparison.
        match points.into_iter().find(|p| !(p.abs().max_element() <= FURTHEST && p.is_finite())) {
            Some(found) => Err(TrackError::OutOfRange { part: name(), frame, found, limit: FURTHEST }),
            None => Ok(()),
        }
    };
    for (&frame, key) in &part.keys {
        if key.len() != expected {
            return Err(TrackError::UnequalKeys { part: name(), frame, found: key.len(), expected });
        }
        in_range(frame, key.clone())?;
    }
    for (&frame, pins) in &part.pins {
        if let Some((&index, _)) = pins.iter().find(|(index, _)| **index >= expected) {
            return Err(TrackError::NoSuchPoint { part: name(), frame, index, count: expected });
        }
        in_range(frame, pins.values().copied().collect())?;
    }
    part.centers.iter().try_for_each(|(&frame, &center)| in_range(frame, vec![center]))
}
