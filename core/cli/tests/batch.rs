//! Tests of `rototoon batch`: results, resuming, files of others, killed workers, exit statuses.

use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::Duration;

const FRAMES: i32 = 5;

/// A folder with shots of a square that moves, and a manifest.
struct Season {
    folder: tempfile::TempDir,
}

fn draw(path: &Path, left: i32) {
    let picture = image::RgbImage::from_fn(64, 48, |x, y| {
        let inside = (left..left + 20).contains(&(x as i32)) && (12..36).contains(&y);
        let grain = ((x * 7 + y * 13) % 11) as u8;
        image::Rgb(if inside { [200, 60 + 3 * grain, 40] } else { [180, 200, 220 + grain] })
    });
    picture.save(path).unwrap();
}

fn square(left: i32) -> Value {
    json!([[left, 12], [left + 20, 12], [left + 20, 36], [left, 36]])
}

fn steps() -> Value {
    json!([{"do": "check"}, {"do": "track"}, {"do": "snap"}, {"do": "render", "what": "matte", "to": "matte_%03d.png"},
        {"do": "export", "to": "shapes.svg"}])
}

impl Season {
    /// So many shots; each has a speed of its own.
    fn new(shots: usize) -> Self {
        let season = Self { folder: tempfile::tempdir().unwrap() };
        for k in 0..shots {
            season.shot(k);
        }
        season.manifest(&steps(), shots);
        season
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn shot(&self, k: usize) {
        let (folder, speed) = (self.path(&format!("in/sh{k}")), 1 + k as i32 % 3);
        fs::create_dir_all(&folder).unwrap();
        (0..FRAMES).for_each(|frame| draw(&folder.join(format!("f_{frame:03}.png")), 8 + speed * frame));
        let footage =
            json!({"pattern": "f_%03d.png", "first": 0, "last": FRAMES - 1, "fps": 12, "width": 64, "height": 48});
        let keys = json!({"0": square(8), (FRAMES - 1).to_string(): square(8 + speed * (FRAMES - 1))});
        let document =
            json!({"rototoon": 1, "footage": footage, "parts": [{"name": "square", "closed": true, "keys": keys}]});
        fs::write(folder.join("project.json"), document.to_string()).unwrap();
    }

    fn manifest(&self, steps: &Value, shots: usize) {
        let shot = |k: usize| json!({"name": format!("sh{k}"), "project": format!("in/sh{k}/project.json")});
        let shots: Vec<_> = (0..shots).map(shot).collect();
        fs::write(self.path("m.json"), json!({"rototoon_batch": 1, "steps": steps, "shots": shots}).to_string())
            .unwrap();
    }

    fn command(&self, more: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rototoon"));
        command.current_dir(self.folder.path()).args(["batch", "m.json", "-o", "out"]).args(more);
        command
    }

    fn run(&self, more: &[&str]) -> Output {
        self.command(more).output().unwrap()
    }

    /// Runs the batch; its status must be 0.
    fn good(&self, more: &[&str]) -> String {
        let output = self.run(more);
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(0), "{said}");
        said
    }

    /// The result files of all shots with their bytes.
    fn results(&self) -> BTreeMap<String, Vec<u8>> {
        let mut found = BTreeMap::new();
        for shot in
            fs::read_dir(self.path("out")).unwrap().map(|entry| entry.unwrap().path()).filter(|path| path.is_dir())
        {
            for file in fs::read_dir(&shot).unwrap().map(|entry| entry.unwrap().path()) {
                let name = file.file_name().unwrap().to_str().unwrap().to_owned();
                if !name.starts_with('.') && name != "batch.json" {
                    let place = format!("{}/{name}", shot.file_name().unwrap().to_str().unwrap());
                    found.insert(place, fs::read(&file).unwrap());
                }
            }
        }
        found
    }

    /// Lines of the report of a kind.
    fn events(&self, kind: &str) -> Vec<Value> {
        let text = fs::read_to_string(self.path("out/report.jsonl")).unwrap();
        let lines = text.lines().map(|line| serde_json::from_str::<Value>(line).unwrap());
        lines.filter(|line| line["event"] == kind).collect()
    }

    fn clear_report(&self) {
        fs::remove_file(self.path("out/report.jsonl")).unwrap();
    }

