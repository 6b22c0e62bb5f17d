//! Tests of the library of clips: what is there is replaced on request only.

use super::{Fine, outcome, take};
use crate::status::RototoonStatus::{self, Error};
use crate::style_abi::{rototoon_library_add, rototoon_library_add_files, rototoon_library_find};
use serde_json::{Value, json};
use std::path::Path;
use std::ptr::null_mut;

/// A file with a clip of some frames.
fn walk(frames: usize) -> Value {
    let clip = json!({"character": "Ann", "motion": "walk", "points": vec![vec![[1.5, 2.0]; 17]; frames]});
    json!({"rototoon_clips": 1, "fps": 12, "clips": [clip]})
}

fn add(folder: &Path, clips: &str) -> (RototoonStatus, String) {
    let (folder, source) = (folder.to_str().unwrap(), "shot 1");
    // SAFETY: texts with their lengths.
    outcome(|error| unsafe {
        rototoon_library_add(
            folder.as_ptr(),
            folder.len(),
            clips.as_ptr(),
            clips.len(),
            source.as_ptr(),
            source.len(),
            error,
        )
    })
}

fn add_files(folder: &Path, files: &Value, options: &str) -> ((RototoonStatus, String), String) {
    let (folder, files, mut added) = (folder.to_str().unwrap(), files.to_string(), null_mut());
    // SAFETY: texts with their lengths, and a local.
    let found = outcome(|error| unsafe {
        rototoon_library_add_files(
            folder.as_ptr(),
            folder.len(),
            files.as_ptr(),
            files.len(),
            options.as_ptr(),
            options.len(),
            &mut added,
            error,
        )
    });
    (found, take(added))
}

/// Frames and source of each clip of a library.
fn entries(folder: &Path) -> Vec<(u64, String)> {
    let (folder, wanted, mut found) = (folder.to_str().unwrap(), "{}", null_mut());
    // SAFETY: texts with their lengths, and a local.
    let status = outcome(|error| unsafe {
        rototoon_library_find(folder.as_ptr(), folder.len(), wanted.as_ptr(), wanted.len(), &mut found, error)
    });
    assert_eq!(status, (Fine, String::new()));
    let found: Value = serde_json::from_str(&take(found)).unwrap();
    let entry = |e: &Value| (e["frames"].as_u64().unwrap(), e["source"].as_str().unwrap().to_owned());
    found["entries"].as_array().unwrap().iter().map(entry).collect()
}

#[test]
fn clips_of_a_library_are_replaced_on_request_only() {
    let folder = tempfile::tempdir().unwrap();
    let shelf = folder.path().join("shelf");
    assert_eq!(add(&shelf, &walk(2).to_string()), (Fine, String::new()));
    let (status, said) = add(&shelf, &walk(3).to_string());
    let expected = format!(
        "{}: found \"walk\" by \"Ann\" already (ann-walk.clip.json, 2 frames, from \"shot 1\"), expected another \
         character or motion, or \"replace\"",
        shelf.display()
    );
    assert_eq!((status, said.as_str()), (Error, expected.as_str()));
    let mut other = walk(1);
    other["clips"][0]["character"] = json!("Bo");
    let files = json!([{"clips": other}, {"clips": walk(3), "source": "shot 2"}]);
    for options in ["", "{}", r#"{"replace": false}"#] {
        assert_eq!(add_files(&shelf, &files, options), ((Error, expected.clone()), String::new()), "{options}");
    }
    assert_eq!(entries(&shelf), [(2, "shot 1".to_owned())], "nothing is added");
    let (status, added) = add_files(&shelf, &files, r#"{"replace": true}"#);
    assert_eq!(status, (Fine, String::new()));
    let added: Value = serde_json::from_str(&added).unwrap();
    assert_eq!((&added["replaced"][0]["source"], &added["replaced"][1]), (&json!("shot 1"), &Value::Null));
    assert_eq!((added["aside"].is_null(), entries(&shelf)), (true, vec![(3, "shot 2".into()), (1, String::new())]));
}

#[test]
fn what_is_wrong_with_files_of_clips_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let said = |files: Value, options: &str| add_files(folder.path(), &files, options).0.1;
    let mut short = walk(1);
    short["clips"][0]["points"][0].as_array_mut().unwrap().pop();
    assert!(said(json!([{"clips": walk(1)}, {"clips": short}]), "").starts_with("files[1].clips: clips[0]"));
    assert!(said(json!([{"clip": walk(1)}]), "").starts_with("files: unknown field `clip`"));
    assert!(said(json!([]), r#"{"repalce": true}"#).starts_with("options: unknown field `repalce`"));
    assert!(
        said(json!([{"clips": walk(1)}, {"clips": walk(2)}]), "").starts_with("found two clips \"walk\" by \"Ann\"")
    );
    assert!(entries(folder.path()).is_empty());
}
