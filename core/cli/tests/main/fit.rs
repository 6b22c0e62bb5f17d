//! Tests of `rototoon fit`.

use crate::cartoon::{command, text};
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

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
