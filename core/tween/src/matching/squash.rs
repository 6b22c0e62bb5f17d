//! Shapes that are squashed instead of turned, and points that show how a shape turns.
//!
//! An eye that closes is wide after it was tall. The best similarity lays its long side on its long side, so the eye would turn by a
//! quarter turn. Of two explanations that fit about the same, the one that turns least is right, and the fit is that of an affine map
//! ([`Affine`]): a shape that changes its proportions anyway may as well do so without a turn. The turn is that against the places of the
//! strokes around it: in a figure that lies down, all turns. Where the strokes around it are squashed too, `setting` decides.
//!
//! Points of equal number, of which an affine map leads each to its counterpart, are a copy that was changed. If they say in their own order
//! that little turns, or that a long shape turns without a stretch (a box that tumbles), they are believed. Otherwise their order
//! was rolled, and every start at a point is tried as well.
//!
//! A shape that keeps its proportions is left as it was found: a limb that swings by a quarter turn is no limb that becomes wide. So is the choice
//! between two ways half a turn apart, which `turns` settles.
//!
//! An open line of as many points as its counterpart runs as its points say where that turns it much less: a lid that closes bends the other way,
//! and is not turned over. So does a copy that only turned. Neither does where that tears it from what it touches (`torn`).

use super::super::angle::wrap;
use super::super::line::{Line, vertex_shares};
use super::super::stroke::Stroke;
use super::costs::Figure;
use super::movement::held_by;
use super::outline::{Outline, Way};
use super::relaxation::Chosen;
use super::similarity::Movement;
use super::{setting, torn};
use crate::affine::{Affine, COPY, elongation};

/// Price of a stretch, and of a turn in radians, in shares of the shape's variance. They are not squared: a little turn would buy a smaller stretch.
const STRETCH: f64 = 0.06;
const TURN: f64 = 0.06;
/// A way that fits the shape worse by this share of its variance fits about the same.
const AS_WELL: f64 = 0.02;
/// A shape that is stretched less than this keeps its proportions.
pub(super) const RIGID: f64 = 0.15;
/// A shape is long if it is stretched by more than this against a round one.
const LONG: f64 = 0.15;
/// A way is replaced by one that is cheaper by this. Where no points say so, it must be cheaper by the second number, and differ by the turn after it:
/// less is noise in shapes that were drawn freely.
const CHEAPER: [f64; 2] = [0.005, 0.03];
const OTHER: f64 = 0.8;
/// Two ways that are farther apart are taken for half a turn apart.
const NEAR_HALF_A_TURN: f64 = 0.75 * std::f64::consts::PI;
/// Points in their own order that turn less than this say that nothing turned; ways within it are the same way.
const LITTLE: f64 = 0.2;
const SAME: f64 = 0.6;
/// The distance, in radii of the drawing, at which stillness counts as one more stroke.
pub(super) const HELD: f64 = 0.05;
/// Largest number of points of which every start is tried.
const MOST_POINTS: usize = 256;
/// Where a start is sought near a rough one: the number of samples, and the number of starts on each side with the share of the length between
/// them.
const STARTS: (i32, i32, f64) = (64, 8, 1.0 / 256.0);
/// A line runs as its points say if that turns it by this much less, and leaves at most this share of the variance to a similarity.
const MUCH_LESS: f64 = std::f64::consts::FRAC_PI_2;
const OPEN_FITS: f64 = 0.35;

/// A way with the parts of its affine map. `price` counts the turn against what is around.
#[derive(Clone, Copy, Debug)]
struct Tried {
    way: Way,
    affine: Affine,
    price: f64,
    by_points: bool,
}

/// Replaces ways that turn a stroke where it is rather squashed.
pub(super) fn settle(a: &Figure, b: &Figure, found: &mut [Option<Chosen>]) {
    let still = Movement { turn: 0.0, scale: 1.0, source: a.middle, target: b.middle };
    let around = held_by(a, b, found, &still, HELD * a.radius);
    let squashes = setting::squashes(a, b, found);
    let given = found.to_vec();
    // Read from the other end, it would turn: what such a stroke does is no proof for another one.
    let settled = |k: usize| {
        let own = given[k].as_ref();
        own.is_some_and(|own| !own.way.reversed || a.strokes[k].closed || !as_many(a, b, (k, own.to)))
    };
    for (i, choice) in found.iter_mut().enumerate() {
        let Some(choice) = choice else { continue };
        let (Some(p), Some(q)) = (&a.outlines[i], &b.outlines[choice.to]) else { continue };
        let (one, other) = (&a.strokes[i], &b.strokes[choice.to]);
        let better = match (p.closed, q.closed) {
            (true, true) => closed((one, p), (other, q), &choice.way, around[i].turn)
                .or_else(|| squashes[i]?.way_of(one, p, (other, q), &choice.way)),
            (false, false) => open((one, p), (other, q), &choice.way, around[i].turn)
                .filter(|way| !torn::tears((a, b), &given, (i, choice.to), (&choice.way, way), settled)),
            _ => None,
        };
        choice.way = better.unwrap_or(choice.way);
    }
}

