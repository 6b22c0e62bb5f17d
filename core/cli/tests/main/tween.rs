//! Tests of `rototoon tween` from the command line.

use image::{ImageBuffer, Rgb};
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A folder with a document that has footage, no parts, and these fields.
fn project(fields: Value) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let footage = json!({"pattern": "f_%03d.png", "first": 0, "last": 20, "fps": 24, "width": 200, "height": 100});
    let mut document = json!({"rototoon": 1, "footage": footage, "parts": [], "note": "kept"});
    document.as_object_mut().unwrap().extend(fields.as_object().unwrap().clone());
    let path = folder.path().join("project.json");
    fs::write(&path, document.to_string()).unwrap();
    (folder, path)
}

fn tween(from: &Path, to: &Path, more: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_rototoon")).arg("tween").arg(from).arg("-o").arg(to).args(more).output().unwrap()
}

fn square(x: f64, y: f64, side: f64) -> Value {
    json!({"closed": true, "points": [[x, y], [x + side, y], [x + side, y + side], [x, y + side]]})
}

fn line(x: f64) -> Value {
    json!({"closed": false, "points": [[x, 10], [x + 8.0, 40], [x + 30.0, 60]], "material": 2})
}

/// Eight curved strokes at places that follow from `seed`.
fn scribble(seed: u64) -> Value {
    let mut state = seed;
    let mut random = |limit: f64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        limit * (state >> 32) as f64 / f64::from(u32::MAX)
    };
    let mut stroke = || {
        let (x, y, angle, bend) = (random(150.0), random(70.0), random(6.0), random(0.6) - 0.3);
        let at = |k: i32| {
            let (far, turn) = (5.0 * f64::from(k), angle + bend * f64::from(k));
            [x + far * turn.cos(), y + far * turn.sin()]
        };
        json!({"closed": false, "points": (0..10).map(at).collect::<Vec<_>>()})
    };
    (0..8).map(|_| stroke()).collect()
}

fn two_drawings() -> Value {
    json!({"drawings": [
        {"frame": 2, "spacing": "linear", "strokes": [square(100.0, 20.0, 30.0), line(10.0)]},
        {"frame": 6, "strokes": [line(30.0), square(120.0, 20.0, 30.0)]},
    ]})
}

