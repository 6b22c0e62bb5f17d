//! Tests of `rototoon style clip` and `rototoon style reshape` from the command line.

use serde_json::{Value, json};
use std::path::Path;
use std::process::{Command, Output};

pub(super) fn rototoon(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_rototoon")).current_dir(folder).args(arguments).output().unwrap()
}

pub(super) fn said(done: &Output) -> String {
    String::from_utf8_lossy(&done.stderr).into_owned()
}

/// Eight points: four down the right side, then four up the left side. The frame's number moves them to the right.
pub(super) fn ring(x: f64, top: f64, bottom: f64, half: f64, frame: usize) -> Value {
    let at = |k: usize| {
        let y =
            if k < 4 { top + (bottom - top) * k as f64 / 3.0 } else { bottom - (bottom - top) * (k - 4) as f64 / 3.0 };
        [x + if k < 4 { half } else { -half } + frame as f64, y]
    };
    json!((0..8).map(at).collect::<Vec<_>>())
}

pub(super) fn figure(frames: usize) -> Value {
    let part = |name: &str, depth: usize, x: f64, top: f64, bottom: f64, half: f64| {
        let keys: serde_json::Map<String, Value> =
            (0..frames).map(|f| (f.to_string(), ring(x, top, bottom, half, f))).collect();
        json!({"name": name, "closed": true, "depth": depth, "keys": keys})
    };
    let limb = |from: &str, to: &str, part: &str, places: [f64; 4]| {
        let point = |at: f64| json!({"part": part, "at": at});
        let [a, b, c, d] = places.map(point);
        json!({"from": from, "to": to, "start": {"points": [a, b]}, "end": {"points": [c, d]}})
    };
    json!({
        "rototoon": 1,
        "footage": {"pattern": "f_%d.png", "first": 0, "last": frames - 1, "fps": 12, "width": 120, "height": 120},
        "parts": [part("body", 1, 50.0, 20.0, 62.0, 12.0), part("arm", 2, 66.0, 22.0, 58.0, 5.0)],
        "limbs": [
            limb("pelvis", "neck", "body", [3.0, 4.0, 0.0, 7.0]),
            limb("r_shoulder", "r_wrist", "arm", [0.0, 7.0, 3.0, 4.0]),
        ],
    })
}

pub(super) fn write(folder: &Path, name: &str, value: &Value) {
    std::fs::write(folder.join(name), value.to_string()).unwrap();
}

pub(super) fn read(folder: &Path, name: &str) -> Value {
    serde_json::from_str(&std::fs::read_to_string(folder.join(name)).unwrap()).unwrap()
}

#[test]
fn contours_become_a_clip_and_a_drawing_follows_it() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write(folder, "shot.json", &figure(5));
    write(folder, "doll.json", &figure(1));
    let clip = ["style", "clip", "shot.json", "--character", "anna", "--motion", "glide", "-o", "clips.json"];
    let done = rototoon(folder, &clip);
    assert!(done.status.success(), "{}", said(&done));
    assert!(said(&done).contains("warning: shot.json: r_elbow: filled in on 5 of 5 frames"), "{}", said(&done));
    let clips = read(folder, "clips.json");
    assert_eq!((&clips["fps"], &clips["clips"][0]["motion"]), (&json!(12.0), &json!("glide")));
    assert_eq!(clips["clips"][0]["points"][3][0], json!([53.0, 62.0]));
    let done = rototoon(folder, &["style", "reshape", "doll.json", "clips.json", "-o", "moved.json"]);
    assert!(done.status.success(), "{}", said(&done));
    let moved = read(folder, "moved.json");
    assert_eq!(moved["footage"]["last"], json!(4));
    for part in moved["parts"].as_array().unwrap() {
        let x = |frame: &str| part["tracks"][frame][0][0].as_f64().unwrap();
        assert!((x("4") - x("0") - 4.0).abs() < 1e-3, "{part}");
    }
    // The result can be rendered and exported like a tracked document.
    let render = ["render", "moved.json", "-o", "m_%02d.png", "--what", "matte"];
    assert!(rototoon(folder, &render).status.success() && folder.join("m_04.png").exists());
    assert!(rototoon(folder, &["export", "moved.json", "-o", "moved.svg"]).status.success());
}

