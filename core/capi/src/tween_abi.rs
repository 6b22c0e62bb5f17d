//! The exported functions of stroke matching and in-betweens.

use crate::callback::{RototoonProgress, with_progress};
use crate::entry::{MAX_BYTES, clear, entry, free, give, handle, slice, text};
use crate::sheet::{Drawings, RototoonInBetweens, RototoonMatches, in_betweens, matches};
use crate::status::{Failure, RototoonStatus};
use crate::strokes_abi::strokes;
use crate::text::RototoonText;
use std::ffi::c_void;
use std::ptr::{null, null_mut};

/// The array, or an empty one if the pointer is null.
///
/// # Safety
/// The same as of `slice`.
unsafe fn optional<'a, T>(data: *const T, length: usize, name: &str) -> Result<&'a [T], Failure> {
    // SAFETY: this function's contract.
    if data.is_null() { Ok(&[]) } else { unsafe { slice(data, length, name) } }
}

/// Makes drawings of flat arrays.
///
/// # Safety
/// The same as of `strokes`, and: `colours` has three numbers per stroke or is null, `labels` two per stroke or is null,
/// `drawings` has `drawing_count` + 1 numbers, `frames` has `drawing_count` or is null, and `by_hand` has two numbers for
/// each of `by_hand_count` pairs.
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

/// Matches the strokes of each drawing with the strokes of the next drawing.
///
/// - `offsets`, `points`, `closed`: the strokes of all drawings, one drawing after the other, as in
///   `rototoon_fit_strokes`. Stroke numbers below count all of them.
/// - `colours`: three numbers per stroke, sRGB from 0 to 1, or NaN if it has no colour. The pointer may be null.
/// - `labels`: two numbers per stroke, its material and its layer, or -1 if it has none. The pointer may be null.
/// - `drawings_of`: `drawing_count` + 1 numbers. Drawing `d` has the strokes `drawings_of[d]` to `drawings_of[d + 1]`
///   (excluded), from behind to the front.
/// - `by_hand`: `by_hand_count` pairs that are kept: a stroke and its counterpart in the next drawing. With -1 as
///   counterpart, or as stroke, the other one has no counterpart.
/// - `options`: a JSON object, in which all fields may be left out. `max_cost` is the cost from which on a stroke has no
///   counterpart. `max_turn` (radians) and `max_scale` (a factor) limit the movement of the entire drawing. `threads` is
///   the number of threads, 0 for one per core.
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

/// Reads the arrays of matches. They live as long as the handle. There are `span_count` spans. A span is two neighbouring
/// drawings.
///
/// - `offsets`: `span_count` + 1 numbers. The drawings `d` and `d` + 1 have the rows `offsets[d]` to `offsets[d + 1]`
///   (excluded). They have none if they did not have to be matched.
/// - `rows`: four numbers per row: kind, stroke of the earlier drawing, stroke of the later drawing, flags. Strokes are
///   numbered among all strokes, -1 is none. Kinds are: 0 a pair; 1 the later stroke is a piece of the earlier one; 2
///   the earlier stroke is a piece of the later one; 3 the earlier stroke has no counterpart; 4 the later stroke has
///   none; 5 both are pieces of one line, cut in other places, and share a stretch of it. Flags are: 1 the later stroke runs backwards; 2 the pair was made by hand.
/// - `values`: two numbers per row. The first one is for closed strokes: the share of the later stroke's length at which
///   the first point of the earlier one is. The second one is the confidence of the pair, 0 to 1.
///
/// The pieces of a stroke are in their order along it.
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

/// Frees matches. Null is allowed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_matches_free(matches: *mut RototoonMatches) {
    // SAFETY: the crate's contract.
    unsafe { free(matches) }
}

