//! Tests of pictures of painted regions and traced strokes.

use image::{ImageBuffer, Rgb, RgbaImage};
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A document of two frames of 40 × 30 pixels with these fields.
fn project(fields: Value) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    for frame in 0..2 {
        let paper = ImageBuffer::from_pixel(40, 30, Rgb([255u8; 3]));
        paper.save(folder.path().join(format!("f_{frame}.png"))).unwrap();
    }
    let footage = json!({"pattern": "f_%d.png", "first": 0, "last": 1, "fps": 12, "width": 40, "height": 30});
    let mut document = json!({"rototoon": 1, "footage": footage, "parts": []});
    document.as_object_mut().unwrap().extend(fields.as_object().unwrap().clone());
    let path = folder.path().join("project.json");
    fs::write(&path, document.to_string()).unwrap();
    (folder, path)
}

/// A painted red square; a solid grey square to its left; a black line, 4 px wide, that crosses both and is written first.
fn drawn() -> Value {
    let square = |x: f64, y: f64, side: f64| json!([[x, y], [x + side, y], [x + side, y + side], [x, y + side]]);
    let region = json!({"outline": square(10.0, 5.0, 20.0), "colour": [1, 0, 0], "track": 3, "confidence": 1.0});
    let line =
        json!({"track": 1, "points": [[5, 15], [35, 15]], "closed": false, "widths": [4, 4], "colour": [0, 0, 0]});
    let solid =
        json!({"track": 7, "points": square(2.0, 12.0, 6.0), "closed": true, "fill": true, "colour": [0.5, 0.5, 0.5]});
    json!({
        "filled": [{"frame": 0, "regions": [region]}],
        "traced": [{"frame": 0, "strokes": [line, solid]}, {"frame": 1, "strokes": []}],
    })
}

fn render(from: &Path, to: &Path, more: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_rototoon")).arg("render").arg(from).arg("-o").arg(to).args(more).output().unwrap()
}

