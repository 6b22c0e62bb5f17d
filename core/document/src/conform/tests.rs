//! Documents moved to new footage.

use super::*;
use crate::Document;
use rototoon_base::geometry::Point;
use rototoon_base::scene::conform::Source::{New, Redrawn, Same};
use rototoon_base::scene::conform::{FrameMap, Placement, Source};
use serde_json::Value;

/// Old frames 1 to 6; 3 and 4 show one drawing.
fn document() -> Document {
    let text = r#"{"rototoon": 1,
        "footage": {"pattern": "old/%d.png", "first": 1, "last": 6, "fps": 12, "width": 100, "height": 50},
        "parts": [{"name": "arm", "keys": {"1": [[10, 20]], "5": [[14, 20]]}, "pins": {"3": {"0": [12, 21]}},
                   "tracks": {"1": [[10, 20]], "2": [[11, 20]], "3": [[12, 21]], "4": [[12, 21]], "5": [[14, 20]]},
                   "confidence": {"1": [1], "2": [0.9], "3": [1], "4": [0.8], "5": [1]},
                   "absent": [[6, 6]], "feather": [3]}],
        "drawings": [{"frame": 1, "strokes": [{"points": [[1, 2], [3, 4]], "closed": false, "widths": [2, 2], "mood": "calm"}]},
                     {"frame": 4, "strokes": []}, {"frame": 6, "strokes": []}],
        "pairs": [{"frame": 1, "from": 0, "to": null}, {"frame": 4, "from": 0, "to": 0}],
        "pegs": [{"name": "arm", "parent": null, "pivot": [5, 6], "keys": [{"frame": 2, "shift": [1, 2]}]}],
        "matches": [{"frame": 1, "next": 4, "pairs": []}], "in_betweens": [{"frame": 2, "strokes": []}],
        "traced": [{"frame": 4, "strokes": [{"track": 7, "points": [[1, 2], [3, 4]], "closed": false}]}, {"frame": 5, "strokes": []}],
        "fills": [{"frame": 2, "regions": [{"at": [5, 5], "colour": [1, 0, 0]}]}],
        "filled": [{"frame": 2, "regions": [{"outline": [[0, 0], [9, 0], [9, 9]], "holes": [[[1, 1], [2, 1], [2, 2]]], "colour": [1, 0, 0], "track": 0, "confidence": 1}]}],
        "limb_swaps": [[2, 4]], "depth_marks": [{"front": "arm", "behind": "arm", "first": 4}],
        "recolours": [{"from": {"colour": [1, 0, 0]}, "to": {"name": "wet", "colour": [0, 0, 1]}, "first": 2, "last": 4, "why": "rain"},
            {"from": {"name": "wet"}, "to": {"colour": [0, 0, 0]}, "last": 3}, {"from": {"colour": [1, 0, 0]}, "to": {"name": "wet"}}],
        "note": {"frame": 2}}"#;
    Document::parse(text, "old.json").unwrap()
}

fn moved(sources: &[Source], placement: Placement) -> (Document, Vec<Note>) {
    let sources: Vec<_> = (1001..).zip(sources.iter().copied()).collect();
    let last = sources.last().unwrap().0;
    let frames = FrameMap::new(1..=6, sources.into_iter().collect(), vec![[3, 4]]);
    let footage =
        Footage { pattern: "new/%d.png".into(), first: 1001, last, fps: 24.0, width: 200, height: 100, held: false };
    document().conformed(&Conform { placement, frames }, footage).unwrap()
}

fn json(document: &Document) -> Value {
    serde_json::from_str(&document.to_json()).unwrap()
}

const ALL: [Source; 6] = [Same(1), Same(2), Same(3), Same(4), Same(5), Same(6)];

