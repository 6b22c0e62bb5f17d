//! In-betweens that follow captured contours.
//!
//! Two drawings do not show the progress of a limb on each frame, nor whether it swings out and back. Tracked footage
//! between them shows both. A stroke that is drawn on a captured part then moves with that part, from the earlier key
//! forwards and from the later key backwards:
//!
//! p(f) = (1 − u) W_{a→f}(p_a) + u W_{b→f}(p_b), u = (f − a) / (b − a).
//!
//! Here W maps the part's contour on one frame to its contour on another, and the plane around it too ([`Moving`]). On the
//! keys the result is the drawings themselves, with everything that they add to the contours. Between the keys these
//! additions fade from those of one drawing into those of the other.
//!
//! The lids of a closed eye share one line, and an arm may rest on its body. A point near two stretches of a contour on
//! one key belongs to the stretch to which it is near on both keys. Each point is therefore **bound** to the place on
//! the contour with the least sum of squared distances on both keys. It follows the contour around that place. The
//! farther it is from the contour, the longer the stretch that it follows.
//!
//! # The part that a stroke follows
//!
//! Candidates are parts that are captured on all frames of the span and that contain the stroke, or have it near them,
//! on both keys. The best one carries the stroke's points most exactly from one key to the other. An arm that has swung out and
//! come back explains a line on its sleeve no better than the body behind it, so where the stroke lies counts as well, if
//! little ([`BESIDE`]). A stroke follows no part if the best one misses its points by more than half of their way and by more
//! than drawings may be off a part ([`NEAR`]).
//!
//! # Limits
//!
//! A spacing chart describes the progress of a movement that nobody saw. A captured movement has its own spacing, so
//! charts do not apply to it.

use super::Track;
use rototoon_base::geometry::moving::Moving;
use rototoon_base::geometry::{Point, polygon, polyline};
use rototoon_base::scene::FrameNumber;
use std::collections::BTreeMap;

/// Number of parts into which a segment of a contour is divided, so that a point on it is nearer to one of them than to
/// another stretch.
const STEPS: usize = 4;
/// Half length of the stretch that a point follows: this many times its distance from the contour, but at least this
/// many segments.
const AROUND: f64 = 3.0;
/// Largest mean distance of a stroke's points outside a part, in sizes of the part.
const NEAR: f64 = 0.15;
/// Largest share of its way by which a part may miss a stroke that it does not meet within [`NEAR`].
const EXPLAINED: f64 = 0.5;
/// A part counts as missing a stroke by this share of their distance more. It is larger than the noise of tracked contours,
/// and smaller than what parts that move apart miss.
const BESIDE: f64 = 0.05;
/// Size of an open contour or one without area, as a share of its length.
const OPEN: f64 = 0.3;

/// A captured contour of a part.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Captured {
    /// Whether the last point joins the first.
    pub closed: bool,
    /// Its points by frame, in pixels; the same number on each frame.
    pub contours: BTreeMap<FrameNumber, Vec<Point>>,
}

impl Captured {
    /// Whether it is known on all frames from `first` to `last`, with the same number of points on each.
    fn spans(&self, first: FrameNumber, last: FrameNumber) -> bool {
        let Some(points) = self.contours.get(&first).map(Vec::len) else { return false };
        let alike = self.contours.range(first..=last).filter(|(_, contour)| contour.len() == points).count() as i64;
        first <= last && alike == i64::from(last) - i64::from(first) + 1
    }

    /// A contour with each segment divided into [`STEPS`].
    fn divided(&self, contour: &[Point]) -> Vec<Point> {
        let last = contour.last().filter(|_| !self.closed || contour.len() == 1).copied();
        let steps = |(a, b): (Point, Point)| (0..STEPS).map(move |k| a.lerp(b, k as f64 / STEPS as f64));
        polyline::segments(contour, self.closed).flat_map(steps).chain(last).collect()
    }

    /// Whether points are inside the part or near it on a frame, in the mean.
    fn holds(&self, points: &[Point], frame: FrameNumber) -> bool {
        let Some(contour) = self.contours.get(&frame).filter(|contour| !contour.is_empty()) else { return false };
        let outside = |p: &Point| {
            if self.closed && polygon::contains(contour, *p) {
                0.0
            } else {
                polyline::distance(*p, contour, self.closed)
            }
        };
        let off = points.iter().map(outside).sum::<f64>() / points.len().max(1) as f64;
        off <= NEAR * self.size(contour)
    }

