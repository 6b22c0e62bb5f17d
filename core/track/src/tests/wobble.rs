//! The default solver on a film whose lines wobble.

use super::scene::{colour_at, points};
use crate::rototoon::mechanisms::{Mechanism, Mechanisms};
use crate::{TrackOptions, Tracker, Tracking};
use rototoon_base::geometry::{Point, polygon};
use rototoon_base::scene::{
    Cancelled, Colour, Footage, FrameError, FrameNumber, FrameSource, Part, Progress, Raster, Scene, Silent,
};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

const SIZE: (usize, usize) = (300, 270);
const LAST: FrameNumber = 11;
/// The largest displacement of a drawn point along each axis, in pixels.
const WOBBLE: f64 = 0.9;

/// A head with two eyes and a mouth that drifts and nods.
struct Face {
    wobble: f64,
}

impl Face {
    fn rest(part: usize) -> Vec<Point> {
        let ring = |count: usize, radii: (f64, f64), centre: (f64, f64)| -> Vec<Point> {
            let angle = |k: usize| std::f64::consts::TAU * k as f64 / count as f64;
            let around = |k: usize| Point::from_angle(angle(k)) * Point::new(radii.0, radii.1);
            (0..count).map(|k| around(k) + Point::new(centre.0, centre.1)).collect()
        };
        match part {
            0 => ring(14, (64.0, 78.0), (0.0, 0.0)),
            1 => points(&[(-38.0, -24.0), (-22.0, -32.0), (-10.0, -22.0), (-14.0, -4.0), (-34.0, -6.0)]),
            2 => points(&[(38.0, -24.0), (22.0, -32.0), (10.0, -22.0), (14.0, -4.0), (34.0, -6.0)]),
            _ => points(&[(-34.0, 26.0), (0.0, 20.0), (36.0, 30.0), (22.0, 50.0), (-6.0, 54.0), (-26.0, 44.0)]),
        }
    }

    /// Where a part truly is.
    fn truth(part: usize, frame: FrameNumber) -> Vec<Point> {
        let t = f64::from(frame);
        let shift = Point::new(90.0 + 9.0 * t, 130.0 + 7.0 * (frame % 3) as f64);
        Self::rest(part).iter().map(|&p| Point::from_angle(0.02 * t).rotate(p) + shift).collect()
    }

    /// Where it is drawn. Keys are drawn without a wobble.
    fn drawn(&self, part: usize, frame: FrameNumber) -> Vec<Point> {
        let wobble = if frame == 0 || frame == LAST { 0.0 } else { self.wobble };
        let mut state = (part as u64 + 1) * 977 + frame as u64 * 131;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((state >> 11) as f64 / (1_u64 << 53) as f64 * 2.0 - 1.0) * wobble
        };
        // The first numbers of such a generator depend on its seed too simply.
        (0..8).for_each(|_| _ = random());
        Self::truth(part, frame).iter().map(|&p| p + Point::new(random(), random())).collect()
    }

    fn scene() -> Scene {
        let footage = Footage {
            pattern: "%d.png".into(),
            first: 0,
            last: LAST,
            fps: 12.0,
            width: SIZE.0,
            height: SIZE.1,
            held: false,
        };
        let part = |part: usize| {
            let keys = [0, LAST].map(|frame| (frame, Self::truth(part, frame)));
            Part {
                name: format!("part {part}"),
                closed: true,
                depth: part as f64,
                keys: keys.into(),
                ..Part::default()
            }
        };
        Scene { footage, parts: (0..4).map(part).collect() }
    }
}

