//! The exported function that suggests a breakdown.

use crate::breakdown::suggested;
use crate::callback::{RototoonProgress, with_progress};
use crate::entry::{MAX_BYTES, clear, entry, give, slice, text};
use crate::sheet::Drawings;
use crate::status::{Failure, RototoonStatus};
use crate::strokes_abi::strokes;
use crate::text::RototoonText;
use std::ffi::c_void;
use std::ptr::null_mut;

/// Suggests the frame on which a breakdown, one more drawing between two keys, helps most: where the in-between is
/// farthest from its picture, or without pictures in the middle of the span that moves most.
///
/// - `offsets`, `points`, `closed`, `drawings_of`, `frames`: keys and in-betweens in time order, as of
///   `rototoon_draw_in_betweens`.
/// - `options`: a JSON object. `keys` are the frames of the keys. `footage` is the footage in the form of documents, on
///   whose frames and pixels the drawings are; it may be null or left out. `folder` is the folder of a relative pattern.
///   `threads` is the number of threads, 0 for one per core. Frames without a picture file are not judged.
///
/// `suggestion` is JSON: `null` where nothing lies between two keys, or `{"frame", "first", "last", "by", "distance",
/// "keys", "foreign", "looked", "text"}`. `first` and `last` are the keys around the frame. `by` is "picture" or
/// "movement". `distance` is how far, in pixels, the in-between is from its picture, or how far the span moves. `keys` is
/// how far the keys are from their pictures, or null. `foreign` is null, or how far the keys are from pictures that show
/// something else and count for nothing. `looked` lists `[frame, distance]` for each drawing with a picture. `text` says
/// it in a sentence.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_suggest_breakdown(
    offsets: *const i32,
    stroke_count: usize,
    points: *const f64,
    closed: *const u8,
    drawings_of: *const i32,
    drawing_count: usize,
    frames: *const i32,
    options: *const u8,
    options_length: usize,
    progress: RototoonProgress,
    user: *mut c_void,
    suggestion: *mut *mut RototoonText,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            clear(suggestion, null_mut(), "suggestion")?;
            let bounds = drawing_count.checked_add(1).filter(|&count| count < MAX_BYTES);
            let large = || Failure::BadArgument(format!("drawing_count: {drawing_count} is too large"));
            let given = Drawings {
                strokes: strokes(offsets, stroke_count, points, closed)?,
                colours: &[],
                labels: &[],
                drawings: slice(drawings_of, bounds.ok_or_else(large)?, "drawings")?,
                frames: slice(frames, drawing_count, "frames")?,
                by_hand: &[],
            };
            let options = text(options, options_length, "options")?;
            let found = with_progress(progress, user, |go_on| suggested(&given, options, go_on))?;
            give(suggestion, RototoonText::new(found));
            Ok(())
        })
    }
}
