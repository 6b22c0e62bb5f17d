//! Tests of what stays of files when the program cannot write or is interrupted.

use crate::cartoon::{Cartoon, FRAMES, bad, command, good, said, text};
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

/// Checks that a command which could not write has left the old file, and no temporary file.
fn unharmed(cartoon: &Cartoon, out: &Path, before: &[u8]) {
    assert_eq!(fs::read(out).unwrap(), before);
    assert!(cartoon.names().iter().all(|name| !name.starts_with(".rototoon")), "{:?}", cartoon.names());
}

#[test]
fn a_full_disk_leaves_the_file_as_it_was() {
    let cartoon = Cartoon::new();
    let (project, out) = (cartoon.keyed(), cartoon.path("out.json"));
    fs::write(&out, "before").unwrap();
    // The limit on the file size makes writing fail half-way, as on a full disk.
    let script = "ulimit -f 1; exec \"$@\"";
    let output = Command::new("sh")
        .args(["-c", script, "sh", env!("CARGO_BIN_EXE_rototoon"), "track", text(&project), "-o", text(&out)])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1), "{}", said(&output));
    assert!(said(&output).contains("out.json: cannot write: "), "{}", said(&output));
    unharmed(&cartoon, &out, b"before");
}

#[test]
fn a_document_in_a_pipe_has_an_absolute_pattern_and_a_dash_is_refused() {
    let cartoon = Cartoon::new();
    let project = cartoon.keyed();
    let out = command(&["track", text(&project), "-o", "/dev/stdout"]).output().unwrap();
    assert_eq!(out.status.code(), Some(0), "{}", said(&out));
    let piped = cartoon.path("saved/elsewhere.json");
    fs::create_dir(cartoon.path("saved")).unwrap();
    fs::write(&piped, &out.stdout).unwrap();
    assert!(good(&["check", text(&piped)]).contains("usable"), "it finds its frames from anywhere");
    let error = bad(&["track", text(&project), "-o", "-"], 2);
    assert!(error.contains("expected a file; for a file of this name write ./-"), "{error}");
}

/// `nohup` starts a program with SIGHUP ignored, and it goes on when the terminal goes.
#[cfg(target_os = "linux")]
#[test]
fn a_program_under_nohup_outlives_its_terminal() {
    let cartoon = Cartoon::new();
    fs::write(cartoon.path("clips.json"), crate::budgets::many_clips()).unwrap();
    let words =
        ["style", "translate", "clips.json", "--style", "c0", "--motion", "m0", "--content", "c1", "-o", "out.json"];
    let child = |script: &str| {
        let program = env!("CARGO_BIN_EXE_rototoon");
        let mut started = Command::new("sh");
        started.args(["-c", script, "sh", program]).args(words).args(["--preset", "liang2012", "--rank", "400"]);
        started.current_dir(cartoon.folder.path()).stderr(Stdio::piped()).spawn().unwrap()
    };
    let hang_up = |child: &mut std::process::Child| {
        std::thread::sleep(Duration::from_millis(700));
        let sent = Command::new("kill").args(["-s", "HUP", &child.id().to_string()]).status().unwrap();
        assert!(sent.success());
        std::thread::sleep(Duration::from_millis(3000));
        child.try_wait().unwrap()
    };
    let (mut kept, mut ended) = (child("trap '' HUP; exec \"$@\""), child("exec \"$@\""));
    let status = hang_up(&mut kept);
    // A loaded machine gets more than the 1.5 seconds that the program takes.
    let later = |child: &mut std::process::Child| {
        (0..90).find_map(|_| {
            std::thread::sleep(Duration::from_secs(1));
            child.try_wait().unwrap()
        })
    };
    let other = hang_up(&mut ended).or_else(|| later(&mut ended));
    let _ = (kept.kill(), ended.kill());
    assert!(status.is_none(), "it ended with {status:?}");
    if hang_ups_are_ignored() {
        // These tests themselves run under nohup, so both programs outlive their terminal.
        return;
    }
    assert_eq!(other.and_then(|status| status.signal()), Some(1), "{other:?}");
}

/// Whether this process ignores SIGHUP, the first bit of the mask, and so all that it starts.
#[cfg(target_os = "linux")]
fn hang_ups_are_ignored() -> bool {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).is_some_and(|mask| mask & 1 == 1)
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_device_is_an_error() {
    let cartoon = Cartoon::new();
    let error = bad(&["export", text(&cartoon.keyed()), "-o", "/dev/full"], 2);
    assert!(
        error.contains("expected a name that ends in .svg, .nk, .ntp, .py, .jsx, .fxs, .setting or .json"),
        "{error}"
    );
    let error = bad(&["track", text(&cartoon.keyed()), "-o", "/dev/full"], 1);
    assert!(error.starts_with("error: /dev/full: cannot write: "), "{error}");
}