    fn record(&self, shot: &str) -> Value {
        serde_json::from_slice(&fs::read(self.path(&format!("out/{shot}/batch.json"))).unwrap()).unwrap()
    }
}

fn outcomes(events: &[Value]) -> Vec<&str> {
    events.iter().map(|event| event["outcome"].as_str().unwrap()).collect()
}

#[test]
fn a_batch_does_what_the_commands_do() {
    let season = Season::new(2);
    let said = season.good(&["--jobs", "2"]);
    assert!(said.contains("2 good, 0 want keys, 0 failed, 0 not run"), "{said}");
    let own = |words: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rototoon"));
        assert!(command.current_dir(season.path("in/sh1")).args(words).status().unwrap().success());
    };
    own(&["track", "project.json", "-o", "../../out/own.json"]);
    own(&["snap", "../../out/own.json", "-o", "../../out/snapped.json"]);
    own(&["render", "../../out/snapped.json", "-o", "../../out/m_%03d.png", "--what", "matte"]);
    own(&["export", "../../out/snapped.json", "-o", "../../out/own.svg"]);
    for (batch, single) in [("matte_002.png", "m_002.png"), ("shapes.svg", "own.svg")] {
        let read = |name: &str| fs::read(season.path(name)).unwrap();
        assert_eq!(read(&format!("out/sh1/{batch}")), read(&format!("out/{single}")), "{batch}");
    }
    let document: Value = serde_json::from_slice(&fs::read(season.path("out/sh1/snapped.json")).unwrap()).unwrap();
    assert_eq!(document["footage"]["pattern"], "../../in/sh1/f_%03d.png");
    let page = fs::read_to_string(season.path("out/index.html")).unwrap();
    assert!(page.contains("data:image/jpeg;base64,") && page.contains("id=\"shot-sh0\""));
    let summary: Value = serde_json::from_slice(&fs::read(season.path("out/summary.json")).unwrap()).unwrap();
    assert_eq!((&summary["good"], summary["shots"].as_array().unwrap().len()), (&json!(2), 2));
    if cfg!(target_os = "linux") {
        assert!(season.events("step").iter().all(|event| event["peak_bytes"].as_u64().unwrap() > 1_000_000));
    }
}

#[test]
fn only_what_changed_is_done_again() {
    let season = Season::new(2);
    season.good(&[]);
    let before = season.results();
    let again = || {
        season.clear_report();
        season.good(&[]);
        outcomes(&season.events("step")).iter().filter(|outcome| **outcome == "done").count()
    };
    assert_eq!(again(), 0);
    assert_eq!(season.results(), before);
    // A frame changes: all steps that read frames, and those after them.
    draw(&season.path("in/sh0/f_002.png"), 11);
    assert!((3..=5).contains(&again()));
    // A result is gone: the step that wrote it.
    fs::remove_file(season.path("out/sh1/matte_002.png")).unwrap();
    assert_eq!(again(), 1);
    assert_eq!(season.results().keys().collect::<Vec<_>>(), before.keys().collect::<Vec<_>>());
    // Another option: that step alone, since no later one reads its files. Files of the old name go.
    let mut other = steps();
    other[3]["to"] = json!("m_%03d.png");
    season.manifest(&other, 2);
    assert_eq!(again(), 2, "render of two shots");
    assert!(season.results().keys().all(|name| !name.contains("matte_")));
}

#[test]
fn files_of_others_are_never_replaced() {
    let season = Season::new(2);
    fs::create_dir_all(season.path("out/sh0")).unwrap();
    fs::write(season.path("out/sh0/tracked.json"), "mine").unwrap();
    let output = season.run(&[]);
    assert_eq!(output.status.code(), Some(1));
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("sh0") && said.contains("did not write"), "{said}");
    assert_eq!(fs::read_to_string(season.path("out/sh0/tracked.json")).unwrap(), "mine");
    assert_eq!(outcomes(&season.events("shot")).iter().filter(|outcome| **outcome == "good").count(), 1);
    // An artist corrected a result: a later run leaves it alone too.
    fs::write(season.path("out/sh1/tracked.json"), "corrected").unwrap();
    draw(&season.path("in/sh1/f_002.png"), 12);
    assert_eq!(season.run(&[]).status.code(), Some(1));
    assert_eq!(fs::read_to_string(season.path("out/sh1/tracked.json")).unwrap(), "corrected");
}