fn told(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn picture(from: &Path, what: &str, more: &[&str]) -> RgbaImage {
    let to = from.with_file_name(format!("{what}_%d.png"));
    let output = render(from, &to, &[&["--what", what, "--frames", "0"], more].concat());
    assert!(output.status.success() && told(&output).is_empty(), "{}", told(&output));
    image::open(from.with_file_name(format!("{what}_0.png"))).unwrap().to_rgba8()
}

#[test]
fn strokes_lie_over_solid_shapes_and_paint() {
    let (_folder, path) = project(drawn());
    let (black, grey, red, none) = ([0, 0, 0, 255], [128, 128, 128, 255], [255, 0, 0, 255], [0; 4]);
    let lines = picture(&path, "lines", &[]);
    let cel = picture(&path, "cel", &[]);
    for ((x, y), of_lines, of_cel) in [
        ((20, 15), black, black),
        ((20, 13), black, black),
        ((6, 15), black, black),
        ((3, 17), grey, grey),
        ((20, 8), none, red),
        ((20, 11), none, red),
        ((2, 2), none, none),
    ] {
        assert_eq!([lines.get_pixel(x, y).0, cel.get_pixel(x, y).0], [of_lines, of_cel], "{x} {y}");
    }
}

#[test]
fn pictures_have_the_size_that_is_asked_for() {
    let (_folder, path) = project(drawn());
    let cel = picture(&path, "cel", &["--scale", "2.5"]);
    assert_eq!(cel.dimensions(), (100, 75));
    // The line is 10 px wide now.
    let column = (0..75).filter(|&y| cel.get_pixel(50, y).0 == [0, 0, 0, 255]).count();
    assert!((9..=10).contains(&column), "{column}");
    assert_eq!(cel.get_pixel(50, 20).0, [255, 0, 0, 255]);
    let output = render(&path, &path.with_file_name("m_%d.png"), &["--what", "painted", "--scale", "2"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(told(&output).contains("--scale: found 2, expected 1: only paint, lines and cel"), "{}", told(&output));
}

#[test]
fn regions_and_strokes_are_keyed_by_their_numbers() {
    let (_folder, path) = project(drawn());
    let to = path.with_file_name("cel.exr");
    assert!(render(&path, &to, &["--what", "cel", "--frames", "0"]).status.success());
    let bytes = fs::read(&to).unwrap();
    let header = String::from_utf8_lossy(&bytes);
    for name in ["\"region 3\":", "\"stroke 1\":", "\"stroke 7\":"] {
        assert!(header.contains(name), "{name}");
    }
    let again = path.with_file_name("again.exr");
    assert!(render(&path, &again, &["--what", "cel", "--frames", "0", "--threads", "1"]).status.success());
    assert_eq!(bytes, fs::read(again).unwrap());
}

#[test]
fn frames_with_nothing_to_draw_are_told() {
    let (_folder, path) = project(drawn());
    let output = render(&path, &path.with_file_name("c_%d.png"), &["--what", "cel"]);
    assert!(output.status.success());
    assert!(told(&output).contains("frame 1: not painted; run `rototoon fill` there"), "{}", told(&output));
    assert!(!told(&output).contains("not drawn"), "frame 1 is traced, without any stroke: {}", told(&output));
    let (_folder, empty) = project(json!({}));
    for (what, field, command) in [("lines", "traced", "trace"), ("cel", "filled", "fill"), ("paint", "filled", "fill")]
    {
        let output = render(&empty, &empty.with_file_name("c_%d.png"), &["--what", what]);
        assert_eq!(output.status.code(), Some(1));
        let said = told(&output);
        assert!(
            said.contains(&format!("{field}: found none")) && said.contains(&format!("`rototoon {command}`")),
            "{said}"
        );
    }
}

#[test]
fn a_solid_shape_is_solid_between_its_keys() {
    let square = |x: f64| json!([[x, 8], [x + 10.0, 8], [x + 10.0, 18], [x, 18]]);
    let solid = |x: f64| json!([{"points": square(x), "closed": true, "fill": true, "colour": [1, 0, 0]}]);
    let drawings = json!([{"frame": -1, "strokes": solid(4.0)}, {"frame": 1, "strokes": solid(20.0)}]);
    let (folder, path) = project(json!({"drawings": drawings}));
    let tweened = folder.path().join("tweened.json");
    let words = ["tween", path.to_str().unwrap(), "-o", tweened.to_str().unwrap()];
    assert!(Command::new(env!("CARGO_BIN_EXE_rototoon")).args(words).status().unwrap().success());
    let lines = picture(&tweened, "lines", &[]);
    assert_eq!([lines.get_pixel(17, 13).0, lines.get_pixel(8, 13).0], [[255, 0, 0, 255], [0; 4]]);
}

/// A square with a red line, 2 px wide, and a fill.
fn painted_square(x: f64, fill: [f64; 3]) -> Value {
    let points = json!([[x, 5], [x + 20.0, 5], [x + 20.0, 25], [x, 25]]);
    json!({"points": points, "closed": true, "widths": [2, 2, 2, 2], "colour": [1, 0, 0], "fill_colour": fill})
}

#[test]
fn a_fill_lies_under_its_line_and_changes_its_colour_between_its_keys() {
    let line = |x: f64| json!({"points": [[x - 4.0, 21], [x + 24.0, 21]], "closed": false, "widths": [2, 2], "colour": [0, 0, 0]});
    let spot = |x: f64| {
        let points = json!([[x + 8.0, 8], [x + 12.0, 8], [x + 12.0, 12], [x + 8.0, 12]]);
        json!({"points": points, "closed": true, "fill": true, "colour": [1, 1, 0]})
    };
    let drawing =
        |frame: i32, x: f64, fill| json!({"frame": frame, "strokes": [line(x), painted_square(x, fill), spot(x)]});
    let drawings = [drawing(-1, 4.0, [0.0, 1.0, 0.0]), drawing(1, 16.0, [0.0, 0.0, 1.0])];
    let (folder, path) = project(json!({"drawings": drawings}));
    let tweened = folder.path().join("tweened.json");
    let run = |words: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_rototoon")).args(words).output().unwrap();
        assert!(output.status.success(), "{}", told(&output));
    };
    run(&["tween", path.to_str().unwrap(), "-o", tweened.to_str().unwrap()]);
    let document: Value = serde_json::from_str(&fs::read_to_string(&tweened).unwrap()).unwrap();
    assert_eq!(document["in_betweens"][0]["strokes"][1]["fill_colour"], json!([0.0, 0.5, 0.5]));
    let lines = picture(&tweened, "lines", &[]);
    // The square is at 10 px. It hides the black line, which is drawn before it; the yellow spot is drawn after it.
    let (red, mixed, yellow, black) = ([255, 0, 0, 255], [0, 128, 128, 255], [255, 255, 0, 255], [0, 0, 0, 255]);
    for ((x, y), expected) in [
        ((9, 15), red),
        ((10, 15), red),
        ((15, 18), mixed),
        ((15, 21), mixed),
        ((20, 10), yellow),
        ((7, 21), black),
        ((7, 15), [0; 4]),
    ] {
        assert_eq!(lines.get_pixel(x, y).0, expected, "{x} {y}");
    }
    let to = folder.path().join("lines.exr");
    assert!(render(&tweened, &to, &["--what", "lines", "--frames", "0"]).status.success());
    let bytes = fs::read(to).unwrap();
    let header = String::from_utf8_lossy(&bytes);
    assert!(["\"stroke 1\":", "\"stroke 1 fill\":", "\"stroke 2\":"].iter().all(|name| header.contains(name)));
    let to = folder.path().join("lines.svg");
    run(&["export", tweened.to_str().unwrap(), "-o", to.to_str().unwrap()]);
    let text = fs::read_to_string(to).unwrap();
    let order = [
        "id=\"stroke-0\"",
        "id=\"stroke-1\" fill=\"#008080\" stroke=\"#ff0000\" stroke-width=\"2\"",
        "id=\"stroke-2\"",
    ];
    let places = order.map(|part| text.find(part).unwrap_or_else(|| panic!("{part}: {text}")));
    assert!(places.is_sorted() && text.contains("values=\"#008080;#0000ff\""), "{text}");
}

#[test]
fn a_line_and_its_fill_fade_as_one() {
    let mut stroke = painted_square(10.0, [0.0, 1.0, 0.0]);
    stroke.as_object_mut().unwrap().extend([("track".into(), json!(0)), ("opacity".into(), json!(0.5))]);
    let (_folder, path) = project(json!({"in_betweens": [{"frame": 0, "strokes": [stroke]}]}));
    let lines = picture(&path, "lines", &[]);
    for ((x, y), expected) in [((10, 15), [255, 0, 0, 128]), ((15, 15), [0, 255, 0, 128]), ((9, 15), [255, 0, 0, 128])]
    {
        assert_eq!(lines.get_pixel(x, y).0, expected, "{x} {y}");
    }
}

#[test]
fn in_betweens_and_drawings_are_drawn_and_exported() {
    let line = |x: f64| json!([{"points": [[x, 5], [x, 25]], "closed": false, "colour": [0, 0, 1]}]);
    let drawings = json!([{"frame": 0, "strokes": line(8.0)}, {"frame": 4, "strokes": line(32.0)}]);
    let (folder, path) = project(json!({"drawings": drawings}));
    let mut document: Value = serde_json::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
    document["footage"]["last"] = json!(5);
    fs::write(&path, document.to_string()).unwrap();
    let tweened = folder.path().join("tweened.json");
    let run = |words: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_rototoon")).args(words).output().unwrap();
        assert!(output.status.success(), "{}", told(&output));
        told(&output)
    };
    run(&["tween", path.to_str().unwrap(), "-o", tweened.to_str().unwrap()]);

    let to = folder.path().join("line_%d.png");
    let said =
        run(&["render", tweened.to_str().unwrap(), "-o", to.to_str().unwrap(), "--what", "lines", "--scale", "4"]);
    assert!(said.contains("frame 5: not drawn"), "{said}");
    // The line stands at 8, 20 and 32 px.
    for (frame, x) in [(0, 8), (2, 20), (4, 32)] {
        let picture = image::open(folder.path().join(format!("line_{frame}.png"))).unwrap().to_rgba8();
        let seen: Vec<u32> = (0..160).filter(|&column| picture.get_pixel(column, 60).0[3] > 0).collect();
        let middle = f64::from(seen[0] + seen[seen.len() - 1] + 1) / 8.0;
        assert!((middle - f64::from(x)).abs() < 0.3, "{frame}: {middle}");
        assert_eq!(picture.get_pixel(4 * x, 60).0[..3], [0, 0, 255]);
    }

    let to = &folder.path().join("lines.svg");
    assert_eq!(run(&["export", tweened.to_str().unwrap(), "-o", to.to_str().unwrap()]), "", "it needs no part");
    let text = fs::read_to_string(to).unwrap();
    // It is one stroke, from the first drawing to the last.
    assert_eq!(text.matches("<path").count(), 1, "{text}");
    assert!(
        text.contains(r#"id="stroke-0""#) && text.contains("M8 5L8 25;") && text.contains(";M32 5L32 25"),
        "{text}"
    );
    run(&["export", path.to_str().unwrap(), "-o", to.to_str().unwrap()]);
    let text = fs::read_to_string(to).unwrap();
    for id in ["frame-0-stroke-0", "frame-4-stroke-0"] {
        assert!(text.contains(&format!("id=\"{id}\"")), "nothing says that these are one stroke: {id}: {text}");
    }
}

#[test]
fn forms_without_strokes_are_not_written_of_drawings() {
    let (folder, path) = project(drawn());
    let export = |name: &str| {
        let to = folder.path().join(name);
        let output =
            Command::new(env!("CARGO_BIN_EXE_rototoon")).arg("export").arg(&path).arg("-o").arg(&to).output().unwrap();
        (output.status.code(), told(&output), to.exists())
    };
    for name in ["a.nk", "a.ntp", "a.py", "a.jsx", "a.fxs", "a.setting"] {
        let (status, said, written) = export(name);
        assert!(status == Some(1) && !written && said.lines().count() == 1, "{name}: {said}");
        let what = "The document has strokes on 1 frame and painted regions on 1 frame; .svg and .json take them";
        assert!(said.contains("project.json: found no contour of a part") && said.contains(what), "{said}");
    }
    assert_eq!((export("a.svg").0, export("a.json").0), (Some(0), Some(0)));
}

#[test]
fn a_sheet_shows_strokes_and_paint() {
    let (folder, path) = project(drawn());
    let to = folder.path().join("sheet.png");
    let output =
        Command::new(env!("CARGO_BIN_EXE_rototoon")).arg("sheet").arg(&path).arg("-o").arg(&to).output().unwrap();
    assert!(output.status.success() && told(&output).is_empty(), "{}", told(&output));
    let sheet = image::open(to).unwrap().to_rgb8();
    // A picture begins 4 px from the sheet's edge, behind a border of 5 px and below a strip of 21 px.
    assert_eq!(sheet.get_pixel(9 + 15, 30 + 8).0, [255, 0, 0]);
    let line = sheet.get_pixel(9 + 33, 30 + 15).0;
    assert!(line.iter().any(|value| *value < 200), "{line:?}");
    assert_eq!(sheet.get_pixel(9 + 33, 30 + 25).0, [255; 3]);
}

/// The value behind an attribute of an OpenEXR file: its name, type and size as in the file.
fn attribute<'a>(bytes: &'a mut [u8], name: &[u8]) -> Option<&'a mut [u8]> {
    let at = bytes.windows(name.len()).position(|own| own == name)? + name.len();
    Some(&mut bytes[at..])
}

