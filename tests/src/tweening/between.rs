//! Measures the errors of in-betweens, compared with linear interpolation of the same points.
//!
//! Keys are frames of a set at equal distances, beginning with every possible first frame. In-betweens are compared with the
//! true frames. Every contour has the same points on all frames, and both methods get the correct pairs.
//!
//! [`measure_places`] measures where the points of a contour are found on the next key, if that is drawn with other points.

use super::{Contours, Set};
use anyhow::{Context, Result};
use rototoon::geometry::{Point, polyline};
use rototoon::tween::Stroke;
use rototoon::tween::between::{GivenPegs, InBetween, Key, Options, Sequence, Spacing};
use rototoon::tween::matching::{Matching, Pair};

/// Least root mean square distance in pixels from key to key of a contour that moves.
const LEAST_WAY: f64 = 5.0;

/// Sums of distances in pixels from the true points.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// Number of points.
    pub count: usize,
    /// Of linear interpolation.
    pub linear: f64,
    /// Of linear interpolation with its best spacing chart.
    pub linear_charted: f64,
    /// Of Rototoon.
    pub ours: f64,
    /// Of Rototoon with its best spacing chart.
    pub ours_charted: f64,
}

impl Errors {
    /// Adds other sums.
    pub fn add(&mut self, other: Self) {
        self.count += other.count;
        self.linear += other.linear;
        self.linear_charted += other.linear_charted;
        self.ours += other.ours;
        self.ours_charted += other.ours_charted;
    }
}

/// The shares of the way that a chart may give a frame.
fn shares() -> impl Iterator<Item = f64> {
    (-10..=50).map(|k| f64::from(k) / 40.0)
}

/// The keys of a set as drawings, with only the parts that every key has.
pub(super) fn drawings(set: &Set, frames: &[i32]) -> (Vec<usize>, Vec<Key>) {
    let there = |i: &usize| frames.iter().all(|f| set.parts[*i].points.contains_key(f));
    let parts: Vec<usize> = (0..set.parts.len()).filter(there).collect();
    let stroke = |i: usize, f: i32| Stroke::new(set.parts[i].points[&f].clone(), set.parts[i].closed);
    let key =
        |&frame: &i32| Key { frame, strokes: parts.iter().map(|&i| stroke(i, frame)).collect(), ..Key::default() };
    let keys = frames.iter().map(key).collect();
    (parts, keys)
}

fn paired(count: usize, spans: usize) -> Vec<Matching> {
    let pair = |i| Pair { from: i, to: i, reversed: false, start: 0.0, confidence: 1.0, by_hand: true };
    vec![Matching { pairs: (0..count).map(pair).collect(), ..Matching::default() }; spans]
}

pub(super) fn off(drawn: &[Vec<Point>], truth: &[&Vec<Point>]) -> f64 {
    let stroke = |(a, b): (&Vec<Point>, &&Vec<Point>)| a.iter().zip(b.iter()).map(|(p, q)| p.distance(*q)).sum::<f64>();
    drawn.iter().zip(truth).map(stroke).sum()
}

/// Sums of distances in pixels from the true positions.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlaceErrors {
    /// Number of points.
    pub count: usize,
    /// Of positions at the same share of the length.
    pub plain: f64,
    /// Of Rototoon's positions.
    pub ours: f64,
    /// Contours on which Rototoon is better by more than a hundredth of a pixel per point.
    pub better: usize,
    /// Contours on which Rototoon is worse by more than a hundredth of a pixel per point.
    pub worse: usize,
}

/// Measures where the points of contours are found on the second of two frames. The second frame has twice as many points on
/// the same lines.
pub fn measure_places(set: &Set, (first, second): (i32, i32)) -> Result<PlaceErrors> {
    let (parts, mut keys) = drawings(set, &[first, second]);
    for stroke in &mut keys[1].strokes {
        stroke.points = halved(&stroke.points, stroke.closed);
    }
    let plain: Vec<Vec<Point>> = keys[0].strokes.iter().zip(&keys[1].strokes).map(|(a, b)| by_length(a, b)).collect();
    let sequence = Sequence::new(keys, &paired(parts.len(), 1), &GivenPegs::default(), &Options::default())?;
    let mut errors = PlaceErrors::default();
    for (k, &part) in parts.iter().enumerate() {
        let truth = &set.parts[part].points[&second];
        let found = sequence.tracks().iter().find(|track| track.at(0).is_some_and(|stand| stand.stroke == k));
        let Some(stand) = found.and_then(|track| track.at(1)) else { continue };
        let off = |points: &[Point]| points.iter().zip(truth).map(|(p, q)| p.distance(*q)).sum::<f64>();
        let (by_length, ours) = (off(&plain[k]), off(&stand.places.points));
        errors.count += truth.len();
        errors.plain += by_length;
        errors.ours += ours;
        errors.better += usize::from(ours < by_length - 0.01 * truth.len() as f64);
        errors.worse += usize::from(ours > by_length + 0.01 * truth.len() as f64);
    }
    Ok(errors)
}

