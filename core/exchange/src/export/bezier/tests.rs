use super::super::outlines::{Detail, Outlines};
use super::*;
use proptest::prelude::*;

/// What the error leaves out between samples, in pixels.
const BETWEEN: f64 = 0.01;

fn p(x: f64, y: f64) -> Point {
    Point::new(x, y)
}

/// A part with snapped paths, whose control points are their ends.
fn part(closed: bool, frames: &[(FrameNumber, Paths)]) -> Part {
    let mut part = Part { closed, ..Part::default() };
    for (frame, paths) in frames {
        let mut points: Vec<Point> = paths.iter().map(|path| path[0]).collect();
        if !closed {
            points.push(*paths[paths.len() - 1].last().unwrap());
        }
        part.keys.insert(*frame, points.clone());
        part.tracks.insert(*frame, points);
        part.curves.insert(*frame, paths.clone());
    }
    part
}

/// The contours of a part as Bézier curves.
fn made(part: &Part, tolerance: f64) -> Vec<(FrameNumber, Vec<Knot>)> {
    Outlines::new(part, Detail::Bezier(tolerance)).within(-1000, 1000)
}

/// Points of the drawn curve.
fn drawn(knots: &[Knot], closed: bool) -> Vec<Point> {
    const STEPS: usize = 64;
    let mut line = Vec::new();
    let next = knots.iter().skip(1).chain(closed.then(|| &knots[0]));
    for (from, to) in knots.iter().zip(next) {
        let ([_, b], [c, _]) = (from.handles(), to.handles());
        line.extend((0..=STEPS).map(|k| {
            let (t, u) = (k as f64 / STEPS as f64, 1.0 - k as f64 / STEPS as f64);
            u * u * u * from.at + 3.0 * u * u * t * b + 3.0 * u * t * t * c + t * t * t * to.at
        }));
    }
    if knots.len() == 1 {
        line.push(knots[0].at);
    }
    line
}

/// The greatest distance of points of one line from another, and the other way.
fn apart(a: &[Point], b: &[Point]) -> f64 {
    let one = |a: &[Point], b: &[Point]| a.iter().map(|p| polyline::distance(*p, b, false)).fold(0.0, f64::max);
    one(a, b).max(one(b, a))
}

/// The greatest distance of the drawn curves from the snapped paths on all frames.
fn worst(part: &Part, found: &[(FrameNumber, Vec<Knot>)]) -> f64 {
    let off =
        |(frame, knots): &(FrameNumber, Vec<Knot>)| apart(&drawn(knots, part.closed), &part.curves[frame].concat());
    found.iter().map(off).fold(0.0, f64::max)
}

/// The turn between the handles of a knot in degrees; `None` unless it has both.
fn turn(knot: &Knot) -> Option<f64> {
    (knot.before.length() > 1e-6 && knot.after.length() > 1e-6)
        .then(|| (-knot.before).angle_to(knot.after).abs().to_degrees())
}

/// A circle as snapped paths with points half a pixel apart.
fn circle(middle: Point, radius: f64, segments: usize) -> Paths {
    let at = |turn: f64| middle + radius * Point::from_angle(std::f64::consts::TAU * turn);
    let steps = (std::f64::consts::TAU * radius / segments as f64 / 0.5).ceil() as usize;
    let point = |segment: usize, k: usize| at((segment as f64 + k as f64 / steps as f64) / segments as f64);
    (0..segments).map(|segment| (0..=steps).map(|k| point(segment, k)).collect()).collect()
}

#[test]
fn a_circle_needs_no_more_points_than_its_control_points_and_is_smooth() {
    let part = part(true, &[(1, circle(p(40.0, 40.0), 30.0, 4)), (2, circle(p(44.0, 40.0), 22.0, 4))]);
    let found = made(&part, 0.25);
    assert_eq!(found.iter().map(|(frame, knots)| (*frame, knots.len())).collect::<Vec<_>>(), [(1, 4), (2, 4)]);
    for knot in found.iter().flat_map(|(_, knots)| knots) {
        assert!(turn(knot).unwrap() < 1e-3, "{knot:?}");
        assert!((knot.after.length() - knot.before.length()).abs() < 0.5, "{knot:?}");
    }
    assert!(worst(&part, &found) < 0.25);
}

