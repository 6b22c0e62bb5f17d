//! Tests of `rototoon batch`: results, resuming, files of others, killed workers, exit statuses.

use crate::season::{FRAMES, Season, draw, outcomes, square, steps, wait_for};
use serde_json::{Value, json};
use std::fs;
#[cfg(unix)]
use std::os::unix::process::ExitStatusExt;
#[cfg(unix)]
use std::process::Child;
use std::process::{Command, Stdio};
use std::time::Duration;

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
fn frames_are_decoded_once_for_all_steps_if_there_is_memory() {
    let (season, small) = (Season::new(1), Season::new(1));
    season.good(&[]);
    small.good(&["--memory", "0.001"]);
    let kept = |season: &Season| -> Vec<u64> {
        season.record("sh0")["steps"].as_array().unwrap().iter().map(|s| s["kept_bytes"].as_u64().unwrap()).collect()
    };
    assert_eq!(kept(&season), [FRAMES as u64 * 64 * 48 * 3; 5]);
    assert_eq!(kept(&small), [0; 5]);
    assert_eq!(season.results(), small.results());
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
fn shots_and_results_may_move() {
    let season = Season::new(1);
    let [track, snap] = [1, 2].map(|k| steps()[k].clone());
    season.manifest(&json!([track]), 1);
    season.good(&[]);
    let pattern = |place: &str| {
        let document: Value = serde_json::from_slice(&fs::read(season.path(place)).unwrap()).unwrap();
        document["footage"]["pattern"].as_str().unwrap().to_owned()
    };
    // The shot goes to another disk, and later steps read its pictures there.
    fs::create_dir(season.path("disk2")).unwrap();
    fs::rename(season.path("in"), season.path("disk2/in")).unwrap();
    let manifest = |steps: Value| {
        let shots = json!([{"name": "sh0", "project": "disk2/in/sh0/project.json"}]);
        fs::write(season.path("m.json"), json!({"rototoon_batch": 1, "steps": steps, "shots": shots}).to_string())
            .unwrap();
    };
    manifest(json!([track, snap]));
    season.good(&[]);
    assert_eq!(pattern("out/sh0/tracked.json"), "../../disk2/in/sh0/f_%03d.png");
    // So do the results.
    fs::create_dir(season.path("night")).unwrap();
    fs::rename(season.path("out"), season.path("night/out")).unwrap();
    let good = |folder: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rototoon"));
        let command = command.current_dir(season.path(folder)).args(["batch", "m.json", "-o", "night/out"]);
        let output = command.output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    };
    good("");
    assert_eq!(pattern("night/out/sh0/snapped.json"), "../../../disk2/in/sh0/f_%03d.png");
    // Where both move together, nothing is done again.
    fs::create_dir(season.path("farm")).unwrap();
    for name in ["night", "disk2", "m.json"] {
        fs::rename(season.path(name), season.path("farm").join(name)).unwrap();
    }
    fs::remove_file(season.path("farm/night/out/report.jsonl")).unwrap();
    good("farm");
    let report = fs::read_to_string(season.path("farm/night/out/report.jsonl")).unwrap();
    assert!(report.contains("\"unchanged\"") && !report.contains("\"done\""), "{report}");
}

#[test]
fn steps_may_be_inserted_moved_and_taken_out() {
    let season = Season::new(1);
    let names = |season: &Season| season.results().into_keys().collect::<Vec<_>>();
    let run = |steps: &Value| {
        season.manifest(steps, 1);
        season.clear_report();
        season.good(&[]);
        let events = season.events("step");
        let done = events.iter().filter(|event| event["outcome"] == "done");
        done.map(|event| event["step"].as_str().unwrap().to_owned()).collect::<Vec<_>>()
    };
    season.good(&[]);
    let before = season.results();
    let [track, snap, render, export] = [1, 2, 3, 4].map(|k| steps()[k].clone());
    // The same steps in another order, and one more: nothing else is done again, and no file is lost.
    let ids = json!({"do": "render", "what": "ids", "to": "ids_%03d.exr"});
    assert_eq!(run(&json!([track, ids, snap, export, render])), ["render"]);
    assert!(before.iter().all(|(name, bytes)| season.results().get(name) == Some(bytes)));
    // Two steps change places, and both are done anew.
    let (mut other_render, mut other_export) = (render.clone(), export.clone());
    other_render["parts"] = json!(["square"]);
    other_export["motion"] = json!("linear");
    assert_eq!(run(&json!([track, ids, snap, other_render, other_export])), ["render", "export"]);
    assert!(before.keys().all(|name| names(&season).contains(name)), "{:?}", names(&season));
    // What a step wrote stays when the step is taken out, and is the batch's own when it comes back.
    assert!(run(&json!([track, snap])).is_empty());
    assert!(before.keys().all(|name| names(&season).contains(name)), "{:?}", names(&season));
    assert_eq!(run(&json!([render, export])).len(), 2, "they read another document now");
}

