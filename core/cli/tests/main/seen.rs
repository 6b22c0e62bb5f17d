//! Pictures that were drawn again after they were painted, traced and tracked.

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ImageBuffer, Rgb, RgbImage};
use serde_json::{Value, json};
use std::fs::{self, File};
use std::path::Path;
use std::process::{Command, Output};

/// A box with a disc in it.
fn picture(frame: u32, radius: f64) -> RgbImage {
    ImageBuffer::from_fn(160, 120, |x, y| {
        let (x, y) = (f64::from(x) + 0.5 - 4.0 * f64::from(frame), f64::from(y) + 0.5);
        let edge = ((x - 60.0).abs().max((y - 60.0).abs()) - 40.0).abs() < 1.5;
        let disc = ((x - 60.0).hypot(y - 60.0) - radius).abs() < 1.5;
        Rgb([if edge || disc { 20u8 } else { 250 }; 3])
    })
}

fn document() -> Value {
    let corners = |x: f64| json!([[20.0 + x, 20], [100.0 + x, 20], [100.0 + x, 100], [20.0 + x, 100]]);
    json!({
        "rototoon": 1,
        "footage": {"pattern": "f_%03d.png", "first": 0, "last": 3, "fps": 12, "width": 160, "height": 120},
        "parts": [{"name": "box", "keys": {"0": corners(0.0), "3": corners(12.0)}}],
        "fills": [{"frame": 0, "regions": [{"at": [30, 60], "colour": [0.9, 0.2, 0.1]}, {"at": [60, 60], "colour": [0.1, 0.2, 0.9]}]}],
    })
}

fn run(folder: &Path, words: &[&str]) -> String {
    let run = Command::new(env!("CARGO_BIN_EXE_rototoon")).args(words).current_dir(folder).output();
    let Output { status, stderr, .. } = run.unwrap();
    let told = String::from_utf8_lossy(&stderr).into_owned();
    assert!(status.success(), "{words:?}: {told}");
    told
}

#[test]
fn a_picture_that_was_drawn_again_is_named_wherever_its_results_are_shown() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    (0..4).for_each(|frame| picture(frame, 15.0).save(at(&format!("f_{frame:03}.png"))).unwrap());
    fs::write(at("a.json"), document().to_string()).unwrap();
    for (command, from, to) in [("fill", "a", "b"), ("trace", "b", "c"), ("track", "c", "d")] {
        run(folder.path(), &[command, &format!("{from}.json"), "-o", &format!("{to}.json")]);
    }
    let shown: [&[&str]; 7] = [
        &["check", "d.json"],
        &["render", "d.json", "-o", "r_%d.png", "--what", "painted"],
        &["render", "d.json", "-o", "r_%d.png", "--what", "lines"],
        &["render", "d.json", "-o", "r_%d.png", "--what", "matte"],
        &["sheet", "d.json", "-o", "s.png"],
        &["export", "d.json", "-o", "e.svg"],
        &["export", "d.json", "-o", "e.nk"],
    ];
    // Saved again, with the same pixels.
    let file = File::create(at("f_001.png")).unwrap();
    let encoder = PngEncoder::new_with_quality(file, CompressionType::Uncompressed, FilterType::NoFilter);
    picture(1, 15.0).write_with_encoder(encoder).unwrap();
    for words in shown {
        assert!(!run(folder.path(), words).contains("another one"), "{words:?}");
    }
    picture(2, 22.0).save(at("f_002.png")).unwrap();
    let told = |done: &str| format!("the picture of frame 2 is another one than when it was {done}");
    let expected = [(1, 1, 1), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1), (1, 1, 1), (0, 0, 1)];
    for (words, expected) in shown.iter().zip(expected) {
        let said = run(folder.path(), words);
        let found = ["painted", "traced", "tracked"].map(|done| said.matches(&told(done)).count());
        assert_eq!((found[0], found[1], found[2]), expected, "{words:?}: {said}");
    }
    let some = run(folder.path(), &["render", "d.json", "-o", "r_%d.png", "--what", "painted", "--frames", "0-1"]);
    assert!(!some.contains("another one"), "{some}");
    picture(3, 22.0).save(at("f_003.png")).unwrap();
    let said = run(folder.path(), &["sheet", "d.json", "-o", "s.png"]);
    assert!(said.contains("the pictures of frames 2-3 are other ones than when they were traced"), "{said}");
    // What is made again is of the new pictures, and no other result is.
    run(folder.path(), &["fill", "d.json", "-o", "d.json", "--frames", "2-3"]);
    let said = run(folder.path(), &["sheet", "d.json", "-o", "s.png"]);
    assert!(!said.contains("painted") && said.contains("traced") && said.contains("tracked"), "{said}");
}

#[test]
fn a_wrong_mark_is_named_with_its_document() {
    let folder = tempfile::tempdir().unwrap();
    (0..4).for_each(|frame| picture(frame, 15.0).save(folder.path().join(format!("f_{frame:03}.png"))).unwrap());
    let mut wrong = document();
    wrong["seen"] = json!({"tracks": {"0": "x"}});
    fs::write(folder.path().join("a.json"), wrong.to_string()).unwrap();
    for words in [
        &["render", "a.json", "-o", "r_%d.png", "--what", "matte"][..],
        &["sheet", "a.json", "-o", "s.png"],
        &["export", "a.json", "-o", "e.nk"],
    ] {
        let output = Command::new(env!("CARGO_BIN_EXE_rototoon")).args(words).current_dir(folder.path()).output();
        let said = String::from_utf8(output.unwrap().stderr).unwrap();
        assert!(said.contains("error: a.json: seen.tracks.\"0\": found \"x\""), "{words:?}: {said}");
    }
}
