//! What a preset answers: the tracks of all parts, and how they came about.

use super::error::TrackError;
use super::job::SpanSummary;
use rototoon_base::geometry::Point;
use rototoon_base::scene::{FrameNumber, FrameSource, Progress, Scene, Span};
use std::collections::BTreeMap;

/// The result of tracking.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tracking {
    /// One entry per part, in the order of the scene.
    pub parts: Vec<PartTrack>,
    /// One entry per job, ordered by part, then by span.
    pub jobs: Vec<JobReport>,
    /// Parts that look alike and may have changed places.
    pub exchanges: Vec<Exchange>,
}

/// Two parts that look alike, and the frames on which nothing says which is which.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Exchange {
    /// Their indices in the scene.
    pub parts: [usize; 2],
    /// The frames. Their contours are doubtful there, or lost.
    pub frames: Vec<FrameNumber>,
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

/// Why a track from a single key ends before the footage does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// The part was lost and needs a key.
    Lost,
    /// The footage changes to another shot.
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

/// The end of a track that ends before the footage does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TrackEnd {
    /// The first frame beyond the track. If the part was lost it needs a key there.
    pub frame: FrameNumber,
    /// Why it ends there.
    pub reason: Ending,
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