#[test]
fn lost_and_doubtful_contours_of_a_clip_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let mut shot = figure(6);
    let keys = shot["parts"][1]["keys"].take();
    let confidence: serde_json::Map<String, Value> = [("1", 0.2), ("2", 0.3), ("3", 0.95), ("4", 0.6)]
        .map(|(frame, c)| (frame.to_owned(), json!(vec![c; 8])))
        .into_iter()
        .collect();
    shot["parts"][1]["keys"] = json!({"0": keys["0"], "5": keys["5"]});
    shot["parts"][1]["tracks"] = keys;
    shot["parts"][1]["confidence"] = json!(confidence);
    write(folder, "shot.json", &shot);
    let clip = |more: &[&str]| {
        let fixed = ["style", "clip", "shot.json", "--character", "a", "--motion", "b", "-o", "clips.json"];
        said(&rototoon(folder, &[&fixed[..], more].concat()))
    };
    let all = clip(&[]);
    let wanted = "warning: shot.json: part \"arm\" (r_shoulder to r_wrist): lost on 1-2; doubtful on 4; the clip has";
    assert!(all.contains(wanted) && !all.contains("part \"body\""), "{all}");
    let end = clip(&["--frames", "3-5"]);
    assert!(end.contains("(r_shoulder to r_wrist): doubtful on 4;"), "{end}");
}

#[test]
fn a_clip_of_another_rate_lasts_as_long_and_lines_that_lie_on_nothing_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write(folder, "shot.json", &figure(9));
    let mut doll = figure(1);
    doll["footage"]["fps"] = json!(24);
    let line = json!({"name": "ground line", "closed": false, "keys": {"0": [[-100, 110], [300, 110]]}});
    doll["parts"].as_array_mut().unwrap().push(line);
    write(folder, "doll.json", &doll);
    let clip = ["style", "clip", "shot.json", "--character", "anna", "--motion", "glide", "-o", "clips.json"];
    assert!(rototoon(folder, &clip).status.success());
    let done = rototoon(folder, &["style", "reshape", "doll.json", "clips.json", "-o", "moved.json"]);
    let told = said(&done);
    assert!(done.status.success(), "{told}");
    let rate = "note: doll.json: the clip has 12 frames a second and the document 24, so its 9 frames become 17";
    assert!(told.contains(rate), "{told}");
    let stays = "warning: doll.json: part \"ground line\": no limb carries it, so it stays where it is drawn";
    assert!(told.contains(stays), "{told}");
    let moved = read(folder, "moved.json");
    assert_eq!((&moved["footage"]["last"], moved["footage"]["fps"].as_f64()), (&json!(16), Some(24.0)));
    let x = |frame: &str| moved["parts"][0]["tracks"][frame][0][0].as_f64().unwrap();
    assert!((x("16") - x("0") - 8.0).abs() < 1e-3 && (x("8") - x("0") - 4.0).abs() < 1e-3);
    assert_eq!(moved["parts"][2]["tracks"]["9"], json!([[-100, 110], [300, 110]]));
}

