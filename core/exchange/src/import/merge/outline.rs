//! The outline of a file as control points and paths of a part.
//!
//! **Why.** An export of a snapped part has many points on its paths, and programs for drawing add and delete some. When such an outline was edited on one frame, the
//! part must keep its control points there: they are the same ones on all frames.
//!
//! **How.** The paths of the part begin at joints. A joint that lies on the file's outline is an anchor. Anchors that contradict the order along
//! the outline are dropped: the longest run in order stays. Joints between two anchors are placed by their share of the length between them,
//! so an edit moves only what was edited. Without any anchor the outlines begin at the same point, since programs keep the first point of a shape; an open one ends at the same point too.
//! Control points at anchors, and paths on which all points of the file lie, stay exactly as they are.
//!
//! **Limits.** A joint that was moved lies on the new outline, but nobody says where along it.

use super::compared::Compared;
use super::near::Near;
use rototoon_base::geometry::{Point, polyline};
use rototoon_base::scene::{FrameNumber, Part};

/// Distance from a path within which a point lies on it, in pixels: formats round points, and chords cut a path's bends.
pub(super) const NEAR: f64 = 0.05;
/// Greatest difference in length of outlines that are the same, as a share.
const SHARE: f64 = 0.02;

/// By outlines.
pub(super) struct Outline;

impl Compared for Outline {
    fn is_same(&self, part: &Part, frame: FrameNumber, file: &[Point]) -> bool {
        part.outline(frame).is_some_and(|own| lies_on(file, &own, part.closed))
    }

    fn taken(&self, part: &Part, frame: FrameNumber, file: Vec<Point>) -> (Vec<Point>, Vec<Vec<Point>>) {
        taken(part, frame, &file, |_| None)
    }
}

/// The control points of the outline of a file, and the paths between them. `written` gives the outline that an export writes on a frame, if that is another
/// one than the part's own.
pub(super) fn taken(
    part: &Part,
    frame: FrameNumber,
    file: &[Point],
    written: impl Fn(FrameNumber) -> Option<Vec<Point>>,
) -> (Vec<Point>, Vec<Vec<Point>>) {
    let like = joined(part).min_by_key(|&other| (i64::from(other) - i64::from(frame)).abs());
    let found = like.and_then(|like| Some((part.points_at(like)?, paths(part, like)?, written(like))));
    let Some((points, own, written)) = found else { return (file.to_vec(), Vec::new()) };
    let cut = |line: &[Point]| {
        let line = Line::new(line, part.closed);
        let places = places(&line, &own, points.len());
        let path = |k: usize| line.between(places[k].0, places[(k + 1) % places.len()].0, k + 1 == own.len());
        let paths: Vec<Vec<Point>> = (0..own.len()).map(path).collect();
        (line, places, paths)
    };
    let (line, places, mut paths) = cut(file);
    let written = written.map(|written| cut(&written).2);
    let known = written.as_ref().unwrap_or(&own);
    for (k, path) in paths.iter_mut().enumerate() {
        if places[k].1 && places[(k + 1) % places.len()].1 && lies_on(path, &known[k], false) {
            path.clone_from(&own[k]);
        }
    }
    let kept = |k: usize| if places[k].1 { points[k] } else { line.at(places[k].0) };
    ((0..points.len()).map(kept).collect(), paths)
}

/// Whether a part has a contour whose joints can be found on an outline.
pub(super) fn has_joints(part: &Part) -> bool {
    joined(part).next().is_some()
}

/// The frames with a contour of a part that has as many points as its first one, and at least two. Damaged documents have others.
fn joined(part: &Part) -> impl Iterator<Item = FrameNumber> + '_ {
    let known = || part.keys.keys().chain(part.tracks.keys()).copied();
    let count = known().find_map(|frame| part.points_at(frame)).map_or(0, Vec::len);
    let fits = move |&frame: &FrameNumber| {
        let (points, paths) = (part.points_at(frame), paths(part, frame));
        let segments = if part.closed { count } else { count - 1 };
        points.is_some_and(|points| points.len() == count) && paths.is_some_and(|paths| paths.len() == segments)
    };
    known().filter(move |_| count > 1).filter(fits)
}

/// Whether a line lies on another one along its whole length.
pub(super) fn lies_on(line: &[Point], other: &[Point], closed: bool) -> bool {
    let (length, whole) = (polyline::length(line, closed), polyline::length(other, closed));
    let mut near = Near::new(other, closed);
    (length - whole).abs() <= SHARE * length.max(1.0) && line.iter().all(|&p| near.is_within(p, NEAR))
}

/// The paths of a part on a frame; straight ones between its control points if it has none.
fn paths(part: &Part, frame: FrameNumber) -> Option<Vec<Vec<Point>>> {
    if let Some(own) = part.complete_curves(frame) {
        return Some(own.clone());
    }
    Some(polyline::segments(part.points_at(frame)?, part.closed).map(|(a, b)| vec![a, b]).collect())
}

