//! The exported functions that track and snap a session's contours, and give the results.

use crate::callback::{RototoonProgress, with_progress};
use crate::entry::{clear, entry, give, handle, text};
use crate::handles::{RototoonCurves, RototoonTrack};
use crate::session_abi::RototoonSession;
use crate::status::RototoonStatus;
use crate::text::RototoonText;
use crate::work::GoOn;
use std::ffi::c_void;
use std::ptr::null_mut;

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
/// "final_cost"}], "ends": [{"part", "frame", "reason"}], "exchanges": [{"parts": [name, name], "frames": [frame]}],
/// "unseen": [{"part", "frames": [frame]}], "footage_changed"}`.
///
/// - `jobs` has one entry for each part and span. `solved` is false if the span was reused. `termination` is one of
///   nothing_to_solve, cost_converged, step_converged, no_descent, iteration_limit, path_chosen.
/// - `ends` has an entry for each end of a single-key part's track that is not an end of the footage. `frame` is the
///   first frame without a track. `reason` is "lost" (the part needs a key on that frame), "cut" (another shot begins
///   there) or "left" (the part left the picture).
/// - `exchanges` has an entry for each two parts that look alike and may have changed places, with the frames on which nothing says which is which.
///   `rototoon_outcomes` has words for it.
/// - `unseen` has an entry for each part that can probably not be seen on some frames, because nearer parts or the picture's edge hide it. Only a person
///   knows; the document's `absent` says so.
/// - `footage_changed` is true if files of the footage have changed since this session read them. Then no span was reused that was solved with the old ones.
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
/// or if every frame is a key frame or next to one. The score is the sum over the parts of what the mean confidence lacks to that of a sure contour, as a share of it,
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

/// Returns the parts that can probably not be seen on some frames, by the tracks that the document has: JSON `[{"part", "frames": [frame]}]`, as in the summary of
/// `rototoon_session_track`. So documents that were tracked elsewhere can be asked too.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_session_unseen(
    session: *const RototoonSession,
    unseen: *mut *mut RototoonText,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            clear(unseen, null_mut(), "unseen")?;
            let session = handle(session, "session")?;
            let value = session.with(|session| Ok(RototoonText::new(session.unseen())))?;
            give(unseen, value);
            Ok(())
        })
    }
}