#[test]
fn errors_name_their_file() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let mut shot = figure(3);
    shot["limbs"][1]["end"]["points"][1]["at"] = json!(12);
    write(folder, "shot.json", &shot);
    let clip = |file: &str, more: &[&str]| {
        let fixed = ["style", "clip", file, "--character", "a", "--motion", "b", "-o", "clips.json"];
        rototoon(folder, &[&fixed[..], more].concat())
    };
    let done = clip("shot.json", &[]);
    assert_eq!(done.status.code(), Some(1));
    assert_eq!(
        said(&done),
        "error: shot.json: limbs[1] (r_shoulder to r_wrist).end.points[1].at: found 12, expected 0 to 8 on \"arm\"\n"
    );
    let late = clip("shot.json", &["--frames", "0-9"]);
    assert_eq!(late.status.code(), Some(2));
    assert_eq!(said(&late), "error: shot.json: --frames: found 0 to 9, expected frames of the footage, 0 to 2\n");
    assert!(!folder.join("clips.json").exists());
    write(folder, "shot.json", &figure(3));
    assert!(clip("shot.json", &[]).status.success());
    let reshape = |more: &[&str]| {
        rototoon(folder, &[&["style", "reshape", "shot.json", "clips.json", "-o", "out.json"], more].concat())
    };
    let done = reshape(&["--motion", "run"]);
    let wanted = r#"clips.json: --character any, --motion "run": found no clip, expected one of ("a", "b")"#;
    assert!(said(&done).contains(wanted), "{}", said(&done));
    let done = reshape(&["--rest", "7"]);
    assert!(said(&done).contains("shot.json: --rest: found frame 7 without a contour of \"body\""), "{}", said(&done));
    assert_eq!(reshape(&["--sub-keys", "-1"]).status.code(), Some(2));
    assert_eq!(reshape(&["--mirror", "perhaps"]).status.code(), Some(2));
    for (chain, wanted) in [
        ("arm=l_leg", "shot.json: --chain: found \"arm\", expected a chain of \"human\": one of torso, head, l_arm"),
        ("l_arm=leg", "shot.json: --chain: found \"leg\", expected a chain of \"human\": one of torso, head, l_arm"),
    ] {
        let done = reshape(&["--chain", chain]);
        assert_eq!(done.status.code(), Some(2));
        assert!(said(&done).contains(wanted), "{}", said(&done));
    }
    assert!(!folder.join("out.json").exists());
}

#[test]
fn a_clip_without_motion_and_a_clip_that_is_mirrored_are_noted() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write(folder, "shot.json", &figure(4));
    write(folder, "still.json", &figure(1));
    let clip = |file: &str| {
        let made = ["style", "clip", file, "--character", "a", "--motion", "b", "-o", "clips.json"];
        let done = rototoon(folder, &made);
        assert_eq!(done.status.code(), Some(0));
        said(&done)
    };
    let note = "note: still.json: found contours on frame 0 only, so the clip has one posture and no motion";
    assert!(clip("still.json").contains(note));
    assert!(!clip("shot.json").contains("note:"));
    // A clip of another figure with bent knees, which looks to the left; the drawing has no legs.
    let mut clips = read(folder, "clips.json");
    for posture in clips["clips"][0]["points"].as_array_mut().unwrap() {
        posture[10][1] = json!(90);
        posture[7] = json!([66, 64]);
        for knee in [12, 15] {
            posture[knee][0] = json!(posture[knee][0].as_f64().unwrap() - 12.0);
        }
    }
    write(folder, "clips.json", &clips);
    let reshape = |mirror: &str| {
        let fixed = ["style", "reshape", "still.json", "clips.json", "-o", "out.json", "--mirror"];
        let done = rototoon(folder, &[&fixed[..], &[mirror]].concat());
        assert!(done.status.success(), "{}", said(&done));
        let body = &read(folder, "out.json")["parts"][0]["tracks"];
        let x = |frame: &str| body[frame][0][0].as_f64().unwrap();
        (said(&done), x("3") - x("0"))
    };
    let (text, way) = reshape("auto");
    let wanted = "note: still.json: the drawing looks to a side that cannot be told and the clip left, so the clip is not mirrored (--mirror on)";
    assert!(text.contains(wanted) && way > 2.0, "{text} {way}");
    let (text, way) = reshape("on");
    assert!(!text.contains("note:") && way < -2.0, "{text} {way}");
    let (text, way) = reshape("off");
    assert!(!text.contains("note:") && way > 2.0, "{text} {way}");
}
