//! Foot points: the parameter at which the curve is nearest to a point, followed from its previous value.
//!
//! Newton's method solves (B(t) − p) · B′(t) = 0 in the parameter of the complete section. B is smooth across joints,
//! so a step that leaves a piece continues in the next one. Any parameter gives an upper bound of the distance. An
//! inexact foot makes the bound less tight, but never wrong.
//!
//! On the straight half leg of a corner the curve leaves the corner like u², and Newton's method would be slow. There
//! the foot is the square root of the share of the leg.

use super::section::Arc;
use rototoon_base::geometry::Point;

/// Largest number of Newton steps in a call.
const STEPS: usize = 3;
/// A step shorter than this is the last one.
const CLOSE: f64 = 1e-2;

/// The foot of `p` near parameter `t`: within 0 ..= pieces, for a closed section within 0 .. pieces.
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

/// Brings the parameter `t` of a closed section of `count` pieces into 0 .. count.
pub(super) fn wrapped(t: f64, count: f64) -> f64 {
    if (0.0..count).contains(&t) {
        return t;
    }
    // Usually `t` is one round off. The remainder would give the same number but takes ten times as long.
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
    // Where the curve bends strongly towards the point, Newton's slope would vanish or change its sign. The slope of
    // Gauss–Newton replaces it.
    let slope = (2.0 * squared + error.dot(arc.a)).max(squared);
    if slope <= f64::MIN_POSITIVE {
        return t;
    }
    t - (error.dot(half_speed) / slope).clamp(-1.0, 1.0)
}

fn along_half_leg(arc: &Arc, i: usize, p: Point) -> f64 {
    // The leg runs from the corner to its midpoint.
    let (corner, leg) = if arc.rest < 0 { (arc.p0, arc.a) } else { (arc.p0 + arc.b * 2.0 + arc.a, -arc.a) };
    let (corner, leg) = if arc.rest < 0 { (corner, leg) } else { (corner, -(arc.b * 2.0 + arc.a)) };
    let length = leg.length_squared();
    let share = if length > f64::MIN_POSITIVE { (p - corner).dot(leg) / length } else { 0.0 };
    // The neighbouring piece continues with a speed of two leg lengths per piece.
    let from_corner = if share <= 1.0 { share.max(0.0).sqrt() } else { 1.0 + (0.5 * (share - 1.0)).min(1.0) };
    if arc.rest < 0 { i as f64 + from_corner } else { (i + 1) as f64 - from_corner }
}
