//! Clicks that mend a drawing that was carried, and what follows it.

use super::*;

#[test]
fn a_click_on_a_later_frame_mends_it_and_what_follows() {
    let later = [click((60.0 + 6.0 * 3.0, 75.0), RED)];
    let mut film = Film::new(5, moving).clicked(&[(0, &own_clicks()), (3, &later)]);
    film.fill().unwrap();
    let disc = |frame: FrameNumber| film.at(frame, (60.0 + 6.0 * f64::from(frame), 75.0)).unwrap();
    assert_eq!([0, 1, 2, 3, 4, 5].map(|frame| disc(frame).colour), [BLUE, BLUE, BLUE, RED, RED, RED]);
    assert_eq!(disc(3).confidence, 1.0);
    assert_ne!(disc(2).track, disc(3).track, "a number has one colour");
    // What was not clicked there was carried there.
    assert_eq!(film.at(3, (60.0 + 18.0 - 35.0, 75.0)).unwrap().colour, RED);
    assert_eq!(film.at(5, (3.0, 3.0)).unwrap().colour, PAPER);
}

#[test]
fn corrections_hold_to_the_end_of_the_film() {
    let x = |frame: FrameNumber| 60.0 + 6.0 * f64::from(frame);
    let (disc, rest) = ([click((x(2), 75.0), RED)], [click((x(5) - 35.0, 75.0), BLUE)]);
    let mut film = Film::new(14, moving).clicked(&[(0, &own_clicks()), (2, &disc), (5, &rest)]);
    film.fill().unwrap();
    for frame in 0..=14 {
        let colours = [0.0, -35.0].map(|beside| film.at(frame, (x(frame) + beside, 75.0)).unwrap().colour);
        let wanted = [if frame < 2 { BLUE } else { RED }, if frame < 5 { RED } else { BLUE }];
        assert_eq!(colours, wanted, "frame {frame}");
        assert_eq!(film.at(frame, (3.0, 3.0)).unwrap().colour, PAPER, "frame {frame}");
    }
}

#[test]
fn a_click_before_the_model_drawing_mends_it_and_what_comes_before() {
    let x = |frame: FrameNumber| 60.0 + 6.0 * f64::from(frame);
    let model = [click((5.0, 5.0), PAPER), click((x(4) - 35.0, 75.0), RED), click((x(4), 75.0), BLUE)];
    let mut film = Film::new(5, moving).clicked(&[(2, &[click((x(2), 75.0), RED)]), (4, &model)]);
    let report = film.fill().unwrap();
    assert!(report.frames.iter().all(|frame| frame.regions == 3), "one click is no model drawing: {report:?}");
    let disc = |frame: FrameNumber| film.at(frame, (x(frame), 75.0)).unwrap();
    assert_eq!([0, 1, 2, 3, 4, 5].map(|frame| disc(frame).colour), [RED, RED, RED, BLUE, BLUE, BLUE]);
    assert_eq!((disc(2).confidence, disc(4).track), (1.0, 2), "the numbers of the model drawing begin with 0");
    for frame in 0..=5 {
        assert_eq!(film.at(frame, (x(frame) - 35.0, 75.0)).unwrap().colour, RED, "frame {frame}");
        assert_eq!(film.at(frame, (3.0, 3.0)).unwrap().colour, PAPER, "frame {frame}");
    }
}
