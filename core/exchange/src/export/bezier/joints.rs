//! Where a contour runs smoothly through a point, and in which direction.
//!
//! The direction of a side is that from the point to where the path is a few pixels on: a single step of a snapped path says little. A point
//! is *smooth* if on most frames the two sides turn by less than 25°; otherwise it is a corner. That is decided once for all frames,
//! so that a point does not change its kind.
//!
//! At a smooth point both handles lie on one line, on every frame. Of several lines that is taken with which a cubic on each side comes closest
//! to the path; the first one that is close enough ends the search. On a frame on which no line does, or on which the sides turn by 45°
//! or more, one handle is 0: the two still lie on one line, and the drawn corner stays.

use super::cubic::{End, fit, is_straight};
use rototoon_base::geometry::Point;

/// How far along a path its direction is taken, in pixels.
const REACH: f64 = 4.0;
/// Other reaches that are tried, in pixels.
const REACHES: [f64; 2] = [2.0, 8.0];
/// The least turn of a corner, in degrees.
const CORNER: f64 = 25.0;
/// The least turn at which a smooth point is drawn as a corner, in degrees. Handles on one line would be tiny there.
const SHARP: f64 = 45.0;
/// How much of a path counts for the line of the handles, in pixels.
const NEAR: f64 = 16.0;

/// A point of a contour on one frame, between the path before it and the path after it.
pub(super) struct Joint<'a> {
    before: &'a [Point],
    after: &'a [Point],
}

impl<'a> Joint<'a> {
    /// The point between two paths. Both have at least one point.
    pub fn new(before: &'a [Point], after: &'a [Point]) -> Self {
        Self { before, after }
    }

    /// The directions of both sides, away from the point; `None` where a side has no length.
    fn ways(&self, reach: f64) -> Option<[Point; 2]> {
        let way = |side: Vec<Point>| (side[side.len() - 1] - side[0]).try_normalize();
        let [back, on] = self.sides(reach).map(way);
        Some([back?, on?])
    }

    /// The paths away from the point, so far.
    fn sides(&self, reach: f64) -> [Vec<Point>; 2] {
        [start(self.before.iter().rev(), reach), start(self.after.iter(), reach)]
    }

    /// The turn in degrees; `None` where a side has no length.
    fn turn(&self) -> Option<f64> {
        self.ways(REACH).map(|[back, on]| (-back).angle_to(on).abs().to_degrees())
    }

    /// What is known of the handles before and after the point. A cubic is close enough at half of `tolerance`.
    pub fn ends(&self, smooth: bool, tolerance: f64) -> [End; 2] {
        let Some(ways) = self.ways(REACH).filter(|_| smooth) else { return [End::Free; 2] };
        let sides = self.sides(NEAR);
        let error = |ends: [End; 2]| {
            let one = |side: usize| fit(&sides[side], [ends[side], End::Free], tolerance).error;
            one(0).max(one(1))
        };
        let mut best = ([End::Bare; 2], f64::INFINITY);
        let lines = self.lines(ways).into_iter().chain(std::iter::once_with(|| free_lines(ways, &sides)).flatten());
        let sharp = self.turn().is_some_and(|turn| turn >= SHARP);
        for line in lines.flatten().filter(|_| !sharp) {
            let ends = [End::Along(-line), End::Along(line)];
            let error = error(ends);
            if error <= 0.5 * tolerance {
                return ends;
            }
            if error < best.1 {
                best = (ends, error);
            }
        }
        if best.1 > tolerance {
            for ends in [[End::Free, End::Bare], [End::Bare, End::Free]] {
                let error = error(ends);
                if error < best.1 {
                    best = (ends, error);
                }
            }
        }
        best.0
    }

