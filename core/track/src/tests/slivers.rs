//! Keys that show next to nothing of a part.

use super::scene::{Drawn, LAST, Shape, points};
use crate::{TrackOptions, Tracker};
use rototoon_base::geometry::Point;
use rototoon_base::scene::{Colour, FrameError, FrameNumber, FrameSource, Part, Raster, Silent};
use std::f64::consts::TAU;
use std::sync::Arc;

/// A bar that goes behind a disc and comes out on the other side. On frame 2 next to nothing of it shows.
fn bar_and_disc(colour: Colour) -> Drawn {
    let bar = Shape {
        rest: points(&[(-36.0, -10.0), (0.0, -10.0), (36.0, -10.0), (36.0, 10.0), (0.0, 10.0), (-36.0, 10.0)]),
        colour,
        motion: |t| match t as i32 {
            0 => (Point::new(44.0, 80.0), 0.0),
            2 => (Point::new(120.0, 90.0), 0.0),
            4 => (Point::new(192.0, 104.0), 0.0),
            _ => (Point::new(194.0, 120.0), 12.0),
        },
    };
    let disc = Shape {
        rest: (0..24).map(|k| Point::from_angle(f64::from(k) / 24.0 * TAU) * 37.0).collect(),
        colour: [0.3, 0.4, 0.8],
        motion: |_| (Point::new(120.0, 90.0), 0.0),
    };
    Drawn(vec![bar, disc])
}

/// The bar is darker on frames 4 and 5: no pose of the key that shows it fits without a difference.
struct Darker([Drawn; 2]);

impl FrameSource for Darker {
    fn picture(&self, frame: FrameNumber) -> Result<Arc<Raster<Colour>>, FrameError> {
        self.0[usize::from((4..6).contains(&frame))].picture(frame)
    }
}

#[test]
fn a_key_behind_a_nearer_part_does_not_lead_the_drawings_around_astray() {
    let film = Darker([[0.85, 0.6, 0.2], [0.63, 0.44, 0.15]].map(bar_and_disc));
    let drawn = &film.0[0];
    let part = |k: usize| {
        let keys = [0, 2, LAST].map(|frame: FrameNumber| (frame, drawn.0[k].contour(frame)));
        Part { name: k.to_string(), closed: true, depth: k as f64, keys: keys.into(), ..Part::default() }
    };
    let scene = drawn.scene(vec![part(0), part(1)]);
    let tracking = Tracker::new(TrackOptions::default()).track(&scene, &film, &Silent).unwrap();
    for frame in [4, 5] {
        let found = &tracking.parts[0].tracks[&frame];
        let worst = found.iter().zip(drawn.0[0].contour(frame)).map(|(p, q)| p.distance(q)).fold(0.0, f64::max);
        assert!(worst < 3.0, "{worst} px off on {frame}");
    }
}