#[test]
fn other_numbers_and_another_size_keep_everything() {
    let placement = Placement { scale: 2.0, shift: Point::new(4.0, 1.0) };
    let (new, notes) = moved(&ALL, placement);
    assert_eq!(notes, []);
    assert!(new.problems().error_count() == 0, "{}", new.problems());
    let part = &new.scene.parts[0];
    assert_eq!(part.keys.keys().copied().collect::<Vec<_>>(), [1001, 1005]);
    assert_eq!(part.keys[&1001], [Point::new(24.0, 41.0)]);
    assert_eq!(part.pins[&1003][&0], Point::new(28.0, 43.0));
    assert_eq!(
        (part.tracks.len(), part.absent.as_slice(), part.feather.as_slice()),
        (5, [[1006, 1006]].as_slice(), [6.0].as_slice())
    );
    let value = json(&new);
    let stroke = &value["drawings"][0]["strokes"][0];
    assert_eq!(stroke["points"], serde_json::json!([[6.0, 5.0], [10.0, 9.0]]));
    assert_eq!((&stroke["widths"], &stroke["mood"]), (&serde_json::json!([4.0, 4.0]), &serde_json::json!("calm")));
    assert_eq!(value["pegs"][0]["keys"][0], serde_json::json!({"frame": 1002, "shift": [2.0, 4.0]}));
    assert_eq!(value["pegs"][0]["pivot"], serde_json::json!([14.0, 13.0]));
    assert_eq!(
        (&value["matches"][0]["next"], &value["in_betweens"][0]["frame"]),
        (&Value::from(1004), &Value::from(1002))
    );
    assert_eq!(value["filled"][0]["regions"][0]["holes"][0][2], serde_json::json!([8.0, 5.0]));
    assert_eq!(value["fills"][0]["regions"][0]["at"], serde_json::json!([14.0, 11.0]));
    assert_eq!(
        (&value["limb_swaps"], &value["depth_marks"][0]["first"]),
        (&serde_json::json!([[1002, 1004]]), &Value::from(1004))
    );
    assert_eq!(value["note"], serde_json::json!({"frame": 2}), "what is not known stays");
    let recolours: Vec<_> = new.recolours().unwrap().list().iter().map(|own| (own.first, own.last)).collect();
    assert_eq!(recolours, [(Some(1002), Some(1004)), (None, Some(1003)), (None, None)], "open ends stay open");
    assert_eq!(value["recolours"][0]["why"], "rain");
}

#[test]
fn a_colour_that_becomes_another_one_goes_with_its_drawings() {
    // Frame 3 is held longer, and frame 4 is gone.
    let (new, notes) = moved(&[Same(1), Same(2), Same(3), Same(3), Same(5)], Placement::SAME);
    let recolours: Vec<_> = new.recolours().unwrap().list().iter().map(|own| (own.first, own.last)).collect();
    assert_eq!(recolours[0], (Some(1002), Some(1004)));
    assert!(!notes.iter().any(|note| note.to_string().contains("becomes")), "{notes:?}");
    let (new, notes) = moved(&[Same(5), Same(6)], Placement::SAME);
    assert_eq!(new.recolours().unwrap().list().len(), 1);
    let gone: Vec<String> = notes.iter().map(ToString::to_string).filter(|note| note.contains("becomes")).collect();
    assert_eq!(
        gone,
        [2, 3].map(|frame| format!(
            "a colour that becomes another one on {frame} of the old footage: left out, its drawing is gone"
        ))
    );
}

#[test]
fn a_drawing_that_is_held_longer_shows_its_results_on_all_frames() {
    let (new, notes) = moved(&[Same(1), Same(2), Same(3), Same(4), Same(4), Same(5), Same(6)], Placement::SAME);
    let part = &new.scene.parts[0];
    assert_eq!(part.tracks.keys().copied().collect::<Vec<_>>(), [1001, 1002, 1003, 1004, 1005, 1006]);
    assert_eq!((part.keys.contains_key(&1006), part.absent.as_slice()), (true, [[1007, 1007]].as_slice()));
    assert_eq!(json(&new)["traced"].as_array().unwrap().len(), 3);
    assert_eq!(notes, [Note::Again { what: "in-betweens", command: "tween" }]);
}

#[test]
fn keys_stay_on_a_drawing_that_was_drawn_again_and_results_do_not() {
    let (new, notes) = moved(&[Same(1), Same(2), Same(3), Same(4), Redrawn(5), Same(6)], Placement::SAME);
    let part = &new.scene.parts[0];
    assert!(part.keys.contains_key(&1005) && !part.tracks.contains_key(&1005));
    assert_eq!(json(&new)["traced"].as_array().unwrap().len(), 1);
    let texts: Vec<String> = notes.iter().map(Note::to_string).collect();
    assert_eq!(texts[0], "part \"arm\": the key on 1005: the drawing was drawn again; look whether it still fits");
    assert!(texts.iter().any(|text| text.contains("`rototoon trace`")), "{texts:?}");
}