/// Makes in-betweens: the drawings on frames between key drawings, all of them in one call.
///
/// The arguments are those of `rototoon_match_strokes`, and `frames`: the frame of each drawing, in rising order.
/// `options` is a JSON object, in which all fields may be left out:
///
/// - `spans`: a list of `{"key": d, "frames": [...]}`, the frames to draw between drawing `d` and the next one. Without
///   it nothing is drawn.
/// - `spacing`: for each drawing the spacing of the movement to the next one, in the form of documents: `"smooth"`,
///   `"linear"`, `"ease_in"`, ..., a curve, or a chart.
/// - `corners`: the drawings at which the velocity may jump.
/// - `arcs`: the strength of arcs, from 0 (straight ways) to 1 (turns about the fixed point of a movement).
/// - `rigid`: whether shapes change as rigidly as possible. `contacts`: whether contacts between strokes are kept.
/// - `rest`: whether everything rests before the first and after the last drawing. Otherwise it moves on with constant
///   speed.
/// - `leaving`: what a stroke does that only one of two drawings has: `"grow"`, `"fade"` or `{"leave": [width, height]}`
///   with the size of the picture.
/// - `pegs`: pegs in the form of documents. `hung`: for each stroke the name of its peg, or null. Strokes without a peg
///   get one that is found.
/// - `captured`: contours whose movement is known, a list of `{"closed": bool, "first": frame, "contours": [...]}`. They
///   have the points on each frame, beginning with frame `first`. Strokes on such a contour follow it.
/// - The options of `rototoon_match_strokes`.
///
/// A span depends on the drawings at its ends and on the captured contours between them. If its spacing is smooth, it
/// also depends on the drawing before and the drawing after these. It depends on nothing else.
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

/// Reads the arrays of in-betweens. They live as long as the handle. There are `span_count` spans, in the order of the
/// option `spans`.
///
/// - `frame_offsets`: `span_count` + 1 numbers. Span `s` has the frames `frame_offsets[s]` to `frame_offsets[s + 1]`
///   (excluded).
/// - `shares`: for each frame the share of the way between the two drawings, 0 to 1.
/// - `stroke_offsets`: `span_count` + 1 numbers. Every frame of span `s` has the strokes `stroke_offsets[s]` to
///   `stroke_offsets[s + 1]` (excluded), from behind to the front.
/// - `strokes`: three numbers per stroke: the stroke of the earlier drawing, the stroke of the later drawing (-1 for
///   none), and flags. Flags are: 1 closed; 2 only a part of the earlier stroke; 4 only a part of the later stroke.
/// - `point_offsets`: one more than there are strokes. Stroke `i` has `point_offsets[i + 1] - point_offsets[i]` points
///   on each frame.
/// - `indices`: four numbers for each point of a stroke: two given points of the earlier drawing and two of the later
///   drawing. The point comes from a place between the two of each drawing.
/// - `weights`: two numbers for each point of a stroke: the weight of the second of the two points, for each drawing.
/// - `points`: `point_count` × 2 coordinates, x and y in pixels, ordered by span, frame, stroke and point.
/// - `opacities`: numbers from 0 to 1, ordered by span, frame and stroke.
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

/// Reads which spans of in-betweens are held. `held` has one number for each span, in the order of the option `spans`, and
/// lives as long as the handle. The number is 1 where no movement between the two drawings can be believed, so that all
/// frames show the earlier one; else it is 0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_in_betweens_held(
    in_betweens: *const RototoonInBetweens,
    span_count: *mut usize,
    held: *mut *const u8,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract; out parameters are written only after `clear` accepted them.
    unsafe {
        entry(error, || {
            clear(span_count, 0, "span_count")?;
            clear(held, null(), "held")?;
            let found = handle(in_betweens, "in_betweens")?;
            span_count.write(found.held.len());
            held.write(found.held.as_ptr());
            Ok(())
        })
    }
}

/// Frees in-betweens. Null is allowed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_in_betweens_free(in_betweens: *mut RototoonInBetweens) {
    // SAFETY: the crate's contract.
    unsafe { free(in_betweens) }
}