const ASPECT: &[u8] = b"pixelAspectRatio\0float\0\x04\0\0\0";

/// Writes a white frame of this pixel aspect.
fn plate(path: &Path, aspect: f32) {
    ImageBuffer::from_pixel(40, 30, Rgb([1f32; 3])).save(path).unwrap();
    let mut bytes = fs::read(path).unwrap();
    attribute(&mut bytes, ASPECT).unwrap()[..4].copy_from_slice(&aspect.to_le_bytes());
    fs::write(path, bytes).unwrap();
}

/// The pixel aspect of an OpenEXR file.
fn aspect(path: &Path) -> f32 {
    let mut bytes = fs::read(path).unwrap();
    f32::from_le_bytes(attribute(&mut bytes, ASPECT).unwrap()[..4].try_into().unwrap())
}

/// A part that is keyed on both frames.
fn coat() -> Value {
    let keys = json!({"0": [[5, 5], [30, 5], [30, 20]], "1": [[6, 5], [31, 5], [31, 20]]});
    json!({"parts": [{"name": "coat", "closed": true, "keys": keys}]})
}

#[test]
fn pictures_have_the_pixel_aspect_of_the_footage() {
    let (folder, path) = project(drawn());
    let text = fs::read_to_string(&path).unwrap().replace("f_%d.png", "f_%d.exr");
    fs::write(&path, text).unwrap();
    (0..2).for_each(|frame| plate(&folder.path().join(format!("f_{frame}.exr")), 2.0));
    for what in ["cutout", "matte", "ids", "paint", "overlay"] {
        let to = folder.path().join(format!("{what}.exr"));
        let output = render(&path, &to, &["--what", what, "--frames", "1"]);
        assert!(output.status.success(), "{}", told(&output));
        assert_eq!(aspect(&to), 2.0, "{what}");
        let bytes = fs::read(to).unwrap();
        let told = |text: &[u8]| bytes.windows(text.len()).any(|own| own == text);
        assert!(told(b"chromaticities\0chromaticities\0\x20\0\0\0") && told(b"framesPerSecond\0rational\0\x08\0\0\0"));
    }
}

