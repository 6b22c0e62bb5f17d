//! Tests of the benchmark of tracking on a small synthetic scene: its program, its table and its pictures.

use rototoon_tests::benchmark::growth::Sample;
use rototoon_tests::benchmark::run::Outcome;
use rototoon_tests::benchmark::{presets, write_files};
use rototoon_tests::puppet::Puppet;
use std::path::Path;
use std::process::{Command, Output};

const SMALL: Puppet = Puppet { width: 160, height: 120, frames: 7, step: 3, parts: 3, points: 8 };

fn program(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_bench-tracking")).args(arguments).output().unwrap()
}

fn outcome(folder: &Path, preset: &str, more: &[&str]) -> Outcome {
    let (set, out) = (folder.join("set"), folder.join(format!("limbs.{preset}")));
    let (set, out) = (set.to_str().unwrap(), out.to_str().unwrap());
    let mut arguments = vec!["run", set, "--set", "limbs", "--preset", preset, "--out", out, "--threads", "1"];
    arguments.extend(more);
    let ran = program(&arguments);
    assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
    serde_json::from_slice(&std::fs::read(format!("{out}.json")).unwrap()).unwrap()
}

#[test]
fn every_preset_has_a_row_a_line_and_a_sheet() {
    let folder = tempfile::tempdir().unwrap();
    SMALL.write(&folder.path().join("set")).unwrap();
    let outcomes: Vec<Outcome> = presets().iter().map(|id| outcome(folder.path(), id, &[])).collect();
    write_files(folder.path(), &outcomes, &[]).unwrap();
    let table = std::fs::read_to_string(folder.path().join("table.md")).unwrap();
    let svg = std::fs::read_to_string(folder.path().join("limbs.errors.svg")).unwrap();
    for (outcome, id) in outcomes.iter().zip(presets()) {
        // Keys are on frames 0, 3 and 6, so there are four frames between them, with three parts of eight points.
        assert_eq!((outcome.work.total, outcome.threads, outcome.preset.as_str()), (96, 1, id));
        assert!(outcome.corrected && outcome.work.edits() <= 96 && outcome.seconds > 0.0);
        assert_eq!(outcome.again.len(), outcome.work.rounds, "a track after each round");
        assert_eq!(outcome.keys, [(0, 1.0), (3, 1.0), (6, 1.0)]);
        assert!(outcome.frames.iter().all(|errors| [1, 2, 4, 5].contains(&errors.frame)));
        assert!(table.contains(&format!("| limbs | {id} | ")) && svg.contains(&format!(">{id}</text>")));
        let sheet = image::open(folder.path().join(format!("limbs.{id}.png"))).unwrap();
        assert!(sheet.width() > 4 * 480, "four pictures side by side");
    }
    assert!(image::open(folder.path().join("limbs.errors.png")).is_ok());
    let json: serde_json::Value =
        serde_json::from_slice(&std::fs::read(folder.path().join("table.json")).unwrap()).unwrap();
    assert_eq!(json["outcomes"].as_array().unwrap().len(), outcomes.len());
}

#[test]
fn the_default_preset_is_measured_without_the_artist() {
    let folder = tempfile::tempdir().unwrap();
    SMALL.write(&folder.path().join("set")).unwrap();
    let outcome = outcome(folder.path(), "rototoon", &["--no-edits"]);
    assert!(!outcome.corrected && outcome.again.is_empty());
    assert_eq!((outcome.work.edits(), outcome.work.first), (0, outcome.work.last));
    assert!(outcome.work.first.good > 0.5, "{:?}", outcome.work.first);
}

#[test]
fn a_drawn_scene_is_timed() {
    let folder = tempfile::tempdir().unwrap();
    let set = folder.path().join("set");
    let set = set.to_str().unwrap();
    assert!(program(&["draw", set, "96", "80", "3", "9", "1", "6"]).status.success());
    let said = program(&["time", set, "--threads", "1"]);
    let sample: Sample = serde_json::from_slice(&said.stdout).unwrap();
    assert!(sample.seconds > 0.0);
    #[cfg(target_os = "linux")]
    assert!(sample.peak_mb.unwrap() > 1.0);
}

#[test]
fn errors_name_what_is_wrong() {
    let folder = tempfile::tempdir().unwrap();
    let set = folder.path().to_str().unwrap();
    let error = |arguments: &[&str]| {
        let ran = program(arguments);
        assert!(!ran.status.success());
        String::from_utf8(ran.stderr).unwrap()
    };
    let missing = error(&["run", set, "--set", "a", "--preset", "rototoon", "--out", "out"]);
    assert!(missing.contains("project.json"), "{missing}");
    assert!(error(&["run", set, "--set", "a", "--preset", "best", "--out", "out"]).contains("no preset \"best\""));
}

#[test]
fn a_mechanism_can_be_left_out() {
    let folder = tempfile::tempdir().unwrap();
    SMALL.write(&folder.path().join("set")).unwrap();
    let whole = outcome(folder.path(), "rototoon", &["--no-edits"]);
    let lessened = outcome(folder.path(), "rototoon", &["--no-edits", "--without", "blending"]);
    assert_eq!(lessened.preset, "rototoon without blending");
    assert_ne!(lessened.frames, whole.frames, "it makes a difference");
    let set = folder.path().join("set");
    let arguments = ["run", set.to_str().unwrap(), "--set", "limbs", "--out", "none", "--no-edits", "--preset"];
    let said = |more: &[&str]| {
        let ran = program(&[&arguments, more].concat());
        assert!(!ran.status.success());
        String::from_utf8_lossy(&ran.stderr).into_owned()
    };
    assert!(said(&["rototoon", "--without", "luck"]).contains("no mechanism \"luck\""));
    assert!(said(&["zhou2011", "--without", "search"]).contains("left out of the preset \"zhou2011\""));
}