/// Whether a stroke and its counterpart have as many points.
fn as_many(a: &Figure, b: &Figure, (from, to): (usize, usize)) -> bool {
    a.strokes[from].points.len() == b.strokes[to].points.len()
}

fn tried(way: Way, affine: Affine, by_points: bool, expected: f64) -> Tried {
    let price = affine.residual + STRETCH * affine.stretch + TURN * wrap(affine.turn - expected).abs();
    Tried { way: Way { turn: affine.turn, ..way }, affine, price, by_points }
}

/// A better way to lay a closed stroke on its counterpart.
fn closed((one, p): (&Stroke, &Outline), (other, q): (&Stroke, &Outline), own: &Way, expected: f64) -> Option<Way> {
    let laid = |way: &Way| Affine::fit(&p.places, &q.read(way)).map(|affine| tried(*way, affine, false, expected));
    let now = laid(own)?;
    let copies = by_points(one, other, p, q, expected);
    if let Some(copy) = copies.first().filter(|copy| copy.way.start == 0.0 && !copy.way.reversed) {
        let rigid = copy.affine.stretch < RIGID && elongation(&one.points) > LONG;
        if rigid || wrap(copy.affine.turn - expected).abs() < LITTLE {
            return Some(copy.way);
        }
    }
    let near = |tried: &Tried| wrap(tried.way.turn - now.way.turn).abs();
    let squashed = now.affine.stretch >= RIGID;
    let fits = |tried: &Tried| {
        let as_well = tried.affine.residual <= now.affine.residual + AS_WELL;
        let other = squashed && near(tried) < NEAR_HALF_A_TURN;
        as_well && if tried.by_points { other || near(tried) < SAME } else { other && near(tried) > OTHER }
    };
    let by_length = p.all_ways(q).into_iter().flatten().filter_map(|way| laid(&way));
    let all = copies.iter().copied().chain(by_length).filter(fits);
    let best = all.min_by(|x, y| x.price.total_cmp(&y.price))?;
    let better = best.price < now.price - CHEAPER[usize::from(!best.by_points)] || best.by_points && near(&best) < SAME;
    better.then(|| if best.way.exact { best.way } else { refined(one, other, best, expected) })
}

/// A squashed way with the start near its own one by which it is cheapest.
fn refined(one: &Stroke, other: &Stroke, rough: Tried, expected: f64) -> Way {
    let (a, b) = (Line::new(one), Line::new(other));
    let shares = || (0..STARTS.0).map(|k| f64::from(k) / f64::from(STARTS.0));
    let from: Vec<_> = shares().map(|share| a.at(share)).collect();
    let at = |step: i32| {
        let start = (rough.way.start + f64::from(step) * STARTS.2).rem_euclid(1.0);
        let sign = if rough.way.reversed { -1.0 } else { 1.0 };
        let to: Vec<_> = shares().map(|share| b.at((start + sign * share).rem_euclid(1.0))).collect();
        let way = Way { start, exact: true, ..rough.way };
        Affine::fit(&from, &to).map(|affine| tried(way, affine, false, expected))
    };
    let steps = (0..=STARTS.1).flat_map(|step| [-step, step]);
    let best = steps.filter_map(at).min_by(|x, y| x.price.total_cmp(&y.price));
    best.map_or(rough.way, |best| best.way)
}

/// The ways to lay a stroke on one of as many points, point by point, where it is a copy that was changed. The points in their own order come
/// first.
fn by_points(one: &Stroke, other: &Stroke, p: &Outline, q: &Outline, expected: f64) -> Vec<Tried> {
    let n = one.points.len();
    if n < 4 || other.points.len() != n {
        return Vec::new();
    }
    let shares = vertex_shares(other);
    let starts = if n > MOST_POINTS { 1 } else { n };
    let of = |(reversed, first): (bool, usize)| {
        let at = |k: usize| if reversed { (first + n - k) % n } else { (first + k) % n };
        let to: Vec<_> = (0..n).map(|k| other.points[at(k)]).collect();
        let affine = Affine::fit(&one.points, &to).filter(|affine| affine.residual <= COPY)?;
        let way = Way { residual: 0.0, turn: affine.turn, reversed, start: shares[first], exact: true };
        Some(tried(way, affine, true, expected))
    };
    let directions = p.directions(q);
    directions.into_iter().flat_map(|reversed| (0..starts).map(move |first| (reversed, first))).filter_map(of).collect()
}

