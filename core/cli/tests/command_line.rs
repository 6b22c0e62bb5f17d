//! Tests of the command line: the files that it writes, its messages, its exit status.

use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A folder with a short cartoon of 64x48 pixels: a square that moves 3 px per frame on frames 0 to 6.
struct Cartoon {
    folder: tempfile::TempDir,
}

const FRAMES: i32 = 7;

fn draw(path: &Path, frame: i32, width: u32, height: u32) {
    let left = 8 + 3 * frame;
    let picture = image::RgbImage::from_fn(width, height, |x, y| {
        let inside = (left..left + 20).contains(&(x as i32)) && (12..36).contains(&y);
        let grain = ((x * 7 + y * 13) % 11) as u8;
        image::Rgb(if inside { [200, 60 + 3 * grain, 40] } else { [180, 200, 220 + grain] })
    });
    picture.save(path).unwrap();
}

fn square(left: f64) -> Value {
    json!([[left, 12.0], [left + 20.0, 12.0], [left + 20.0, 36.0], [left, 36.0]])
}

impl Cartoon {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("frames")).unwrap();
        let cartoon = Self { folder };
        for frame in 0..FRAMES {
            draw(&cartoon.frame(frame), frame, 64, 48);
        }
        cartoon
    }

    fn frame(&self, frame: i32) -> PathBuf {
        self.path(&format!("frames/f_{frame:03}.png"))
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Writes the document `name` with these parts.
    fn document(&self, name: &str, parts: Value) -> PathBuf {
        let footage =
            json!({"pattern": "frames/f_%03d.png", "first": 0, "last": 6, "fps": 12, "width": 64, "height": 48});
        let path = self.path(name);
        fs::write(&path, json!({"rototoon": 1, "footage": footage, "parts": parts, "note": "kept"}).to_string())
            .unwrap();
        path
    }

    /// The document of the square with keys on the first and the last frame.
    fn keyed(&self) -> PathBuf {
        let part = json!({"name": "square", "keys": {"0": square(8.0), "6": square(26.0)}, "label": [1.0]});
        self.document("project.json", json!([part]))
    }

    /// Names of the files in the folder.
    fn names(&self) -> Vec<String> {
        let mut names: Vec<_> =
            fs::read_dir(self.folder.path()).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }
}

