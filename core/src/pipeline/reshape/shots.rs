//! Drawings with a motion of their own: what of it is not in a result.

use super::tests::{figure, job, waving};
use super::*;
use crate::project::seen::{Made, Seen};
use crate::scene::Silent;

const ARM: usize = 3;

fn reshaped(document: &mut Document, frames: usize) -> Reshaped {
    let motion = waving(&figure(""), frames);
    reshape(document, &ReshapeJob { mirror: Mirror::Off, ..job(&motion) }, &Silent).unwrap()
}

fn read_again(document: &Document) -> Document {
    Document::parse(&document.to_json(), "again").unwrap()
}

#[test]
fn a_part_that_is_absent_in_the_own_motion_is_there_in_another() {
    let mut document = figure("");
    document.scene.parts[ARM].absent = vec![[2, 3]];
    let made = reshaped(&mut document, 6);
    let arm = &document.scene.parts[ARM];
    assert!((0..6).all(|frame| arm.points_at(frame).is_some()) && arm.absent.is_empty());
    let said = "the result shows parts that are absent in the drawing's own motion: \"arm\" on 2-3";
    assert!(made.remarks.iter().any(|remark| remark == said), "{:?}", made.remarks);
    assert!(document.problems().is_empty(), "{:?}", document.problems());
}

#[test]
fn a_part_that_is_made_absent_on_a_result_stays_absent() {
    let mut document = figure("");
    reshaped(&mut document, 8);
    document.scene.parts[ARM].absent = vec![[2, 3], [5, 6]];
    // The second clip ends where the arm is absent.
    let made = reshaped(&mut document, 6);
    let arm = &document.scene.parts[ARM];
    let there: Vec<FrameNumber> = (0..6).filter(|&frame| arm.points_at(frame).is_some()).collect();
    assert_eq!((there, &arm.absent[..]), (vec![0, 1, 4], &[[2, 3], [5, 6]][..]));
    let said = "your corrections stay: \"arm\" absent on 2-3, 5-6";
    assert!(made.notes.iter().any(|note| note == said), "{:?}", made.notes);
    assert!(document.problems().is_empty(), "{:?}", document.problems());
}

const STROKE: &str = r#"{"points": [[66, 54], [66, 56]], "closed": false}"#;
const TRACED: &str = r#", "traced": [{"frame": 0, "strokes": [{"track": 0, "points": [[1, 1], [9, 1]], "closed": false}]}],
    "filled": [{"frame": 1, "regions": [{"track": 0, "outline": [[1, 1], [9, 1], [9, 9]], "colour": [1, 0, 0]}]}]"#;

/// The strokes that a document shows on a frame.
fn shown(document: &Document, frame: FrameNumber) -> Vec<Vec<Point>> {
    let mut by_frame = crate::pipeline::strokes::strokes(document).unwrap();
    by_frame.remove(&frame).unwrap_or_default().into_iter().map(|seen| seen.stroke.points).collect()
}

#[test]
fn traced_strokes_and_paint_of_the_own_motion_do_not_hide_the_result() {
    let mut document = figure(&format!(r#", "drawings": [{{"frame": 0, "strokes": [{STROKE}]}}]{TRACED}"#));
    let made = reshaped(&mut document, 4);
    let document = read_again(&document);
    assert!(document.traced().unwrap().is_empty() && document.filled().unwrap().is_empty());
    assert_eq!(document.drawings().unwrap().drawings.len(), 1, "what was drawn stays");
    assert!(shown(&document, 3)[0][0].x > 90.0, "the stroke goes with the arm: {:?}", shown(&document, 3));
    let said = "what the drawing's own motion has and the result has not: traced strokes on 0, painted regions on 1";
    assert!(made.remarks.iter().any(|remark| remark == said), "{:?}", made.remarks);
}

#[test]
fn key_drawings_of_the_own_motion_do_not_show_where_the_drawing_at_rest_has_no_strokes() {
    let between = format!(r#", "in_betweens": [{{"frame": 2, "strokes": [{}"track": 0, {}]}}]"#, "{", &STROKE[1..]);
    let mut document = figure(&format!(r#", "drawings": [{{"frame": 3, "strokes": [{STROKE}]}}]{between}"#));
    let made = reshaped(&mut document, 6);
    let document = read_again(&document);
    assert!((0..6).all(|frame| shown(&document, frame).is_empty()));
    assert_eq!(document.drawings().unwrap().drawings.len(), 1);
    let note = "frame 0, at rest, has no strokes, so the result shows none: the drawings on 3 stay in the document";
    assert!(made.notes.iter().any(|own| own == note), "{:?}", made.notes);
    let said = "what the drawing's own motion has and the result has not: in-betweens on 2";
    assert!(made.remarks.iter().any(|remark| remark == said), "{:?}", made.remarks);
}

#[test]
fn the_strokes_of_an_earlier_result_over_other_footage_are_reshaped_again() {
    let mut document = figure(&format!(r#", "drawings": [{{"frame": 0, "strokes": [{STROKE}]}}]"#));
    let motion = waving(&document, 4);
    let over = Footage { first: 100, last: 103, ..document.scene.footage.clone() };
    reshape(&mut document, &ReshapeJob { over: Some(over), ..job(&motion) }, &Silent).unwrap();
    let made = reshaped(&mut document, 4);
    assert!(shown(&document, 103)[0][0].x > 90.0, "{:?}", shown(&document, 103));
    let about = |remark: &String| remark.contains("in-betweens");
    assert!(!made.remarks.iter().any(about), "those of an earlier result: {:?}", made.remarks);
}

#[test]
fn a_result_is_made_of_no_pictures() {
    let mut document = figure("");
    let seen = BTreeMap::from([(0, Seen { file: 1, pixels: 2 })]);
    document.set_seen(Made::Tracks, 0..=9, &seen).unwrap();
    reshaped(&mut document, 4);
    assert!(document.seen(Made::Tracks).unwrap().is_empty());
}

#[test]
fn all_frames_have_the_side_of_the_drawing_at_rest() {
    let sides = |swaps: &str| {
        let mut document = figure(&format!(r#", "limb_swaps": {swaps}"#));
        let made = reshaped(&mut document, 6);
        (document.limbs().unwrap().swaps, made.remarks)
    };
    let own = "what the drawing's own motion has and the result has not: swapped sides on ".to_owned();
    assert_eq!(sides("[[2, 3]]"), (vec![], vec![own.clone() + "2-3"]));
    assert_eq!(sides("[[0, 1], [5, 9]]"), (vec![(0, 5)], vec![own + "0-1, 5-9"]));
    assert_eq!(sides("[[0, 9]]"), (vec![(0, 5)], vec![]), "all of the drawing's frames have that side");
}
