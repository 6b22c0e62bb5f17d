//! The exported functions that paint line drawings.

use crate::callback::{RototoonProgress, with_progress};
use crate::entry::{MAX_BYTES, clear, entry, free, give, handle, slice, text};
use crate::filled::{RototoonFilled, clicks_by_frame};
use crate::session_abi::RototoonSession;
use crate::status::{Failure, RototoonStatus};
use crate::text::RototoonText;
use crate::work::GoOn;
use std::ffi::c_void;
use std::ptr::{null, null_mut};

/// Replaces the clicks of the painter, `fills` in the document. `frames` has `click_count` frame numbers, in any order.
/// `places` has two numbers for each click, x and y in pixels. `colours` has three, sRGB from 0 to 1, or three NaN for a region that stays without
/// paint.
/// On a frame, clicks keep their order. The painted regions stay until `rototoon_session_fill` runs. Without clicks the
/// field is removed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_session_set_fills(
    session: *const RototoonSession,
    frames: *const i32,
    places: *const f64,
    colours: *const f64,
    click_count: usize,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            let session = handle(session, "session")?;
            // Three times the count must not wrap around.
            if click_count > MAX_BYTES / (3 * size_of::<f64>()) {
                let message = format!("click_count: {click_count} is more than memory can hold");
                return Err(Failure::BadArgument(message));
            }
            let frames = slice(frames, click_count, "frames")?;
            let places = slice(places, 2 * click_count, "places")?;
            let colours = slice(colours, 3 * click_count, "colours")?;
            let fills = clicks_by_frame(frames, places, colours)?;
            session.with(|session| {
                session.set_fills(&fills);
                Ok(())
            })
        })
    }
}

/// Replaces the clicks of the painter by some in the form of the document's `fills`, as JSON: so colours can have names.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_session_set_fills_json(
    session: *const RototoonSession,
    fills: *const u8,
    fills_length: usize,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            let session = handle(session, "session")?;
            let fills = text(fills, fills_length, "fills")?;
            session.with(|session| session.set_fills_json(fills))
        })
    }
}

/// Returns the clicks of the painter as JSON, in the form of the document's `fills`: `[{"frame", "regions": [{"at":
/// [x, y], "colour": [r, g, b], "name"}]}]`. `name` is there if the colour has one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_session_fills(
    session: *const RototoonSession,
    fills: *mut *mut RototoonText,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            clear(fills, null_mut(), "fills")?;
            let session = handle(session, "session")?;
            let value = RototoonText::new(session.with(|session| session.fills())?);
            give(fills, value);
            Ok(())
        })
    }
}

/// Returns the colours of paint that become others as JSON, in the form of the document's `recolours`: `[{"from": {"name", "colour"}, "to": {"name",
/// "colour"}, "first", "last"}]`. `name` is there if the colour has one, and `first` and `last` if the range of frames ends there.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_session_recolours(
    session: *const RototoonSession,
    recolours: *mut *mut RototoonText,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            clear(recolours, null_mut(), "recolours")?;
            let session = handle(session, "session")?;
            let value = RototoonText::new(session.with(|session| session.recolours())?);
            give(recolours, value);
            Ok(())
        })
    }
}

/// Replaces the colours of paint that become others by some in the form of the document's `recolours`, as JSON. `rototoon_session_fill` follows them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_session_set_recolours_json(
    session: *const RototoonSession,
    recolours: *const u8,
    recolours_length: usize,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            let session = handle(session, "session")?;
            let recolours = text(recolours, recolours_length, "recolours")?;
            session.with(|session| session.set_recolours_json(recolours))
        })
    }
}

/// Paints the regions of the footage's line drawings by the clicks in the document's `fills`, and stores `filled` in the
/// document. Work begins on the first frame with clicks; from there colours are carried to the other frames. Clicks on
/// later frames overrule what was carried there.
///
/// `options` is a JSON object, in which all fields may be left out: `sensitivity` to faint ink, 0.1 to 10; `leave_out`, as for
/// `rototoon_session_trace`; `confidence`,
/// 0 to 1, below which a region stays unpainted; `frames`, a list of the first and the last frame; `threads`, 0 for one
/// per core. Regions of frames outside of `frames` stay in the document. It is an error if there is no click.
///
/// `filled` has the regions of all frames, as `rototoon_session_filled` gives them. `report` is JSON: `{"frames":
/// [{"frame", "regions", "doubtful", "related", "bare"}], "missed": [{"frame", "click"}], "overruled": [{"frame", "click"}], "leaking":
/// [{"frame", "click", "parted", "gap", "width", "size"}]}`.
///
/// - `frames` are the frames that were looked at. `doubtful` is the number of regions whose colour is probably wrong.
///   `related` is false if no painted drawing shows the same; such a frame stays unpainted. `bare` is true if the drawing has hardly any
///   regions for what was clicked: its lines were probably not found.
/// - `missed` are the clicks that lie on a line or outside of the picture, and so paint nothing. `click` is the index
///   among the clicks of its frame.
/// - `overruled` are the clicks that paint nothing because a later click has given their region another colour.
/// - `leaking` are the clicks from which a gap leads to the edge of the picture. `gap` is its place and `width` how wide it is, `size` are width and
///   height of what the click paints, all in pixels. If `parted` is true, the gap was closed; otherwise the region is in doubt.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_session_fill(
    session: *const RototoonSession,
    options: *const u8,
    options_length: usize,
    progress: RototoonProgress,
    user: *mut c_void,
    filled: *mut *mut RototoonFilled,
    report: *mut *mut RototoonText,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            clear(filled, null_mut(), "filled")?;
            clear(report, null_mut(), "report")?;
            let session = handle(session, "session")?;
            let options = text(options, options_length, "options")?;
            let fill = |go_on: GoOn<'_>| session.with(|session| session.fill(options, go_on));
            let (regions, told) = with_progress(progress, user, fill)?;
            give(filled, regions);
            give(report, RototoonText::new(told));
            Ok(())
        })
    }
}

