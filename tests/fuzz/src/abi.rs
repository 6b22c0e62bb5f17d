//! The C ABI of `rototoon-capi` as safe functions: the only file with unsafe code.
//!
//! Each function makes one call as a foreign caller does, frees what it gets, and holds the library to its contract: no
//! status says that it panicked, and there is a message if and only if a call fails.

#![allow(unsafe_code, reason = "a C ABI is called with raw pointers; each use says why they are valid")]

use rototoon_capi::callback::RototoonProgress;
use rototoon_capi::filled::RototoonFilled;
use rototoon_capi::filled_abi::{
    rototoon_filled_free, rototoon_filled_read, rototoon_session_fill, rototoon_session_set_fills,
};
use rototoon_capi::handles::{
    RototoonCurves, RototoonTrack, rototoon_curves_free, rototoon_curves_read, rototoon_text_free, rototoon_text_read,
    rototoon_track_free, rototoon_track_read,
};
use rototoon_capi::session_abi::{RototoonSession, rototoon_session_free, rototoon_session_new};
use rototoon_capi::session_edit_abi::{
    rototoon_session_pin, rototoon_session_set_center, rototoon_session_set_key, rototoon_session_unpin,
};
use rototoon_capi::session_track_abi::{rototoon_session_curves_of, rototoon_session_track_of};
use rototoon_capi::status::RototoonStatus;
use rototoon_capi::strokes_abi::{
    rototoon_fit_strokes, rototoon_guides_free, rototoon_hidden_lines, rototoon_pieces_free,
};
use rototoon_capi::text::RototoonText;
use rototoon_capi::tween_abi::{
    rototoon_draw_in_betweens, rototoon_in_betweens_free, rototoon_match_strokes, rototoon_matches_free,
};
use std::ffi::c_void;
use std::ptr::{null, null_mut};

type Status = RototoonStatus;
type Error = *mut *mut RototoonText;
/// A call of a session with one text.
pub type TextCall = unsafe extern "C" fn(*const RototoonSession, *const u8, usize, Error) -> Status;
/// A call of a session that gives a text.
pub type OutCall = unsafe extern "C" fn(*const RototoonSession, *mut *mut RototoonText, Error) -> Status;
/// A call of a session with a part and a frame.
pub type FrameCall = unsafe extern "C" fn(*const RototoonSession, *const u8, usize, i32, Error) -> Status;
/// A call of a session with options and progress that gives a text.
pub type WorkCall = unsafe extern "C" fn(
    *const RototoonSession,
    *const u8,
    usize,
    RototoonProgress,
    *mut c_void,
    *mut *mut RototoonText,
    Error,
) -> Status;
/// A call with one text that gives a text.
pub type RequestCall = unsafe extern "C" fn(*const u8, usize, *mut *mut RototoonText, Error) -> Status;
/// A call with two texts that gives a text.
pub type PairCall = unsafe extern "C" fn(*const u8, usize, *const u8, usize, *mut *mut RototoonText, Error) -> Status;

/// Makes a call. The answer is whether it succeeded.
fn done(call: impl FnOnce(Error) -> Status) -> bool {
    let mut error = null_mut();
    let status = call(&mut error);
    let message = taken(error);
    assert_ne!(status, Status::Panic, "{}", message.as_deref().unwrap_or_default());
    assert_ne!(status, Status::Busy, "no other call runs");
    assert_eq!(message.is_none(), status == Status::Ok, "a message without a failure, or a failure without a message");
    status == Status::Ok
}

/// Makes a call that gives a text. The text is there if and only if the call succeeded.
fn answer(call: impl FnOnce(*mut *mut RototoonText, Error) -> Status) -> Option<String> {
    let mut out = null_mut();
    let fine = done(|error| call(&mut out, error));
    let text = taken(out);
    assert_eq!(text.is_some(), fine, "a call that succeeded gave no text, or one that failed did");
    text
}

/// Reads a text and frees it.
fn taken(text: *mut RototoonText) -> Option<String> {
    if text.is_null() {
        return None;
    }
    let (mut data, mut length) = (null(), 0);
    // SAFETY: a living handle of the library, locals; the bytes are copied before the handle is freed.
    unsafe {
        assert_eq!(rototoon_text_read(text, &mut data, &mut length, null_mut()), Status::Ok);
        let bytes = std::slice::from_raw_parts(data, length).to_vec();
        rototoon_text_free(text);
        Some(String::from_utf8(bytes).expect("texts of the library are UTF-8"))
    }
}

