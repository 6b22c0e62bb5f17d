//! Tests of `rototoon batch` where things go wrong: long manifests, strange paths, folders that vanish, full disks, clocks.

use crate::season::{Season, draw, outcomes, steps};
use serde_json::{Value, json};
use std::fs;
#[cfg(unix)]
use std::process::Command;
use std::time::{Duration, SystemTime};

/// The summary of what was done.
fn summary(season: &Season) -> Value {
    serde_json::from_slice(&fs::read(season.path("out/summary.json")).unwrap()).unwrap()
}

#[test]
fn a_manifest_of_ten_thousand_shots() {
    let season = Season::new(1);
    let shot = |k: usize| json!({"name": format!("sh{k}"), "project": format!("in/sh{}/project.json", k.min(1))});
    let shots: Vec<_> = (0..10_000).map(shot).collect();
    fs::write(season.path("m.json"), json!({"rototoon_batch": 1, "steps": steps(), "shots": shots}).to_string())
        .unwrap();
    let output = season.run(&["--shots", "1-2"]);
    // The second shot's project is missing.
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(season.run(&["--summary"]).status.code(), Some(1));
    let found = summary(&season);
    assert_eq!((&found["good"], &found["failed"], &found["not_run"]), (&json!(1), &json!(1), &json!(9_998)));
    assert!(fs::metadata(season.path("out/index.html")).unwrap().len() < 10_000_000);
}

#[test]
fn strange_paths_are_paths_of_files_that_are_missing() {
    let season = Season::new(1);
    let paths =
        ["\\\\server\\share\\a.json", "//server/share/a.json", "smb://server/a.json", "Z:\\a.json", "~/a.json", ""];
    let mut shots = vec![json!({"name": "sh0", "project": "./in/../in/sh0/project.json"})];
    shots.extend(paths.iter().take(5).enumerate().map(|(k, path)| json!({"name": format!("p{k}"), "project": path})));
    let write = |shots: &[Value]| {
        let manifest = json!({"rototoon_batch": 1, "steps": [{"do": "track"}], "shots": shots});
        fs::write(season.path("m.json"), manifest.to_string()).unwrap();
    };
    write(&shots);
    let output = season.run(&["--jobs", "1"]);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert_eq!(outcomes(&season.events("shot")), ["good", "failed", "failed", "failed", "failed", "failed"]);
    assert_eq!(said.matches("a.json: cannot read the document: ").count(), 5, "{said}");
    shots.push(json!({"name": "empty", "project": paths[5]}));
    write(&shots);
    assert_eq!(season.run(&[]).status.code(), Some(2));
}

#[test]
fn names_may_hold_percent_signs_quotes_and_blanks() {
    let season = Season::new(1);
    for name in ["100% done", "%d", "%04d it's $HOME", "-o", "日本"] {
        let shot = json!({"name": name, "project": "in/sh0/project.json"});
        fs::write(season.path("m.json"), json!({"rototoon_batch": 1, "steps": steps(), "shots": [shot]}).to_string())
            .unwrap();
        season.good(&[]);
        assert!(season.path(&format!("out/{name}/matte_002.png")).is_file(), "{name}");
    }
}

#[test]
fn a_folder_of_results_that_is_gone_or_no_folder_concerns_its_shot_alone() {
    let season = Season::new(3);
    season.good(&["--shots", "1-2"]);
    fs::remove_dir_all(season.path("out/sh0")).unwrap();
    fs::remove_dir_all(season.path("out/sh1")).unwrap();
    fs::write(season.path("out/sh1"), "a file").unwrap();
    season.clear_report();
    let output = season.run(&["--jobs", "1"]);
    assert_eq!(output.status.code(), Some(1));
    let events = season.events("shot");
    assert_eq!(outcomes(&events), ["good", "failed", "good"]);
    assert_eq!(fs::read_to_string(season.path("out/sh1")).unwrap(), "a file");
    // Screen, report, summary and page say the same.
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("2 good, 0 want keys, 1 failed, 0 not run"), "{said}");
    let reason = events[1]["failure"].as_str().unwrap();
    assert!(reason.contains("sh1: cannot write: ") && said.contains(reason), "{reason} / {said}");
    assert_eq!(events[1]["seconds"].to_string(), "0.0");
    let found = summary(&season);
    assert_eq!((&found["failed"], &found["not_run"]), (&season.events("end")[0]["failed"], &json!(0)));
    assert_eq!((&found["shots"][1]["outcome"], &found["shots"][1]["failure"]), (&json!("failed"), &json!(reason)));
    assert!(fs::read_to_string(season.path("out/index.html")).unwrap().contains("sh1: cannot write: "));
    // A later look at the folder finds why, too. Windows does not say that the folder is a file.
    assert_eq!(season.run(&["--summary"]).status.code(), Some(1));
    let found = summary(&season)["shots"][1].clone();
    assert!(cfg!(windows) || found["failure"].as_str().unwrap().contains("sh1"), "{found}");
}

