//! Tests of export to other programs, import from them, and pictures of ids, from the command line.

use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

const WIDTH: f64 = 64.0;
const HEIGHT: f64 = 48.0;

type Keys = BTreeMap<i32, Vec<[f64; 2]>>;

/// The track of a triangle that moves unevenly on frames 2 to 6.
fn triangle() -> Keys {
    let at = |frame: i32| {
        let (x, y) = (f64::from(frame * frame) * 0.7, f64::from(frame) * 1.3);
        vec![[4.25 + x, 3.5 + y], [20.0 + x, 5.0 + y], [11.5 + x, 17.75 + y]]
    };
    // It rests on frames 4 and 5.
    (2..=6).map(|frame| (frame, at(if frame == 5 { 4 } else { frame }))).collect()
}

/// An open line with keys on the first and the last frame only.
fn line() -> Keys {
    [(0, vec![[1.0, 40.0], [30.5, 44.0]]), (8, vec![[3.0, 41.0], [33.5, 40.0]])].into()
}

/// The same on its way from key to key.
fn line_between() -> Keys {
    let (from, to) = (&line()[&0], &line()[&8]);
    let on = |frame: i32| {
        let share = f64::from(frame) / 8.0;
        let between = |k: usize, axis: usize| from[k][axis] + share * (to[k][axis] - from[k][axis]);
        vec![[between(0, 0), between(0, 1)], [between(1, 0), between(1, 1)]]
    };
    (0..=8).map(|frame| (frame, on(frame))).collect()
}

fn object(keys: &Keys) -> Value {
    Value::Object(keys.iter().map(|(frame, points)| (frame.to_string(), json!(points))).collect())
}

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn document(&self, name: &str, parts: Value) -> PathBuf {
        let footage =
            json!({"pattern": "f_%d.png", "first": 0, "last": 8, "fps": 12.5, "width": WIDTH, "height": HEIGHT});
        let path = self.path(name);
        fs::write(&path, json!({"rototoon": 1, "footage": footage, "parts": parts, "note": "kept"}).to_string())
            .unwrap();
        path
    }

    /// A document of two parts. The line is nearer than the triangle.
    fn captured(&self) -> PathBuf {
        let keys: Keys = triangle().into_iter().filter(|(frame, _)| [2, 6].contains(frame)).collect();
        self.document(
            "captured.json",
            json!([
                {"name": "near <line>", "closed": false, "depth": 2, "keys": object(&line())},
                {"name": "triangle", "closed": true, "depth": 1, "keys": object(&keys), "tracks": object(&triangle())},
            ]),
        )
    }
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

/// Runs a command that must end with this status. Returns its standard error.
fn run(arguments: &[&str], status: i32) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_rototoon")).args(arguments).output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(status), "{arguments:?}: {said}");
    said
}

/// The name, whether it is closed, and the keys of each part of a document, the farthest part first.
fn parts(path: &Path) -> Vec<(String, bool, Keys)> {
    let document: Value = serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap();
    assert_eq!(document["note"], "kept");
    let mut parts = document["parts"].as_array().unwrap().clone();
    parts.sort_by(|a, b| a["depth"].as_f64().unwrap().total_cmp(&b["depth"].as_f64().unwrap()));
    let keys = |part: &Value| {
        let keys = part["keys"].as_object().unwrap().iter();
        keys.map(|(frame, points)| (frame.parse().unwrap(), serde_json::from_value(points.clone()).unwrap())).collect()
    };
    parts.iter().map(|part| (part["name"].as_str().unwrap().into(), part["closed"] == true, keys(part))).collect()
}

fn same(found: &Keys, expected: &Keys, tolerance: f64) {
    assert_eq!(found.keys().collect::<Vec<_>>(), expected.keys().collect::<Vec<_>>());
    for (frame, points) in expected {
        assert_eq!(found[frame].len(), points.len(), "{frame}");
        for (a, b) in found[frame].iter().zip(points) {
            let off = (a[0] - b[0]).abs().max((a[1] - b[1]).abs());
            assert!(off <= tolerance, "{frame}: {a:?} {b:?}");
        }
    }
}