/// Counts down to the cancelling of a work: the number of reports that it may still make.
extern "C" fn progress(left: *mut c_void, fraction: f64, _step: *const u8, _length: usize) -> i32 {
    assert!((0.0..=1.0).contains(&fraction), "a fraction of {fraction}");
    // SAFETY: `Session::work` passes its own number, which nothing else uses during the call.
    let left = unsafe { &mut *left.cast::<u32>() };
    *left = left.saturating_sub(1);
    i32::from(*left == 0)
}

/// A session that is freed when it is dropped.
pub struct Session(*mut RototoonSession);

impl Drop for Session {
    fn drop(&mut self) {
        // SAFETY: made by the library, freed once.
        unsafe { rototoon_session_free(self.0) }
    }
}

impl Session {
    /// A session of a document in a folder.
    pub fn new(document: &str, folder: &str) -> Option<Self> {
        let mut session = null_mut();
        // SAFETY: pointers and lengths belong together, out parameters are locals.
        let fine = done(|error| unsafe {
            let (text, place) = (document.as_bytes(), folder.as_bytes());
            rototoon_session_new(text.as_ptr(), text.len(), place.as_ptr(), place.len(), &mut session, error)
        });
        assert_eq!(!session.is_null(), fine);
        fine.then_some(Self(session))
    }

    /// A call with one text.
    pub fn text(&self, call: TextCall, text: &str) -> bool {
        // SAFETY: a living session, a text with its length.
        done(|error| unsafe { call(self.0, text.as_ptr(), text.len(), error) })
    }

    /// A call that gives a text.
    pub fn out(&self, call: OutCall) -> Option<String> {
        // SAFETY: a living session, locals.
        answer(|out, error| unsafe { call(self.0, out, error) })
    }

    /// A call with a part and a frame.
    pub fn frame(&self, call: FrameCall, part: &str, frame: i32) -> bool {
        // SAFETY: a living session, a text with its length.
        done(|error| unsafe { call(self.0, part.as_ptr(), part.len(), frame, error) })
    }

    /// A call with options, which is cancelled at the report of this number; 0 for never.
    pub fn work(&self, call: WorkCall, options: &str, mut cancel: u32) -> Option<String> {
        let asked: RototoonProgress = if cancel > 0 { Some(progress) } else { None };
        let user = (&raw mut cancel).cast();
        // SAFETY: a living session, a text with its length, a callback that fits `user`, locals.
        answer(|out, error| unsafe { call(self.0, options.as_ptr(), options.len(), asked, user, out, error) })
    }

    /// `rototoon_session_set_key` with any number of values.
    pub fn set_key(&self, part: &str, frame: i32, values: &[f64]) -> bool {
        let name = part.as_bytes();
        // SAFETY: a living session, arrays with their lengths.
        done(|error| unsafe {
            rototoon_session_set_key(self.0, name.as_ptr(), name.len(), frame, values.as_ptr(), values.len(), error)
        })
    }

    /// `rototoon_session_pin`.
    pub fn pin(&self, part: &str, frame: i32, point: i32, [x, y]: [f64; 2]) -> bool {
        // SAFETY: a living session, a text with its length.
        done(|error| unsafe { rototoon_session_pin(self.0, part.as_ptr(), part.len(), frame, point, x, y, error) })
    }

    /// `rototoon_session_unpin`.
    pub fn unpin(&self, part: &str, frame: i32, point: i32) -> bool {
        // SAFETY: a living session, a text with its length.
        done(|error| unsafe { rototoon_session_unpin(self.0, part.as_ptr(), part.len(), frame, point, error) })
    }

    /// `rototoon_session_set_center`.
    pub fn set_center(&self, part: &str, frame: i32, [x, y]: [f64; 2]) -> bool {
        // SAFETY: a living session, a text with its length.
        done(|error| unsafe { rototoon_session_set_center(self.0, part.as_ptr(), part.len(), frame, x, y, error) })
    }

    /// `rototoon_session_track_of`, read and freed. The sum of all that was read keeps the reads.
    pub fn track_of(&self, part: &str) -> bool {
        let mut track: *mut RototoonTrack = null_mut();
        // SAFETY: a living session, a text with its length, locals; arrays are read before their handle is freed.
        unsafe {
            let fine = done(|error| rototoon_session_track_of(self.0, part.as_ptr(), part.len(), &mut track, error));
            if fine {
                let (mut frames, mut points, mut confidence) = (null(), null(), null());
                let (mut count, mut each) = (0, 0);
                assert!(done(|error| rototoon_track_read(
                    track,
                    &mut count,
                    &mut each,
                    &mut frames,
                    &mut points,
                    &mut confidence,
                    error
                )));
                read(frames, count);
                read(points, 2 * count * each);
                read(confidence, count * each);
            }
            rototoon_track_free(track);
            fine
        }
    }

