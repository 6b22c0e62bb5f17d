//! Strokes that claim the same ink.
//!
//! A stroke whose ink is gone finds other ink nearby, which is another stroke's. Ink that two strokes lie on, though they were apart
//! before, belongs to one of them. The other one has ended: it is the one that is clearly less probable by its own signs, its place and
//! its surroundings. A long stroke that only crosses the ink of a short one stays.
//!
//! **Limits.** Lines that are drawn on top of each other from one drawing to the next lose one stroke, which begins anew where they part.

use super::Laid;
use super::confidence::near;
use crate::stroke::Tracked;
use rototoon_base::geometry::{Point, polygon};

/// Share of a stroke on another one's ink, from which they claim the same.
const SAME: f64 = 0.75;
/// Largest share on the drawing before of strokes that were apart.
const APART: f64 = 0.3;

/// Strokes whose odds are closer to each other are both left: lines that were sketched twice may be drawn once.
const CLEARLY: f64 = std::f64::consts::E;

/// How much farther than its rival a stroke has come, in pixels at 540 lines, so that it is the wrong one. Nothing else need speak against a
/// short line that is all on its rival's ink.
const JUMP: f64 = 12.0;

/// Lets strokes end that lie on the ink of more probable ones, and did not before.
pub fn settled(laid: &mut [Option<Laid>], before: &[Tracked], reach: f64, unit: f64) {
    let (numbers, lines): (Vec<usize>, Vec<(&[Point], bool)>) = laid
        .iter()
        .enumerate()
        .filter_map(|(k, laid)| Some((k, laid.as_ref().map(|l| (&l.points[..], l.closed))?)))
        .unzip();
    let shares = near(&lines, reach);
    let jumps = jumps(laid, before);
    let mut losers: Vec<(f64, usize, usize)> = Vec::new();
    for (k, shares_of) in shares.iter().enumerate() {
        for (&m, &share) in shares_of.iter().filter(|found| *found.1 >= SAME) {
            let (a, b) = (numbers[k], numbers[m]);
            let sure = |k: usize| laid[k].as_ref().map_or(0.0, |laid| laid.signs.probability());
            let mutual = shares[m].get(&k).is_some_and(|share| *share >= SAME);
            let jumped = mutual && jumps[a] > jumps[b] + JUMP * unit;
            let loses = jumped || odds(sure(a)) * CLEARLY < odds(sure(b));
            if loses && share_before(before, a, b, reach) <= APART {
                losers.push((sure(a) - share, a, b));
            }
        }
    }
    losers.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
    for (_, loser, winner) in losers {
        if laid[winner].is_some() {
            laid[loser] = None;
        }
    }
}

/// How much farther or otherwise than the drawing each stroke has moved: than the middle one of all strokes.
fn jumps(laid: &[Option<Laid>], before: &[Tracked]) -> Vec<f64> {
    let way = |(laid, before): (&Option<Laid>, &Tracked)| {
        laid.as_ref().map(|laid| polygon::center(&laid.points) - polygon::center(&before.stroke.points))
    };
    let ways: Vec<Option<Point>> = laid.iter().zip(before).map(way).collect();
    let middle = |of: fn(Point) -> f64| {
        let mut values: Vec<f64> = ways.iter().flatten().copied().map(of).collect();
        values.sort_unstable_by(f64::total_cmp);
        values.get(values.len() / 2).copied().unwrap_or(0.0)
    };
    let usual = Point::new(middle(|way| way.x), middle(|way| way.y));
    ways.into_iter().map(|way| way.map_or(0.0, |way| way.distance(usual))).collect()
}

fn odds(probability: f64) -> f64 {
    probability / (1.0 - probability).max(1e-9)
}

/// The share of a stroke on the drawing before that was near another one.
fn share_before(before: &[Tracked], a: usize, b: usize, reach: f64) -> f64 {
    let line = |k: usize| (&before[k].stroke.points[..], before[k].stroke.closed);
    near(&[line(a), line(b)], reach)[0].get(&1).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::super::confidence::Signs;
    use super::*;
    use crate::stroke::Stroke;

    fn bar(x: f64, y: f64, length: f64) -> Vec<Point> {
        vec![Point::new(x, y), Point::new(x + length, y)]
    }

    fn tracked(points: Vec<Point>) -> Tracked {
        Tracked::sure(0, Stroke { points, ..Stroke::default() })
    }

    fn laid(points: Vec<Point>, far: f64) -> Option<Laid> {
        Some(Laid { points, closed: false, signs: Signs { far, ..Signs::default() } })
    }

    fn settle(before: [Vec<Point>; 2], after: [(Vec<Point>, f64); 2]) -> [bool; 2] {
        let mut found = after.map(|(points, far)| laid(points, far));
        settled(&mut found, &before.map(tracked), 2.0, 2.0);
        found.map(|laid| laid.is_some())
    }

    #[test]
    fn of_two_on_the_same_ink_the_one_that_came_from_farther_has_ended() {
        let before = || [bar(0.0, 0.0, 40.0), bar(0.0, 15.0, 40.0)];
        let after = |far: [f64; 2]| [(bar(3.0, 0.0, 40.0), far[0]), (bar(3.0, 0.5, 38.0), far[1])];
        assert_eq!(settle(before(), after([1.0, 20.0])), [true, false]);
        assert_eq!(settle(before(), after([20.0, 1.0])), [false, true]);
        assert_eq!(settle(before(), after([1.0, 2.0])), [true, true], "neither is clearly wrong");
        let far = [bar(0.0, 0.0, 40.0), bar(0.0, 45.0, 40.0)];
        assert_eq!(settle(far, after([1.0, 1.0])), [true, false], "it has jumped");
    }

    #[test]
    fn strokes_that_were_one_line_before_and_lines_that_cross_stay() {
        let close = [bar(0.0, 0.0, 40.0), bar(0.0, 1.0, 40.0)];
        assert_eq!(settle(close, [(bar(3.0, 0.0, 40.0), 1.0), (bar(3.0, 0.5, 40.0), 20.0)]), [true, true]);
        let apart = || [bar(0.0, 0.0, 200.0), bar(0.0, 25.0, 20.0)];
        let after = [(bar(0.0, 0.0, 200.0), 20.0), (bar(60.0, 0.5, 20.0), 1.0)];
        assert_eq!(settle(apart(), after), [true, true], "the long one is on other ink, too");
        let after = [(bar(0.0, 0.0, 200.0), 1.0), (bar(60.0, 0.5, 20.0), 20.0)];
        assert_eq!(settle(apart(), after), [true, false], "all of the short one is the long one's");
    }

    #[test]
    fn of_three_on_the_same_ink_one_is_left() {
        let before = [0.0, 25.0, 50.0].map(|y| tracked(bar(0.0, y, 40.0)));
        let mut found: Vec<Option<Laid>> = [9.0, 1.0, 20.0].map(|far| laid(bar(0.0, 25.0, 40.0), far)).into();
        settled(&mut found, &before, 2.0, 4.0);
        assert_eq!(found.iter().map(Option::is_some).collect::<Vec<_>>(), [false, true, false]);
    }
}
