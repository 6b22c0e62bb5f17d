//! Colours that vanish from one drawing to the next.

use super::*;

#[test]
fn a_colour_that_vanishes_is_named_with_its_frames() {
    // The second square has a colour of its own. It is hidden on frames 2 and 3, and comes back.
    let [paper, red, blue] = own_clicks();
    let yellow = [1.0, 1.0, 0.0];
    let squares = [click((178.0, 30.0), RED), click((178.0, 120.0), yellow)];
    let all = [vec![paper, red, blue], squares.to_vec()].concat();
    let mut film = Film::new(6, coat).clicked(&[(0, &all)]);
    let report = film.fill().unwrap();
    let hue = Hue { colour: yellow, name: None };
    assert_eq!(report.vanished, [VanishedColour { frame: 2, hue }]);
    let told: Vec<String> = report.lines().into_iter().filter(|line| line.contains("vanishes")).collect();
    let [line] = told.as_slice() else { panic!("{told:?}") };
    assert!(line.starts_with("the colour #ffff00 vanishes on frame 2: no region has it"), "{line}");
    // From the other side the drawing that was painted before is the one behind.
    let mut film = film.clicked(&[(6, &all.iter().map(|own| shifted(own, 18.0)).collect::<Vec<_>>())]);
    let frames: Vec<FrameNumber> = film.fill().unwrap().vanished.iter().map(|own| own.frame).collect();
    assert_eq!(frames, [3]);
    // What a click takes away was meant, and is not said.
    let mut film = Film::new(1, moving).clicked(&[(0, &own_clicks()), (1, &[click((66.0, 75.0), RED)])]);
    assert_eq!(film.fill().unwrap().vanished, []);
}

/// A click on the moving box, as many pixels further to the right. Others stay.
fn shifted(own: &FillClick, by: f64) -> FillClick {
    let moves = own.at.x > 10.0 && own.at.x < 110.0;
    FillClick { at: own.at + Point::new(if moves { by } else { 0.0 }, 0.0), ..own.clone() }
}
