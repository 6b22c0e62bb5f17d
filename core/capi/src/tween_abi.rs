//! Drawings on key frames: matching, and drawing between them.

use crate::callback::{RototoonProgress, with_progress};
use crate::entry::{MAX_BYTES, clear, entry, free, give, handle, slice, text};
use crate::sheet::{Drawings, RototoonInBetweens, RototoonMatches, in_betweens, matches};
use crate::status::{Failure, RototoonStatus};
use crate::strokes_abi::strokes;
use crate::text::RototoonText;
use std::ffi::c_void;
use std::ptr::{null, null_mut};

/// The array, or nothing where the pointer is null.
///
/// # Safety
/// As `slice`.
unsafe fn optional<'a, T>(data: *const T, length: usize, name: &str) -> Result<&'a [T], Failure> {
    // SAFETY: this function's contract.
    if data.is_null() { Ok(&[]) } else { unsafe { slice(data, length, name) } }
}

/// The drawings of flat arrays.
///
/// # Safety
/// As `strokes`; three colours and two labels for each stroke or null, `drawing_count` + 1 drawings, `drawing_count` frames
/// or null, two numbers for each of `by_hand_count` pairs.
#[allow(clippy::too_many_arguments)]
unsafe fn drawings<'a>(
    offsets: *const i32,
    stroke_count: usize,
    points: *const f64,
    closed: *const u8,
    colours: *const f64,
    labels: *const i32,
    drawings: *const i32,
    drawing_count: usize,
    frames: *const i32,
    by_hand: *const i32,
    by_hand_count: usize,
) -> Result<Drawings<'a>, Failure> {
    let bounds = drawing_count.checked_add(1).filter(|&count| count < MAX_BYTES);
    let bounds = bounds.ok_or_else(|| Failure::BadArgument(format!("drawing_count: {drawing_count} is too large")))?;
    // SAFETY: this function's contract.
    unsafe {
        Ok(Drawings {
            strokes: strokes(offsets, stroke_count, points, closed)?,
            colours: optional(colours, stroke_count.saturating_mul(3), "colours")?,
            labels: optional(labels, stroke_count.saturating_mul(2), "labels")?,
            drawings: slice(drawings, bounds, "drawings")?,
            frames: optional(frames, drawing_count, "frames")?,
            by_hand: slice(by_hand, by_hand_count.saturating_mul(2), "by_hand")?,
        })
    }
}

/// Finds which stroke of a drawing is which of the next one, for all neighbours of several drawings.
///
/// The strokes of all drawings are given as to `rototoon_fit_strokes`, one drawing after the other: drawing `d` has the
/// strokes `drawings[d]` to `drawings[d + 1]` (excluded), from behind to the front; `drawings` has `drawing_count` + 1
/// numbers. `colours` are three numbers for each stroke (sRGB, 0 to 1; NaN where it has none), `labels` two (material and
/// layer; -1 where it has none); both may be null. `by_hand` are `by_hand_count` pairs that are kept: a stroke and its
/// counterpart in the next drawing, by their numbers among all strokes; with -1 in the place of either the other one has
/// none. `options` is a JSON object: `max_cost`, `max_turn`, `max_scale`, `threads`; all may be left out.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_match_strokes(
    offsets: *const i32,
    stroke_count: usize,
    points: *const f64,
    closed: *const u8,
    colours: *const f64,
    labels: *const i32,
    drawings_of: *const i32,
    drawing_count: usize,
    by_hand: *const i32,
    by_hand_count: usize,
    options: *const u8,
    options_length: usize,
    progress: RototoonProgress,
    user: *mut c_void,
    found: *mut *mut RototoonMatches,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            clear(found, null_mut(), "matches")?;
            let given = drawings(
                offsets,
                stroke_count,
                points,
                closed,
                colours,
                labels,
                drawings_of,
                drawing_count,
                null(),
                by_hand,
                by_hand_count,
            )?;
            let options = text(options, options_length, "options")?;
            give(found, with_progress(progress, user, |go_on| matches(&given, options, go_on))?);
            Ok(())
        })
    }
}

/// The arrays of matches, which live as long as the handle. The drawings `d` and `d` + 1 have the rows `offsets[d]` to
/// `offsets[d + 1]` (excluded; none where they were not asked for). A row has four numbers in `rows`: kind, stroke of the
/// earlier drawing, stroke of the later one (by their numbers among all, -1 for none), and flags; and two in `values`.
/// Kinds: 0 a pair, 1 the later stroke is a piece of the earlier one, 2 the earlier is a piece of the later one, 3 vanished,
/// 4 appeared. Flags: 1 the later stroke is walked backwards, 2 made by hand. Values: of closed strokes the share of the
/// later one's length at which the first point of the earlier one lies; how sure the pair is, 0 to 1. Pieces stand in the
/// order along the whole.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_matches_read(
    matches: *const RototoonMatches,
    span_count: *mut usize,
    offsets: *mut *const i32,
    rows: *mut *const i32,
    values: *mut *const f64,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract; out parameters are written only after `clear` accepted them.
    unsafe {
        entry(error, || {
            clear(span_count, 0, "span_count")?;
            clear(offsets, null(), "offsets")?;
            clear(rows, null(), "rows")?;
            clear(values, null(), "values")?;
            let matches = handle(matches, "matches")?;
            span_count.write(matches.offsets.len() - 1);
            offsets.write(matches.offsets.as_ptr());
            rows.write(matches.rows.as_ptr());
            values.write(matches.values.as_ptr());
            Ok(())
        })
    }
}

