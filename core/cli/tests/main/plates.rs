//! Tests of footage as it comes: plates that begin on another frame, gaps in sequences, documents behind links, and the forms of the
//! pictures that are made of them.

use crate::cartoon::{Cartoon, bad, good, read, square, text};
use serde_json::{Value, json};
use std::fs;
use std::path::Path;

/// A document of two parts that are tracked on all frames.
fn tracked(cartoon: &Cartoon) -> std::path::PathBuf {
    let on = |last: i32| {
        let frames = (0..=last).map(|frame| (frame.to_string(), square(8.0 + 3.0 * f64::from(frame))));
        serde_json::Value::Object(frames.collect())
    };
    let part = |name: &str, depth: i32, last: i32| json!({"name": name, "depth": depth, "closed": true, "keys": on(last), "tracks": on(last)});
    cartoon.document("tracked.json", json!([part("near", 2, 6), part("far", 1, 3)]))
}

#[test]
fn what_is_exchanged_with_a_frame_offset_comes_back_with_it() {
    let cartoon = Cartoon::new();
    let document = tracked(&cartoon);
    for ending in ["nk", "ntp", "fxs"] {
        let [plain, plate, a, b] = ["plain", "plate", "a", "b"].map(|name| cartoon.path(&format!("{name}.{ending}")));
        good(&["export", text(&document), "-o", text(&plain)]);
        good(&["export", text(&document), "-o", text(&plate), "--frame-offset", "1001"]);
        assert_ne!(fs::read(&plain).unwrap(), fs::read(&plate).unwrap());
        let (a, b) = (a.with_extension("json"), b.with_extension("json"));
        good(&["import", text(&document), text(&plain), "-o", text(&a)]);
        let said = good(&["import", text(&document), text(&plate), "-o", text(&b), "--frame-offset", "1001"]);
        assert!(said.ends_with("as before \"far\", \"near\"\n"), "{said}");
        assert_eq!(fs::read(&a).unwrap(), fs::read(&b).unwrap(), "{ending}");
        let said = bad(&["import", text(&document), text(&plate), "-o", text(&b)], 1);
        assert!(said.contains(", expected a frame of the footage, 0 to 6; --frame-offset says"), "{said}");
    }
    for name in ["a.svg", "a.jsx"] {
        let to = cartoon.path(name);
        let said = bad(&["export", text(&document), "-o", text(&to), "--frame-offset", "1000"], 2);
        assert!(said.contains("which counts from its own beginning") && !to.exists(), "{said}");
    }
    let pattern = cartoon.path("m.%04d.png");
    let words = ["render", text(&document), "-o", text(&pattern), "--what", "matte", "--frames", "2-3"];
    good(&[&words[..], &["--frame-offset", "-1"]].concat());
    good(&[&words[..], &["--frame-offset", "1000"]].concat());
    let made = |number: &str| fs::read(cartoon.path(&format!("m.{number}.png"))).unwrap();
    assert_eq!(cartoon.names().iter().filter(|name| name.starts_with("m.")).count(), 4);
    assert!(made("0001") == made("1002") && made("0002") == made("1003") && made("0001") != made("0002"));
    let said = bad(&[&words[..], &["--frame-offset", "999999999"]].concat(), 2);
    assert!(said.contains("--frame-offset: found 999999999: frame 6 becomes 1000000005"), "{said}");
}

#[test]
fn frames_of_an_excerpt_stay_where_they_were() {
    let cartoon = Cartoon::new();
    let document = tracked(&cartoon);
    let (file, back, script) = (cartoon.path("some.svg"), cartoon.path("back.json"), cartoon.path("some.jsx"));
    for to in [&file, &script] {
        good(&["export", text(&document), "-o", text(to), "--frames", "2-4"]);
    }
    let bare = cartoon.document("bare.json", json!([]));
    good(&["import", text(&bare), text(&file), "-o", text(&back)]);
    let parts = read(&back)["parts"].as_array().unwrap().clone();
    let near = parts.iter().find(|part| part["name"] == "near").unwrap();
    assert_eq!(near["keys"].as_object().unwrap().keys().collect::<Vec<_>>(), ["2", "3", "4"]);
    assert_eq!(near["keys"]["3"], json!([[17, 12], [37, 12], [37, 36], [17, 36]]), "where the part is on frame 3");
    let script = fs::read_to_string(&script).unwrap();
    assert!(script.contains("\"frames\": 7") && script.contains("[2, [") && !script.contains("[0, ["), "{script}");
}