#[test]
fn a_worker_killed_between_two_names_leaves_no_strange_files() {
    let season = Season::new(1);
    season.good(&[]);
    // One file has its name already, but the record was not written again. Then a frame changes.
    let mut record = season.record("sh0");
    let hash = record["files"].as_object_mut().unwrap().remove("matte_002.png").unwrap();
    record["pending"]["matte_002.png"] = hash;
    fs::write(season.path("out/sh0/batch.json"), record.to_string()).unwrap();
    draw(&season.path("in/sh0/f_002.png"), 11);
    season.good(&[]);
}

#[test]
fn one_bad_shot_does_not_stop_the_others() {
    let season = Season::new(3);
    fs::remove_dir_all(season.path("in/sh1")).unwrap();
    let output = season.run(&["--jobs", "1"]);
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(outcomes(&season.events("shot")), ["good", "failed", "good"]);
    assert_eq!(season.run(&["--summary", "--fine", "keys"]).status.code(), Some(1));
    season.good(&["--fine", "all"]);
    assert!(season.record("sh1")["failure"].as_str().unwrap().contains("in/sh1"));
    let page = fs::read_to_string(season.path("out/index.html")).unwrap();
    assert!(page.contains("class=\"failure\""));
    season.shot(1);
    season.clear_report();
    season.good(&[]);
    assert_eq!(outcomes(&season.events("shot")), ["good"; 3]);
}

#[test]
fn the_status_says_that_keys_are_wanted() {
    let season = Season::new(1);
    // The document was tracked before, and the contours between the keys are in doubt.
    let path = season.path("in/sh0/project.json");
    let mut document: Value = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
    let by_frame = |value: &dyn Fn(i32) -> Value| -> Value { (0..FRAMES).map(|f| (f.to_string(), value(f))).collect() };
    let confidence = |frame: i32| json!(vec![if frame % (FRAMES - 1) == 0 { 1.0 } else { 0.25 }; 4]);
    document["parts"][0]["tracks"] = by_frame(&|frame| square(8 + frame));
    document["parts"][0]["confidence"] = by_frame(&confidence);
    fs::write(&path, document.to_string()).unwrap();
    season.manifest(&json!([{"do": "check"}]), 1);
    let output = season.run(&[]);
    let wanted = season.events("shot")[0]["wanted"].as_array().unwrap().clone();
    assert_eq!(wanted, [json!({"part": "square", "frame": 2, "worth": 2.25, "lost": false})]);
    assert_eq!(output.status.code(), Some(3));
    season.good(&["--fine", "keys"]);
    assert_eq!(season.run(&["--summary"]).status.code(), Some(3));
    assert!(fs::read_to_string(season.path("out/index.html")).unwrap().contains("Keys that help most"));
}

#[test]
fn wrong_manifests_and_requests_end_before_any_work() {
    let season = Season::new(2);
    for (more, expected) in [
        (["--shots", "0-1"], "expected places from 1 to 2"),
        (["--shots", "2-9"], "expected places from 1 to 2"),
        (["--shot", "sh9"], "expected the name of a shot"),
        (["--memory", "0"], "expected a positive number"),
        (["--report", "in/sh0/project.json"], "the command reads"),
    ] {
        let output = season.run(&more);
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.code() == Some(2) && said.contains(expected), "{more:?}: {said}");
    }
    for (steps, expected) in [
        (json!([{"do": "track", "preset": "magic"}]), "steps[0]: invalid value 'magic'"),
        (json!([{"do": "snap", "colour": 3}]), "steps[0]: unexpected argument '--colour'"),
        (json!([{"do": "trak"}]), "steps[0]: do: found \"trak\""),
    ] {
        season.manifest(&steps, 2);
        let output = season.run(&[]);
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.code() == Some(2) && said.contains(expected), "{said}");
    }
    assert!(!season.path("out").exists());
}

#[test]
fn parts_of_a_batch_make_the_whole() {
    let season = Season::new(3);
    season.good(&["--shots", "1-2"]);
    assert!(!season.path("out/index.html").exists());
    assert_eq!(season.run(&["--summary"]).status.code(), Some(1), "a shot was not run");
    let summary = || serde_json::from_slice::<Value>(&fs::read(season.path("out/summary.json")).unwrap()).unwrap();
    assert_eq!((&summary()["good"], &summary()["not_run"]), (&json!(2), &json!(1)));
    season.good(&["--shot", "sh2"]);
    season.good(&["--summary"]);
    assert_eq!((&summary()["good"], &summary()["not_run"]), (&json!(3), &json!(0)));
}

