//! Painting line drawings through the ABI.

use super::{cancel, document, open, outcome, session, take};
use crate::entry::MAX_BYTES;
use crate::filled_abi::{
    rototoon_filled_free, rototoon_filled_names, rototoon_filled_read, rototoon_session_fill, rototoon_session_filled,
    rototoon_session_fills, rototoon_session_recolours, rototoon_session_set_fills, rototoon_session_set_fills_json,
    rototoon_session_set_recolours_json,
};
use crate::session_abi::RototoonSession;
use crate::status::RototoonStatus::{self, BadArgument, Cancelled, Error, Ok as Fine};
use serde_json::{Value, json};
use std::ptr::{null, null_mut};

const FRAMES: [i32; 3] = [4, 0, 4];
const PLACES: [f64; 6] = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
const COLOURS: [f64; 9] = [0.1, 0.2, 0.3, 1.0, 1.0, 1.0, 0.5, 0.5, 0.5];

fn set(
    session: *const RototoonSession,
    (frames, places, colours): (*const i32, *const f64, *const f64),
    count: usize,
) -> (RototoonStatus, String) {
    // SAFETY: the arrays have `count` clicks, or are refused before they are read; the session is alive or null.
    outcome(|error| unsafe { rototoon_session_set_fills(session, frames, places, colours, count, error) })
}

fn arrays() -> (*const i32, *const f64, *const f64) {
    (FRAMES.as_ptr(), PLACES.as_ptr(), COLOURS.as_ptr())
}

/// Status and error text of painting. Checks that there are results if and only if it succeeds.
fn fill(session: *const RototoonSession, options: &str, stop: bool) -> (RototoonStatus, String) {
    let (mut filled, mut report) = (null_mut(), null_mut());
    let progress: crate::callback::RototoonProgress = if stop { Some(cancel) } else { None };
    let (data, length) = (options.as_ptr(), options.len());
    // SAFETY: a living session or null, a text with its length, a callback that reads nothing, locals.
    unsafe {
        let found = outcome(|error| {
            rototoon_session_fill(session, data, length, progress, null_mut(), &mut filled, &mut report, error)
        });
        assert_eq!((filled.is_null(), report.is_null()), (found.0 != Fine, found.0 != Fine));
        rototoon_filled_free(filled);
        take(report);
        found
    }
}

