//! Tests of commands and batches that are asked to end: what was stopped does not look like what failed.

use crate::season::{Season, wait_for};
use serde_json::{Value, json};
use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc::channel;
use std::time::Duration;

/// More frames than are drawn while the test waits.
const MANY: usize = 20_000;

/// A season with one shot, whose only step draws many mattes.
fn long_render() -> Season {
    let season = Season::new(1);
    let path = season.path("in/sh0/project.json");
    let mut document: Value = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
    document["footage"]["last"] = json!(MANY - 1);
    fs::write(&path, document.to_string()).unwrap();
    season.manifest(&json!([{"do": "render", "what": "matte", "to": "m_%05d.png"}]), 1);
    season
}

/// Pictures in the folder of the shot, whole or not, under whatever names.
fn pictures(season: &Season) -> usize {
    fs::read_dir(season.path("out/sh0")).map_or(0, |entries| {
        entries.filter(|entry| entry.as_ref().unwrap().file_name().to_str().unwrap().contains("m_")).count()
    })
}

fn send(signal: &str, to: &str) {
    assert!(Command::new("kill").args(["-s", signal, "--", to]).status().unwrap().success());
}

/// How a program ends that was asked to, and what it said.
fn end(mut child: Child) -> (ExitStatus, String) {
    wait_for("it ends", || child.try_wait().unwrap().is_some());
    let mut said = String::new();
    child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
    (child.wait().unwrap(), said)
}

/// The batch, in a group of its own as a shell starts it, with its step under way.
fn started(season: &Season) -> Child {
    let child = season.command(&["--fine", "all"]).process_group(0).stderr(Stdio::piped()).spawn().unwrap();
    wait_for("pictures", || pictures(season) > 3);
    child
}

#[test]
fn a_command_ends_by_the_signal_and_says_how_many_frames_are_whole() {
    for (signal, number) in [("INT", 2), ("TERM", 15), ("HUP", 1)] {
        let season = long_render();
        fs::create_dir_all(season.path("out/sh0")).unwrap();
        let mut command = Command::new(env!("CARGO_BIN_EXE_rototoon"));
        command.current_dir(season.path("in/sh0")).args(["render", "project.json", "--what", "matte"]);
        let child = command.args(["-o", "../../out/sh0/m_%05d.png"]).stderr(Stdio::piped()).spawn().unwrap();
        wait_for("pictures", || pictures(&season) > 3);
        send(signal, &child.id().to_string());
        if signal == "HUP" && hang_ups_are_ignored() {
            send("KILL", &child.id().to_string());
            continue;
        }
        let (status, said) = end(child);
        assert_eq!(status.signal(), Some(number), "{said}");
        let whole = pictures(&season);
        let line = format!("project.json: cancelled by SIG{signal} after {whole} of {MANY} frames, which are whole");
        assert_eq!(
            said.lines().filter(|line| line.starts_with("error: ")).collect::<Vec<_>>(),
            [format!("error: {line}")]
        );
    }
}

/// Whether this process ignores SIGHUP, as under `nohup`, and so all that it starts.
fn hang_ups_are_ignored() -> bool {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).is_some_and(|mask| mask & 1 == 1)
}

#[test]
fn a_shell_sees_the_usual_status() {
    let season = long_render();
    fs::create_dir_all(season.path("out/sh0")).unwrap();
    let script = "\"$0\" render project.json --what matte -o ../../out/sh0/m_%05d.png & child=$!
        while [ ! -e ../../out/sh0/m_00003.png ]; do kill -0 $child || exit 9; sleep 0.02; done; kill -TERM $child; wait $child; echo $?";
    let mut shell = Command::new("sh");
    let output = shell.current_dir(season.path("in/sh0")).args(["-c", script, env!("CARGO_BIN_EXE_rototoon")]).output();
    assert_eq!(String::from_utf8(output.unwrap().stdout).unwrap().trim(), "143");
}

#[test]
fn a_batch_that_is_stopped_with_its_programs_has_no_failed_shot() {
    for (signal, number, group) in [("TERM", 15, true), ("INT", 2, true), ("TERM", 15, false)] {
        let season = long_render();
        let child = started(&season);
        send(signal, &format!("{}{}", if group { "-" } else { "" }, child.id()));
        let (status, said) = end(child);
        assert_eq!(status.signal(), Some(number), "{said}");
        let line = format!("error: m.json: cancelled by SIG{signal} after 0 of 1 shots; start it again to go on");
        assert!(said.lines().any(|told| told == line) && said.matches("error: ").count() == 1, "{said}");
        // A machine under load may end the worker before it writes the line.
        assert!(season.events("stop").len() <= 1);
        assert!(season.events("step").is_empty() && season.events("shot").is_empty(), "nothing failed");
    }
}

#[test]
fn a_step_that_somebody_else_stopped_fails_its_shot_with_that_reason() {
    let season = long_render();
    let child = season.command(&[]).stderr(Stdio::piped()).spawn().unwrap();
    wait_for("pictures", || pictures(&season) > 3);
    send("TERM", &season.events("start")[0]["program"].to_string());
    let (status, said) = end(child);
    assert_eq!(status.code(), Some(1), "{said}");
    let failure = season.events("shot")[0]["failure"].to_string();
    assert!(failure.contains("render: ") && failure.contains("cancelled by SIGTERM after "), "{failure}");
    assert!(season.events("stop").is_empty() && season.events("end").len() == 1);
}

#[test]
fn a_program_that_has_answered_says_nothing_more() {
    let season = Season::new(1);
    let mut command = Command::new(env!("CARGO_BIN_EXE_rototoon"));
    command.current_dir(season.path("in/sh0")).arg("steps").stdin(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let mut requests = child.stdin.take().unwrap();
    requests.write_all(b"[\"check\", \"project.json\"]\n").unwrap();
    let mut said = BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    while !line.starts_with("step: 1 status=0 ") {
        line.clear();
        assert!(said.read_line(&mut line).unwrap() > 0, "it answers");
    }
    send("TERM", &child.id().to_string());
    line.clear();
    said.read_to_string(&mut line).unwrap();
    assert_eq!((line.as_str(), child.wait().unwrap().signal()), ("", Some(15)));
}

#[test]
fn a_command_without_long_work_is_named_too() {
    let season = Season::new(1);
    let (document, pipe) = (season.path("in/sh0/project.json"), season.path("in/sh0/pipe.json"));
    let mut long: Value = serde_json::from_slice(&fs::read(&document).unwrap()).unwrap();
    // More than a pipe takes, so that the program waits for its reader.
    long["note"] = json!("a".repeat(1 << 20));
    fs::write(&document, long.to_string()).unwrap();
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    for words in ["export project.json", "absent project.json --part square --frames 1"] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rototoon"));
        command.current_dir(season.path("in/sh0")).args(words.split(' ')).args(["-o", "pipe.json"]);
        let child = command.stderr(Stdio::piped()).spawn().unwrap();
        // A pipe opens for reading when the program writes to it.
        let (send_file, files) = channel();
        let pipe = pipe.clone();
        std::thread::spawn(move || send_file.send(fs::File::open(pipe)));
        let file = files.recv_timeout(Duration::from_secs(60)).expect("it writes the document").unwrap();
        send("TERM", &child.id().to_string());
        let (status, said) = end(child);
        assert_eq!(
            (status.signal(), said.as_str()),
            (Some(15), "error: project.json: cancelled by SIGTERM\n"),
            "{words}"
        );
        drop(file);
    }
}
