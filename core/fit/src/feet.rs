//! Foot points: the parameter at which a point is nearest to the curve, followed from where it was.
//!
//! Newton's method on (B(t) − p) · B′(t) = 0 in the parameter of the whole section, which is smooth across joints: a
//! step that leaves a piece goes on in the next. Any parameter gives an upper bound of the distance, so an imperfect
//! foot costs tightness, never truth.
//!
//! On a corner's straight half leg the curve rests at the corner like u², and Newton's method would crawl: there the
//! foot is the square root of the share of the leg.

use super::section::Arc;
use rototoon_base::geometry::Point;

/// Steps of Newton's method a call.
const STEPS: usize = 3;
/// A step below this is the last.
const CLOSE: f64 = 1e-2;

/// Foot of `p` near parameter `t`; within 0 ..= pieces, of a closed section within 0 .. pieces.
pub(super) fn follow(arcs: &[Arc], periodic: bool, p: Point, mut t: f64) -> f64 {
    let count = arcs.len() as f64;
    for _ in 0..STEPS {
        let i = (t as usize).min(arcs.len() - 1);
        let arc = &arcs[i];
        let next = if arc.rest == 0 { newton(arc, i, p, t) } else { along_half_leg(arc, i, p) };
        let moved = (next - t).abs();
        t = if periodic { wrapped(next, count) } else { next.clamp(0.0, count) };
        if moved < CLOSE {
            break;
        }
    }
    t
}

/// The parameter `t` of a closed section of `count` pieces, brought into 0 .. count.
pub(super) fn wrapped(t: f64, count: f64) -> f64 {
    if (0.0..count).contains(&t) {
        return t;
    }
    // One round too far is what happens; the remainder takes ten times as long and is the same number then.
    let t = if t < 0.0 && t >= -count {
        t + count
    } else if t >= count && t < 2.0 * count {
        t - count
    } else {
        t.rem_euclid(count)
    };
    if t < count { t } else { 0.0 }
}

fn newton(arc: &Arc, i: usize, p: Point, t: f64) -> f64 {
    let u = t - i as f64;
    let half_speed = arc.b + arc.a * u;
    let error = arc.p0 + (arc.b * 2.0 + arc.a * u) * u - p;
    let squared = half_speed.length_squared();
    // Gauss–Newton's slope where the curve bends towards the point so much that Newton's would vanish or turn.
    let slope = (2.0 * squared + error.dot(arc.a)).max(squared);
    if slope <= f64::MIN_POSITIVE {
        return t;
    }
    t - (error.dot(half_speed) / slope).clamp(-1.0, 1.0)
}

fn along_half_leg(arc: &Arc, i: usize, p: Point) -> f64 {
    // From the corner to the midpoint of its leg.
    let (corner, leg) = if arc.rest < 0 { (arc.p0, arc.a) } else { (arc.p0 + arc.b * 2.0 + arc.a, -arc.a) };
    let (corner, leg) = if arc.rest < 0 { (corner, leg) } else { (corner, -(arc.b * 2.0 + arc.a)) };
    let length = leg.length_squared();
    let share = if length > f64::MIN_POSITIVE { (p - corner).dot(leg) / length } else { 0.0 };
    // The neighbour goes on with the speed of two leg lengths a piece.
    let from_corner = if share <= 1.0 { share.max(0.0).sqrt() } else { 1.0 + (0.5 * (share - 1.0)).min(1.0) };
    if arc.rest < 0 { i as f64 + from_corner } else { (i + 1) as f64 - from_corner }
}
