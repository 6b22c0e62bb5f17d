//! One line against one shape in front of it: which of its stretches are inside, and which run along the border.
//!
//! 1. All meetings of the line with the outline cut it into stretches on each of which it stays on one side.
//! 2. A stretch whose end keeps within the border's width of the outline for a while runs along it there; the place
//!    where it departs is found by steps along the line and halving.
//! 3. What is left is inside or outside by the winding number of three of its points. Should they disagree, a meeting
//!    was missed (two crossings within rounding of each other, of which one shows): it is found by halving.

use super::cover::Shape;
use super::intervals::Interval;
use super::path::Path;
use super::tree::meet;
use rototoon_base::curve::Meeting;

/// Meetings closer in the parameter are one cut.
const SAME: f64 = 1e-9;

/// Where along a stretch its side is looked at.
const SAMPLES: [f64; 3] = [1.0 / 6.0, 0.5, 5.0 / 6.0];

/// What became of a line.
#[derive(Default)]
pub(super) struct Found {
    /// Stretches inside.
    pub(super) inside: Vec<Interval>,
    /// Stretches along the border.
    pub(super) border: Vec<Interval>,
    /// All parameters where the line meets the outline, and its ends; rising.
    pub(super) cuts: Vec<f64>,
}

/// Distances that decide, in pixels.
#[derive(Clone, Copy)]
pub(super) struct Widths {
    /// What is no farther from the outline lies on it.
    pub(super) border: f64,
    /// Stretches along the border that are shorter count as crossings.
    pub(super) sliver: f64,
}

/// The line `path` against `shape`.
pub(super) fn against(path: &Path, shape: &Shape, widths: Widths) -> Found {
    let (cuts, shared) = meetings(path, shape);
    let mut found = Found::default();
    for pair in cuts.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        let middle = 0.5 * (from + to);
        if shared.iter().any(|&(a, b)| a < middle && middle < b) {
            found.border.push((from, to));
        } else {
            stretch(path, shape, widths, (from, to), &mut found);
        }
    }
    found.cuts = cuts;
    found
}

/// Parameters of the line where it meets the outline, and its ends; and the stretches that it shares with the outline.
fn meetings(path: &Path, shape: &Shape) -> (Vec<f64>, Vec<Interval>) {
    let mut cuts = vec![0.0, path.end()];
    let mut shared = Vec::new();
    for (i, piece) in path.pieces().iter().enumerate() {
        let bounds = piece.bounds();
        if !meet(bounds, shape.bounds()) {
            continue;
        }
        let start = i as f64;
        shape.tree.query(bounds, |j| {
            for meeting in piece.intersect(&shape.pieces[j]) {
                match meeting {
                    Meeting::Point { first, .. } => cuts.push(start + first),
                    Meeting::Overlap { first: (from, to), .. } => {
                        cuts.extend([start + from, start + to]);
                        shared.push((start + from, start + to));
                    }
                }
            }
        });
    }
    cuts.sort_by(f64::total_cmp);
    // Of meetings that are one the first counts, but the end of the line stays its end.
    cuts.dedup_by(|next, kept| *next - *kept < SAME);
    if let Some(last) = cuts.last_mut() {
        *last = path.end();
    }
    (cuts, shared)
}

/// A stretch between two meetings: its ends that keep to the border, and the side of what is between.
fn stretch(path: &Path, shape: &Shape, widths: Widths, (from, to): Interval, found: &mut Found) {
    let left = departure(path, shape, widths, from, to);
    if left >= to {
        found.border.push((from, to));
        return;
    }
    let right = departure(path, shape, widths, to, left);
    if left > from {
        found.border.push((from, left));
    }
    if right < to {
        found.border.push((right, to));
    }
    if left < right {
        sides(path, shape, (left, right), &mut found.inside);
    }
}

/// How far from `start` towards `end` the line keeps to the border: `start` where it only crosses, `end` if all the
/// way.
fn departure(path: &Path, shape: &Shape, widths: Widths, start: f64, end: f64) -> f64 {
    let near = |t: f64| shape.is_near(path.point(t), widths.border);
    let mut step = widths.sliver.max(widths.border);
    let mut last = start;
    let mut next = advanced(path, start, end, step);
    if next == end {
        // A stretch shorter than a step: by its middle.
        return if near(0.5 * (start + end)) { end } else { start };
    }
    if !near(next) {
        return start;
    }
    while near(next) {
        if next == end {
            return end;
        }
        step *= 2.0;
        last = next;
        next = advanced(path, last, end, step);
    }
    for _ in 0..40 {
        let middle = 0.5 * (last + next);
        if near(middle) { last = middle } else { next = middle }
    }
    last
}

/// The parameter that lies `distance` pixels from `t` towards `end`, or the end of the piece if that comes first.
fn advanced(path: &Path, t: f64, end: f64, distance: f64) -> f64 {
    let forward = end > t;
    // At a joint, the piece that lies ahead.
    let ahead = if forward { t.floor() } else { t.ceil() - 1.0 };
    let i = (ahead.max(0.0) as usize).min(path.pieces().len() - 1);
    let (piece, start) = (&path.pieces()[i], i as f64);
    let length = piece.length_to(t - start);
    // At most a quarter of a piece, so that no bend is passed over.
    let (quarter, total) = (0.25, piece.length());
    let wanted = if forward { length + distance } else { length - distance };
    let edge = if forward { start + 1.0 } else { start };
    let reached = if wanted <= 0.0 || wanted >= total { edge } else { start + piece.parameter_at(wanted) };
    let limited = if forward { reached.min(t + quarter).min(end) } else { reached.max(t - quarter).max(end) };
    // Rounding must not stop the march.
    if limited == t { if forward { edge.min(end) } else { edge.max(end) } } else { limited }
}

/// Adds the parts of a stretch that are inside.
fn sides(path: &Path, shape: &Shape, (from, to): Interval, inside: &mut Vec<Interval>) {
    let at = |share: f64| from + (to - from) * share;
    let is_inside = |t: f64| shape.contains(path.point(t));
    let states = SAMPLES.map(|share| is_inside(at(share)));
    let mut start = from;
    for k in 0..SAMPLES.len() {
        let changes = k + 1 < SAMPLES.len() && states[k] != states[k + 1];
        if !changes && k + 1 < SAMPLES.len() {
            continue;
        }
        let end = if changes { change(is_inside, at(SAMPLES[k]), at(SAMPLES[k + 1])) } else { to };
        if states[k] {
            inside.push((start, end));
        }
        start = end;
    }
}

/// Where between two parameters the state changes.
fn change(state: impl Fn(f64) -> bool, mut a: f64, mut b: f64) -> f64 {
    let before = state(a);
    for _ in 0..50 {
        let middle = 0.5 * (a + b);
        if state(middle) == before { a = middle } else { b = middle }
    }
    b
}
