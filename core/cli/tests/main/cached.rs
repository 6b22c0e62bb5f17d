//! `track`, `trace` and `fill` with a cache: what has the same input as before comes from it, and the document is the same.

use crate::cartoon::{Cartoon, command, draw, good, read, said, square, text};
use serde_json::{Value, json};
use std::fs;
use std::path::Path;

/// The square with keys on frames 0, 3 and 6. The last key is moved by this much.
fn keyed(cartoon: &Cartoon, moved: f64) -> Value {
    let part = json!({"name": "square", "keys": {"0": square(8.0), "3": square(17.0), "6": square(26.0 + moved)}});
    let path = cartoon.document("project.json", json!([part]));
    read(&path)
}

/// Tracks with this cache. Returns the document as it was written, and what the command says of earlier spans.
fn tracked(cartoon: &Cartoon, cache: &Path) -> (String, Option<String>) {
    let (from, to) = (cartoon.path("project.json"), cartoon.path("tracked.json"));
    let said = good(&["track", text(&from), "-o", text(&to), "--cache", text(cache)]);
    let line = said.lines().find(|line| line.contains("of an earlier run")).map(str::to_owned);
    (fs::read_to_string(to).unwrap(), line)
}

#[test]
fn spans_that_are_as_before_are_not_tracked_again() {
    let cartoon = Cartoon::new();
    let cache = cartoon.path("cache");
    let both = "note: 2 of 2 spans have the keys and the pictures of an earlier run, and its tracks";
    keyed(&cartoon, 0.0);
    let (first, line) = tracked(&cartoon, &cache);
    assert_eq!(line, None);
    let (again, line) = tracked(&cartoon, &cache);
    assert_eq!((again == first, line.as_deref()), (true, Some(both)));
    keyed(&cartoon, 0.5);
    let (moved, line) = tracked(&cartoon, &cache);
    assert_eq!(line.as_deref(), Some(both.replacen('2', "1", 1).as_str()));
    let (bare, line) = tracked(&cartoon, Path::new("none"));
    assert_eq!((bare == moved, line), (true, None), "without a cache it is the same");
    // A picture is another one: the square is a pixel further.
    keyed(&cartoon, 0.0);
    draw(&cartoon.frame(5), 5, 64, 48);
    assert_eq!(tracked(&cartoon, &cache).1.as_deref(), Some(both), "it was drawn again as it was");
    fs::copy(cartoon.frame(4), cartoon.frame(5)).unwrap();
    assert_eq!(tracked(&cartoon, &cache).1.as_deref(), Some(both.replacen('2', "1", 1).as_str()));
}

#[test]
fn the_variable_names_the_folder_and_a_bad_one_does_no_harm() {
    let cartoon = Cartoon::new();
    keyed(&cartoon, 0.0);
    let run = |cache: &Path| {
        let (from, to) = (cartoon.path("project.json"), cartoon.path("tracked.json"));
        let output = command(&["track", text(&from), "-o", text(&to)]).env("ROTOTOON_CACHE", cache).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{}", said(&output));
        said(&output).contains("of an earlier run")
    };
    let cache = cartoon.path("a cache");
    assert!(!run(&cache) && run(&cache) && cache.is_dir());
    assert!(!run(&cartoon.frame(0)) && !run(&cartoon.frame(0)), "a file is no folder");
    // Every entry is damaged.
    for group in fs::read_dir(&cache).unwrap().flatten().filter(|entry| entry.path().is_dir()) {
        for entry in fs::read_dir(group.path()).unwrap().flatten() {
            let mut bytes = fs::read(entry.path()).unwrap();
            *bytes.last_mut().unwrap() ^= 1;
            fs::write(entry.path(), bytes).unwrap();
        }
    }
    assert!(!run(&cache) && run(&cache));
}

/// Runs a command on the cartoon with this cache. Returns the document as it was written, and what it says of earlier steps.
fn ran(words: &[&str], cartoon: &Cartoon, cache: &Path) -> (String, Option<String>) {
    let (from, to) = (cartoon.path("project.json"), cartoon.path("made.json"));
    let said = good(&[words, &[text(&from), "-o", text(&to), "--cache", text(cache)]].concat());
    let line = said.lines().find(|line| line.contains("of an earlier run")).map(str::to_owned);
    (fs::read_to_string(to).unwrap(), line)
}

#[test]
fn drawings_that_are_as_before_are_not_traced_and_painted_again() {
    let cartoon = Cartoon::new();
    cartoon.document("project.json", json!([]));
    let path = cartoon.path("project.json");
    let mut document = read(&path);
    document["fills"] = json!([{"frame": 0, "regions": [{"at": [3, 3], "colour": [0.5, 0.5, 1]}]}]);
    fs::write(&path, document.to_string()).unwrap();
    let traced = ["note: 7 of 7", "note: 4 of 7"]
        .map(|count| format!("{count} steps have the strokes and the pictures of an earlier run"));
    let painted =
        ["note: 18 of 18", "note: 14 of 18"].map(|count| format!("{count} steps have the pictures of an earlier run"));
    for (command, [all, some]) in [("trace", traced), ("fill", painted)] {
        let cache = cartoon.path(command);
        let run = || ran(&[command], &cartoon, &cache);
        let bare = || ran(&[command], &cartoon, Path::new("none"));
        let (first, line) = run();
        assert_eq!((&first, line), (&bare().0, None), "{command}");
        assert_eq!(run(), (first, Some(all)), "{command}");
        // A picture is another one.
        let before = fs::read(cartoon.frame(4)).unwrap();
        draw(&cartoon.frame(4), 9, 64, 48);
        let (changed, line) = run();
        assert_eq!((&changed, line), (&bare().0, Some(some)), "{command}");
        fs::write(cartoon.frame(4), before).unwrap();
    }
}
