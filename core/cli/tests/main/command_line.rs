//! Tests of the command line: the files that it writes, its messages, its exit status.

use crate::cartoon::{Cartoon, FRAMES, bad, command, draw, good, read, said, square, text};
use serde_json::{Value, json};
use std::fs;
use std::path::Path;

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
fn tracking_names_the_frames_that_have_no_file_and_are_held() {
    let cartoon = Cartoon::new();
    let (project, out) = (cartoon.keyed(), cartoon.path("out.json"));
    [2, 3, 5].into_iter().for_each(|frame| fs::remove_file(cartoon.frame(frame)).unwrap());
    let mut document = read(&project);
    document["footage"]["gaps"] = json!("held");
    fs::write(&project, document.to_string()).unwrap();
    let told = "footage.gaps: 3 of 7 frames have no file and show that of the frame before: 2-3, 5";
    for words in [["track", text(&project), "-o", text(&out)], ["snap", text(&out), "-o", text(&out)]] {
        let said = good(&words);
        let from = words[1];
        assert!(said.lines().any(|line| line == format!("note: {from}: {told}")), "{said}");
    }
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
    let way_out = r#"if the drawing before it is held, write "gaps": "held" in the document's footage"#;
    assert_eq!(lines[0], format!("{}no file {:?}; {way_out}", start(2), cartoon.frame(2)));
    let sizes = "is 60x48 pixels, but the footage is 64x48";
    assert_eq!(lines[1], format!("{}{:?} {sizes}", start(3), cartoon.frame(3)));
    for (line, frame) in lines[2..].iter().zip([4, 5]) {
        assert!(line.starts_with(&format!("{}cannot read {:?}: ", start(frame), cartoon.frame(frame))), "{line}");
    }
    let error = bad(&["track", text(&project), "-o", text(&out)], 1);
    // The file of frame 5 is damaged behind its head, so it would be found later.
    let begin = format!("error: {}: frame ", project.display());
    let named: Vec<_> = error.lines().filter_map(|line| line.strip_prefix(&begin)?.get(..2)).collect();
    assert_eq!(named, ["2:", "3:", "4:"], "{error}");
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
        ("one point", two(json!([[9, 12]])), "has 1 point, which encloses no area"),
        ("two points", two(json!([[9, 12], [20, 12]])), "has 2 points"),
        ("no area", two(json!([[9, 12], [20, 12], [14, 12]])), "encloses no area"),
        ("a figure of eight", two(json!([[9, 12], [20, 18], [20, 12], [9, 18]])), "crosses itself"),
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
fn names_and_frames_that_do_not_fit_are_named_with_file_and_option() {
    let cartoon = Cartoon::new();
    let (project, out) = (cartoon.keyed(), cartoon.path("out.json"));
    let (p, o, pictures) = (text(&project), text(&out), cartoon.path("a_%d.png"));
    let pictures = text(&pictures);
    for (arguments, wanted) in [
        (vec!["render", p, "-o", pictures, "--parts", "nose"], r#"--parts: no part "nose"; the document has "square""#),
        (
            vec!["render", p, "-o", pictures, "--frames", "5-7"],
            "--frames: found 5 to 7, expected frames of the footage, 0 to 6",
        ),
        (
            vec!["absent", p, "-o", o, "--part", "nose", "--frames", "2"],
            r#"--part: no part "nose"; the document has "square""#,
        ),
        (
            vec!["absent", p, "-o", o, "--part", "square", "--frames", "2-9"],
            "--frames: frame 9 is outside the footage, which has frames 0 to 6",
        ),
        (
            vec!["import", p, "none.svg", "-o", o, "--frame", "8"],
            "--frame: found 8, expected a frame of the footage, 0 to 6",
        ),
    ] {
        assert_eq!(bad(&arguments, 2), format!("error: {p}: {wanted}\n"), "{arguments:?}");
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
    // Another program may write the field alone. What was tracked there does not show.
    let mut edited = read(&tracked);
    edited["parts"][0]["absent"] = json!([[1, 4]]);
    fs::write(&again, edited.to_string()).unwrap();
    let checked = command(&["check", text(&again)]).output().unwrap();
    let told = String::from_utf8_lossy(&checked.stderr).into_owned();
    assert!(told.contains("tracks.\"1\": found a contour where the part is absent"), "{told}");
    let drawing = cartoon.path("drawing.svg");
    good(&["export", text(&again), "-o", text(&drawing)]);
    let drawing = fs::read_to_string(&drawing).unwrap();
    assert!(drawing.contains("keyTimes=\"0;0.138392;0.709821\" values=\"visible;hidden;visible\""), "{drawing}");
    let kept = absent(&project, "5-6", &again, &[]);
    let told = String::from_utf8_lossy(&kept.stderr).into_owned();
    assert!(kept.status.success() && told.contains("part \"square\" has a key on frame 6, so it is there"), "{told}");
    let refused = absent(&project, "2-9", &cartoon.path("no.json"), &[]);
    assert!(String::from_utf8_lossy(&refused.stderr).contains("frame 9 is outside the footage"));
    assert!(!cartoon.path("no.json").exists());
}

#[test]
fn keys_that_were_changed_after_tracking_are_named() {
    let cartoon = Cartoon::new();
    let (project, tracked) = (cartoon.keyed(), cartoon.path("tracked.json"));
    good(&["track", text(&project), "-o", text(&tracked)]);
    let [out, shapes, sheet] = ["out.json", "out.svg", "sheet.png"].map(|name| cartoon.path(name));
    let mattes = cartoon.path("matte_%02d.png");
    let commands: [&[&str]; 5] = [
        &["check", text(&tracked)],
        &["snap", text(&tracked), "-o", text(&out)],
        &["export", text(&tracked), "-o", text(&shapes)],
        &["render", text(&tracked), "--what", "matte", "-o", text(&mattes)],
        &["sheet", text(&tracked), "-o", text(&sheet)],
    ];
    for words in commands {
        assert!(!good(words).contains("changed after tracking"), "{words:?}");
    }
    let mut edited = read(&tracked);
    edited["parts"][0]["keys"]["6"] = square(24.0);
    fs::write(&tracked, edited.to_string()).unwrap();
    for words in commands {
        let told = good(words);
        assert_eq!(told.matches("changed after tracking").count(), 1, "{words:?}: {told}");
    }
    assert!(!good(&["track", text(&tracked), "-o", text(&tracked)]).contains("changed after tracking"));
    assert!(!good(commands[2]).contains("changed after tracking"));
}

#[test]
fn a_path_of_another_system_is_told() {
    let cartoon = Cartoon::new();
    let project = cartoon.keyed();
    let with = |pattern: &str| {
        let mut document = read(&project);
        document["footage"]["pattern"] = pattern.into();
        fs::write(&project, document.to_string()).unwrap();
        bad(&["check", text(&project)], 1)
    };
    for (pattern, hint) in [
        (r"Z:\show\f_%03d.png", "the path looks like one of Windows"),
        ("$SHOW/f_%03d.png", "~ and variables such as $SHOW are not replaced"),
        ("~/f_%03d.png", "~ and variables such as $SHOW are not replaced"),
    ] {
        let error = with(pattern);
        assert!(error.contains(hint) && error.contains("no file"), "{error}");
    }
    assert!(!with("none/f_%03d.png").contains(';'), "nothing is said of other paths");
}