fn command(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rototoon"));
    command.args(arguments);
    command
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// Runs a command that must succeed. Returns its standard error.
fn good(arguments: &[&str]) -> String {
    let output = command(arguments).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", said(&output));
    assert!(output.stdout.is_empty());
    said(&output)
}

/// Runs a command that must fail with this exit status. Returns its standard error.
fn bad(arguments: &[&str], status: i32) -> String {
    let output = command(arguments).output().unwrap();
    assert_eq!(output.status.code(), Some(status), "{arguments:?}: {}", said(&output));
    said(&output)
}

fn read(path: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}

#[test]
fn tracking_fills_the_document_and_keeps_the_rest() {
    let cartoon = Cartoon::new();
    let (project, out) = (cartoon.keyed(), cartoon.path("out.json"));
    let report = cartoon.path("report.json");
    let said = good(&["track", text(&project), "-o", text(&out), "--report", text(&report)]);
    assert!(said.starts_with("note: part \"square\": "), "{said}");
    let of = |what: &str| read(&report)["parts"][0][what].as_array().unwrap().len();
    assert_eq!(of("sure") + of("doubtful") + of("lost"), 5, "the keys are not counted");
    assert_eq!(read(&report)["contours"]["sure"], of("sure"));
    fs::remove_file(&report).unwrap();
    let (before, after) = (read(&project), read(&out));
    assert_eq!(after["note"], "kept");
    assert_eq!(after["footage"]["pattern"], before["footage"]["pattern"]);
    let part = &after["parts"][0];
    assert_eq!((&part["name"], &part["closed"], &part["label"]), (&json!("square"), &json!(true), &json!([1.0])));
    for frame in ["0", "6"] {
        let numbers = |value: &Value| -> Vec<f64> {
            value.as_array().unwrap().iter().flat_map(|p| p.as_array().unwrap()).map(|x| x.as_f64().unwrap()).collect()
        };
        assert_eq!(numbers(&part["keys"][frame]), numbers(&before["parts"][0]["keys"][frame]));
        assert_eq!(part["tracks"][frame], part["keys"][frame]);
    }
    for frame in 0..FRAMES {
        let points = part["tracks"][frame.to_string()].as_array().unwrap();
        assert_eq!(points.len(), 4);
        let left = points[0][0].as_f64().unwrap();
        assert!((left - f64::from(8 + 3 * frame)).abs() < 1.5, "frame {frame}: {left}");
        assert_eq!(part["confidence"][frame.to_string()].as_array().unwrap().len(), 4);
    }
}

#[test]
fn the_result_does_not_depend_on_the_number_of_threads() {
    let cartoon = Cartoon::new();
    let (project, one, four) = (cartoon.keyed(), cartoon.path("1.json"), cartoon.path("4.json"));
    good(&["track", text(&project), "-o", text(&one), "--threads", "1"]);
    good(&["track", text(&project), "-o", text(&four), "--threads", "4"]);
    assert_eq!(fs::read(&one).unwrap(), fs::read(&four).unwrap());
    good(&["snap", text(&one), "-o", text(&one), "--threads", "1"]);
    good(&["snap", text(&four), "-o", text(&four), "--threads", "4"]);
    assert_eq!(fs::read(&one).unwrap(), fs::read(&four).unwrap());
    assert_eq!(read(&one)["parts"][0]["curves"]["3"].as_array().unwrap().len(), 4);
}

#[test]
fn a_document_written_elsewhere_finds_its_frames() {
    let cartoon = Cartoon::new();
    let project = cartoon.keyed();
    let other = cartoon.path("other/100%d");
    fs::create_dir_all(&other).unwrap();
    let out = other.join("out.json");
    good(&["track", text(&project), "-o", text(&out)]);
    assert_eq!(read(&out)["footage"]["pattern"], "../../frames/f_%03d.png");
    let note = good(&["check", text(&out)]);
    assert!(note.starts_with("note: ") && note.contains("outside the document's folder"), "{note}");
    let drawings = good(&["check", text(&out), "--drawings"]);
    assert!(drawings.contains("out.json: 7 frames show 7 drawings: 0, 1, 2, 3, 4, 5, 6\n"), "{drawings}");
    assert!(note.lines().count() == 2 && note.ends_with("out.json: usable\n"), "{note}");
    // Back from a folder whose own name contains a pattern for a number.
    fs::rename(cartoon.path("frames"), other.join("frames")).unwrap();
    fs::copy(&project, other.join("p.json")).unwrap();
    let back = cartoon.path("back.json");
    good(&["export", text(&other.join("p.json")), "-o", text(&back)]);
    assert_eq!(read(&back)["footage"]["pattern"], "other/100%%d/frames/f_%03d.png");
    assert_eq!(good(&["check", text(&back)]), format!("note: {}: usable\n", back.display()));
    // With a path relative to the working directory.
    let here = command(&["check", "back.json"]).current_dir(cartoon.folder.path()).output().unwrap();
    assert_eq!(here.status.code(), Some(0), "{}", said(&here));
}

#[test]
fn missing_and_unreadable_frames_are_named() {
    let cartoon = Cartoon::new();
    let (project, out) = (cartoon.keyed(), cartoon.path("out.json"));
    fs::remove_file(cartoon.frame(2)).unwrap();
    draw(&cartoon.frame(3), 3, 60, 48);
    fs::write(cartoon.frame(4), "no picture").unwrap();
    let whole = fs::read(cartoon.frame(5)).unwrap();
    fs::write(cartoon.frame(5), &whole[..whole.len() / 2]).unwrap();
    let lines = bad(&["check", text(&project)], 1);
    let lines: Vec<_> = lines.lines().collect();
    assert_eq!(lines.len(), 4, "{lines:?}");
    let start = |frame: i32| format!("error: {}: footage: frame {frame}: ", project.display());
    assert_eq!(lines[0], format!("{}no file {:?}", start(2), cartoon.frame(2)));
    let sizes = "is 60x48 pixels, but the footage is 64x48";
    assert_eq!(lines[1], format!("{}{:?} {sizes}", start(3), cartoon.frame(3)));
    for (line, frame) in lines[2..].iter().zip([4, 5]) {
        assert!(line.starts_with(&format!("{}cannot read {:?}: ", start(frame), cartoon.frame(frame))), "{line}");
    }
    let error = bad(&["track", text(&project), "-o", text(&out)], 1);
    assert!(error.starts_with("error: frame ") && error.lines().count() == 1, "{error}");
    assert!(!out.exists());
    // Snapping needs only the frames of the keys, and these exist.
    good(&["snap", text(&project), "-o", text(&out)]);
}

#[test]
fn odd_parts_are_tracked_or_left_alone_with_a_warning() {
    let cartoon = Cartoon::new();
    let two = |points: Value| json!({"0": points, "6": points});
    let cases = [
        ("no key", json!({}), "there is no key"),
        ("one key", json!({"3": square(8.0)}), ""),
        ("no point", two(json!([])), "the part has no points"),
        ("one point", two(json!([[9, 12]])), "has 1 points"),
        ("two points", two(json!([[9, 12], [20, 12]])), "has 2 points"),
        ("no area", two(json!([[9, 12], [20, 12], [14, 12]])), "encloses no area"),
        ("one place", two(json!([[9, 12], [9, 12], [9, 12]])), "encloses no area"),
        ("off", two(json!([[-90, -12], [-70, -12], [-80, -50]])), "is completely outside of the picture"),
        ("far off", two(json!([[-9e5, -12], [9e5, -12], [-80, 9e5]])), ""),
    ];
    let parts: Vec<_> = cases.iter().map(|(name, keys, _)| json!({"name": name, "keys": keys})).collect();
    let project = cartoon.document("odd.json", json!(parts));
    let out = cartoon.path("out.json");
    let warnings = good(&["track", text(&project), "-o", text(&out)]);
    for (index, (name, _, warning)) in cases.iter().enumerate() {
        let place = format!("parts[{index}] {name:?}");
        let line = warnings.lines().find(|line| line.contains(&place));
        assert_eq!(
            line.is_some_and(|line| line.starts_with("warning: ") && line.contains(warning)),
            !warning.is_empty()
        );
    }
    assert_eq!(read(&out)["parts"][1]["tracks"]["3"], json!([[8, 12], [28, 12], [28, 36], [8, 36]]));
    for part in read(&out)["parts"].as_array().unwrap() {
        let finite = |value: &Value| value.as_array().unwrap().iter().all(|p| p[0].is_number() && p[1].is_number());
        for points in part["tracks"].as_object().into_iter().flat_map(|tracks| tracks.values()) {
            assert!(finite(points), "{part}");
        }
    }
    good(&["snap", text(&out), "-o", text(&out)]);
    good(&["check", text(&out)]);
    good(&["export", text(&out), "-o", text(&cartoon.path("out.svg"))]);
    good(&["render", text(&out), "-o", text(&cartoon.path("r_%d.png"))]);
    good(&["render", text(&out), "--what", "matte", "-o", text(&cartoon.path("m_%d.exr"))]);
}

#[test]
fn cutouts_have_the_footage_where_the_parts_are() {
    let cartoon = Cartoon::new();
    let project = cartoon.keyed();
    // Frame 0 with alpha: the upper half of the picture has alpha 102, the lower half 255.
    let mut cel = image::open(cartoon.frame(0)).unwrap().to_rgba8();
    cel.enumerate_pixels_mut().for_each(|(_, y, pixel)| pixel.0[3] = if y < 24 { 102 } else { 255 });
    cel.save(cartoon.frame(0)).unwrap();
    let (png, exr) = (cartoon.path("cut.png"), cartoon.path("cut.exr"));
    for out in [&png, &exr] {
        good(&["render", text(&project), "--what", "cutout", "--frames", "0", "-o", text(out)]);
    }
    let (png, exr) = (image::open(png).unwrap().to_rgba8(), image::open(exr).unwrap().to_rgba32f());
    for (x, y, found) in png.enumerate_pixels() {
        let inside = (8..28).contains(&x) && (12..36).contains(&y);
        let wanted = if inside { cel.get_pixel(x, y).0 } else { [0; 4] };
        assert_eq!(found.0, wanted, "{x} {y}");
        let (light, alpha) = (exr.get_pixel(x, y).0, f32::from(wanted[3]) / 255.0);
        // Linear light of an sRGB value (IEC 61966-2-1). All values here are above the linear segment of the curve.
        let red = alpha * ((f32::from(wanted[0]) / 255.0 + 0.055) / 1.055).powf(2.4);
        assert!((light[3] - alpha).abs() < 1e-6 && (light[0] - red).abs() < 1e-5, "{x} {y}: {light:?} {red} {alpha}");
    }
}

#[test]
fn bad_documents_give_one_line_per_problem() {
    let cartoon = Cartoon::new();
    let out = cartoon.path("out.json");
    let keyed = fs::read_to_string(cartoon.keyed()).unwrap();
    let cases = [
        (keyed[..keyed.len() / 2].to_owned(), 1, "the document ends too early: it was cut short"),
        (keyed.replace("\"rototoon\":1", "\"rototoon\":2"), 1, "found a document of version 2, expected version 1"),
        (keyed.replacen("[8.0,12.0]", "[NaN,12.0]", 1), 1, "found NaN, expected a finite number"),
        (keyed.replacen("[8.0,12.0],", "", 1).replacen("12", "null", 1), 1, "found null, expected a finite number"),
        (keyed.replacen("[8.0,12.0],", "", 1), 1, "found 4 points, expected 3 as on the part's first key, frame 0"),
        (keyed.replacen("\"name\"", "\"title\"", 1), 2, "the field \"name\" is missing"),
    ];
    let path = cartoon.path("bad.json");
    for (document, count, message) in cases {
        assert_ne!(document, keyed);
        fs::write(&path, document).unwrap();
        for arguments in [vec!["check", text(&path)], vec!["track", text(&path), "-o", text(&out)]] {
            let lines = bad(&arguments, 1);
            assert!(lines.contains(message), "{lines}");
            assert!(lines.lines().all(|line| line.starts_with(&format!("error: {}: ", path.display()))), "{lines}");
            assert!(lines.lines().count() >= count, "{lines}");
        }
    }
    let none = cartoon.path("none.json");
    assert!(bad(&["check", text(&none)], 1).contains("none.json: cannot read the document: "));
    assert!(!out.exists());
}

#[test]
fn wrong_use_ends_with_two() {
    let cartoon = Cartoon::new();
    let project = cartoon.keyed();
    let out = cartoon.path("out.json");
    let (p, o) = (text(&project), text(&out));
    for arguments in [
        vec![],
        vec!["follow", p],
        vec!["track", p],
        vec!["track", p, "-o", o, "--preset", "best"],
        vec!["track", p, "-o", o, "--threads", "-1"],
        vec!["snap", p, "-o", o, "--corridor-share", "x"],
        vec!["export", p, "-o", "a.mov"],
        vec!["render", p, "-o", "a_%d.jpg"],
        vec!["render", p, "-o", "a.png"],
        vec!["render", p, "-o", "a_%d_%d.png"],
        vec!["render", p, "-o", "a_%d.png", "--frames", "5-2"],
        vec!["render", p, "-o", "a_%d.png", "--frames", "5-7"],
        vec!["render", p, "-o", "a_%d.png", "--parts", "nose"],
    ] {
        assert!(!bad(&arguments, 2).is_empty(), "{arguments:?}");
    }
    assert_eq!(cartoon.names(), ["frames", "project.json"]);
}

#[test]
fn pictures_are_written_for_the_given_frames() {
    let cartoon = Cartoon::new();
    let project = cartoon.keyed();
    let out = cartoon.path("out.json");
    good(&["track", text(&project), "-o", text(&out)]);
    good(&["render", text(&out), "-o", text(&cartoon.path("o_%02d.png")), "--frames", "2-4"]);
    good(&["render", text(&out), "-o", text(&cartoon.path("m.exr")), "--frames", "0", "--what", "matte"]);
    assert_eq!(cartoon.names(), ["frames", "m.exr", "o_02.png", "o_03.png", "o_04.png", "out.json", "project.json"]);
    let matte = image::open(cartoon.path("m.exr")).unwrap().to_rgba32f();
    assert_eq!(matte.dimensions(), (64, 48));
    let area: f32 = matte.pixels().map(|pixel| pixel.0[3]).sum();
    assert!((area - 480.0).abs() < 1e-3, "{area}");
    let before = fs::read(cartoon.frame(2)).unwrap();
    let own = bad(&["render", text(&out), "-o", text(&cartoon.path("frames/f_%03d.png"))], 2);
    assert!(own.contains("that the command reads"), "{own}");
    assert_eq!(fs::read(cartoon.frame(2)).unwrap(), before);
}

#[test]
fn the_svg_has_a_path_for_each_part() {
    let cartoon = Cartoon::new();
    let svg = cartoon.path("out.svg");
    good(&["export", text(&cartoon.keyed()), "-o", text(&svg), "--motion", "linear"]);
    let text = fs::read_to_string(svg).unwrap();
    assert!(text.starts_with("<svg ") && text.ends_with("</svg>\n"));
    assert_eq!(text.matches("<path ").count(), 1);
    assert!(text.contains("viewBox=\"0 0 64 48\"") && text.contains("<title>square</title>"));
}

/// Checks that a command which could not write has left the old file, and no temporary file.
#[cfg(unix)]
fn unharmed(cartoon: &Cartoon, out: &Path, before: &[u8]) {
    assert_eq!(fs::read(out).unwrap(), before);
    assert!(cartoon.names().iter().all(|name| !name.starts_with(".rototoon")), "{:?}", cartoon.names());
}

#[cfg(unix)]
#[test]
fn a_full_disk_leaves_the_file_as_it_was() {
    let cartoon = Cartoon::new();
    let (project, out) = (cartoon.keyed(), cartoon.path("out.json"));
    fs::write(&out, "before").unwrap();
    // The limit on the file size makes writing fail half-way, as on a full disk.
    let script = "trap '' XFSZ; ulimit -f 1; exec \"$@\"";
    let output = Command::new("sh")
        .args(["-c", script, "sh", env!("CARGO_BIN_EXE_rototoon"), "track", text(&project), "-o", text(&out)])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1), "{}", said(&output));
    assert!(said(&output).contains("out.json: cannot write: "), "{}", said(&output));
    unharmed(&cartoon, &out, b"before");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_device_is_an_error() {
    let cartoon = Cartoon::new();
    let error = bad(&["export", text(&cartoon.keyed()), "-o", "/dev/full"], 2);
    assert!(error.contains("expected a name that ends in .svg, .nk, .ntp, .py, .jsx, .fxs or .json"), "{error}");
    let error = bad(&["track", text(&cartoon.keyed()), "-o", "/dev/full"], 1);
    assert!(error.starts_with("error: /dev/full: cannot write: "), "{error}");
}

