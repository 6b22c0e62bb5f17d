//! Paper that opens between the limbs of a figure.

use super::*;

const GREEN: Colour = [0.0, 1.0, 0.0];

/// A body on two legs that are nearly together, with shoes apart. On frame 1 the legs part and the shoes meet, so paper is closed in between them. There is a
/// pocket on the body then.
fn figure(frame: FrameNumber, p: Point) -> f64 {
    let (inner, apart) = if frame == 0 { (4.0, 3.0) } else { (12.0, 0.0) };
    let outer = inner + 20.0;
    let side = |side: f64| {
        let leg = boxed(p, (100.0 + side * (inner + 10.0), 97.0), (10.0, 32.0));
        leg.min(boxed(p, (100.0 + side * 0.5 * (outer + apart), 136.0), (0.5 * (outer - apart), 7.0)))
    };
    let pocket = if frame == 0 { f64::INFINITY } else { boxed(p, (100.0, 40.0), (9.0, 8.0)) };
    boxed(p, (100.0, 40.0), (42.0, 25.0)).min(side(-1.0)).min(side(1.0)).min(pocket)
}

/// Clicks into all but the paper.
fn clicks() -> Vec<FillClick> {
    let legs = [86.0, 114.0].map(|x| click((x, 97.0), BLUE));
    let shoes = [88.0, 112.0].map(|x| click((x, 136.0), GREEN));
    [vec![click((100.0, 20.0), RED)], legs.to_vec(), shoes.to_vec()].concat()
}

/// The figure, painted, with two frames more.
fn painted(clicks: &[FillClick]) -> Film {
    let mut film = Film::new(2, figure).clicked(&[(0, clicks)]);
    film.fill().unwrap();
    film
}

#[test]
fn paper_that_opens_between_limbs_has_no_paint() {
    let film = painted(&clicks());
    for frame in 1..=2 {
        assert_eq!(film.at(frame, (100.0, 97.0)), None, "frame {frame}: between the legs");
        let known = [((78.0, 97.0), BLUE), ((122.0, 97.0), BLUE), ((84.0, 136.0), GREEN), ((116.0, 136.0), GREEN)];
        for (place, colour) in known {
            let found = film.at(frame, place).unwrap();
            assert!(found.colour == colour && found.confidence > DOUBT, "frame {frame}, {place:?}: {found:?}");
        }
    }
}

#[test]
fn paper_that_is_painted_opens_in_its_colour() {
    let film = painted(&[clicks(), vec![click((5.0, 5.0), PAPER)]].concat());
    for frame in 1..=2 {
        let found = film.at(frame, (100.0, 97.0)).unwrap();
        assert!(found.colour == PAPER && found.confidence > DOUBT, "frame {frame}: {found:?}");
    }
}

#[test]
fn what_is_new_within_a_thing_is_no_paper() {
    let film = painted(&clicks());
    for frame in 1..=2 {
        assert_ne!(film.at(frame, (100.0, 40.0)), None, "frame {frame}: the pocket");
    }
}
