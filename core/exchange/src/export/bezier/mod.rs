//! Snapped contours as Bézier curves of few points, which are the same points on every frame.
//!
//! The points are the part's control points. Each segment between two of them becomes one cubic ([`cubic`]). If on some frame no cubic
//! is within the tolerance of the path, the segment is cut into more pieces, of equal length along the path and as many on all frames. So
//! an artist edits the points that he tracked, and a few more where a path is too winding for them. Where a contour runs smoothly through a
//! point, both handles lie on one line ([`joints`]). Straight pieces have no handles.
//!
//! **The bound.** On every frame the curve is within the tolerance of the path, in both directions, unless a segment needs more than
//! [`MOST_PIECES`] pieces. Then it has as many, and each is as near as its cubic comes.
//!
//! **Why so.** A fitter that chooses its points on each frame, such as that of `kurbo`, gives each frame other points: there is nothing that goes
//! from frame to frame. Here the number is what the worst frame needs.
//!
//! **Limits.** A corner of a path between two control points has no point of its own unless a cut happens to fall on it. The pieces around it
//! become short instead. A control point there costs less.

mod cubic;
mod joints;

use super::knot::Knot;
use cubic::{End, Fitted, fit};
use joints::{Joint, is_smooth};
use rototoon_base::geometry::{Point, polyline};
use rototoon_base::scene::{FrameNumber, Part};
use std::collections::BTreeMap;

/// Greatest number of pieces of one segment.
pub const MOST_PIECES: usize = 64;

/// The snapped contours of a part as Bézier curves.
#[derive(Clone, Debug)]
pub(super) struct Curves {
    /// Number of pieces of each segment.
    counts: Vec<usize>,
    /// The knots of each frame with a snapped contour.
    knots: BTreeMap<FrameNumber, Vec<Knot>>,
}

/// The path of each segment, from its point to the next one.
type Paths = Vec<Vec<Point>>;

impl Curves {
    /// The curves of a part within `tolerance` pixels of its snapped paths; `None` if it has none. `points` gives its control points on a
    /// frame.
    pub fn new<'a>(
        part: &Part,
        tolerance: f64,
        points: impl Fn(FrameNumber) -> Option<&'a Vec<Point>>,
    ) -> Option<Self> {
        let paths = part.curves.keys().filter_map(|&frame| {
            let (paths, points) = (part.complete_curves(frame)?, points(frame)?);
            Some((frame, joined(paths, points, part.closed)))
        });
        let frames: BTreeMap<FrameNumber, Paths> = paths.collect();
        let segments = frames.values().next()?.len();
        let mut made: BTreeMap<FrameNumber, Vec<Knot>> = frames.keys().map(|frame| (*frame, Vec::new())).collect();
        let mut counts = Vec::with_capacity(segments);
        let ends = ends(&frames, &smooth_points(&frames, segments, part.closed), tolerance);
        for segment in 0..segments {
            let segment = Segment::new(&frames, segment, &ends);
            let (count, cubics) = segment.fitted(tolerance);
            counts.push(count);
            for ((knots, cubics), paths) in made.values_mut().zip(cubics).zip(frames.values()) {
                append(knots, &cut(&paths[segment.index], count), &cubics);
            }
        }
        for (knots, paths) in made.values_mut().zip(frames.values()) {
            finish(knots, paths, part.closed);
        }
        Some(Self { counts, knots: made })
    }

    /// The knots on a frame. A frame without a snapped contour has straight sides between its points.
    pub fn at(&self, frame: FrameNumber, points: &[Point], closed: bool) -> Vec<Knot> {
        if let Some(knots) = self.knots.get(&frame) {
            return knots.clone();
        }
        let mut knots = Vec::new();
        for (i, &count) in self.counts.iter().enumerate().take(points.len()) {
            let (from, to) = (points[i], points[(i + 1) % points.len()]);
            knots.extend((0..count).map(|k| Knot::bare(from.lerp(to, k as f64 / count as f64))));
        }
        if !closed {
            knots.extend(points.last().copied().map(Knot::bare));
        }
        knots
    }
}

/// Paths of which each ends where the next one begins. The last one of an open contour ends at the last point.
fn joined(paths: &[Vec<Point>], points: &[Point], closed: bool) -> Paths {
    let end = if closed { paths[0][0] } else { points[points.len() - 1] };
    let ends = paths[1..].iter().map(|path| path[0]).chain([end]);
    let join = |(path, end): (&Vec<Point>, Point)| {
        let mut path = path.clone();
        if path[path.len() - 1] != end {
            path.push(end);
        }
        path
    };
    paths.iter().zip(ends).map(join).collect()
}

/// Whether each control point at which a path begins is smooth. The ends of an open contour are not.
fn smooth_points(frames: &BTreeMap<FrameNumber, Paths>, segments: usize, closed: bool) -> Vec<bool> {
    let smooth = |point: usize| {
        let before = (point + segments - 1) % segments;
        is_smooth(frames.values().map(|paths| Joint::new(&paths[before], &paths[point])))
    };
    (0..segments).map(|point| (closed || point > 0) && smooth(point)).collect()
}