#[test]
fn shapes_of_silhouette_nuke_and_natron_are_the_same_after_export_and_import() {
    let folder = Folder::new();
    let (empty, out) = (folder.document("empty.json", json!([])), folder.path("o.json"));
    for name in ["a.fxs", "a.nk", "a.ntp", "a.setting"] {
        let shapes = folder.path(name);
        run(&["export", text(&folder.captured()), "-o", text(&shapes)], 0);
        assert_eq!(run(&["import", text(&empty), text(&shapes), "-o", text(&out)], 0), "");
        let found = parts(&out);
        assert_eq!(
            found.iter().map(|part| (part.0.as_str(), part.1)).collect::<Vec<_>>(),
            // Tools of Fusion have letters, digits and underscores in their names.
            [("triangle", true), (if name == "a.setting" { "near__line_" } else { "near <line>" }, false)]
        );
        same(&found[0].2, &triangle(), 1e-4);
        same(&found[1].2, &line(), 1e-4);
        let said = run(&["check", text(&out)], 1);
        assert!(said.matches("no file").count() == 1 && said.contains("the same on the next 8 frames"), "{said}");
    }
}

#[test]
fn svg_shapes_are_the_same_after_export_and_import() {
    let folder = Folder::new();
    let (shapes, empty, out) = (folder.path("a.svg"), folder.document("empty.json", json!([])), folder.path("o.json"));
    let captured = folder.captured();
    // Half a unit of the last decimal place in the SVG.
    let tolerance = 0.005 + 1e-9;
    run(&["export", text(&captured), "-o", text(&shapes)], 0);
    run(&["import", text(&empty), text(&shapes), "-o", text(&out)], 0);
    let found = parts(&out);
    assert_eq!((found[0].0.as_str(), found[1].0.as_str()), ("triangle", "near <line>"));
    assert_eq!((found[0].1, found[1].1), (true, false));
    same(&found[0].2, &triangle(), tolerance);
    same(&found[1].2, &line(), tolerance);
    run(&["export", text(&captured), "-o", text(&shapes), "--motion", "linear"], 0);
    run(&["import", text(&empty), text(&shapes), "-o", text(&out)], 0);
    same(&parts(&out)[0].2, &triangle(), tolerance);
}

#[test]
fn svg_of_a_pattern_is_a_file_for_each_frame() {
    let folder = Folder::new();
    let captured = folder.captured();
    let pattern = folder.path("f_%04d.svg");
    run(&["export", text(&captured), "-o", text(&pattern), "--frames", "3-6", "--frame-offset", "1000"], 0);
    let (empty, out) = (folder.document("empty.json", json!([])), folder.path("o.json"));
    for frame in 3..=6 {
        let file = folder.path(&format!("f_{:04}.svg", frame + 1000));
        assert!(!fs::read_to_string(&file).unwrap().contains("<animate"), "a picture stands still");
        run(&["import", text(&empty), text(&file), "-o", text(&out), "--frame", &frame.to_string()], 0);
        let found = parts(&out);
        let keys = found.iter().find(|part| part.0 == "triangle").unwrap();
        same(&keys.2, &[(frame, triangle()[&frame].clone())].into(), 0.005 + 1e-9);
    }
    let files = fs::read_dir(folder.path("")).unwrap().filter_map(|file| file.unwrap().file_name().into_string().ok());
    assert_eq!(files.filter(|name| name.ends_with(".svg")).count(), 4);
    let said = run(&["export", text(&captured), "-o", text(&folder.path("f_%04d.nk"))], 2);
    assert!(said.contains("a .nk file holds all frames"), "{said}");
}

