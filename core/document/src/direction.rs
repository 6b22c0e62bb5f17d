//! Keys of a part that were drawn in the other direction than the key before.
//!
//! The control points of a part have the same numbers on all keys. If one key is drawn from the other end, or the other
//! way round, each point goes to the wrong place, and the contour collapses between the keys. A program cannot know what
//! the artist meant. But if the points fit those of the key before much better in the reversed order than in their own,
//! it is worth a word.
//!
//! The fit is that of the best similarity (shift, turn and scale). For closed parts all first points are tried, in both
//! orders, so a different first point alone is no reason for a warning.

use rototoon_base::geometry::Point;
use rototoon_base::geometry::similarity::Similarity;
use rototoon_base::scene::{FrameNumber, Part};

/// The reversed order fits if what remains is at most this share of what remains in the drawn order.
const BETTER: f64 = 0.3;
/// In the drawn order at least this must remain, as a share of the contour's extent: below it, both orders fit.
const WRONG: f64 = 0.2;
/// For closed contours with more points than this only some first points are tried.
const TRIED: usize = 64;

/// Neighbouring keys of which the later one was probably drawn in the other direction.
pub(super) fn reversed(part: &Part) -> Vec<[FrameNumber; 2]> {
    let keys: Vec<_> = part.keys.iter().collect();
    let pairs = keys.windows(2).filter(|pair| pair[0].1.len() == pair[1].1.len() && pair[0].1.len() > 2);
    pairs.filter(|pair| is_reversed(pair[0].1, pair[1].1, part.closed)).map(|pair| [*pair[0].0, *pair[1].0]).collect()
}

fn is_reversed(before: &[Point], after: &[Point], closed: bool) -> bool {
    let back: Vec<Point> = after.iter().rev().copied().collect();
    let (drawn, other) = (remaining(before, after, closed), remaining(before, &back, closed));
    drawn > WRONG && other < BETTER * drawn
}

/// Root mean square of what the best similarity leaves, as a share of the extent of `before`. Of closed contours the
/// least for any first point.
fn remaining(before: &[Point], after: &[Point], closed: bool) -> f64 {
    let step = if closed { after.len().div_ceil(TRIED) } else { after.len() };
    let starts = (0..after.len()).step_by(step);
    let left = |start: usize| {
        let turned = [&after[start..], &after[..start]].concat();
        let map = Similarity::fit(before, &turned);
        let sum: f64 = before.iter().zip(&turned).map(|(p, q)| map.apply(*p).distance_squared(*q)).sum();
        let extent: f64 = turned.iter().map(|q| q.distance_squared(map.target)).sum();
        (sum / extent.max(1e-12)).sqrt()
    };
    starts.map(left).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn part(keys: &[(FrameNumber, &[(f64, f64)])], closed: bool) -> Part {
        let points = |list: &[(f64, f64)]| list.iter().map(|&(x, y)| Point::new(x, y)).collect();
        Part { closed, keys: keys.iter().map(|&(f, list)| (f, points(list))).collect(), ..Part::default() }
    }

    const HOOK: [(f64, f64); 5] = [(0.0, 0.0), (10.0, 0.0), (20.0, 1.0), (25.0, 6.0), (24.0, 12.0)];

    #[test]
    fn a_line_from_the_other_end_is_found() {
        let moved = HOOK.map(|(x, y)| (x + 3.0, y * 1.1 - 2.0));
        let mut back = moved;
        back.reverse();
        assert_eq!(reversed(&part(&[(1, &HOOK), (5, &moved), (9, &back)], false)), [[5, 9]]);
    }

    #[test]
    fn a_contour_the_other_way_round_is_found_and_another_first_point_is_not() {
        let boot = [(0.0, 0.0), (8.0, 0.0), (8.0, 20.0), (22.0, 22.0), (22.0, 28.0), (0.0, 28.0)];
        let (mut back, mut turned) = (boot, boot);
        back.reverse();
        turned.rotate_left(2);
        assert_eq!(reversed(&part(&[(1, &boot), (5, &back)], true)), [[1, 5]]);
        assert!(reversed(&part(&[(1, &boot), (5, &turned)], true)).is_empty());
    }

    #[test]
    fn shapes_that_fit_both_ways_are_no_reason_for_a_warning() {
        let square = [(0.0, 0.0), (9.0, 0.0), (9.0, 9.0), (0.0, 9.0)];
        let mut back = square;
        back.reverse();
        let found = reversed(&part(&[(1, &square), (5, &back)], true));
        assert_eq!(found, [[1, 5]], "no turn brings the points of a square round the other way");
        let line = [(0.0, 0.0), (5.0, 0.0), (10.0, 0.0)];
        let mut back = line;
        back.reverse();
        assert!(reversed(&part(&[(1, &line), (5, &back)], false)).is_empty(), "it may have turned by half a turn");
        assert!(reversed(&part(&[(1, &[(0.0, 0.0); 4]), (5, &[(0.0, 0.0); 4])], true)).is_empty());
    }
}
