//! The exported functions of sessions.

use crate::callback::{RototoonProgress, with_progress};
use crate::edit;
use crate::entry::{clear, entry, free, give, handle, slice, text};
use crate::handles::{RototoonCurves, RototoonTrack};
use crate::session::Session;
use crate::status::{Failure, RototoonStatus};
use crate::text::RototoonText;
use crate::work::GoOn;
use rototoon::geometry::Point;
use std::ffi::c_void;
use std::path::Path;
use std::ptr::null_mut;
use std::sync::{Mutex, TryLockError};

/// A session: a document, its pictures, and the results that tracking keeps for reuse.
pub struct RototoonSession(Mutex<Session>);

impl RototoonSession {
    fn new(session: Session) -> Self {
        Self(Mutex::new(session))
    }

    /// Runs `body` on the session. Fails at once if another call is using the session.
    pub(crate) fn with<T>(&self, body: impl FnOnce(&mut Session) -> Result<T, Failure>) -> Result<T, Failure> {
        let mut session = match self.0.try_lock() {
            Ok(session) => session,
            Err(TryLockError::WouldBlock) => return Err(Failure::Busy),
            Err(TryLockError::Poisoned(poisoned)) => {
                // A call panicked. The document is intact, because it is replaced in one step. Caches may be half-written.
                let mut session = poisoned.into_inner();
                session.forget();
                self.0.clear_poison();
                session
            }
        };
        body(&mut session)
    }

    fn edit<E: std::fmt::Display>(
        &self,
        change: impl FnOnce(&mut rototoon::scene::Scene) -> Result<(), E>,
    ) -> Result<(), Failure> {
        self.with(|session| change(session.scene_mut()).map_err(Failure::error))
    }
}

/// Creates a session from the JSON text of a document. A relative footage pattern is relative to `folder`. Pictures are
/// read when they are needed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_session_new(
    document: *const u8,
    document_length: usize,
    folder: *const u8,
    folder_length: usize,
    session: *mut *mut RototoonSession,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            clear(session, null_mut(), "session")?;
            let document = text(document, document_length, "document")?;
            let folder = text(folder, folder_length, "folder")?;
            let value = RototoonSession::new(Session::new(document, Path::new(folder))?);
            give(session, value);
            Ok(())
        })
    }
}

/// Creates a session from a project file. A relative footage pattern is relative to the file's folder.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_session_open(
    path: *const u8,
    path_length: usize,
    session: *mut *mut RototoonSession,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            clear(session, null_mut(), "session")?;
            let path = text(path, path_length, "path")?;
            let value = RototoonSession::new(Session::open(Path::new(path))?);
            give(session, value);
            Ok(())
        })
    }
}

/// Frees a session. Null is allowed. No call may be running on it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_session_free(session: *mut RototoonSession) {
    // SAFETY: the crate's contract.
    unsafe { free(session) }
}

/// Returns the document as JSON, with its results.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_session_document(
    session: *const RototoonSession,
    document: *mut *mut RototoonText,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            clear(document, null_mut(), "document")?;
            let session = handle(session, "session")?;
            let value = session.with(|session| Ok(RototoonText::new(session.document())))?;
            give(document, value);
            Ok(())
        })
    }
}

/// Replaces the document, given as JSON. The session keeps solved spans, so tracking solves only spans that differ. It
/// keeps its pictures if the footage is the same.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_session_set_document(
    session: *const RototoonSession,
    document: *const u8,
    document_length: usize,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            let session = handle(session, "session")?;
            let document = text(document, document_length, "document")?;
            session.with(|session| session.set_document(document))
        })
    }
}

/// Writes the document to a file, completely or not at all. If the file is not in the session's folder, a relative
/// footage pattern is rewritten so that it names the same files.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_session_save(
    session: *const RototoonSession,
    path: *const u8,
    path_length: usize,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            let session = handle(session, "session")?;
            let path = text(path, path_length, "path")?;
            session.with(|session| session.save(Path::new(path)))
        })
    }
}

/// Replaces the footage. `footage` is JSON with the fields of the document's `footage`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_session_set_footage(
    session: *const RototoonSession,
    footage: *const u8,
    footage_length: usize,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            let session = handle(session, "session")?;
            let footage = text(footage, footage_length, "footage")?;
            session.with(|session| session.set_footage(footage))
        })
    }
}

