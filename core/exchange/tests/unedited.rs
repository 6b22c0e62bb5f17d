//! A file that comes back as it went out changes nothing.

use proptest::collection::{btree_map, vec};
use proptest::prelude::*;
use proptest::sample::select;
use rototoon_base::geometry::Point;
use rototoon_base::scene::{Footage, FrameNumber, Part, Scene};
use rototoon_exchange::export::{Detail, Motion, SvgOptions, fusion, natron_project, nuke, renamed, silhouette, svg};
use rototoon_exchange::import::{self, Change, ImportError, Shapes};
use std::collections::BTreeMap;

/// Frames of the footage.
const COUNT: FrameNumber = 10;
const NAMES: [&str; 6] = ["arm", "arm 2", "left leg", "Hütchen <1>", "part-0", "x\"y'z"];

/// How a range is written.
const DETAILS: [Detail; 3] = [Detail::Spacing(2.0), Detail::Spacing(9.0), Detail::Bezier(0.5)];

/// What a part is like: whether it is closed, and its points on the first frame.
type Form = (bool, Vec<(f64, f64)>);

fn footage() -> impl Strategy<Value = Footage> {
    (select(&[0, 1001, -4][..]), select(&[12.0, 12.5, 23.976, 24.0, 25.0, 29.97][..])).prop_map(|(first, fps)| {
        Footage { pattern: "%d".into(), first, last: first + COUNT - 1, fps, width: 640, height: 360, held: false }
    })
}

fn form() -> impl Strategy<Value = Form> {
    (any::<bool>(), vec((0.0..640.0, 0.0..360.0), 2..6))
        .prop_filter("area", |(closed, points)| !closed || points.len() > 2)
}

/// A part: its form, how far it moves from frame to frame, its keys, and what is known besides.
fn part(first: FrameNumber) -> impl Strategy<Value = Part> {
    let steps = vec(select(&[0.0, 0.0, 3.0, -7.5, 0.37][..]), COUNT as usize);
    let keys = btree_map(0..COUNT, Just(()), 1..4);
    let absent = vec((0..COUNT, 0..3 as FrameNumber), 0..3);
    (form(), steps, keys, absent, any::<bool>(), any::<bool>(), any::<bool>()).prop_map(
        move |((closed, points), steps, keys, absent, tracked, snapped, bends)| {
            let on = |frame: FrameNumber| -> Vec<Point> {
                let way: f64 = steps[..=frame as usize].iter().sum();
                let bend = |k: usize| if bends { way * (k as f64 - 1.0) * 0.3 } else { 0.0 };
                points.iter().enumerate().map(|(k, p)| Point::new(p.0 + way, p.1 + bend(k))).collect()
            };
            let mut part = Part { closed, ..Part::default() };
            part.keys = keys.keys().map(|&k| (first + k, on(k))).collect();
            for (from, more) in absent {
                part.set_absent(first + from, first + (from + more).min(COUNT - 1));
            }
            let (from, to) = match keys.len() {
                1 => {
                    let key = *keys.keys().next().unwrap();
                    ((key - 2).max(0), (key + 3).min(COUNT - 1))
                }
                _ => (*keys.keys().next().unwrap(), *keys.keys().next_back().unwrap()),
            };
            if tracked {
                part.tracks = (from..=to).map(|k| (first + k, on(k))).collect();
                if snapped {
                    part.curves = part.tracks.iter().map(|(frame, points)| (*frame, paths(points, closed))).collect();
                }
                part.forget_where_absent();
            }
            part
        },
    )
}

/// A bow between each point and the next.
fn paths(points: &[Point], closed: bool) -> Vec<Vec<Point>> {
    let sides = if closed { points.len() } else { points.len() - 1 };
    let path = |k: usize| {
        let (a, b) = (points[k], points[(k + 1) % points.len()]);
        let across = Point::new(a.y - b.y, b.x - a.x) * 0.15;
        (0..=16).map(|i| f64::from(i) / 16.0).map(|t| a.lerp(b, t) + across * (4.0 * t * (1.0 - t))).collect()
    };
    (0..sides).map(path).collect()
}

fn scene() -> impl Strategy<Value = Scene> {
    (footage(), Just(NAMES.to_vec()).prop_shuffle()).prop_flat_map(|(footage, names)| {
        vec(part(footage.first), 1..4).prop_map(move |mut parts| {
            for (k, part) in parts.iter_mut().enumerate() {
                (part.name, part.depth) = (names[k].into(), k as f64);
            }
            Scene { footage: footage.clone(), parts }
        })
    })
}

/// The shapes of each format after export, read for a whole scene.
fn read(scene: &Scene, whole: &Scene, detail: Detail) -> Vec<(&'static str, Result<Shapes, ImportError>)> {
    let (footage, first) = (&whole.footage, whole.footage.first);
    let options = |motion| match detail {
        Detail::Spacing(spacing) => SvgOptions { motion, spacing, bezier: None },
        Detail::Bezier(tolerance) => SvgOptions { motion, bezier: Some(tolerance), ..SvgOptions::default() },
    };
    let names: Vec<&str> = scene.parts.iter().map(|part| part.name.as_str()).collect();
    let still = import::svg::Still { frame: first, asked: false };
    let drawn = |motion| import::svg::svg_of(&svg(scene, &options(motion)), footage, still, &names);
    vec![
        ("svg", drawn(Motion::Hold)),
        ("svg", drawn(Motion::Linear)),
        ("nk", import::nuke::nuke(&nuke(scene, detail), footage, first)),
        ("ntp", import::natron::natron(&natron_project(scene, detail), footage, first)),
        ("fxs", import::silhouette::silhouette(&silhouette(scene, detail), footage)),
        ("setting", import::fusion::fusion(&fusion(scene, detail), footage, first)),
    ]
}

