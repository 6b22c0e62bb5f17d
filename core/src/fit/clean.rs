//! Points made ready: no two equal ones in a row, and none far apart.
//!
//! Fitting looks at points; the tolerance is for the line through them. Long segments therefore get points in between, at
//! most [`SPACING`] tolerances apart as long as that does not multiply the work ([`MOST`]); what is missed between them the
//! final measurement finds.

use crate::geometry::Point;

/// Wanted spacing of points in tolerances.
const SPACING: f64 = 6.0;
/// Points added are at most this many for each one given, plus a few.
const MOST: f64 = 3.0;

/// A polyline ready for fitting.
#[derive(Clone, Debug)]
pub(super) struct Cleaned {
    /// Points without repetitions; of a closed one the first is not repeated at the end.
    pub points: Vec<Point>,
    /// Arc length at each.
    pub lengths: Vec<f64>,
    /// Length of the whole, the closing segment included.
    pub total: f64,
}

/// The points without repetitions.
pub(super) fn distinct(points: &[Point], closed: bool) -> Vec<Point> {
    let mut kept: Vec<Point> = points.to_vec();
    kept.dedup();
    while closed && kept.len() > 1 && kept.first() == kept.last() {
        kept.pop();
    }
    kept
}

/// Fills long segments of distinct points and measures.
pub(super) fn filled(points: &[Point], closed: bool, tolerance: f64) -> Cleaned {
    let n = points.len();
    let segments = if closed && n > 1 { n } else { n - 1 };
    let length: f64 = (0..segments).map(|i| points[i].distance(points[(i + 1) % n])).sum();
    let spacing = (SPACING * tolerance).max(length / (MOST * n as f64 + 200.0));
    let mut all = Vec::with_capacity(n);
    let mut lengths = Vec::with_capacity(n);
    let mut walked = 0.0;
    for i in 0..segments {
        let (a, b) = (points[i], points[(i + 1) % n]);
        let step = a.distance(b);
        let parts = (step / spacing).ceil().max(1.0);
        for k in 0..parts as usize {
            let share = k as f64 / parts;
            all.push(a.lerp(b, share));
            lengths.push(walked + step * share);
        }
        walked += step;
    }
    if !closed || n == 1 {
        all.push(points[n - 1]);
        lengths.push(walked);
    }
    Cleaned { points: all, lengths, total: walked }
}