/// What is known of the handles before and after each control point at which a path begins, on each frame. The last point of an open contour has none
/// after it, and is as its first point: nothing is known of it.
fn ends(frames: &BTreeMap<FrameNumber, Paths>, smooth: &[bool], tolerance: f64) -> Vec<Vec<[End; 2]>> {
    let on = |paths: &Paths, point: usize| {
        let n = paths.len();
        Joint::new(&paths[(point + n - 1) % n], &paths[point]).ends(smooth[point], tolerance)
    };
    (0..smooth.len()).map(|point| frames.values().map(|paths| on(paths, point)).collect()).collect()
}

/// One segment on all frames.
struct Segment<'a> {
    index: usize,
    paths: Vec<&'a [Point]>,
    /// What is known of the handles at its two ends on each frame.
    ends: Vec<[End; 2]>,
}

impl<'a> Segment<'a> {
    fn new(frames: &'a BTreeMap<FrameNumber, Paths>, index: usize, ends: &[Vec<[End; 2]>]) -> Self {
        let paths = frames.values().map(|paths| &paths[index][..]).collect();
        let [first, last] = [&ends[index], &ends[(index + 1) % ends.len()]];
        Self { index, paths, ends: first.iter().zip(last).map(|(first, last)| [first[1], last[0]]).collect() }
    }

    /// The least number of pieces with which all frames are within the tolerance, and the cubics of each frame.
    fn fitted(&self, tolerance: f64) -> (usize, Vec<Vec<Fitted>>) {
        let (mut count, mut worst) = (1, 0);
        loop {
            let pieces: Vec<Paths> = self.paths.iter().map(|path| cut(path, count)).collect();
            let smooth: Vec<bool> =
                (1..count).map(|k| is_smooth(pieces.iter().map(|own| Joint::new(&own[k - 1], &own[k])))).collect();
            let last = count >= MOST_PIECES;
            let of = |frame: usize| cubics(&pieces[frame], self.ends[frame], &smooth, tolerance, last);
            // A frame that was too winding before most likely still is.
            if of(worst).is_some() {
                let all: Vec<Vec<Fitted>> = (0..pieces.len()).map_while(of).collect();
                if all.len() == pieces.len() {
                    return (count, all);
                }
                worst = all.len();
            }
            count = (count + 1 + count / 8).min(MOST_PIECES);
        }
    }
}

/// The cubics of the pieces of a segment on one frame; `None` if one is not within the tolerance, unless these are the `last` pieces that are tried.
fn cubics(pieces: &Paths, ends: [End; 2], smooth: &[bool], tolerance: f64, last: bool) -> Option<Vec<Fitted>> {
    let mut found = Vec::with_capacity(pieces.len());
    let mut start = ends[0];
    for (k, piece) in pieces.iter().enumerate() {
        let own = pieces.get(k + 1).map(|after| Joint::new(piece, after).ends(smooth[k], tolerance));
        let [end, next] = own.unwrap_or([ends[1]; 2]);
        let cubic = fit(piece, [start, end], tolerance);
        // Most numbers of pieces are too few, and the first piece that is too far says so.
        if !last && (cubic.error.is_nan() || cubic.error > tolerance) {
            return None;
        }
        found.push(cubic);
        start = next;
    }
    Some(found)
}

/// A path as pieces of equal length.
fn cut(path: &[Point], count: usize) -> Paths {
    let total = polyline::length(path, false);
    let mut pieces: Paths = vec![vec![path[0]]];
    let mut walked = 0.0;
    for (a, b) in polyline::segments(path, false) {
        let length = a.distance(b);
        while pieces.len() < count {
            let at = total * pieces.len() as f64 / count as f64;
            if length == 0.0 || at > walked + length {
                break;
            }
            let p = a.lerp(b, ((at - walked) / length).clamp(0.0, 1.0));
            put(&mut pieces, p);
            pieces.push(vec![p]);
        }
        put(&mut pieces, b);
        walked += length;
    }
    // A path without length, or a last cut that rounding put behind the end.
    while pieces.len() < count {
        pieces.push(vec![path[path.len() - 1]]);
    }
    pieces
}

/// Adds a point to the last piece.
fn put(pieces: &mut Paths, p: Point) {
    if let Some(piece) = pieces.last_mut()
        && piece.last() != Some(&p)
    {
        piece.push(p);
    }
}

/// Adds the pieces of a segment to the knots before them. The handle before the end of each piece waits in the next knot.
fn append(knots: &mut Vec<Knot>, pieces: &Paths, cubics: &[Fitted]) {
    for (piece, cubic) in pieces.iter().zip(cubics) {
        let [after, before] = cubic.handles;
        match knots.last_mut() {
            Some(knot) => (knot.at, knot.after) = (piece[0], after),
            None => knots.push(Knot { after, ..Knot::bare(piece[0]) }),
        }
        knots.push(Knot { before, ..Knot::bare(piece[piece.len() - 1]) });
    }
}

/// Makes the last knot of a closed contour one with the first.
fn finish(knots: &mut Vec<Knot>, paths: &Paths, closed: bool) {
    if closed
        && !paths.is_empty()
        && let (Some(last), Some(first)) = (knots.pop(), knots.first_mut())
    {
        first.before = last.before;
    }
}

#[cfg(test)]
mod tests;
