//! Parts that lie on one drawn thing.
//!
//! Two eyes look alike. Where one of them turns away, its contour may go over to the other one, which has a contour already: both fit, and
//! nothing in the picture says that anything is wrong. That two contours of one size and shape lie on one place says it.
//!
//! Two contours are *on one place* if their centres are at most [`NEAR`] of their size apart (the size is the square root of the area), and their
//! areas and extents differ by a factor of at most [`ALIKE`]. A pupil is not on the place of its eye.
//!
//! Where two parts are on one place and neither is known to be lost, at least one of them is wrong, or hidden by the other one. Nothing says which. So both are doubtful
//! there, and a report names them together.
//!
//! Parts that the artist has drawn on one place, such as a patch and its paint, belong there. So two parts of which both have a key on a frame
//! where they are on one place do not count.

use crate::contract::tracking::PartTrack;
use rototoon_base::geometry::{Point, polygon};
use rototoon_base::scene::outcome::{Verdict, mean};
use rototoon_base::scene::{FrameNumber, Part, Scene};
use std::collections::BTreeMap;

/// Largest distance of the centres, as a share of the size.
const NEAR: f64 = 0.2;
/// Largest ratio of two areas, and of two widths or heights.
const ALIKE: f64 = 1.6;

/// Largest confidence of parts that are on one place: one of them is probably right.
const DOUBTED: f64 = 0.6;

/// A part with its contours and confidences by frame.
type Followed<'a> = (&'a Part, &'a Tracks, &'a BTreeMap<FrameNumber, Vec<f64>>);

/// Contours by frame.
type Tracks = BTreeMap<FrameNumber, Vec<Point>>;

/// Whether two closed contours are on one place.
pub fn on_one_place(a: &[Point], b: &[Point]) -> bool {
    let alike = |a: f64, b: f64| a.max(b) <= ALIKE * a.min(b);
    let (Some((low, high)), Some((from, to))) = (polygon::bounds(a), polygon::bounds(b)) else { return false };
    let areas = [a, b].map(|contour| polygon::signed_area(contour).abs());
    let (extent, other) = (high - low, to - from);
    areas[0].min(areas[1]) > 0.0
        && polygon::center(a).distance(polygon::center(b)) <= NEAR * areas[0].min(areas[1]).sqrt()
        && alike(areas[0], areas[1])
        && alike(extent.x, other.x)
        && alike(extent.y, other.y)
}

/// The stretches of frames on which two closed parts with these tracks are on one place, as first and last frames. None if they belong there.
pub fn together((a, of_a): (&Part, &Tracks), (b, of_b): (&Part, &Tracks)) -> Vec<[FrameNumber; 2]> {
    let mut runs: Vec<[FrameNumber; 2]> = Vec::new();
    let mut drawn = false;
    for (&frame, contour) in of_a.iter().filter(|_| a.closed && b.closed) {
        let Some(other) = of_b.get(&frame) else { continue };
        if !on_one_place(contour, other) {
            continue;
        }
        drawn |= a.keys.contains_key(&frame) && b.keys.contains_key(&frame);
        match runs.last_mut() {
            Some([_, last]) if *last + 1 == frame => *last = frame,
            _ => runs.push([frame, frame]),
        }
    }
    if drawn { Vec::new() } else { runs }
}

/// The frames on which two closed parts with these tracks and confidences are on one place, and neither of them is known to be lost there.
pub fn sure_together(a: Followed, b: Followed) -> Vec<FrameNumber> {
    let believed = |(_, _, sure): Followed, frame: &FrameNumber| {
        sure.get(frame).and_then(|points| mean(points)).is_some_and(|mean| Verdict::of(mean) < Verdict::Lost)
    };
    let frames = together((a.0, a.1), (b.0, b.1)).into_iter().flat_map(|[first, last]| first..=last);
    frames.filter(|frame| believed(a, frame) && believed(b, frame)).collect()
}

/// The pairs of parts that are on one place on some frames though neither of them is known to be lost there, with these frames.
pub fn twins(parts: &[Part]) -> Vec<([usize; 2], Vec<FrameNumber>)> {
    let followed = |p: usize| (&parts[p], &parts[p].tracks, &parts[p].confidence);
    let pairs = (0..parts.len()).flat_map(|a| (a + 1..parts.len()).map(move |b| [a, b]));
    let found = pairs.map(|[a, b]| ([a, b], sure_together(followed(a), followed(b))));
    found.filter(|(_, frames)| !frames.is_empty()).collect()
}

