//! Segments that nearer parts hide.
//!
//! **Why.** A contour goes on behind what lies over it: its matte is complete there. A path that is sought in the picture would follow the nearer part's
//! ink instead, which leads away from the hidden edge.
//!
//! **How.** A segment is hidden if at least [`MOST`] of its length lies inside of nearer parts, and deeper there than [`DEEP`]: in the band along a nearer
//! contour two parts may share one line. A hidden segment takes the form that it has where it is seen: the paths of the [`FORMS`] nearest frames on which it is
//! seen, each turned and scaled so that its ends come to the control points, and of these the median place for each share of the length. So one frame
//! on which a path went astray does not count. Where a segment is seen on fewer than [`FEWEST`] frames, at half to twice its length, it stays straight.
//!
//! **Limits.** Nearer parts are taken as their tracked polygons. Parts of equal depth do not hide each other. What hides the part and is no part itself is not known.

use super::footage::PartCurves;
use rototoon_base::geometry::{Point, polygon, polyline};
use rototoon_base::scene::{FrameNumber, Scene};
use std::collections::BTreeMap;

/// Share of a segment's length from which it is hidden, and up to which it is seen.
const MOST: f64 = 0.25;
const SEEN: f64 = 0.1;
/// How deep inside of a nearer part a place must lie, in pixels at 540 lines.
const DEEP: f64 = 4.0;
/// Distance of the places that are looked at, in pixels at 540 lines, and their least number.
const APART: f64 = 2.0;
const LEAST: usize = 5;
/// How many times as long or as short a segment may have become for its form to be taken.
const STRETCH: f64 = 2.0;
/// Frames whose forms are compared, the fewest of them, and the number of places of a form.
const FORMS: usize = 5;
const FEWEST: usize = 3;
const PLACES: usize = 17;

/// Gives hidden segments of all parts the form that they have where they are seen.
pub(super) fn form_hidden(scene: &Scene, curves: &mut [PartCurves]) {
    let scale = scene.footage.height as f64 / 540.0;
    for (index, curves) in curves.iter_mut().enumerate() {
        let part = &scene.parts[index];
        let shares: BTreeMap<FrameNumber, Vec<f64>> =
            curves.keys().map(|&frame| (frame, shares(scene, index, frame, scale))).collect();
        let seen = curves.clone();
        for (&frame, paths) in curves.iter_mut() {
            let Some(points) = part.points_at(frame) else { continue };
            for (k, (a, b)) in polyline::segments(points, part.closed).enumerate().take(paths.len()) {
                if shares[&frame].get(k).is_some_and(|share| *share >= MOST) {
                    let forms = nearest_seen(&shares, frame, k).filter_map(|from| moved(seen[&from].get(k)?, a, b));
                    paths[k] = median(&forms.take(FORMS).collect::<Vec<_>>(), a, b);
                }
            }
        }
    }
}

/// The frames on which a segment is seen, the nearest ones first.
fn nearest_seen(
    shares: &BTreeMap<FrameNumber, Vec<f64>>,
    frame: FrameNumber,
    k: usize,
) -> impl Iterator<Item = FrameNumber> {
    let is_seen = |(_, shares): &(&FrameNumber, &Vec<f64>)| shares.get(k).is_some_and(|share| *share <= SEEN);
    let mut found: Vec<FrameNumber> = shares.iter().filter(is_seen).map(|(found, _)| *found).collect();
    found.sort_by_key(|found| (i64::from(*found).abs_diff(i64::from(frame)), *found));
    found.into_iter()
}

/// The median of several forms, from `a` to `b`; straight if they are too few.
fn median(forms: &[Vec<Point>], a: Point, b: Point) -> Vec<Point> {
    if forms.len() < FEWEST {
        return vec![a, b];
    }
    let forms: Vec<Vec<Point>> = forms.iter().map(|form| polyline::resample(form, false, PLACES)).collect();
    let middle = |k: usize, of: fn(&Point) -> f64| {
        let mut values: Vec<f64> = forms.iter().map(|form| of(&form[k])).collect();
        values.sort_by(f64::total_cmp);
        0.5 * (values[(values.len() - 1) / 2] + values[values.len() / 2])
    };
    let mut path: Vec<Point> = (0..PLACES).map(|k| Point::new(middle(k, |p| p.x), middle(k, |p| p.y))).collect();
    (path[0], path[PLACES - 1]) = (a, b);
    path
}

/// The share of each segment's length that nearer parts hide.
fn shares(scene: &Scene, index: usize, frame: FrameNumber, scale: f64) -> Vec<f64> {
    let part = &scene.parts[index];
    let Some(points) = part.points_at(frame) else { return Vec::new() };
    let depth = part.depth_at(frame);
    let nearer: Vec<(&Vec<Point>, (Point, Point))> = scene
        .parts
        .iter()
        .filter(|other| other.closed && other.depth_at(frame) > depth)
        .filter_map(|other| other.points_at(frame))
        .filter_map(|contour| Some((contour, polygon::bounds(contour)?)))
        .collect();
    let hides = |p: Point, (contour, (low, high)): &(&Vec<Point>, (Point, Point))| {
        let within = low.x <= p.x && p.x <= high.x && low.y <= p.y && p.y <= high.y;
        within && polygon::contains(contour, p) && polyline::distance(p, contour, true) > DEEP * scale
    };
    let share = |(a, b): (Point, Point)| {
        let count = ((a.distance(b) / (APART * scale)).ceil() as usize).clamp(LEAST, 1000);
        let place = |k: usize| a.lerp(b, (k as f64 + 0.5) / count as f64);
        let hidden = (0..count).filter(|&k| nearer.iter().any(|other| hides(place(k), other))).count();
        hidden as f64 / count as f64
    };
    polyline::segments(points, part.closed).map(share).collect()
}

