//! Hostile files meet every command within 2 GB of address space and 10 seconds of processor time. The command ends with
//! status 0, 1 or 2: it does not panic (101), abort (134) or get killed (137, 152).

use serde_json::{Value, json};
use std::fs;
use std::io::Read;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

/// Address space in KB, and seconds of processor time.
const LIMITS: &str = "ulimit -v 2097152 && ulimit -t 10 && exec \"$0\" \"$@\"";

fn within_limits(folder: &Path, words: &[&str]) -> Output {
    let program = env!("CARGO_BIN_EXE_rototoon");
    Command::new("sh").args(["-c", LIMITS, program]).args(words).current_dir(folder).output().unwrap()
}

fn footage(last: i64, width: u32, height: u32) -> Value {
    json!({"pattern": "f_%03d.png", "first": 0, "last": last, "fps": 12, "width": width, "height": height})
}

fn square(x: f64) -> Value {
    json!([[x, 12], [x + 20.0, 12], [x + 20.0, 36], [x, 36]])
}

/// Documents that ask for too much, or say what cannot be.
fn documents() -> Vec<(&'static str, Value)> {
    let part = |keys: Value| json!({"name": "a", "closed": true, "depth": 1, "keys": keys});
    let plain = || part(json!({"0": square(8.0), "3": square(12.0)}));
    let with = |footage: Value, parts: Vec<Value>| json!({"rototoon": 1, "footage": footage, "parts": parts});
    let mut uneven = plain();
    uneven["tracks"] = json!({"0": square(8.0), "1": [[1, 1]], "2": [], "3": square(12.0)});
    let stroke = |x: f64| json!([{"points": [[x, 0.0], [x + 9.0, 4.0], [x + 20.0, 1.0]], "closed": false}]);
    let mut drawn = with(footage(3, 64, 48), vec![]);
    drawn["drawings"] = json!({"-1000000000": stroke(0.0), "1000000000": stroke(5.0)});
    let heap: Vec<Value> = (0..400).map(|k| part(json!({"0": square(f64::from(k) * 0.05)}))).collect();
    let heap: Vec<Value> = heap
        .into_iter()
        .enumerate()
        .map(|(k, mut part)| {
            part["name"] = json!(format!("part {k}"));
            part
        })
        .collect();
    let far = json!([[8, 12], [1e6, 12], [28, 36], [8, 36]]);
    vec![
        ("size.json", with(footage(3, 65_535, 65_535), vec![plain()])),
        ("wide.json", with(footage(0, 4_000_000_000, 1), vec![plain()])),
        ("long.json", with(footage(2_000_000_000, 64, 48), vec![plain()])),
        ("frames.json", drawn),
        ("uneven.json", with(footage(3, 64, 48), vec![uneven])),
        ("heap.json", with(footage(0, 64, 48), heap)),
        ("far.json", with(footage(3, 64, 48), vec![part(json!({"0": far, "3": square(8.0)}))])),
        ("huge.json", with(footage(3, 64, 48), vec![part(json!({"0": [[1e300, 0], [0, 1e300], [-1e300, 0]]}))])),
    ]
}

/// A PNG whose header promises a picture of 46 000² pixels.
fn large_png() -> Vec<u8> {
    let mut file = Vec::new();
    let picture = image::GrayImage::new(1, 1);
    picture.write_to(&mut std::io::Cursor::new(&mut file), image::ImageFormat::Png).unwrap();
    // The header's width and height follow the signature, a length and the name of the chunk. Its checksum follows
    // 13 bytes of content.
    let size = 46_000u32.to_be_bytes();
    file[16..20].copy_from_slice(&size);
    file[20..24].copy_from_slice(&size);
    let sum = crc32(&file[12..29]).to_be_bytes();
    file[29..33].copy_from_slice(&sum);
    file
}

/// The checksum of a PNG chunk (ISO 3309).
fn crc32(bytes: &[u8]) -> u32 {
    let step = |sum: u32, _| if sum & 1 == 1 { 0xedb8_8320 ^ (sum >> 1) } else { sum >> 1 };
    !bytes.iter().fold(!0, |sum, &byte| (0..8).fold(sum ^ u32::from(byte), step))
}

fn commands(document: &str) -> Vec<Vec<&str>> {
    let mut list = vec![
        vec!["check", document],
        vec!["track", document, "-o", "out.json"],
        vec!["snap", document, "-o", "out.json"],
        vec!["tween", document, "-o", "out.json"],
        vec!["fit", document, "-o", "out.json", "--tolerance", "1"],
        vec!["style", "clip", document, "--character", "a", "--motion", "b", "-o", "out.json"],
        vec!["style", "reshape", document, "clips.json", "-o", "out.json"],
        vec!["import", document, "deep.svg", "-o", "out.json"],
    ];
    list.extend(
        ["out.svg", "out.nk", "out.ntp", "out.py", "out.fxs", "out.setting", "out.json"]
            .map(|to| vec!["export", document, "-o", to]),
    );
    for what in ["overlay", "matte", "cutout", "ids"] {
        list.extend(["r_%d.png", "r_%d.exr"].map(|to| vec!["render", document, "-o", to, "--what", what]));
    }
    list
}