/// What each part has on each frame.
fn told(part: &Part) -> BTreeMap<FrameNumber, (bool, bool)> {
    let frames = part.keys.keys().chain(part.tracks.keys());
    frames.map(|frame| (*frame, (part.keys.contains_key(frame), part.tracks.contains_key(frame)))).collect()
}

fn check(scene: &Scene, detail: Detail) -> Result<(), TestCaseError> {
    for (format, found) in read(scene, scene, detail) {
        let mut found = found.map_err(|error| TestCaseError::fail(format!("{format}: {error}")))?;
        for (own, there) in renamed(scene, format) {
            found.shapes.iter_mut().filter(|shape| shape.name == there).for_each(|shape| shape.name = own.to_owned());
        }
        let mut back = scene.clone();
        let merged = import::into_scene(&mut back, found.shapes).unwrap();
        for taken in &merged.taken {
            prop_assert!(taken.change == Change::Nothing, "{format}: {taken:?}, {:?}", found.warnings);
        }
        prop_assert!(merged.moved.is_empty(), "{format}: {:?}", merged.moved);
        prop_assert_eq!(
            back.parts.iter().map(told).collect::<Vec<_>>(),
            scene.parts.iter().map(told).collect::<Vec<_>>()
        );
        prop_assert!(back == *scene, "{format}");
    }
    Ok(())
}

/// A range of frames of a scene, as an export of it has them.
fn range(scene: &Scene, [first, last]: [FrameNumber; 2]) -> Scene {
    let mut scene = scene.clone();
    (scene.footage.first, scene.footage.last) = (first, last);
    let within = |frame: &FrameNumber| (first..=last).contains(frame);
    for part in &mut scene.parts {
        part.keys.retain(|frame, _| within(frame));
        part.tracks.retain(|frame, _| within(frame));
        part.curves.retain(|frame, _| within(frame));
    }
    scene
}

/// The range comes back into the whole scene.
fn check_range(scene: &Scene, [first, count]: [FrameNumber; 2], detail: Detail) -> Result<(), TestCaseError> {
    let from = scene.footage.first + first;
    let part = range(scene, [from, (from + count).min(scene.footage.last)]);
    for (format, found) in read(&part, scene, detail) {
        // A range without any part has no shape.
        let Ok(mut found) = found else { continue };
        for (own, there) in renamed(&part, format) {
            found.shapes.iter_mut().filter(|shape| shape.name == there).for_each(|shape| shape.name = own.to_owned());
        }
        let mut back = scene.clone();
        let merged = import::into_scene(&mut back, found.shapes).unwrap();
        for taken in &merged.taken {
            prop_assert!(taken.change == Change::Nothing, "{format}: {taken:?}, {:?}", found.warnings);
        }
        prop_assert!(back == *scene, "{format}");
    }
    Ok(())
}

/// A scene whose parts are tracked: others have contours between their keys that a range makes keys of.
fn tracked() -> impl Strategy<Value = Scene> {
    scene().prop_filter("tracked", |scene| scene.parts.iter().all(|part| !part.tracks.is_empty()))
}

/// A part that waves, little on most frames and more on the last ones.
fn waving() -> Part {
    let mut part = Part { name: "hair".into(), ..Part::default() };
    for frame in 0..COUNT {
        let high = if frame < 6 { 0.5 } else { f64::from(frame) };
        let [a, b] = [(100.0, 100.0), (220.0, 110.0)].map(Point::from);
        let across = (b - a).perp().normalize();
        let wave = |t: f64| high * (9.0 * t).sin() * (1.0 - t) * t * 4.0;
        let path = (0..=40).map(|i| f64::from(i) / 40.0).map(|t| a.lerp(b, t) + across * wave(t)).collect();
        part.tracks.insert(frame, vec![a, b]);
        part.curves.insert(frame, vec![path]);
    }
    part.keys.insert(0, part.tracks[&0].clone());
    part
}

/// On most frames points in a distance, and curves of other tolerances, are the same as those of the file, but not on those with the highest waves.
#[test]
fn curves_of_usual_tolerances_that_were_not_edited_change_nothing() {
    let footage =
        Footage { pattern: "%d".into(), first: 0, last: COUNT - 1, fps: 24.0, width: 640, height: 360, held: false };
    let scene = Scene { footage, parts: vec![waving()] };
    for tolerance in [0.1, 0.25, 0.5, 1.0] {
        check(&scene, Detail::Bezier(tolerance)).unwrap_or_else(|error| panic!("{tolerance}: {error}"));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 8, ..ProptestConfig::default() })]

    #[test]
    fn a_file_that_was_not_edited_changes_nothing(scene in scene()) {
        check(&scene, Detail::Spacing(2.0))?;
    }

    #[test]
    fn curves_that_were_not_edited_change_nothing(scene in scene()) {
        check(&scene, Detail::Bezier(0.3))?;
    }

    #[test]
    fn a_range_that_was_not_edited_changes_nothing(
        scene in tracked(), first in 0..COUNT, count in 0..COUNT, detail in select(&DETAILS[..]),
    ) {
        check_range(&scene, [first, count], detail)?;
    }

    #[test]
    fn coarse_points_that_were_not_edited_change_nothing(scene in scene(), spacing in 0.5..40.0) {
        check(&scene, Detail::Spacing(spacing))?;
    }
}