/// Returns the names of the parts as a JSON list, in the document's order.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_session_parts(
    session: *const RototoonSession,
    names: *mut *mut RototoonText,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            clear(names, null_mut(), "names")?;
            let session = handle(session, "session")?;
            let value = session.with(|session| Ok(RototoonText::new(session.part_names())))?;
            give(names, value);
            Ok(())
        })
    }
}

/// Adds a part at the end. `part` is JSON in the form of the document's `parts`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_session_add_part(
    session: *const RototoonSession,
    part: *const u8,
    part_length: usize,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            let session = handle(session, "session")?;
            let part = text(part, part_length, "part")?;
            session.with(|session| session.add_part(part))
        })
    }
}

/// Removes the part of this name, with its keys, corrections and results.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_session_remove_part(
    session: *const RototoonSession,
    part: *const u8,
    part_length: usize,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            let session = handle(session, "session")?;
            let part = text(part, part_length, "part")?;
            session.with(|session| session.remove_part(part))
        })
    }
}

/// Sets the artist's contour of a part on a frame. `points` has `value_count` numbers: x, y, x, y, ... in pixels. The
/// number of points must be that of the part's other keys. Pins and a fixed centre on the frame are removed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_session_set_key(
    session: *const RototoonSession,
    part: *const u8,
    part_length: usize,
    frame: i32,
    points: *const f64,
    value_count: usize,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            let session = handle(session, "session")?;
            let part = text(part, part_length, "part")?;
            let points = slice(points, value_count, "points")?;
            session.edit(|scene| edit::set_key(scene, part, frame, points))
        })
    }
}

/// Removes the key of a part on a frame. It is an error if there is none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_session_remove_key(
    session: *const RototoonSession,
    part: *const u8,
    part_length: usize,
    frame: i32,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            let session = handle(session, "session")?;
            let part = text(part, part_length, "part")?;
            session.edit(|scene| edit::remove_key(scene, part, frame))
        })
    }
}

/// Fixes control point `point` (counted from 0) of a part at (`x`, `y`) pixels. The frame must be between the part's
/// keys. If the part has a single key, it may be any other frame of the footage.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_session_pin(
    session: *const RototoonSession,
    part: *const u8,
    part_length: usize,
    frame: i32,
    point: i32,
    x: f64,
    y: f64,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            let session = handle(session, "session")?;
            let part = text(part, part_length, "part")?;
            session.edit(|scene| edit::pin(scene, part, frame, point.into(), Point::new(x, y)))
        })
    }
}

/// Releases control point `point` of a part on a frame, or all of them with -1. It is no error if none is fixed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_session_unpin(
    session: *const RototoonSession,
    part: *const u8,
    part_length: usize,
    frame: i32,
    point: i32,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            let session = handle(session, "session")?;
            let part = text(part, part_length, "part")?;
            session.edit(|scene| edit::unpin(scene, part, frame, point.into()))
        })
    }
}

/// Fixes the mean of the control points of a part at (`x`, `y`) pixels. The frame must be between the part's keys. If
/// the part has a single key, it may be any other frame of the footage.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_session_set_center(
    session: *const RototoonSession,
    part: *const u8,
    part_length: usize,
    frame: i32,
    x: f64,
    y: f64,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            let session = handle(session, "session")?;
            let part = text(part, part_length, "part")?;
            session.edit(|scene| edit::set_center(scene, part, frame, Point::new(x, y)))
        })
    }
}

/// Releases the centre of a part on a frame. It is no error if it is not fixed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_session_clear_center(
    session: *const RototoonSession,
    part: *const u8,
    part_length: usize,
    frame: i32,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            let session = handle(session, "session")?;
            let part = text(part, part_length, "part")?;
            session.edit(|scene| edit::clear_center(scene, part, frame))
        })
    }
}

/// Marks a part as not there on the frames from `first` to `last`, or, with `absent` 0, as there again. Where it is absent it
/// has no track and no confidence. Its keys stay, and it is always there on them. The frames must be in the footage.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_session_set_absent(
    session: *const RototoonSession,
    part: *const u8,
    part_length: usize,
    first: i32,
    last: i32,
    absent: i32,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            let session = handle(session, "session")?;
            let part = text(part, part_length, "part")?;
            session.edit(|scene| edit::set_absent(scene, part, [first, last], absent != 0))
        })
    }
}