/// The same line with one more point on each segment, not in its middle.
fn halved(points: &[Point], closed: bool) -> Vec<Point> {
    let last = (!closed).then(|| points.last().copied()).flatten();
    polyline::segments(points, closed).flat_map(|(a, b)| [a, a.lerp(b, 0.37)]).chain(last).collect()
}

/// For each point of a stroke the point of the other stroke at the same share of the length.
fn by_length(stroke: &Stroke, other: &Stroke) -> Vec<Point> {
    let walked = |of: &Stroke| {
        let mut walked = vec![0.0];
        for (a, b) in polyline::segments(&of.points, of.closed) {
            walked.push(walked[walked.len() - 1] + a.distance(b));
        }
        walked
    };
    let (from, to) = (walked(stroke), walked(other));
    let scale = to[to.len() - 1] / from[from.len() - 1].max(f64::MIN_POSITIVE);
    let at = |k: usize| {
        let place = from[k] * scale;
        let next = to.partition_point(|&w| w <= place).clamp(1, to.len() - 1);
        let within = (place - to[next - 1]) / (to[next] - to[next - 1]).max(f64::MIN_POSITIVE);
        other.points[next - 1].lerp(other.points[next % other.points.len()], within.clamp(0.0, 1.0))
    };
    (0..stroke.points.len()).map(at).collect()
}

/// The in-betweens of a set's keys.
pub fn sequence(set: &Set, frames: &[i32], options: &Options) -> Result<(Vec<usize>, Sequence)> {
    let (parts, keys) = drawings(set, frames);
    let matchings = paired(parts.len(), frames.len() - 1);
    Ok((parts, Sequence::new(keys, &matchings, &GivenPegs::default(), options)?))
}

/// The errors of the strokes that move in one direction between keys. Each stroke has its best chart, so these errors are
/// only those of path and shape.
pub fn measure_one_way(set: &Set, frames: &[i32], options: &Options) -> Result<Errors> {
    let (parts, ours) = sequence(set, frames, options)?;
    let mut errors = Errors::default();
    for pair in frames.windows(2) {
        let (_, keys) = drawings(set, pair);
        let charted = Charted::new(&keys, options)?;
        let moving: Vec<usize> =
            (0..parts.len()).filter(|&n| is_one_way(&set.parts[parts[n]], (pair[0], pair[1]))).collect();
        for frame in pair[0] + 1..pair[1] {
            let drawn = points(ours.at(frame));
            let u = f64::from(frame - pair[0]) / f64::from(pair[1] - pair[0]);
            for &n in &moving {
                let truth = &set.parts[parts[n]].points[&frame];
                let (a, b) = (&keys[0].strokes[n].points, &keys[1].strokes[n].points);
                let off = |line: &[Point]| line.iter().zip(truth).map(|(p, q)| p.distance(*q)).sum::<f64>();
                let linear = |s: f64| off(&a.iter().zip(b).map(|(p, q)| p.lerp(*q, s)).collect::<Vec<_>>());
                errors.count += truth.len();
                errors.linear += linear(u);
                errors.ours += off(&drawn[n]);
                errors.linear_charted += shares().map(linear).fold(f64::INFINITY, f64::min);
                errors.ours_charted += charted.drawings.iter().map(|d| off(&d[n])).fold(f64::INFINITY, f64::min);
            }
        }
    }
    Ok(errors)
}

/// Whether a contour moves from one key to the other without turning back or going beyond the key, by more than a tenth of
/// the way.
fn is_one_way(part: &Contours, (from, to): (i32, i32)) -> bool {
    let (a, b) = (&part.points[&from], &part.points[&to]);
    let square: f64 = a.iter().zip(b).map(|(p, q)| p.distance_squared(*q)).sum();
    if square < LEAST_WAY * LEAST_WAY * a.len() as f64 {
        return false;
    }
    let come = |frame: i32| {
        let now = part.points.get(&frame)?;
        Some(a.iter().zip(b).zip(now).map(|((p, q), r)| (*r - *p).dot(*q - *p)).sum::<f64>() / square)
    };
    let mut farthest = 0.0f64;
    (from + 1..=to).all(|frame| {
        let Some(share) = come(frame) else { return false };
        let forward = share > farthest - 0.1 && share < 1.1;
        farthest = farthest.max(share);
        forward
    })
}

