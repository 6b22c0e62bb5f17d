//! Tests of `conform`: footage that is delivered again.

use crate::cartoon::{Cartoon, bad, draw, good, read, text};
use serde_json::json;
use std::collections::BTreeMap;
use std::fs;

/// The cartoon again at its own size from frame 101 on, without its frame 2, in a folder of its own.
fn delivered(cartoon: &Cartoon) -> String {
    let folder = cartoon.path("again");
    fs::create_dir(&folder).unwrap();
    for (new, old) in (101..).zip([0, 1, 3, 4, 5, 6]) {
        fs::copy(cartoon.frame(old), folder.join(format!("new_{new:04}.png"))).unwrap();
    }
    text(&folder.join("new_%04d.png")).to_owned()
}

#[test]
fn a_document_moves_to_footage_that_is_delivered_again() {
    let cartoon = Cartoon::new();
    let document = cartoon.keyed();
    let before = fs::read(&document).unwrap();
    let pattern = delivered(&cartoon);
    let (out, report) = (cartoon.path("moved.json"), cartoon.path("report.json"));
    let said = good(&["conform", text(&document), "--footage", &pattern, "-o", text(&out), "--report", text(&report)]);
    for expected in ["the pictures lie on each other", "6 of 6 frames show", "gone from the old footage: 2"] {
        assert!(said.contains(expected), "{said}");
    }
    let moved = read(&out);
    assert_eq!(moved["footage"]["pattern"], json!(pattern), "a complete path stays");
    assert_eq!((&moved["footage"]["first"], &moved["footage"]["last"]), (&json!(101), &json!(106)));
    let keys = |document: &serde_json::Value| -> BTreeMap<String, Vec<[f64; 2]>> {
        serde_json::from_value(document["parts"][0]["keys"].clone()).unwrap()
    };
    let (old, new) = (keys(&read(&document)), keys(&moved));
    assert_eq!(new.keys().collect::<Vec<_>>(), ["101", "106"]);
    assert_eq!((&new["101"], &new["106"]), (&old["0"], &old["6"]));
    let report = read(&report);
    assert_eq!((&report["frames"]["103"], &report["gone"]), (&json!({"same": 3}), &json!([2])));
    assert_eq!(fs::read(&document).unwrap(), before);
    good(&["check", text(&out)]);
}

#[test]
fn what_does_not_fit_is_refused_before_anything_is_written() {
    let cartoon = Cartoon::new();
    let document = cartoon.keyed();
    let out = cartoon.path("moved.json");
    let words = |pattern: &str| ["conform", text(&document), "-o", text(&out), "--footage", pattern].map(str::to_owned);
    let refused = |pattern: &str, more: &[&str], status| {
        let words = words(pattern);
        let said = bad(&[&words.each_ref().map(String::as_str)[..], more].concat(), status);
        assert!(!out.exists(), "{said}");
        said
    };
    assert!(refused("none_%04d.png", &[], 2).contains("none_%04d.png: found no file of this name"));
    assert!(refused("none.png", &[], 1).contains("has no frame number"));
    let pattern = delivered(&cartoon);
    assert!(refused(&pattern, &["--shift", "1"], 2).contains("expected two numbers X,Y"));
    let other = cartoon.path("again/new_0101.png");
    draw(&other, 3, 40, 30);
    let said = refused(&pattern, &[], 1);
    assert!(said.contains("but the footage is 40x30"), "{said}");
    draw(&other, 3, 64, 48);
    let later = cartoon.path("again/new_0103.png");
    fs::write(&later, "no picture").unwrap();
    let said = refused(&pattern, &[], 1);
    assert!(said.contains("new footage: frame 103: cannot read") && !said.contains("--frame-offset"), "{said}");
    draw(&later, 3, 64, 48);
    fs::write(cartoon.frame(3), "no picture").unwrap();
    let said = refused(&pattern, &[], 1);
    assert!(said.contains("old footage: frame 3: cannot read") && said.contains("--frame-offset"), "{said}");
    let begin = format!("error: {}: ", text(&document));
    assert!(said.lines().all(|line| line.starts_with(&begin)), "{said}");
}