/// Tracks every part between its keys and stores `tracks` and `confidence` in the document. The default preset tracks a
/// part with a single key outward from that key, as far as the result is reliable. It stores the frames on which it
/// lost the part in `wants_key`.
///
/// `options` is a JSON object of the parameters of the stages "track" and "run" (see `rototoon_parameters`), such as
/// `{"preset": "zhou2011", "threads": 2}`. Each may be left out, and the text may be empty. The number of threads does
/// not change the result. Spans that have not changed since they were last solved are reused. Snapped curves of frames
/// whose track changed are dropped.
///
/// `summary` is JSON: `{"jobs": [{"part", "first", "last", "solved", "termination", "iterations", "initial_cost",
/// "final_cost"}], "ends": [{"part", "frame", "reason"}]}`.
///
/// - `jobs` has one entry for each part and span. `solved` is false if the span was reused. `termination` is one of
///   nothing_to_solve, cost_converged, step_converged, no_descent, iteration_limit, path_chosen.
/// - `ends` has an entry for each end of a single-key part's track that is not an end of the footage. `frame` is the
///   first frame without a track. `reason` is "lost" (the part needs a key on that frame), "cut" (another shot begins
///   there) or "left" (the part left the picture).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_session_track(
    session: *const RototoonSession,
    options: *const u8,
    options_length: usize,
    progress: RototoonProgress,
    user: *mut c_void,
    summary: *mut *mut RototoonText,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            clear(summary, null_mut(), "summary")?;
            let session = handle(session, "session")?;
            let options = text(options, options_length, "options")?;
            let track = |go_on: GoOn<'_>| session.with(|session| session.track(options, go_on));
            let value = RototoonText::new(with_progress(progress, user, track)?);
            give(summary, value);
            Ok(())
        })
    }
}

/// Snaps the contours to the drawn ink and stores `curves` in the document.
///
/// `options` is a JSON object of the parameters of the stages "snap" and "run" (see `rototoon_parameters`). `summary` is
/// JSON: `{"frames": number}`, the number of snapped frames, summed over the parts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_session_snap(
    session: *const RototoonSession,
    options: *const u8,
    options_length: usize,
    progress: RototoonProgress,
    user: *mut c_void,
    summary: *mut *mut RototoonText,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            clear(summary, null_mut(), "summary")?;
            let session = handle(session, "session")?;
            let options = text(options, options_length, "options")?;
            let snap = |go_on: GoOn<'_>| session.with(|session| session.snap(options, go_on));
            let value = RototoonText::new(with_progress(progress, user, snap)?);
            give(summary, value);
            Ok(())
        })
    }
}

/// Returns the track of a part. It has no frames if the part is not tracked.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_session_track_of(
    session: *const RototoonSession,
    part: *const u8,
    part_length: usize,
    track: *mut *mut RototoonTrack,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            clear(track, null_mut(), "track")?;
            let session = handle(session, "session")?;
            let part = text(part, part_length, "part")?;
            let value = session.with(|session| Ok(RototoonTrack::of(session.part(part)?)))?;
            give(track, value);
            Ok(())
        })
    }
}

/// Returns the snapped paths of a part on a frame, one for each segment between control points. There are none if the
/// part is not snapped on that frame.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_session_curves_of(
    session: *const RototoonSession,
    part: *const u8,
    part_length: usize,
    frame: i32,
    curves: *mut *mut RototoonCurves,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            clear(curves, null_mut(), "curves")?;
            let session = handle(session, "session")?;
            let part = text(part, part_length, "part")?;
            let value = session.with(|session| {
                Ok(RototoonCurves::of(session.part(part)?.curves.get(&frame).map_or(&[], Vec::as_slice)))
            })?;
            give(curves, value);
            Ok(())
        })
    }
}

/// Returns the frame on which the next key helps most, as JSON `{"frame", "score"}`. It is `null` if nothing is tracked
/// or if every frame is a key frame or next to one. The score is the sum over the parts of the mean of 1 - confidence,
/// smoothed over time.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_session_weakest_frame(
    session: *const RototoonSession,
    weakest: *mut *mut RototoonText,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            clear(weakest, null_mut(), "weakest")?;
            let session = handle(session, "session")?;
            let value = session.with(|session| Ok(RototoonText::new(session.weakest_frame())))?;
            give(weakest, value);
            Ok(())
        })
    }
}