#[test]
fn a_file_for_each_frame_lies_on_its_own_frame_and_may_be_empty() {
    let folder = Folder::new();
    let (captured, out) = (folder.captured(), folder.path("o.json"));
    let file = |frame: i32| folder.path(&format!("f_{frame:04}.svg"));
    let pattern = folder.path("f_%04d.svg");
    let export = ["export", text(&captured), "-o", text(&pattern), "--parts", "triangle"];
    run(&export, 0);
    let (empty, third) = (fs::read_to_string(file(0)).unwrap(), fs::read_to_string(file(3)).unwrap());
    assert!(!empty.contains("<path") && third.contains("<path"), "the triangle is there from frame 2 on");
    let said = run(&["import", text(&captured), text(&pattern), "-o", text(&out)], 0);
    assert!(said.contains("as before \"triangle\""), "{said}");
    // A drawing that is held on the next frame too.
    fs::copy(file(3), file(4)).unwrap();
    let said = run(&["import", text(&captured), text(&pattern), "-o", text(&out)], 0);
    assert!(said.contains("changed \"triangle\" on 4"), "{said}");
    same(&[(4, parts(&out)[0].2[&4].clone())].into(), &[(4, triangle()[&3].clone())].into(), 0.005 + 1e-9);
    let said = run(&["import", text(&captured), text(&file(3)), "-o", text(&out), "--frame", "5"], 0);
    assert!(said.contains("changed \"triangle\" on 5"), "{said}");
    let film = folder.path("film.svg");
    run(&["export", text(&captured), "-o", text(&film)], 0);
    let said = run(&["import", text(&captured), text(&film), "-o", text(&out), "--frame", "5"], 1);
    assert!(said.contains("found the frames 0 to 8, expected one frame for frame 5"), "{said}");
    for frame in 0..=8 {
        fs::write(file(frame), &empty).unwrap();
    }
    assert!(run(&["import", text(&captured), text(&pattern), "-o", text(&out)], 1).contains("found no shape"));
}

#[test]
fn a_range_with_a_part_that_comes_within_it_changes_no_other_frame() {
    let folder = Folder::new();
    let (captured, out) = (folder.captured(), folder.path("o.json"));
    let mut document: Value = serde_json::from_str(&fs::read_to_string(&captured).unwrap()).unwrap();
    let part = &mut document["parts"][1];
    part["keys"]["2"] = part["tracks"]["2"].clone();
    part["absent"] = json!([[3, 4]]);
    for frame in ["3", "4"] {
        part["tracks"].as_object_mut().unwrap().remove(frame);
    }
    fs::write(&captured, document.to_string()).unwrap();
    for extension in ["nk", "ntp", "fxs", "setting", "svg"] {
        let shapes = folder.path(&format!("a.{extension}"));
        run(&["export", text(&captured), "-o", text(&shapes), "--frames", "4-5", "--parts", "triangle"], 0);
        let said = run(&["import", text(&captured), text(&shapes), "-o", text(&out)], 0);
        assert!(said.contains("as before \"triangle\""), "{extension}: {said}");
        let after: Value = serde_json::from_str(&fs::read_to_string(&out).unwrap()).unwrap();
        assert_eq!(after["parts"][1]["absent"], json!([[3, 4]]), "{extension}");
        assert_eq!(parts(&out)[0].2, parts(&captured)[0].2, "{extension}");
    }
}

#[test]
fn a_shape_changes_the_part_of_its_name() {
    let folder = Folder::new();
    let (shapes, captured) = (folder.path("a.svg"), folder.captured());
    let still = "<path id=\"triangle\" d=\"M1 2h8v9h-8z\"/><path id=\"new\" d=\"M1 2h8\"/>";
    fs::write(&shapes, format!("<svg viewBox=\"0 0 32 24\">{still}\n<text>x</text></svg>")).unwrap();
    let said = run(&["import", text(&captured), text(&shapes), "-o", text(&captured), "--frame", "3"], 0);
    assert!(said.starts_with("warning: ") && said.contains("a.svg: line 2, column 1: <text> has no outline"), "{said}");
    let found = parts(&captured);
    assert_eq!(found.iter().map(|part| part.0.as_str()).collect::<Vec<_>>(), ["triangle", "near <line>", "new"]);
    // It is a drawing of one frame, so the part keeps the others, and its three points lie on the four sides.
    assert_eq!(found[0].2.keys().collect::<Vec<_>>(), [&2, &3, &6]);
    let document: Value = serde_json::from_str(&fs::read_to_string(&captured).unwrap()).unwrap();
    let (part, key) = (&document["parts"][1], &found[0].2[&3]);
    let track: Vec<[f64; 2]> = serde_json::from_value(part["tracks"]["3"].clone()).unwrap();
    assert_eq!((key.len(), key[0], &track), (3, [2.0, 4.0], key));
    let paths: Vec<Vec<[f64; 2]>> = serde_json::from_value(part["curves"]["3"].clone()).unwrap();
    let corners = [[2.0, 4.0], [18.0, 4.0], [18.0, 22.0], [2.0, 22.0]];
    assert!(paths.len() == 3 && corners.iter().all(|corner| paths.concat().contains(corner)), "{paths:?}");
    let told = r#"a.svg: changed "triangle" on 3; new "new"; the file says nothing of the frames 2, 4-6 of "triangle""#;
    assert!(said.contains(told), "{said}");
}