#[cfg(unix)]
#[test]
fn a_read_only_folder_is_reported_before_the_work() {
    use std::os::unix::fs::PermissionsExt;
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

#[cfg(unix)]
#[test]
fn an_interrupt_leaves_no_incomplete_files() {
    use std::process::Stdio;
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
    assert_eq!((output.status.code(), said(&output).as_str()), (Some(1), "error: cancelled\n"));
    let files: Vec<_> = fs::read_dir(&out).unwrap().map(|entry| entry.unwrap().path()).collect();
    assert!(!files.is_empty() && files.len() < COUNT as usize);
    for file in files {
        assert_eq!(image::open(&file).unwrap().width(), 64, "{file:?}");
    }
}

/// A new folder with a file of curves, and the paths of that file and of an output file.
fn curves(text: &str) -> (tempfile::TempDir, PathBuf, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let (from, to) = (folder.path().join("curves.json"), folder.path().join("out.json"));
    fs::write(&from, text).unwrap();
    (folder, from, to)
}

fn fit(from: &Path, to: &Path, more: &[&str]) -> Output {
    command(&[&["fit", text(from), "-o", text(to)], more].concat()).output().unwrap()
}

#[test]
fn fit_writes_guides_in_place_of_points() {
    let circle: Vec<Value> = (0..120)
        .map(|k| (k as f64 * std::f64::consts::TAU / 120.0).sin_cos())
        .map(|(sin, cos)| json!([100.0 + 50.0 * cos, 80.0 + 50.0 * sin]))
        .collect();
    let line = json!({"closed": false, "name": "line", "points": [[0, 0], [5, 0], [9, 0]]});
    let document = json!({"curves": [{"closed": true, "points": circle}, line]});
    for preset in ["rototoon", "yang1986"] {
        let (_folder, from, to) = curves(&document.to_string());
        let said = fit(&from, &to, &["--tolerance", "0.5", "--preset", preset]);
        assert!(said.status.success(), "{said:?}");
        let written: Value = serde_json::from_str(&fs::read_to_string(&to).unwrap()).unwrap();
        let fitted = &written["curves"][0];
        assert!(fitted["points"].is_null() && fitted["closed"] == true);
        assert!(fitted["max_error"].as_f64().unwrap() <= 0.5);
        assert!((3..40).contains(&fitted["guides"].as_array().unwrap().len()));
        assert_eq!(fitted["corners"], json!([]));
        assert_eq!(written["curves"][1]["name"], "line");
        if preset == "rototoon" {
            assert_eq!(written["curves"][1]["guides"], json!([[0.0, 0.0], [9.0, 0.0]]));
        }
    }
}

#[test]
fn fit_names_what_is_wrong_and_writes_nothing() {
    let empty = r#"{"curves": [{"closed": true, "points": [[0, 0]]}, {"closed": false, "points": []}]}"#;
    let far = r#"{"curves": [{"closed": true, "points": [[0, 0], [1e12, 0]]}]}"#;
    let kind = r#"{"curves": [{"closed": 1, "points": [[0, 0]]}]}"#;
    for (document, message) in [
        (empty, "curves[1].points: found no points, expected at least one"),
        (far, "curves[0].points[1]: found (1000000000000, 0), expected numbers between -1e9 and 1e9"),
        (kind, "curves[0].closed: found 1, expected true or false"),
        ("{", "line 1, column 1: EOF while parsing an object"),
    ] {
        let (_folder, from, to) = curves(document);
        let said = fit(&from, &to, &["--tolerance", "1"]);
        let errors = String::from_utf8(said.stderr).unwrap();
        assert_eq!(said.status.code(), Some(1), "{errors}");
        assert_eq!(errors, format!("error: {}: {message}\n", from.display()));
        assert!(!to.exists());
    }
    let (_folder, from, to) = curves(r#"{"curves": []}"#);
    for bad in ["0", "-1", "nan", "inf", "one"] {
        let said = fit(&from, &to, &["--tolerance", bad]);
        let errors = String::from_utf8(said.stderr).unwrap();
        assert_eq!(said.status.code(), Some(2), "{errors}");
        assert!(errors.contains("expected a positive number of pixels"), "{errors}");
    }
    assert!(fit(&from, &to, &["--tolerance", "1"]).status.success());
    assert_eq!(fs::read_to_string(&to).unwrap(), "{\"curves\":[]}\n");
}

#[test]
fn a_part_is_marked_as_hidden_and_as_there_again() {
    let cartoon = Cartoon::new();
    let (project, hidden, again) = (cartoon.keyed(), cartoon.path("hidden.json"), cartoon.path("again.json"));
    let read = |path: &Path| -> Value { serde_json::from_slice(&fs::read(path).unwrap()).unwrap() };
    let absent = |from: &Path, frames: &str, to: &Path, more: &[&str]| {
        let given = [&["absent", text(from), "--part", "square", "--frames", frames, "-o", text(to)], more].concat();
        command(&given).output().unwrap()
    };
    assert!(absent(&project, "2-4", &hidden, &[]).status.success());
    assert_eq!(read(&hidden)["parts"][0]["absent"], json!([[2, 4]]));
    let tracked = cartoon.path("tracked.json");
    good(&["track", text(&hidden), "-o", text(&tracked)]);
    let frames: Vec<String> = read(&tracked)["parts"][0]["tracks"].as_object().unwrap().keys().cloned().collect();
    assert_eq!(frames, ["0", "1", "5", "6"]);
    assert!(absent(&tracked, "3", &again, &["--there"]).status.success());
    assert_eq!(read(&again)["parts"][0]["absent"], json!([[2, 2], [4, 4]]));
    let refused = absent(&project, "2-9", &cartoon.path("no.json"), &[]);
    assert!(String::from_utf8_lossy(&refused.stderr).contains("frame 9 is outside the footage"));
    assert!(!cartoon.path("no.json").exists());
}
