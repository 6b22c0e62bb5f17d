//! Numbers of regions where only some frames are painted.

use super::*;

/// A large box on all frames, a small one in it on the left before frame 2, and one on the right after it.
fn one_goes_and_one_comes(frame: FrameNumber, p: Point) -> f64 {
    let small = match frame {
        ..2 => boxed(p, (60.0, 60.0), (15.0, 15.0)),
        2 => 99.0,
        _ => boxed(p, (140.0, 90.0), (18.0, 15.0)),
    };
    small.min(boxed(p, (100.0, 75.0), (80.0, 60.0)))
}

fn film() -> Film {
    let none = FillClick { colour: None, ..click((5.0, 5.0), RED) };
    let model = [click((100.0, 40.0), RED), none];
    Film::new(4, one_goes_and_one_comes).clicked(&[
        (1, &[click((60.0, 60.0), BLUE)]),
        (2, &model),
        (3, &[click((140.0, 90.0), BLUE)]),
    ])
}

fn on(film: &mut Film, range: RangeInclusive<FrameNumber>) {
    fill(&mut film.document, film.folder.path(), Some(range), &FillOptions::default(), None, &Silent).unwrap();
}

#[test]
fn frames_that_are_painted_again_keep_their_numbers() {
    let mut film = film();
    film.fill().unwrap();
    let before = film.document.to_json();
    let number = |film: &Film, frame, place| film.at(frame, place).unwrap().track;
    let (gone, come) = (number(&film, 0, (60.0, 60.0)), number(&film, 3, (140.0, 90.0)));
    assert_ne!(gone, come);
    for range in [3..=4, 3..=3, 4..=4, 0..=0, 2..=3] {
        on(&mut film, range.clone());
        assert_eq!(film.document.to_json(), before, "{range:?}");
    }
}

#[test]
fn a_region_that_is_new_has_a_number_of_its_own() {
    let mut film = film();
    on(&mut film, 0..=2);
    let gone = film.at(0, (60.0, 60.0)).unwrap().track;
    on(&mut film, 3..=4);
    let [third, fourth] = [3, 4].map(|frame| film.at(frame, (140.0, 90.0)).unwrap().track);
    assert_eq!(third, fourth);
    assert_ne!(third, gone, "another region of the same colour has that number on frames that stay");
    let around = |frame| film.at(frame, (100.0, 40.0)).unwrap().track;
    assert_eq!(around(4), around(0), "the region that is on all frames");
}