fn outcome(season: &Season) -> Value {
    season.run(&["--summary"]);
    summary(season)["shots"][0]["outcome"].clone()
}

#[test]
fn a_summary_counts_only_what_was_run_with_the_manifest() {
    let season = Season::new(1);
    season.good(&[]);
    assert_eq!(outcome(&season), "good");
    // As many steps, and another one among them.
    let mut other = steps();
    other[4]["to"] = json!("shapes.nk");
    season.manifest(&other, 1);
    assert_eq!(outcome(&season), "not_run");
    season.good(&[]);
    assert_eq!(outcome(&season), "good");
    // A failure of other steps.
    fs::write(season.path("out/sh0/mine.svg"), "mine").unwrap();
    other[4]["to"] = json!("mine.svg");
    season.manifest(&other, 1);
    season.run(&[]);
    assert_eq!(outcome(&season), "failed");
    season.manifest(&steps(), 1);
    assert_eq!(outcome(&season), "not_run");
    // A record of an earlier version does not say what was asked.
    season.good(&[]);
    let mut record = season.record("sh0");
    record.as_object_mut().unwrap().remove("asked");
    fs::write(season.path("out/sh0/batch.json"), record.to_string()).unwrap();
    assert_eq!(outcome(&season), "good");
}

/// A season of one shot, in which a file of somebody else has the name of an export.
fn with_a_file_of_others() -> Season {
    let season = Season::new(1);
    fs::create_dir_all(season.path("out/sh0")).unwrap();
    fs::write(season.path("out/sh0/shapes.svg"), "mine").unwrap();
    assert_eq!(season.run(&[]).status.code(), Some(1));
    season.clear_report();
    season
}

fn done(season: &Season) -> Vec<String> {
    let events = season.events("step").into_iter().filter(|event| event["outcome"] == "done");
    events.map(|event| event["step"].as_str().unwrap().to_owned()).collect()
}

#[test]
fn a_shot_goes_on_where_a_step_gets_another_name_than_a_file_of_others() {
    let mut other = steps();
    other[4]["to"] = json!("other.svg");
    let mut without = steps();
    without.as_array_mut().unwrap().pop();
    for (manifest, wanted) in [(other, &["export"][..]), (without, &[])] {
        let season = with_a_file_of_others();
        season.manifest(&manifest, 1);
        season.good(&[]);
        assert_eq!(done(&season), wanted);
        assert_eq!(fs::read_to_string(season.path("out/sh0/shapes.svg")).unwrap(), "mine");
        assert!(!season.path("out/sh0/.new-shapes.svg").exists());
        assert_eq!(season.record("sh0")["pending"], json!({}));
    }
}

#[test]
fn a_shot_goes_on_where_a_file_of_others_is_moved_away() {
    let season = with_a_file_of_others();
    let said = String::from_utf8(season.run(&[]).stderr).unwrap();
    assert!(said.contains("choose another name in `to`") && done(&season).is_empty(), "{said}");
    // A new picture: the steps before it are done again all the same.
    draw(&season.path("in/sh0/f_002.png"), 11);
    assert_eq!(season.run(&[]).status.code(), Some(1));
    assert_eq!(done(&season), ["check", "track", "snap", "render"]);
    season.clear_report();
    fs::rename(season.path("out/sh0/shapes.svg"), season.path("out/sh0/mine.svg")).unwrap();
    season.good(&[]);
    assert!(done(&season).is_empty(), "the export waits for its name");
    assert!(fs::read_to_string(season.path("out/sh0/shapes.svg")).unwrap().contains("<svg"));
}

