//! Joints of groups: whether a group turns about a point that the drawing shows.
//!
//! A drawing seldom shows the fixed point of a movement: a body that turns on its way from A to B goes round some point in the air, and a full arc
//! about it may be wrong. But an arm that is drawn alone turns about its shoulder, and somebody who leans over turns about the feet. There the
//! fixed point lies on the drawing, at the end of something long. It is a joint, and it stays where it is.
//!
//! A forearm hangs on its upper arm. So what hangs on a group counts as its own, and its movement is that against what it hangs on itself.
//!
//! Round things are left out: a wheel that rolls turns about a point of its rim, too, and does not swing about it.

use super::super::peg::propose::{Group, Moving};
use crate::affine::elongation;
use rototoon_base::geometry::similarity::Similarity;
use rototoon_base::geometry::{Point, polygon};

/// Largest distance of a joint from the strokes, in root mean square distances of the strokes from their middle.
const NEAR: f64 = 0.35;
/// Least distance of a joint from the middle of the strokes, in the same units.
const END: f64 = 0.7;
/// Least turn in radians that shows a joint.
const TURN: f64 = 0.1;
/// Least logarithm of the ratio of length and width.
const LONG: f64 = 0.35;

/// Whether the movement `step` of group `g` from key `k` to the next one, against what it hangs on, goes about a joint: a place of its own
/// strokes or of those that hang on it.
pub(super) fn is_about(step: &Similarity, g: usize, k: usize, groups: &[Group], strokes: &[Moving]) -> bool {
    if step.angle().abs() < TURN {
        return false;
    }
    let Some(fixed) = step.fixed_point() else { return false };
    let own = (0..groups.len()).filter(|&other| hangs_on(groups, other, g)).flat_map(|other| &groups[other].members);
    let places = own.filter_map(|&i| strokes[i].places.get(k)?.as_ref()).flatten().copied().collect::<Vec<Point>>();
    let middle = polygon::center(&places);
    let square = places.iter().map(|p| p.distance_squared(middle)).sum::<f64>() / places.len().max(1) as f64;
    let size = square.sqrt();
    let near = places.iter().any(|p| p.distance(fixed) <= NEAR * size);
    near && fixed.distance(middle) >= END * size && elongation(&places) >= LONG
}

/// Whether a group is another one, or hangs on it.
fn hangs_on(groups: &[Group], mut g: usize, other: usize) -> bool {
    for _ in 0..groups.len() {
        match groups[g].parent {
            Some(parent) if g != other => g = parent,
            _ => break,
        }
    }
    g == other
}

#[cfg(test)]
mod tests {
    use super::super::{GivenPegs, Key, Options, Sequence, Spacing};
    use super::*;
    use crate::Stroke;
    use crate::matching::{Matching, Pair};
    use crate::peg::Timing;

    /// The drawing half way where all strokes turn about a point, and where they should be.
    fn half_way(strokes: &[Vec<Point>], turn: f64, about: Point, arcs: f64) -> [Vec<Point>; 2] {
        let turned = |turn: f64| -> Vec<Stroke> {
            let at = |p: &Point| about + Point::from_angle(turn).rotate(*p - about);
            strokes.iter().map(|points| Stroke::new(points.iter().map(at).collect(), false)).collect()
        };
        let spacing = Spacing::Timing(Timing::Linear);
        let key = |(frame, strokes)| Key { frame, strokes, spacing: spacing.clone(), corner: false };
        let keys = [(0, turned(0.0)), (8, turned(turn))].map(key);
        let pair = |k| Pair { from: k, to: k, reversed: false, start: 0.0, confidence: 1.0, by_hand: true };
        let matching = Matching { pairs: (0..strokes.len()).map(pair).collect(), ..Matching::default() };
        let options = Options { arcs, ..Options::default() };
        let sequence = Sequence::new(keys.into(), &[matching], &GivenPegs::default(), &options).unwrap();
        let points = |strokes: Vec<Stroke>| strokes.into_iter().flat_map(|stroke| stroke.points).collect();
        [points(sequence.at(4).into_iter().map(|drawn| drawn.stroke).collect()), points(turned(turn / 2.0))]
    }