#[test]
fn two_workers_do_no_shot_twice() {
    let season = Season::new(4);
    let start = || season.command(&["--jobs", "1"]).stderr(Stdio::null()).spawn().unwrap();
    let workers = [start(), start()];
    for mut worker in workers {
        assert!(worker.wait().unwrap().success());
    }
    let done = season.events("step").iter().filter(|event| event["outcome"] == "done").count();
    assert_eq!(done, 4 * 5);
}

#[cfg(unix)]
#[test]
fn killed_workers_lose_nothing() {
    let undisturbed = Season::new(3);
    undisturbed.good(&[]);
    let season = Season::new(3);
    let start = || -> Child { season.command(&["--jobs", "2"]).stderr(Stdio::null()).spawn().unwrap() };
    // Times spread over the run of a batch. Some workers end before: that is a case too.
    for round in 0..12u64 {
        let mut worker = start();
        std::thread::sleep(Duration::from_millis(20 + 35 * (round * 7 % 12)));
        worker.kill().unwrap();
        worker.wait().unwrap();
    }
    season.good(&[]);
    assert_eq!(season.results(), undisturbed.results());
    let mut done: Vec<(String, String)> = Vec::new();
    for event in season.events("step").iter().filter(|event| event["outcome"] == "done") {
        done.push((event["shot"].to_string(), event["step"].to_string()));
    }
    let all = done.len();
    done.sort();
    done.dedup();
    assert_eq!(done.len(), all, "a step that was whole was done again");
    let left = fs::read_dir(season.path("out/sh0"))
        .unwrap()
        .filter(|entry| entry.as_ref().unwrap().file_name().to_str().unwrap().starts_with(".new-"));
    assert_eq!(left.count(), 0);
}

#[cfg(unix)]
#[test]
fn a_batch_that_is_asked_to_end_can_go_on() {
    let season = Season::new(3);
    let mut worker = season.command(&["--jobs", "1"]).stderr(Stdio::null()).spawn().unwrap();
    std::thread::sleep(Duration::from_millis(200));
    assert!(Command::new("kill").args(["-TERM", &worker.id().to_string()]).status().unwrap().success());
    // It may have been quick.
    assert!([Some(0), Some(1), Some(130)].contains(&worker.wait().unwrap().code()));
    season.good(&[]);
    assert_eq!(outcomes(&season.events("shot")).iter().rev().take(3).copied().collect::<Vec<_>>(), ["good"; 3]);
}

#[test]
fn jobs_are_written_for_farms() {
    let season = Season::new(2);
    let job = |more: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rototoon"));
        let output = command.current_dir(season.folder.path()).args(["job", "m.json"]).args(more).output().unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    assert_eq!(job(&["-o", "job.json", "--chunk", "2"]).0, Some(0));
    let template: Value = serde_json::from_slice(&fs::read(season.path("job.json")).unwrap()).unwrap();
    assert_eq!(template["specificationVersion"], "jobtemplate-2023-09");
    let default = |template: &Value, k: usize| template["parameterDefinitions"][k]["default"].clone();
    assert_eq!((default(&template, 0), default(&template, 1)), (json!("m.json"), json!("results")));
    // The specification wants paths that begin in the template's folder.
    assert_eq!(job(&["-o", "in/job.json", "--results", season.path("in/night").to_str().unwrap()]).0, Some(0));
    let template: Value = serde_json::from_slice(&fs::read(season.path("in/job.json")).unwrap()).unwrap();
    assert_eq!((default(&template, 0), default(&template, 1)), (json!("../m.json"), json!("night")));
    assert_eq!(job(&["-o", "rototoon.js", "--for", "flamenco"]).0, Some(0));
    assert!(fs::read_to_string(season.path("rototoon.js")).unwrap().contains("function compileJob(job)"));
    let (status, said) = job(&["-o", "in/sh0/project.json"]);
    assert!(status == Some(2) && said.contains("the command reads"), "{said}");
}
