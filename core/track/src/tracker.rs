//! What is asked of a tracker, and who answers: the preset's solver.
//!
//! A solver keeps what it computed, so that after an edit only what the edit touches is solved again. A result depends on
//! nothing but the scene and the pictures, whatever was solved before and whatever the number of threads.

use super::agarwala2004::Agarwala2004;
use super::job::{SpanSolver, SpanSummary};
use super::liang2012::Liang2012;
use super::mechanisms::Mechanisms;
use super::outward::{Ending, TrackEnd};
use super::part_by_part::PartByPart;
use super::rototoon::Rototoon;
use super::zhou2011::Zhou2011;
use rototoon_base::geometry::Point;
use rototoon_base::scene::{Cancelled, Footage, FrameError, FrameNumber, FrameSource, Part, Progress, Scene, Span};
use std::collections::BTreeMap;

/// Which method tracks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Preset {
    /// The best that Rototoon knows.
    #[default]
    Rototoon,
    /// Zhou & Xiao 2011 as printed.
    Zhou2011,
    /// Agarwala et al. 2004.
    Agarwala2004,
    /// Agarwala et al. 2004 with the ribbon and the colour penalty of Liang et al. 2012.
    Liang2012,
}

impl Preset {
    /// Every preset with its id in documents, parameters and on the command line.
    pub const ALL: [(Self, &str); 4] = [
        (Self::Rototoon, "rototoon"),
        (Self::Zhou2011, "zhou2011"),
        (Self::Agarwala2004, "agarwala2004"),
        (Self::Liang2012, "liang2012"),
    ];

    /// The preset of an id.
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

/// How to track.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TrackOptions {
    /// The method.
    pub preset: Preset,
    /// What the default preset uses; the others do not listen.
    pub mechanisms: Mechanisms,
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
    /// Keys of one part differ in their number of points.
    #[error("part {part:?}: the key on frame {frame} has {found} points, but the first key has {expected}")]
    UnequalKeys {
        /// Name of the part.
        part: String,
        /// Frame of the differing key.
        frame: FrameNumber,
        /// Its number of points.
        found: usize,
        /// The number on the first key.
        expected: usize,
    },
    /// A coordinate is no number, or far from any picture.
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
    #[error("part {part:?}, frame {frame}: pin of point {index}, but the part has {count} points")]
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
    /// Pictures of a shape that no scene has: scaled to the lines that the tracker works on they would fill the memory.
    #[error("footage: found pictures of {width}x{height} pixels, expected at most {limit} times as wide as high")]
    TooWide {
        /// Width of the footage.
        width: usize,
        /// Height of the footage.
        height: usize,
        /// The largest quotient of both.
        limit: usize,
    },
}

/// What tracking found, in the order of the scene's parts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tracking {
    /// One entry a part.
    pub parts: Vec<PartTrack>,
    /// One entry a job, in the order of parts, then spans.
    pub jobs: Vec<JobReport>,
}

/// How one part fared over one span.
#[derive(Clone, Debug, PartialEq)]
pub struct JobReport {
    /// Index of the part in the scene.
    pub part: usize,
    /// The frames, keys included.
    pub span: Span,
    /// What the solver says.
    pub summary: SpanSummary,
    /// Whether it was solved in this run, not remembered from one before.
    pub solved: bool,
}

/// The track of one part.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PartTrack {
    /// Control points by frame, from the first key to the last; of a part with one key, as far as it is trusted.
    pub tracks: BTreeMap<FrameNumber, Vec<Point>>,
    /// Confidence by frame and point, 0 to 1.
    pub confidence: BTreeMap<FrameNumber, Vec<f64>>,
    /// Where the track of a part with one key ends before the footage does, backwards first.
    pub ends: Vec<TrackEnd>,
}

impl PartTrack {
    /// Frames on which the part wants a key, since it was lost there.
    pub fn wants_key(&self) -> Vec<FrameNumber> {
        self.ends.iter().filter(|end| end.reason == Ending::Lost).map(|end| end.frame).collect()
    }
}

/// Tracks all parts of a scene, and may keep what it computed for the next time.
pub trait SceneSolver: Send {
    /// Tracks every part between its first and its last key.
    ///
    /// The scene was checked; its footage is that of the last call, or the solver was told to forget. After an error the
    /// solver still knows what it knew before.
    fn track(
        &mut self,
        scene: &Scene,
        frames: &dyn FrameSource,
        progress: &dyn Progress,
    ) -> Result<Tracking, TrackError>;

    /// Forgets all results and pictures.
    fn forget(&mut self);
}

/// Tracks scenes, and remembers what it solved from one run to the next.
pub struct Tracker {
    solver: Box<dyn SceneSolver>,
    footage: Option<Footage>,
}

impl Tracker {
    /// A tracker that knows nothing yet.
    pub fn new(options: TrackOptions) -> Self {
        Self { solver: options.preset.solver(options.mechanisms), footage: None }
    }

    /// A tracker that solves part by part with a solver of the caller's.
    pub fn with_solver(solver: Box<dyn SpanSolver>) -> Self {
        Self { solver: Box::new(PartByPart::new(solver)), footage: None }
    }

    /// Tracks every part of `scene` between its first and its last key. Runs on the caller's rayon pool.
    ///
    /// The default preset follows parts with one key outward, as far as they can be trusted; with the others they have a
    /// track on that frame only. After an error the tracker still knows what it knew before.
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

    /// Forgets all results and pictures, since the files of the footage have changed.
    pub fn forget(&mut self) {
        self.solver.forget();
    }
}

/// Largest coordinate that is still taken for a place: a hundred times the width of an 8k picture.
const FURTHEST: f64 = 1e6;

fn check(part: &Part) -> Result<(), TrackError> {
    let name = || part.name.clone();
    let expected = part.point_count();
    let in_range = |frame: FrameNumber, points: Vec<Point>| {
        // A comparison that NaN fails.
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
