//! The exported functions of curve fitting and hidden lines.

use crate::entry::{MAX_BYTES, clear, entry, free, give, handle, slice};
use crate::pool::install;
use crate::status::{Failure, RototoonStatus};
use crate::strokes::{Placing, RototoonGuides, RototoonPieces, Strokes, fitted, pieces};
use crate::text::RototoonText;
use rototoon::tween::hidden;

/// Makes strokes of three arrays.
///
/// # Safety
/// The same as of `slice`, for `stroke_count` + 1 offsets, two coordinates for each point up to the last offset, and
/// `stroke_count` flags.
pub(crate) unsafe fn strokes<'a>(
    offsets: *const i32,
    stroke_count: usize,
    points: *const f64,
    closed: *const u8,
) -> Result<Strokes<'a>, Failure> {
    let count = stroke_count.checked_add(1).filter(|&count| count < MAX_BYTES);
    let count = count.ok_or_else(|| Failure::BadArgument(format!("stroke_count: {stroke_count} is too large")))?;
    // SAFETY: this function's contract.
    unsafe {
        let offsets = slice(offsets, count, "offsets")?;
        let numbers = 2 * usize::try_from(offsets[stroke_count]).unwrap_or(0);
        Ok(Strokes {
            offsets,
            points: slice(points, numbers, "points")?,
            closed: slice(closed, stroke_count, "closed")?,
        })
    }
}

/// Fits uniform quadratic B-splines with few guiding points to strokes.
///
/// - `offsets`: `stroke_count` + 1 numbers, beginning with 0. Stroke `i` has the points `offsets[i]` to `offsets[i + 1]`
///   (excluded).
/// - `points`: two coordinates per point, x and y in pixels.
/// - `closed`: one number per stroke. If it is not 0, the end of the stroke joins its start.
/// - `values`: `channel_count` numbers per point, such as pressure. The guiding points get fitted values.
/// - `tolerance`: a distance in pixels. No point of a stroke is farther from the curve, and no place of the curve is
///   farther from the stroke.
///
/// Strokes without points give no guiding points.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_fit_strokes(
    offsets: *const i32,
    stroke_count: usize,
    points: *const f64,
    closed: *const u8,
    values: *const f64,
    channel_count: usize,
    tolerance: f64,
    guides: *mut *mut RototoonGuides,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            clear(guides, std::ptr::null_mut(), "guides")?;
            let strokes = strokes(offsets, stroke_count, points, closed)?;
            let numbers = (strokes.points.len() / 2).saturating_mul(channel_count);
            let values = slice(values, numbers, "values")?;
            give(guides, install(|| fitted(&strokes, values, channel_count, tolerance))?);
            Ok(())
        })
    }
}

/// Reads the arrays of fitted strokes. They live as long as the handle.
///
/// - `offsets`: one more than there are strokes. Stroke `i` has the guiding points `offsets[i]` to `offsets[i + 1]`
///   (excluded).
/// - `points`: `guide_count` × 2 coordinates, x and y in pixels. The guiding point of a corner occurs twice.
/// - `values`: `guide_count` × `channel_count` numbers, guiding point by guiding point.
/// - `nearest`: for each guiding point the index of the given point that is nearest along the stroke.
/// - `errors`: for each stroke the largest distance between stroke and curve, in pixels.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_guides_read(
    guides: *const RototoonGuides,
    guide_count: *mut usize,
    offsets: *mut *const i32,
    points: *mut *const f64,
    values: *mut *const f64,
    nearest: *mut *const i32,
    errors: *mut *const f64,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract; out parameters are written only after `clear` accepted them.
    unsafe {
        entry(error, || {
            clear(guide_count, 0, "guide_count")?;
            clear(offsets, std::ptr::null(), "offsets")?;
            clear(points, std::ptr::null(), "points")?;
            clear(values, std::ptr::null(), "values")?;
            clear(nearest, std::ptr::null(), "nearest")?;
            clear(errors, std::ptr::null(), "errors")?;
            let guides = handle(guides, "guides")?;
            guide_count.write(guides.nearest.len());
            offsets.write(guides.offsets.as_ptr());
            points.write(guides.points.as_ptr());
            values.write(guides.values.as_ptr());
            nearest.write(guides.nearest.as_ptr());
            errors.write(guides.errors.as_ptr());
            Ok(())
        })
    }
}

