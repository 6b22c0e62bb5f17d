//! No command writes over a file that it reads, except a project document onto itself.

use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A file for every kind of input. The frames are no pictures: the commands must refuse before they read them.
fn files() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::create_dir(at("frames")).unwrap();
    for frame in 0..4 {
        fs::write(at(&format!("frames/f_{frame:03}.png")), format!("frame {frame}")).unwrap();
    }
    let footage = json!({"pattern": "frames/f_%03d.png", "first": 0, "last": 3, "fps": 12, "width": 64, "height": 48});
    let square = json!([[8, 12], [28, 12], [28, 36], [8, 36]]);
    let part = json!({"name": "square", "closed": true, "keys": {"0": square, "3": square}});
    let document = json!({"rototoon": 1, "footage": footage, "parts": [part]});
    let posture: Vec<[f64; 2]> = (0..17).map(|k| [f64::from(k % 3), f64::from(k)]).collect();
    let clip = json!({"character": "old", "motion": "walk", "points": [posture, posture]});
    let clips = json!({"rototoon_clips": 1, "fps": 12, "clips": [clip]});
    let curves = json!({"curves": [{"closed": false, "points": [[0, 0], [5, 1], [9, 4]]}]});
    let svg = "<svg xmlns=\"http://www.w3.org/2000/svg\"><path id=\"square\" d=\"M8 12L28 12L28 36L8 36z\"/></svg>";
    let texts = [
        ("shot.json", document.to_string()),
        ("shot.svg", document.to_string()),
        ("clips.json", clips.to_string()),
        ("curves.json", curves.to_string()),
        ("x.svg", svg.to_owned()),
        ("walk.bvh", "HIERARCHY".to_owned()),
        ("joints.json", "{}".to_owned()),
        ("pose.json", "[]".to_owned()),
    ];
    for (name, text) in texts {
        fs::write(at(name), text).unwrap();
    }
    folder
}

fn run(folder: &Path, words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_rototoon")).current_dir(folder).args(words).output().unwrap()
}

/// Every file below a folder with its bytes.
fn contents(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(contents(&path));
        } else {
            found.insert(path.clone(), fs::read(&path).unwrap());
        }
    }
    found
}

#[test]
fn an_output_that_is_an_input_is_refused_and_nothing_changes() {
    let folder = files();
    assert!(run(folder.path(), &["style", "library", "add", "shelf", "clips.json"]).status.success());
    let before = contents(folder.path());
    let (frame, clips) = ("frames/f_002.png", "clips.json");
    let (kept, index) = ("shelf/old-walk.clip.json", "shelf/library.json");
    for words in [
        &["render", "shot.json", "-o", "frames/f_003.png", "--frames", "1"][..],
        &["render", "shot.json", "-o", "frames/f_%03d.png"],
        &["render", "shot.json", "-o", "frames/../frames/f_%03d.png", "--frames", "2-3"],
        &["track", "shot.json", "-o", frame],
        &["snap", "shot.json", "-o", frame],
        &["tween", "shot.json", "-o", frame],
        &["export", "shot.svg", "-o", "shot.svg"],
        &["fit", "curves.json", "-o", "curves.json", "--tolerance", "1"],
        &["import", "shot.json", "x.svg", "-o", "x.svg"],
        &["import", "shot.json", "x.svg", "-o", frame],
        &["style", "clip", "shot.json", "--character", "a", "--motion", "b", "-o", "shot.json"],
        &["style", "translate", clips, "--style", "old", "--motion", "walk", "--content", "old", "-o", clips],
        &["style", "import", "walk.bvh", "-o", "walk.bvh"],
        &["style", "import", "walk.bvh", "--joints", "joints.json", "-o", "joints.json"],
        &["style", "reshape", "shot.json", clips, "-o", clips],
        &["track", "shot.json", "-o", "tracked.json", "--report", "./shot.json"],
        &["track", "shot.json", "-o", "tracked.json", "--report", frame],
        &["conform", "shot.json", "--footage", "frames/f_%03d.png", "-o", "new.json", "--report", "shot.json"],
        &["style", "translate", "shelf", "--style", "old", "--motion", "walk", "--content", "old", "-o", kept],
        &["style", "translate", "shelf", "--style", "old", "--motion", "walk", "--content", "old", "-o", index],
        &["style", "reshape", "shot.json", "shelf", "--motion", "walk", "-o", kept],
    ] {
        let output = run(folder.path(), words);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{words:?}: {said}");
        assert!(said.contains("that the command reads"), "{words:?}: {said}");
        assert_eq!(contents(folder.path()), before, "{words:?}");
    }
}

#[test]
fn a_report_does_not_go_over_the_output() {
    let folder = files();
    let before = contents(folder.path());
    for report in ["tracked.json", "./tracked.json", "frames/../tracked.json"] {
        let output = run(folder.path(), &["track", "shot.json", "-o", "tracked.json", "--report", report]);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains("--report: found") && said.contains("expected another file than the output"), "{said}");
        assert_eq!(contents(folder.path()), before, "{report}");
    }
}

#[cfg(unix)]
#[test]
fn links_to_an_input_are_refused_too() {
    let folder = files();
    let at = |name: &str| folder.path().join(name);
    fs::hard_link(at("frames/f_001.png"), at("hard.json")).unwrap();
    std::os::unix::fs::symlink(at("frames/f_001.png"), at("soft.json")).unwrap();
    let before = contents(folder.path());
    for name in ["hard.json", "soft.json"] {
        let output = run(folder.path(), &["track", "shot.json", "-o", name]);
        assert_eq!(output.status.code(), Some(2), "{}", String::from_utf8_lossy(&output.stderr));
        assert_eq!(contents(folder.path()), before, "{name}");
    }
}

#[test]
fn a_document_may_be_written_onto_itself() {
    let folder = files();
    let output = run(folder.path(), &["import", "shot.json", "x.svg", "-o", "shot.json"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let written: Value = serde_json::from_slice(&fs::read(folder.path().join("shot.json")).unwrap()).unwrap();
    assert_eq!(written["parts"][0]["name"], "square");
}
