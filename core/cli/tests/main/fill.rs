//! Tests of `rototoon fill` from the command line.

use image::{ImageBuffer, Rgb};
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A box with a disc in it that move 4 px to the right on each of four frames, as footage of a document with these fields.
fn project(fields: Value) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    for frame in 0..4u32 {
        let picture = ImageBuffer::from_fn(160, 120, |x, y| {
            let (x, y) = (f64::from(x) + 0.5 - 4.0 * f64::from(frame), f64::from(y) + 0.5);
            let edge = ((x - 60.0).abs().max((y - 60.0).abs()) - 40.0).abs() < 1.5;
            let disc = ((x - 60.0).hypot(y - 60.0) - 15.0).abs() < 1.5;
            Rgb([if edge || disc { 20u8 } else { 250 }; 3])
        });
        picture.save(folder.path().join(format!("f_{frame:03}.png"))).unwrap();
    }
    let footage = json!({"pattern": "f_%03d.png", "first": 0, "last": 3, "fps": 12, "width": 160, "height": 120});
    let mut document = json!({"rototoon": 1, "footage": footage, "parts": [], "note": "kept"});
    document.as_object_mut().unwrap().extend(fields.as_object().unwrap().clone());
    let path = folder.path().join("project.json");
    fs::write(&path, document.to_string()).unwrap();
    (folder, path)
}

fn clicks() -> Value {
    let click = |x: f64, y: f64, colour: [f64; 3]| json!({"at": [x, y], "colour": colour});
    let regions = [click(5.0, 5.0, [1.0; 3]), click(30.0, 60.0, [0.9, 0.2, 0.1]), click(60.0, 60.0, [0.1, 0.2, 0.9])];
    json!({"fills": [{"frame": 0, "regions": regions}]})
}

fn run(command: &str, from: &Path, to: &Path, more: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_rototoon")).arg(command).arg(from).arg("-o").arg(to).args(more).output().unwrap()
}

