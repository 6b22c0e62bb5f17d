//! Contours between frames, for motion blur and for times between frames.
//!
//! Control points move along arcs: each coordinate follows the Catmull–Rom cubic through the surrounding frames. A
//! swinging arm therefore stays on its arc and does not take the chord. A snapped path moves with its segment. The
//! similarity that maps the ends of the segment on the path's frame to the ends at the given time carries the path.
//! This is done from both neighbouring frames, and the two results are blended point by point at equal shares of their
//! lengths.
//!
//! Limits: if the number of control points differs between the neighbouring frames, the nearest frame is used.
//!
//! Source: E. Catmull, R. Rom: A class of local interpolating splines. Computer Aided Geometric Design, 1974.

use super::coverage::MOST_INSTANTS;
use rototoon_base::geometry::{Point, polyline};
use rototoon_base::scene::{FrameNumber, Part};

/// A time closer than this to a frame counts as that frame.
const SAME_FRAME: f64 = 1e-6;

/// The instants of an open shutter: the middles of `samples` equal intervals of `length` frames around `time`. The
/// number of samples is limited to 1 and [`MOST_INSTANTS`].
pub fn shutter(time: f64, length: f64, samples: usize) -> Vec<f64> {
    shutter_from(time - 0.5 * length.max(0.0), length, samples)
}

/// The instants of a shutter that opens at a time: the middles of `samples` equal intervals of `length` frames. Without a
/// length it is only that time.
pub fn shutter_from(opens: f64, length: f64, samples: usize) -> Vec<f64> {
    let n = if length > 0.0 { samples.clamp(1, MOST_INSTANTS) } else { 1 };
    (0..n).map(|k| opens + length.max(0.0) * ((k as f64 + 0.5) / n as f64)).collect()
}

/// The contour of a part at a time in frames. With `curves` it follows the snapped paths where they exist, otherwise
/// the control points. `None` if the part has no contour on the nearest frame.
pub fn outline_at(part: &Part, time: f64, curves: bool) -> Option<Vec<Point>> {
    let nearest = frame(time.round())?;
    part.points_at(nearest)?;
    if (time - time.round()).abs() < SAME_FRAME {
        return whole(part, nearest, curves);
    }
    let first = frame(time.floor())?;
    let (Some(before), Some(after)) = (part.points_at(first), part.points_at(first + 1)) else {
        return whole(part, nearest, curves);
    };
    if before.len() != after.len() {
        return whole(part, nearest, curves);
    }
    let share = time - time.floor();
    let points = between(part, first, before, after, share);
    let paths = if curves { paths_between(part, first, &points, share) } else { None };
    Some(paths.map_or(points, |paths| joined(&paths, part.closed)))
}

/// The contour of a part at a time as one path for each segment between control points. Joined they are [`outline_at`].
pub fn segments_at(part: &Part, time: f64, curves: bool) -> Option<Vec<Vec<Point>>> {
    let points = outline_at(part, time, false)?;
    let nearest = frame(time.round())?;
    if curves {
        let still = (time - time.round()).abs() < SAME_FRAME;
        let (before, after) = (frame(time.floor())?, frame(time.floor())? + 1);
        let count = |frame| part.points_at(frame).map(Vec::len);
        let moving = !still && count(before).is_some() && count(before) == count(after);
        let paths = if moving {
            paths_between(part, before, &points, time - time.floor())
        } else {
            part.complete_curves(nearest).cloned()
        };
        if let Some(paths) = paths.filter(|paths| paths.len() == polyline::segments(&points, part.closed).count()) {
            return Some(paths);
        }
    }
    Some(polyline::segments(&points, part.closed).map(|(a, b)| vec![a, b]).collect())
}

fn frame(time: f64) -> Option<FrameNumber> {
    (time.abs() < 1e9).then_some(time as FrameNumber)
}

fn whole(part: &Part, frame: FrameNumber, curves: bool) -> Option<Vec<Point>> {
    if curves { part.outline(frame) } else { part.points_at(frame).cloned() }
}

