//! Tests of the ABI from the side of a foreign caller: pointers, statuses, texts.

mod clips;
mod conforming;
mod fills;
mod saving;

use crate::callback::RototoonProgress;
use crate::edit;
use crate::entry::{MAX_BYTES, entry};
use crate::functions::{rototoon_abi_version, rototoon_header_hash, rototoon_version};
use crate::handles::{
    rototoon_curves_free, rototoon_curves_read, rototoon_text_free, rototoon_text_read, rototoon_track_free,
    rototoon_track_read,
};
use crate::session_abi::{
    RototoonSession, rototoon_session_document, rototoon_session_free, rototoon_session_new, rototoon_session_parts,
    rototoon_session_set_document,
};
use crate::session_edit_abi::{
    rototoon_session_add_part, rototoon_session_pin, rototoon_session_remove_part, rototoon_session_set_key,
};
use crate::session_track_abi::{rototoon_session_curves_of, rototoon_session_track, rototoon_session_track_of};
use crate::status::RototoonStatus::{self, BadArgument, Busy, Cancelled, Error, Ok as Fine, Panic};
use crate::text::RototoonText;
use std::ffi::c_void;
use std::ptr::{null, null_mut};

/// A document with tracks and curves. Its pictures do not exist.
const DOCUMENT: &str = r#"{
  "rototoon": 1,
  "footage": {"pattern": "no_such_%03d.png", "first": 0, "last": 9, "fps": 25, "width": 64, "height": 48},
  "parts": [{
    "name": "near arm", "closed": true, "depth": 1, "note": "kept",
    "keys": {"0": [[1, 2], [3, 4], [5, 7]], "6": [[1, 2], [3, 4], [5, 7]]},
    "tracks": {"0": [[1, 2], [3, 4], [5, 7]], "1": [[1.5, 2.5], [3.5, 4.5], [5.5, 7.5]]},
    "confidence": {"1": [0.25, 0.5, 0.75]},
    "curves": {"1": [[[1, 1], [2, 2]], [[2, 2], [2, 3], [3, 3]], [[3, 3], [1, 1]]]}
  }]
}"#;

/// Reads a text and frees its handle.
fn take(text: *mut RototoonText) -> String {
    if text.is_null() {
        return String::new();
    }
    let (mut data, mut length) = (null(), 0);
    // SAFETY: `text` is a living handle, the out parameters are locals, and the bytes live until the text is freed.
    unsafe {
        assert_eq!(rototoon_text_read(text, &mut data, &mut length, null_mut()), Fine);
        let owned = String::from_utf8(std::slice::from_raw_parts(data, length).to_vec()).unwrap();
        rototoon_text_free(text);
        owned
    }
}

/// Status and error text of a call.
fn outcome(call: impl FnOnce(*mut *mut RototoonText) -> RototoonStatus) -> (RototoonStatus, String) {
    let mut error = null_mut();
    let status = call(&mut error);
    (status, take(error))
}

/// A session that is freed at the end of the test.
struct Owned(*mut RototoonSession);

impl Drop for Owned {
    fn drop(&mut self) {
        // SAFETY: made by the library, freed once.
        unsafe { rototoon_session_free(self.0) }
    }
}

fn open(document: &str) -> Result<Owned, (RototoonStatus, String)> {
    let mut session = null_mut();
    // SAFETY: pointers and lengths belong together, out parameters are locals.
    let found = outcome(|error| unsafe {
        rototoon_session_new(document.as_ptr(), document.len(), b"/nowhere".as_ptr(), 8, &mut session, error)
    });
    if found.0 == Fine { Ok(Owned(session)) } else { Err(found) }
}

fn session() -> Owned {
    open(DOCUMENT).unwrap()
}

fn document(session: &Owned) -> serde_json::Value {
    let mut text = null_mut();
    // SAFETY: a living session and a local.
    assert_eq!(outcome(|error| unsafe { rototoon_session_document(session.0, &mut text, error) }), (Fine, "".into()));
    serde_json::from_str(&take(text)).unwrap()
}

