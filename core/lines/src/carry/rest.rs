//! Ink that no carried stroke explains.
//!
//! The lines that tracing finds are cut where carried strokes cover them. What is left and goes on from the end of a carried
//! stroke lengthens that stroke: its end was not quite found. All else is new.

use super::samples::Cells;
use crate::strokes::Walked;
use rototoon_base::geometry::{Point, polyline};

/// Cosine of the turn up to which a rest goes on from a stroke's end.
const STRAIGHT: f64 = 0.5;
/// Longest rest that lengthens a stroke, as a share of the stroke's length.
const SHARE: f64 = 0.35;

/// What is left of lines outside of `reach` of the `covered` points, in runs of at least `least` pixels.
pub fn left(lines: &[Walked], covered: &[Point], reach: f64, least: f64) -> Vec<Walked> {
    let cells = Cells::new(covered.iter().copied(), reach);
    let mut rest = Vec::new();
    for line in lines {
        let free: Vec<bool> =
            line.points.iter().map(|&p| !cells.near(p, reach).any(|k| covered[k].distance(p) <= reach)).collect();
        if line.closed && free.iter().all(|&f| f) {
            rest.push(line.clone());
            continue;
        }
        if line.fill {
            // A shape is there as a whole or not at all.
            if 2 * free.iter().filter(|&&f| f).count() > free.len() {
                rest.push(line.clone());
            }
            continue;
        }
        // A ring is opened at a covered place, so that no run goes over its first point.
        let n = free.len();
        let first = if line.closed { free.iter().position(|&f| !f).unwrap_or(0) } else { 0 };
        let order: Vec<usize> = (0..n).map(|k| (first + k) % n).collect();
        for run in order.chunk_by(|&a, &b| free[a] == free[b]).filter(|run| free[run[0]]) {
            let (points, radii): (Vec<Point>, Vec<f64>) = run.iter().map(|&i| (line.points[i], line.radii[i])).unzip();
            if points.len() > 1 && polyline::length(&points, false) >= least {
                rest.push(Walked { points, radii, closed: false, free: [true; 2], fill: false });
            }
        }
    }
    rest
}

/// Lengthens open strokes by rests that go on from their ends; returns the rests that do not.
pub fn lengthened(strokes: &mut [(Vec<Point>, bool)], rests: Vec<Walked>, reach: f64) -> Vec<Walked> {
    let mut kept = Vec::new();
    'rests: for rest in rests {
        let own = polyline::length(&rest.points, false);
        let mut best: Option<(f64, usize, bool, bool)> = None;
        for (k, (points, closed)) in strokes.iter().enumerate() {
            if rest.closed || *closed || points.len() < 3 || own > SHARE * polyline::length(points, false) {
                continue;
            }
            for (last, turned) in [(false, false), (false, true), (true, false), (true, true)] {
                let end = if last { points[points.len() - 1] } else { points[0] };
                let start = if turned { rest.points[rest.points.len() - 1] } else { rest.points[0] };
                let gap = end.distance(start);
                let onward = outward(points, last, reach).dot(-outward(&rest.points, turned, reach));
                if gap <= 2.0 * reach && onward > STRAIGHT && best.is_none_or(|b| gap < b.0) {
                    best = Some((gap, k, last, turned));
                }
            }
        }
        let Some((_, k, last, turned)) = best else {
            kept.push(rest);
            continue 'rests;
        };
        let mut more = rest.points;
        if turned {
            more.reverse();
        }
        if last {
            strokes[k].0.extend(more);
        } else {
            more.reverse();
            more.append(&mut strokes[k].0);
            strokes[k].0 = more;
        }
    }
    kept
}

/// The direction in which a line leaves its end.
fn outward(points: &[Point], last: bool, reach: f64) -> Point {
    let at = |k: usize| if last { points[points.len() - 1 - k] } else { points[k] };
    let far = (1..points.len()).find(|&k| at(0).distance(at(k)) >= 2.0 * reach).unwrap_or(points.len() - 1);
    (at(0) - at(far)).normalize_or_zero()
}
