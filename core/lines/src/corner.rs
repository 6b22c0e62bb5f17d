//! Corners that do not look like two branches that meet alone.
//!
//! - The *tip*: two lines that meet at a sharp angle run together before they end. Lines of width w at an angle of θ share
//!   their ink over w / (2 tan θ/2). A free tail at their junction that is not much longer, and goes on between both, is the tip of the corner.
//! - The *touch*: a corner may touch a line that passes. Then two branches are left at the junction, both on the same side.
//!
//! A corner over a gap (both ends free, lines that would meet ahead of both) was tried: on real drawings it joined fingers
//! with the creases beside them.

use crate::direction::{End, angle, outward, place, radius};
use crate::graph::Graph;
use rototoon_base::geometry::{Point, polyline};
use std::f64::consts::{PI, TAU};

/// Turn from which a corner may have a tip, in radians.
const SHARP: f64 = 1.2;
/// Length of the longest tip, in units of what both lines share, and in widths.
const SHARED: f64 = 1.3;
const MOST: f64 = 8.0;
/// How far beside the directions of both sides a tip may point, in radians.
const BESIDE: f64 = 0.5;
/// Largest turn of a corner that touches a line, in radians. Beyond, both lines run beside each other.
const SHARPEST: f64 = 2.6;

/// The corner that has a tail for its tip, if three ends are one: both sides, and the tail, which goes on where the sides point. Tails shorter than
/// `stub` pixels are overshoots in any case. Of several tails the shortest one is the tip.
pub fn tip(graph: &Graph, ends: &[End], stub: f64) -> Option<(End, End, End)> {
    let [a, b, c] = *ends else { return None };
    let length = |tail: End| polyline::length(&graph.branches[tail.0].points, false);
    let is_tip = |&(a, b, tail): &(End, End, End)| {
        let branch = &graph.branches[tail.0];
        if branch.ends[1 - tail.1].is_some() || branch.closed || a.0 == b.0 {
            return false;
        }
        let (from, to) = (outward(graph, a), outward(graph, b));
        let turn = angle(from, -to);
        let width = 2.0 * radius(graph, a).max(radius(graph, b));
        let shared = width / (2.0 * ((PI - turn) / 2.0).tan()).max(1e-6);
        // A third line may begin where two others meet, as the barbs of an arrow do.
        let is_ahead = || angle((from + to).normalize_or_zero(), -outward(graph, tail)) < 0.5 * (PI - turn) + BESIDE;
        let most = (stub + SHARED * shared).min(MOST * width);
        turn > SHARP && (length(tail) <= stub.min(most) || (length(tail) <= most && is_ahead()))
    };
    let all = [(a, b, c), (b, c, a), (c, a, b)].into_iter().filter(is_tip);
    all.min_by(|x, y| length(x.2).total_cmp(&length(y.2)))
}

/// The two ends that the `chosen` pairs leave, if they are a corner on the same side of all of them.
pub fn touch(graph: &Graph, ends: &[End], chosen: &[(End, End)]) -> Option<(End, End)> {
    let taken = |end: &End| chosen.iter().any(|&(a, b)| a == *end || b == *end);
    let left: Vec<End> = ends.iter().filter(|end| !taken(end)).copied().collect();
    let ([a, b], false) = (&left[..], chosen.is_empty()) else { return None };
    let way = |end: End| (-outward(graph, end)).to_angle();
    let (from, to) = (way(*a), way(*b));
    let between = |end: End| (way(end) - from).rem_euclid(TAU) < (to - from).rem_euclid(TAU);
    let beside = chosen.iter().all(|&(c, d)| between(c) == between(d));
    let turn = angle(outward(graph, *a), -outward(graph, *b));
    (beside && turn < SHARPEST).then_some((*a, *b))
}

/// The point in which a line would have the corner: the tip of the tail.
pub fn top(graph: &Graph, (branch, side): End) -> Point {
    place(graph, (branch, 1 - side))
}