#[test]
fn files_of_a_step_that_is_taken_out_stay_where_others_of_its_kind_are_done() {
    let season = Season::new(1);
    let render = |what: &str, to: &str| json!({"do": "render", "what": what, "to": to});
    let (track, matte, ids) = (json!({"do": "track"}), render("matte", "a_%03d.png"), render("ids", "b_%03d.exr"));
    let run = |steps: &Value| {
        season.manifest(steps, 1);
        season.good(&[]);
        season.results().into_keys().filter(|name| name.contains("_002")).collect::<Vec<_>>()
    };
    assert_eq!(run(&json!([track, matte, ids])), ["sh0/a_002.png", "sh0/b_002.exr"]);
    draw(&season.path("in/sh0/f_002.png"), 11);
    assert_eq!(run(&json!([track, ids])), ["sh0/a_002.png", "sh0/b_002.exr"], "the ids are done again");
    // One new step for two old ones: nothing says which of them has another name now.
    assert_eq!(run(&json!([track, matte, ids])).len(), 2);
    assert_eq!(
        run(&json!([track, render("matte", "c_%03d.png")])),
        ["sh0/a_002.png", "sh0/b_002.exr", "sh0/c_002.png"]
    );
    assert_eq!(run(&json!([track, render("matte", "d_%03d.png")])).last().unwrap(), "sh0/d_002.png");
    assert!(!season.path("out/sh0/c_002.png").exists(), "one for one: it has another name");
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
fn files_whose_names_look_like_those_of_a_batch_stay() {
    let season = Season::new(1);
    let own =
        ["out/sh0/.new-idea.txt", "out/sh0/.new-folder/a.txt", "out/sh0/.sheet/notes.txt", "out/sh0/.sheet/1.png"];
    for path in own.map(|name| season.path(name)) {
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, "mine").unwrap();
    }
    season.good(&[]);
    draw(&season.path("in/sh0/f_002.png"), 12);
    season.good(&[]);
    for name in own {
        assert_eq!(fs::read_to_string(season.path(name)).unwrap(), "mine", "{name}");
    }
    assert!(season.path("out/sh0/.sheet/0.jpg").exists());
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
    let failure = season.record("sh1")["failure"].as_str().unwrap().replace('\\', "/");
    assert!(failure.contains("in/sh1"), "{failure}");
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
fn wrong_requests_end_before_any_work() {
    let season = Season::new(2);
    fs::write(season.path("notes.txt"), "mine").unwrap();
    let before = fs::read(season.path("in/sh0/f_001.png")).unwrap();
    for (more, expected) in [
        (["--shots", "0-1"], "expected places from 1 to 2"),
        (["--shots", "2-9"], "expected places from 1 to 2"),
        (["--shot", "sh9"], "--shot: found \"sh9\", expected one of \"sh0\", \"sh1\""),
        (["--memory", "0"], "expected a positive number"),
        (["--report", "in/sh0/project.json"], "the command reads"),
        (["--report", "in/sh0/f_001.png"], "f_001.png: cannot write: found a file that is no report"),
        (["--report", "out/summary.json"], "--report: found out/summary.json, expected another name"),
        (["--report", "out/sh1"], "--report: found out/sh1, expected another name"),
        (["--report", "notes.txt"], "notes.txt: cannot write: found a file that is no report"),
    ] {
        let output = season.run(&more);
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.code() == Some(2) && said.contains(expected), "{more:?}: {said}");
    }
    assert!(!season.path("out").exists());
    assert_eq!(fs::read_to_string(season.path("notes.txt")).unwrap(), "mine");
    assert_eq!(fs::read(season.path("in/sh0/f_001.png")).unwrap(), before);
}