#[test]
fn a_segment_has_as_many_pieces_on_all_frames_as_the_most_winding_one_needs() {
    let wave = |height: f64| -> Paths {
        let end = |x: f64| p(x, 0.0);
        vec![
            (0..=160).map(|k| f64::from(k) * 0.5).map(|x| p(x, height * (x * 0.2).sin())).collect(),
            vec![p(80.0, height * 16f64.sin()), end(90.0)],
        ]
    };
    let calm = part(false, &[(1, wave(0.0)), (2, wave(0.1))]);
    assert!(made(&calm, 0.5).iter().all(|(_, knots)| knots.len() == 3));
    let wild = part(false, &[(1, wave(0.0)), (2, wave(0.1)), (3, wave(8.0))]);
    let found = made(&wild, 0.5);
    let counts: Vec<usize> = found.iter().map(|(_, knots)| knots.len()).collect();
    assert!(counts[0] > 5 && counts[0] < 16 && counts.iter().all(|count| *count == counts[0]), "{counts:?}");
    assert!(worst(&wild, &found) < 0.5 + BETWEEN);
}

#[test]
fn straight_sides_have_no_handles_and_corners_stay() {
    let corners = [p(2.0, 2.0), p(42.0, 2.0), p(42.0, 30.0), p(2.0, 30.0)];
    let side = |k: usize| -> Vec<Point> {
        (0..=20).map(|i| corners[k].lerp(corners[(k + 1) % 4], f64::from(i) / 20.0)).collect()
    };
    let part = part(true, &[(1, (0..4).map(side).collect())]);
    assert_eq!(made(&part, 0.25), [(1, corners.map(Knot::bare).to_vec())]);
}

#[test]
fn a_point_keeps_its_kind_on_a_frame_that_says_otherwise() {
    let bump = |second: f64| -> Paths {
        let arc = |from: f64, to: f64, up: f64| -> Vec<Point> {
            (0..=40)
                .map(|k| f64::from(k) / 40.0)
                .map(|t| p(from + (to - from) * t, up * (t * std::f64::consts::PI).sin()))
                .collect()
        };
        vec![arc(0.0, 30.0, 6.0), arc(30.0, 60.0, second)]
    };
    // The point in the middle is smooth where a hump meets a hollow, and a corner where two humps meet.
    let smooth = part(false, &[(1, bump(-6.0)), (2, bump(-6.0)), (3, bump(6.0))]);
    let found = made(&smooth, 0.25);
    assert!(worst(&smooth, &found) < 0.25 + BETWEEN);
    let middle = |knots: &[Knot]| *knots.iter().find(|knot| knot.at.distance(p(30.0, 0.0)) < 1e-6).unwrap();
    assert!(turn(&middle(&found[0].1)).unwrap() < 1e-3);
    assert_eq!(turn(&middle(&found[2].1)), None, "the drawn corner stays: one handle is 0");
    let corner = part(false, &[(1, bump(6.0)), (2, bump(6.0)), (3, bump(-6.0))]);
    let found = made(&corner, 0.25);
    assert!(turn(&middle(&found[0].1)).unwrap() > 25.0);
    assert!(worst(&corner, &found) < 0.25 + BETWEEN);
}

#[test]
fn frames_without_a_snapped_contour_have_as_many_points_with_straight_sides() {
    let mut part = part(true, &[(1, circle(p(40.0, 40.0), 38.0, 2))]);
    let moved: Vec<Point> = part.tracks[&1].iter().map(|at| *at + 3.0).collect();
    part.tracks.insert(2, moved.clone());
    let found = made(&part, 0.25);
    assert_eq!(found.len(), 2);
    assert!(found[0].1.len() > 2 && found[0].1.len() == found[1].1.len());
    assert!(found[1].1.iter().all(|knot| knot.before == Point::ZERO && knot.after == Point::ZERO));
    assert!(apart(&drawn(&found[1].1, true), &moved) < 1e-9);
    let other = part.tracks[&1][..1].to_vec();
    part.tracks.insert(2, other);
    assert_eq!(made(&part, 0.25).len(), 1, "another number of points is no contour");
}