fn pin(session: *const RototoonSession, part: &str, frame: i32, point: i32) -> (RototoonStatus, String) {
    // SAFETY: pointer and length belong together; the session is alive or null.
    outcome(|error| unsafe { rototoon_session_pin(session, part.as_ptr(), part.len(), frame, point, 9.0, 8.0, error) })
}

fn track(session: &Owned, options: &str, progress: RototoonProgress, user: *mut c_void) -> (RototoonStatus, String) {
    let mut summary = null_mut();
    // SAFETY: a living session, a text with its length, a callback that fits `user`, a local.
    let found = outcome(|error| unsafe {
        rototoon_session_track(session.0, options.as_ptr(), options.len(), progress, user, &mut summary, error)
    });
    assert_eq!(summary.is_null(), found.0 != Fine);
    take(summary);
    found
}

#[test]
fn unknown_fields_of_a_document_are_kept() {
    let session = session();
    assert_eq!(pin(session.0, "near arm", 3, 1), (Fine, "".into()));
    let found = document(&session);
    assert_eq!(found["parts"][0]["pins"], serde_json::json!({"3": {"1": [9, 8]}}));
    assert_eq!(found["parts"][0]["note"], "kept");
}

#[test]
fn bad_documents_are_named() {
    let cases = [
        ("", "document"),
        ("{\"rototoon\": 1, \"footage\"", "line 1"),
        ("[]", "document"),
        ("{\"rototoon\": 2}", "version"),
    ];
    for (json, expected) in cases {
        let (status, message) = open(json).err().unwrap();
        assert_eq!(status, Error, "{json}");
        assert!(message.contains(expected), "{json}: {message:?} should say {expected:?}");
    }
}

#[test]
fn null_arguments_are_refused() {
    let session = session();
    let mut text = null_mut();
    // SAFETY: the nulls are what is tested; all other arguments are locals or living handles.
    unsafe {
        let cases = [
            (pin(null(), "near arm", 3, 1), "session: null handle"),
            (outcome(|error| rototoon_session_document(session.0, null_mut(), error)), "document: null out parameter"),
            (outcome(|error| rototoon_session_parts(null(), &mut text, error)), "session: null handle"),
            (outcome(|error| rototoon_session_set_document(session.0, null(), 5, error)), "document: null pointer"),
            (
                outcome(|error| rototoon_session_set_key(session.0, b"a".as_ptr(), 1, 0, null(), 2, error)),
                "points: null pointer with length 2",
            ),
            (outcome(|error| rototoon_text_read(null(), &mut null(), &mut 0, error)), "text: null handle"),
            (outcome(|error| rototoon_version(null_mut(), error)), "version: null out parameter"),
        ];
        for ((status, message), expected) in cases {
            assert_eq!(status, BadArgument);
            assert!(message.contains(expected), "{message:?} should say {expected:?}");
        }
        // The pointer for the message may be null. Freeing null does nothing.
        assert_eq!(rototoon_session_parts(null(), &mut text, null_mut()), BadArgument);
        rototoon_text_free(null_mut());
        rototoon_track_free(null_mut());
        rototoon_curves_free(null_mut());
        rototoon_session_free(null_mut());
    }
    assert!(text.is_null());
}

