//! One line against one shape in front of it: the stretches of the line inside the shape, and those along its border.
//!
//! 1. All meetings with the outline cut the line into stretches. On each stretch the line stays on one side.
//! 2. A stretch may run along the outline, within the border's width, at one of its ends. Steps along the line and
//!    halving find the place where it departs.
//! 3. The winding numbers of three points decide whether the rest of the stretch is inside. If they disagree, a meeting
//!    was missed (two crossings so close that rounding shows only one). Halving finds it.

use super::cover::Shape;
use super::intervals::Interval;
use super::path::Path;
use super::tree::meet;
use rototoon_base::curve::Meeting;

/// Meetings closer than this in the parameter are one cut.
const SAME: f64 = 1e-9;

/// The shares of a stretch at which its side is tested.
const SAMPLES: [f64; 3] = [1.0 / 6.0, 0.5, 5.0 / 6.0];

/// The stretches of a line relative to one shape.
#[derive(Default)]
pub(super) struct Found {
    /// Stretches inside the shape.
    pub(super) inside: Vec<Interval>,
    /// Stretches along its border.
    pub(super) border: Vec<Interval>,
    /// All parameters where the line meets the outline, and the line's ends; rising.
    pub(super) cuts: Vec<f64>,
}

/// The deciding distances, in pixels.
#[derive(Clone, Copy)]
pub(super) struct Widths {
    /// A point at most this far from the outline is on the border.
    pub(super) border: f64,
    /// Stretches along the border shorter than this count as crossings.
    pub(super) sliver: f64,
}

/// Compares the line `path` with `shape`.
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

/// The parameters of the line where it meets the outline, with the line's ends, and the stretches that it shares with
/// the outline.
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
    // Among meetings that are the same the first counts, but the end of the line stays its end.
    cuts.dedup_by(|next, kept| *next - *kept < SAME);
    if let Some(last) = cuts.last_mut() {
        *last = path.end();
    }
    (cuts, shared)
}

/// Sorts a stretch between two meetings: its ends along the border, and the side of the rest.
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

/// The parameter up to which the line keeps to the border, from `start` towards `end`. It is `start` where the line
/// only crosses, and `end` where it never leaves the border.
fn departure(path: &Path, shape: &Shape, widths: Widths, start: f64, end: f64) -> f64 {
    let near = |t: f64| shape.is_near(path.point(t), widths.border);
    let mut step = widths.sliver.max(widths.border);
    let mut last = start;
    let mut next = advanced(path, start, end, step);
    if next == end {
        // The middle decides for a stretch shorter than a step.
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

/// The parameter `distance` pixels from `t` towards `end`, or the end of the piece if that comes first.
fn advanced(path: &Path, t: f64, end: f64, distance: f64) -> f64 {
    let forward = end > t;
    // At a joint, the next piece in the direction of travel.
    let ahead = if forward { t.floor() } else { t.ceil() - 1.0 };
    let i = (ahead.max(0.0) as usize).min(path.pieces().len() - 1);
    let (piece, start) = (&path.pieces()[i], i as f64);
    let length = piece.length_to(t - start);
    // A step covers at most a quarter of a piece, so that it does not skip a bend.
    let (quarter, total) = (0.25, piece.length());
    let wanted = if forward { length + distance } else { length - distance };
    let edge = if forward { start + 1.0 } else { start };
    let reached = if wanted <= 0.0 || wanted >= total { edge } else { start + piece.parameter_at(wanted) };
    let limited = if forward { reached.min(t + quarter).min(end) } else { reached.max(t - quarter).max(end) };
    // Rounding must not stop the progress.
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

/// The parameter between `a` and `b` where the state changes.
fn change(state: impl Fn(f64) -> bool, mut a: f64, mut b: f64) -> f64 {
    let before = state(a);
    for _ in 0..50 {
        let middle = 0.5 * (a + b);
        if state(middle) == before { a = middle } else { b = middle }
    }
    b
}
