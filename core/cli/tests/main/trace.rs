//! Tests of `rototoon trace` from the command line.

use image::{ImageBuffer, Rgb};
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A cross and a ring that move 4 px to the right on each of four frames, as footage of a document with these fields.
fn project(fields: Value) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    for frame in 0..4u32 {
        let picture = ImageBuffer::from_fn(160, 120, |x, y| {
            let (x, y) = (f64::from(x) + 0.5 - 4.0 * f64::from(frame), f64::from(y) + 0.5);
            let bar = (y - 60.0).abs() < 1.5 && (20.0..90.0).contains(&x);
            let post = (x - 50.0).abs() < 1.5 && (20.0..100.0).contains(&y);
            let ring = ((x - 110.0).hypot(y - 40.0) - 15.0).abs() < 1.5;
            Rgb([if bar || post || ring { 20u8 } else { 250 }; 3])
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

fn trace(from: &Path, to: &Path, more: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_rototoon")).arg("trace").arg(from).arg("-o").arg(to).args(more).output().unwrap()
}

fn read(path: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}

/// The numbers of the strokes on each frame, ascending.
fn numbers(document: &Value) -> Vec<(i64, Vec<u64>)> {
    let drawings = document["traced"].as_array().unwrap().iter();
    drawings
        .map(|drawing| {
            let strokes = drawing["strokes"].as_array().unwrap().iter();
            let mut numbers: Vec<u64> = strokes.map(|stroke| stroke["track"].as_u64().unwrap()).collect();
            numbers.sort_unstable();
            (drawing["frame"].as_i64().unwrap(), numbers)
        })
        .collect()
}

/// The output of `check`, without the path of the document.
fn checked(path: &Path) -> (Option<i32>, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_rototoon")).arg("check").arg(path).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    (output.status.code(), said.replace(&format!("{}: ", path.display()), ""))
}

#[test]
fn numbers_of_an_exposure_sheet_hold_the_drawing_before_them() {
    let (folder, path) = project(json!({}));
    let at = |frame: u32| folder.path().join(format!("f_{frame:03}.png"));
    [1, 3].iter().for_each(|&frame| fs::remove_file(at(frame)).unwrap());
    let out = folder.path().join("traced.json");
    let output = trace(&path, &out, &[]);
    let said = String::from_utf8_lossy(&output.stderr);
    let way_out = "if the drawing before it is held, write \"gaps\": \"held\" in the document's footage";
    assert!(!output.status.success() && said.contains("frame 1: no file") && said.contains(way_out), "{said}");
    assert!(checked(&path).1.contains(way_out));

    let mut document = read(&path);
    document["footage"]["gaps"] = json!("held");
    fs::write(&path, document.to_string()).unwrap();
    let (status, said) = checked(&path);
    assert_eq!(status, Some(0), "{said}");
    let told = "footage.gaps: 2 of 4 frames have no file and show that of the frame before: 1, 3";
    assert!(said.contains(&format!("note: {told}\n")), "{said}");
    for words in [&["--drawings", "1"][..], &[]] {
        let output = trace(&path, &out, words);
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success() && said.contains(&format!("note: {}: {told}\n", path.display())), "{said}");
    }
    let traced = read(&out);
    assert_eq!(traced["footage"]["gaps"], "held");
    let strokes = |frame: usize| &traced["traced"][frame]["strokes"];
    assert_eq!(strokes(0), strokes(1));
    assert_eq!(strokes(2), strokes(3));
    assert_ne!(strokes(1), strokes(2));

    fs::remove_file(at(0)).unwrap();
    let (status, said) = checked(&path);
    assert_eq!(status, Some(1), "{said}");
    assert!(said.contains("error: footage: frame 0: no file") && said.contains("(the same on frame 1)"), "{said}");
}

#[test]
fn three_lines_are_the_same_three_strokes_on_every_frame() {
    let (folder, path) = project(json!({}));
    let out = folder.path().join("traced.json");
    let output = trace(&path, &out, &[]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let document = read(&out);
    assert_eq!(document["note"], "kept");
    let expected: Vec<(i64, Vec<u64>)> = (0..4).map(|frame| (frame, vec![0, 1, 2])).collect();
    assert_eq!(numbers(&document), expected);
    for drawing in document["traced"].as_array().unwrap() {
        for stroke in drawing["strokes"].as_array().unwrap() {
            let count = stroke["points"].as_array().unwrap().len();
            assert_eq!(stroke["widths"].as_array().unwrap().len(), count);
            assert_eq!(stroke["colour"].as_array().unwrap().len(), 3);
        }
    }
    let again = folder.path().join("again.json");
    assert!(trace(&path, &again, &["--threads", "1"]).status.success());
    assert_eq!(fs::read(&out).unwrap(), fs::read(&again).unwrap(), "one thread gives the same bytes");
}

#[test]
fn drawn_strokes_are_kept_and_followed_both_ways() {
    let post = json!({"points": [[58, 20], [58, 100]], "closed": false});
    let drawings = json!([{"frame": 2, "strokes": [post]}]);
    let (folder, path) = project(json!({"drawings": drawings}));
    let out = folder.path().join("traced.json");
    assert!(trace(&path, &out, &[]).status.success());
    let document = read(&out);
    assert_eq!(document["drawings"], drawings);
    let own = &document["traced"][2]["strokes"];
    assert_eq!(own.as_array().unwrap().len(), 1, "the artist's frame is as it was drawn");
    assert_eq!(own[0]["points"], json!([[58.0, 20.0], [58.0, 100.0]]));
    for (frame, numbers) in numbers(&document) {
        assert_eq!(numbers[0], 0, "frame {frame}");
        let strokes = document["traced"][frame as usize]["strokes"].as_array().unwrap();
        let stroke = strokes.iter().find(|stroke| stroke["track"] == 0).unwrap();
        let middle = 50.0 + 4.0 * frame as f64;
        let far = |p: &Value| (p[0].as_f64().unwrap() - middle).abs();
        assert!(stroke["points"].as_array().unwrap().iter().all(|p| far(p) < 2.0), "frame {frame}: {stroke}");
    }
}

#[test]
fn a_range_is_traced_with_the_numbers_of_earlier_results_beside_it_which_stay() {
    let post = json!({"track": 7, "points": [[50, 20], [50, 60], [50, 100]], "closed": false});
    let earlier = json!([{"frame": 0, "strokes": [post]},
        {"frame": 2, "strokes": []}]);
    let (folder, path) = project(json!({"traced": earlier}));
    let out = folder.path().join("traced.json");
    assert!(trace(&path, &out, &["--frames", "2-3"]).status.success());
    let found = numbers(&read(&out));
    assert_eq!(found[0], (0, vec![7]));
    assert_eq!(found[1..].iter().map(|f| f.0).collect::<Vec<_>>(), [2, 3]);
    assert_eq!(found[1].1, [7, 8, 9], "the post is itself, bar and ring are new");
    assert_eq!(found[2].1, found[1].1);
}

#[test]
fn what_is_wrong_is_said_and_nothing_is_written() {
    let (folder, path) = project(json!({}));
    let out = folder.path().join("traced.json");
    let said = |more: &[&str], status: i32| {
        let output = trace(&path, &out, more);
        assert_eq!(output.status.code(), Some(status));
        assert!(!out.exists());
        String::from_utf8(output.stderr).unwrap()
    };
    assert!(said(&["--frames", "2-9"], 2).contains("--frames: found 2 to 9, expected frames of the footage, 0 to 3"));
    assert!(said(&["--style", "messy"], 2).contains("messy"));
    assert!(said(&["--sensitivity", "0"], 2).contains("expected a number from 0.1 to 10"));
    fs::remove_file(folder.path().join("f_001.png")).unwrap();
    assert!(said(&[], 1).contains("f_001.png"));
}

#[test]
fn two_drawings_bind_the_frames_between_and_stay_as_they_are() {
    // The first drawing has the bar and the ring, the last one the ring, drawn the other way, and the post.
    let ring = |middle: f64, way: f64| -> Vec<[f64; 2]> {
        let at = |k: u32| (f64::from(k) * way * std::f64::consts::TAU / 40.0).sin_cos();
        (0..40).map(|k| [middle + 15.0 * at(k).1, 40.0 + 15.0 * at(k).0]).collect()
    };
    let bar = json!({"points": [[20, 60], [90, 60]], "closed": false});
    let post = json!({"points": [[62, 20], [62, 100]], "closed": false});
    let rings = [(110.0, 1.0), (122.0, -1.0)].map(|(x, way)| json!({"points": ring(x, way), "closed": true}));
    let drawings = json!([{"frame": 0, "strokes": [bar, rings[0]]}, {"frame": 3, "strokes": [rings[1], post]}]);
    let (folder, path) = project(json!({"drawings": drawings}));
    let out = folder.path().join("traced.json");
    assert!(trace(&path, &out, &[]).status.success());
    let document = read(&out);
    let found = numbers(&document);
    // The post began behind the first drawing. It has one number from there to the second drawing.
    assert_eq!(found, [(0, vec![0, 1]), (1, vec![0, 1, 2]), (2, vec![0, 1, 2]), (3, vec![1, 2])]);
    for (frame, own) in [(0, &drawings[0]), (3, &drawings[1])] {
        let kept = document["traced"][frame]["strokes"].as_array().unwrap();
        let points = |strokes: &Value| -> Vec<Vec<[f64; 2]>> {
            let list = strokes.as_array().unwrap().iter();
            list.map(|s| serde_json::from_value(s["points"].clone()).unwrap()).collect()
        };
        let far = |(a, b): (&[f64; 2], &[f64; 2])| (a[0] - b[0]).hypot(a[1] - b[1]);
        for (a, b) in points(&own["strokes"]).iter().zip(points(&json!(kept))) {
            assert!(a.len() == b.len() && a.iter().zip(&b).all(|pair| far(pair) < 1e-3), "frame {frame}");
        }
    }
    let again = folder.path().join("again.json");
    assert!(trace(&path, &again, &["--threads", "1"]).status.success());
    assert_eq!(fs::read(&out).unwrap(), fs::read(&again).unwrap(), "one thread gives the same bytes");
}

#[test]
fn a_pupil_is_a_fill_in_the_document_and_in_svg() {
    let (folder, path) = project(json!({}));
    for frame in 0..4u32 {
        let file = folder.path().join(format!("f_{frame:03}.png"));
        let mut picture = image::open(&file).unwrap().into_rgb8();
        for (x, y, pixel) in picture.enumerate_pixels_mut() {
            let (x, y) = (f64::from(x) + 0.5 - 4.0 * f64::from(frame), f64::from(y) + 0.5);
            if (x - 112.0).hypot(y - 90.0) < 12.0 {
                *pixel = Rgb([20; 3]);
            }
        }
        picture.save(&file).unwrap();
    }
    let out = folder.path().join("traced.json");
    assert!(trace(&path, &out, &[]).status.success());
    let document = read(&out);
    assert_eq!(numbers(&document), (0..4).map(|frame| (frame, vec![0, 1, 2, 3])).collect::<Vec<_>>());
    for drawing in document["traced"].as_array().unwrap() {
        let strokes = drawing["strokes"].as_array().unwrap();
        let fills: Vec<usize> = (0..4).filter(|&k| strokes[k]["fill"] == true).collect();
        assert_eq!(fills, [0], "the fill is behind the lines");
        assert_eq!((&strokes[0]["track"], &strokes[0]["closed"]), (&json!(0), &json!(true)));
        assert!(strokes[0]["widths"].is_null());
    }
    let svg = folder.path().join("strokes.svg");
    let export =
        Command::new(env!("CARGO_BIN_EXE_rototoon")).arg("export").arg(&out).arg("-o").arg(&svg).output().unwrap();
    assert!(export.status.success(), "{}", String::from_utf8_lossy(&export.stderr));
    let text = fs::read_to_string(&svg).unwrap();
    let filled: Vec<&str> = text.lines().filter(|line| line.contains("fill=\"#")).collect();
    assert_eq!(filled.len(), 1);
    assert!(filled[0].contains("id=\"stroke-0\"") && filled[0].contains("stroke=\"none\""), "{}", filled[0]);
}

#[test]
fn keys_are_traced_and_their_in_betweens_have_widths_and_numbers() {
    let (folder, path) = project(json!({}));
    // Nothing is drawn between the keys.
    (1..3).for_each(|frame| fs::remove_file(folder.path().join(format!("f_{frame:03}.png"))).unwrap());
    let (keys, out) = (folder.path().join("keys.json"), folder.path().join("tweened.json"));
    let output = trace(&path, &keys, &["--drawings", "3,0"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let document = read(&keys);
    assert_eq!((&document["note"], document["traced"].is_null()), (&json!("kept"), true));
    let drawings = document["drawings"].as_array().unwrap();
    assert_eq!(drawings.iter().map(|own| own["frame"].as_i64().unwrap()).collect::<Vec<_>>(), [0, 3]);
    let run = |words: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_rototoon")).args(words).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    };
    run(&["tween", keys.to_str().unwrap(), "-o", out.to_str().unwrap()]);
    let tweened = read(&out);
    let numbers: Vec<u64> = serde_json::from_value(tweened["matches"][0]["tracks"][0].clone()).unwrap();
    let mut sorted = numbers.clone();
    sorted.sort_unstable();
    assert_eq!((sorted, &tweened["matches"][0]["tracks"].as_array().unwrap().len()), (vec![0, 1, 2], &2));
    // From rest to rest, 12 px in all.
    for (k, moved) in [(0, 3.1), (1, 8.9)] {
        let strokes = tweened["in_betweens"][k]["strokes"].as_array().unwrap();
        assert_eq!(strokes.len(), 3);
        for stroke in strokes {
            let widths: Vec<f64> = serde_json::from_value(stroke["widths"].clone()).unwrap();
            assert_eq!(widths.len(), stroke["points"].as_array().unwrap().len());
            let width = if stroke["closed"] == true { 3.0 } else { 2.0 };
            assert!(widths.iter().all(|found| (found - width).abs() < 0.4), "{width} px: {widths:?}");
        }
        let ring = strokes.iter().find(|stroke| stroke["closed"] == true).expect("the ring");
        let points: Vec<[f64; 2]> = serde_json::from_value(ring["points"].clone()).unwrap();
        let mean = points.iter().map(|p| p[0]).sum::<f64>() / points.len() as f64;
        assert!((mean - 110.0 - moved).abs() < 0.5, "{mean} on frame {}", k + 1);
    }
    // Pictures name a stroke alike on keys and between them.
    let names = |frame: &str| {
        let to = folder.path().join(format!("lines_{frame}.exr"));
        run(&["render", out.to_str().unwrap(), "-o", to.to_str().unwrap(), "--what", "lines", "--frames", frame]);
        let header = String::from_utf8_lossy(&fs::read(to).unwrap()).into_owned();
        (0..3).all(|k| header.contains(&format!("\"stroke {k}\":"))) && !header.contains("\"frame ")
    };
    assert!(names("0") && names("1") && names("3"));
}

#[test]
fn drawings_that_are_there_are_not_traced_over() {
    let stroke = json!({"points": [[20, 60], [90, 60]], "closed": false});
    let own = |frame: i64| json!({"frame": frame, "strokes": [stroke]});
    let fields = json!({"drawings": [own(0), own(2)], "pairs": [{"frame": 0, "from": 0, "to": 0}]});
    let (folder, path) = project(fields);
    let out = folder.path().join("keys.json");
    for (frames, code, said) in [
        ("2", 1, "drawings[1] (frame 2): found a drawing, expected none"),
        ("1", 1, "pairs[0] (frame 0): found a pair of frames 0 and 2, expected none"),
        ("3,9", 2, "--drawings: found 9, expected frames of the footage, 0 to 3"),
        ("3,x", 2, "invalid value 'x'"),
    ] {
        let output = trace(&path, &out, &["--drawings", frames]);
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(code), "{told}");
        assert!(told.contains(said) && !out.exists(), "{told}");
    }
    let blank = ImageBuffer::from_pixel(160, 120, Rgb([250u8; 3]));
    blank.save(folder.path().join("f_003.png")).unwrap();
    let output = trace(&path, &out, &["--drawings", "3"]);
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success() && told.contains("frame 3: no line was found, so its drawing is empty"), "{told}");
    let drawings = read(&out)["drawings"].clone();
    assert_eq!((&drawings[0], &drawings[2]["strokes"]), (&own(0), &json!([])));
}

#[test]
fn a_film_whose_first_frame_was_emptied_is_traced_alike_again() {
    let (folder, path) = project(json!({}));
    let [first, second, third] = ["1.json", "2.json", "3.json"].map(|name| folder.path().join(name));
    let run = |from: &Path, to: &Path| assert!(trace(from, to, &["--cache", "none"]).status.success());
    run(&path, &first);
    let mut document = read(&first);
    let drawn = |stroke: &Value| json!({"points": stroke["points"], "closed": stroke["closed"]});
    let strokes: Vec<Value> = document["traced"][2]["strokes"].as_array().unwrap().iter().map(drawn).collect();
    document["drawings"] = json!([{"frame": 0, "strokes": []}, {"frame": 2, "strokes": strokes}]);
    fs::write(&first, document.to_string()).unwrap();
    run(&first, &second);
    run(&second, &third);
    assert_eq!(read(&second)["traced"][0]["strokes"], json!([]));
    assert_eq!(read(&second), read(&third));
}