#[test]
fn import_errors_are_named_and_nothing_is_written() {
    let folder = Folder::new();
    let (captured, out) = (folder.captured(), folder.path("o.json"));
    let file = |name: &str, content: &str| {
        let path = folder.path(name);
        fs::write(&path, content).unwrap();
        path
    };
    let bad = file("bad.svg", "<svg>\n <path d=\"M0 0Lx\"/></svg>");
    let key = "<Key frame=\"9\"><Path><Point>(0,0)</Point></Path></Key>";
    let late = file(
        "late.fxs",
        &format!("<Silhouette>\n<Object type=\"Shape\"><Property id=\"path\">{key}</Property></Object></Silhouette>"),
    );
    for (path, status, message) in [
        (bad, 1, "bad.svg: line 2, column 2: <path>: d: found \"M0 0Lx\", expected path data"),
        (
            late,
            1,
            "late.fxs: line 2, column 42: <Key>: found a key on frame 9, expected a frame of the footage, 0 to 8",
        ),
        (file("cut.fxs", "<Silhouette><Object"), 1, "cut.fxs: found text that is not XML, expected XML: "),
        (file("none.svg", "<svg/>"), 1, "none.svg: found no shape, expected a path"),
        (file("a.nk", "RotoPaint {}"), 1, "a.nk: found no shape, expected a curvegroup of a Roto or RotoPaint node"),
        (
            file("a.nk.txt", "RotoPaint {}"),
            2,
            "a.nk.txt: expected a name that ends in .nk, .ntp, .fxs, .setting, .comp or .svg",
        ),
        (folder.path("gone.svg"), 1, "gone.svg: cannot read the shapes: "),
    ] {
        let said = run(&["import", text(&captured), text(&path), "-o", text(&out)], status);
        assert!(said.starts_with("error: ") && said.contains(message) && said.lines().count() == 1, "{said}");
    }
    let good = file("good.svg", "<svg><path d=\"M0 0h9\"/></svg>");
    assert!(run(&["import", text(&captured), text(&good), "-o", text(&out), "--frame", "9"], 2).contains("0 to 8"));
    assert!(!out.exists());
}

/// A word, or a list in braces.
#[derive(Debug)]
enum Item {
    Word(String),
    List(Vec<Item>),
}

/// The items of a Nuke script up to a closing brace or the end.
fn items(rest: &mut std::iter::Peekable<std::str::Chars>) -> Vec<Item> {
    let mut found = Vec::new();
    while let Some(c) = rest.next() {
        match c {
            '{' => found.push(Item::List(items(rest))),
            '}' => return found,
            '"' => found.push(Item::Word(rest.by_ref().take_while(|c| *c != '"').collect())),
            c if c.is_whitespace() => {}
            c => {
                let mut word = String::from(c);
                while let Some(c) = rest.next_if(|c| !c.is_whitespace() && *c != '{' && *c != '}') {
                    word.push(c);
                }
                found.push(Item::Word(word));
            }
        }
    }
    found
}

