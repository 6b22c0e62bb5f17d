//! Contacts between strokes, kept between the keys.
//!
//! A contact is a point of one stroke that is on another stroke on both keys, at about the same place of it. The point
//! must be on that place between the keys too. After all strokes have moved, the gaps that opened are closed. Both
//! strokes give way, the longer one less. The shift is largest at the contact and fades along half of the stroke's
//! length. Several contacts are closed in turn, in a few rounds.

use rayon::prelude::{IntoParallelIterator, IntoParallelRefIterator, ParallelIterator};
use rototoon_base::geometry::{Point, polygon, polyline};
use std::collections::BTreeMap;

/// Largest distance, in pixels on the keys, for the end of an open stroke.
const TOUCHING: f64 = 2.0;
/// Largest distance, in pixels on the keys, for other points of a stroke.
const COINCIDENT: f64 = 0.75;
/// Largest slide of the place on the other stroke from key to key, as a share of its segments.
const SLIDE: f64 = 0.06;
/// Largest number of contacts of two strokes in each direction.
const MOST: usize = 24;
/// Points of one stroke times points of another, up to which all points are examined.
const MOST_TRIED: usize = 1_000_000;
/// Gap, in pixels, that counts as closed.
const CLOSED: f64 = 1e-6;
/// Number of neighbouring segments that share a box.
const CHUNK: usize = 6;
/// Largest number of rounds of closing.
const ROUNDS: usize = 8;
/// Share of a stroke's points along which a shift fades.
const REACH: f64 = 0.5;

/// A stroke on the two keys of a span.
#[derive(Clone, Copy, Debug)]
pub(super) struct Between<'a> {
    /// Its points on the earlier and the later key.
    pub ends: [&'a [Point]; 2],
    pub closed: bool,
}

/// A point of one stroke that stays on another stroke.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Contact {
    a: usize,
    point: usize,
    b: usize,
    /// Segment of the other stroke, and the share along it.
    segment: usize,
    along: f64,
    /// Vector from the place on the other stroke to the point, on both keys.
    gaps: [Point; 2],
}

/// Finds the contacts between strokes.
pub(super) fn find(strokes: &[Between]) -> Vec<Contact> {
    let boxes: Vec<_> = strokes.iter().map(|s| polygon::bounds(s.ends[0])).collect();
    let mut order: Vec<usize> = (0..strokes.len()).filter(|&i| boxes[i].is_some()).collect();
    let low = |i: usize| boxes[i].map_or(0.0, |b| b.0.x);
    order.sort_by(|&i, &j| low(i).total_cmp(&low(j)).then(i.cmp(&j)));
    let mut pairs = Vec::new();
    for (n, &i) in order.iter().enumerate() {
        let Some(own) = boxes[i] else { continue };
        for &j in order[n + 1..].iter().take_while(|&&j| low(j) <= own.1.x + TOUCHING) {
            let Some(other) = boxes[j] else { continue };
            if own.0.y <= other.1.y + TOUCHING && other.0.y <= own.1.y + TOUCHING {
                pairs.push((i.min(j), i.max(j)));
            }
        }
    }
    pairs.sort_unstable();
    let chunks: Vec<Chunks> = strokes.par_iter().map(|stroke| Chunks::new(stroke.ends[0], stroke.closed)).collect();
    let found: Vec<Vec<Contact>> = pairs.into_par_iter().map(|(i, j)| of_pair(strokes, &chunks, i, j)).collect();
    found.concat()
}

/// Boxes around runs of a line's segments. They exclude distant lines quickly.
struct Chunks(Vec<(Point, Point)>);

impl Chunks {
    fn new(points: &[Point], closed: bool) -> Self {
        let segments: Vec<(Point, Point)> = polyline::segments(points, closed).collect();
        let bounds = |run: &[(Point, Point)]| {
            run.iter().fold((run[0].0, run[0].0), |(low, high), (a, b)| (low.min(*a).min(*b), high.max(*a).max(*b)))
        };
        Self(segments.chunks(CHUNK).map(bounds).collect())
    }

    /// Whether part of the line may be within a distance of a point.
    fn near(&self, p: Point, distance: f64) -> bool {
        self.0.is_empty()
            || self.0.iter().any(|(low, high)| p.distance_squared(p.clamp(*low, *high)) <= distance * distance)
    }
}

fn of_pair(strokes: &[Between], chunks: &[Chunks], i: usize, j: usize) -> Vec<Contact> {
    let mut found = Vec::new();
    for (a, b) in [(i, j), (j, i)] {
        let n = strokes[a].ends[0].len();
        let step = (n * strokes[b].ends[0].len() / MOST_TRIED).max(1);
        let tried = (0..n).step_by(step).chain((step > 1).then_some(n - 1));
        let mut own: Vec<Contact> = tried.filter_map(|point| contact(strokes, &chunks[b], a, point, b)).collect();
        if own.len() > MOST {
            let step = own.len().div_ceil(MOST);
            own = own.into_iter().step_by(step).collect();
        }
        found.extend(own);
    }
    found
}

