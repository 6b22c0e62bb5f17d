//! Strokes that are on both drawings, in the same place.
//!
//! An artist copies a drawing and moves some of its strokes. The others stand where they stood, to the last digit, or nearly so where
//! they were traced or fitted anew: each place of one line lies on the other. Such strokes are pairs before anything else is compared. An
//! arm that is most of the drawing would otherwise take a head for the body where its own turn would bring it.
//!
//! A line lies on another where no place of either is farther from the other than 0.0015 of the drawing's size, and their lengths are
//! nearly equal. Lines less than ten times that long must be the same point by point: dots lie on each other by chance. Of several
//! lines the nearest is taken. The pair keeps its places: a ring that stands does not turn with an arm that swings around it.
//!
//! A pair made by hand may send such a stroke elsewhere: two dots have changed places. Then standing still proves nothing, and no
//! stroke is fixed.
//!
//! Limit: legs that have changed places in a walk, so that each lies where the other was, stand still. Layers, colours, pegs and pairs by
//! hand tell them apart.

use super::super::ink;
use super::super::line::Line;
use super::super::stroke::Stroke;
use super::{Fixed, Matching, start};
use rototoon_base::geometry::{Point, polyline};

/// Largest distance of a line from one that it lies on, as a share of the drawings' size.
const ON: f64 = 0.0015;
/// Smallest size of a line that may lie nearly on another, in such distances.
const LEAST: f64 = 10.0;
/// Largest difference of lengths, as a share of the longer one, for lines that lie nearly on each other.
const LONGER: f64 = 0.05;
/// Number of samples of a line, and of a closed one where its start is looked for.
const SAMPLES: usize = 48;
const STARTS: usize = 192;
/// Confidence in a pair whose lines are the same point by point, and in one whose lines lie nearly on each other.
const CONFIDENCE: [f64; 2] = [1.0, 0.99];

/// A stroke that is on both drawings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Unchanged {
    pub from: usize,
    pub to: usize,
    reversed: bool,
    start: f64,
    confidence: f64,
}

/// Fixes free strokes to the strokes of the other drawing that lie in the same place and look the same. Returns them by their index on
/// the first drawing; `None` where standing still proves nothing.
pub(super) fn fix(first: &[Stroke], second: &[Stroke], fixed: &mut [Fixed]) -> Option<Vec<Unchanged>> {
    let on = ON * ink::size(first.iter().chain(second).flat_map(|s| &s.points));
    let boxes = second.iter().map(bounds).collect::<Vec<_>>();
    let mut same: Vec<(f64, usize, usize)> = Vec::new();
    for (i, stroke) in first.iter().enumerate().filter(|(_, stroke)| !stroke.points.is_empty()) {
        let own = bounds(stroke);
        let near = |j: &usize| (0..2).all(|k| own[k].distance(boxes[j.to_owned()][k]) <= 2.0 * on);
        let laid = |j: usize| apart(stroke, &second[j], on).map(|apart| (apart, i, j));
        same.extend((0..second.len()).filter(near).filter_map(laid));
    }
    same.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)).then(a.2.cmp(&b.2)));
    let mut free = vec![true; second.len()];
    for (i, fixed) in fixed.iter().enumerate() {
        if let Fixed::To(to) = fixed {
            let mut own = same.iter().filter(|same| same.1 == i).peekable();
            if own.peek().is_some() && !own.any(|same| same.2 == *to) {
                return None;
            }
            free[*to] = false;
        }
    }
    let mut found = Vec::new();
    for (apart, from, to) in same {
        if fixed[from] == Fixed::Free && free[to] {
            (fixed[from], free[to]) = (Fixed::To(to), false);
            found.push(laid(from, to, &first[from], &second[to], CONFIDENCE[usize::from(apart > 0.0)]));
        }
    }
    found.sort_unstable_by_key(|unchanged| unchanged.from);
    Some(found)
}

/// The corners of the box around a stroke.
pub(super) fn bounds(stroke: &Stroke) -> [Point; 2] {
    let grown = |[low, high]: [Point; 2], p: &Point| [low.min(*p), high.max(*p)];
    stroke.points.iter().fold([Point::INFINITY, Point::NEG_INFINITY], grown)
}