#[test]
fn some_parts_and_frames_can_leave_a_document() {
    let cartoon = Cartoon::new();
    let document = tracked(&cartoon);
    let (file, back) = (cartoon.path("some.fxs"), cartoon.path("back.json"));
    let export = ["export", text(&document), "-o", text(&file)];
    good(&[&export[..], &["--parts", "near", "--frames", "2-4", "--frame-offset", "1000"]].concat());
    let bare = cartoon.document("bare.json", json!([]));
    good(&["import", text(&bare), text(&file), "-o", text(&back), "--frame-offset", "1000"]);
    let parts = read(&back)["parts"].as_array().unwrap().clone();
    assert_eq!((parts.len(), &parts[0]["name"]), (1, &json!("near")));
    assert_eq!(parts[0]["keys"].as_object().unwrap().keys().collect::<Vec<_>>(), ["2", "3", "4"]);
    fs::remove_file(&file).unwrap();
    let said = bad(&[&export[..], &["--parts", "neat"]].concat(), 2);
    assert!(said.contains("--parts: no part \"neat\"; the document has \"near\", \"far\""), "{said}");
    let said = bad(&[&export[..], &["--parts", "far", "--frames", "5-6"]].concat(), 1);
    assert!(said.contains("of the parts and frames asked for: found no contour of a part"), "{said}");
    let said = bad(&[&export[..], &["--frames", "5-9"]].concat(), 2);
    assert!(
        said.contains("--frames: found 5 to 9, expected frames of the footage, 0 to 6") && !file.exists(),
        "{said}"
    );
    let json = cartoon.path("some.json");
    let said = bad(&["export", text(&document), "-o", text(&json), "--parts", "near"], 2);
    assert!(said.contains("which has the whole document") && !json.exists(), "{said}");
}

#[test]
fn a_gap_in_a_sequence_ends_work_at_once_and_all_gaps_are_named() {
    let cartoon = Cartoon::new();
    let (keyed, document) = (cartoon.keyed(), tracked(&cartoon));
    fs::remove_file(cartoon.frame(1)).unwrap();
    fs::remove_file(cartoon.frame(2)).unwrap();
    fs::write(cartoon.frame(4), "no picture").unwrap();
    let [out, painted] = ["out.json", "painted.json"].map(|name| cartoon.path(name));
    let mut clicked = read(&document);
    clicked["fills"] = json!([{"frame": 0, "regions": [{"at": [20, 20], "colour": [1, 0, 0]}]}]);
    fs::write(&painted, clicked.to_string()).unwrap();
    for words in [
        ["track", text(&keyed), "-o", text(&out)],
        ["snap", text(&document), "-o", text(&out)],
        ["trace", text(&document), "-o", text(&out)],
        ["fill", text(&painted), "-o", text(&out)],
    ] {
        let said = bad(&words, 1);
        let lines: Vec<&str> = said.lines().filter(|line| line.starts_with("error: ")).collect();
        assert_eq!(lines.len(), 2, "{words:?}: {said}");
        assert!(lines[0].contains("frame 1: no file") && lines[0].ends_with("(the same on frame 2)"), "{said}");
        assert!(lines[1].contains("frame 4: cannot read") && lines[1].contains("not a PNG"), "{said}");
    }
    assert!(!out.exists());
    // Frames that are not needed may be missing.
    good(&["trace", text(&document), "-o", text(&out), "--frames", "5-6"]);
}

#[test]
fn pictures_are_drawn_around_a_gap_and_the_missing_ones_are_named() {
    let cartoon = Cartoon::new();
    let document = tracked(&cartoon);
    fs::remove_file(cartoon.frame(2)).unwrap();
    let whole = fs::read(cartoon.frame(5)).unwrap();
    fs::write(cartoon.frame(5), &whole[..whole.len() / 2]).unwrap();
    for (name, what) in [("o.%d.png", "overlay"), ("c.%d.exr", "cutout")] {
        let to = cartoon.path(name);
        let said = bad(&["render", text(&document), "-o", text(&to), "--what", what], 1);
        assert!(said.contains("frame 2: no file") && said.contains("frame 5: cannot read"), "{said}");
        assert!(said.contains("5 of 7 frames were drawn; those named are missing"), "{said}");
        let made: Vec<_> = cartoon.names().into_iter().filter(|own| own.starts_with(&name[..2])).collect();
        assert_eq!(made, [0, 1, 3, 4, 6].map(|frame| name.replace("%d", &frame.to_string())));
    }
    // A matte is drawn from contours alone.
    let to = cartoon.path("m.%d.exr");
    good(&["render", text(&document), "-o", text(&to), "--what", "matte"]);
}

#[test]
fn warnings_of_drawn_pictures_come_before_the_missing_ones() {
    let cartoon = Cartoon::new();
    let keys = json!({"0": square(8.0), "6": square(26.0)});
    let document = cartoon.document("keys.json", json!([{"name": "near", "closed": true, "keys": keys}]));
    fs::remove_file(cartoon.frame(2)).unwrap();
    let to = cartoon.path("o.%d.png");
    let said = bad(&["render", text(&document), "-o", text(&to)], 1);
    let [warned, missing] =
        ["not tracked on all frames between its keys", "6 of 7 frames were drawn"].map(|own| said.find(own));
    assert!(warned.is_some() && missing > warned, "{said}");
}

