//! Elastic correspondence of two curves: positions of a part's control points on a drawn curve.
//!
//! The part's curve is cut into short pieces whose ends include every control point. The drawn curve is cut more than
//! twice as finely, and its own points are kept. Dynamic programming (in the spirit of Sebastian, Klein & Kimia 2003)
//! finds the monotone map of least cost from samples i of the part to samples j(i) of the drawn curve.
//!
//! The cost of a pair of samples has three terms: their distance after the best similarity, the difference of their
//! tangents, and the difference of their turning, which maps corners to corners. The cost of a step is its stretch. On
//! open curves ends map to ends. On closed curves the map is closed, and several starts near that of the similarity are
//! tried.
//!
//! Limits: if a part of the curve is hidden on one of the drawings only, the map cannot leave it out; it compresses it
//! to a quarter of its length at most.

use super::outline::Alignment;
use crate::geometry::{Point, polyline};

/// Least number of pieces of the part's curve.
const PART_PIECES: f64 = 80.0;
/// Least number of pieces of the drawn curve.
const DRAWN_PIECES: f64 = 200.0;
/// A curve with more points than this is first resampled.
const MOST_POINTS: usize = 400;
/// Half width of the band of maps around the even map, as a share of the length.
const BAND: f64 = 0.15;
/// Half width of the range of starts on closed curves, as a share of the length.
const STARTS: f64 = 0.08;
/// Step, in samples, of the starts that are tried first.
const COARSE: usize = 4;
/// Least and greatest stretch of a step, relative to the curves' lengths.
const STRETCH: (f64, f64) = (0.25, 3.0);
/// Reach of the turning to each side of a sample, as a share of the length.
const TURNING_REACH: f64 = 1.0 / 30.0;

/// Weight of the squared distance in units of the curve's radius.
const DISTANCE: f64 = 1.0;
/// Weight of 1 − cos of the angle between the tangents.
const TANGENT: f64 = 0.3;
/// Weight of the squared difference of turning, in rad².
const TURNING: f64 = 0.12;
/// Weight of the squared relative stretch.
const STRETCHING: f64 = 0.06;

/// A curve cut into pieces.
pub(super) struct Cut {
    places: Vec<Point>,
    /// Arc length from the start to each sample.
    arcs: Vec<f64>,
    tangents: Vec<Point>,
    turnings: Vec<f64>,
    /// Index of the sample at each point of the curve.
    pub at_points: Vec<usize>,
    /// Length in pixels.
    pub length: f64,
    closed: bool,
}

impl Cut {
    /// Cuts the curve through `points` into pieces of at most a share of its length. A closed curve ends at its first
    /// point.
    fn new(points: &[Point], closed: bool, pieces: f64) -> Self {
        let length = polyline::length(points, closed);
        let (mut places, mut arcs, mut at_points) = (Vec::new(), Vec::new(), Vec::new());
        let mut walked = 0.0;
        for (a, b) in polyline::segments(points, closed) {
            at_points.push(places.len());
            let step = a.distance(b);
            let count = (step / length * pieces).ceil().max(1.0);
            for k in 0..count as usize {
                places.push(a.lerp(b, k as f64 / count));
                arcs.push(walked + step * k as f64 / count);
            }
            walked += step;
        }
        if !closed {
            at_points.push(places.len());
        }
        places.push(points[if closed { 0 } else { points.len() - 1 }]);
        arcs.push(length);
        let mut cut = Self { places, arcs, tangents: Vec::new(), turnings: Vec::new(), at_points, length, closed };
        cut.differentiate();
        cut
    }

    fn differentiate(&mut self) {
        let reach = TURNING_REACH * self.length;
        for i in 0..self.places.len() {
            let (before, after) = (self.at_arc(self.arcs[i] - reach), self.at_arc(self.arcs[i] + reach));
            let (incoming, outgoing) = (self.places[i] - before, after - self.places[i]);
            self.tangents.push((after - before).normalize_or_zero());
            self.turnings.push(if incoming.dot(outgoing) == 0.0 && incoming.perp_dot(outgoing) == 0.0 {
                0.0
            } else {
                incoming.angle_to(outgoing)
            });
        }
    }

    /// The point at an arc length. It wraps on closed curves and stops at the ends of open ones.
    fn at_arc(&self, arc: f64) -> Point {
        let arc = if self.closed { arc.rem_euclid(self.length) } else { arc.clamp(0.0, self.length) };
        let next = self.arcs.partition_point(|&s| s <= arc).clamp(1, self.arcs.len() - 1);
        let (s, t) = (self.arcs[next - 1], self.arcs[next]);
        let share = if t > s { (arc - s) / (t - s) } else { 0.0 };
        self.places[next - 1].lerp(self.places[next], share)
    }