/// The place of each joint along a line, as a length, and whether it is an anchor.
fn places(line: &Line, own: &[Vec<Point>], count: usize) -> Vec<(f64, bool)> {
    let lengths: Vec<f64> = own.iter().map(|path| polyline::length(path, false)).collect();
    let joint = |k: usize| own.get(k).map_or_else(|| own[own.len() - 1].last(), |path| path.first());
    let starts: Vec<f64> = (0..count).map(|k| lengths[..k.min(own.len())].iter().sum()).collect();
    let on_line = |k: usize| joint(k).and_then(|joint| line.place_of(*joint).map(|place| (k, place)));
    let mut anchors = in_order((0..count).filter_map(on_line).collect(), line);
    let found = anchors.len();
    if anchors.is_empty() {
        anchors.push((0, 0.0));
    }
    if !line.closed {
        // The ends of an open line are those of the part.
        anchors.retain(|(k, _)| *k > 0 && k + 1 < count);
        anchors.insert(0, (0, 0.0));
        anchors.push((count - 1, line.length()));
    }
    let (whole, total) = (lengths.iter().sum::<f64>(), line.length());
    let mut places = vec![(0.0, false); count];
    for (n, &(k, place)) in anchors.iter().enumerate() {
        let exact = found > 0 && joint(k).is_some_and(|joint| joint.distance(line.at(place)) <= NEAR);
        let (to, end) = match anchors.get(n + 1) {
            Some(&next) => next,
            None if line.closed => (anchors[0].0 + count, anchors[0].1 + total),
            None => (k, place),
        };
        places[k] = (place, exact);
        let start = |j: usize| if j < count { starts[j] } else { starts[j - count] + whole };
        let way = start(to) - start(k);
        for j in k + 1..to {
            let share = if way > 0.0 { (start(j) - start(k)) / way } else { 0.0 };
            places[j % count] = (place + share * (end - place), false);
        }
    }
    places
}

/// The anchors that lie in order along a line. Those of a closed line may go on from its start, where their places are greater by its length.
fn in_order(mut anchors: Vec<(usize, f64)>, line: &Line) -> Vec<(usize, f64)> {
    if line.closed
        && let Some(&(_, first)) = anchors.first()
    {
        // Just before the first one is nearly all the way round, but for rounding.
        anchors.iter_mut().filter(|(_, place)| *place < first - NEAR).for_each(|(_, place)| *place += line.length());
    }
    let mut best: Vec<(usize, Option<usize>)> = Vec::with_capacity(anchors.len());
    for (n, (_, place)) in anchors.iter().enumerate() {
        let before = (0..n).filter(|&m| anchors[m].1 <= *place).max_by_key(|&m| best[m].0);
        best.push((before.map_or(1, |m| best[m].0 + 1), before));
    }
    let mut at = (0..anchors.len()).max_by_key(|&n| best[n].0);
    let mut run = Vec::new();
    while let Some(n) = at {
        run.push(anchors[n]);
        at = best[n].1;
    }
    run.reverse();
    run
}

/// A polyline with the length up to each of its points.
struct Line {
    /// A closed one ends with its first point.
    points: Vec<Point>,
    lengths: Vec<f64>,
    closed: bool,
}

impl Line {
    fn new(points: &[Point], closed: bool) -> Self {
        let mut points = points.to_vec();
        if closed {
            points.extend(points.first().copied());
        }
        let mut length = 0.0;
        let steps = points.windows(2).map(|pair| {
            length += pair[0].distance(pair[1]);
            length
        });
        let lengths = std::iter::once(0.0).chain(steps).collect();
        Self { points, lengths, closed }
    }

    fn length(&self) -> f64 {
        self.lengths.last().copied().unwrap_or(0.0)
    }