#[test]
fn in_betweens_and_matches_are_written() {
    let (folder, path) = project(two_drawings());
    let out = folder.path().join("out.json");
    let output = tween(&path, &out, &[]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let written: Value = serde_json::from_str(&fs::read_to_string(&out).unwrap()).unwrap();
    assert_eq!(written["note"], "kept");
    assert_eq!(written["drawings"], two_drawings()["drawings"]);
    let pairs = written["matches"][0]["pairs"].as_array().unwrap();
    assert_eq!(pairs.iter().map(|p| p["to"].as_u64().unwrap()).collect::<Vec<_>>(), [1, 0]);
    let between = written["in_betweens"].as_array().unwrap();
    assert_eq!(between.iter().map(|d| d["frame"].as_i64().unwrap()).collect::<Vec<_>>(), [3, 4, 5]);
    let half = &between[1]["strokes"];
    assert_eq!(half[0]["points"][0], json!([110.0, 20.0]));
    assert_eq!((&half[1]["points"][2], &half[1]["material"]), (&json!([50.0, 60.0]), &json!(2)));
    let again = folder.path().join("again.json");
    assert!(tween(&out, &again, &["--threads", "1"]).status.success());
    assert_eq!(fs::read(&out).unwrap(), fs::read(&again).unwrap());
}

#[test]
fn strokes_follow_the_tracked_parts_that_they_lie_on() {
    // The part is a square that moves away and comes back. The drawings have that square, and a line that is no part.
    let at = |x: f64| json!([[x, 20.0], [x + 30.0, 20.0], [x + 30.0, 50.0], [x, 50.0]]);
    let tracks = json!({"2": at(100.0), "3": at(125.0), "4": at(140.0), "5": at(125.0), "6": at(102.0)});
    let keys = json!({"2": at(100.0), "6": at(102.0)});
    let part = json!({"name": "box", "closed": true, "keys": keys, "tracks": tracks});
    let drawings = json!([
        {"frame": 2, "spacing": "linear", "strokes": [square(100.0, 20.0, 30.0), line(10.0)]},
        {"frame": 6, "strokes": [square(102.0, 20.0, 30.0), line(30.0)]},
    ]);
    let (folder, path) = project(json!({"drawings": drawings, "parts": [part]}));
    let corner = |more: &[&str]| {
        let out = folder.path().join("out.json");
        let output = tween(&path, &out, more);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let written: Value = serde_json::from_str(&fs::read_to_string(&out).unwrap()).unwrap();
        let half = written["in_betweens"][1]["strokes"].clone();
        assert_eq!(half[1]["points"][2], json!([50.0, 60.0]), "the line does not follow the part");
        half[0]["points"][0].clone()
    };
    assert_eq!(corner(&[]), json!([140.0, 20.0]));
    assert_eq!(corner(&["--captured", "ignore"]), json!([101.0, 20.0]));
}

#[test]
fn pairs_made_by_hand_and_pegs_are_respected() {
    let mut fields = two_drawings();
    fields["pairs"] = json!([{"frame": 2, "from": 1, "to": null}]);
    fields["pegs"] = json!([{"name": "wheel", "pivot": [115, 35],
        "keys": [{"frame": 2, "timing": "linear"}, {"frame": 6, "shift": [20, 0], "turn": 360}]}]);
    fields["drawings"][0]["strokes"][0]["peg"] = json!("wheel");
    let (folder, path) = project(fields);
    let out = folder.path().join("out.json");
    let output = tween(&path, &out, &["--leaving", "fade"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let written: Value = serde_json::from_str(&fs::read_to_string(&out).unwrap()).unwrap();
    assert_eq!(written["matches"][0]["vanished"], json!([1]));
    let half = &written["in_betweens"][1]["strokes"];
    let turned = half.as_array().unwrap().iter().find(|s| s["closed"] == true).unwrap();
    assert_eq!(turned["points"][0], json!([140.0, 50.0]), "half a turn");
    let opacities: Vec<f64> = half
        .as_array()
        .unwrap()
        .iter()
        .filter(|s| s["closed"] == false)
        .map(|s| s["opacity"].as_f64().unwrap())
        .collect();
    assert_eq!(opacities, [0.5, 0.5]);
}

#[test]
fn errors_are_named_and_nothing_is_written() {
    let bad = |change: &dyn Fn(&mut Value), expected: &str| {
        let mut fields = two_drawings();
        change(&mut fields);
        let (folder, path) = project(fields);
        let out = folder.path().join("out.json");
        let output = tween(&path, &out, &[]);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1), "{said}");
        assert!(said.contains(expected) && said.contains("project.json"), "{said}");
        assert!(!out.exists());
    };
    bad(&|f| f["drawings"] = json!([]), "drawings: found 0, expected at least two");
    bad(&|f| f["drawings"][1]["frame"] = json!(2), "drawings[1] (frame 2).frame: found 2, expected more than 2");
    bad(&|f| f["drawings"][0]["spacing"] = json!("fast"), "drawings[0] (frame 2).spacing: found \"fast\"");
    bad(&|f| f["drawings"][0]["spacing"] = json!([0.5]), "has 1 shares, expected one for each of 3 frames");
    bad(
        &|f| f["pairs"] = json!([{"frame": 2, "from": 9, "to": 0}]),
        "pairs[0] (frame 2).from: found 9, expected the index of one of the 2 strokes",
    );
    let pegs = |keys: Value| {
        json!([{"name": "a", "parent": "b", "pivot": [0, 0], "keys": keys}, {"name": "b", "parent": "a",
        "pivot": [0, 0], "keys": []}])
    };
    bad(&|f| f["pegs"] = pegs(json!([])), "is its own ancestor");
    bad(&|f| f["pegs"] = pegs(json!([{"frame": 2, "scale": 0}])), "peg \"a\", frame 2: scale is 0");
    let wrong_use = tween(Path::new("none.json"), Path::new("out.json"), &["--arcs", "2"]);
    assert_eq!(wrong_use.status.code(), Some(2));
}

/// A document with two drawings of a bar that moves by 80 px from frame 2 to frame 10.
fn moved_bar() -> (tempfile::TempDir, PathBuf) {
    let bar = |x: f64| json!({"closed": false, "points": [[x, 20], [x, 50], [x, 80]]});
    project(json!({"drawings": [
        {"frame": 2, "spacing": "linear", "strokes": [bar(40.5)]}, {"frame": 10, "strokes": [bar(120.5)]}]}))
}

/// What `--suggest` says of a line test of [`moved_bar`]; on the frames between, the pictures show it at `places`.
fn suggested(places: &[(i32, f64)]) -> String {
    let (folder, path) = moved_bar();
    for &(frame, place) in places {
        let picture = ImageBuffer::from_fn(200, 100, |x, y| {
            let ink = (f64::from(x) + 0.5 - place).abs() < 1.5 && (20..80).contains(&y);
            Rgb([if ink { 20u8 } else { 250 }; 3])
        });
        picture.save(folder.path().join(format!("f_{frame:03}.png"))).unwrap();
    }
    let output = tween(&path, &folder.path().join("out.json"), &["--suggest"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stderr).trim_end().to_owned()
}

#[test]
fn a_drawing_that_is_held_is_said() {
    let (folder, path) = project(json!({"drawings": [
        {"frame": 0, "strokes": scribble(1)}, {"frame": 4, "strokes": scribble(2)}, {"frame": 5, "strokes": scribble(1)},
        {"frame": 8, "strokes": scribble(1)}]}));
    let out = folder.path().join("out.json");
    let output = tween(&path, &out, &[]);
    let said = String::from_utf8_lossy(&output.stderr);
    // Nothing is between 4 and 5.
    assert!(output.status.success() && said.starts_with("note: frames 0 to 4: no movement"), "{said}");
    assert_eq!(said.lines().count(), 1, "{said}");
    let written: Value = serde_json::from_str(&fs::read_to_string(&out).unwrap()).unwrap();
    let held = |k: usize| written["matches"][k].get("held").cloned();
    assert_eq!([held(0), held(1), held(2)], [Some(json!(true)), Some(json!(true)), None]);
    for between in &written["in_betweens"].as_array().unwrap()[..3] {
        let points = |k: usize| between["strokes"][k]["points"].as_array().unwrap().len();
        assert_eq!((0..8).map(points).sum::<usize>(), 80, "the strokes of the earlier drawing");
    }
}

/// A face of eight strokes above a floor, at a place, turned and stretched.
fn face(at: [f64; 2], turn: f64, size: [f64; 2]) -> Value {
    let put = |x: f64, y: f64| {
        let (x, y, (sin, cos)) = (x * size[0], y * size[1], turn.sin_cos());
        [at[0] + cos * x - sin * y, at[1] + sin * x + cos * y]
    };
    let arc = |x: f64, y: f64, a: f64, b: f64, turns: f64, count: i32, closed: bool| {
        let of = |k: i32| std::f64::consts::TAU * turns * f64::from(k) / f64::from(count);
        let points: Vec<[f64; 2]> =
            (0..count + i32::from(!closed)).map(|k| put(x + a * of(k).cos(), y + b * of(k).sin())).collect();
        json!({"points": points, "closed": closed})
    };
    let mut strokes = vec![json!({"points": [[20, 453], [320, 453], [620, 453]], "closed": false})];
    strokes.push(arc(0.0, 0.0, 75.0, 65.0, 1.0, 60, true));
    for side in [-25.0, 25.0] {
        strokes.push(arc(side, -15.0, 14.0, 18.0, 1.0, 32, true));
        strokes.push(arc(side + 4.0, -11.0, 6.0, 7.0, 1.0, 20, true));
        strokes.push(arc(side, -38.0, 12.0, -5.0, 0.5, 8, false));
    }
    strokes.push(arc(0.0, 14.0, 36.0, 14.0, 0.5, 16, false));
    json!(strokes)
}

#[test]
fn a_face_that_is_drawn_again_bends_and_moves_as_itself() {
    let poses = [face([90.0, 400.0], -0.25, [1.2, 0.8]), face([299.0, 287.0], 0.0, [0.8, 1.25])];
    let drawings: Vec<Value> =
        [0, 10].iter().zip(&poses).map(|(frame, strokes)| json!({"frame": frame, "strokes": strokes})).collect();
    let (folder, path) = project(json!({"drawings": drawings}));
    let out = folder.path().join("out.json");
    let output = tween(&path, &out, &[]);
    assert!(output.status.success() && output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
    let written: Value = serde_json::from_str(&fs::read_to_string(&out).unwrap()).unwrap();
    let tracks = &written["matches"][0]["tracks"];
    assert_eq!(tracks[0], tracks[1], "each stroke has its own number on both drawings");
    for between in written["in_betweens"].as_array().unwrap() {
        let strokes = between["strokes"].as_array().unwrap();
        assert_eq!(strokes.len(), 9, "frame {}", between["frame"]);
        let floor = strokes.iter().find(|stroke| stroke["track"] == tracks[0][0]).unwrap();
        let level = |point: &Value| (point[1].as_f64().unwrap() - 453.0).abs() < 0.5;
        assert!(floor["points"].as_array().unwrap().iter().all(level), "the floor stays: {floor}");
    }
}

#[test]
fn a_breakdown_is_suggested_where_the_line_test_differs_most() {
    // The bar runs ahead of an even movement, most of all on frame 8.
    let ahead = [0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 1.5, 0.0];
    let mut places: Vec<(i32, f64)> =
        (2..=10).zip(ahead).map(|(frame, ahead)| (frame, 40.5 + 10.0 * f64::from(frame - 2) + ahead)).collect();
    let said = suggested(&places);
    let start = "note: breakdown: frame 8, between the keys 2 and 10: the in-between is ";
    assert!(said.starts_with(start) && said.contains("px off the picture, the keys 0."), "{said}");
    // A picture that is missing is not judged.
    places.remove(6);
    assert!(!suggested(&places).contains("frame 8"));
}

#[test]
fn a_picture_that_cannot_be_read_is_named_with_the_document() {
    let (folder, path) = moved_bar();
    fs::write(folder.path().join("f_004.png"), "no picture").unwrap();
    let output = tween(&path, &folder.path().join("out.json"), &["--suggest"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(said.starts_with(&format!("error: {}: frame 4: cannot read", path.display())), "{said}");
}

#[test]
fn a_breakdown_is_suggested_in_the_middle_where_no_picture_shows_it() {
    let middle = "note: breakdown: frame 6, between the keys 2 and 10: the middle of the span that moves most. ";
    assert_eq!(suggested(&[]), format!("{middle}No picture shows the movement"));
    let elsewhere: Vec<(i32, f64)> = (2..=10).map(|frame| (frame, 190.0)).collect();
    let said = suggested(&elsewhere);
    assert!(said.starts_with(&format!("{middle}The pictures show something else: the keys are ")), "{said}");
}

#[test]
fn check_finds_all_that_is_wrong_with_drawings_pairs_and_pegs() {
    let check = |path: &Path| {
        let output = Command::new(env!("CARGO_BIN_EXE_rototoon")).arg("check").arg(path).output().unwrap();
        // Missing frames of the footage are reported too, and left out here.
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        let start = format!(": {}: ", path.display());
        let lines: Vec<String> =
            said.lines().filter(|l| !l.contains("footage: ")).map(|l| l.replacen(&start, " ", 1)).collect();
        (output.status.code(), lines)
    };
    let (_folder, path) = project(two_drawings());
    assert_eq!(check(&path).1, ["warning parts: there is no part, so there is nothing to track"]);
    let mut fields = two_drawings();
    fields["drawings"][0]["spacing"] = json!("fast");
    fields["pegs"] = json!([{"name": "a", "parent": "a", "pivot": [0, 0], "keys": [{"frame": 2, "scale": 0}]}]);
    let (_folder, path) = project(fields.clone());
    assert_eq!(
        check(&path).1[1..],
        [
            "error drawings[0] (frame 2).spacing: found \"fast\", expected a movement function: smooth, constant, linear, \
             ease_in, ease_out, ease_in_out, cosine or bounce",
            "error pegs[0] \"a\".keys[0] (frame 2).scale: found 0, expected a number from 1e-6 to 1e9",
            "error pegs[0] \"a\".parent: the peg is its own ancestor, expected parents without a loop",
            "warning pegs[0] \"a\": no stroke hangs on the peg, so it has no effect",
        ]
    );
    fields["pairs"] = json!([{"frame": 2, "from": 5, "to": 0}]);
    fields["limbs"] = json!([7]);
    let (_folder, path) = project(fields);
    assert_eq!(
        check(&path).1[1..],
        [
            "error limbs[0]: found 7, expected an object",
            "error pairs[0] (frame 2).from: found 5, expected the index of one of the 2 strokes on frame 2",
        ]
    );
    // JSON has no NaN. The reader names the line and column.
    fs::write(&path, fs::read_to_string(&path).unwrap().replacen("130.0", "NaN", 1)).unwrap();
    let (code, lines) = check(&path);
    assert!(code == Some(1) && lines.len() == 1 && lines[0].starts_with("error line 1, column "), "{lines:?}");
}
