//! A job: one part over one span. This module defines the input and the output of a solver.

use super::error::TrackError;
use rototoon_base::geometry::{Point, polygon};
use rototoon_base::scene::{FrameSource, Progress, Span};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// The artist's corrections on one frame between the keys. Places are in pixels of the picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Correction {
    /// Fixed control points by index. They are hard constraints.
    pub pins: BTreeMap<usize, Point>,
    /// Corrected centre: the mean of the control points. It is a hard constraint, with one exception: if the artist
    /// moved the part far, the default solver takes it as the place to search.
    pub center: Option<Point>,
}

/// One part between two neighbouring keys. All places are in pixels of the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Job {
    /// Name of the part, for messages.
    pub name: String,
    /// Whether the contour is closed.
    pub closed: bool,
    /// The frames, with both keys.
    pub span: Span,
    /// Control points on the first and the last frame of the span. Both have the same number.
    pub keys: [Vec<Point>; 2],
    /// The artist's corrections by frame index in the span. Keys have none.
    pub corrections: BTreeMap<usize, Correction>,
    /// Frame indices in the span on which the part is not there, by the artist's word. Keys are never among them.
    pub absent: BTreeSet<usize>,
    /// By frame index in the span: closed contours of the nearer parts, keyed or tracked.
    pub occluders: Vec<Vec<Vec<Point>>>,
    /// Width and height of the pictures in pixels.
    pub size: (usize, usize),
}

/// The result of a job.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpanTrack {
    /// Control points on each frame of the span, in pixels of the picture. Keys and corrections are exact.
    pub points: Vec<Vec<Point>>,
    /// Confidence by frame and point, 0 to 1. It is 1 at the keys.
    pub confidence: Vec<Vec<f64>>,
    /// How the solver ended.
    pub summary: SpanSummary,
}

/// Why a solver stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Termination {
    /// There is no frame between the keys, or no point is free to move.
    NothingToSolve,
    /// The last step lowered the cost by less than the tolerance.
    CostConverged,
    /// The last step was shorter than the tolerance.
    StepConverged,
    /// No step lowers the cost, at any damping.
    NoDescent,
    /// The solver reached its limit of iterations.
    IterationLimit,
    /// A path of least cost through the hypotheses was chosen.
    PathChosen,
}

/// How a solver ended on a job.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpanSummary {
    /// Why it stopped.
    pub termination: Termination,
    /// Iterations of the innermost solver, summed over all starts.
    pub iterations: usize,
    /// Cost at the start.
    pub initial_cost: f64,
    /// Cost of the result.
    pub final_cost: f64,
}

/// Solves jobs. One solver serves all jobs of a run from several threads. It may keep data that it computed from
/// pictures.
pub trait SpanSolver: Send + Sync {
    /// Tracks the part through the span. The result depends only on the job and the pictures.
    ///
    /// # Errors
    ///
    /// The error of a picture that cannot be read, or the cancellation by `progress`.
    fn solve(&self, job: &Job, frames: &dyn FrameSource, progress: &dyn Progress) -> Result<SpanTrack, TrackError>;

    /// Forgets all data from pictures, because the footage has changed.
    fn forget_pictures(&self);
}

impl Correction {
    /// The correction without its centre.
    pub fn pins_only(&self) -> Self {
        Self { center: None, ..self.clone() }
    }

    /// Moves control points so that the correction is fulfilled exactly. Pinned points are set. Then the other points
    /// are shifted together until the centre is the corrected one. If all points are pinned, the centre has no effect.
    pub fn enforce(&self, points: &mut [Point]) {
        self.enforce_within(0.0, points);
    }

    /// The same as [`Correction::enforce`], but the points are not shifted if their centre is at most `reach` from the
    /// corrected one. Same unit as the points.
    pub fn enforce_within(&self, reach: f64, points: &mut [Point]) {
        for (&j, &p) in &self.pins {
            points[j] = p;
        }
        let Some(center) = self.center.filter(|center| polygon::center(points).distance(*center) > reach) else {
            return;
        };
        let free = points.len() - self.pins.len();
        let missing = center * points.len() as f64 - points.iter().sum::<Point>();
        for (j, p) in points.iter_mut().enumerate() {
            if !self.pins.contains_key(&j) {
                *p += missing / free as f64;
            }
        }
    }
}

impl Job {
    /// Sets the points of frame `index` of the span so that keys and corrections are fulfilled exactly. On a key they
    /// become the key's points. On other frames see [`Correction::enforce`].
    pub fn enforce(&self, index: usize, points: &mut [Point]) {
        self.enforce_within(0.0, index, points);
    }

    /// The same as [`Job::enforce`], but the centre may be up to `reach` from the corrected one.
    pub fn enforce_within(&self, reach: f64, index: usize, points: &mut [Point]) {
        if index == 0 || index + 1 == self.span.len() {
            points.copy_from_slice(&self.keys[usize::from(index != 0)]);
            return;
        }
        let Some(correction) = self.corrections.get(&index) else { return };
        correction.enforce_within(reach, points);
    }

    /// The track where nothing is to be solved: the keys blended, corrections kept.
    pub fn keys_only(&self) -> SpanTrack {
        let mut points: Vec<Vec<Point>> = (0..self.span.len()).map(|index| self.interpolated(index)).collect();
        points.iter_mut().enumerate().for_each(|(index, points)| self.enforce(index, points));
        let confidence = points.iter().map(|points| vec![1.0; points.len()]).collect();
        let summary =
            SpanSummary { termination: Termination::NothingToSolve, iterations: 0, initial_cost: 0.0, final_cost: 0.0 };
        SpanTrack { points, confidence, summary }
    }

    /// The keys blended linearly at frame `index` of the span.
    pub fn interpolated(&self, index: usize) -> Vec<Point> {
        let share = index as f64 / (self.span.len() - 1) as f64;
        self.keys[0].iter().zip(&self.keys[1]).map(|(a, b)| a.lerp(*b, share)).collect()
    }
}