#[test]
fn a_frame_without_a_file_has_the_pixel_aspect_of_the_footage() {
    let (folder, path) = project(coat());
    let text = fs::read_to_string(&path).unwrap().replace("f_%d.png", "f_%d.exr");
    fs::write(&path, text).unwrap();
    plate(&folder.path().join("f_1.exr"), 2.0);
    for frames in ["0-1", "0"] {
        let to = folder.path().join("m_%d.exr");
        let output = render(&path, &to, &["--what", "matte", "--frames", frames]);
        assert!(output.status.success(), "{}", told(&output));
        assert_eq!(aspect(&folder.path().join("m_0.exr")), 2.0, "{frames}");
    }
    let to = folder.path().join("shapes.nk");
    let output =
        Command::new(env!("CARGO_BIN_EXE_rototoon")).arg("export").arg(&path).arg("-o").arg(&to).output().unwrap();
    assert!(output.status.success(), "{}", told(&output));
    assert!(fs::read_to_string(to).unwrap().contains("format \"40 30 0 0 40 30 2 \""));
}

#[test]
fn a_batch_exports_again_if_the_pixels_have_another_shape() {
    let (folder, path) = project(coat());
    let text = fs::read_to_string(&path).unwrap().replace("f_%d.png", "f_%d.exr");
    fs::write(&path, text).unwrap();
    let manifest = folder.path().join("night.json");
    let shots = json!([{"name": "s", "project": "project.json"}]);
    let steps = json!([{"do": "export", "to": "a.nk"}]);
    fs::write(&manifest, json!({"rototoon_batch": 1, "steps": steps, "shots": shots}).to_string()).unwrap();
    let results = folder.path().join("results");
    for aspect in [1, 2] {
        plate(&folder.path().join("f_0.exr"), aspect as f32);
        let output = Command::new(env!("CARGO_BIN_EXE_rototoon"))
            .arg("batch")
            .arg(&manifest)
            .arg("-o")
            .arg(&results)
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", told(&output));
        let text = fs::read_to_string(results.join("s/a.nk")).unwrap();
        assert!(text.contains(&format!("format \"40 30 0 0 40 30 {aspect} \"")), "{aspect}: {text}");
    }
}

