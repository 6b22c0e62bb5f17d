//! A figure that is drawn with one contour, and moves its arm by itself.

use super::scene::{HEIGHT, WIDTH, colour_at, points};
use crate::{Mechanism, Mechanisms, TrackOptions, Tracker};
use rototoon_base::geometry::{Point, polygon};
use rototoon_base::scene::{Colour, Footage, FrameError, FrameNumber, FrameSource, Part, Raster, Scene, Silent};
use std::sync::Arc;

/// Direction of the arm by frame, in degrees below the horizontal.
const ARM: [f64; 3] = [80.0, 0.0, -80.0];
const LAST: FrameNumber = 2;

/// A body with an arm at its right side.
struct Figure;

impl Figure {
    fn contour(frame: FrameNumber) -> Vec<Point> {
        let turn = Point::from_angle(ARM[frame as usize].to_radians());
        let shoulder = Point::new(120.0, 80.0);
        let arm = points(&[(8.0, -6.0), (30.0, -6.0), (55.0, -6.0), (65.0, 0.0), (55.0, 6.0), (30.0, 6.0), (8.0, 6.0)]);
        let body =
            [(120.0, 95.0), (124.0, 150.0), (90.0, 155.0), (60.0, 150.0), (64.0, 90.0), (75.0, 55.0), (110.0, 60.0)];
        arm.into_iter().map(|p| turn.rotate(p) + shoulder).chain(points(&body)).collect()
    }
}

impl FrameSource for Figure {
    fn picture(&self, frame: FrameNumber) -> Result<Arc<Raster<Colour>>, FrameError> {
        let contour = Self::contour(frame);
        let (low, high) = polygon::bounds(&contour).expect("the figure has points");
        let shown = [(contour, (low - 1.0, high + 1.0), [0.3, 0.5, 0.8])];
        let pixel = |x: usize, y: usize| colour_at(&shown, Point::new(x as f64 + 0.5, y as f64 + 0.5));
        Ok(Arc::new(Raster::from_fn(WIDTH, HEIGHT, pixel)))
    }
}

/// The largest distance of a point from its place.
fn worst(mechanisms: Mechanisms) -> f64 {
    let keys = [0, LAST].map(|frame| (frame, Figure::contour(frame)));
    let part = Part { name: "figure".into(), closed: true, keys: keys.into(), ..Part::default() };
    let footage = Footage {
        pattern: "%d.png".into(),
        first: 0,
        last: LAST,
        fps: 12.0,
        width: WIDTH,
        height: HEIGHT,
        held: false,
    };
    let scene = Scene { footage, parts: vec![part] };
    let options = TrackOptions { mechanisms, ..TrackOptions::default() };
    let tracking = Tracker::new(options).track(&scene, &Figure, &Silent).unwrap();
    let off = |frame: FrameNumber| {
        let found = &tracking.parts[0].tracks[&frame];
        found.iter().zip(Figure::contour(frame)).map(|(p, q)| p.distance(q)).fold(0.0, f64::max)
    };
    (1..LAST).map(off).fold(0.0, f64::max)
}

#[test]
fn an_arm_that_swings_by_itself_is_found() {
    let (with, without) = (worst(Mechanisms::default()), worst(Mechanisms::without(Mechanism::Branches)));
    assert!(with < 9.0, "{with}");
    assert!(without > 3.0 * with, "{without}");
}