#[test]
fn misaligned_oversize_and_undecodable_arguments_are_refused() {
    let session = session();
    let numbers = [0.0_f64; 4];
    let odd = numbers.as_ptr().cast::<u8>().wrapping_add(1);
    // SAFETY: refused before anything is read through them.
    unsafe {
        let key = |points, count| {
            outcome(|error| rototoon_session_set_key(session.0, b"a".as_ptr(), 1, 0, points, count, error))
        };
        let cases = [
            (key(odd.cast(), 2), "points: pointer is not aligned to 8 bytes"),
            (key(numbers.as_ptr(), usize::MAX), "points: length 18446744073709551615 is more than"),
            (key(numbers.as_ptr(), MAX_BYTES / 8 + 1), "is more than"),
            (pin(odd.cast(), "near arm", 3, 1), "session: misaligned handle"),
            (outcome(|error| rototoon_session_remove_part(session.0, [0xFF_u8].as_ptr(), 1, error)), "part: not UTF-8"),
        ];
        for ((status, message), expected) in cases {
            assert_eq!(status, BadArgument);
            assert!(message.contains(expected), "{message:?} should say {expected:?}");
        }
        let misaligned_error = odd.cast_mut().cast::<*mut RototoonText>();
        assert_eq!(rototoon_session_parts(session.0, &mut null_mut(), misaligned_error), BadArgument);
    }
}

#[test]
fn panics_become_a_status_and_the_session_stays_usable() {
    // SAFETY: the out parameter is a local.
    let found = outcome(|error| unsafe { entry(error, || panic!("number {}", 7)) });
    assert_eq!(found, (Panic, "defect in Rototoon: number 7".into()));

    let session = session();
    let before = document(&session);
    // SAFETY: a living session, a local.
    let found = outcome(|error| unsafe {
        entry(error, || (*session.0).with(|_| -> Result<(), crate::status::Failure> { panic!("inside") }))
    });
    assert_eq!(found, (Panic, "defect in Rototoon: inside".into()));
    assert_eq!(document(&session), before);
}

#[test]
fn refused_edit_says_why_and_changes_nothing() {
    let session = session();
    let before = document(&session);
    let (status, message) = pin(session.0, "near arm", 6, 1);
    assert_eq!(status, Error);
    assert_eq!(message, edit_message());
    assert_eq!(document(&session), before);
}

fn edit_message() -> String {
    let what = "a key frame, where the key itself is edited";
    edit::EditError::NotBetweenKeys { part: "near arm".into(), frame: 6, what }.to_string()
}

extern "C" fn cancel(_user: *mut c_void, _fraction: f64, _step: *const u8, _length: usize) -> i32 {
    1
}

#[test]
fn cancelled_track_leaves_the_document_as_it_was() {
    let session = session();
    let before = document(&session);
    assert_eq!(track(&session, "", Some(cancel), null_mut()), (Cancelled, "cancelled".into()));
    assert_eq!(document(&session), before);
}

/// A session to be used while a call on it runs, and the status and error text of that use.
struct Intruder {
    session: *const RototoonSession,
    found: Option<(RototoonStatus, String)>,
}

extern "C" fn intrude(user: *mut c_void, _fraction: f64, _step: *const u8, _length: usize) -> i32 {
    // SAFETY: the test passes its `Intruder`, which nothing else touches during the call.
    let intruder = unsafe { &mut *user.cast::<Intruder>() };
    intruder.found = Some(pin(intruder.session, "near arm", 3, 1));
    1
}

#[test]
fn call_during_another_call_is_refused() {
    let session = session();
    let mut intruder = Intruder { session: session.0, found: None };
    let found = track(&session, "", Some(intrude), (&raw mut intruder).cast());
    assert_eq!(found.0, Cancelled);
    let (status, message) = intruder.found.unwrap();
    assert_eq!(status, Busy);
    assert!(message.contains("in use by another call"), "{message}");
    assert_eq!(pin(session.0, "near arm", 3, 1).0, Fine);
}

#[test]
fn options_and_missing_pictures_are_named() {
    let session = session();
    let before = document(&session);
    for (options, expected) in [
        (
            "{\"preset\": \"best\"}",
            "preset: found \"best\", expected one of rototoon, zhou2011, agarwala2004, liang2012",
        ),
        ("{\"speed\": 3}", "speed"),
        ("{\"threads\": 100000}", "expected a whole number from 0 to 1024"),
        ("{", "options"),
        ("{}", "no_such_000.png"),
    ] {
        let (status, message) = track(&session, options, None, null_mut());
        assert_eq!(status, Error, "{options}");
        assert!(message.contains(expected), "{options}: {message:?} should say {expected:?}");
    }
    assert_eq!(document(&session), before);
}

