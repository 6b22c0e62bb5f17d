//! Tests of how commands say how far they are, where nobody looks at a terminal.

use crate::cartoon::{Cartoon, command, good, read, said, text};
use crate::season::Season;
use serde_json::{Value, json};
use std::fs;
use std::process::Output;

/// Tracks a cartoon with a way to tell progress.
fn track(cartoon: &Cartoon, way: &str) -> Output {
    let (project, out) = (cartoon.keyed(), cartoon.path(&format!("{way}.json")));
    let output = command(&["track", text(&project), "-o", text(&out), "--progress", way]).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    output
}

/// The lines of JSON in what a command said.
fn objects(said: &str) -> Vec<Value> {
    said.lines().filter(|line| line.starts_with('{')).map(|line| serde_json::from_str(line).unwrap()).collect()
}

/// Shares that never fall, from nothing to all.
fn rises(percents: &[f64]) -> bool {
    percents.first() == Some(&0.0) && percents.last() == Some(&100.0) && percents.is_sorted()
}

#[test]
fn a_log_has_lines_with_the_document_the_percent_and_the_time() {
    let cartoon = Cartoon::new();
    let output = track(&cartoon, "lines");
    let (said, name) = (said(&output), cartoon.path("project.json").display().to_string());
    let told: Vec<&str> = said.lines().filter_map(|line| line.strip_prefix("progress: ")).collect();
    assert!(told.len() >= 2 && output.stdout.is_empty(), "{said}");
    let [first, last] = [told[0], told[told.len() - 1]];
    for (line, percent) in [(first, "0 %"), (last, "100 %")] {
        let rest = line.strip_prefix(&format!("{name}: {percent}, ")).unwrap_or_else(|| panic!("{line}"));
        let (time, step) = rest.split_once(", ").unwrap_or_else(|| panic!("{line}"));
        let words: Vec<&str> = time.split(' ').collect();
        let is_time = |pair: &[&str]| pair[0].parse::<u32>().is_ok() && ["s", "min", "h"].contains(&pair[1]);
        assert!(words.len().is_multiple_of(2) && words.chunks(2).all(is_time) && !step.is_empty(), "{line}");
    }
}

#[test]
fn programs_read_progress_as_json() {
    let cartoon = Cartoon::new();
    let told = objects(&said(&track(&cartoon, "json")));
    let percents: Vec<f64> = told.iter().map(|line| line["percent"].as_f64().unwrap()).collect();
    assert!(rises(&percents), "{told:?}");
    for line in &told {
        assert_eq!(line["event"], "progress");
        assert_eq!(line["document"], text(&cartoon.path("project.json")));
        assert!(line["seconds"].as_f64().unwrap() >= 0.0 && line["step"].is_string(), "{line}");
    }
}

#[test]
fn work_in_two_parts_has_one_progress() {
    let cartoon = Cartoon::new();
    let project = cartoon.keyed();
    let mut drawn = read(&project);
    let line = |x: f64| json!([{"closed": false, "points": [[x, 10], [x, 25], [x, 40]]}]);
    drawn["drawings"] = json!([{"frame": 0, "strokes": line(8.5)}, {"frame": 6, "strokes": line(26.5)}]);
    fs::write(&project, drawn.to_string()).unwrap();
    let out = cartoon.path("out.json");
    for words in [
        &["check", text(&project), "--drawings"][..],
        &["check", text(&project)],
        &["tween", text(&project), "-o", text(&out), "--suggest"],
    ] {
        let said = good(&[words, &["--progress", "json"]].concat());
        let percents: Vec<f64> = objects(&said).iter().map(|line| line["percent"].as_f64().unwrap()).collect();
        assert!(rises(&percents) && percents.iter().filter(|percent| **percent == 100.0).count() == 1, "{said}");
    }
}

#[test]
fn an_engine_gets_its_own_lines_on_standard_output() {
    let cartoon = Cartoon::new();
    let output = track(&cartoon, "openjd");
    let told = String::from_utf8(output.stdout.clone()).unwrap();
    let percents: Vec<f64> =
        told.lines().filter_map(|line| line.strip_prefix("openjd_progress: ")?.parse().ok()).collect();
    assert!(rises(&percents), "{told}");
    assert_eq!(told.lines().filter(|line| line.starts_with("openjd_status: ")).count(), percents.len());
    assert!(!said(&output).contains("progress"), "{}", said(&output));
}

#[test]
fn without_a_terminal_nothing_is_told_and_results_do_not_depend_on_it() {
    let cartoon = Cartoon::new();
    for way in ["auto", "none"] {
        let output = track(&cartoon, way);
        assert!(output.stdout.is_empty() && said(&output).lines().all(|line| line.starts_with("note: ")));
    }
    track(&cartoon, "lines");
    let results = ["auto", "none", "lines"].map(|way| fs::read(cartoon.path(&format!("{way}.json"))).unwrap());
    assert!(results[0] == results[1] && results[0] == results[2]);
    assert!(read(&cartoon.path("auto.json"))["parts"][0]["tracks"].is_object());
}

#[test]
fn a_batch_tells_how_far_all_its_shots_are() {
    let season = Season::new(2);
    let told = objects(&season.good(&["--jobs", "2", "--progress", "json"]));
    let percents: Vec<f64> = told.iter().map(|line| line["percent"].as_f64().unwrap()).collect();
    assert!(percents.is_sorted() && percents.last() == Some(&100.0), "{told:?}");
    assert!(told.iter().any(|line| line["step"].as_str().unwrap().starts_with("sh")), "{told:?}");
    assert!(told.iter().all(|line| line["document"] == "m.json"), "{told:?}");
    // What the steps tell is no message of theirs.
    for event in season.events("step") {
        assert!(event["messages"].as_array().unwrap().iter().all(|line| !line.as_str().unwrap().starts_with("at: ")));
    }
}

#[test]
fn the_report_says_who_works_on_what_since_when() {
    let season = Season::new(2);
    let worker = season.command(&["--jobs", "2"]).spawn().unwrap();
    let pid = worker.id();
    assert!(worker.wait_with_output().unwrap().status.success());
    let lines = fs::read_to_string(season.path("out/report.jsonl")).unwrap();
    let lines: Vec<Value> = lines.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    for line in &lines {
        let time = line["time"].as_str().unwrap();
        assert!(time.len() == 24 && &time[10..11] == "T" && time.ends_with('Z'), "{line}");
        assert_eq!(line["pid"], pid, "{line}");
        assert_eq!(line["host"], lines[0]["host"]);
    }
    assert!(lines.iter().map(|line| line["time"].as_str().unwrap()).is_sorted(), "those of one worker: {lines:?}");
    let place = |event: &str, shot: &Value, step: &Value| {
        lines.iter().position(|line| line["event"] == event && line["shot"] == *shot && line["step"] == *step)
    };
    let ends: Vec<&Value> = lines.iter().filter(|line| line["event"] == "step").collect();
    assert_eq!(ends.len(), 10);
    for end in ends {
        let [begin, end] = ["start", "step"].map(|event| place(event, &end["shot"], &end["step"]));
        assert!(begin.is_some() && begin < end, "{lines:?}");
        let program = &lines[begin.unwrap()]["program"];
        assert!(program.is_u64() && *program != pid);
    }
    // What is found done does not begin.
    season.good(&[]);
    assert_eq!((season.events("start").len(), season.events("step").len()), (10, 20));
}