    /// Number of samples; the last sample of a closed curve repeats the first and does not count.
    fn count(&self) -> usize {
        self.places.len() - usize::from(self.closed)
    }

    /// Arc length of state `j`. On a closed curve it keeps growing past the start.
    fn arc(&self, j: usize) -> f64 {
        if self.closed { (j / self.count()) as f64 * self.length + self.arcs[j % self.count()] } else { self.arcs[j] }
    }
}

/// The positions of a part's control points on a drawn curve.
pub(super) struct Placement {
    /// Mean cost of a sample.
    pub cost: f64,
    /// Position of each control point, in pixels.
    pub places: Vec<Point>,
    /// Arc length of each control point on the drawn curve, measured from its first point in drawing order.
    pub arcs: Vec<f64>,
}

/// The best map of the part's curve onto the drawn one near an alignment. Both curves need a positive length, and both
/// are closed or both open. `scale` is the size of the drawn curve relative to the part's, `radius` that of the drawn
/// curve in pixels. `None` if no map stays within the allowed stretch.
pub(super) fn place(
    part: &[Point],
    drawn: &[Point],
    closed: bool,
    alignment: &Alignment,
    (scale, radius): (f64, f64),
) -> Option<Placement> {
    let mut walked =
        if drawn.len() > MOST_POINTS { polyline::resample(drawn, closed, MOST_POINTS) } else { drawn.to_vec() };
    if alignment.reversed {
        walked.reverse();
        // The first point of a closed curve stays first.
        walked.rotate_right(usize::from(closed));
    }
    let (p, q) = (Cut::new(part, closed, PART_PIECES), Cut::new(&walked, closed, DRAWN_PIECES));
    let turn = Point::from_angle(alignment.turn);
    let (from, to) = (mean(&p), mean(&q));
    let mapped: Vec<Point> = p.places.iter().map(|&x| (turn * scale).rotate(x - from) + to).collect();
    let tangents: Vec<Point> = p.tangents.iter().map(|&t| turn.rotate(t)).collect();
    let pair = |i: usize, j: usize| {
        DISTANCE * (mapped[i] - q.places[j]).length_squared() / (radius * radius)
            + TANGENT * (1.0 - tangents[i].dot(q.tangents[j]))
            + TURNING * (p.turnings[i] - q.turnings[j]).powi(2)
    };
    let columns = q.count();
    let costs: Vec<f64> = (0..p.places.len() * columns).map(|c| pair(c / columns, c % columns)).collect();
    let cost = |i: usize, j: usize| costs[i * columns + j % columns];
    let share = if alignment.reversed { 1.0 - alignment.start } else { alignment.start };
    let map = if closed { closed_map(&p, &q, share, &cost) } else { monotone_map(&p, &q, 0, &cost) }?;
    let arcs = p.at_points.iter().map(|&i| q.arc(map.1[i]).rem_euclid(q.length.next_up()));
    let arcs: Vec<f64> = arcs.map(|s| if alignment.reversed { q.length - s } else { s }).collect();
    let places = p.at_points.iter().map(|&i| q.places[map.1[i] % columns]).collect();
    Some(Placement { cost: map.0 / p.places.len() as f64, places, arcs })
}

/// Mean position, weighted by arc length.
fn mean(cut: &Cut) -> Point {
    let pieces = cut.places.windows(2).zip(cut.arcs.windows(2));
    pieces.map(|(p, s)| 0.5 * (p[0] + p[1]) * (s[1] - s[0])).sum::<Point>() / cut.length
}

/// The best map among starts near a share of the drawn curve's length. Every fourth start is tried, then those next to
/// the best.
fn closed_map(p: &Cut, q: &Cut, share: f64, cost: &impl Fn(usize, usize) -> f64) -> Option<(f64, Vec<usize>)> {
    let away = |start: usize| {
        let apart = q.arcs[start] / q.length - share;
        (apart - apart.round()).abs()
    };
    let near: Vec<usize> = (0..q.count()).filter(|&start| away(start) <= STARTS).collect();
    let best_of = |starts: &mut dyn Iterator<Item = usize>| {
        let maps = starts.filter_map(|start| Some((start, monotone_map(p, q, start, cost)?)));
        maps.reduce(|best, next| if next.1.0 < best.1.0 { next } else { best })
    };
    let (rough, _) = best_of(&mut near.iter().copied().step_by(COARSE))?;
    let count = q.count();
    let mut around = (count + 1 - COARSE..count + COARSE).map(|shift| (rough + shift) % count);
    best_of(&mut around).map(|(_, map)| map)
}