#[test]
fn an_svg_has_the_mean_width_of_each_frame_and_says_so() {
    let stroke = |track: usize, widths: [f64; 2]| json!({"track": track, "points": [[5, 15], [35, 15]], "closed": false, "widths": widths, "colour": [0, 0, 0]});
    let traced = |first: Value, second: Value| json!({"traced": [{"frame": 0, "strokes": [first]}, {"frame": 1, "strokes": [second]}]});
    let export = |fields: Value| {
        let (folder, path) = project(fields);
        let to = folder.path().join("a.svg");
        let output =
            Command::new(env!("CARGO_BIN_EXE_rototoon")).arg("export").arg(path).arg("-o").arg(&to).output().unwrap();
        assert!(output.status.success(), "{}", told(&output));
        (fs::read_to_string(to).unwrap(), told(&output))
    };
    let (text, said) = export(traced(stroke(4, [3.0, 3.0]), stroke(4, [1.0, 9.0])));
    assert!(text.contains("attributeName=\"stroke-width\"") && text.contains("values=\"3;5\""), "{text}");
    assert!(said.contains("a.svg: stroke 4 has a width that varies along the line"), "{said}");
    let (text, said) = export(traced(stroke(4, [3.0, 3.1]), stroke(5, [3.1, 3.0])));
    assert!(!text.contains("attributeName=\"stroke-width\"") && said.is_empty(), "{text} {said}");
}

#[test]
fn a_line_that_is_hidden_on_one_frame_is_hidden_in_the_svg_file_and_its_fill_is_not() {
    let square = json!([[2, 2], [12, 2], [12, 12], [2, 12]]);
    let lined = json!({"track": 0, "points": square, "closed": true, "widths": [4, 4, 4, 4], "colour": [0, 0, 0],
        "fill_colour": [1, 0, 0]});
    let hidden = json!({"track": 0, "points": square, "closed": true, "fill": true, "colour": [1, 0, 0]});
    for (strokes, widths) in [([&lined, &hidden], "4;0"), ([&hidden, &lined], "0;4")] {
        let frame = |k: usize| json!({"frame": k, "strokes": [strokes[k]]});
        let (_folder, path) = project(json!({"in_betweens": [frame(0), frame(1)]}));
        let to = path.with_file_name("lines.svg");
        let output =
            Command::new(env!("CARGO_BIN_EXE_rototoon")).arg("export").arg(&path).arg("-o").arg(&to).output().unwrap();
        assert!(output.status.success(), "{}", told(&output));
        let text = fs::read_to_string(&to).unwrap();
        assert!(text.contains("fill=\"#ff0000\"") && !text.contains("attributeName=\"fill\""), "{text}");
        let width = text.split("attributeName=\"stroke-width\"").nth(1).unwrap();
        assert!(width.split('>').next().unwrap().contains(&format!("values=\"{widths}\"")), "{width}");
    }
}
