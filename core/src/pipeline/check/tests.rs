//! Tests of what is wrong with a document.

use super::*;
use serde_json::{Value, json};

fn document(fields: &Value) -> Document {
    let mut whole = json!({"rototoon": 1, "parts": [],
        "footage": {"pattern": "f_%d.png", "first": 0, "last": 9, "fps": 24, "width": 64, "height": 48}});
    whole.as_object_mut().unwrap().extend(fields.as_object().unwrap().clone());
    Document::parse(&whole.to_string(), "a.json").unwrap()
}

/// Errors and warnings, with one line for each.
fn said(fields: &Value) -> (Vec<String>, Vec<String>) {
    let problems = drawing_problems(&document(fields));
    (problems.errors().map(ToString::to_string).collect(), problems.warnings().map(ToString::to_string).collect())
}

#[test]
fn paint_that_cannot_be_read_is_named() {
    let told = |fields: Value| paint(&document(&fields), &mut Problems::default()).err().map(|error| error.to_string());
    let click = json!({"frame": 0, "regions": [{"at": [1, 1], "name": "coat"}]});
    assert_eq!(told(json!({"palette": {"coat": [0, 0, 1]}, "fills": [click]})), None);
    let expected = "fills[0] (frame 0).regions[0].name: found \"coat\", expected a name of the field palette, or a colour beside it";
    assert_eq!(told(json!({"fills": [click]})).as_deref(), Some(expected));
    assert!(told(json!({"palette": 7})).is_some_and(|told| told.starts_with("palette: found 7")));
}

#[test]
fn what_lies_outside_of_the_footage_is_named() {
    let clicks = json!([{"frame": 10, "regions": [{"at": [1, 1], "colour": [0, 0, 1]}]}]);
    let filled = json!([{"frame": 12, "regions": []}, {"frame": 13, "regions": []}]);
    let mut problems = Problems::default();
    paint(&document(&json!({"fills": clicks, "filled": filled})), &mut problems).unwrap();
    let told: Vec<_> = problems.iter().map(ToString::to_string).collect();
    assert!(told.contains(&"fills[0].frame: found 10, expected a frame of the footage, 0 to 9".to_owned()), "{told:?}");
    assert!(told.iter().any(|told| told.starts_with("filled: found frames 12-13, which are never drawn")), "{told:?}");
    assert_eq!(problems.error_count(), 1);
}

#[test]
fn limbs_that_cannot_be_bound_are_all_named() {
    let points =
        |a: (&str, f64), b: (&str, f64)| json!({"points": [{"part": a.0, "at": a.1}, {"part": b.0, "at": b.1}]});
    let limb = json!({"from": "r_shoulder", "to": "r_elbow", "start": points(("arm", 0.0), ("nobody", 1.0)),
        "end": points(("arm", 3.5), ("arm", 1.0)), "carries": ["arm", "mitten"]});
    let arm = json!({"name": "arm", "closed": true, "keys": {"0": [[0, 0], [9, 0], [9, 9]]}});
    let document = document(&json!({"parts": [arm], "limbs": [limb]}));
    let mut problems = Problems::default();
    limbs(&document.limbs().unwrap(), &document.scene, &mut problems);
    let told: Vec<_> = problems.iter().map(ToString::to_string).collect();
    let place = "limbs[0] (r_shoulder to r_elbow)";
    assert_eq!(told[0], format!("{place}.start.points[1].part: found \"nobody\", expected one of arm"));
    assert!(told[1].starts_with(&format!("{place}.end.points[0].at: found 3.5, expected 0 to ")), "{told:?}");
    assert_eq!(told[2], "limbs[0].carries: there is no part \"mitten\", so the limb does not carry it");
    assert_eq!((problems.error_count(), problems.warning_count()), (2, 1));
}