    /// Mean distance of points from the contour on a frame, in pixels.
    fn beside(&self, points: &[Point], frame: FrameNumber) -> f64 {
        let contour = self.contours.get(&frame).map_or(&[][..], Vec::as_slice);
        points.iter().map(|p| polyline::distance(*p, contour, self.closed)).sum::<f64>() / points.len().max(1) as f64
    }

    /// Size of a contour, in pixels.
    fn size(&self, contour: &[Point]) -> f64 {
        let area = if self.closed { polygon::signed_area(contour).abs().sqrt() } else { 0.0 };
        // A closed eye has no area either, so the length counts too.
        area.max(OPEN * polyline::length(contour, false))
    }
}

/// How a stroke between two keys follows a part.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Following {
    /// Index of the part.
    part: usize,
    /// Frames of the keys.
    frames: [FrameNumber; 2],
    /// For each point the index of its place on the divided contour, and the number of places around it that count.
    bound: Vec<(usize, f64)>,
}

impl Following {
    /// Binds points to a part on both keys. `None` where the part is not captured on all frames, or the points are not
    /// near it.
    fn new(parts: &[Captured], part: usize, frames: [FrameNumber; 2], points: [&[Point]; 2]) -> Option<Self> {
        let captured = &parts[part];
        let on = captured.spans(frames[0], frames[1]);
        if !on || !(0..2).all(|k| captured.holds(points[k], frames[k])) {
            return None;
        }
        let contours = frames.map(|frame| captured.contours.get(&frame).map(|c| captured.divided(c)));
        let [Some(a), Some(b)] = contours else { return None };
        let spacing = 0.5 * (polyline::length(&a, captured.closed) + polyline::length(&b, captured.closed));
        let spacing = (spacing / a.len().max(1) as f64).max(1e-9);
        let bind = |(p, q): (&Point, &Point)| {
            let off = |j: usize| [p.distance_squared(a[j]), q.distance_squared(b[j])];
            let sum = |j: &usize| off(*j)[0] + off(*j)[1];
            let nearest = (0..a.len()).min_by(|i, j| sum(i).total_cmp(&sum(j)))?;
            let farther = off(nearest)[0].max(off(nearest)[1]).sqrt();
            Some((nearest, (AROUND * STEPS as f64).max(AROUND * farther / spacing)))
        };
        let bound = points[0].iter().zip(points[1]).map(bind).collect::<Option<_>>()?;
        Some(Self { part, frames, bound })
    }

    /// The stroke's points on a frame, from its points on both keys.
    pub fn at(&self, parts: &[Captured], points: [&[Point]; 2], frame: FrameNumber) -> Option<Vec<Point>> {
        let [a, b] = self.frames;
        let u = (f64::from(frame) - f64::from(a)) / (f64::from(b) - f64::from(a));
        let part = parts.get(self.part)?;
        let forwards = self.carried(part, points[0], a, frame)?;
        let backwards = self.carried(part, points[1], b, frame)?;
        Some(forwards.iter().zip(&backwards).map(|(p, q)| p.lerp(*q, u)).collect())
    }

    /// Carries points from one frame to another.
    fn carried(&self, part: &Captured, points: &[Point], from: FrameNumber, to: FrameNumber) -> Option<Vec<Point>> {
        let (from, to) = (part.divided(part.contours.get(&from)?), part.divided(part.contours.get(&to)?));
        let count = from.len();
        let moving = (count == to.len()).then(|| Moving::new(&from, &to, part.closed))?;
        let carry = |(&p, &(at, reach)): (&Point, &(usize, f64))| {
            moving.apply_by(p, |j| {
                let along = at.abs_diff(j);
                let along = if part.closed { along.min(count - along) } else { along };
                let share = along as f64 / reach;
                if share < 1.0 { (1.0 - share * share).powi(2) } else { 0.0 }
            })
        };
        Some(points.iter().zip(&self.bound).map(carry).collect())
    }
}