#[test]
fn arrays_have_the_values_of_the_document() {
    let session = session();
    let part = "near arm";
    let (mut tracks, mut curves) = (null_mut(), null_mut());
    let (mut frame_count, mut point_count, mut path_count) = (0, 0, 0);
    let (mut frames, mut points, mut confidence) = (null(), null(), null());
    let (mut offsets, mut path_points) = (null(), null());
    // SAFETY: living handles, locals, and arrays read before their handle is freed.
    unsafe {
        let (name, length) = (part.as_ptr(), part.len());
        assert_eq!(rototoon_session_track_of(session.0, name, length, &mut tracks, null_mut()), Fine);
        let read = rototoon_track_read(
            tracks,
            &mut frame_count,
            &mut point_count,
            &mut frames,
            &mut points,
            &mut confidence,
            null_mut(),
        );
        assert_eq!((read, frame_count, point_count), (Fine, 2, 3));
        assert_eq!(std::slice::from_raw_parts(frames, 2), [0, 1]);
        let expected = [1.0, 2.0, 3.0, 4.0, 5.0, 7.0, 1.5, 2.5, 3.5, 4.5, 5.5, 7.5];
        assert_eq!(std::slice::from_raw_parts(points, 12), expected);
        assert_eq!(std::slice::from_raw_parts(confidence, 6), [1.0, 1.0, 1.0, 0.25, 0.5, 0.75]);
        rototoon_track_free(tracks);

        assert_eq!(rototoon_session_curves_of(session.0, name, length, 1, &mut curves, null_mut()), Fine);
        let read = rototoon_curves_read(curves, &mut path_count, &mut offsets, &mut path_points, null_mut());
        assert_eq!((read, path_count), (Fine, 3));
        assert_eq!(std::slice::from_raw_parts(offsets, 4), [0, 2, 5, 7]);
        assert_eq!(std::slice::from_raw_parts(path_points, 4), [1.0, 1.0, 2.0, 2.0]);
        rototoon_curves_free(curves);
    }
}

#[test]
fn parts_are_added_checked_and_removed() {
    let session = session();
    let add = |json: &str| {
        // SAFETY: a living session, a text with its length.
        outcome(|error| unsafe { rototoon_session_add_part(session.0, json.as_ptr(), json.len(), error) })
    };
    assert_eq!(add(r#"{"name": "leg", "closed": false, "depth": 0, "keys": {"0": [[1, 1], [2, 2]]}}"#).0, Fine);
    assert_eq!(document(&session)["parts"][1]["name"], "leg");
    assert_eq!(document(&session)["parts"][0]["note"], "kept");
    for bad in [r#"{"name": "leg"}"#, r#"{"name": "x", "keys": {"0": [[1]]}}"#, "[", "7"] {
        assert_eq!(add(bad).0, Error, "{bad}");
    }
    // SAFETY: a living session, a text with its length.
    let removed = outcome(|error| unsafe { rototoon_session_remove_part(session.0, "leg".as_ptr(), 3, error) });
    assert_eq!(removed.0, Fine);
    assert_eq!(document(&session)["parts"].as_array().unwrap().len(), 1);
}

#[test]
fn bindings_carry_the_hash_and_version_of_this_build() {
    let bindings = include_str!("../../../blender-addon/rototoon/native/_bindings.py");
    let hash = format!("HEADER_HASH = 0x{:016x}\n", rototoon_header_hash());
    assert!(bindings.contains(&hash), "run `cargo xtask generate`");
    assert!(bindings.contains(&format!("ROTOTOON_ABI_VERSION = {}\n", rototoon_abi_version())));
    let mut version = null_mut();
    // SAFETY: the out parameter is a local.
    assert_eq!(unsafe { rototoon_version(&mut version, null_mut()) }, Fine);
    assert_eq!(take(version), rototoon::VERSION);
}