#[test]
fn marks_that_contradict_each_other_on_a_frame_are_named() {
    let part = |name: &str| json!({"name": name, "closed": true, "keys": {"0": [[0, 0], [9, 0], [9, 9]]}});
    let told = |second: Value| {
        let marks = [json!({"front": "arm", "behind": "leg", "last": 5}), second];
        let document = document(&json!({"parts": [part("arm"), part("leg")], "depth_marks": marks}));
        let mut problems = Problems::default();
        limbs(&document.limbs().unwrap(), &document.scene, &mut problems);
        problems.iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    let both = "depth_marks[0] (\"arm\" in front of \"leg\"), depth_marks[1] (\"leg\" in front of \"arm\")";
    let found = told(json!({"front": "leg", "behind": "arm", "first": 5}));
    assert_eq!(found, [format!("depth_marks: frame 5: found marks that contradict each other: {both}")]);
    assert!(told(json!({"front": "leg", "behind": "arm", "first": 6})).is_empty());
}

#[test]
fn colours_that_become_others_without_effect_are_named() {
    let click = json!({"frame": 0, "regions": [{"at": [1, 1], "name": "coat", "colour": [0, 0, 1]}]});
    let entry = |from: &str, first| json!({"from": {"name": from, "colour": [1, 0, 0]}, "to": {"name": "wet", "colour": [0, 0, 0]}, "first": first});
    let mut problems = Problems::default();
    let fields = json!({"fills": [click], "recolours": [entry("coat", 5), entry("cape", 5), entry("wet", 11)]});
    // The third one begins with what the first one makes.
    assert!(
        paint(&document(&fields), &mut problems).unwrap_err().to_string().starts_with("recolours[2].to: found \"wet\"")
    );
    let fields = json!({"fills": [click], "recolours": [entry("coat", 5), entry("cape", 5), entry("coat", 11)]});
    paint(&document(&fields), &mut problems).unwrap();
    let told: Vec<String> = problems.warnings().map(ToString::to_string).collect();
    assert_eq!(
        told,
        [
            r#"recolours[1].from: no click and no region has the colour "cape", so it has no effect; the paint has "coat", "wet""#,
            "recolours[2]: it holds on no frame of the footage, 0 to 9"
        ]
    );
}

fn good() -> Value {
    json!({
        "drawings": [
            {"frame": 0, "spacing": [0.2, 0.5, 0.9], "strokes": [
                {"points": [[1, 2], [3, 4]], "closed": false, "peg": "arm"}, {"points": [[1, 2]], "closed": true}]},
            {"frame": 4, "spacing": {"curve": [[0.3, 0.1], [0.8, 1.2]]}, "strokes": [
                {"points": [[1, 2], [3, 4]], "closed": false}]},
            {"frame": 9, "strokes": [{"points": [[5, 5]], "closed": false}]},
        ],
        "pairs": [{"frame": 0, "from": 0, "to": 0}, {"frame": 0, "from": 1, "to": null}],
        "pegs": [{"name": "arm", "parent": "body", "pivot": [1, 1], "keys": [
            {"frame": 0, "turn": 90, "timing": "ease_in"}, {"frame": 4, "scale": 2, "timing": {"bounce": 2}}]},
            {"name": "body", "pivot": [0, 0], "keys": []}],
    })
}

#[track_caller]
fn error(change: impl Fn(&mut Value), expected: &[&str]) {
    let mut fields = good();
    change(&mut fields);
    assert_eq!(said(&fields).0, expected);
}

#[test]
fn what_tweening_and_tracing_wrote_is_read() {
    let stroke = json!({"track": 0, "points": [[1, 2], [3, 4]], "closed": false, "opacity": 1});
    let between = json!([{"frame": 2, "strokes": [stroke]}]);
    let matches = json!([{"frame": 0, "next": 4, "tracks": [[0, 1], [0]]}]);
    let good = {
        let mut fields = good();
        fields["in_betweens"] = between;
        fields["matches"] = matches;
        fields
    };
    assert_eq!(said(&good), (vec![], vec![]));
    let error = |change: &dyn Fn(&mut Value), expected: &str| {
        let mut fields = good.clone();
        change(&mut fields);
        assert_eq!(said(&fields).0, [expected]);
    };
    let opacity = "in_betweens[0] (frame 2).strokes[0].opacity: found 2, expected a number from 0 to 1";
    error(&|f| f["in_betweens"][0]["strokes"][0]["opacity"] = json!(2), opacity);
    error(&|f| f["matches"][0]["tracks"] = json!([[0]]), "matches[0].tracks[1]: found nothing, expected a list");
    let colour = "traced[0] (frame 2).strokes[0].colour[0]: found 255, expected a number from 0 to 1";
    let traced =
        json!([{"frame": 2, "strokes": [{"track": 0, "points": [[1, 2]], "closed": false, "colour": [255, 0, 0]}]}]);
    error(&|f| f["traced"] = traced.clone(), colour);
}

#[test]
fn strokes_outside_of_the_footage_are_warned_of() {
    let drawing = |frame| json!({"frame": frame, "strokes": []});
    let fields = json!({"in_betweens": [drawing(-1), drawing(3)], "traced": [drawing(9), drawing(10), drawing(11)]});
    let mut problems = Problems::default();
    strokes(&document(&fields), &mut problems);
    let told: Vec<String> = problems.warnings().map(ToString::to_string).collect();
    let never =
        |field, frames| format!("{field}: found frames {frames}, which are never drawn: the footage has 0 to 9");
    assert_eq!(told, [never("in_betweens", "-1"), never("traced", "10-11")]);
}

#[test]
fn strips_are_warned_of() {
    let warned = |width, height| {
        let footage = Footage { pattern: "%d.png".into(), first: 0, last: 1, fps: 12.0, width, height, held: false };
        let mut problems = Problems::default();
        shape(&footage, &mut problems);
        problems.warnings().map(ToString::to_string).collect::<Vec<_>>()
    };
    assert!(warned(320, 10).is_empty());
    let told =
        "footage: found pictures of 321x10 pixels; the default preset tracks those at most 32 times as wide as high";
    assert_eq!(warned(321, 10), [told]);
}

#[test]
fn good_drawings_have_no_problems() {
    assert_eq!(said(&good()), (vec![], vec![]));
    assert_eq!(said(&json!({})), (vec![], vec![]));
}

#[test]
fn pairs_name_strokes_that_are_there_each_once() {
    error(
        |f| {
            f["pairs"] = json!([{"frame": 0, "from": 2, "to": 1}, {"frame": 4, "from": 0, "to": 0},
            {"frame": 4, "from": 0, "to": 0}, {"frame": 9, "from": 0, "to": 0}, {"frame": 0, "from": 0}]);
        },
        &[
            "pairs[0] (frame 0).from: found 2, expected the index of one of the 2 strokes on frame 0",
            "pairs[0] (frame 0).to: found 1, expected the index of one of the 1 strokes on frame 4",
            "pairs[2] (frame 4).from: found stroke 0 on frame 4, expected a stroke that pairs[1] does not use",
            "pairs[2] (frame 4).to: found stroke 0 on frame 9, expected a stroke that pairs[1] does not use",
            "pairs[3].frame: found 9, expected the frame of a drawing that has a next one",
            "pairs[4] (frame 0).to: found nothing, expected a whole number from 0 on",
        ],
    );
}

#[test]
fn frames_rise() {
    error(
        |f| {
            f["drawings"][2]["frame"] = json!(4);
            f["pegs"][0]["keys"][1]["frame"] = json!(0);
        },
        &["drawings[2] (frame 4).frame: found 4, expected more than 4, that of drawings[1]"],
    );
    error(
        |f| f["pegs"][0]["keys"][1]["frame"] = json!(0),
        &["pegs[0] \"arm\".keys[1] (frame 0).frame: found 0, expected more than 0, the frame of the key before it"],
    );
}

#[test]
fn pegs_are_a_tree_of_movements() {
    error(
        |f| f["pegs"][1]["parent"] = json!("arm"),
        &["pegs[0] \"arm\".parent: the peg is its own ancestor, expected parents without a loop"],
    );
    error(
        |f| f["pegs"][1]["parent"] = json!("body"),
        &["pegs[1] \"body\".parent: the peg is its own ancestor, expected parents without a loop"],
    );
    error(
        |f| {
            f["pegs"][0]["keys"][0]["scale"] = json!(0);
            f["pegs"][0]["keys"][1]["scale"] = json!(-1);
            f["pegs"][0]["keys"][1]["turn"] = json!(1e300);
        },
        &[
            "pegs[0] \"arm\".keys[0] (frame 0).scale: found 0, expected a number from 1e-6 to 1e9",
            "pegs[0] \"arm\".keys[1] (frame 4).turn: found 1e300, expected a number between -5e10 and 5e10",
            "pegs[0] \"arm\".keys[1] (frame 4).scale: found -1, expected a number from 1e-6 to 1e9",
        ],
    );
    error(
        |f| f["pegs"] = json!([{"name": "arm", "pivot": [1e7, 0], "keys": []}, {"name": "arm", "pivot": [0, 0]}, 7]),
        &[
            "pegs[1] \"arm\".name: found \"arm\", expected a unique name: it is that of pegs[0]",
            "pegs[2]: found 7, expected an object",
            "pegs[0] \"arm\".pivot: found [10000000.0,0], expected a point [x, y] of numbers between -1e6 and 1e6",
            "pegs[1] \"arm\".keys: found nothing, expected a list",
        ],
    );
    error(
        |f| f["drawings"][1]["strokes"][0]["peg"] = json!("leg"),
        &["drawings[1] (frame 4).strokes[0].peg: found \"leg\", expected the name of a peg"],
    );
}

#[test]
fn movements_are_known_and_charts_are_whole() {
    error(
        |f| {
            f["drawings"][0]["spacing"] = json!([0.5]);
            f["drawings"][1]["spacing"] = json!("quickly");
            f["pegs"][0]["keys"][0]["timing"] = json!("slowly");
        },
        &[
            "drawings[0] (frame 0).spacing: the spacing chart has 1 shares, expected one for each of 3 frames to the \
             next key",
            "drawings[1] (frame 4).spacing: found \"quickly\", expected a movement function: smooth, constant, linear, \
             ease_in, ease_out, ease_in_out, cosine or bounce",
            "pegs[0] \"arm\".keys[0] (frame 0).timing: found \"slowly\", expected a movement function: constant, linear, \
             ease_in, ease_out, ease_in_out, cosine or bounce",
        ],
    );
    error(
        |f| f["drawings"][1]["spacing"] = json!({"curve": [[0.5, 0.1], [0.5, 0.2]]}),
        &["drawings[1] (frame 4).spacing: place 1 of the curve is at time 0.5, expected a time after the previous"],
    );
    error(
        |f| f["pegs"][0]["keys"][0]["timing"] = json!({"curve": [[2, 0.1]]}),
        &[
            "pegs[0] \"arm\".keys[0] (frame 0).timing: place 0 of the curve is (2, 0.1), expected a time from 0 to 1 and a \
             finite share",
        ],
    );
}

#[test]
fn all_that_is_wrong_is_found_at_once() {
    error(
        |f| {
            f["drawings"][0]["frame"] = json!("x");
            f["drawings"][1]["strokes"] = json!([{"points": [[1, null]], "closed": false}, {"points": []}]);
            f["drawings"][2]["corner"] = json!(1);
            f["pairs"] = json!([{"frame": 4, "from": 1, "to": 0}]);
        },
        &[
            "drawings[0].frame: found \"x\", expected a frame number",
            "drawings[1] (frame 4).strokes[0].points[0]: found [1,null], expected a point [x, y] of numbers between -1e6 \
             and 1e6",
            "drawings[1] (frame 4).strokes[1].closed: found nothing, expected true or false",
            "drawings[2] (frame 9).corner: found 1, expected true or false",
        ],
    );
    error(|f| f["drawings"] = json!({}), &["drawings: found an object, expected a list"]);
}

#[test]
fn what_has_no_effect_is_a_warning() {
    let mut fields = good();
    fields["drawings"] = json!([{"frame": 12, "spacing": "linear", "strokes": [{"points": [], "closed": false}]}]);
    fields["pairs"] = json!([]);
    assert_eq!(
        said(&fields),
        (
            vec![],
            vec![
                "drawings[0] (frame 12).spacing: there is no next drawing, so the spacing has no effect".to_owned(),
                "drawings: there is one drawing, so there is nothing to draw between".to_owned(),
                "drawings[0] (frame 12): the drawing is outside of the footage, frames 0 to 9".to_owned(),
                "drawings[0] (frame 12).strokes[0]: the stroke has no points, so nothing is drawn".to_owned(),
                "pegs[0] \"arm\": no stroke hangs on the peg, so it has no effect".to_owned(),
                "pegs[1] \"body\": no stroke hangs on the peg, so it has no effect".to_owned(),
            ]
        )
    );
}