/// Control points at a share of the way from frame `first` to the next.
fn between(part: &Part, first: FrameNumber, before: &[Point], after: &[Point], share: f64) -> Vec<Point> {
    let neighbour = |frame: FrameNumber| part.points_at(frame).filter(|points| points.len() == before.len());
    let (earlier, later) = (neighbour(first - 1), neighbour(first + 2));
    let (t, u) = (share, 1.0 - share);
    let point = |i: usize| {
        let (a, b) = (before[i], after[i]);
        let leaving = earlier.map_or(b - a, |points| 0.5 * (b - points[i]));
        let reaching = later.map_or(b - a, |points| 0.5 * (points[i] - a));
        (1.0 + 2.0 * t) * u * u * a + t * u * u * leaving + t * t * (3.0 - 2.0 * t) * b - t * t * u * reaching
    };
    (0..before.len()).map(point).collect()
}

/// The snapped paths of the neighbouring frames, carried to the segments between `points`. `None` if neither frame has
/// them. Paths of a contour with another number of points are left out.
fn paths_between(part: &Part, first: FrameNumber, points: &[Point], share: f64) -> Option<Vec<Vec<Point>>> {
    let sides = [(first, 1.0 - share), (first + 1, share)];
    let segments = polyline::segments(points, part.closed).count();
    let known: Vec<_> = sides
        .iter()
        .filter_map(|&(frame, weight)| Some((part.points_at(frame)?, part.complete_curves(frame)?, weight)))
        .filter(|(own, paths, _)| own.len() == points.len() && paths.len() == segments)
        .collect();
    let total: f64 = known.iter().map(|(_, _, weight)| weight).sum();
    let mut result: Vec<Vec<Point>> = Vec::new();
    for segment in 0..known.first()?.1.len() {
        let end = (segment + 1) % points.len();
        let count = known.iter().map(|(_, paths, _)| paths[segment].len()).max()?.max(2);
        let mut path = vec![Point::ZERO; count];
        for (own, paths, weight) in &known {
            let carry = carrier([own[segment], own[end]], [points[segment], points[end]]);
            for (sum, p) in path.iter_mut().zip(polyline::resample(&paths[segment], false, count)) {
                *sum += weight / total * carry(p);
            }
        }
        result.push(path);
    }
    Some(result)
}

/// Paths as one contour. The last point of a closed one does not repeat the first.
fn joined(paths: &[Vec<Point>], closed: bool) -> Vec<Point> {
    let mut outline = paths.concat();
    outline.dedup();
    if closed && outline.len() > 1 && outline.first() == outline.last() {
        outline.pop();
    }
    outline
}

