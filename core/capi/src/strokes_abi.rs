//! Strokes of drawings: fitting and hidden lines.

use crate::entry::{MAX_BYTES, clear, entry, free, give, handle, slice};
use crate::status::{Failure, RototoonStatus};
use crate::strokes::{Placing, RototoonGuides, RototoonPieces, Strokes, fitted, pieces};
use crate::text::RototoonText;
use rototoon::tween::hidden;

/// The strokes of three arrays.
///
/// # Safety
/// As `slice`: `stroke_count` + 1 offsets, two coordinates for each point that they count, `stroke_count` flags.
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

/// Fits quadratic B-splines with few guiding points to strokes. Stroke `i` has the points `offsets[i]` to `offsets[i + 1]`
/// (excluded) of `points` (x, y in pixels); its end joins its start where `closed[i]` is not 0. Each point carries
/// `channel_count` numbers of `values`, which the guides carry on. No point of a stroke is farther than `tolerance` pixels
/// from its curve, and no place of the curve farther than that from the stroke. Strokes without points give no guides.
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
            give(guides, fitted(&strokes, values, channel_count, tolerance)?);
            Ok(())
        })
    }
}

/// The arrays of fitted strokes, which live as long as the handle: stroke `i` has the guiding points `offsets[i]` to
/// `offsets[i + 1]` (excluded) of `points` (x, y in pixels), those of corners twice; `values` are what they carry;
/// `nearest` the given point that is nearest to each; `errors` the largest distance of each stroke. There are
/// `guide_count` guides.
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

/// Frees fitted strokes; null is allowed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_guides_free(guides: *mut RototoonGuides) {
    // SAFETY: the crate's contract.
    unsafe { free(guides) }
}

/// Cuts strokes where filled strokes in front hide them. Strokes are given as to `rototoon_fit_strokes`. `forms[i]` says
/// what the points of stroke `i` mean: 0 a polyline, 1 guiding points of a uniform quadratic B-spline, 2 control points of
/// a chain of quadratic Bezier curves. `depths` has two numbers for each stroke, layer and stroke: of two layers the
/// larger is in front, in a layer the larger stroke; equal ones do not hide each other. `fills[i]` is 0 where a stroke is not filled;
/// strokes of a layer with the same number fill one shape. What is nearer to an outline than `border` pixels lies on it;
/// parts shorter than `sliver` pixels take after their surroundings.
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
            give(cut, pieces(&strokes, &placing, &hidden::Options { border, sliver })?);
            Ok(())
        })
    }
}

/// The arrays of cut strokes, which live as long as the handle. There are `piece_count` parts, in the order of the strokes
/// and along each: part `i` belongs to the stroke `strokes[i]`, is hidden where `hidden[i]` is not 0, and reaches from
/// parameter `intervals[2 i]` to `intervals[2 i + 1]` (over the end of a closed stroke's last piece if it runs over its
/// seam). Its points are `offsets[i]` to `offsets[i + 1]` (excluded), none where it is a whole stroke; each is the sum of
/// three given points by `indices` with `weights`. Parts of polylines are polylines, all others are of form 2; all are open.
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

/// Frees cut strokes; null is allowed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_pieces_free(pieces: *mut RototoonPieces) {
    // SAFETY: the crate's contract.
    unsafe { free(pieces) }
}
