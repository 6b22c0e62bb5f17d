//! One part over one span: what a solver is given, and what it returns.

use super::error::TrackError;
use rototoon_base::geometry::{Point, polygon};
use rototoon_base::scene::{FrameSource, Progress, Span};
use std::collections::BTreeMap;

/// What the artist fixed on one frame between the keys.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Correction {
    /// Control points by index: hard constraints.
    pub pins: BTreeMap<usize, Point>,
    /// Where the mean of the control points lies: a hard constraint, but to the default solver a place to look at if the
    /// part was moved far.
    pub center: Option<Point>,
}

/// One part between two neighbouring keys.
#[derive(Clone, Debug, PartialEq)]
pub struct Job {
    /// Name of the part, for messages.
    pub name: String,
    /// Whether the contour is closed.
    pub closed: bool,
    /// The frames, keys included.
    pub span: Span,
    /// Control points on the first and the last frame of the span: equal in number.
    pub keys: [Vec<Point>; 2],
    /// The artist's corrections by index of the frame in the span; none at the keys.
    pub corrections: BTreeMap<usize, Correction>,
    /// By index of the frame in the span: closed contours of the nearer parts, as tracked.
    pub occluders: Vec<Vec<Vec<Point>>>,
    /// Size of the pictures in pixels.
    pub size: (usize, usize),
}

/// What a solver found for a job.
#[derive(Clone, Debug, PartialEq)]
pub struct SpanTrack {
    /// Control points on each frame of the span, keys and corrections kept exactly.
    pub points: Vec<Vec<Point>>,
    /// By frame and point, 0 to 1; 1 at the keys.
    pub confidence: Vec<Vec<f64>>,
    /// How the solver fared.
    pub summary: SpanSummary,
}

/// Why a solver stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Termination {
    /// There is no frame between the keys, or nothing is free to move.
    NothingToSolve,
    /// The last step lowered the cost by less than the tolerance.
    CostConverged,
    /// The last step was shorter than the tolerance.
    StepConverged,
    /// No step lowers the cost, at any damping.
    NoDescent,
    /// The limit of iterations was reached.
    IterationLimit,
    /// The best path through the hypotheses was chosen.
    PathChosen,
}

/// How a solver fared on a job.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpanSummary {
    /// Why it stopped.
    pub termination: Termination,
    /// Iterations of the innermost solver, all starts together.
    pub iterations: usize,
    /// Cost at the start.
    pub initial_cost: f64,
    /// Cost of what is returned.
    pub final_cost: f64,
}

/// Solves jobs. One solver serves all jobs of a run (from several threads) and may keep what it computes from pictures.
pub trait SpanSolver: Send + Sync {
    /// Tracks the part through the span. The result depends on nothing but the job and the pictures.
    fn solve(&self, job: &Job, frames: &dyn FrameSource, progress: &dyn Progress) -> Result<SpanTrack, TrackError>;

    /// Forgets what was kept of pictures, since the footage is another.
    fn forget_pictures(&self);
}

impl Correction {
    /// Without the centre.
    pub fn pins_only(&self) -> Self {
        Self { center: None, ..self.clone() }
    }

    /// Fixes control points so that the correction holds exactly: pins are set, then the points that are not pinned are
    /// shifted together until the centre is where the artist put it.
    pub fn enforce(&self, points: &mut [Point]) {
        self.enforce_within(0.0, points);
    }

    /// The same, but a centre that is no further than `reach` from where the artist put it stays.
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
    /// Fixes the points of frame `index` of the span so that the keys and corrections hold exactly: pins are set, then
    /// the points that are not pinned are shifted together until the centre is where the artist put it.
    pub fn enforce(&self, index: usize, points: &mut [Point]) {
        self.enforce_within(0.0, index, points);
    }

    /// The same, but a centre may lie up to `reach` from where the artist put it.
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
