//! Whether a way to lay a stroke on its counterpart tears it from what it touches.
//!
//! A line and its counterpart may fit each other from either end: an arm that is bent a little up, and then as much down, is the same line read from the
//! hand. What it touches tells the ends apart: the hand stays at the one, the body at the other.

use super::costs::Figure;
use super::outline::{Outline, Way};
use super::relaxation::Chosen;
use rototoon_base::geometry::Point;

/// Largest gap of strokes that touch, in units of the geometric mean of their radii.
const TOUCHING: f64 = 0.15;
/// Distance of a place under the two strokes' movements that counts as torn apart, in units of the mean of their radii.
const TORN: f64 = 1.0;
/// A way tears if it parts this much more than the other one: half of one touch.
const MORE: f64 = 0.5;
/// Farther apart than this, in units of the sum of the radii, no two strokes touch.
const FAR: f64 = 4.0;

/// Whether `way` tears a stroke from other strokes that its `own` one leaves together. Only strokes whose own way is `settled` are asked.
pub(super) fn tears(
    (a, b): (&Figure, &Figure),
    found: &[Option<Chosen>],
    (i, to): (usize, usize),
    (own, way): (&Way, &Way),
    settled: impl Fn(usize) -> bool,
) -> bool {
    let (Some(p), Some(q)) = (&a.outlines[i], &b.outlines[to]) else { return false };
    let (stays, goes) = (p.movement(q, own), p.movement(q, way));
    let mut more = 0.0;
    for (k, choice) in found.iter().enumerate().filter(|(k, _)| *k != i && settled(*k)) {
        let Some(choice) = choice else { continue };
        let Some((r, s)) = a.comparable(k, b, choice.to) else { continue };
        let Some(place) = touch(p, r) else { continue };
        let there = r.movement(s, &choice.way).apply(place);
        let torn = |at: Point| (at.distance(there) / (TORN * 0.5 * (p.radius + r.radius))).powi(2).min(1.0);
        more += torn(goes.apply(place)) - torn(stays.apply(place));
    }
    more > MORE
}

/// The place where two strokes touch, if they do.
fn touch(p: &Outline, r: &Outline) -> Option<Point> {
    if p.centre.distance(r.centre) > FAR * (p.radius + r.radius) {
        return None;
    }
    let pairs = p.places.iter().flat_map(|&x| r.places.iter().map(move |&y| (x.distance_squared(y), x.midpoint(y))));
    let (square, place) = pairs.min_by(|x, y| x.0.total_cmp(&y.0))?;
    (square <= TOUCHING * TOUCHING * p.radius * r.radius).then_some(place)
}

#[cfg(test)]
mod tests {
    use super::super::super::stroke::Stroke;
    use super::super::{Options, match_strokes};
    use super::*;
    use rototoon_base::geometry::polyline;
    use rototoon_base::scene::Silent;
    use std::f64::consts::TAU;

    fn line(corners: &[Point], count: usize) -> Stroke {
        Stroke::new(polyline::resample(corners, false, count), false)
    }

    fn ring(centre: Point, radius: f64) -> Stroke {
        let at = |k: i32| centre + Point::from_angle(TAU * f64::from(k) / 24.0) * radius;
        Stroke::new((0..24).map(at).collect(), true)
    }

    /// A body with a head and two arms of two lines and a hand each, at an angle below the level and bent by another one.
    fn figure(at: Point, angle: f64, bend: f64) -> Vec<Stroke> {
        let put = |x: f64, y: f64| at + Point::new(x, y);
        let mut strokes = vec![
            line(&[put(-35.0, 0.0), put(-40.0, -200.0)], 13),
            line(&[put(35.0, 0.0), put(40.0, -200.0)], 13),
            line(&[put(-35.0, 0.0), put(35.0, 0.0)], 13),
            line(&[put(-40.0, -200.0), put(40.0, -200.0)], 13),
            ring(put(0.0, -250.0), 48.0),
        ];
        for side in [1.0, -1.0] {
            let way = |angle: f64| Point::new(side * angle.cos(), angle.sin());
            let shoulder = put(40.0 * side, -185.0);
            let elbow = shoulder + way(angle) * 100.0;
            let hand = elbow + way(angle + bend) * 100.0;
            for off in [-14.0, 14.0] {
                let (upper, lower) = (way(angle).perp() * off, way(angle + bend).perp() * off);
                strokes.push(line(&[shoulder + upper, elbow + upper, elbow + lower, hand + lower], 25));
            }
            strokes.push(ring(hand, 18.0));
        }
        strokes
    }

    #[test]
    fn arms_that_bend_the_other_way_keep_their_hands_wherever_they_are_drawn_from() {
        let first = figure(Point::new(500.0, 500.0), 0.5, 0.3);
        let mut second = figure(Point::new(520.0, 300.0), -0.5, -0.3);
        for arm in [5, 6, 8, 9] {
            second[arm].points.reverse();
        }
        let found = match_strokes(&first, &second, &[], &Options::default(), &Silent).unwrap();
        for arm in [5, 6, 8, 9] {
            let pair = found.pairs.iter().find(|pair| pair.from == arm).unwrap();
            assert!(pair.to / 3 == arm / 3 && pair.reversed, "{pair:?}");
        }
    }
}