#[test]
fn a_part_without_snapped_paths_stays_the_polygon_that_it_is() {
    let mut part = part(true, &[(1, circle(p(40.0, 40.0), 30.0, 5))]);
    part.curves.clear();
    assert!(!Outlines::new(&part, Detail::Bezier(0.25)).bent());
    assert_eq!(made(&part, 0.25), Outlines::new(&part, 2.0).within(1, 1));
}

#[test]
fn paths_of_one_point_and_gaps_between_paths_are_joined() {
    let paths = vec![vec![p(0.0, 0.0)], vec![p(10.0, 0.0), p(10.0, 9.0)], vec![p(10.0, 10.0), p(4.0, 4.0)]];
    let part = part(true, &[(1, paths)]);
    let found = made(&part, 0.25);
    assert_eq!(found[0].1, [p(0.0, 0.0), p(10.0, 0.0), p(10.0, 10.0)].map(Knot::bare)[..].to_vec().as_slice());
    for count in 1..5 {
        let pieces = cut(&[Point::ONE], count);
        assert!(pieces.len() == count && pieces.iter().all(|piece| piece == &[Point::ONE]), "{pieces:?}");
    }
}

/// A path: smooth, with corners, straight, or without length.
fn path() -> impl Strategy<Value = Vec<(f64, f64)>> {
    let smooth = (1.0..40.0, -0.3..0.3, -0.02..0.02f64).prop_map(|(length, bend, more): (f64, f64, f64)| {
        let (mut way, mut at, mut steps) = (0.0f64, Point::ZERO, Vec::new());
        for k in 0..(2.0 * length) as usize {
            way += 0.5 * bend * (more * k as f64).cos();
            at += 0.5 * Point::from_angle(way);
            steps.push((at.x, at.y));
        }
        steps
    });
    let corners = prop::collection::vec((-12.0..12.0, -12.0..12.0), 1..4);
    let straight = (0.0..30.0, -20.0..20.0).prop_map(|to| vec![to]);
    prop_oneof![4 => smooth, 1 => corners, 1 => straight, 1 => Just(vec![(0.0, 0.0)])]
}

/// Paths one after the other: each begins where the one before ends.
fn chained(shapes: &[Vec<(f64, f64)>], closed: bool) -> Paths {
    let mut at = p(50.0, 50.0);
    let mut paths = Vec::new();
    for shape in shapes {
        let path: Vec<Point> = [at].into_iter().chain(shape.iter().map(|&(x, y)| at + p(x, y))).collect();
        at = path[path.len() - 1];
        paths.push(path);
    }
    if closed && let Some(last) = paths.last_mut() {
        last.push(p(50.0, 50.0));
    }
    paths
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, ..ProptestConfig::default() })]

    #[test]
    fn curves_are_within_the_tolerance_with_the_same_points_on_all_frames(
        shapes in (2usize..5).prop_flat_map(|n| prop::collection::vec(prop::collection::vec(path(), n), 1..4)),
        closed: bool,
        tolerance in 0.1..2.0f64,
    ) {
        let frames: Vec<(FrameNumber, Paths)> = (1..).zip(shapes.iter().map(|own| chained(own, closed))).collect();
        let part = part(closed, &frames);
        let found = made(&part, tolerance);
        prop_assert_eq!(found.len(), frames.len());
        let n = part.segment_count();
        for (frame, knots) in &found {
            prop_assert_eq!(knots.len(), found[0].1.len());
            prop_assert!(knots.len() <= n * MOST_PIECES + 1);
            prop_assert!(knots.iter().all(|knot| knot.before.is_finite() && knot.after.is_finite()));
            // No control point is lost.
            let points = part.points_at(*frame).unwrap();
            prop_assert!(points.iter().all(|at| knots.iter().any(|knot| knot.at.distance(*at) < 1e-9)));
            let off = apart(&drawn(knots, closed), &part.curves[frame].concat());
            prop_assert!(off <= tolerance + BETWEEN, "frame {}: {} for {}", frame, off, tolerance);
        }
    }
}