#[test]
fn a_sheet_marks_frames_without_a_picture_of_their_own() {
    let cartoon = Cartoon::new();
    let document = tracked(&cartoon);
    let sheet = cartoon.path("sheet.png");
    const WIDE: u32 = 74;
    let cells = || {
        let sheet = image::open(&sheet).unwrap().to_rgb8();
        // A cell has a border of 5 px and a strip of 21 px, and 4 px between itself and the next one. Six are in a row.
        let (width, height) = ((sheet.width() - 4) / 6, (sheet.height() - 4) / 2);
        let at = |frame: u32| (4 + frame % 6 * width, 4 + frame / 6 * height);
        // Cells are as wide as the widest one, so the narrowest is compared.
        let cell = |(x, y): (u32, u32)| image::imageops::crop_imm(&sheet, x, y, WIDE, height - 4).to_image();
        (0..7).map(|frame| cell(at(frame)).into_raw()).collect::<Vec<_>>()
    };
    good(&["sheet", text(&document), "-o", text(&sheet)]);
    let whole = cells();
    fs::remove_file(cartoon.frame(2)).unwrap();
    let changed = |now: &[Vec<u8>]| (0..7).filter(|&frame| now[frame] != whole[frame]).collect::<Vec<_>>();
    // The document says that gaps are held.
    let held = cartoon.path("held.json");
    let mut json = read(&document);
    json["footage"]["gaps"] = json!("held");
    fs::write(&held, json.to_string()).unwrap();
    good(&["sheet", text(&held), "-o", text(&sheet)]);
    let holding = cells();
    assert_eq!(changed(&holding), [2]);
    fs::copy(cartoon.frame(1), cartoon.frame(2)).unwrap();
    good(&["sheet", text(&held), "-o", text(&sheet)]);
    assert_ne!(cells()[2], holding[2], "the same picture in a file of its own is not held");
    // A file that is missing, and one that is cut off.
    fs::remove_file(cartoon.frame(2)).unwrap();
    let bytes = fs::read(cartoon.frame(5)).unwrap();
    fs::write(cartoon.frame(5), &bytes[..bytes.len() / 2]).unwrap();
    let said = bad(&["sheet", text(&document), "-o", text(&sheet)], 1);
    assert!(said.contains("frame 2: no file") && said.contains("frame 5: cannot read"), "{said}");
    assert!(said.contains("5 of 7 frames were drawn; those named are missing"), "{said}");
    assert_eq!(changed(&cells()), [2, 5]);
    // A sheet without any picture is none.
    (0..7).filter(|frame| *frame != 2).for_each(|frame| fs::remove_file(cartoon.frame(frame)).unwrap());
    fs::remove_file(&sheet).unwrap();
    let said = bad(&["sheet", text(&document), "-o", text(&sheet)], 1);
    assert!(said.contains("none of 7 frames was drawn") && !sheet.exists(), "{said}");
}

#[test]
fn openexr_has_the_numbers_and_the_compression_that_are_asked_for() {
    let cartoon = Cartoon::new();
    let document = tracked(&cartoon);
    let channel = |name: &str, kind: u8| [name.as_bytes(), &[0, kind, 0, 0, 0]].concat();
    let holds = |file: &[u8], wanted: &[u8]| file.windows(wanted.len()).any(|own| own == wanted);
    let make = |what: &str, more: &[&str]| {
        let to = cartoon.path("a.exr");
        good(&[&["render", text(&document), "-o", text(&to), "--frames", "3", "--what", what], more].concat());
        fs::read(&to).unwrap()
    };
    let packed = |file: &[u8], number: u8| {
        holds(file, &[b"compression\0compression\0\x01\0\0\0".as_slice(), &[number]].concat())
    };
    let plain = make("ids", &[]);
    assert!(holds(&plain, &channel("A", 2)) && packed(&plain, 3));
    for (id, number) in [("none", 0), ("rle", 1), ("zips", 2), ("zip", 3), ("piz", 4)] {
        let file = make("ids", &["--exr", "half", "--compression", id]);
        assert!(packed(&file, number), "{id}");
        assert!(holds(&file, &channel("A", 1)) && holds(&file, &channel("R", 1)), "{id}");
        assert!(holds(&file, &channel("CryptoObject00.R", 2)), "{id}: ids have 32 bits");
    }
    let layers = make("matte", &["--layers", "on", "--exr", "half"]);
    assert!(holds(&layers, &channel("near.A", 1)));
    let to = cartoon.path("a.png");
    let said = bad(&["render", text(&document), "-o", text(&to), "--frames", "3", "--exr", "half"], 2);
    assert!(said.contains("found --exr half: expected no such option for a .png file"), "{said}");
}