/// Frees fitted strokes. Null is allowed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_guides_free(guides: *mut RototoonGuides) {
    // SAFETY: the crate's contract.
    unsafe { free(guides) }
}

/// Cuts strokes where filled strokes in front of them hide them.
///
/// - `offsets`, `points`, `closed`: the strokes, as in `rototoon_fit_strokes`.
/// - `forms`: one number per stroke, the meaning of its points. 0 is a polyline, 1 guiding points of a uniform quadratic
///   B-spline, 2 control points of a chain of quadratic Bezier curves.
/// - `depths`: two numbers per stroke, its layer and its place in the layer. The larger layer is in front. In one layer
///   the larger place is in front. Strokes of equal depth do not hide each other.
/// - `fills`: one number per stroke. 0 means that the stroke is not filled. Strokes of one layer with the same number
///   are the outlines of one filled shape, which has the depth of its rearmost outline.
/// - `border`: a distance in pixels. A line that is no farther from an outline lies on the outline.
/// - `sliver`: a length in pixels. Shorter parts are as visible as the parts around them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_hidden_lines(
    offsets: *const i32,
    stroke_count: usize,
    points: *const f64,
    closed: *const u8,
    forms: *const u8,
    depths: *const i32,
    fills: *const i32,
    border: f64,
    sliver: f64,
    cut: *mut *mut RototoonPieces,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            clear(cut, std::ptr::null_mut(), "pieces")?;
            let strokes = strokes(offsets, stroke_count, points, closed)?;
            let placing = Placing {
                forms: slice(forms, stroke_count, "forms")?,
                depths: slice(depths, 2 * stroke_count, "depths")?,
                fills: slice(fills, stroke_count, "fills")?,
            };
            give(cut, install(|| pieces(&strokes, &placing, &hidden::Options { border, sliver }))?);
            Ok(())
        })
    }
}

/// Reads the arrays of cut strokes. They live as long as the handle. There are `piece_count` pieces, ordered by stroke,
/// and along each stroke.
///
/// - `strokes`: for each piece the index of its stroke.
/// - `hidden`: for each piece a number that is not 0 if the piece is hidden.
/// - `intervals`: for each piece two parameters of its stroke, start and end. The end is beyond the stroke's last
///   parameter if the piece runs over the seam of a closed stroke.
/// - `offsets`: `piece_count` + 1 numbers. Piece `i` has the points `offsets[i]` to `offsets[i + 1]` (excluded). It has
///   none if it is a complete stroke.
/// - `indices`, `weights`: three numbers for each point of a piece. The point is the sum of the three given points of
///   these indices, with these weights.
///
/// All pieces are open. Pieces of polylines are polylines. All other pieces have form 2.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_pieces_read(
    pieces: *const RototoonPieces,
    piece_count: *mut usize,
    strokes: *mut *const i32,
    hidden: *mut *const i32,
    intervals: *mut *const f64,
    offsets: *mut *const i32,
    indices: *mut *const i32,
    weights: *mut *const f64,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract; out parameters are written only after `clear` accepted them.
    unsafe {
        entry(error, || {
            clear(piece_count, 0, "piece_count")?;
            clear(strokes, std::ptr::null(), "strokes")?;
            clear(hidden, std::ptr::null(), "hidden")?;
            clear(intervals, std::ptr::null(), "intervals")?;
            clear(offsets, std::ptr::null(), "offsets")?;
            clear(indices, std::ptr::null(), "indices")?;
            clear(weights, std::ptr::null(), "weights")?;
            let pieces = handle(pieces, "pieces")?;
            piece_count.write(pieces.strokes.len());
            strokes.write(pieces.strokes.as_ptr());
            hidden.write(pieces.hidden.as_ptr());
            intervals.write(pieces.intervals.as_ptr());
            offsets.write(pieces.offsets.as_ptr());
            indices.write(pieces.indices.as_ptr());
            weights.write(pieces.weights.as_ptr());
            Ok(())
        })
    }
}

/// Frees cut strokes. Null is allowed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_pieces_free(pieces: *mut RototoonPieces) {
    // SAFETY: the crate's contract.
    unsafe { free(pieces) }
}