/// Returns the painted regions of the document. There are none if it was not painted.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_session_filled(
    session: *const RototoonSession,
    filled: *mut *mut RototoonFilled,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            clear(filled, null_mut(), "filled")?;
            let session = handle(session, "session")?;
            let value = session.with(|session| session.filled())?;
            give(filled, value);
            Ok(())
        })
    }
}

/// Reads the arrays of painted regions. They live as long as the handle.
///
/// - `frames`: `frame_count` frame numbers in rising order.
/// - `region_offsets`: `frame_count` + 1 numbers. Frame `f` has the regions `region_offsets[f]` to
///   `region_offsets[f + 1]` (excluded). Later ones lie over earlier ones.
/// - `tracks`: the number of each region. It is the same on all frames, and occurs once on a frame.
/// - `colours`: three numbers for each region, sRGB from 0 to 1.
/// - `confidence`: for each region the probability, 0 to 1, that its colour is right. It is 1 where a painter clicked.
/// - `doubtful`: for each region 1 if its colour is probably wrong, otherwise 0.
/// - `outline_offsets`: one more than there are regions. Region `i` has the outlines `outline_offsets[i]` to
///   `outline_offsets[i + 1]` (excluded). The first is its own; the others are those of its holes.
/// - `point_offsets`: one more than there are outlines. Outline `k` has the points `point_offsets[k]` to
///   `point_offsets[k + 1]` (excluded). The last one joins the first.
/// - `points`: two coordinates for each point, x and y in pixels.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_filled_read(
    filled: *const RototoonFilled,
    frame_count: *mut usize,
    frames: *mut *const i32,
    region_offsets: *mut *const i32,
    tracks: *mut *const i32,
    colours: *mut *const f64,
    confidence: *mut *const f64,
    doubtful: *mut *const i32,
    outline_offsets: *mut *const i32,
    point_offsets: *mut *const i32,
    points: *mut *const f64,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract; out parameters are written only after `clear` accepted them.
    unsafe {
        entry(error, || {
            clear(frame_count, 0, "frame_count")?;
            for (out, name) in [
                (frames, "frames"),
                (region_offsets, "region_offsets"),
                (tracks, "tracks"),
                (doubtful, "doubtful"),
                (outline_offsets, "outline_offsets"),
                (point_offsets, "point_offsets"),
            ] {
                clear(out, null(), name)?;
            }
            for (out, name) in [(colours, "colours"), (confidence, "confidence"), (points, "points")] {
                clear(out, null(), name)?;
            }
            let filled = handle(filled, "filled")?;
            frame_count.write(filled.frames.len());
            frames.write(filled.frames.as_ptr());
            region_offsets.write(filled.region_offsets.as_ptr());
            tracks.write(filled.tracks.as_ptr());
            colours.write(filled.colours.as_ptr());
            confidence.write(filled.confidence.as_ptr());
            doubtful.write(filled.doubtful.as_ptr());
            outline_offsets.write(filled.outline_offsets.as_ptr());
            point_offsets.write(filled.point_offsets.as_ptr());
            points.write(filled.points.as_ptr());
            Ok(())
        })
    }
}

/// Returns the names of the colours of all regions as JSON: a list with a text or null for each region.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_filled_names(
    filled: *const RototoonFilled,
    names: *mut *mut RototoonText,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            clear(names, null_mut(), "names")?;
            let filled = handle(filled, "filled")?;
            give(names, RototoonText::new(serde_json::json!(filled.names).to_string()));
            Ok(())
        })
    }
}

/// Frees painted regions. Null is allowed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_filled_free(filled: *mut RototoonFilled) {
    // SAFETY: the crate's contract.
    unsafe { free(filled) }
}
