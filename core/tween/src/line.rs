//! A stroke parametrised by shares of its length: 0 at its first point, 1 at its end.

use super::stroke::Stroke;
use rototoon_base::geometry::{Point, polyline};

/// The share of the length at each point of a stroke, 0 to 1. A closed stroke has one entry more, 1 for the return to
/// its first point. A stroke without length gets even shares.
pub(super) fn vertex_shares(stroke: &Stroke) -> Vec<f64> {
    let mut walked = vec![0.0];
    for (a, b) in polyline::segments(&stroke.points, stroke.closed) {
        walked.push(walked[walked.len() - 1] + a.distance(b));
    }
    let (total, count) = (walked[walked.len() - 1], walked.len());
    if total > 0.0 {
        walked.iter_mut().for_each(|w| *w /= total);
    } else {
        walked.iter_mut().enumerate().for_each(|(k, w)| *w = k as f64 / (count.max(2) - 1) as f64);
    }
    walked
}

/// A stroke that can be read at any share of its length.
pub(super) struct Line<'a> {
    stroke: &'a Stroke,
    shares: Vec<f64>,
}

impl<'a> Line<'a> {
    /// Takes a stroke that has at least one point.
    pub fn new(stroke: &'a Stroke) -> Self {
        Self { stroke, shares: vertex_shares(stroke) }
    }

    /// The place, in pixels, at a share of the length.
    pub fn at(&self, share: f64) -> Point {
        let points = &self.stroke.points;
        let (k, next, within) = self.between(share);
        points[k].lerp(points[next], within)
    }

    /// The indices of the two points around the place at a share, and the place's fraction of the way from the first to
    /// the second, 0 to 1.
    pub fn between(&self, share: f64) -> (usize, usize, f64) {
        let k = self.shares.partition_point(|&s| s <= share).clamp(1, self.shares.len().max(2) - 1);
        let (Some(&from), Some(&to)) = (self.shares.get(k - 1), self.shares.get(k)) else { return (0, 0, 0.0) };
        let within = if to > from { ((share - from) / (to - from)).clamp(0.0, 1.0) } else { 0.0 };
        (k - 1, k % self.stroke.points.len(), within)
    }
}