/// The errors of all frames between keys, with strokes that follow captured parts, if [`Set::capture`] was called. Charts are
/// not measured.
pub fn measure_captured(set: &Set, frames: &[i32], options: &Options) -> Result<Errors> {
    let (parts, sequence) = sequence(set, frames, options)?;
    let sequence = sequence.following(set.captured.clone());
    let mut errors = Errors::default();
    for pair in frames.windows(2) {
        for frame in pair[0] + 1..pair[1] {
            let u = f64::from(frame - pair[0]) / f64::from(pair[1] - pair[0]);
            for (drawn, &part) in points(sequence.at(frame)).iter().zip(&parts) {
                let of = &set.parts[part].points;
                let Some(truth) = of.get(&frame) else { continue };
                let linear: Vec<Point> = of[&pair[0]].iter().zip(&of[&pair[1]]).map(|(p, q)| p.lerp(*q, u)).collect();
                errors.count += truth.len();
                errors.linear += off(&[linear], &[truth]);
                errors.ours += off(std::slice::from_ref(drawn), &[truth]);
            }
        }
    }
    Ok(errors)
}

/// The errors of all frames between keys.
pub fn measure(set: &Set, frames: &[i32], options: &Options) -> Result<Errors> {
    let (parts, ours) = sequence(set, frames, options)?;
    let mut errors = Errors::default();
    for pair in frames.windows(2) {
        let (_, keys) = drawings(set, pair);
        let charted = Charted::new(&keys, options)?;
        for frame in pair[0] + 1..pair[1] {
            let truth: Option<Vec<&Vec<Point>>> = parts.iter().map(|&i| set.parts[i].points.get(&frame)).collect();
            let Some(truth) = truth else { continue };
            let u = f64::from(frame - pair[0]) / f64::from(pair[1] - pair[0]);
            let linear = |s: f64| -> Vec<Vec<Point>> {
                let strokes = keys[0].strokes.iter().zip(&keys[1].strokes);
                strokes.map(|(a, b)| a.points.iter().zip(&b.points).map(|(p, q)| p.lerp(*q, s)).collect()).collect()
            };
            errors.count += truth.iter().map(|p| p.len()).sum::<usize>();
            errors.linear += off(&linear(u), &truth);
            errors.linear_charted += shares().map(|s| off(&linear(s), &truth)).fold(f64::INFINITY, f64::min);
            errors.ours += off(&points(ours.at(frame)), &truth);
            errors.ours_charted += charted.drawings.iter().map(|d| off(d, &truth)).fold(f64::INFINITY, f64::min);
        }
    }
    Ok(errors)
}

/// The points of in-betweens, ordered by track.
pub(super) fn points(drawn: Vec<InBetween>) -> Vec<Vec<Point>> {
    let mut drawn = drawn;
    drawn.sort_by_key(|d| d.track);
    drawn.into_iter().map(|d| d.stroke.points).collect()
}

/// Rototoon's in-betweens of two keys at every share that a chart may give.
struct Charted {
    drawings: Vec<Vec<Vec<Point>>>,
}

impl Charted {
    fn new(keys: &[Key], options: &Options) -> Result<Self> {
        let chart: Vec<f64> = shares().collect();
        let mut keys = keys.to_vec();
        keys[0].frame = 0;
        keys[1].frame = i32::try_from(chart.len() + 1).context("too many shares")?;
        keys[0].spacing = Spacing::Chart(chart);
        let last = keys[1].frame;
        let matchings = paired(keys[0].strokes.len(), 1);
        let sequence = Sequence::new(keys, &matchings, &GivenPegs::default(), options)?;
        Ok(Self { drawings: (1..last).map(|f| points(sequence.at(f))).collect() })
    }
}

/// Rows of key frames of a set at the distance `gap`, one row for each possible first frame. Rows of one key are left out.
pub fn rows_of_keys(set: &Set, gap: i32) -> Vec<Vec<i32>> {
    let (first, last) = set.frames;
    let row = |start: i32| (start..=last).step_by(gap as usize).collect::<Vec<_>>();
    (first..first + gap).map(row).filter(|row| row.len() > 1).collect()
}