    /// Where a point lies on the line, as a length; `None` if it does not.
    fn place_of(&self, p: Point) -> Option<f64> {
        let pairs = self.points.windows(2).zip(&self.lengths).map(|(pair, start)| {
            let foot = polyline::nearest_on_segment(p, pair[0], pair[1]);
            (foot.distance(p), start + foot.distance(pair[0]))
        });
        pairs.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|(distance, _)| *distance <= NEAR).map(|(_, place)| place)
    }

    /// The place, within one round.
    fn once(&self, place: f64) -> f64 {
        let length = self.length();
        if self.closed && length > 0.0 && place > length { place - length } else { place }
    }

    /// The point at a length.
    fn at(&self, place: f64) -> Point {
        let place = self.once(place);
        let k = self.lengths.partition_point(|length| *length <= place).clamp(1, self.points.len().max(2) - 1);
        let Some(&[a, b]) = self.points.get(k - 1..=k) else { return self.points[0] };
        let step = self.lengths[k] - self.lengths[k - 1];
        if step > 0.0 { a.lerp(b, ((place - self.lengths[k - 1]) / step).clamp(0.0, 1.0)) } else { a }
    }

    /// The line from one place to another. The last path of a closed line may go round to its start.
    fn between(&self, from: f64, to: f64, last: bool) -> Vec<Point> {
        let (from, mut to) = (self.once(from), self.once(to));
        if self.closed && (to < from || last && to == from) {
            to += self.length();
        }
        let round = |lap: f64| self.points.iter().zip(&self.lengths).map(move |(p, length)| (*p, length + lap));
        let laps = round(0.0).chain(round(self.length()).skip(1));
        let mut path = vec![self.at(from)];
        path.extend(laps.filter(|(_, length)| from < *length && *length < to).map(|(p, _)| p));
        path.push(self.at(to));
        path
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    /// A square of side 40 with a bulge between its first two control points.
    fn snapped(closed: bool) -> Part {
        let points = [(0.0, 0.0), (40.0, 0.0), (40.0, 40.0), (0.0, 40.0)].map(Point::from).to_vec();
        let mut paths: Vec<Vec<Point>> = polyline::segments(&points, closed).map(|(a, b)| vec![a, b]).collect();
        paths[0].insert(1, Point::new(20.0, -6.0));
        Part {
            closed,
            keys: BTreeMap::from([(3, points.clone())]),
            tracks: BTreeMap::from([(3, points)]),
            curves: BTreeMap::from([(3, paths)]),
            ..Part::default()
        }
    }

    /// The outline of the part with a point every two pixels, which begins with the joint `first`.
    fn exported(part: &Part, first: usize) -> Vec<Point> {
        let mut paths = part.curves[&3].clone();
        paths.rotate_left(first);
        let mut all: Vec<Point> =
            paths.iter().flat_map(|path| polyline::resample(path, false, 21)[..20].to_vec()).collect();
        if !part.closed {
            all.extend(paths.last().and_then(|path| path.last()));
        }
        all
    }

    #[test]
    fn what_was_not_edited_stays_exactly() {
        for closed in [false, true] {
            let part = snapped(closed);
            for first in 0..if closed { 4 } else { 1 } {
                let file = exported(&part, first);
                assert!(Outline.is_same(&part, 3, &file));
                let (points, paths) = Outline.taken(&part, 3, file);
                assert_eq!((&points, &paths), (&part.tracks[&3], &part.curves[&3]), "{closed} {first}");
            }
        }
    }

    #[test]
    fn an_edit_between_two_joints_changes_their_path_alone() {
        for closed in [false, true] {
            let part = snapped(closed);
            let mut file = exported(&part, 0);
            let p = file.iter().position(|p| p.distance(Point::new(40.0, 20.0)) < 1e-9).unwrap();
            file[p].x += 9.0;
            // Programs for drawing take points out too.
            file.remove(p + 3);
            assert!(!Outline.is_same(&part, 3, &file));
            let (points, paths) = Outline.taken(&part, 3, file);
            assert_eq!(points, part.tracks[&3]);
            let own = &part.curves[&3];
            assert_eq!((&paths[0], &paths[2..]), (&own[0], &own[2..]));
            assert!(paths[1].contains(&Point::new(49.0, 20.0)));
            assert_eq!((paths[1].first(), paths[1].last()), (points.get(1), points.get(2)));
        }
    }

    #[test]
    fn a_joint_that_was_moved_goes_along_and_its_neighbours_stay() {
        let part = snapped(true);
        let mut file = exported(&part, 0);
        for p in &mut file {
            let far = 1.0 - p.distance(Point::new(40.0, 40.0)) / 12.0;
            *p += Point::new(8.0, 8.0) * far.max(0.0);
        }
        let (points, paths) = Outline.taken(&part, 3, file);
        assert!(points[2].distance(Point::new(48.0, 48.0)) < 0.5, "{:?}", points[2]);
        assert_eq!([points[0], points[1], points[3]], [0, 1, 3].map(|k| part.tracks[&3][k]));
        assert_eq!((&paths[0], &paths[3]), (&part.curves[&3][0], &part.curves[&3][3]));
        assert_eq!(paths[1].last(), paths[2].first());
    }

    #[test]
    fn an_outline_that_was_moved_as_a_whole_begins_where_it_did() {
        for closed in [false, true] {
            let part = snapped(closed);
            let by = Point::new(100.0, 30.0);
            let file = exported(&part, 0).into_iter().map(|p| p + by).collect();
            let (points, paths) = Outline.taken(&part, 3, file);
            for (p, own) in points.iter().zip(&part.tracks[&3]) {
                assert!(p.distance(*own + by) < 1e-9, "{p} {own}");
            }
            assert_eq!(paths.len(), part.curves[&3].len());
            assert!(
                paths
                    .iter()
                    .zip(&part.curves[&3])
                    .all(|(path, own)| { (polyline::length(path, false) - polyline::length(own, false)).abs() < 1e-9 })
            );
        }
    }

    #[test]
    fn a_hidden_frame_takes_the_joints_of_the_nearest_one() {
        let part = snapped(true);
        let (points, _) = Outline.taken(&part, 9, exported(&part, 0));
        assert_eq!(points, part.tracks[&3]);
    }
}