impl FrameSource for Face {
    fn picture(&self, frame: FrameNumber) -> Result<Arc<Raster<Colour>>, FrameError> {
        let colours = [[0.9, 0.75, 0.6], [0.95, 0.98, 0.95], [0.85, 0.9, 0.98], [0.75, 0.25, 0.25]];
        let shown: Vec<(Vec<Point>, (Point, Point), Colour)> = (0..4)
            .rev()
            .map(|part| {
                let contour = self.drawn(part, frame);
                let (low, high) = polygon::bounds(&contour).expect("a part has points");
                (contour, (low - 1.0, high + 1.0), colours[part])
            })
            .collect();
        Ok(Arc::new(Raster::from_fn(SIZE.0, SIZE.1, |x, y| {
            let places = [(0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75)];
            let seen = places.map(|(dx, dy)| colour_at(&shown, Point::new(x as f64 + dx, y as f64 + dy)));
            std::array::from_fn(|k| seen.iter().map(|colour| colour[k]).sum::<f32>() / 4.0)
        })))
    }
}

/// The root mean square second difference of the error of all points.
fn shake(tracking: &Tracking) -> f64 {
    let mut squares = Vec::new();
    for (part, found) in tracking.parts.iter().enumerate() {
        let error = |frame: FrameNumber| -> Vec<Point> {
            let truth = Face::truth(part, frame);
            found.tracks[&frame].iter().zip(truth).map(|(found, truth)| *found - truth).collect()
        };
        for frame in 2..LAST - 1 {
            let [a, b, c] = [error(frame - 1), error(frame), error(frame + 1)];
            squares.extend((0..b.len()).map(|k| (a[k] - 2.0 * b[k] + c[k]).length_squared()));
        }
    }
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

/// Progress that must not fall.
#[derive(Default)]
struct Rising(Mutex<f64>);

impl Progress for Rising {
    fn report(&self, step: &str, done: f64) -> Result<(), Cancelled> {
        let mut before = self.0.lock().unwrap();
        assert!(done >= *before, "{step}: {done} after {before}");
        *before = done;
        Ok(())
    }
}

#[test]
fn contours_are_steadied_where_lines_wobble_and_the_memory_changes_nothing() {
    let (face, scene) = (Face { wobble: WOBBLE }, Face::scene());
    let drawn = Tracking {
        parts: (0..4)
            .map(|part| crate::PartTrack {
                tracks: (0..=LAST).map(|frame| (frame, face.drawn(part, frame))).collect(),
                ..Default::default()
            })
            .collect(),
        ..Tracking::default()
    };
    let mut tracker = Tracker::new(TrackOptions::default());
    let tracking = tracker.track(&scene, &face, &Rising::default()).unwrap();
    let (lines, found) = (shake(&drawn), shake(&tracking));
    let without = TrackOptions { mechanisms: Mechanisms::without(Mechanism::Steadying), ..TrackOptions::default() };
    let before = shake(&Tracker::new(without).track(&scene, &face, &Silent).unwrap());
    assert!(found < 0.6 * lines && found < 0.75 * before, "{found} px; lines {lines}, not steadied {before}");

    // A pin is kept exactly, and a run that remembers finds what a fresh one finds.
    let mut pinned = scene.clone();
    let pin = Face::truth(0, 5)[3] + Point::new(1.5, 0.5);
    pinned.parts[0].pins.insert(5, BTreeMap::from([(3, pin)]));
    let again = tracker.track(&pinned, &face, &Silent).unwrap();
    let fresh = Tracker::new(TrackOptions::default()).track(&pinned, &face, &Silent).unwrap();
    assert_eq!(again.parts[0].tracks[&5][3], pin);
    assert!(again.parts == fresh.parts, "the memory changed a track");
    let back = tracker.track(&scene, &face, &Silent).unwrap();
    assert!(back.parts == tracking.parts, "a pin that was taken away left something");
    let far = |tracking: &Tracking| tracking.parts[3].tracks[&1].clone();
    let moved = far(&again).iter().zip(far(&tracking)).map(|(a, b)| a.distance(b)).fold(0.0, f64::max);
    assert!(moved < 0.1, "a pin on another part moved a far drawing by {moved} px");
}