/// The way of an open stroke as its points say, where that turns it much less or leaves nothing of its shape unexplained.
fn open((one, p): (&Stroke, &Outline), (other, q): (&Stroke, &Outline), own: &Way, expected: f64) -> Option<Way> {
    if !own.reversed || one.points.len() != other.points.len() || one.points.len() < 3 {
        return None;
    }
    let forward = p.all_ways(q).into_iter().flatten().find(|way| !way.reversed)?;
    let turn = |way: &Way| wrap(way.turn - expected).abs();
    let less = forward.residual <= OPEN_FITS && turn(&forward) + MUCH_LESS < turn(own);
    let copied = forward.residual + COPY < own.residual && forward.residual <= COPY;
    (less || copied).then_some(forward)
}

#[cfg(test)]
mod tests {
    use super::super::{Matching, Options, match_strokes};
    use super::*;
    use crate::between::{GivenPegs, Key, Sequence};
    use rototoon_base::geometry::{Point, polygon, polyline};
    use rototoon_base::scene::Silent;
    use std::f64::consts::{FRAC_PI_2, TAU};

    fn ellipse(wide: f64, high: f64, count: usize) -> Stroke {
        let at = |k: usize| Point::from_angle(TAU * k as f64 / count as f64) * Point::new(wide, high);
        Stroke::new((0..count).map(at).collect(), true)
    }

    fn boxed(wide: f64, high: f64) -> Stroke {
        let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        Stroke::new(corners.map(|(x, y)| Point::new(x * wide, y * high)).into(), true)
    }

    fn matched(a: &[Stroke], b: &[Stroke]) -> Matching {
        match_strokes(a, b, &[], &Options::default(), &Silent).unwrap()
    }

    /// The points half way of each stroke of the first drawing.
    fn half_way(a: &[Stroke], b: &[Stroke]) -> Vec<Vec<Point>> {
        let keys = [(0, a), (8, b)].map(|(frame, strokes)| Key { frame, strokes: strokes.to_vec(), ..Key::default() });
        let pegs = GivenPegs::default();
        let sequence =
            Sequence::new(keys.into(), &[matched(a, b)], &pegs, &crate::between::Options::default()).unwrap();
        sequence.at(4).into_iter().map(|drawn| drawn.stroke.points).collect()
    }

    /// How far the long axis is from an upright or a level one, in radians.
    fn aslant(points: &[Point]) -> f64 {
        let middle = polygon::center(points);
        let square = |p: &Point| {
            Point::new((*p - middle).x.powi(2) - (*p - middle).y.powi(2), 2.0 * (*p - middle).x * (*p - middle).y)
        };
        let axis = 0.5 * points.iter().map(square).sum::<Point>().to_angle();
        (axis - FRAC_PI_2 * (axis / FRAC_PI_2).round()).abs()
    }

    fn turned(stroke: &Stroke, turn: f64, about: Point) -> Stroke {
        let at = |p: &Point| about + Point::from_angle(turn).rotate(*p - about);
        Stroke::new(stroke.points.iter().map(at).collect(), stroke.closed)
    }

    #[test]
    fn what_is_squashed_does_not_turn() {
        let pairs = [
            ("an eye that closes", ellipse(16.0, 20.0, 16), ellipse(16.0, 3.0, 16)),
            ("an eye that opens", ellipse(16.0, 3.0, 16), ellipse(16.0, 20.0, 16)),
            ("a half closed eye", ellipse(16.0, 20.0, 16), ellipse(16.0, 10.0, 16)),
            ("an eye with other points", ellipse(16.0, 20.0, 40), ellipse(16.0, 3.0, 27)),
            ("a ball", ellipse(100.0, 150.0, 24), ellipse(150.0, 80.0, 24)),
            ("a mouth", ellipse(40.0, 8.0, 24), ellipse(25.0, 40.0, 24)),
            ("a box", boxed(50.0, 100.0), boxed(100.0, 50.0)),
            ("a door", boxed(100.0, 120.0), boxed(10.0, 120.0)),
        ];
        for (name, a, b) in pairs {
            let half = half_way(std::slice::from_ref(&a), std::slice::from_ref(&b)).remove(0);
            let narrow = aslant(&half);
            // Half way an ellipse may be a circle, whose axis is anything.
            assert!(
                narrow < 0.04 || crate::affine::elongation(&half) < 0.05,
                "{name} stands aslant by {narrow} half way"
            );
            if a.points.len() == b.points.len() {
                assert_eq!(matched(&[a], &[b]).pairs[0].start, 0.0, "{name}");
            }
        }
    }

