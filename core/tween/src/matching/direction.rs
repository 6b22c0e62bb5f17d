//! The direction of open strokes that lie where they lay.
//!
//! A belt lies on itself whichever way it is read, and its shape does not say which end is which. The strokes beside it may mislead: a hand that lies at
//! the belt's end, and swings away by half a turn, turns the belt round with it. But a line that lies in one place on both drawings has not turned,
//! unless it went round something: the movement of what is around it then carries it onto itself, end to end. So a stroke that lies in its place keeps
//! its direction, also where its pair was made by hand, except where the movement around it explains the half turn place by place.
//!
//! Limit: a spoke through the hub of a wheel that turns by half a turn lies in its place. It turns only if the strokes beside it show the turn by their places.

use super::costs::Figure;
use super::movement::held_by;
use super::relaxation::Chosen;
use super::similarity::Movement;
use super::squash::HELD;
use rototoon_base::geometry::Point;

/// Largest root mean square distance of places from their counterparts, in radii of the stroke, of a stroke that lies in its place. The ends of a straight
/// line that is read from the other end are 3.5 radii apart, its places 2 in the mean.
const IN_PLACE: f64 = 0.5;
/// Read the other way, its places are farther apart by this factor: a ring that is nearly closed may turn a little.
const CLEARLY: f64 = 2.0;

/// Lets strokes that lie in their places run as they lie.
pub(super) fn settle(a: &Figure, b: &Figure, found: &mut [Option<Chosen>]) {
    let still = Movement { turn: 0.0, scale: 1.0, source: a.middle, target: a.middle };
    let around = held_by(a, b, found, &still, HELD * a.radius);
    for (i, choice) in found.iter_mut().enumerate() {
        let Some(choice) = choice else { continue };
        let (Some(p), Some(q)) = (&a.outlines[i], &b.outlines[choice.to]) else { continue };
        if p.closed || q.closed {
            continue;
        }
        let read = |reversed: bool| -> Vec<Point> {
            if reversed { q.places.iter().rev().copied().collect() } else { q.places.clone() }
        };
        let (own, other) = (read(choice.way.reversed), read(!choice.way.reversed));
        let near = IN_PLACE * p.radius.min(q.radius);
        let stands = apart(&p.places, &other);
        if stands > near || CLEARLY * stands > apart(&p.places, &own) {
            continue;
        }
        let carried: Vec<Point> = p.places.iter().map(|&place| around[i].apply(place)).collect();
        if apart(&carried, &own) > near
            && let Some(way) = p.all_ways(q).into_iter().flatten().find(|way| way.reversed != choice.way.reversed)
        {
            choice.way = way;
        }
    }
}

/// Root mean square distance of places from others.
fn apart(places: &[Point], others: &[Point]) -> f64 {
    let squares = places.iter().zip(others).map(|(p, q)| p.distance_squared(*q));
    (squares.sum::<f64>() / places.len().max(1) as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::super::super::stroke::Stroke;
    use super::super::{HandPair, Options, match_strokes};
    use super::*;
    use rototoon_base::scene::Silent;

    fn line(from: Point, to: Point) -> Stroke {
        Stroke::new((0..=8).map(|k| from.lerp(to, f64::from(k) / 8.0)).collect(), false)
    }

    /// A hand of seven lines at a place, turned.
    fn hand(at: Point, turn: f64) -> Vec<Stroke> {
        let put = |x: f64, y: f64| at + Point::from_angle(turn).rotate(Point::new(x, y));
        (0..7)
            .map(|k| {
                line(put(0.0, 4.0 * f64::from(k) - 12.0), put(40.0 + 3.0 * f64::from(k), 5.0 * f64::from(k) - 15.0))
            })
            .collect()
    }

    /// Whether each stroke of the first drawing runs backwards on the second one, where all pairs are made by hand.
    fn reversed(first: &[Stroke], second: &[Stroke]) -> Vec<bool> {
        let by_hand: Vec<HandPair> = (0..first.len()).map(|k| HandPair { from: k, to: Some(k) }).collect();
        let found = match_strokes(first, second, &by_hand, &Options::default(), &Silent).unwrap();
        found.pairs.iter().map(|pair| pair.reversed).collect()
    }

    #[test]
    fn a_belt_does_not_turn_with_the_hand_beside_it() {
        let belt = |off: f64| line(Point::new(0.0, off), Point::new(215.0, 2.0 - off));
        let place = Point::new(-46.0, 0.0);
        for turn in [1.6, 2.0, 2.9] {
            let first: Vec<Stroke> = [belt(0.0)].into_iter().chain(hand(place, 0.1)).collect();
            let second: Vec<Stroke> =
                [belt(3.0)].into_iter().chain(hand(Point::new(60.0, -420.0), 0.1 + turn)).collect();
            assert!(!reversed(&first, &second)[0], "{turn}");
            let mut drawn = second;
            drawn[0].points.reverse();
            assert!(reversed(&first, &drawn)[0], "{turn}: it was drawn from the other end");
        }
    }

    #[test]
    fn what_goes_round_with_all_around_it_turns() {
        let drawing =
            [line(Point::new(-50.0, 0.0), Point::new(50.0, 0.0))].into_iter().chain(hand(Point::new(60.0, 20.0), 0.3));
        let first: Vec<Stroke> = drawing.chain(hand(Point::new(-70.0, -40.0), 2.0)).collect();
        let round = |stroke: &Stroke| Stroke::new(stroke.points.iter().map(|p| -*p).collect(), false);
        let second: Vec<Stroke> = first.iter().map(round).collect();
        assert_eq!(reversed(&first, &second), vec![false; first.len()]);
    }
}
