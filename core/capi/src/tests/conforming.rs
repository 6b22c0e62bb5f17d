//! Documents that move to new footage through the ABI.

use super::{Owned, cancel, document, outcome, session, take};
use crate::callback::RototoonProgress;
use crate::session_abi::{RototoonSession, rototoon_session_new};
use crate::session_conform_abi::rototoon_session_conform;
use crate::status::RototoonStatus::{self, Cancelled, Error, Ok as Fine};
use rototoon::render::{Format, encode};
use rototoon::scene::Raster;
use serde_json::{Value, json};
use std::path::Path;
use std::ptr::{null, null_mut};

/// A ring with a wall beside it, seen at a scale and from a border away.
fn deliver(folder: &Path, name: &str, first: i32, steps: &[i32], scale: f64, border: f64) {
    for (frame, &step) in (first..).zip(steps) {
        let side = |length: f64| (length * scale + 2.0 * border) as usize;
        let picture = Raster::from_fn(side(96.0), side(64.0), |x, y| {
            let [x, y] = [x, y].map(|k| (k as f64 + 0.5 - border) / scale);
            let ring = ((x - 30.0 - 6.0 * f64::from(step)).hypot(y - 30.0) - 14.0).abs();
            let wall = if x > 2.0 && x < 94.0 { (y - 58.0).abs() } else { 99.0 };
            [if ring.min(wall) < 1.3 { 0.1 } else { 0.9 }; 3]
        });
        std::fs::write(folder.join(format!("{name}_{frame}.png")), encode::colours(&picture, Format::Png).unwrap())
            .unwrap();
    }
}

fn drawn(folder: &Path) -> Owned {
    deliver(folder, "old", 1, &[0, 1, 2, 3, 4], 1.0, 0.0);
    let key = |x: i32| json!([[x, 30], [x + 4, 30], [x, 40]]);
    let text = json!({
        "rototoon": 1,
        "footage": {"pattern": "old_%d.png", "first": 1, "last": 5, "fps": 12, "width": 96, "height": 64},
        "parts": [{"name": "ring", "keys": {"1": key(30), "5": key(54)}, "note": "kept"}],
    });
    let (text, folder) = (text.to_string(), folder.to_str().unwrap().to_owned());
    let mut session = null_mut();
    // SAFETY: pointers and lengths belong together, out parameters are locals.
    let found = outcome(|error| unsafe {
        rototoon_session_new(text.as_ptr(), text.len(), folder.as_ptr(), folder.len(), &mut session, error)
    });
    assert_eq!(found, (Fine, String::new()));
    Owned(session)
}

/// Status and the text of the report or of the error. Checks that there is a report if and only if the call succeeds.
fn conform(session: *const RototoonSession, options: &str, stop: bool) -> (RototoonStatus, String) {
    let mut report = null_mut();
    let progress: RototoonProgress = if stop { Some(cancel) } else { None };
    // SAFETY: a living session or null, a text with its length, a callback that reads nothing, a local.
    let found = outcome(|error| unsafe {
        rototoon_session_conform(session, options.as_ptr(), options.len(), progress, null_mut(), &mut report, error)
    });
    assert_eq!(report.is_null(), found.0 != Fine);
    let report = take(report);
    if found.0 == Fine { (Fine, report) } else { found }
}

#[test]
fn a_document_moves_and_the_frames_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let session = drawn(folder.path());
    // One handle, drawing 2 is gone.
    deliver(folder.path(), "new", 101, &[-2, 0, 2, 3, 4], 2.0, 8.0);
    let (status, report) = conform(session.0, r#"{"pattern": "new_%d.png", "fps": 24}"#, false);
    assert_eq!(status, Fine, "{report}");
    let report: Value = serde_json::from_str(&report).unwrap();
    assert_eq!((&report["scale"], &report["shift"]), (&json!(2.0), &json!([8.0, 8.0])));
    assert_eq!(report["went"], json!({"1": 102, "3": 103, "4": 104, "5": 105}));
    assert_eq!((&report["frames"]["101"], &report["gone"]), (&json!({"new": true}), &json!([2])));
    let found = document(&session);
    assert_eq!(found["footage"]["pattern"], "new_%d.png");
    assert_eq!((&found["footage"]["first"], &found["footage"]["fps"]), (&json!(101), &json!(24)));
    assert_eq!(found["parts"][0]["keys"]["102"], json!([[68, 68], [76, 68], [68, 88]]));
    assert_eq!(found["parts"][0]["note"], "kept");
}

#[test]
fn what_fails_or_is_cancelled_leaves_the_document_as_it_was() {
    let folder = tempfile::tempdir().unwrap();
    let session = drawn(folder.path());
    deliver(folder.path(), "new", 1, &[0, 1, 2, 3, 4], 1.0, 4.0);
    let before = document(&session);
    let asked = r#"{"pattern": "new_%d.png"}"#;
    assert_eq!(conform(session.0, asked, true), (Cancelled, "cancelled".into()));
    let (status, said) = conform(session.0, r#"{"pattern": "none_%d.png"}"#, false);
    assert_eq!((status, said.as_str()), (Error, "none_%d.png: found no file of this name"));
    assert_eq!(conform(session.0, "{}", false).0, Error);
    assert_eq!(conform(null(), asked, false).1, "session: null handle");
    assert_eq!(document(&session), before);
}

#[test]
fn an_offset_needs_no_old_pictures() {
    let folder = tempfile::tempdir().unwrap();
    deliver(folder.path(), "new", 100, &[0; 10], 1.0, 0.0);
    // The pictures of this session do not exist.
    let session = session();
    let pattern = folder.path().join("new_%d.png");
    let asked = json!({"pattern": pattern, "frame_offset": 100, "shift": [5, 0], "scale": 1}).to_string();
    let (status, said) = conform(session.0, &asked, false);
    assert_eq!(status, Fine, "{said}");
    assert_eq!(document(&session)["parts"][0]["keys"]["106"], json!([[6, 2], [8, 4], [10, 7]]));
}
