//! Tests of `rototoon style reshape` on results that the artist corrected.

use super::style_reshape::{figure, read, ring, rototoon, said, write};
use serde_json::{Value, json};
use std::path::Path;

/// Clips of two motions, and a drawing that was reshaped by the first.
fn reshaped(folder: &Path) -> Value {
    for (name, frames) in [("a", 9), ("b", 7)] {
        write(folder, "shot.json", &figure(frames));
        let out = format!("{name}.json");
        let done = rototoon(folder, &["style", "clip", "shot.json", "--character", "x", "--motion", name, "-o", &out]);
        assert!(done.status.success(), "{}", said(&done));
    }
    write(folder, "doll.json", &figure(1));
    let done = rototoon(folder, &["style", "reshape", "doll.json", "a.json", "-o", "m.json"]);
    assert!(done.status.success() && !said(&done).contains("corrections"), "{}", said(&done));
    read(folder, "m.json")
}

/// All numbers of a value in order: a program may write 33.0 as 33.
fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(list) => list.iter().flat_map(numbers).collect(),
        Value::Object(fields) => fields.values().flat_map(numbers).collect(),
        other => other.as_f64().into_iter().collect(),
    }
}

fn corrected(mut made: Value) -> Value {
    made["parts"][0]["pins"] = json!({"3": {"1": [90.5, 40.25]}});
    made["parts"][0]["centers"] = json!({"5": [70.5, 33.0]});
    made["parts"][1]["keys"]["4"] = ring(90.0, 20.0, 50.0, 6.0, 0);
    made
}

#[test]
fn pins_centres_and_keys_on_generated_frames_stay_and_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let made = corrected(reshaped(folder));
    write(folder, "m.json", &made);
    // More than once: what stays is still the artist's the next time.
    for clip in ["b.json", "a.json", "b.json"] {
        let done = rototoon(folder, &["style", "reshape", "m.json", clip, "-o", "m.json"]);
        let told = said(&done);
        assert!(done.status.success(), "{told}");
        let wanted = "warning: m.json: your corrections stay: \"body\" on 3, 5, \"arm\" on 4";
        assert!(told.contains(wanted), "{told}");
        let again = read(folder, "m.json");
        let [body, arm] = [0, 1].map(|k| &again["parts"][k]);
        for (now, before) in [
            (&body["pins"]["3"], &made["parts"][0]["pins"]["3"]),
            (&body["centers"]["5"], &made["parts"][0]["centers"]["5"]),
            (&arm["keys"]["4"], &made["parts"][1]["keys"]["4"]),
            // A key is the contour of its frame.
            (&arm["tracks"]["4"], &made["parts"][1]["keys"]["4"]),
        ] {
            assert_eq!(numbers(now), numbers(before), "{now} {before}");
        }
        let pinned = &body["tracks"]["3"];
        assert_eq!(numbers(&pinned[1]), [90.5, 40.25]);
        assert_eq!(
            numbers(&pinned[2]),
            numbers(&made["parts"][0]["tracks"]["3"][2]),
            "the rest of the contour stays as it was"
        );
        let mean = |axis: usize| {
            let points = body["tracks"]["5"].as_array().unwrap();
            points.iter().map(|p| p[axis].as_f64().unwrap()).sum::<f64>() / points.len() as f64
        };
        assert!((mean(0) - 70.5).abs() < 1e-3 && (mean(1) - 33.0).abs() < 1e-3, "{}", body["tracks"]["5"]);
        let last = if clip == "a.json" { "8" } else { "6" };
        let keys: Vec<&String> = arm["keys"].as_object().unwrap().keys().collect();
        assert_eq!(keys, ["0", "4", last], "keys that were made go with their clip");
        assert!(!told.contains("the clip ends"), "{told}");
    }
}