#[cfg(unix)]
#[test]
fn a_full_disk_leaves_nothing_half_written() {
    let (season, undisturbed) = (Season::new(2), Season::new(2));
    undisturbed.good(&[]);
    // Files may have at most 1024 bytes: what is longer cannot be written, as on a full disk.
    let limit = "trap '' XFSZ; ulimit -f 1; exec \"$0\" batch m.json -o out --jobs 1 --report /dev/null";
    let mut command = Command::new("bash");
    command.current_dir(season.folder.path()).args(["-c", limit, env!("CARGO_BIN_EXE_rototoon")]);
    let output = command.output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("File too large"), "{said}");
    // What has its final name is whole. What begins with a dot is not, and the next run removes it.
    let whole = undisturbed.results();
    assert!(season.results().iter().all(|(place, bytes)| whole.get(place) == Some(bytes)));
    season.good(&[]);
    assert_eq!(season.results(), whole);
}

#[cfg(target_os = "linux")]
#[test]
fn a_report_that_cannot_be_written_ends_the_batch() {
    let season = Season::new(1);
    let output = season.run(&["--report", "/dev/full"]);
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.code() == Some(1) && said.contains("/dev/full"), "{said}");
}

#[test]
fn clocks_play_no_part() {
    let season = Season::new(1);
    season.good(&[]);
    let mut times =
        [SystemTime::UNIX_EPOCH, SystemTime::now() + Duration::from_secs(90 * 365 * 86_400)].into_iter().cycle();
    for folder in ["in/sh0", "out/sh0"] {
        for entry in fs::read_dir(season.path(folder)).unwrap().map(|entry| entry.unwrap().path()) {
            if entry.is_file() {
                let file = fs::OpenOptions::new().append(true).open(entry).unwrap();
                file.set_modified(times.next().unwrap()).unwrap();
            }
        }
    }
    season.clear_report();
    season.good(&[]);
    assert_eq!(outcomes(&season.events("step")), ["unchanged"; 5]);
}

#[test]
fn a_report_that_a_spreadsheet_saved_is_written_on() {
    let season = Season::new(1);
    season.good(&[]);
    let path = season.path("out/report.jsonl");
    let text = fs::read_to_string(&path).unwrap();
    // As a table: quotes are doubled, lines end with CR LF, a mark stands before them, and the last line has no end.
    let table: Vec<_> = text.lines().map(|line| format!("\"{}\"", line.replace('"', "\"\""))).collect();
    fs::write(&path, format!("\u{feff}{}", table.join("\r\n"))).unwrap();
    season.good(&[]);
    let saved = fs::read_to_string(&path).unwrap();
    assert!(saved.starts_with('\u{feff}'));
    let new = saved.lines().skip(table.len());
    assert!(new.clone().count() > 5 && new.clone().all(|line| serde_json::from_str::<Value>(line).is_ok()));
    assert!(!fs::read_to_string(season.path("out/index.html")).unwrap().is_empty());
}

#[test]
fn one_picture_may_have_a_plain_name() {
    let season = Season::new(1);
    let render = |frames: &str| json!([{"do": "render", "what": "matte", "to": "m.png", "frames": frames}]);
    season.manifest(&render("3"), 1);
    season.good(&[]);
    assert!(season.path("out/sh0/m.png").is_file());
}

#[test]
fn the_report_of_a_step_is_one_of_its_results() {
    let season = Season::new(1);
    fs::write(season.path("notes.json"), "mine").unwrap();
    let track = |report: &str| json!([{"do": "track", "report": report}]);
    season.manifest(&track("../../notes.json"), 1);
    assert_eq!(season.run(&[]).status.code(), Some(2));
    assert_eq!(fs::read_to_string(season.path("notes.json")).unwrap(), "mine");
    season.manifest(&track("sure.json"), 1);
    season.good(&[]);
    assert!(season.record("sh0")["files"]["sure.json"].is_string());
    assert!(fs::read_to_string(season.path("out/sh0/sure.json")).unwrap().contains("\"sure\""));
}