/// How far two lines are from each other where they lie on each other and look the same. 0 where they have the same points.
fn apart(a: &Stroke, b: &Stroke, on: f64) -> Option<f64> {
    if !looks_alike(a, b) {
        return None;
    }
    if a.points == b.points {
        return Some(0.0);
    }
    let [low, high] = bounds(a);
    let lengths = [a.length(), b.length()];
    let longer = lengths[0].max(lengths[1]);
    if low.distance(high) < LEAST * on || (lengths[0] - lengths[1]).abs() > LONGER * longer {
        return None;
    }
    Some(farthest(a, b)).filter(|apart| *apart <= on).map(|apart| apart.max(f64::MIN_POSITIVE))
}

/// Whether nothing but its place tells a stroke from another one.
pub(super) fn looks_alike(a: &Stroke, b: &Stroke) -> bool {
    let look = |s: &Stroke| (s.closed, s.colour, s.material, s.layer);
    look(a) == look(b) && a.may_be(b)
}

/// How far a place of one of two lines is at most from the other line.
pub(super) fn farthest(a: &Stroke, b: &Stroke) -> f64 {
    let from = |a: &Stroke, b: &Stroke| {
        let samples = polyline::resample(&a.points, a.closed, SAMPLES);
        samples.iter().map(|p| polyline::distance(*p, &b.points, b.closed)).fold(0.0, f64::max)
    };
    from(a, b).max(from(b, a))
}

/// How a stroke lies on its counterpart: in which direction, and where it starts.
pub(super) fn laid(from: usize, to: usize, a: &Stroke, b: &Stroke, confidence: f64) -> Unchanged {
    let (on_a, on_b) = (Line::new(a), Line::new(b));
    let shares = |count: usize| (0..count).map(move |k| k as f64 / count as f64);
    let start = if a.closed {
        let first = on_a.at(0.0);
        let nearest =
            |x: &f64, y: &f64| on_b.at(*x).distance_squared(first).total_cmp(&on_b.at(*y).distance_squared(first));
        shares(STARTS).min_by(nearest).unwrap_or(0.0)
    } else {
        0.0
    };
    let other = |s: f64, reversed: bool| match (a.closed, reversed) {
        (true, false) => (start + s).rem_euclid(1.0),
        (true, true) => (start - s).rem_euclid(1.0),
        (false, false) => s,
        (false, true) => 1.0 - s,
    };
    let off = |reversed: bool| shares(SAMPLES).map(|s| on_a.at(s).distance(on_b.at(other(s, reversed)))).sum::<f64>();
    let reversed = off(true) < off(false);
    let start = if a.closed { start::refined(a, b, start, reversed) } else { 0.0 };
    Unchanged { from, to, reversed, start, confidence }
}