    /// `rototoon_session_curves_of`, read and freed.
    pub fn curves_of(&self, part: &str, frame: i32) -> bool {
        let mut curves: *mut RototoonCurves = null_mut();
        // SAFETY: a living session, a text with its length, locals; arrays are read before their handle is freed.
        unsafe {
            let fine =
                done(|error| rototoon_session_curves_of(self.0, part.as_ptr(), part.len(), frame, &mut curves, error));
            if fine {
                let (mut count, mut offsets, mut points) = (0, null(), null());
                assert!(done(|error| rototoon_curves_read(curves, &mut count, &mut offsets, &mut points, error)));
                read(offsets, count + 1);
                read(points, 2 * usize::try_from(*offsets.add(count)).expect("offsets are not negative"));
            }
            rototoon_curves_free(curves);
            fine
        }
    }
}

impl Session {
    /// `rototoon_session_set_fills`. `places` and `colours` have two and three numbers for each frame.
    pub fn set_fills(&self, frames: &[i32], places: &[f64], colours: &[f64]) -> bool {
        assert_eq!((places.len(), colours.len()), (2 * frames.len(), 3 * frames.len()));
        // SAFETY: a living session, arrays with the lengths that the function asks for (above).
        done(|error| unsafe {
            let (frames, count) = (frames.as_ptr(), frames.len());
            rototoon_session_set_fills(self.0, frames, places.as_ptr(), colours.as_ptr(), count, error)
        })
    }

    /// `rototoon_session_fill`, which is cancelled at the report of this number; 0 for never. The regions are read and freed.
    pub fn fill(&self, options: &str, mut cancel: u32) -> bool {
        let asked: RototoonProgress = if cancel > 0 { Some(progress) } else { None };
        let user = (&raw mut cancel).cast();
        let (mut filled, mut report) = (null_mut(), null_mut());
        let (data, length) = (options.as_ptr(), options.len());
        // SAFETY: a living session, a text with its length, a callback that fits `user`, locals.
        unsafe {
            let fine =
                done(|error| rototoon_session_fill(self.0, data, length, asked, user, &mut filled, &mut report, error));
            assert_eq!((taken(report).is_some(), !filled.is_null()), (fine, fine));
            if fine {
                read_regions(filled);
            }
            rototoon_filled_free(filled);
            fine
        }
    }
}

/// Reads all arrays of painted regions.
///
/// # Safety
///
/// `filled` is a living handle.
unsafe fn read_regions(filled: *const RototoonFilled) {
    let mut count = 0;
    let (mut frames, mut regions, mut tracks, mut doubtful) = (null(), null(), null(), null());
    let (mut outlines, mut ends) = (null::<i32>(), null::<i32>());
    let (mut colours, mut confidence, mut points) = (null(), null(), null());
    // SAFETY: a living handle (this function's contract), locals; arrays are read before their handle is freed.
    unsafe {
        assert!(done(|error| rototoon_filled_read(
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
            error
        )));
        let last =
            |offsets: *const i32, at: usize| usize::try_from(*offsets.add(at)).expect("offsets are not negative");
        read(frames, count);
        read(regions, count + 1);
        let found = last(regions, count);
        read(tracks, found);
        read(colours, 3 * found);
        read(confidence, found);
        read(doubtful, found);
        read(outlines, found + 1);
        let loops = last(outlines, found);
        read(ends, loops + 1);
        read(points, 2 * last(ends, loops));
    }
}

/// Reads an array of the library to its end, so that the address sanitizer sees a length that is too large.
///
/// # Safety
///
/// `length` values can be read at `data`; that they can is what is tested.
unsafe fn read<T: Copy>(data: *const T, length: usize) {
    if length > 0 {
        // SAFETY: this function's contract.
        std::hint::black_box(unsafe { std::slice::from_raw_parts(data, length) }.to_vec());
    }
}

/// A call with one text that gives a text.
pub fn request(call: RequestCall, text: &str) -> Option<String> {
    // SAFETY: a text with its length, locals.
    answer(|out, error| unsafe { call(text.as_ptr(), text.len(), out, error) })
}

/// A call with two texts that gives a text.
pub fn pair(call: PairCall, [a, b]: [&str; 2]) -> Option<String> {
    // SAFETY: texts with their lengths, locals.
    answer(|out, error| unsafe { call(a.as_ptr(), a.len(), b.as_ptr(), b.len(), out, error) })
}