#[test]
fn corrections_that_the_clip_does_not_reach_stay_too() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let mut made = reshaped(folder);
    // The last key was made, and then drawn anew.
    made["parts"][1]["keys"]["8"] = ring(90.0, 20.0, 50.0, 6.0, 0);
    write(folder, "m.json", &made);
    let done = rototoon(folder, &["style", "reshape", "m.json", "b.json", "-o", "m.json"]);
    let told = said(&done);
    assert!(told.contains("your corrections stay: \"arm\" on 8; the clip ends on 6"), "{told}");
    let again = read(folder, "m.json");
    assert_eq!(numbers(&again["parts"][1]["keys"]["8"]), numbers(&made["parts"][1]["keys"]["8"]));
    assert_eq!(again["footage"]["last"], json!(8));
    assert_eq!(again["parts"][0]["keys"].as_object().unwrap().len(), 2);
}

#[test]
fn keys_of_a_shot_are_not_put_into_another_motion_and_that_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    reshaped(folder);
    let mut shot = figure(5);
    shot["parts"][1]["keys"]["3"] = ring(90.0, 20.0, 50.0, 6.0, 0);
    shot["parts"][1]["pins"] = json!({"2": {"1": [90.5, 40.25]}});
    write(folder, "shot.json", &shot);
    let done = rototoon(folder, &["style", "reshape", "shot.json", "b.json", "-o", "other.json"]);
    let told = said(&done);
    assert!(
        told.contains(
            "note: shot.json: keys and corrections of the drawing's own motion are not in the result: \"arm\", on 2-3"
        ),
        "{told}"
    );
    let other = read(folder, "other.json");
    assert!(other["parts"][1].get("pins").is_none_or(|pins| pins == &json!({})), "{}", other["parts"][1]);
    assert!(!told.contains("your corrections"), "{told}");
}

#[test]
fn keys_that_were_changed_after_tracking_are_named_and_their_frames_stay_lost() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let mut shot = figure(6);
    let contours = shot["parts"][1]["keys"].take();
    let confidence: serde_json::Map<String, Value> =
        (1..5).map(|frame| (frame.to_string(), json!(vec![if frame < 4 { 0.2 } else { 0.95 }; 8]))).collect();
    shot["parts"][1]["keys"] = json!({"0": contours["0"], "5": contours["5"]});
    shot["parts"][1]["tracks"] = contours;
    shot["parts"][1]["confidence"] = json!(confidence);
    shot["parts"][1]["keys"]["2"] = ring(90.0, 20.0, 50.0, 6.0, 0);
    write(folder, "shot.json", &shot);
    let old = "warning: shot.json: keys were changed after tracking, and the old contours are used: \"arm\"; run `rototoon track` first";
    let clip = ["style", "clip", "shot.json", "--character", "a", "--motion", "b", "-o", "clips.json"];
    let told = said(&rototoon(folder, &clip));
    assert!(told.contains(old), "{told}");
    assert!(told.contains("part \"arm\" (r_shoulder to r_wrist): lost on 1-3;"), "{told}");
    let reshape = ["style", "reshape", "shot.json", "clips.json", "-o", "out.json"];
    let told = said(&rototoon(folder, &reshape));
    assert!(told.contains(old), "{told}");
}

#[test]
fn a_drawing_on_one_picture_moves_before_that_picture() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let made = reshaped(folder);
    assert_eq!((&made["footage"]["last"], &made["footage"]["gaps"]), (&json!(8), &json!("held")));
    // Another program's document ends before its contours.
    let mut short = made;
    short["footage"]["last"] = json!(0);
    for part in short["parts"].as_array_mut().unwrap() {
        part["keys"] = json!({"0": part["keys"]["0"]});
    }
    write(folder, "short.json", &short);
    let wanted = "contours on frames 1-8 are outside of the footage, frames 0 to 0, so no picture and no shape has them: \"body\", \"arm\"";
    for arguments in [
        &["check", "short.json"][..],
        &["export", "short.json", "-o", "s.svg"],
        &["export", "short.json", "-o", "s_%d.svg"],
        &["export", "short.json", "-o", "s.nk"],
        &["render", "short.json", "-o", "s_%d.png", "--what", "matte"],
    ] {
        let told = said(&rototoon(folder, arguments));
        assert!(told.contains(wanted), "{arguments:?}: {told}");
    }
    let told = said(&rototoon(folder, &["export", "short.json", "--frames", "0-0", "-o", "s.svg"]));
    assert!(!told.contains("outside of the footage"), "{told}");
}