#[test]
fn every_command_ends_in_order_on_hostile_files() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    for frame in 0..4 {
        fs::write(at(&format!("f_{frame:03}.png")), large_png()).unwrap();
    }
    let posture: Vec<[f64; 2]> = (0..17).map(|k| [f64::from(k % 3), f64::from(k)]).collect();
    let clip = json!({"character": "old", "motion": "walk", "points": [posture, posture]});
    fs::write(at("clips.json"), json!({"rototoon_clips": 1, "fps": 12, "clips": [clip]}).to_string()).unwrap();
    let svg = format!("<svg xmlns=\"http://www.w3.org/2000/svg\">{}", "<g>".repeat(20_000));
    fs::write(at("deep.svg"), svg + &"</g>".repeat(20_000) + "</svg>").unwrap();
    let mut runs = 0;
    for (name, document) in documents() {
        fs::write(at(name), document.to_string()).unwrap();
        for words in commands(name) {
            let output = within_limits(folder.path(), &words);
            let said = String::from_utf8_lossy(&output.stderr);
            let code = output.status.code();
            assert!(matches!(code, Some(0..=2)), "{words:?}: {:?} {said}", output.status);
            assert!(code == Some(0) || said.contains("error: "), "{words:?}: no reason: {said}");
            runs += 1;
        }
    }
    assert_eq!(runs, documents().len() * commands("").len());
}

/// Lines that take minutes to fit.
fn long_curves() -> String {
    let point = |k: i32| {
        let t = f64::from(k);
        [0.4 * t, 40.0 * (0.2 * t).sin() + 3.0 * (0.7 * t * t).sin()]
    };
    let points: Vec<[f64; 2]> = (0..200_000).map(point).collect();
    json!({"curves": [{"closed": false, "points": points}]}).to_string()
}

/// Clips whose style takes minutes to learn.
pub fn many_clips() -> String {
    let posture = |character: u32, motion: u32, frame: u32| -> Vec<[f64; 2]> {
        let sway = (0.4 * f64::from(frame + motion)).sin() * 0.1 * f64::from(1 + motion);
        (0..17).map(|k| f64::from(k) / 8.0).map(|y| [sway * y - 0.1 * f64::from(character) * y, y]).collect()
    };
    let clip = |(character, motion): (u32, u32)| {
        let points: Vec<_> = (0..60).map(|frame| posture(character, motion, frame)).collect();
        json!({"character": format!("c{character}"), "motion": format!("m{motion}"), "points": points})
    };
    let clips: Vec<Value> = (0..12).flat_map(|c| (0..8).map(move |m| (c, m))).map(clip).collect();
    json!({"rototoon_clips": 1, "fps": 12, "clips": clips}).to_string()
}

#[test]
fn long_work_ends_after_a_signal_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("curves.json"), long_curves()).unwrap();
    fs::write(folder.path().join("clips.json"), many_clips()).unwrap();
    let fit = &["fit", "curves.json", "--tolerance", "0.5", "-o", "out.json"][..];
    let translate = &["style", "translate", "clips.json", "--style", "c0", "--motion", "m0", "--content", "c1"][..];
    let translate = [translate, &["--preset", "liang2012", "--rank", "400", "-o", "out.json"]].concat();
    for (words, signal) in [(fit, "INT"), (fit, "TERM"), (&translate, "INT"), (&translate, "TERM")] {
        let program = env!("CARGO_BIN_EXE_rototoon");
        let started = Command::new(program).args(words).current_dir(folder.path()).stderr(Stdio::piped()).spawn();
        let mut child = started.unwrap();
        std::thread::sleep(Duration::from_millis(700));
        assert!(child.try_wait().unwrap().is_none(), "{words:?} is no long work");
        let sent = Command::new("kill").args(["-s", signal, &child.id().to_string()]).status().unwrap();
        assert!(sent.success());
        // The work takes minutes. The program promises 2 seconds; a loaded machine gets more.
        let end = Instant::now() + Duration::from_secs(20);
        while child.try_wait().unwrap().is_none() && Instant::now() < end {
            std::thread::sleep(Duration::from_millis(20));
        }
        let status = child.try_wait().unwrap();
        let _ = child.kill();
        let status = status.unwrap_or_else(|| panic!("{words:?} goes on after SIG{signal}"));
        // The system says which signal ended it; a shell gives 130 and 143.
        assert_eq!(status.signal(), Some(if signal == "INT" { 2 } else { 15 }), "{words:?}: {status:?}");
        let mut said = String::new();
        child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
        let line = format!(
            "error: {}: cancelled by SIG{signal}",
            if words[0] == "fit" { "curves.json" } else { "clips.json" }
        );
        assert!(said.starts_with(&line) && said.matches("error: ").count() == 1, "{said}");
        let left: Vec<_> = fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        assert_eq!(left.len(), 2, "{left:?}");
    }
}