/// Makes pairs of parts of which one has a single key doubtful where they are on one place though neither of them is known to be lost there. Keys
/// stay beyond doubt. Parts between keys choose together, and what is not right there is said by their margins.
pub fn doubt(scene: &Scene, tracks: &mut [PartTrack]) {
    let mut doubted = Vec::new();
    for a in 0..tracks.len() {
        let single = |p: usize| scene.parts[p].keys.len() == 1;
        for b in (a + 1..tracks.len()).filter(|&b| single(a) || single(b)) {
            let followed = |p: usize| (&scene.parts[p], &tracks[p].tracks, &tracks[p].confidence);
            doubted
                .extend(sure_together(followed(a), followed(b)).into_iter().flat_map(|frame| [(a, frame), (b, frame)]));
        }
    }
    for (p, frame) in doubted.into_iter().filter(|(p, frame)| !scene.parts[*p].keys.contains_key(frame)) {
        let points = tracks[p].confidence.entry(frame).or_default();
        points.iter_mut().for_each(|point| *point = point.min(DOUBTED));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon_base::scene::Footage;

    fn square(x: f64, side: f64) -> Vec<Point> {
        [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)].map(|(dx, dy)| Point::new(x + dx, dy)).to_vec()
    }

    #[test]
    fn contours_of_one_size_and_centre_are_on_one_place() {
        assert!(on_one_place(&square(0.0, 10.0), &square(1.5, 10.0)));
        assert!(!on_one_place(&square(0.0, 10.0), &square(3.0, 10.0)), "beside");
        let pupil: Vec<Point> = square(2.5, 5.0).into_iter().map(|p| p + Point::new(0.0, 2.5)).collect();
        assert!(!on_one_place(&square(0.0, 10.0), &pupil), "smaller");
        assert!(!on_one_place(&square(0.0, 10.0), &[]), "nothing");
    }

    /// A part with a key on a frame, and a track along these places.
    fn part(key: FrameNumber, places: [f64; 6]) -> (Part, Tracks) {
        let tracks: Tracks = (0..).zip(places.map(|x| square(x, 10.0))).collect();
        (Part { closed: true, keys: [(key, tracks[&key].clone())].into(), ..Part::default() }, tracks)
    }

    #[test]
    fn parts_that_meet_and_part_are_together_between() {
        let (a, of_a) = part(0, [0.0, 0.0, 30.0, 30.0, 30.0, 0.0]);
        let (b, of_b) = part(5, [30.0; 6]);
        assert_eq!(together((&a, &of_a), (&b, &of_b)), [[2, 4]]);
        let (b, of_b) = part(3, [30.0; 6]);
        assert_eq!(together((&a, &of_a), (&b, &of_b)), [[2, 4]], "one of them is keyed there");
        let (c, of_c) = part(3, [60.0, 60.0, 30.0, 30.0, 30.0, 60.0]);
        assert!(together((&b, &of_b), (&c, &of_c)).is_empty(), "drawn so");
    }

    #[test]
    fn sure_parts_on_one_place_become_doubtful_but_for_keys() {
        let (a, of_a) = part(0, [0.0, 0.0, 30.0, 30.0, 30.0, 0.0]);
        let (b, of_b) = part(3, [30.0; 6]);
        let sure = |lost: FrameNumber| (0..6).map(move |frame| (frame, vec![if frame == lost { 0.1 } else { 0.9 }; 4]));
        let track = |tracks, lost| PartTrack { tracks, confidence: sure(lost).collect(), ends: Vec::new() };
        let mut tracks = [track(of_a, 4), track(of_b, 9)];
        let footage =
            Footage { pattern: "%d.png".into(), first: 0, last: 5, fps: 24.0, width: 64, height: 48, held: false };
        doubt(&Scene { footage, parts: vec![a, b] }, &mut tracks);
        let mean = |p: usize| tracks[p].confidence.values().map(|points| points[0]).collect::<Vec<f64>>();
        assert_eq!(mean(0), [0.9, 0.9, DOUBTED, DOUBTED, 0.1, 0.9]);
        assert_eq!(mean(1), [0.9, 0.9, DOUBTED, 0.9, 0.9, 0.9]);
    }
}