/// A path turned and scaled so that it goes from `a` to `b`; `None` if it would become too long or too short.
fn moved(path: &[Point], a: Point, b: Point) -> Option<Vec<Point>> {
    let [first, .., last] = path else { return None };
    let (from, to) = (*last - *first, b - a);
    let stretch = to.length() / from.length();
    if !(1.0 / STRETCH..=STRETCH).contains(&stretch) {
        return None;
    }
    // As complex numbers: the quotient of the two ways turns and scales.
    let turn = Point::new(from.dot(to), from.perp_dot(to)) / from.length_squared();
    let mut moved: Vec<Point> = path.iter().map(|&p| a + turn.rotate(p - *first)).collect();
    let end = moved.len() - 1;
    moved[end] = b;
    Some(moved)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon_base::scene::{Footage, Part};

    const FRAMES: std::ops::RangeInclusive<FrameNumber> = 0..=6;

    /// A square of 60 px whose path bows outwards by 6 px on its right side, and a nearer part that covers this side from frame 4 on. On frame
    /// 3 the path went astray.
    fn film() -> (Scene, Vec<PartCurves>) {
        let square = |left: f64, size: f64| {
            [(0.0, 0.0), (size, 0.0), (size, size), (0.0, size)].map(|(x, y)| Point::new(left + x, 100.0 + y)).to_vec()
        };
        let at = |frame: FrameNumber| square(100.0 + 3.0 * f64::from(frame), 60.0);
        let part = |name: &str, depth, tracks: BTreeMap<FrameNumber, Vec<Point>>| Part {
            name: name.into(),
            closed: true,
            depth,
            keys: tracks.clone(),
            tracks,
            ..Part::default()
        };
        let body = part("body", 0.0, FRAMES.map(|frame| (frame, at(frame))).collect());
        let hand = part("hand", 1.0, (4..=6).map(|frame| (frame, square(130.0, 80.0))).collect());
        let bowed = |points: &Vec<Point>| {
            let mut paths: Vec<Vec<Point>> = polyline::segments(points, true).map(|(a, b)| vec![a, b]).collect();
            paths[1].insert(1, points[1].midpoint(points[2]) + Point::new(6.0, 0.0));
            paths
        };
        let mut curves: PartCurves = body.tracks.iter().map(|(frame, points)| (*frame, bowed(points))).collect();
        // What the nearer part's ink made of the path.
        for frame in 3..=6 {
            curves.get_mut(&frame).unwrap()[1][1].x += 15.0;
        }
        let footage =
            Footage { pattern: "%d".into(), first: 0, last: 6, fps: 24.0, width: 960, height: 540, held: false };
        (Scene { footage, parts: vec![body, hand] }, vec![curves, PartCurves::new()])
    }

    #[test]
    fn a_hidden_segment_has_the_form_of_the_frames_on_which_it_is_seen() {
        let (scene, mut curves) = film();
        let before = curves.clone();
        form_hidden(&scene, &mut curves);
        for frame in 4..=6 {
            let points = &scene.parts[0].tracks[&frame];
            let middle = points[1].midpoint(points[2]) + Point::new(6.0, 0.0);
            assert!(polyline::distance(middle, &curves[0][&frame][1], false) < 1e-9, "frame {frame}");
            assert_eq!((curves[0][&frame][1][0], *curves[0][&frame][1].last().unwrap()), (points[1], points[2]));
            assert_eq!(curves[0][&frame][3], before[0][&frame][3], "the left side is seen");
        }
        assert!((0..4).all(|frame| curves[0][&frame] == before[0][&frame]), "where it is seen it stays");
    }

    #[test]
    fn a_segment_that_is_never_seen_stays_straight() {
        let (mut scene, mut curves) = film();
        let hand = scene.parts[1].tracks[&4].clone();
        scene.parts[1].tracks = FRAMES.map(|frame| (frame, hand.clone())).collect();
        form_hidden(&scene, &mut curves);
        for frame in FRAMES {
            assert_eq!(curves[0][&frame][1].len(), 2, "frame {frame}");
        }
        // A part that is farther hides nothing.
        let (mut scene, mut curves) = film();
        scene.parts[1].depth = -1.0;
        let before = curves.clone();
        form_hidden(&scene, &mut curves);
        assert_eq!(curves, before);
    }

    #[test]
    fn a_form_goes_with_its_ends() {
        let path = vec![Point::ZERO, Point::new(1.0, 1.0), Point::new(2.0, 0.0)];
        let found = moved(&path, Point::new(5.0, 5.0), Point::new(5.0, 8.0)).unwrap();
        assert!(found[1].distance(Point::new(3.5, 6.5)) < 1e-9, "{}", found[1]);
        assert_eq!((found[0], found[2]), (Point::new(5.0, 5.0), Point::new(5.0, 8.0)));
        assert_eq!(moved(&path, Point::ZERO, Point::new(0.5, 0.0)), None);
        assert_eq!(moved(&[Point::ONE; 2], Point::ZERO, Point::ONE), None, "it has no length");
    }
}