/// Frees matches; null is allowed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_matches_free(matches: *mut RototoonMatches) {
    // SAFETY: the crate's contract.
    unsafe { free(matches) }
}

/// Draws between drawings on key frames, all wanted frames in one call.
///
/// The drawings are given as to `rototoon_match_strokes`; drawing `d` lies on `frames[d]`, which rise. `options` is a JSON
/// object, in which all but `spans` may be left out: `spans`, a list of `{"key": d, "frames": [...]}`, frames between
/// drawing `d` and the next one; `spacing`, by drawing how the movement to the next one runs, as documents write it
/// (`"smooth"`, `"linear"`, `"ease_in"`, ..., a curve, or a chart); `corners`, the drawings at which velocities do not join;
/// `arcs` (0 to 1), `rigid`, `contacts`, `rest`; `leaving`, what strokes do that only one of two drawings has: `"grow"`,
/// `"fade"` or `{"leave": [width, height]}`; `pegs` as documents write them, with `hung`, the name of the peg of each stroke,
/// or null; `captured`, contours whose movement is known: a list of `{"closed": bool, "first": frame, "contours": [...]}`, the
/// points on each frame from the first on, which strokes that lie on them follow; and the options of
/// `rototoon_match_strokes`. Without pegs these are found. A span depends on the drawings at its ends, on what was captured
/// between them, and if its spacing is smooth also on the drawings beside them, on nothing else.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_draw_in_betweens(
    offsets: *const i32,
    stroke_count: usize,
    points: *const f64,
    closed: *const u8,
    colours: *const f64,
    labels: *const i32,
    drawings_of: *const i32,
    drawing_count: usize,
    frames: *const i32,
    by_hand: *const i32,
    by_hand_count: usize,
    options: *const u8,
    options_length: usize,
    progress: RototoonProgress,
    user: *mut c_void,
    found: *mut *mut RototoonMatches,
    drawn: *mut *mut RototoonInBetweens,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            clear(found, null_mut(), "matches")?;
            clear(drawn, null_mut(), "in_betweens")?;
            let frames = slice(frames, drawing_count, "frames")?;
            let given = drawings(
                offsets,
                stroke_count,
                points,
                closed,
                colours,
                labels,
                drawings_of,
                drawing_count,
                frames.as_ptr(),
                by_hand,
                by_hand_count,
            )?;
            let options = text(options, options_length, "options")?;
            let (between, pairs) = with_progress(progress, user, |go_on| in_betweens(&given, options, go_on))?;
            give(found, pairs);
            give(drawn, between);
            Ok(())
        })
    }
}

/// The arrays of in-betweens, which live as long as the handle. There are `span_count` spans, as they were asked. Span `s`
/// has the frames `frame_offsets[s]` to `frame_offsets[s + 1]` (excluded), whose share of the way is in `shares`, and draws
/// the strokes `stroke_offsets[s]` to `stroke_offsets[s + 1]` on all of them, from behind to the front. A stroke has three
/// numbers in `strokes`: that of the earlier and of the later drawing (-1 for none), and flags (1 closed, 2 only a part of the
/// earlier one, 4 only a part of the later one). Stroke `i` has `point_offsets[i + 1] - point_offsets[i]` points on each
/// frame. Each point of it has four numbers in `indices`, the given points of the earlier and of the later drawing between
/// which its place lies, and in `weights` the weights of the second of either two. `points` are x, y by span, frame and
/// point, `opacities` by span, frame and stroke.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_in_betweens_read(
    in_betweens: *const RototoonInBetweens,
    span_count: *mut usize,
    point_count: *mut usize,
    frame_offsets: *mut *const i32,
    shares: *mut *const f64,
    stroke_offsets: *mut *const i32,
    strokes: *mut *const i32,
    point_offsets: *mut *const i32,
    indices: *mut *const i32,
    weights: *mut *const f64,
    points: *mut *const f64,
    opacities: *mut *const f64,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract; out parameters are written only after `clear` accepted them.
    unsafe {
        entry(error, || {
            clear(span_count, 0, "span_count")?;
            clear(point_count, 0, "point_count")?;
            for (out, name) in [
                (frame_offsets, "frame_offsets"),
                (stroke_offsets, "stroke_offsets"),
                (strokes, "strokes"),
                (point_offsets, "point_offsets"),
                (indices, "indices"),
            ] {
                clear(out, null(), name)?;
            }
            for (out, name) in [(shares, "shares"), (weights, "weights"), (points, "points"), (opacities, "opacities")]
            {
                clear(out, null(), name)?;
            }
            let found = handle(in_betweens, "in_betweens")?;
            span_count.write(found.frame_offsets.len() - 1);
            point_count.write(found.points.len() / 2);
            frame_offsets.write(found.frame_offsets.as_ptr());
            shares.write(found.shares.as_ptr());
            stroke_offsets.write(found.stroke_offsets.as_ptr());
            strokes.write(found.strokes.as_ptr());
            point_offsets.write(found.point_offsets.as_ptr());
            indices.write(found.indices.as_ptr());
            weights.write(found.weights.as_ptr());
            points.write(found.points.as_ptr());
            opacities.write(found.opacities.as_ptr());
            Ok(())
        })
    }
}

/// Frees in-betweens; null is allowed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_in_betweens_free(in_betweens: *mut RototoonInBetweens) {
    // SAFETY: the crate's contract.
    unsafe { free(in_betweens) }
}