#[test]
fn colours_have_names() {
    let session = session();
    let text = r#"[{"frame": 1, "regions": [{"at": [1, 2], "colour": [1, 0, 0], "name": "coat"}]}]"#;
    // SAFETY: a living session, texts with their lengths, locals.
    unsafe {
        let set =
            |text: &str| outcome(|error| rototoon_session_set_fills_json(session.0, text.as_ptr(), text.len(), error));
        assert_eq!(set(text), (Fine, String::new()));
        assert_eq!(document(&session)["fills"][0]["regions"][0]["name"], "coat");
        assert_eq!(set("{").0, Error);
        assert!(set(r#"[{"frame": 1, "regions": [{"at": [1, 2]}]}]"#).1.starts_with("fills[0] (frame 1).regions[0]"));
        let mut names = null_mut();
        let empty = crate::filled::RototoonFilled { names: vec![Some("coat".into()), None], ..Default::default() };
        assert_eq!(outcome(|error| rototoon_filled_names(&empty, &mut names, error)).0, Fine);
        assert_eq!(take(names), r#"["coat",null]"#);
        assert_eq!(outcome(|error| rototoon_filled_names(null(), &mut names, error)).0, BadArgument);
    }
}

#[test]
fn colours_become_others() {
    let session = session();
    let text = r#"[{"from": {"name": "coat", "colour": [1, 0, 0]}, "to": {"colour": [0, 0, 1]}, "last": 3}]"#;
    // SAFETY: a living session, texts with their lengths, locals.
    unsafe {
        let set = |text: &str| {
            outcome(|error| rototoon_session_set_recolours_json(session.0, text.as_ptr(), text.len(), error))
        };
        assert_eq!(set(text), (Fine, String::new()));
        assert_eq!(document(&session)["recolours"][0]["last"], 3);
        assert!(set(r#"[{"from": {"name": "coat"}}]"#).1.starts_with("recolours[0].from.name: found \"coat\""));
        let mut given = null_mut();
        assert_eq!(outcome(|error| rototoon_session_recolours(session.0, &mut given, error)).0, Fine);
        let found: Value = serde_json::from_str(&take(given)).unwrap();
        let hue = json!({"name": "coat", "colour": [1.0, 0.0, 0.0]});
        assert_eq!(found, json!([{"from": hue, "to": {"colour": [0.0, 0.0, 1.0]}, "last": 3}]));
        assert_eq!(outcome(|error| rototoon_session_recolours(null(), &mut given, error)).0, BadArgument);
        assert_eq!(set("[]").0, Fine);
        assert_eq!(document(&session).get("recolours"), None);
    }
}

#[test]
fn clicks_are_set_read_and_removed() {
    let session = session();
    assert_eq!(set(session.0, arrays(), 3), (Fine, "".into()));
    let mut text = null_mut();
    // SAFETY: a living session, a local.
    assert_eq!(unsafe { rototoon_session_fills(session.0, &mut text, null_mut()) }, Fine);
    let found: Value = serde_json::from_str(&take(text)).unwrap();
    let click = |at: [f64; 2], colour: [f64; 3]| json!({"at": at, "colour": colour});
    let first = json!({"frame": 0, "regions": [click([3.0, 4.0], [1.0; 3])]});
    let last = [click([1.0, 2.0], [0.1, 0.2, 0.3]), click([5.0, 6.0], [0.5; 3])];
    assert_eq!(found, json!([first, {"frame": 4, "regions": last}]));
    assert_eq!(document(&session)["fills"][1]["frame"], 4);
    assert_eq!(set(session.0, (null(), null(), null()), 0).0, Fine);
    assert_eq!(document(&session).get("fills"), None);
}

#[test]
fn wrong_arrays_are_refused_and_change_nothing() {
    let session = session();
    assert_eq!(set(session.0, arrays(), 2).0, Fine);
    let before = document(&session);
    let (frames, places, colours) = arrays();
    let odd = places.cast::<u8>().wrapping_add(1).cast();
    for (found, expected) in [
        (set(null(), arrays(), 3), "session: null handle"),
        (set(session.0, (null(), places, colours), 3), "frames: null pointer with length 3"),
        (set(session.0, (frames, null(), colours), 3), "places: null pointer with length 6"),
        (set(session.0, (frames, places, null()), 3), "colours: null pointer with length 9"),
        (set(session.0, (frames, odd, colours), 3), "places: pointer is not aligned to 8 bytes"),
        (set(session.0, arrays(), usize::MAX), "click_count: 18446744073709551615 is more than"),
        (set(session.0, arrays(), MAX_BYTES / 24 + 1), "is more than memory can hold"),
        (set(session.0, arrays(), usize::MAX / 3 + 2), "is more than memory can hold"),
    ] {
        assert_eq!(found.0, BadArgument, "{expected}");
        assert!(found.1.contains(expected), "{:?} should say {expected:?}", found.1);
    }
    let (status, message) = set(session.0, (frames, places, [2.0; 9].as_ptr()), 3);
    assert_eq!(
        (status, &message[..]),
        (Error, "click 0 (frame 4): colour: found 2, expected numbers from 0 to 1, or three NaN for no paint")
    );
    assert_eq!(document(&session), before);
}

#[test]
fn painting_names_what_is_wrong_and_changes_nothing() {
    let session = session();
    assert_eq!(fill(null(), "", false).0, BadArgument);
    let (status, message) = fill(session.0, "", false);
    assert_eq!(status, Error);
    assert!(message.starts_with("fills: found no click"), "{message}");
    assert_eq!(set(session.0, arrays(), 3).0, Fine);
    let before = document(&session);
    for (options, expected) in [
        (r#"{"sensitivity": 0}"#, "options: sensitivity: found 0"),
        (r#"{"confidence": -1}"#, "options: confidence: found -1"),
        (r#"{"frames": [2, 99]}"#, "frames: found 2 to 99, expected frames of the footage, 0 to 9"),
        ("{", "options: EOF"),
        ("", "no_such_000.png"),
    ] {
        let (status, message) = fill(session.0, options, false);
        assert_eq!(status, Error, "{options}");
        assert!(message.contains(expected), "{options}: {message:?} should say {expected:?}");
    }
    assert_eq!(fill(session.0, "", true), (Cancelled, "cancelled".into()));
    assert_eq!(document(&session), before);
    // SAFETY: the nulls are what is tested.
    let found = outcome(|error| unsafe {
        let (mut filled, none) = (null_mut(), null_mut());
        rototoon_session_fill(session.0, null(), 0, None, null_mut(), &mut filled, none, error)
    });
    assert_eq!(found, (BadArgument, "report: null out parameter".into()));
}

#[test]
fn painted_regions_are_read_as_arrays() {
    let text = r#"{
      "rototoon": 1, "parts": [],
      "footage": {"pattern": "no_such_%03d.png", "first": 0, "last": 9, "fps": 25, "width": 64, "height": 48},
      "filled": [{"frame": 3, "regions": [{"outline": [[1, 2], [3, 4], [5, 7]], "holes": [[[2, 2], [3, 3], [2, 3]]],
        "colour": [0.25, 0.5, 1], "track": 6, "confidence": 0.25}]}]
    }"#;
    let session = open(text).unwrap();
    let (mut filled, mut count) = (null_mut(), 0);
    let (mut frames, mut regions, mut tracks, mut doubtful) = (null(), null(), null(), null());
    let (mut outlines, mut ends) = (null(), null());
    let (mut colours, mut confidence, mut points) = (null(), null(), null());
    // SAFETY: living handles, locals, and arrays read before their handle is freed.
    unsafe {
        assert_eq!(rototoon_session_filled(session.0, &mut filled, null_mut()), Fine);
        let read = rototoon_filled_read(
            filled,
            &mut count,
            &mut frames,
            &mut regions,
            &mut tracks,
            &mut colours,
            &mut confidence,
            &mut doubtful,
            &mut outlines,
            &mut ends,
            &mut points,
            null_mut(),
        );
        assert_eq!((read, count, *frames, *tracks, *doubtful), (Fine, 1, 3, 6, 1));
        assert_eq!(std::slice::from_raw_parts(regions, 2), [0, 1]);
        assert_eq!(std::slice::from_raw_parts(outlines, 2), [0, 2]);
        assert_eq!(std::slice::from_raw_parts(ends, 3), [0, 3, 6]);
        assert_eq!((std::slice::from_raw_parts(colours, 3), *confidence), (&[0.25, 0.5, 1.0][..], 0.25));
        assert_eq!(std::slice::from_raw_parts(points, 12)[6..8], [2.0, 2.0]);
        rototoon_filled_free(filled);
        rototoon_filled_free(null_mut());
    }
}