fn contact(strokes: &[Between], chunks: &Chunks, a: usize, point: usize, b: usize) -> Option<Contact> {
    let (own, other) = (&strokes[a], &strokes[b]);
    let end = !own.closed && (point == 0 || point + 1 == own.ends[0].len());
    let tolerance = if end { TOUCHING } else { COINCIDENT };
    if !chunks.near(own.ends[0][point], tolerance) {
        return None;
    }
    let near = |key: usize| {
        let p = own.ends[key][point];
        let within = |q: &Point| p.distance(*q) <= tolerance;
        nearest(p, other.ends[key], other.closed).filter(|(_, _, q)| within(q))
    };
    let (first, last) = (near(0)?, near(1)?);
    let count = (other.ends[0].len() - usize::from(!other.closed)).max(1) as f64;
    let slid = (last.0 as f64 + last.1 - first.0 as f64 - first.1).abs();
    let slid = if other.closed { slid.min(count - slid) } else { slid };
    if slid > (SLIDE * count).max(1.0) {
        return None;
    }
    // The place on the other stroke is the same on both keys.
    let on = |key: usize| place(other.ends[key], first.0, first.1);
    let gaps = [0, 1].map(|key| own.ends[key][point] - on(key));
    (gaps[1].length() <= 2.0 * tolerance).then_some(Contact { a, point, b, segment: first.0, along: first.1, gaps })
}

/// The place of a line nearest to a point: segment, share along it, and position.
fn nearest(p: Point, points: &[Point], closed: bool) -> Option<(usize, f64, Point)> {
    if let [only] = points {
        return Some((0, 0.0, *only));
    }
    let mut best: Option<(f64, usize, f64, Point)> = None;
    for (k, (a, b)) in polyline::segments(points, closed).enumerate() {
        let q = polyline::nearest_on_segment(p, a, b);
        let d = p.distance_squared(q);
        if best.is_none_or(|(least, ..)| d < least) {
            let length = a.distance(b);
            best = Some((d, k, if length > 0.0 { a.distance(q) / length } else { 0.0 }, q));
        }
    }
    best.map(|(_, k, along, q)| (k, along, q))
}

fn place(points: &[Point], segment: usize, along: f64) -> Point {
    points[segment].lerp(points[(segment + 1) % points.len()], along)
}

/// Closes the gaps of contacts at a share of the span. `points` is by stroke.
pub(super) fn close(contacts: &[Contact], points: &mut [Vec<Point>], closed: &[bool], s: f64) {
    if contacts.is_empty() {
        return;
    }
    let mut falls: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
    for contact in contacts {
        for n in [points[contact.a].len(), points[contact.b].len()] {
            falls.entry(n).or_insert_with(|| fall(n));
        }
    }
    let lengths: Vec<f64> = points.iter().zip(closed).map(|(p, &c)| polyline::length(p, c)).collect();
    for _ in 0..ROUNDS {
        let mut worst = 0.0f64;
        for contact in contacts {
            let on = place(&points[contact.b], contact.segment, contact.along);
            let off = on + contact.gaps[0].lerp(contact.gaps[1], s) - points[contact.a][contact.point];
            if off.length_squared() < CLOSED * CLOSED {
                continue;
            }
            worst = worst.max(off.length());
            let total = (lengths[contact.a] + lengths[contact.b]).max(1e-9);
            let share = lengths[contact.b] / total;
            for (stroke, at, shift) in
                [(contact.a, contact.point, off * share), (contact.b, contact.segment, -off * (1.0 - share))]
            {
                let fall = &falls[&points[stroke].len()];
                give_way(&mut points[stroke], closed[stroke], at, shift, fall);
            }
        }
        if worst < 0.01 {
            break;
        }
    }
}

/// The share of a shift by the number of points away from the contact: half a cosine wave.
fn fall(n: usize) -> Vec<f64> {
    let reach = (REACH * n as f64).max(1.0);
    let share = |apart: usize| 0.5 + 0.5 * (std::f64::consts::PI * apart as f64 / reach).cos();
    (0..n).take_while(|&apart| (apart as f64) < reach).map(share).collect()
}

/// Shifts a stroke at one of its points, and less and less along it.
fn give_way(points: &mut [Point], closed: bool, at: usize, shift: Point, fall: &[f64]) {
    let n = points.len();
    for (apart, &share) in fall.iter().enumerate() {
        let (before, after) = (at.checked_sub(apart), Some(at + apart).filter(|&k| k < n));
        let round = |k: Option<usize>, other: usize| if closed { Some(k.unwrap_or(other % n)) } else { k };
        let (before, after) = (round(before, at + n - apart), round(after, at + apart));
        if let Some(k) = before {
            points[k] += shift * share;
        }
        if let Some(k) = after.filter(|_| after != before) {
            points[k] += shift * share;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_end_stays_on_the_line_that_it_touches() {
        let line = |y: f64| (0..11).map(|k| Point::new(k as f64 * 10.0, y)).collect::<Vec<_>>();
        let stem = |x: f64, y: f64| (0..6).map(|k| Point::new(x, y - k as f64 * 8.0)).collect::<Vec<_>>();
        let (a0, a1, b0, b1) = (line(0.0), line(30.0), stem(53.0, 0.5), stem(53.0, 31.0));
        let strokes = [Between { ends: [&a0, &a1], closed: false }, Between { ends: [&b0, &b1], closed: false }];
        let contacts = find(&strokes);
        assert_eq!(contacts.len(), 1, "{contacts:?}");
        let mut points = vec![line(12.0), stem(49.0, 20.0)];
        close(&contacts, &mut points, &[false, false], 0.5);
        let gap = points[1][0] - place(&points[0], 5, 0.3);
        assert!(gap.distance(Point::new(0.0, 0.75)) < 0.05, "{gap}");
        assert!(points[1][5].distance(Point::new(49.0, -20.0)) < 1e-9, "the far end stays");
    }

    #[test]
    fn strokes_that_part_are_no_contact() {
        let a = [Point::ZERO, Point::new(10.0, 0.0)];
        let b = [Point::new(5.0, 0.5), Point::new(5.0, 9.0)];
        let away = b.map(|p| p + Point::new(0.0, 8.0));
        let strokes = [Between { ends: [&a, &a], closed: false }, Between { ends: [&b, &away], closed: false }];
        assert!(find(&strokes).is_empty());
    }
}