/// The best map that begins at `start` and ends one length further: its cost and, for each sample of `p`, the state of
/// `q`.
fn monotone_map(p: &Cut, q: &Cut, start: usize, cost: &impl Fn(usize, usize) -> f64) -> Option<(f64, Vec<usize>)> {
    let end = if q.closed { start + q.count() } else { q.count() - 1 };
    let states = end - start + 1;
    let arcs: Vec<f64> = (start..=end).map(|j| (q.arc(j) - q.arc(start)) / q.length).collect();
    let rows = p.places.len();
    let mut least = vec![f64::INFINITY; states];
    let mut came_from = vec![u32::MAX; rows * states];
    least[0] = cost(0, start);
    for i in 1..rows {
        let (here, step) = (p.arcs[i] / p.length, (p.arcs[i] - p.arcs[i - 1]) / p.length);
        let mut next = vec![f64::INFINITY; states];
        let first = arcs.partition_point(|&s| s < here - BAND);
        // The two grids differ, so a step may be off by one piece.
        let (shortest, longest) = (STRETCH.0 * step - 1.0 / DRAWN_PIECES, STRETCH.1 * step + 1.0 / DRAWN_PIECES);
        for j in (first..states).take_while(|&j| arcs[j] <= here + BAND) {
            let (mut best, mut from) = (f64::INFINITY, u32::MAX);
            for k in (0..=j).rev().take_while(|&k| arcs[j] - arcs[k] <= longest) {
                if arcs[j] - arcs[k] < shortest || least[k] == f64::INFINITY {
                    continue;
                }
                let stretch = if step > 0.0 { (arcs[j] - arcs[k]) / step - 1.0 } else { 0.0 };
                let total = least[k] + STRETCHING * stretch * stretch;
                if total < best {
                    (best, from) = (total, k as u32);
                }
            }
            if best < f64::INFINITY {
                next[j] = best + cost(i, start + j);
                came_from[i * states + j] = from;
            }
        }
        least = next;
    }
    let total = least[states - 1];
    if total == f64::INFINITY {
        return None;
    }
    let mut map = vec![end; rows];
    let mut j = states - 1;
    for i in (1..rows).rev() {
        j = came_from[i * states + j] as usize;
        map[i - 1] = start + j;
    }
    Some((total, map))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_go_to_corners() {
        // The same L, with other points between the corners and another start, drawn backwards.
        let part = [(0.0, 0.0), (40.0, 0.0), (40.0, 10.0), (10.0, 10.0), (10.0, 50.0), (0.0, 50.0)];
        let part = part.map(|(x, y)| Point::new(x, y));
        let drawn = [
            (10.0, 30.0),
            (10.0, 10.0),
            (25.0, 10.0),
            (40.0, 10.0),
            (40.0, 0.0),
            (20.0, 0.0),
            (0.0, 0.0),
            (0.0, 30.0),
            (0.0, 50.0),
            (10.0, 50.0),
        ];
        let drawn = drawn.map(|(x, y)| Point::new(x, y));
        let alignment = Alignment { residual: 0.0, turn: 0.0, reversed: true, start: 90.0 / 180.0 };
        let placed = place(&part, &drawn, true, &alignment, (1.0, 20.0)).unwrap();
        for (found, expected) in placed.places.iter().zip(&part) {
            assert!(found.distance(*expected) < 1e-9, "{found} instead of {expected}");
        }
        assert!((placed.arcs[3] - 20.0).abs() < 1e-9);
    }

    #[test]
    fn ends_go_to_ends() {
        let part = [Point::new(0.0, 0.0), Point::new(10.0, 0.0), Point::new(20.0, 0.0)];
        let drawn = [Point::new(60.0, 5.0), Point::new(20.0, 5.0)];
        let alignment = Alignment { residual: 0.0, turn: 0.0, reversed: true, start: 1.0 };
        let placed = place(&part, &drawn, false, &alignment, (2.0, 11.0)).unwrap();
        assert_eq!((placed.places[0], placed.places[2]), (drawn[1], drawn[0]));
        assert!(placed.places[1].distance(Point::new(40.0, 5.0)) < 0.5);
    }
}