/// The similarity that maps one pair of points to another; a shift if the points of the first pair coincide.
fn carrier(from: [Point; 2], to: [Point; 2]) -> impl Fn(Point) -> Point {
    let (along, wanted) = (from[1] - from[0], to[1] - to[0]);
    let size = along.length_squared();
    // The quotient of the two differences as complex numbers.
    let turn = if size > 0.0 { Point::new(along.dot(wanted), along.perp_dot(wanted)) / size } else { Point::X };
    move |p| to[0] + turn.rotate(p - from[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arm(frames: i32) -> Part {
        let mut part = Part { closed: true, ..Part::default() };
        for frame in 0..frames {
            let turn = Point::from_angle(0.2 * f64::from(frame));
            let points = [Point::new(10.0, 0.0), Point::new(20.0, 1.0), Point::new(20.0, -1.0)];
            let points: Vec<Point> = points.iter().map(|&p| turn.rotate(p)).collect();
            let path = |a: Point, b: Point| {
                let bulge = (b - a).perp() * 0.2;
                vec![a, a.lerp(b, 0.25) + bulge, a.lerp(b, 0.75) + bulge, b]
            };
            let paths = (0..3).map(|i| path(points[i], points[(i + 1) % 3])).collect();
            part.keys.insert(frame, points);
            part.curves.insert(frame, paths);
        }
        part
    }

    #[test]
    fn a_swinging_point_keeps_its_radius() {
        let part = arm(5);
        for time in [1.25, 1.5, 2.5, 2.9] {
            for (p, radius) in outline_at(&part, time, false).unwrap().iter().zip([10.0, 401f64.sqrt(), 401f64.sqrt()])
            {
                assert!((p.length() - radius).abs() < 2e-3 * radius, "{time}: {}", p.length());
                // On a straight way between the frames the radius would be half a per cent smaller.
            }
        }
        let middle = outline_at(&part, 2.5, false).unwrap()[0];
        assert!((middle.to_angle() - 0.5).abs() < 1e-3);
    }

    #[test]
    fn a_snapped_path_turns_with_its_segment() {
        let part = arm(4);
        let (whole, half) = (outline_at(&part, 1.0, true).unwrap(), outline_at(&part, 1.5, true).unwrap());
        assert_eq!(whole, part.outline(1).unwrap());
        assert!(half.len() >= whole.len());
        let reach = half.iter().map(|p| p.length()).fold(0.0, f64::max);
        let expected = whole.iter().map(|p| p.length()).fold(0.0, f64::max);
        assert!((reach - expected).abs() < 0.05, "{reach} {expected}");
    }

    #[test]
    fn segments_joined_are_the_outline() {
        let mut part = arm(4);
        part.curves.remove(&3);
        for time in [0.0, 1.0, 1.5, 2.25, 2.75, 3.0] {
            for curves in [false, true] {
                let segments = segments_at(&part, time, curves).unwrap();
                assert_eq!(segments.len(), 3);
                assert_eq!(joined(&segments, true), outline_at(&part, time, curves).unwrap(), "{time} {curves}");
            }
        }
        assert_eq!(segments_at(&part, 9.0, true), None);
    }

    #[test]
    fn contours_with_other_numbers_of_points_keep_to_the_nearest_frame() {
        let mut part = arm(4);
        // A track may have another number of points than the keys, with as many paths as they have.
        part.tracks.insert(2, vec![Point::new(1.0, 0.0), Point::new(2.0, 1.0)]);
        part.keys.remove(&2);
        for time in [1.25, 1.75, 2.0, 2.25, 2.75] {
            for curves in [false, true] {
                let segments = segments_at(&part, time, curves).unwrap();
                let outline = outline_at(&part, time, curves).unwrap();
                assert!(!outline.is_empty() && segments.iter().flatten().all(|p| p.is_finite()), "{time} {curves}");
                let nearest = part.points_at(time.round() as FrameNumber).unwrap();
                assert_eq!(segments.iter().map(|path| path[0]).collect::<Vec<_>>(), *nearest, "{time} {curves}");
            }
        }
        part.tracks.insert(3, vec![Point::new(1.0, 0.0), Point::new(2.0, 1.0)]);
        part.keys.remove(&3);
        assert_eq!(segments_at(&part, 2.5, true).unwrap().len(), 2);
        assert_eq!(outline_at(&part, 2.5, true).unwrap().len(), 2);
    }

    #[test]
    fn beyond_the_track_there_is_nothing_and_between_it_holds() {
        let part = arm(3);
        assert_eq!(outline_at(&part, 3.0, true), None);
        assert_eq!(outline_at(&part, -0.6, true), None);
        assert_eq!(outline_at(&part, 2.4, false), part.points_at(2).cloned());
        assert_eq!(outline_at(&part, f64::NAN, false), None);
        assert_eq!(outline_at(&part, 1e300, false), None);
    }

    #[test]
    fn a_shutter_is_open_around_its_time() {
        assert_eq!(shutter(5.0, 1.0, 2), [4.75, 5.25]);
        assert_eq!(shutter(5.0, 0.0, 16), [5.0]);
        assert_eq!(shutter(5.0, 1.0, 0), [5.0]);
        assert_eq!(shutter(5.0, 1.0, 1000).len(), MOST_INSTANTS);
    }
}
