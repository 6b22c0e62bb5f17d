//! The exported functions of line tracing.

use crate::callback::{RototoonProgress, with_progress};
use crate::entry::{clear, entry, free, give, handle, text};
use crate::session_abi::RototoonSession;
use crate::status::RototoonStatus;
use crate::text::RototoonText;
use crate::traced::RototoonTraced;
use crate::work::GoOn;
use std::ffi::c_void;
use std::ptr::{null, null_mut};

/// Traces the lines of the footage as strokes, the same strokes on every frame, and stores `traced` in the document.
///
/// Work begins on the first drawing of the document's `drawings`. Its strokes are carried to the other frames. Frames
/// with a drawing keep the strokes of that drawing, in their order. Without drawings the first frame is traced; so it is with them if it was
/// traced for itself before, and the frames up to the first drawing are bound to both. Where the document has its strokes in `traced`, that is known.
///
/// `options` is a JSON object, in which all fields may be left out: `style`, "auto", "clean" or "rough" (lines are
/// sketched with several strokes, which become one); `sensitivity` to faint ink, 0.1 to 10; `leave_out`, a list of the
/// colours of pencils whose lines are left out, three numbers each, sRGB from 0 to 1 as they look on white paper; `frames`, a list of the
/// first and the last frame; `keep_first`, true if the first frame was traced for itself before, and stays so; `threads`, 0 for one per core. Strokes of frames outside of `frames` stay in the document.
///
/// `traced` has the strokes of all frames, as `rototoon_session_traced` gives them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_session_trace(
    session: *const RototoonSession,
    options: *const u8,
    options_length: usize,
    progress: RototoonProgress,
    user: *mut c_void,
    traced: *mut *mut RototoonTraced,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            clear(traced, null_mut(), "traced")?;
            let session = handle(session, "session")?;
            let options = text(options, options_length, "options")?;
            let trace = |go_on: GoOn<'_>| session.with(|session| session.trace(options, go_on));
            give(traced, with_progress(progress, user, trace)?);
            Ok(())
        })
    }
}

/// Returns the traced strokes of the document. There are none if it was not traced.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_session_traced(
    session: *const RototoonSession,
    traced: *mut *mut RototoonTraced,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            clear(traced, null_mut(), "traced")?;
            let session = handle(session, "session")?;
            let value = session.with(|session| session.traced())?;
            give(traced, value);
            Ok(())
        })
    }
}

/// Reads the arrays of traced strokes. They live as long as the handle.
///
/// - `frames`: `frame_count` frame numbers in rising order.
/// - `stroke_offsets`: `frame_count` + 1 numbers. Frame `f` has the strokes `stroke_offsets[f]` to
///   `stroke_offsets[f + 1]` (excluded), from behind to the front.
/// - `tracks`: the number of each stroke. It is the same on all frames, and occurs once on a frame.
/// - `closed`: for each stroke 1 if its last point joins its first, otherwise 0.
/// - `colours`: three numbers for each stroke, sRGB from 0 to 1; NaN if it has no colour.
/// - `point_offsets`: one more than there are strokes. Stroke `i` has the points `point_offsets[i]` to
///   `point_offsets[i + 1]` (excluded).
/// - `points`: two coordinates for each point, x and y in pixels.
/// - `widths`: the width of the line at each point in pixels; NaN if the stroke has no widths.
/// - `confidence`: for each stroke the probability, 0 to 1, that it is the stroke of its number. It is 1 if that is beyond doubt.
///   `rototoon_outcomes` tells which values are sure, doubtful and lost.
/// - `fills`: for each stroke 1 if what is inside is filled with its colour, such as a solid black, otherwise 0. Only closed
///   strokes are filled. A fill without widths has no line around it. [`rototoon_traced_fill_colours`] gives fills below lines.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_traced_read(
    traced: *const RototoonTraced,
    frame_count: *mut usize,
    frames: *mut *const i32,
    stroke_offsets: *mut *const i32,
    tracks: *mut *const i32,
    closed: *mut *const i32,
    colours: *mut *const f64,
    point_offsets: *mut *const i32,
    points: *mut *const f64,
    widths: *mut *const f64,
    confidence: *mut *const f64,
    fills: *mut *const i32,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract; out parameters are written only after `clear` accepted them.
    unsafe {
        entry(error, || {
            clear(frame_count, 0, "frame_count")?;
            for (out, name) in [
                (frames, "frames"),
                (stroke_offsets, "stroke_offsets"),
                (tracks, "tracks"),
                (closed, "closed"),
                (point_offsets, "point_offsets"),
                (fills, "fills"),
            ] {
                clear(out, null(), name)?;
            }
            for (out, name) in
                [(colours, "colours"), (points, "points"), (widths, "widths"), (confidence, "confidence")]
            {
                clear(out, null(), name)?;
            }
            let traced = handle(traced, "traced")?;
            frame_count.write(traced.frames.len());
            frames.write(traced.frames.as_ptr());
            stroke_offsets.write(traced.stroke_offsets.as_ptr());
            tracks.write(traced.tracks.as_ptr());
            closed.write(traced.closed.as_ptr());
            colours.write(traced.colours.as_ptr());
            point_offsets.write(traced.point_offsets.as_ptr());
            points.write(traced.points.as_ptr());
            widths.write(traced.widths.as_ptr());
            confidence.write(traced.confidence.as_ptr());
            fills.write(traced.fills.as_ptr());
            Ok(())
        })
    }
}

/// Reads the colours of the fills below the lines of traced strokes. `fill_colours` has three numbers for each stroke, sRGB from 0 to 1, in the
/// order of `rototoon_traced_read`, and lives as long as the handle. They are NaN where no fill is below the line.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_traced_fill_colours(
    traced: *const RototoonTraced,
    stroke_count: *mut usize,
    fill_colours: *mut *const f64,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract; out parameters are written only after `clear` accepted them.
    unsafe {
        entry(error, || {
            clear(stroke_count, 0, "stroke_count")?;
            clear(fill_colours, null(), "fill_colours")?;
            let traced = handle(traced, "traced")?;
            stroke_count.write(traced.tracks.len());
            fill_colours.write(traced.fill_colours.as_ptr());
            Ok(())
        })
    }
}

/// Frees traced strokes. Null is allowed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_traced_free(traced: *mut RototoonTraced) {
    // SAFETY: the crate's contract.
    unsafe { free(traced) }
}