#[test]
fn a_part_does_not_end_early_because_the_drawing_of_its_key_is_gone() {
    let (new, notes) = moved(&[Same(2), Same(4), New, Same(6)], Placement::SAME);
    let part = &new.scene.parts[0];
    assert_eq!(
        part.keys.iter().map(|(frame, points)| (*frame, points[0].x)).collect::<Vec<_>>(),
        [(1001, 11.0), (1002, 12.0)]
    );
    assert_eq!(
        part.pins.keys().copied().collect::<Vec<_>>(),
        [1002],
        "the pin was on the other frame of a held drawing"
    );
    let replaced = |frame, by| Note::Replaced { part: "arm".into(), frame, by };
    assert_eq!(notes[..2], [replaced(1, 1001), replaced(5, 1002)]);
    let gone = |what: &str, frame| Note::Gone { what: what.into(), frame };
    assert!(notes.contains(&gone("the drawing", 1)) && notes.contains(&gone("a pair of strokes", 1)), "{notes:?}");
    assert!(new.problems().error_count() == 0, "{}", new.problems());
}

#[test]
fn a_new_drawing_between_two_without_the_part_is_without_it() {
    let mut old = document();
    old.scene.parts[0].absent = vec![[3, 4]];
    let sources = [Same(1), Same(2), Same(3), New, Same(4), New, Same(5), Same(6)];
    let frames = FrameMap::new(1..=6, (1..).zip(sources).collect(), Vec::new());
    let footage = Footage { last: 8, ..old.scene.footage.clone() };
    let (new, _) = old.conformed(&Conform { placement: Placement::SAME, frames }, footage).unwrap();
    assert_eq!(new.scene.parts[0].absent, [[3, 5]]);
}

#[test]
fn the_same_footage_gives_the_same_document() {
    let old = document();
    let frames = FrameMap::offset(1..=6, 1..=6, 0);
    let (new, notes) =
        old.conformed(&Conform { placement: Placement::SAME, frames }, old.scene.footage.clone()).unwrap();
    assert_eq!((json(&new), notes), (json(&old), Vec::new()));
}

#[test]
fn what_is_marked_of_limbs_is_named_where_its_drawing_is_gone() {
    let mut old = document();
    old.scene.parts[0].keys = [1, 5].map(|frame| (frame, vec![Point::new(0.0, 0.0), Point::new(20.0, 0.0)])).into();
    old.scene.parts[0].tracks =
        (1..=5).map(|frame| (frame, vec![Point::new(0.0, 0.0), Point::new(20.0, 0.0)])).collect();
    let limbs = r#"[{"from": "r_shoulder", "to": "r_elbow",
        "start": {"points": [{"part": "arm", "at": 0}, {"part": "arm", "drawn": {"2": [5, 3]}}]},
        "end": {"points": [{"part": "arm", "drawn": {"1": [5, 3], "2": [9, 9]}}, {"part": "arm", "at": 1}]}, "bends": {"2": [5, 5]}}]"#;
    old.set_other_field("limbs", limbs.into());
    old.set_other_field("limb_swaps", "[[2, 2], [1, 3]]".into());
    let marks = r#"[{"front": "arm", "behind": "arm", "first": 2, "last": 2}]"#;
    old.set_other_field("depth_marks", marks.into());
    let sources = [(1001, Same(1)), (1002, Same(3)), (1003, Same(4)), (1004, Same(5))];
    let frames = FrameMap::new(1..=6, sources.into_iter().collect(), vec![[3, 4]]);
    let footage = Footage {
        pattern: "new/%d.png".into(),
        first: 1001,
        last: 1004,
        fps: 24.0,
        width: 100,
        height: 50,
        held: false,
    };
    let placement = Placement { scale: 1.0, shift: Point::ZERO };
    let (new, notes) = old.conformed(&Conform { placement, frames }, footage).unwrap();
    let told: Vec<String> = notes.iter().map(ToString::to_string).collect();
    let is_one = |told: &&String| told.contains("limb") || told.contains("which part is in front");
    let gone: Vec<&String> = told.iter().filter(is_one).collect();
    assert!(gone.iter().all(|told| told.contains("on 2 of the old footage")), "{gone:?}");
    assert_eq!(gone.len(), 5, "{notes:?}");
    let json = json(&new);
    assert_eq!(json["limbs"][0]["start"]["points"][1], serde_json::json!({"part": "arm", "at": 0.25}));
    assert_eq!(json["limbs"][0]["end"]["points"][0]["drawn"], serde_json::json!({"1001": [5, 3]}));
    assert_eq!((&json["limb_swaps"], json.get("depth_marks")), (&serde_json::json!([[1001, 1002]]), None));
}