#[test]
fn a_read_only_folder_is_reported_before_the_work() {
    let cartoon = Cartoon::new();
    let project = cartoon.keyed();
    let folder = cartoon.path("locked");
    fs::create_dir(&folder).unwrap();
    let out = folder.join("out.json");
    fs::write(&out, "before").unwrap();
    fs::set_permissions(&folder, fs::Permissions::from_mode(0o555)).unwrap();
    if fs::write(folder.join("probe"), "").is_ok() {
        eprintln!("SKIPPED the test of a read-only folder: this user may write everywhere");
    } else {
        assert!(bad(&["track", text(&project), "-o", text(&out)], 1).contains("out.json: cannot write: "));
        unharmed(&cartoon, &out, b"before");
    }
    fs::set_permissions(&folder, fs::Permissions::from_mode(0o755)).unwrap();
    fs::set_permissions(&out, fs::Permissions::from_mode(0o444)).unwrap();
    assert!(
        bad(&["track", text(&project), "-o", text(&out)], 1).contains("out.json: cannot write: the file is read-only")
    );
    let none = cartoon.path("none/out.json");
    // The frames are missing too, but the folder is reported, because it is checked first.
    fs::remove_dir_all(cartoon.path("frames")).unwrap();
    assert!(bad(&["track", text(&project), "-o", text(&none)], 1).contains("none/out.json: cannot write: "));
}

#[test]
fn an_interrupt_leaves_no_incomplete_files() {
    let cartoon = Cartoon::new();
    const COUNT: i32 = 500;
    for frame in FRAMES..COUNT {
        fs::hard_link(cartoon.frame(0), cartoon.frame(frame)).unwrap();
    }
    let project = cartoon.keyed();
    let long = fs::read_to_string(&project).unwrap().replace("\"last\":6", &format!("\"last\":{}", COUNT - 1));
    fs::write(&project, long).unwrap();
    let out = cartoon.path("out");
    fs::create_dir(&out).unwrap();
    let pattern = out.join("o_%03d.png");
    let mut child = command(&["render", text(&project), "-o", text(&pattern), "--threads", "1"])
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    while !out.join("o_001.png").exists() && child.try_wait().unwrap().is_none() {
        std::thread::yield_now();
    }
    Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.signal(), Some(2), "{}", said(&output));
    assert!(said(&output).contains("project.json: cancelled by SIGINT after "), "{}", said(&output));
    let files: Vec<_> = fs::read_dir(&out).unwrap().map(|entry| entry.unwrap().path()).collect();
    assert!(!files.is_empty() && files.len() < COUNT as usize);
    for file in files {
        assert_eq!(image::open(&file).unwrap().width(), 64, "{file:?}");
    }
}

#[test]
fn folders_that_have_the_number_of_the_frame_are_looked_for_before_the_work() {
    let cartoon = Cartoon::new();
    let project = cartoon.keyed();
    let pattern = cartoon.path("f_%d/m.png");
    let words = ["render", text(&project), "-o", text(&pattern), "--what", "matte", "--frames", "1-2"];
    fs::create_dir(cartoon.path("f_1")).unwrap();
    let said = bad(&words, 1);
    assert!(said.contains("f_2/m.png: cannot write: there is no folder"), "{said}");
    assert!(!cartoon.path("f_1/m.png").exists());
    fs::create_dir(cartoon.path("f_2")).unwrap();
    good(&words);
    assert!(cartoon.path("f_1/m.png").exists() && cartoon.path("f_2/m.png").exists());
    // Frames that the footage does not have are not looked for one by one: that would take all memory.
    let far = ["render", text(&project), "-o", text(&pattern), "--what", "matte", "--frames", "0-2000000000"];
    assert!(bad(&far, 2).contains("expected frames of the footage"));
    fs::create_dir(cartoon.path("f_1001")).unwrap();
    good(&[
        "render",
        text(&project),
        "-o",
        text(&pattern),
        "--what",
        "matte",
        "--frames",
        "1",
        "--frame-offset",
        "1000",
    ]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_document_leaves_no_folder_whose_name_it_cannot_hold() {
    use std::os::unix::ffi::OsStrExt;
    let cartoon = Cartoon::new();
    let odd = cartoon.folder.path().join(std::ffi::OsStr::from_bytes(b"sh\xffot"));
    fs::create_dir(&odd).unwrap();
    fs::rename(cartoon.keyed(), odd.join("project.json")).unwrap();
    fs::rename(cartoon.path("frames"), odd.join("frames")).unwrap();
    let track = |out: &Path| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rototoon"));
        command.arg("track").arg(odd.join("project.json")).arg("-o").arg(out).output().unwrap()
    };
    let refused = track(&cartoon.path("moved.json"));
    assert_eq!(refused.status.code(), Some(1), "{}", said(&refused));
    let told = said(&refused);
    assert!(
        told.contains("moved.json: cannot write: found a folder on the way to the footage whose name is no UTF-8"),
        "{told}"
    );
    assert!(!told.contains("frames"), "before the work: {told}");
    assert!(!cartoon.path("moved.json").exists());
    let beside = track(&odd.join("tracked.json"));
    assert!(beside.status.success(), "{}", said(&beside));
}