    fn off([drawn, wanted]: &[Vec<Point>; 2]) -> f64 {
        drawn.iter().zip(wanted).map(|(p, q)| p.distance(*q)).fold(0.0, f64::max)
    }

    fn bar(from: (f64, f64), to: (f64, f64)) -> Vec<Point> {
        (0..=9).map(|k| Point::from(from).lerp(Point::from(to), f64::from(k) / 9.0)).collect()
    }

    #[test]
    fn an_arm_alone_keeps_its_shoulder_at_any_strength_of_arcs() {
        let arm =
            [bar((10.0, -20.0), (300.0, -12.0)), bar((10.0, 20.0), (300.0, 12.0)), bar((300.0, -12.0), (340.0, 9.0))];
        for turn in [0.4, 1.7, -2.6] {
            for arcs in [0.0, 0.5, 1.0] {
                let found = half_way(&arm, turn, Point::ZERO, arcs);
                assert!(off(&found) < 1.0, "{turn} {arcs}: {} px off", off(&found));
            }
        }
    }

    #[test]
    fn an_arm_of_two_groups_beside_a_body_goes_round_its_shoulder() {
        let body = [bar((-60.0, 0.0), (-60.0, 600.0)), bar((-20.0, 0.0), (-20.0, 600.0))];
        let fore = (0..4).map(|k| bar((160.0, 6.0 * f64::from(k) - 9.0), (300.0, 6.0 * f64::from(k) - 9.0)));
        let arm = [bar((5.0, -12.0), (150.0, -9.0)), bar((5.0, 12.0), (150.0, 9.0))].into_iter().chain(fore);
        let arm: Vec<Vec<Point>> = arm.collect();
        let posed = |turn: f64, bend: f64| -> Vec<Stroke> {
            let elbow = Point::new(155.0, 0.0);
            let bent =
                |k: usize, p: &Point| if k < 2 { *p } else { elbow + Point::from_angle(bend).rotate(*p - elbow) };
            let moved = |(k, points): (usize, &Vec<Point>)| {
                points.iter().map(|p| Point::from_angle(turn).rotate(bent(k, p))).collect()
            };
            body.iter()
                .cloned()
                .chain(arm.iter().enumerate().map(moved))
                .map(|points| Stroke::new(points, false))
                .collect()
        };
        let spacing = Spacing::Timing(Timing::Linear);
        let key = |(frame, strokes)| Key { frame, strokes, spacing: spacing.clone(), corner: false };
        let keys = [(0, posed(-0.5, 0.0)), (8, posed(2.0, 0.2))].map(key);
        let pair = |k| Pair { from: k, to: k, reversed: false, start: 0.0, confidence: 1.0, by_hand: true };
        let matching = Matching { pairs: (0..8).map(pair).collect(), ..Matching::default() };
        let sequence = Sequence::new(keys.into(), &[matching], &GivenPegs::default(), &Options::default()).unwrap();
        let wanted = posed(0.75, 0.1);
        for (drawn, wanted) in sequence.at(4).iter().zip(&wanted) {
            let off = drawn.stroke.points.iter().zip(&wanted.points).map(|(p, q)| p.distance(*q)).fold(0.0, f64::max);
            assert!(off < 12.0, "{off} px off");
        }
    }

    #[test]
    fn arcs_hold_for_what_turns_about_a_point_in_the_air_and_for_a_wheel() {
        let stick = [bar((100.0, 200.0), (300.0, 200.0)), bar((100.0, 210.0), (300.0, 210.0))];
        let spokes: Vec<_> = (0..6)
            .map(|k| Point::from_angle(f64::from(k)) * 100.0)
            .map(|p| bar((0.0, 100.0), (p + Point::Y * 100.0).into()))
            .collect();
        for strokes in [&stick[..], &spokes] {
            let [full, straight] = [1.0, 0.0].map(|arcs| off(&half_way(strokes, 1.2, Point::ZERO, arcs)));
            assert!(full < 1.0 && straight > 15.0, "{full} {straight}");
        }
    }
}
