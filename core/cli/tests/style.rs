//! `rototoon style` as a user calls it.

use serde_json::{Value, json};
use std::path::Path;
use std::process::{Command, Output};

fn rototoon(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_rototoon")).args(arguments).output().unwrap()
}

fn posture(motion: f64, lean: f64, frame: f64) -> Value {
    let point = |k: usize| {
        let height = [0.0, -0.6, -1.0, -1.2, -1.5, -0.9, -0.4, 0.1, -0.9, -0.4, 0.1, 0.05, 1.0, 1.9, 0.05, 1.0, 1.9][k];
        let side = if (8..11).contains(&k) || k > 13 { -1.0 } else { 1.0 };
        [-lean * height + 0.1 * side * motion * (0.4 * frame).sin() * height, height]
    };
    json!((0..17).map(point).collect::<Vec<_>>())
}

fn library() -> Value {
    let mut clips = Vec::new();
    for (character, lean) in [("plain", 0.0), ("old", 0.4), ("shy", 0.2)] {
        for (motion, swing) in [("walk", 1.0), ("run", 2.0), ("bow", 0.3)] {
            let points: Vec<Value> = (0..8).map(|f| posture(swing, lean, f as f64)).collect();
            clips.push(json!({"character": character, "motion": motion, "points": points}));
        }
    }
    json!({"rototoon_clips": 1, "fps": 12, "clips": clips})
}

fn translate(folder: &Path, more: &[&str]) -> Output {
    let (from, to) = (folder.join("clips.json"), folder.join("out.json"));
    let (from, to) = (from.to_str().unwrap(), to.to_str().unwrap());
    let fixed = ["style", "translate", from, "--motion", "run", "--content", "plain", "-o", to];
    rototoon(&fixed.iter().chain(more).copied().collect::<Vec<_>>())
}

#[test]
fn a_clip_is_written_in_the_form_of_those_read() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("clips.json"), library().to_string()).unwrap();
    let pose = folder.path().join("pose.json");
    std::fs::write(&pose, posture(2.0, 0.4, 0.0).to_string()).unwrap();
    for preset in ["rototoon", "bilinear", "liang2012"] {
        let done =
            translate(folder.path(), &["--style", "old", "--preset", preset, "--key-pose", pose.to_str().unwrap()]);
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        let text = std::fs::read_to_string(folder.path().join("out.json")).unwrap();
        let made: Value = serde_json::from_str(&text).unwrap();
        assert_eq!((&made["rototoon_clips"], &made["fps"]), (&json!(1), &json!(12.0)));
        let clip = &made["clips"][0];
        assert_eq!((&clip["character"], &clip["motion"]), (&json!("old"), &json!("run")));
        assert_eq!(clip["points"].as_array().unwrap().len(), 8);
        assert_eq!(clip["deviation"][7].as_array().unwrap().len(), 17);
    }
}

#[test]
fn what_is_wrong_is_said_and_nothing_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let clips = folder.path().join("clips.json");
    let said = |text: &str, more: &[&str]| {
        std::fs::write(&clips, text).unwrap();
        let done = translate(folder.path(), more);
        assert_eq!(done.status.code(), Some(1));
        assert!(!folder.path().join("out.json").exists());
        String::from_utf8(done.stderr).unwrap()
    };
    let good = library().to_string();
    assert!(
        said(&good, &["--style", "nobody"])
            .contains("clips.json: character: found \"nobody\", expected one of old, plain, shy")
    );
    let mut short = library();
    short["clips"][4]["points"][2].as_array_mut().unwrap().pop();
    let error = said(&short.to_string(), &["--style", "old"]);
    assert!(error.contains("clips[4] (\"old\", \"run\"), frame 2: found 16 key points, expected 17"), "{error}");
    assert!(said("{\"rototoon_clips\": 9}", &["--style", "old"]).contains("found version 9, expected 1 or less"));
    assert_eq!(translate(folder.path(), &[]).status.code(), Some(2));
}

#[test]
fn a_library_is_filled_listed_and_learned_from() {
    let folder = tempfile::tempdir().unwrap();
    let (clips, shelf) = (folder.path().join("clips.json"), folder.path().join("shelf"));
    std::fs::write(&clips, library().to_string()).unwrap();
    let (from, to) = (clips.to_str().unwrap(), shelf.to_str().unwrap());
    assert!(rototoon(&["style", "library", "add", to, from, "--source", "shot 3"]).status.success());
    std::fs::write(shelf.join("shy-bow.clip.json"), "{").unwrap();
    let listed = rototoon(&["style", "library", "list", to, "--character", "ol"]);
    let lines = String::from_utf8(listed.stdout).unwrap();
    assert_eq!(lines.lines().count(), 3);
    assert!(lines.contains("old\tbow\t8\t12\told-bow.clip.json\tshot 3"), "{lines}");
    let out = folder.path().join("out.json");
    let request = ["style", "translate", to, "--style", "old", "--motion", "run", "--content", "plain"];
    let made = rototoon(&[&request[..], &["-o", out.to_str().unwrap()]].concat());
    assert!(made.status.success());
    assert!(String::from_utf8_lossy(&made.stderr).contains("warning: "));
    assert!(out.exists());
}
