//! Drawings that are held over pictures that are not.

use super::scene::{Drawn, HEIGHT, LAST, Shape, WIDTH, colour_at, limb_and_ball};
use crate::{Mechanism, Mechanisms, TrackOptions, Tracker, Tracking};
use rototoon_base::geometry::{Point, polygon};
use rototoon_base::scene::{Colour, FrameError, FrameNumber, FrameSource, Part, Raster, Silent};
use std::sync::Arc;

/// Shapes on twos over a ground that pans on ones.
struct Panned {
    drawn: Drawn,
    /// How far the ground goes from frame to frame, and the shapes with it, in pixels.
    pan: Point,
    carries: bool,
}

impl Panned {
    fn carried(&self, frame: FrameNumber) -> Point {
        if self.carries { self.pan * f64::from(frame) } else { Point::ZERO }
    }

    fn contour(&self, shape: &Shape, frame: FrameNumber) -> Vec<Point> {
        shape.contour(frame).into_iter().map(|p| p + self.carried(frame)).collect()
    }

    fn parts(&self) -> Vec<Part> {
        let part = |(k, shape): (usize, &Shape)| {
            let keys = [0, LAST].map(|frame| (frame, self.contour(shape, frame)));
            Part { name: k.to_string(), closed: true, depth: k as f64, keys: keys.into(), ..Part::default() }
        };
        self.drawn.0.iter().enumerate().map(part).collect()
    }

    fn track(&self, mechanisms: Mechanisms) -> Tracking {
        let options = TrackOptions { mechanisms, ..TrackOptions::default() };
        Tracker::new(options).track(&self.drawn.scene(self.parts()), self, &Silent).unwrap()
    }
}

impl FrameSource for Panned {
    fn picture(&self, frame: FrameNumber) -> Result<Arc<Raster<Colour>>, FrameError> {
        let one = |shape: &Shape| {
            let contour = self.contour(shape, frame);
            let (low, high) = polygon::bounds(&contour).unwrap();
            (contour, (low - 1.0, high + 1.0), shape.colour)
        };
        let shown: Vec<_> = self.drawn.0.iter().rev().map(one).collect();
        let ground = |p: Point| {
            let p = p - self.pan * f64::from(frame);
            let value = (0.7 + 0.2 * (0.31 * p.x).sin() * (0.23 * p.y).cos()) as f32;
            [value, 0.9 * value, 0.75]
        };
        let paper = colour_at(&[], Point::ZERO);
        let picture = Raster::from_fn(WIDTH, HEIGHT, |x, y| {
            let mut sum = [0.0f32; 3];
            for (dx, dy) in [(0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75)] {
                let p = Point::new(x as f64 + dx, y as f64 + dy);
                let found = colour_at(&shown, p);
                let colour = if found == paper { ground(p) } else { found };
                (0..3).for_each(|k| sum[k] += 0.25 * colour[k]);
            }
            sum
        });
        Ok(Arc::new(picture))
    }
}

/// The largest difference of the contours of two frames, beyond a shift.
fn apart(tracking: &Tracking, part: usize, [a, b]: [FrameNumber; 2], shift: Point) -> f64 {
    let tracks = &tracking.parts[part].tracks;
    tracks[&a].iter().zip(&tracks[&b]).map(|(p, q)| (*q - *p).distance(shift)).fold(0.0, f64::max)
}

#[test]
fn frames_of_one_drawing_have_one_contour_over_a_ground_that_pans() {
    let film = Panned { drawn: limb_and_ball(), pan: Point::new(3.3, 0.4), carries: false };
    let (tracking, without) = (film.track(Mechanisms::default()), film.track(Mechanisms::without(Mechanism::Holds)));
    for part in 0..2 {
        for first in [0, 2, 4] {
            assert!(apart(&tracking, part, [first, first + 1], Point::ZERO) < 1e-9, "{part} on {first}");
        }
        assert!(apart(&tracking, part, [1, 2], Point::ZERO) > 2.0, "other drawings have other contours");
        assert!(apart(&without, part, [2, 3], Point::ZERO) > 1e-9, "the mechanism is what unites them");
    }
}

#[test]
fn a_drawing_that_goes_with_the_camera_keeps_its_contour() {
    let pan = Point::new(3.3, 0.4);
    let film = Panned { drawn: limb_and_ball(), pan, carries: true };
    let tracking = film.track(Mechanisms::default());
    for part in 0..2 {
        let tracks = &tracking.parts[part].tracks;
        let moved: Vec<Point> = tracks[&2].iter().zip(&tracks[&3]).map(|(p, q)| *q - *p).collect();
        assert!(moved.iter().all(|step| step.distance(moved[0]) < 1e-9), "{part}: the same shape");
        assert!(moved[0].distance(pan) < 0.15, "{part}: {}", moved[0]);
    }
}

#[test]
fn what_was_compared_before_a_pin_is_what_a_new_tracker_finds_after_it() {
    let film = Panned { drawn: limb_and_ball(), pan: Point::new(3.3, 0.4), carries: true };
    let mut scene = film.drawn.scene(film.parts());
    let mut tracker = Tracker::new(TrackOptions::default());
    let first = tracker.track(&scene, &film, &Silent).unwrap();
    let pinned = first.parts[0].tracks[&2][0] + Point::new(3.0, 2.0);
    scene.parts[0].pins.entry(2).or_default().insert(0, pinned);
    let again = tracker.track(&scene, &film, &Silent).unwrap();
    let anew = Tracker::new(TrackOptions::default()).track(&scene, &film, &Silent).unwrap();
    assert_eq!(again.parts, anew.parts);
    assert_ne!(again.parts[0], first.parts[0], "the pin moves its part");
    scene.parts[0].pins.clear();
    assert_eq!(tracker.track(&scene, &film, &Silent).unwrap().parts, first.parts, "without the pin all is as before");
}