impl Item {
    fn list(&self) -> &[Item] {
        let Self::List(list) = self else { panic!("{self:?} is no list") };
        list
    }

    fn word(&self) -> &str {
        let Self::Word(word) = self else { panic!("{self:?} is no word") };
        word
    }

    fn number(&self) -> f64 {
        let word = self.word();
        word.strip_prefix('x')
            .map_or_else(|| word.parse().unwrap(), |bits| f32::from_bits(u32::from_str_radix(bits, 16).unwrap()).into())
    }

    /// The value on a frame: a number, or a curve that must have a key there.
    fn on(&self, frame: i32) -> f64 {
        let Self::List(keys) = self else { return self.number() };
        let mut keys = keys.iter().map(Item::list);
        keys.find(|key| key[0].number() == f64::from(frame)).unwrap()[1].number()
    }
}

/// Finds the lists with this first word, at any depth.
fn named<'a>(items: &'a [Item], name: &str, found: &mut Vec<&'a [Item]>) {
    for item in items {
        if let Item::List(list) = item {
            if matches!(list.first(), Some(Item::Word(word)) if word == name) {
                found.push(list);
            }
            named(list, name, found);
        }
    }
}

#[test]
fn the_nuke_node_has_every_key() {
    let folder = Folder::new();
    let script = folder.path("a.nk");
    run(&["export", text(&folder.captured()), "-o", text(&script)], 0);
    let script = fs::read_to_string(script).unwrap();
    let items = items(&mut script.chars().peekable());
    let mut groups = Vec::new();
    named(&items, "curvegroup", &mut groups);
    let expected = [("near <line>", 8224.0, line()), ("triangle", 8192.0, triangle())];
    assert_eq!(groups.len(), 2);
    for (group, (name, flags, keys)) in groups.into_iter().zip(expected) {
        assert_eq!(group[1].word(), name);
        let (mut points, mut flag) = (Vec::new(), Vec::new());
        named(group, "p", &mut points);
        named(group, "f", &mut flag);
        assert_eq!(flag[0][1].number(), flags);
        let points: Vec<_> = points[0][1..].iter().map(Item::list).collect();
        for (frame, contour) in keys {
            assert_eq!(points.len(), 3 * contour.len());
            for (triple, p) in points.chunks(3).zip(contour) {
                let [before, own, after] = triple else { unreachable!() };
                assert!(before.iter().chain(*after).all(|handle| handle.number() == 0.0));
                let (x, y) = (own[0].on(frame), HEIGHT - own[1].on(frame));
                assert!((x - p[0]).abs() < 1e-5 && (y - p[1]).abs() < 1e-5, "{name} {frame}: {x} {y} {p:?}");
            }
        }
    }
}

#[test]
fn pictures_of_ids_and_layers_are_written() {
    let folder = Folder::new();
    let captured = folder.captured();
    let file = |name: &str| folder.path(name);
    for name in ["a.exr", "b.exr", "a.png"] {
        run(&["render", text(&captured), "-o", text(&file(name)), "--frames", "3", "--what", "ids"], 0);
    }
    let ids = fs::read(file("a.exr")).unwrap();
    assert_eq!(ids, fs::read(file("b.exr")).unwrap());
    let holds = |bytes: &[u8], text: &str| bytes.windows(text.len()).any(|window| window == text.as_bytes());
    for text in ["CryptoObject02.A", "MurmurHash3_32", "uint32_to_float32", "{\"triangle\":\""] {
        assert!(holds(&ids, text), "{text}");
    }
    assert_eq!(image::open(file("a.png")).unwrap().to_rgba8().dimensions(), (64, 48));
    let matte = |name: &str, options: &[&str], status: i32| {
        let (output, path) = (file(name), text(&captured).to_owned());
        let words = ["render", &path, "-o", text(&output), "--frames", "3", "--what", "matte"];
        run(&[&words, options].concat(), status)
    };
    matte("layers.exr", &["--layers", "on"], 0);
    matte("parts.exr", &["--multipart", "on"], 0);
    matte("plain.exr", &[], 0);
    assert!(holds(&fs::read(file("layers.exr")).unwrap(), "triangle.A"));
    assert!(holds(&fs::read(file("parts.exr")).unwrap(), "name\0string\0\u{8}\0\0\0triangle"));
    let files = ["layers.exr", "parts.exr", "plain.exr"];
    let [layers, parts, plain] = files.map(|name| image::open(file(name)).unwrap().to_rgba32f());
    assert!(layers == plain && parts == plain);
    assert!(matte("a.png", &["--layers", "on"], 2).contains("expected a name that ends in .exr for layers"));
    assert!(matte("c.png", &["--multipart", "on"], 2).contains("expected a name that ends in .exr for several parts"));
    let both = matte("both.exr", &["--layers", "on", "--multipart", "on"], 2);
    assert!(both.contains("expected one of them") && !file("both.exr").exists() && !file("c.png").exists());
}