    /// Lines on which both handles may lie, as unit vectors toward the path after the point, by the directions of the sides.
    fn lines(&self, ways: [Point; 2]) -> [Option<Point>; 1 + REACHES.len()] {
        // A straight side has no handle that could turn, so it gives the direction.
        let first = match (is_straight(self.before), is_straight(self.after)) {
            (true, false) => Some(-ways[0]),
            (false, true) => Some(ways[1]),
            _ => between(ways),
        };
        let [near, far] = REACHES.map(|reach| self.ways(reach).and_then(between));
        [first, near, far]
    }
}

/// Lines by the handles that each side would have on its own, and those of one side alone.
fn free_lines(ways: [Point; 2], sides: &[Vec<Point>; 2]) -> [Option<Point>; 5] {
    let [back, on] = std::array::from_fn(|side| fit(&sides[side], [End::Free; 2], 0.0).handles[0].try_normalize());
    let middle = back.zip(on).and_then(|(back, on)| between([back, on]));
    [middle, back.map(|back| -back), on, Some(-ways[0]), Some(ways[1])]
}

fn between([back, on]: [Point; 2]) -> Option<Point> {
    (on - back).try_normalize()
}

/// Whether a point is smooth on most of the frames on which its sides have a direction.
pub(super) fn is_smooth<'a>(joints: impl Iterator<Item = Joint<'a>>) -> bool {
    let turns: Vec<f64> = joints.filter_map(|joint| joint.turn()).collect();
    2 * turns.iter().filter(|turn| **turn < CORNER).count() > turns.len()
}

/// The beginning of a path, so long in pixels.
fn start<'a>(path: impl Iterator<Item = &'a Point>, mut left: f64) -> Vec<Point> {
    let mut found: Vec<Point> = Vec::new();
    for &p in path {
        let Some(&last) = found.last() else {
            found.push(p);
            continue;
        };
        let length = last.distance(p);
        if length >= left {
            found.push(last.lerp(p, left / length));
            break;
        }
        found.push(p);
        left -= length;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(points: &[(f64, f64)]) -> Vec<Point> {
        points.iter().copied().map(Point::from).collect()
    }

    #[test]
    fn a_step_at_the_point_makes_no_corner_and_a_turn_makes_one() {
        let before = line(&[(0.0, 0.0), (9.5, 0.0), (10.0, 0.5)]);
        let after = line(&[(10.0, 0.5), (10.5, 0.5), (20.0, 0.9)]);
        let down = line(&[(10.0, 0.5), (10.0, 9.0)]);
        let joint = |after| Joint::new(&before, after);
        assert!(is_smooth([joint(&after)].into_iter()) && !is_smooth([joint(&down)].into_iter()));
        assert!(is_smooth([joint(&after), joint(&down), joint(&after)].into_iter()));
        assert!(!is_smooth([joint(&after), joint(&down)].into_iter()));
        let nothing = line(&[(10.0, 0.5)]);
        assert!(!is_smooth([joint(&nothing)].into_iter()));
    }

    #[test]
    fn a_smooth_point_that_is_a_corner_on_one_frame_has_one_handle_there() {
        let before = line(&[(0.0, 0.0), (10.0, 0.0)]);
        let bent =
            |up: f64| (0..=20).map(f64::from).map(|t| Point::new(10.0 + 0.6 * t, up * t * t)).collect::<Vec<_>>();
        let after = bent(0.02);
        assert_eq!(Joint::new(&before, &after).ends(true, 0.25), [End::Along(-Point::X), End::Along(Point::X)]);
        assert_eq!(Joint::new(&before, &after).ends(false, 0.25), [End::Free; 2]);
        let down: Vec<Point> = bent(0.02).iter().map(|p| Point::new(10.0 - p.y, p.x - 10.0)).collect();
        let curved: Vec<Point> = bent(0.02).iter().rev().map(|p| Point::new(20.0 - p.x, p.y)).collect();
        let ends = Joint::new(&curved, &down).ends(true, 0.25);
        assert!(ends.contains(&End::Bare) && ends.contains(&End::Free), "{ends:?}");
    }
}
