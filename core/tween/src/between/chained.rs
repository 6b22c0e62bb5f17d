//! Lines in pieces on both drawings: the stretches that a piece of the one shares with a piece of the other.
//!
//! The pieces of each drawing are put together, and the two lines correspond like two strokes ([`super::correspond`]).
//! Each piece of the first line is cut where its counterpart changes from one piece to the next. So every stretch is a part
//! of one stroke on each key, and is followed for itself. Gaps of the second line belong half to the piece before and
//! half to the piece behind.

use super::super::chain::{Chain, Joined};
use super::super::line::Line;
use super::super::matching::{Chained, Pair};
use super::super::stroke::Stroke;
use super::correspond::Places;
use super::tracks::Stand;
use rototoon_base::geometry::Point;

/// Shortest stretch, as a share of the line.
const SHORTEST: f64 = 1e-6;

/// A place of the first line: its share, its point, and its share of the second line. The latter may leave 0 to 1 on a
/// closed line.
#[derive(Clone, Copy)]
struct At {
    here: f64,
    point: Point,
    there: f64,
}

/// The stands of each stretch on the two drawings.
pub(super) fn stretches(first: &[Stroke], second: &[Stroke], line: &Chained) -> Vec<[Stand; 2]> {
    let blank = |chain: &Chain, strokes: &[Stroke]| chain.pieces.iter().any(|piece| strokes[piece.0].points.is_empty());
    if blank(&line.first, first) || blank(&line.second, second) || line.second.pieces.is_empty() {
        return Vec::new();
    }
    let (a, b) = (line.first.joined(first), line.second.joined(second));
    let pair = Pair {
        from: 0,
        to: 0,
        reversed: line.reversed,
        start: line.start,
        confidence: line.confidence,
        by_hand: false,
    };
    let shares = Places::all(&a.line).on(&a.line, &b.line, &pair).shares;
    let cuts = b.cuts();
    let mut found = Vec::new();
    for (m, &(stroke, reversed)) in line.first.pieces.iter().enumerate() {
        let places = places_of(&a, m, &shares, b.line.closed);
        for mut run in runs(&places, &cuts, b.line.closed) {
            if (run[run.len() - 1].here - run[0].here).abs() < SHORTEST {
                continue;
            }
            if reversed {
                run.reverse();
            }
            let here: Vec<f64> = run.iter().map(|at| a.on_piece(m, reversed, at.here)).collect();
            let own = Places { points: run.iter().map(|at| at.point).collect(), shares: here, own: None };
            let n = b.piece_at(around(0.5 * (run[0].there + run[run.len() - 1].there), b.line.closed));
            let (other, against) = line.second.pieces[n];
            let there: Vec<f64> =
                run.iter().map(|at| b.on_piece(n, against, around(at.there, b.line.closed))).collect();
            let along = Line::new(&second[other]);
            let on = Places { points: there.iter().map(|&s| along.at(s)).collect(), shares: there, own: None };
            found.push([Stand { stroke, part: true, places: own }, Stand { stroke: other, part: true, places: on }]);
        }
    }
    found
}

fn around(share: f64, closed: bool) -> f64 {
    if closed { share.rem_euclid(1.0) } else { share }
}

/// The points of a piece, with places on the second line that never jump from its end to its beginning.
fn places_of(a: &Joined, piece: usize, shares: &[f64], closed: bool) -> Vec<At> {
    let (from, to) = a.ranges[piece];
    let count = a.line.points.len();
    // A ring leads back to its first point, unless it is a dot.
    let back = usize::from(a.is_one_ring() && a.shares.len() > count);
    let mut places: Vec<At> = Vec::with_capacity(to + 1 - from + back);
    for k in from..=to + back {
        let mut there = shares[k % count];
        if let Some(last) = places.last().filter(|_| closed) {
            there += (last.there - there).round();
        }
        places.push(At { here: a.shares[k], point: a.line.points[k % count], there });
    }
    places
}

/// The places cut where their counterparts pass from one piece to the next. Both runs have the place of the cut.
fn runs(places: &[At], cuts: &[f64], closed: bool) -> Vec<Vec<At>> {
    let mut runs = vec![vec![places[0]]];
    for pair in places.windows(2) {
        let (p, q) = (pair[0], pair[1]);
        for cut in between(cuts, p.there, q.there, closed) {
            let t = (cut - p.there) / (q.there - p.there);
            let at = At { here: p.here + t * (q.here - p.here), point: p.point.lerp(q.point, t), there: cut };
            if let Some(run) = runs.last_mut() {
                run.push(at);
            }
            runs.push(vec![at]);
        }
        if let Some(run) = runs.last_mut() {
            run.push(q);
        }
    }
    runs
}

/// The cuts strictly between two shares, in the order in which they are passed.
fn between(cuts: &[f64], from: f64, to: f64, closed: bool) -> Vec<f64> {
    let (low, high) = (from.min(to), from.max(to));
    let turns = if closed { low.floor() as i64 - 1..=high.ceil() as i64 } else { 0..=0 };
    let all = turns.flat_map(|turn| cuts.iter().map(move |cut| cut + turn as f64));
    let mut passed: Vec<f64> = all.filter(|&cut| cut > low && cut < high).collect();
    passed.sort_by(f64::total_cmp);
    if to < from {
        passed.reverse();
    }
    passed
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arc(from: f64, to: f64, shift: f64) -> Stroke {
        let at = |k: i32| Point::from_angle((from + (to - from) * f64::from(k) / 40.0).to_radians()) * 50.0;
        Stroke::new((0..=40).map(|k| at(k) + Point::X * shift).collect(), false)
    }

    /// A circle in pieces that are cut elsewhere on the second drawing, which is shifted by 10 px.
    #[test]
    fn every_stretch_lies_on_one_piece_of_each_drawing() {
        let first = [arc(0.0, 178.0, 0.0), arc(358.0, 180.0, 0.0)];
        let second = [arc(60.0, 199.0, 10.0), arc(318.0, 200.0, 10.0), arc(320.0, 419.0, 10.0)];
        let line = Chained {
            first: Chain { pieces: vec![(0, false), (1, true)], closed: true },
            second: Chain { pieces: vec![(0, false), (1, true), (2, false)], closed: true },
            reversed: false,
            start: 300.0 / 360.0,
            confidence: 1.0,
            meetings: Vec::new(),
        };
        let found = stretches(&first, &second, &line);
        let strokes: Vec<_> = found.iter().map(|[a, b]| (a.stroke, b.stroke)).collect();
        assert_eq!(strokes, [(0, 2), (0, 0), (1, 0), (1, 1), (1, 2)]);
        for [a, b] in &found {
            assert_eq!(a.places.points.len(), b.places.points.len());
            for (p, q) in a.places.points.iter().zip(&b.places.points) {
                assert!((*q - *p).distance(Point::X * 10.0) < 2.5, "{} {}: {p} {q}", a.stroke, b.stroke);
            }
            let shares = &a.places.shares;
            assert!(shares.windows(2).all(|s| s[0] <= s[1]), "in the direction of the stroke itself: {shares:?}");
        }
    }
}