#[test]
fn wrong_steps_and_names_of_results_end_before_any_work() {
    let season = Season::new(2);
    let track = json!({"do": "track"});
    for (steps, expected) in [
        (json!([{"do": "track", "preset": "magic"}]), "steps[0]: invalid value 'magic'"),
        (json!([{"do": "track", "preset": "magic"}]), "[possible values: rototoon, zhou2011,"),
        (
            json!([track, {"do": "snap", "to": "x.txt"}]),
            "steps[1]: to: found \"x.txt\", expected a name that ends with",
        ),
        (json!([{"do": "check", "drawings": "perhaps"}]), "steps[0]: invalid value 'perhaps' for '--drawings"),
        (json!([{"do": "snap", "colour": 3}]), "steps[0]: unexpected argument '--colour'"),
        (json!([{"do": "trak"}]), "steps[0]: do: found \"trak\""),
        (json!([track, {"do": "export", "to": "m.fbx"}]), "steps[1]: m.fbx: expected a name that ends in .svg"),
        (
            json!([track, {"do": "render", "to": "m_%04d.jpg"}]),
            "steps[1]: m_%04d.jpg: expected a name that ends in .png",
        ),
        (json!([track, {"do": "render", "to": "m_%x.png"}]), "steps[1]: output pattern \"m_%x.png\" has \"%x"),
        (json!([track, {"do": "render", "to": "m.png", "frames": "1-3"}]), "steps[1]: output pattern \"m.png\" has no"),
        (json!([track, {"do": "render", "what": "matte", "layers": "on", "to": "m_%04d.png"}]), ".exr for layers"),
        (json!([track, {"do": "render", "what": "matte", "scale": 2, "to": "m_%04d.png"}]), "steps[1]: scale: found 2"),
        (
            json!([track, {"do": "render", "what": "matte", "to": "m.####.exr"}]),
            "\"sh0\": render: to: found \"m.####.exr\" for frames 0 to 4",
        ),
    ] {
        season.manifest(&steps, 2);
        let output = season.run(&[]);
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.code() == Some(2) && said.contains(expected), "{expected}: {said}");
        assert!(!said.contains("found no steps"), "the shots are not told of it: {said}");
    }
    assert!(!season.path("out").exists());
    for drawings in [json!(true), json!(false), json!("on")] {
        season.manifest(&json!([{"do": "check", "drawings": drawings}]), 1);
        season.good(&[]);
    }
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

#[test]
fn a_shot_that_another_worker_has_keeps_back_no_other() {
    let season = Season::new(3);
    let folder = season.path("out/sh0");
    fs::create_dir_all(&folder).unwrap();
    let other = fs::File::create(folder.join(".lock")).unwrap();
    other.lock().unwrap();
    let worker = season.command(&["--jobs", "1"]).stderr(Stdio::piped()).spawn().unwrap();
    wait_for("it takes the others first", || season.has_event("wait"));
    assert_eq!(outcomes(&season.events("shot")), ["good", "good"]);
    // It looks again and again, and says so once.
    std::thread::sleep(Duration::from_millis(300));
    drop(other);
    let output = worker.wait_with_output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success() && said.contains("3 good, 0 want keys"), "{said}");
    assert_eq!(
        (said.matches("sh0: waiting for another worker").count(), season.events("wait").len()),
        (1, 1),
        "{said}"
    );
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
    wait_for("a step begins", || season.has_event("start"));
    assert!(Command::new("kill").args(["-TERM", &worker.id().to_string()]).status().unwrap().success());
    // It may have been quick.
    let status = worker.wait().unwrap();
    assert!(status.success() || status.signal() == Some(15), "{status:?}");
    // A machine under load may end the worker before it writes the line.
    assert!(season.events("stop").len() <= usize::from(!status.success()));
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
    let before = fs::read(season.path("in/sh0/f_001.png")).unwrap();
    for input in ["in/sh0/project.json", "in/sh0/f_001.png", "in/../in/sh1/f_000.png", "m.json"] {
        let (status, said) = job(&["-o", input]);
        assert!(status == Some(2) && said.contains("the command reads"), "{input}: {said}");
    }
    assert_eq!(fs::read(season.path("in/sh0/f_001.png")).unwrap(), before);
    assert_eq!(job(&["-o", "job.json"]).0, Some(0), "a template may be written anew");
}