#[test]
fn options_that_would_change_nothing_are_refused() {
    let folder = Folder::new();
    let captured = folder.captured();
    for (command, name, options) in [
        ("render", "a.exr", &["--what", "cutout", "--layers", "on"][..]),
        ("render", "a.exr", &["--what", "ids", "--multipart", "on"]),
        ("render", "a.exr", &["--what", "ids", "--line-width", "4"]),
        ("render", "a.exr", &["--what", "matte", "--points", "off"]),
        ("export", "a.nk", &["--motion", "linear"]),
        ("export", "a.json", &["--spacing", "3"]),
        ("export", "a.json", &["--bezier", "0.5"]),
    ] {
        let to = folder.path(name);
        let frames: &[&str] = if command == "render" { &["--frames", "3"] } else { &[] };
        let said = run(&[&[command, text(&captured), "-o", text(&to)], frames, options].concat(), 2);
        let (option, value) = (options[options.len() - 2], options[options.len() - 1]);
        let told = format!("found {option} {value}: expected no such option ");
        assert!(said.contains(&told) && !to.exists(), "{said}");
    }
    let both = ["--bezier", "0.5", "--spacing", "3"];
    let said = run(&[&["export", text(&captured), "-o", text(&folder.path("a.nk"))], &both[..]].concat(), 2);
    assert!(said.contains("--bezier") && said.contains("--spacing"), "{said}");
    // Their usual values say nothing.
    run(&["export", text(&captured), "-o", text(&folder.path("a.nk")), "--motion", "hold"], 0);
}

#[test]
fn the_shapes_for_after_effects_are_json_with_every_key() {
    let folder = Folder::new();
    let (from, to) = (folder.captured(), folder.path("shapes.jsx"));
    run(&["export", text(&from), "-o", text(&to)], 0);
    let script = fs::read_to_string(&to).unwrap();
    let shapes = script.split_once("var ROTOTOON = ").unwrap().1.split_once(";\n\nfunction").unwrap().0;
    let shapes: Value = serde_json::from_str(shapes).unwrap();
    assert_eq!((&shapes["width"], &shapes["height"], &shapes["frames"]), (&json!(64), &json!(48), &json!(9)));
    assert_eq!(shapes["fps"], json!(12.5));
    let read = |part: &Value| -> (String, bool, Keys) {
        let frame = |entry: &Value| {
            let numbers: Vec<f64> = serde_json::from_value(entry[1].clone()).unwrap();
            (entry[0].as_i64().unwrap() as i32, numbers.chunks(2).map(|p| [p[0], p[1]]).collect())
        };
        let frames = part["frames"].as_array().unwrap().iter().map(frame).collect();
        (part["name"].as_str().unwrap().into(), part["closed"].as_bool().unwrap(), frames)
    };
    let found: Vec<_> = shapes["parts"].as_array().unwrap().iter().map(read).collect();
    assert_eq!(found.len(), 2);
    for ((name, closed, keys), (wanted, is_closed, expected)) in
        found.iter().zip([("near <line>", false, line_between()), ("triangle", true, triangle())])
    {
        assert_eq!((name.as_str(), *closed), (wanted, is_closed));
        same(keys, &expected, 1e-4);
    }
}
