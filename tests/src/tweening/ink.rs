//! Distances between drawn and true ink, and the sums of them that the tables print.

use rototoon::geometry::{Point, polyline};
use rototoon::tween::Stroke;
use rototoon::tween::between::Sequence;

/// Distance of the samples along the ink, in pixels.
const STEP: f64 = 4.0;
/// Distances above this count as this, in pixels: the ink is missing.
const MOST: f64 = 24.0;

/// Sums of the distances between drawn and true ink, in pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InkErrors {
    /// Number of frames.
    pub frames: usize,
    /// Of the earlier key, held.
    pub held: f64,
    /// Of Rototoon.
    pub ours: f64,
    /// Spans, and those on which Rototoon is farther from the truth than holding.
    pub spans: (usize, usize),
    /// Spans in which Rototoon holds the earlier key itself.
    pub holding: usize,
    /// Right and wrong pairs, where they are known.
    pub pairs: (usize, usize),
}

impl InkErrors {
    /// The errors of the in-betweens of one span. `truth` has the true ink of each frame between its keys.
    pub fn of_span(sequence: &Sequence, first: &[Stroke], truth: &[(i32, Vec<Point>)]) -> Self {
        let mut errors = Self::default();
        let held = ink(first.iter().map(|s| (&s.points[..], s.closed)));
        for (frame, truth) in truth {
            let between = sequence.at(*frame);
            let seen = between.iter().filter(|d| d.opacity > 0.0);
            let ours = ink(seen.map(|d| (&d.stroke.points[..], d.stroke.closed)));
            errors.frames += 1;
            errors.held += apart(&held, truth);
            errors.ours += apart(&ours, truth);
        }
        // Where the earlier key is held, only the rounding of sums differs.
        errors.spans = (1, usize::from(errors.ours > errors.held * (1.0 + 1e-9)));
        errors.holding = usize::from(sequence.is_held(0));
        errors
    }

    /// Adds other sums.
    pub fn add(&mut self, other: Self) {
        self.frames += other.frames;
        self.held += other.held;
        self.ours += other.ours;
        self.spans = (self.spans.0 + other.spans.0, self.spans.1 + other.spans.1);
        self.holding += other.holding;
        self.pairs = (self.pairs.0 + other.pairs.0, self.pairs.1 + other.pairs.1);
    }

    /// Rototoon's error divided by that of holding.
    pub fn ratio(&self) -> f64 {
        self.ours / self.held.max(f64::MIN_POSITIVE)
    }
}

/// Points at even distances along lines.
pub fn ink<'a>(lines: impl Iterator<Item = (&'a [Point], bool)>) -> Vec<Point> {
    let samples = |(points, closed): (&[Point], bool)| {
        let count = (polyline::length(points, closed) / STEP).ceil().max(2.0) as usize;
        if points.len() < 2 { points.to_vec() } else { polyline::resample(points, closed, count) }
    };
    lines.flat_map(samples).collect()
}

/// The mean distance from each of two inks to the other, in pixels.
fn apart(a: &[Point], b: &[Point]) -> f64 {
    let one_way = |a: &[Point], b: &[Point]| {
        let nearest = |p: &Point| b.iter().map(|q| p.distance_squared(*q)).fold(MOST * MOST, f64::min).sqrt();
        a.iter().map(nearest).sum::<f64>() / a.len().max(1) as f64
    };
    0.5 * (one_way(a, b) + one_way(b, a))
}