/// Strokes in flat arrays. All offsets but the last may be any numbers: the library must refuse those that do not fit.
#[derive(Clone, Debug, Default)]
pub struct Strokes {
    /// One more than there are strokes. The last one is the number of points, which is the length of `points` over 2.
    pub offsets: Vec<i32>,
    /// Coordinates.
    pub points: Vec<f64>,
    /// One flag a stroke.
    pub closed: Vec<u8>,
    /// Two numbers a stroke: labels or depths.
    pub labels: Vec<i32>,
    /// One number a stroke: the form of its points, 0 to 2.
    pub forms: Vec<u8>,
    /// The bounds of the drawings among the strokes: at least one.
    pub drawings: Vec<i32>,
    /// A frame for each drawing.
    pub frames: Vec<i32>,
    /// Pairs made by hand: an even count.
    pub by_hand: Vec<i32>,
}

impl Strokes {
    /// Whether the arrays have the lengths that the contract asks of a caller.
    fn whole(&self) -> bool {
        let count = self.closed.len();
        self.offsets.len() == count + 1
            && self.offsets[count] as usize * 2 == self.points.len()
            && self.labels.len() == 2 * count
            && self.forms.len() == count
            && self.drawings.len() == self.frames.len() + 1
    }

    /// `rototoon_fit_strokes` with a channel of values.
    pub fn fit(&self, tolerance: f64) -> bool {
        assert!(self.whole());
        let (mut guides, count) = (null_mut(), self.closed.len());
        // SAFETY: the arrays have their lengths (above); one channel of values has half as many as there are coordinates.
        unsafe {
            let (offsets, points, closed) = (self.offsets.as_ptr(), self.points.as_ptr(), self.closed.as_ptr());
            let fine = done(|error| {
                rototoon_fit_strokes(offsets, count, points, closed, points, 1, tolerance, &mut guides, error)
            });
            rototoon_guides_free(guides);
            fine
        }
    }

    /// `rototoon_hidden_lines`.
    pub fn hide(&self, border: f64, sliver: f64) -> bool {
        assert!(self.whole());
        let (mut pieces, count) = (null_mut(), self.closed.len());
        // SAFETY: the arrays have their lengths (above); labels are two a stroke, of which fills take the first half.
        unsafe {
            let (offsets, points, closed) = (self.offsets.as_ptr(), self.points.as_ptr(), self.closed.as_ptr());
            let (forms, labels) = (self.forms.as_ptr(), self.labels.as_ptr());
            let fine = done(|error| {
                rototoon_hidden_lines(
                    offsets,
                    count,
                    points,
                    closed,
                    forms,
                    labels,
                    labels,
                    border,
                    sliver,
                    &mut pieces,
                    error,
                )
            });
            rototoon_pieces_free(pieces);
            fine
        }
    }

    /// `rototoon_match_strokes`.
    pub fn matched(&self, options: &str) -> bool {
        assert!(self.whole());
        let (mut found, count) = (null_mut(), self.closed.len());
        // SAFETY: the arrays have their lengths (above); colours may be null; no callback.
        unsafe {
            let fine = done(|error| {
                rototoon_match_strokes(
                    self.offsets.as_ptr(),
                    count,
                    self.points.as_ptr(),
                    self.closed.as_ptr(),
                    null(),
                    self.labels.as_ptr(),
                    self.drawings.as_ptr(),
                    self.frames.len(),
                    self.by_hand.as_ptr(),
                    self.by_hand.len() / 2,
                    options.as_ptr(),
                    options.len(),
                    None,
                    null_mut(),
                    &mut found,
                    error,
                )
            });
            rototoon_matches_free(found);
            fine
        }
    }

    /// `rototoon_draw_in_betweens`.
    pub fn between(&self, options: &str) -> bool {
        assert!(self.whole());
        let (mut found, mut drawn, count) = (null_mut(), null_mut(), self.closed.len());
        // SAFETY: the arrays have their lengths (above); colours may be null; no callback.
        unsafe {
            let fine = done(|error| {
                rototoon_draw_in_betweens(
                    self.offsets.as_ptr(),
                    count,
                    self.points.as_ptr(),
                    self.closed.as_ptr(),
                    null(),
                    self.labels.as_ptr(),
                    self.drawings.as_ptr(),
                    self.frames.len(),
                    self.frames.as_ptr(),
                    self.by_hand.as_ptr(),
                    self.by_hand.len() / 2,
                    options.as_ptr(),
                    options.len(),
                    None,
                    null_mut(),
                    &mut found,
                    &mut drawn,
                    error,
                )
            });
            rototoon_matches_free(found);
            rototoon_in_betweens_free(drawn);
            fine
        }
    }
}
