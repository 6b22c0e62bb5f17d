//! Parts that are absent on some frames, by the artist's word.

use super::scene::{Drawn, Shape, points};
use crate::{PartTrack, TrackOptions, Tracker};
use rototoon_base::geometry::Point;
use rototoon_base::scene::{Footage, FrameNumber, Part, Scene, Silent};

const LAST: FrameNumber = 16;
const AWAY: f64 = -300.0;

/// A shape that trembles on the left until frame 5, is away, and trembles on the right from frame 10 on.
fn comes_back() -> Shape {
    Shape {
        rest: points(&[(-14.0, -9.0), (0.0, -12.0), (16.0, -8.0), (15.0, 8.0), (-3.0, 11.0), (-15.0, 7.0)]),
        colour: [0.85, 0.3, 0.2],
        motion: |t| {
            let up = if t % 4.0 == 0.0 { 0.0 } else { 14.0 };
            let x = if t < 6.0 { 50.0 } else { 190.0 };
            (Point::new(if (6.0..10.0).contains(&t) { AWAY } else { x }, 60.0 + up), 0.0)
        },
    }
}

/// The same shape at rest in the middle.
fn twin() -> Shape {
    Shape { motion: |_| (Point::new(120.0, 120.0), 0.0), ..comes_back() }
}

/// The track of the first shape of a film with these keys, if it is absent where it is away.
fn tracked(film: &Drawn, keys: &[FrameNumber]) -> PartTrack {
    let keys = keys.iter().map(|&frame| (frame, film.0[0].contour(frame))).collect();
    let part = Part { name: "part".into(), closed: true, keys, absent: vec![[6, 9]], ..Part::default() };
    let scene = Scene { footage: Footage { last: LAST, ..film.scene(Vec::new()).footage }, parts: vec![part] };
    Tracker::new(TrackOptions::default()).track(&scene, film, &Silent).expect("a track").parts.remove(0)
}

/// Asserts that a track has all frames but those of the absence, and is right there.
fn is_right(film: &Drawn, found: &PartTrack) {
    let frames: Vec<FrameNumber> = found.tracks.keys().copied().collect();
    assert_eq!(frames, (0..=LAST).filter(|frame| !(6..=9).contains(frame)).collect::<Vec<_>>());
    for (frame, contour) in &found.tracks {
        let truth = film.0[0].contour(*frame);
        let worst = contour.iter().zip(&truth).map(|(p, q)| p.distance(*q)).fold(0.0, f64::max);
        assert!(worst < 2.0, "frame {frame}: {worst}");
    }
}

#[test]
fn a_part_does_not_go_to_its_twin_because_it_would_be_there_while_it_is_absent() {
    let film = Drawn(vec![comes_back(), twin()]);
    is_right(&film, &tracked(&film, &[0, LAST]));
}

#[test]
fn a_part_with_one_key_is_found_again_where_it_is_no_longer_absent() {
    let film = Drawn(vec![comes_back()]);
    let found = tracked(&film, &[0]);
    is_right(&film, &found);
    assert!(found.ends.is_empty());
}
