//! The meetings of pieces of which one or both are straight. The quartic of [`super::intersect`] cannot handle them.
//!
//! - A straight and a bent piece: the line's own equation replaces the quartic and gives a quadratic. The parameter on
//!   the line is found along it. A straight piece may fold back on itself; it then meets the other piece twice at one
//!   place.
//! - Two straight pieces: the points where the lines cross, or the stretches that they share, fold by fold.
//! - Pieces that are points: they are met where the other piece passes through them.

use super::Quadratic;
use super::meeting::{MERGE, Meeting, SAME};
use crate::geometry::Point;
use crate::numeric::roots::roots_in;

/// Direction of a straight piece's line; `None` where the piece is a point.
fn line_direction(line: &Quadratic) -> Option<Point> {
    let legs = [line.p1 - line.p0, line.p2 - line.p1, line.p2 - line.p0];
    legs.into_iter()
        .max_by(|a, b| a.length_squared().total_cmp(&b.length_squared()))
        .and_then(|leg| leg.try_normalize())
}

/// The parameters at which a straight piece passes the place `at`, measured along `direction`.
fn along_line(line: &Quadratic, direction: Point, at: f64, size: f64) -> Vec<f64> {
    let (a, b) = line.coefficients();
    let polynomial = [line.p0.dot(direction) - at, 2.0 * b.dot(direction), a.dot(direction)];
    let mut found = roots_in(&polynomial, 0.0, 1.0).to_vec();
    for end in [0.0, 1.0] {
        let missed = (line.point(end).dot(direction) - at).abs() <= SAME * size;
        if missed && !found.iter().any(|u| (u - end).abs() < MERGE) {
            found.push(end);
        }
    }
    // The turning point of a fold may touch within the same slack.
    let turn = -b.dot(direction) / a.dot(direction);
    if turn > 0.0 && turn < 1.0 && (line.point(turn).dot(direction) - at).abs() <= SAME * size {
        found.retain(|u| (u - turn).abs() >= 1e-4);
        found.push(turn);
    }
    found
}

/// The meetings of a straight piece and a bent one.
pub(super) fn line_and_parabola(line: &Quadratic, other: &Quadratic, size: f64) -> Vec<Meeting> {
    let Some(direction) = line_direction(line) else { return point_and_piece(line, other, size) };
    let (a, b) = other.coefficients();
    let quadratic = [direction.perp_dot(other.p0 - line.p0), 2.0 * direction.perp_dot(b), direction.perp_dot(a)];
    let touch = -0.5 * quadratic[1] / quadratic[2];
    let candidates = [0.0, 1.0, if touch.is_finite() { touch.clamp(0.0, 1.0) } else { 0.0 }];
    let mut found = Vec::new();
    for &v in roots_in(&quadratic, 0.0, 1.0).iter().chain(&candidates) {
        let place = other.point(v);
        if direction.perp_dot(place - line.p0).abs() > SAME * size {
            continue;
        }
        for u in along_line(line, direction, place.dot(direction), size) {
            found.push(Meeting::Point { first: u, second: v });
        }
    }
    found
}

/// The meetings of a piece that is a point with another piece.
fn point_and_piece(point: &Quadratic, other: &Quadratic, size: f64) -> Vec<Meeting> {
    let nearest = other.nearest(point.p0);
    if nearest.distance > SAME * size {
        return Vec::new();
    }
    vec![Meeting::Point { first: 0.0, second: nearest.parameter }]
}

/// The meetings of two straight pieces.
pub(super) fn lines(one: &Quadratic, two: &Quadratic, size: f64) -> Vec<Meeting> {
    let (Some(s), Some(t)) = (line_direction(one), line_direction(two)) else {
        return match line_direction(one) {
            None => point_and_piece(one, two, size),
            Some(_) => point_and_piece(two, one, size).into_iter().map(Meeting::swapped).collect(),
        };
    };
    let cross = s.perp_dot(t);
    let offset = two.p0 - one.p0;
    if cross.abs() > SAME {
        let place = one.p0 + s * (offset.perp_dot(t) / cross);
        let firsts = along_line(one, s, place.dot(s), size);
        let seconds = along_line(two, t, place.dot(t), size);
        return firsts
            .iter()
            .flat_map(|&first| seconds.iter().map(move |&second| Meeting::Point { first, second }))
            .collect();
    }
    if s.perp_dot(offset).abs() > SAME * size { Vec::new() } else { on_one_line(one, two, s, size) }
}

/// The parameter intervals in which a straight piece does not turn back.
fn monotone(line: &Quadratic, direction: Point) -> Vec<(f64, f64)> {
    let (a, b) = line.coefficients();
    let turn = -b.dot(direction) / a.dot(direction);
    if turn > MERGE && turn < 1.0 - MERGE { vec![(0.0, turn), (turn, 1.0)] } else { vec![(0.0, 1.0)] }
}

/// The stretches that two straight pieces on the same line share, fold by fold.
fn on_one_line(one: &Quadratic, two: &Quadratic, direction: Point, size: f64) -> Vec<Meeting> {
    let place = |q: &Quadratic, u: f64| q.point(u).dot(direction);
    let parameter = |q: &Quadratic, (from, to): (f64, f64), x: f64| {
        let part = q.part(from, to);
        along_line(&part, direction, x, size).first().map_or(from, |u| from + (to - from) * u)
    };
    let mut found = Vec::new();
    for mine in monotone(one, direction) {
        for theirs in monotone(two, direction) {
            let ends = |q, (from, to): (f64, f64)| {
                let (x, y) = (place(q, from), place(q, to));
                (x.min(y), x.max(y), y >= x)
            };
            let ((a0, a1, rising), (b0, b1, _)) = (ends(one, mine), ends(two, theirs));
            let (low, high) = (a0.max(b0), a1.min(b1));
            if high < low - SAME * size {
                continue;
            }
            let (from, to) = if rising { (low, high) } else { (high, low) };
            let first = (parameter(one, mine, from), parameter(one, mine, to));
            let second = (parameter(two, theirs, from), parameter(two, theirs, to));
            found.push(if high - low <= SAME * size {
                Meeting::Point { first: first.0, second: second.0 }
            } else {
                Meeting::Overlap { first, second }
            });
        }
    }
    found
}