/// How a track follows a part from `key` to the next key. `frames` are the frames of these keys.
pub(super) fn followed(parts: &[Captured], track: &Track, key: usize, frames: [FrameNumber; 2]) -> Option<Following> {
    let (a, b) = (track.points(key)?, track.points(key + 1)?);
    let missed = |part: usize| {
        let following = Following::new(parts, part, frames, [a, b])?;
        let carried = following.carried(&parts[part], a, frames[0], frames[1])?;
        let beside = 0.5 * (parts[part].beside(a, frames[0]) + parts[part].beside(b, frames[1]));
        let miss = mean_distance(&carried, b);
        Some((miss + BESIDE * beside, miss, following))
    };
    let (_, least, following) = (0..parts.len()).filter_map(missed).min_by(|a, b| a.0.total_cmp(&b.0))?;
    let size = parts[following.part].contours.get(&frames[0]).map_or(0.0, |c| parts[following.part].size(c));
    (least <= (EXPLAINED * mean_distance(a, b)).max(NEAR * size)).then_some(following)
}

fn mean_distance(a: &[Point], b: &[Point]) -> f64 {
    a.iter().zip(b).map(|(p, q)| p.distance(*q)).sum::<f64>() / a.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::super::super::matching::{Matching, Pair};
    use super::super::super::peg::{Peg, PegKey, PegTree};
    use super::super::super::stroke::Stroke;
    use super::super::{GivenPegs, Key, Options, Sequence};
    use super::*;

    /// An open bar of length 100 from the origin, in a direction.
    fn bar(angle: f64) -> Vec<Point> {
        (0..=20).map(|k| Point::from_angle(angle) * (f64::from(k) * 5.0)).collect()
    }

    /// The angle of a swing out to about 1.2 and back to 0.2. The keys do not show it.
    fn angle(frame: FrameNumber) -> f64 {
        0.2 * f64::from(frame) / 10.0 + 1.1 * (std::f64::consts::PI * f64::from(frame) / 10.0).sin()
    }

    fn swing(frames: impl IntoIterator<Item = FrameNumber>) -> Captured {
        Captured { closed: false, contours: frames.into_iter().map(|f| (f, bar(angle(f)))).collect() }
    }

    /// A sequence of one stroke on frames 0 and 10 that follows parts.
    fn drawn(a: Vec<Point>, b: Vec<Point>, pegs: &GivenPegs, parts: Vec<Captured>) -> Sequence {
        let key = |frame, points| Key { frame, strokes: vec![Stroke::new(points, false)], ..Key::default() };
        let pair = Pair { from: 0, to: 0, reversed: false, start: 0.0, confidence: 1.0, by_hand: true };
        let matching = Matching { pairs: vec![pair], ..Matching::default() };
        let keys = vec![key(0, a), key(10, b)];
        Sequence::new(keys, &[matching], pegs, &Options::default()).unwrap().following(parts.into())
    }

    /// Largest distance of the stroke's middle from the middle of the swinging bar, on frames between the keys.
    fn off(sequence: &Sequence) -> f64 {
        let on = |f: FrameNumber| sequence.at(f)[0].stroke.points[10].distance(bar(angle(f))[10]);
        (1..10).map(on).fold(0.0, f64::max)
    }

    #[test]
    fn a_limb_that_swings_out_and_back_is_followed() {
        let keys = || (bar(angle(0)), bar(angle(10)));
        let plain = drawn(keys().0, keys().1, &GivenPegs::default(), Vec::new());
        assert!(off(&plain) > 40.0, "two drawings do not tell: {}", off(&plain));
        let followed = drawn(keys().0, keys().1, &GivenPegs::default(), vec![swing(0..=10)]);
        assert!(off(&followed) < 1e-6, "{}", off(&followed));
    }

    #[test]
    fn additions_of_one_drawing_fade_into_those_of_the_next() {
        // 4 px beside the bar on the first key, on the bar on the second.
        let beside = |frame, by: f64| -> Vec<Point> {
            bar(angle(frame)).iter().map(|p| *p + Point::from_angle(angle(frame)).perp() * by).collect()
        };
        let sequence = drawn(beside(0, 4.0), beside(10, 0.0), &GivenPegs::default(), vec![swing(0..=10)]);
        for frame in 1..10 {
            let want = beside(frame, 4.0 - 0.4 * f64::from(frame));
            for (p, q) in sequence.at(frame)[0].stroke.points.iter().zip(&want).skip(1) {
                assert!(p.distance(*q) < 0.05, "frame {frame}: {p} for {q}");
            }
        }
        assert_eq!(sequence.at(0)[0].stroke.points, beside(0, 4.0), "a key is drawn as it is");
    }

    #[test]
    fn a_stroke_follows_the_overlapping_part_that_moves_like_it() {
        let still = Captured { closed: false, contours: (0..=10).map(|f| (f, bar(0.1))).collect() };
        let sequence = drawn(bar(angle(0)), bar(angle(10)), &GivenPegs::default(), vec![still, swing(0..=10)]);
        assert!(off(&sequence) < 1e-6, "{}", off(&sequence));
    }

    #[test]
    fn a_line_on_a_limb_that_comes_back_follows_the_limb_and_not_the_body_behind_it() {
        let body: Vec<Point> = [(-60.0, -80.0), (160.0, -80.0), (160.0, 120.0), (-60.0, 120.0)].map(Point::from).into();
        let still = Captured { closed: true, contours: (0..=10).map(|f| (f, body.clone())).collect() };
        // The tracked limb is half a pixel off the drawing on the later key. The body is not.
        let mut limb = swing(0..=10);
        limb.contours.insert(10, bar(angle(0)).into_iter().map(|p| p + Point::new(0.0, 0.5)).collect());
        let there = || bar(angle(0));
        let sequence = drawn(there(), there(), &GivenPegs::default(), vec![still.clone(), limb.clone()]);
        assert!(off(&sequence) < 1.0, "{}", off(&sequence));
        // A line that goes with the body is not taken by the limb, though it lies on it on the first key.
        limb.contours.insert(10, bar(angle(0) + 0.3));
        let sequence = drawn(there(), there(), &GivenPegs::default(), vec![limb, still]);
        assert!(mean_distance(&sequence.at(5)[0].stroke.points, &there()) < 1e-9);
    }

    #[test]
    fn strokes_without_a_usable_part_move_as_before() {
        let far = |points: Vec<Point>| points.into_iter().map(|p| p + Point::new(300.0, 0.0)).collect::<Vec<_>>();
        let both = |parts: Vec<Captured>, pegs: &GivenPegs, shift: bool| {
            let keys = [0, 10].map(|f| if shift { far(bar(angle(f))) } else { bar(angle(f)) });
            let [a, b] = keys;
            let sequence = drawn(a.clone(), b.clone(), pegs, parts);
            (sequence.at(5), drawn(a, b, pegs, Vec::new()).at(5))
        };
        let none = GivenPegs::default();
        let (got, want) = both(vec![swing(0..=10)], &none, true);
        assert_eq!(got, want, "a part that lies elsewhere");
        let (got, want) = both(vec![swing((0..=10).filter(|&f| f != 7))], &none, false);
        assert_eq!(got, want, "a part that is lost on a frame");
        let (got, want) = both(vec![swing(0..=10), Captured::default()], &none, true);
        assert_eq!(got, want, "a part without contours");
        let keys = vec![PegKey::rest(0), PegKey { shift: Point::new(0.0, 9.0), ..PegKey::rest(10) }];
        let tree = PegTree::new(vec![Peg { name: "own".into(), parent: None, pivot: Point::ZERO, keys }]).unwrap();
        let (got, want) = both(vec![swing(0..=10)], &GivenPegs { tree, of: vec![vec![Some(0)]] }, false);
        assert_eq!(got, want, "a peg that is given says how it moves");
    }

    #[test]
    fn contours_with_a_varying_number_of_points_are_not_followed() {
        let mut part = swing(0..=10);
        part.contours.insert(5, bar(0.0)[..5].to_vec());
        let with = |parts| drawn(bar(angle(0)), bar(angle(10)), &GivenPegs::default(), parts).at(4);
        assert_eq!(with(vec![part]), with(Vec::new()));
    }
}
