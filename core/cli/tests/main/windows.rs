//! What is special on Windows: paths with backslashes, drive letters and servers, long paths, names in any script, files
//! that another program holds open. `cargo xtask windows` runs these tests under Wine.

use serde_json::{Value, json};
use std::fs::{self, OpenOptions};
use std::os::windows::fs::OpenOptionsExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Writes four frames with a square that moves 3 px per frame, and a document with keys on the first and the last one.
fn cartoon(folder: &Path) -> PathBuf {
    fs::create_dir_all(folder.join("frames")).unwrap();
    for frame in 0..4 {
        let left = 8 + 3 * frame;
        let picture = image::RgbImage::from_fn(64, 48, |x, y| {
            let inside = (left..left + 20).contains(&x) && (12..36).contains(&y);
            image::Rgb(if inside { [200, 60, 40] } else { [180, 200, 220] })
        });
        picture.save(folder.join(format!("frames/f_{frame:03}.png"))).unwrap();
    }
    let square = |left: f64| json!([[left, 12.0], [left + 20.0, 12.0], [left + 20.0, 36.0], [left, 36.0]]);
    let footage = json!({"pattern": r"frames\f_%03d.png", "first": 0, "last": 3, "fps": 12, "width": 64, "height": 48});
    let part = json!({"name": "square", "keys": {"0": square(8.0), "3": square(17.0)}});
    let path = folder.join("project.json");
    fs::write(&path, json!({"rototoon": 1, "footage": footage, "parts": [part]}).to_string()).unwrap();
    path
}

fn track(from: &Path, to: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_rototoon")).arg("track").arg(from).arg("-o").arg(to).output().unwrap()
}

fn succeeded(output: &Output) {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

fn pattern(document: &Path) -> String {
    let text = fs::read_to_string(document).unwrap();
    assert!(!text.contains('\r'), "documents have line feeds only");
    let document: Value = serde_json::from_str(&text).unwrap();
    document["footage"]["pattern"].as_str().unwrap().to_owned()
}

#[test]
fn patterns_get_forward_slashes() {
    let folder = tempfile::tempdir().unwrap();
    let project = cartoon(&folder.path().join("shot"));
    let beside = folder.path().join(r"shot\tracked.json");
    succeeded(&track(&project, &beside));
    assert_eq!(pattern(&beside), "frames/f_%03d.png");
    fs::create_dir(folder.path().join("out")).unwrap();
    let elsewhere = folder.path().join(r"out\tracked.json");
    succeeded(&track(&beside, &elsewhere));
    assert_eq!(pattern(&elsewhere), "../shot/frames/f_%03d.png");
    succeeded(&track(&elsewhere, &folder.path().join("out/again.json")));
}

#[test]
fn names_may_be_in_any_script() {
    let folder = tempfile::tempdir().unwrap();
    let shot = folder.path().join("Füße und 猫 🎬");
    let project = cartoon(&shot);
    let out = shot.join("Ergebnis ß.json");
    succeeded(&track(&project, &out));
    assert_eq!(pattern(&out), "frames/f_%03d.png");
}

#[test]
fn paths_may_be_longer_than_260_characters() {
    let folder = tempfile::tempdir().unwrap();
    let deep = (0..8).fold(folder.path().to_owned(), |path, _| path.join("a folder with a name of forty characters"));
    assert!(deep.as_os_str().len() > 300);
    let project = cartoon(&deep);
    let out = deep.join("tracked.json");
    succeeded(&track(&project, &out));
    succeeded(&track(&project, &out));
    assert_eq!(pattern(&out), "frames/f_%03d.png");
    let short = folder.path().join("tracked.json");
    succeeded(&track(&project, &short));
    assert!(pattern(&short).starts_with("a folder with a name of forty characters/a folder"));
    succeeded(&track(&short, &folder.path().join("again.json")));
}

#[test]
fn another_drive_is_named_with_its_letter() {
    // `cargo xtask windows` gives the drive R.
    let Some(other) = std::env::var_os("ROTOTOON_OTHER_DRIVE").map(PathBuf::from) else { return };
    let folder = tempfile::tempdir().unwrap();
    let project = cartoon(folder.path());
    let out = other.join("tracked.json");
    succeeded(&track(&project, &out));
    let pattern = pattern(&out);
    assert!(pattern.as_bytes()[1] == b':' && pattern.ends_with("/frames/f_%03d.png"), "{pattern}");
    assert!(!pattern.contains('\\') && !pattern.contains('?'), "{pattern}");
    succeeded(&track(&out, &folder.path().join("back.json")));
    fs::remove_file(out).unwrap();
}

#[test]
fn a_server_is_named_with_its_share() {
    let Some(share) = std::env::var_os("ROTOTOON_SHARE").map(PathBuf::from) else { return };
    let shot = share.join("shot");
    let project = cartoon(&shot);
    succeeded(&track(&project, &shot.join("tracked.json")));
    assert_eq!(pattern(&shot.join("tracked.json")), "frames/f_%03d.png");
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("tracked.json");
    succeeded(&track(&project, &out));
    let pattern = pattern(&out);
    // Wine knows the folder behind its share, and names it by a drive.
    let whole = pattern.starts_with("//") || pattern.as_bytes()[1] == b':';
    assert!(whole && pattern.ends_with("/shot/frames/f_%03d.png"), "{pattern}");
    succeeded(&track(&out, &folder.path().join("again.json")));
    fs::remove_dir_all(shot).unwrap();
}

#[test]
fn a_file_that_is_open_elsewhere_is_kept_and_the_reason_told() {
    let folder = tempfile::tempdir().unwrap();
    let project = cartoon(folder.path());
    let out = folder.path().join("tracked.json");
    fs::write(&out, "mine").unwrap();
    // Shared for reading only, as many programs open their files.
    let held = OpenOptions::new().read(true).share_mode(1).open(&out).unwrap();
    let output = track(&project, &out);
    assert!(!output.status.success());
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(errors.contains("another program has the file open"), "{errors}");
    drop(held);
    assert_eq!(fs::read_to_string(&out).unwrap(), "mine");
    succeeded(&track(&project, &out));
    let names = fs::read_dir(folder.path()).unwrap().filter_map(|entry| entry.unwrap().file_name().into_string().ok());
    let left: Vec<String> = names.filter(|name| name.starts_with(".rototoon")).collect();
    assert!(left.is_empty(), "{left:?}");
}

#[test]
fn messages_and_progress_go_to_the_console_in_lines() {
    let folder = tempfile::tempdir().unwrap();
    let output = track(&folder.path().join("none.json"), &folder.path().join("out.json"));
    assert_eq!(output.status.code(), Some(1));
    let errors = String::from_utf8(output.stderr).unwrap();
    assert!(errors.starts_with("error: ") && errors.contains("none.json"), "{errors}");
}