fn told(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn clicks_paint_every_frame_and_the_svg() {
    let (folder, path) = project(clicks());
    let out = folder.path().join("painted.json");
    let output = run("fill", &path, &out, &[]);
    assert!(output.status.success(), "{}", told(&output));
    assert_eq!(told(&output).trim(), "note: 12 regions painted on 4 frames, 0 in doubt", "and no warning of parts");
    let document: Value = serde_json::from_str(&fs::read_to_string(&out).unwrap()).unwrap();
    assert_eq!(document["note"], "kept");
    let filled = document["filled"].as_array().unwrap();
    assert_eq!(filled.len(), 4);
    for drawing in filled {
        let regions = drawing["regions"].as_array().unwrap();
        let colours: Vec<&Value> = regions.iter().map(|region| &region["colour"]).collect();
        assert_eq!(colours, [&json!([1.0, 1.0, 1.0]), &json!([0.9, 0.2, 0.1]), &json!([0.1, 0.2, 0.9])]);
        let tracks: Vec<u64> = regions.iter().map(|region| region["track"].as_u64().unwrap()).collect();
        assert_eq!(tracks, [0, 1, 2]);
        assert_eq!(regions[1]["holes"].as_array().unwrap().len(), 1);
    }

    let picture = folder.path().join("painted.svg");
    let output = run("export", &out, &picture, &[]);
    assert!(output.status.success(), "{}", told(&output));
    let text = fs::read_to_string(picture).unwrap();
    assert!(text.contains(r##"<path id="fill-2" fill="#1a33e6" fill-rule="evenodd""##), "{text}");
    assert!(text.contains(r#"<g id="paint" inkscape:groupmode="layer" inkscape:label="Paint""#), "{text}");
}

#[test]
fn a_document_without_clicks_gets_a_message_and_no_file() {
    let (folder, path) = project(json!({}));
    let out = folder.path().join("painted.json");
    let output = run("fill", &path, &out, &[]);
    assert_eq!(output.status.code(), Some(1));
    assert!(told(&output).contains("fills: found no click, expected clicks of the paint bucket"), "{}", told(&output));
    assert!(!out.exists());
}

#[test]
fn clicks_that_paint_nothing_are_named() {
    let mut fields = clicks();
    let regions = fields["fills"][0]["regions"].as_array_mut().unwrap();
    regions.push(json!({"at": [400, 3], "colour": [0, 0, 0]}));
    let (folder, path) = project(fields);
    let output = run("fill", &path, &folder.path().join("painted.json"), &["--frames", "0-1"]);
    assert!(output.status.success());
    let expected = "note: frame 0, pixel (400.0, 3.0): the click fills[0].regions[3] lies on a line or outside of the picture, so it paints nothing";
    assert!(told(&output).contains(expected), "{}", told(&output));
}

#[test]
fn painted_regions_are_rendered_alone_and_under_the_drawing() {
    let (folder, path) = project(clicks());
    let (out, at) = (folder.path().join("painted.json"), |name: &str| folder.path().join(name));
    assert!(run("fill", &path, &out, &[]).status.success());
    let rendered = |what: &str, name: &str| {
        let output = run("render", &out, &at(name), &["--what", what]);
        assert!(output.status.success() && told(&output).is_empty(), "{}", told(&output));
    };
    rendered("paint", "paint_%d.png");
    rendered("painted", "painted_%d.png");
    rendered("paint", "paint_%d.exr");
    let open = |name: &str| image::open(at(name)).unwrap();
    let (paint, painted) = (open("paint_2.png").to_rgba8(), open("painted_2.png").to_rgba8());
    let drawing = open("f_002.png").to_rgba8();
    // On frame 2 everything is 8 px to the right.
    for (x, y, expected) in [(3, 3, [255, 255, 255, 255]), (38, 60, [230, 51, 26, 255]), (68, 60, [26, 51, 230, 255])] {
        assert_eq!(paint.get_pixel(x, y).0, expected, "{x} {y}");
        let over = painted.get_pixel(x, y).0;
        assert!((0..4).all(|k| over[k].abs_diff(expected[k]) < 8), "paper leaves the paint: {over:?} {expected:?}");
    }
    // The lines of so small a picture are thick for it: paint reaches into them by a pixel, and not to their middle.
    let ink_near = |x: u32, y: u32| {
        let around = (x.saturating_sub(1)..=x + 1).flat_map(|u| (y.saturating_sub(1)..=y + 1).map(move |v| (u, v)));
        around.into_iter().any(|(u, v)| u < 160 && v < 120 && drawing.get_pixel(u, v).0[0] < 50)
    };
    for (x, y, pixel) in paint.enumerate_pixels() {
        assert!(pixel.0[3] == 255 || ink_near(x, y), "no seam beside a line: {x} {y}");
    }
    for (over, line) in painted.pixels().zip(drawing.pixels()) {
        assert!(over.0[0] <= line.0[0].max(1), "ink stays ink: {over:?} {line:?}");
    }
    let light = open("paint_2.exr").to_rgba32f().get_pixel(38, 60).0;
    let red = ((230.0f32 / 255.0 + 0.055) / 1.055).powf(2.4);
    assert!((light[0] - red).abs() < 0.01 && light[3] == 1.0, "{light:?}");
    assert!(run("render", &out, &at("one_%d.exr"), &["--what", "paint", "--threads", "1"]).status.success());
    assert_eq!(fs::read(at("one_2.exr")).unwrap(), fs::read(at("paint_2.exr")).unwrap());
}

#[test]
fn what_was_not_painted_is_told_when_it_is_rendered() {
    let (folder, path) = project(clicks());
    let (some, to) = (folder.path().join("some.json"), folder.path().join("paint_%d.png"));
    let output = run("render", &path, &to, &["--what", "paint"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        told(&output).contains("filled: found none, expected the painted regions that `rototoon fill`"),
        "{}",
        told(&output)
    );
    assert!(run("fill", &path, &some, &["--frames", "0-1"]).status.success());
    let output = run("render", &some, &to, &["--what", "paint"]);
    assert!(output.status.success());
    assert!(told(&output).contains("frames 2, 3: not painted; run `rototoon fill` there"), "{}", told(&output));
    let empty = image::open(folder.path().join("paint_3.png")).unwrap().to_rgba8();
    assert!(empty.pixels().all(|pixel| pixel.0 == [0; 4]));
    let output = run("render", &some, &to, &["--what", "paint", "--frames", "0-1"]);
    assert!(output.status.success() && told(&output).is_empty(), "{}", told(&output));
    let output = run("render", &some, &to, &["--what", "paint", "--parts", "arm"]);
    assert!(!output.status.success());
    assert!(
        told(&output).contains("found \"arm\", expected none: painted regions and strokes belong to no part"),
        "{}",
        told(&output)
    );
}

/// Colour and name of the box, and its number, on each frame of a file.
fn boxes(path: &Path) -> Vec<(Value, Value, u64)> {
    let document: Value = serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap();
    let drawn = document["filled"].as_array().unwrap().iter();
    // It has a hole, and the paper has none that is not the box itself.
    let own = |drawing: &Value| {
        let regions = drawing["regions"].as_array().unwrap();
        let found =
            regions.iter().find(|region| region["colour"] != json!([1.0, 1.0, 1.0]) && region.get("holes").is_some());
        found
            .map(|region| (region["colour"].clone(), region["name"].clone(), region["track"].as_u64().unwrap()))
            .unwrap()
    };
    drawn.map(own).collect()
}

#[test]
fn a_colour_becomes_another_one_and_fill_keeps_it() {
    let (folder, path) = project(clicks());
    let [painted, wet, again, back] =
        ["painted", "wet", "again", "back"].map(|name| folder.path().join(name).with_extension("json"));
    assert!(run("fill", &path, &painted, &[]).status.success());
    let asked = ["--from", "#e6331a", "--to", "wet", "--look", "#202040", "--first", "2"];
    let output = run("recolour", &painted, &wet, &asked);
    assert!(output.status.success(), "{}", told(&output));
    assert_eq!(told(&output).trim(), r##"note: #e6331a becomes "wet" from frame 2 on: 2 painted regions"##);
    let found = boxes(&wet);
    let dry = (json!([0.9, 0.2, 0.1]), Value::Null, 1);
    assert_eq!(found[..2], [dry.clone(), dry.clone()]);
    assert!(found[2..].iter().all(|own| own.1 == "wet" && own.2 == 3), "{found:?}");
    let output = run("fill", &wet, &again, &[]);
    assert!(
        told(&output).contains("recolours[0]: #e6331a becomes \"wet\" from frame 2 on: 2 regions"),
        "{}",
        told(&output)
    );
    assert_eq!(boxes(&again), found);
    // It is taken back with the same colours.
    let output = run("recolour", &again, &back, &["--from", "#e6331a", "--to", "wet", "--remove"]);
    assert!(told(&output).contains("removed: #e6331a becomes"), "{}", told(&output));
    assert!(run("fill", &back, &again, &[]).status.success());
    assert_eq!(fs::read_to_string(&again).unwrap(), fs::read_to_string(&painted).unwrap());
}

#[test]
fn colours_that_cannot_become_others_are_named() {
    let (folder, path) = project(clicks());
    let out = folder.path().join("out.json");
    for (asked, wanted) in [
        (
            &["--from", "coat", "--to", "#000000"][..],
            r##"--from: found "coat", expected a colour of the paint: #ffffff, #e6331a, #1a33e6"##,
        ),
        (
            &["--from", "#e6331a", "--to", "wet"],
            "--to: found \"wet\", expected a colour of the paint (#ffffff, #e6331a, #1a33e6), or a new name with --look",
        ),
        (&["--from", "#e6331a", "--to", "#e6331a"], "--to: found #e6331a, expected another colour than that of --from"),
        (&["--from", "#e6331a", "--to", "#1a33e6", "--look", "#000000"], "--look: #1a33e6 has a look already"),
        (
            &["--from", "#e6331a", "--to", "#000000", "--first", "9"],
            "--first: frame 9 is outside the footage, which has frames 0 to 3",
        ),
        (
            &["--from", "#e6331a", "--to", "#000000", "--first", "3", "--last", "2"],
            "--last: found 2, expected at least 3, the first frame",
        ),
        (&["--from", "#e6331a", "--to", "#000000", "--remove"], "--remove: found no such entry: the document has none"),
    ] {
        let output = run("recolour", &path, &out, asked);
        assert_eq!(output.status.code(), Some(2), "{asked:?}");
        assert!(told(&output).contains(wanted), "{}", told(&output));
        assert!(!out.exists());
    }
}