#[cfg(unix)]
#[test]
fn a_document_behind_a_link_has_its_frames() {
    use std::os::unix::fs::symlink;
    let cartoon = Cartoon::new();
    let document = cartoon.keyed();
    let desk = tempfile::tempdir().unwrap();
    let (link, out) = (desk.path().join("project.json"), desk.path().join("out.json"));
    symlink(&document, &link).unwrap();
    good(&["check", text(&link)]);
    good(&["track", text(&link), "-o", text(&out)]);
    good(&["check", text(&out)]);
    good(&["track", text(&link), "-o", text(&link)]);
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    let pattern = |path: &std::path::Path| read(path)["footage"]["pattern"].clone();
    assert_eq!(pattern(&document), json!("frames/f_%03d.png"), "written through the link, it names the same frames");
    good(&["check", text(&document)]);
    // Frames beside the link come first: here one is missing.
    fs::create_dir(desk.path().join("frames")).unwrap();
    for frame in 0..6 {
        let name = format!("frames/f_{frame:03}.png");
        fs::copy(cartoon.path(&name), desk.path().join(&name)).unwrap();
    }
    assert!(bad(&["check", text(&link)], 1).contains("frame 6: no file"));
}

/// What a document has of its first part on its frames.
fn keys_of(document: &Path) -> Value {
    let whole: Value = serde_json::from_str(&fs::read_to_string(document).unwrap()).unwrap();
    floats(&whole["parts"][0])
}

/// A value whose numbers all have a point: documents write whole numbers without one.
fn floats(value: &Value) -> Value {
    match value {
        Value::Number(number) => json!(number.as_f64()),
        Value::Array(all) => all.iter().map(floats).collect(),
        Value::Object(fields) => fields.iter().map(|(name, value)| (name.clone(), floats(value))).collect(),
        other => other.clone(),
    }
}

#[test]
fn a_range_of_frames_and_files_for_each_frame_change_these_frames_alone() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let square = |left: i32| {
        let x = f64::from(left);
        json!([[x, 12.0], [x + 20.0, 12.0], [x + 20.0, 36.0], [x, 36.0]])
    };
    let tracks: serde_json::Map<_, _> = (0..10).map(|frame| (frame.to_string(), square(frame))).collect();
    let keys = json!({"0": square(0), "9": square(9)});
    let part = json!({"name": "arm", "closed": true, "keys": keys, "tracks": tracks, "depth": 0.0});
    let footage = json!({"pattern": "f_%03d.png", "first": 0, "last": 9, "fps": 12, "width": 64, "height": 48});
    fs::write(at("shot.json"), json!({"rototoon": 1, "footage": footage, "parts": [part]}).to_string()).unwrap();
    let (document, out) = (at("shot.json"), at("out.json"));
    let before = keys_of(&document);
    for name in ["cut.nk", "cut.svg", "cut.fxs", "cut.ntp", "cut.setting"] {
        for frames in ["3-6", "5"] {
            good(&["export", text(&document), "-o", text(&at(name)), "--frames", frames]);
            let said = good(&["import", text(&document), text(&at(name)), "-o", text(&out)]);
            assert_eq!(keys_of(&out), before, "{name} {frames}");
            assert!(said.contains("as before \"arm\"; the file says nothing of the frames 0-"), "{said}");
        }
    }
    good(&["export", text(&document), "-o", text(&at("draw_%02d.svg")), "--frames", "4-6"]);
    let drawn = fs::read_to_string(at("draw_05.svg")).unwrap();
    fs::write(at("draw_05.svg"), drawn.replace("M5 12", "M1 12")).unwrap();
    let said = good(&["import", text(&document), text(&at("draw_%02d.svg")), "-o", text(&out)]);
    let told = "changed \"arm\" on 5; the file says nothing of the frames 0-3, 7-9 of \"arm\": they stay as they are";
    assert!(said.contains(told), "{said}");
    let after = keys_of(&out);
    assert_eq!(after["keys"].as_object().unwrap().keys().collect::<Vec<_>>(), ["0", "5", "9"]);
    assert_eq!(after["tracks"]["5"][0], json!([1.0, 12.0]));
    assert_eq!((&after["tracks"]["4"], &after["keys"]["9"]), (&before["tracks"]["4"], &before["keys"]["9"]));
    let said = bad(&["import", text(&document), text(&at("none_%02d.svg")), "-o", text(&out)], 1);
    assert!(said.contains("found no file with a number from 0 to 9"), "{said}");
    let said = bad(&["import", text(&document), text(&at("draw_%02d.svg")), "-o", text(&out), "--frame", "3"], 2);
    assert!(said.contains("found --frame 3: expected no such option for a file for each frame"), "{said}");
}