/// Says of the pairs of these strokes that they were found, not made by hand, and lays them as they stand.
pub(super) fn found(matching: &mut Matching, unchanged: &[Unchanged]) {
    for pair in &mut matching.pairs {
        if let Ok(k) = unchanged.binary_search_by_key(&pair.from, |unchanged| unchanged.from) {
            let Unchanged { reversed, start, confidence, .. } = unchanged[k];
            (pair.by_hand, pair.reversed, pair.start, pair.confidence) = (false, reversed, start, confidence);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{HandPair, Options, match_strokes};
    use super::*;
    use rototoon_base::scene::Silent;

    fn ring(x: f64, y: f64, radius: f64) -> Stroke {
        let at = |k: i32| Point::new(x, y) + Point::from_angle(f64::from(k) * 0.2) * radius;
        Stroke::new((0..31).map(at).collect(), true)
    }

    fn bar(from: Point, way: f64, length: f64) -> Stroke {
        Stroke::new((0..20).map(|k| from + Point::from_angle(way) * (length * f64::from(k) / 19.0)).collect(), false)
    }

    /// A head, a body like it, and an arm of many strokes about a shoulder between the two.
    fn figure(way: f64) -> Vec<Stroke> {
        let shoulder = Point::new(100.0, 100.0);
        let side = Point::from_angle(way + 1.5) * 4.0;
        let arm = (0..9).map(|k| bar(shoulder + side * f64::from(k), way, 60.0 + 4.0 * f64::from(k)));
        [ring(100.0, 60.0, 22.0), ring(100.0, 140.0, 24.0)].into_iter().chain(arm).collect()
    }

    fn pairs(matching: &Matching) -> Vec<(usize, usize)> {
        matching.pairs.iter().map(|pair| (pair.from, pair.to)).collect()
    }

    #[test]
    fn what_stands_still_is_itself_beside_an_arm_that_swings() {
        let (first, mut second) = (figure(0.2), figure(2.8));
        second.rotate_left(1);
        let found = match_strokes(&first, &second, &[], &Options::default(), &Silent).unwrap();
        assert_eq!(pairs(&found)[..2], [(0, 10), (1, 0)]);
        assert!(found.pairs[..2].iter().all(|pair| pair.confidence == 1.0 && !pair.by_hand && !pair.reversed));
    }

    #[test]
    fn decisions_by_hand_come_first() {
        let (first, second) = (figure(0.2), figure(0.2));
        let matched = |hand| match_strokes(&first, &second, &[hand], &Options::default(), &Silent).unwrap();
        let crossed = matched(HandPair { from: 0, to: Some(1) });
        assert_eq!((pairs(&crossed)[0], crossed.pairs[0].by_hand), ((0, 1), true));
        let alone = matched(HandPair { from: 2, to: None });
        assert!(alone.vanished.contains(&2) && alone.appeared.contains(&2), "{alone:?}");
        assert_eq!(pairs(&alone)[0], (0, 0));
    }

    #[test]
    fn of_strokes_with_the_same_points_the_one_with_the_same_colour_is_taken() {
        let painted = |colour: f32| Stroke { colour: Some([colour; 3]), ..ring(50.0, 50.0, 20.0) };
        let (first, second) = ([painted(0.1), painted(0.9)], [painted(0.9), painted(0.1)]);
        let found = match_strokes(&first, &second, &[], &Options::default(), &Silent).unwrap();
        assert_eq!(pairs(&found), [(0, 1), (1, 0)]);
    }

    /// As [`figure`], its head and body with other points, in the other direction, a little beside.
    fn drawn_anew() -> Vec<Stroke> {
        let mut strokes = figure(2.8);
        for stroke in &mut strokes[..2] {
            let mut points = polyline::resample(&stroke.points, true, 47);
            points.rotate_left(11);
            points.reverse();
            stroke.points = points.into_iter().map(|p| p + Point::new(0.1, -0.1)).collect();
        }
        strokes
    }

    #[test]
    fn what_lies_nearly_where_it_lay_is_itself_and_does_not_turn() {
        let (first, second) = (figure(0.2), drawn_anew());
        let found = match_strokes(&first, &second, &[], &Options::default(), &Silent).unwrap();
        for (pair, (a, b)) in found.pairs.iter().zip(first.iter().zip(&second)).take(2) {
            assert_eq!((pair.from, pair.reversed, pair.confidence, pair.by_hand), (pair.to, true, 0.99, false));
            let there = Line::new(b).at(pair.start);
            assert!(there.distance(a.points[0]) < 1.0, "{there:?} is not {:?}", a.points[0]);
        }
    }

    #[test]
    fn dots_and_lines_of_other_lengths_are_not_fixed() {
        let size = ring(0.0, 0.0, 500.0);
        let line = |x: f64, length: f64| bar(Point::new(x, 0.0), 0.0, length);
        let of = |a: Stroke, b: Stroke| {
            fix(&[size.clone(), a], &[size.clone(), b], &mut [Fixed::Free; 2])
                .unwrap()
                .iter()
                .any(|found| found.from == 1)
        };
        assert!(of(line(0.0, 100.0), line(0.5, 100.0)));
        assert!(!of(line(0.0, 100.0), line(5.0, 100.0)));
        assert!(!of(line(0.0, 40.0), line(1.0, 37.5)));
        assert!(of(line(0.0, 10.0), line(0.0, 10.0)), "a dot with the same points");
        assert!(!of(line(0.0, 10.0), line(0.5, 10.0)), "a dot beside");
    }
}