    #[test]
    fn an_eye_whose_points_were_rolled_and_turned_round_closes_too() {
        let (eye, mut closed) = (ellipse(16.0, 20.0, 16), ellipse(16.0, 3.0, 16));
        closed.points.rotate_left(4);
        for reversed in [false, true] {
            if reversed {
                closed.points.reverse();
            }
            let half = half_way(std::slice::from_ref(&eye), std::slice::from_ref(&closed)).remove(0);
            assert!(aslant(&half) < 0.04, "{reversed}: {}", aslant(&half));
        }
    }

    #[test]
    fn eyes_close_in_a_face_and_turn_with_it() {
        let at = |stroke: Stroke, x: f64| {
            Stroke::new(stroke.points.iter().map(|p| *p + Point::new(x, -20.0)).collect(), true)
        };
        let face = |high: f64, count: usize| -> Vec<Stroke> {
            let mouth =
                (0..9).map(|k| Point::new(5.0 * f64::from(k) - 20.0, 40.0 + 0.5 * f64::from(k * (8 - k)))).collect();
            vec![
                ellipse(100.0, 120.0, 40),
                at(ellipse(16.0, high, count), -40.0),
                at(ellipse(16.0, high, count), 40.0),
                Stroke::new(mouth, false),
            ]
        };
        let (open, closed) = (face(20.0, 20), face(3.0, 27));
        for turn in [0.0, 0.7] {
            let second: Vec<Stroke> = closed.iter().map(|stroke| turned(stroke, turn, Point::ZERO)).collect();
            let half = half_way(&open, &second);
            for eye in &half[1..3] {
                let back: Vec<Point> = eye.iter().map(|p| Point::from_angle(-turn / 2.0).rotate(*p)).collect();
                assert!(aslant(&back) < 0.15, "{turn}: {}", aslant(&back));
            }
        }
    }

    #[test]
    fn what_really_turns_turns() {
        let tumbling = boxed(50.0, 100.0);
        for turn in [FRAC_PI_2, 2.4] {
            let half = half_way(std::slice::from_ref(&tumbling), &[turned(&tumbling, turn, Point::ZERO)]).remove(0);
            let there = turned(&tumbling, turn / 2.0, Point::ZERO).points;
            let off = half.iter().zip(&there).map(|(p, q)| p.distance(*q)).fold(0.0, f64::max);
            assert!(off < 1.0, "a box that tumbles by {turn} is {off} px off");
        }
        // A limb of one closed line, with other points on the second drawing, on a body that stays.
        let limb = |count: usize| {
            let round = |x: f64, from: f64, radius: f64| {
                (0..9).map(move |k| {
                    Point::new(x, 0.0) + Point::from_angle(from + 0.125 * TAU / 2.0 * f64::from(k)) * radius
                })
            };
            let corners: Vec<Point> = round(100.0, -FRAC_PI_2, 12.0).chain(round(0.0, FRAC_PI_2, 20.0)).collect();
            Stroke::new(polyline::resample(&corners, true, count), true)
        };
        let body = Stroke::new((0..12).map(|k| Point::new(-30.0, 20.0 * f64::from(k))).collect(), false);
        // By more than a quarter turn only points tell which end is which.
        for (turn, count) in [(FRAC_PI_2, 53), (2.6, 40)] {
            let second = [body.clone(), turned(&limb(count), turn, Point::ZERO)];
            let pair = matched(&[body.clone(), limb(40)], &second).pairs[1];
            let start = Line::new(&second[1]).at(pair.start);
            let wanted = Point::from_angle(turn).rotate(limb(40).points[0]);
            assert!(start.distance(wanted) < 4.0, "{turn}: {start} is not {wanted}");
        }
    }

    #[test]
    fn a_lid_that_closes_bends_and_is_not_turned_over() {
        let lid = |high: f64| {
            let at = |k: i32| Point::from_angle(std::f64::consts::PI * f64::from(k) / 11.0) * Point::new(20.0, high);
            Stroke::new((0..12).map(at).collect(), false)
        };
        let half = half_way(&[lid(20.0)], &[lid(-5.0)]).remove(0);
        assert!(!matched(&[lid(20.0)], &[lid(-5.0)]).pairs[0].reversed);
        assert!(half[0].x > 15.0 && half[0].y.abs() < 8.0, "{half:?}");
        let arm = Stroke::new(
            (0..12).map(|k| Point::new(9.0 * f64::from(k), (f64::from(k) * 0.4).sin() * 5.0)).collect(),
            false,
        );
        let pair = matched(std::slice::from_ref(&arm), &[turned(&arm, 2.0, Point::ZERO)]).pairs[0];
        assert!(!pair.reversed, "an arm that swings alone");
    }
}
