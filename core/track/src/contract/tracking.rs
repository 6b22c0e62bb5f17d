//! What a preset answers: the tracks of all parts, and how they came about.

use super::error::TrackError;
use super::job::SpanSummary;
use rototoon_base::geometry::Point;
use rototoon_base::scene::{FrameNumber, FrameSource, Progress, Scene, Span};
use std::collections::BTreeMap;

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

/// Why a track that goes outward from a single key ends before the footage does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// The part was lost: it wants a key.
    Lost,
    /// The footage goes over to another shot.
    Cut,
    /// The part left the picture.
    Left,
}

impl Ending {
    /// Every ending with its id in summaries.
    pub const ALL: [(Self, &str); 3] = [(Self::Lost, "lost"), (Self::Cut, "cut"), (Self::Left, "left")];

    /// Its id in summaries.
    pub fn id(self) -> &'static str {
        Self::ALL.iter().find(|(ending, _)| *ending == self).map_or("", |(_, id)| id)
    }
}

/// The end of a track, where it is not the footage's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TrackEnd {
    /// The first frame beyond the track: where a key is wanted if the part was lost.
    pub frame: FrameNumber,
    /// Why it ends there.
    pub reason: Ending,
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
