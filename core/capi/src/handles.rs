//! Handles of text and arrays. The caller owns and frees them. They never change, so threads may share them.

use crate::entry::{clear, entry, free, handle};
use crate::status::RototoonStatus;
use crate::text::RototoonText;
use rototoon::geometry::Point;
use rototoon::scene::Part;

/// The track of a part: frame numbers, points, confidence.
pub struct RototoonTrack {
    frames: Vec<i32>,
    point_count: usize,
    points: Vec<f64>,
    confidence: Vec<f64>,
}

/// The snapped paths of a part on one frame.
pub struct RototoonCurves {
    offsets: Vec<i32>,
    points: Vec<f64>,
}

impl RototoonTrack {
    /// The track of a part. It has no frames if the part is not tracked.
    pub fn of(part: &Part) -> Self {
        let point_count = part.point_count();
        let mut track = Self { frames: Vec::new(), point_count, points: Vec::new(), confidence: Vec::new() };
        // Tracks with another number of points belong to keys that no longer exist.
        for (frame, points) in part.tracks.iter().filter(|(_, points)| points.len() == point_count) {
            track.frames.push(*frame);
            track.points.extend(points.iter().flat_map(|p| p.to_array()));
            // A document written by hand may have tracks without confidence. Keys are certain in any case.
            let known = part.confidence.get(frame).filter(|known| known.len() == points.len());
            let otherwise = if part.keys.contains_key(frame) { 1.0 } else { 0.0 };
            match known {
                Some(known) => track.confidence.extend(known),
                None => track.confidence.extend(std::iter::repeat_n(otherwise, points.len())),
            }
        }
        track
    }
}

impl RototoonCurves {
    /// Joins paths, one after the other, into flat arrays.
    pub fn of(paths: &[Vec<Point>]) -> Self {
        let mut curves = Self { offsets: vec![0], points: Vec::new() };
        for path in paths {
            curves.points.extend(path.iter().flat_map(|p| p.to_array()));
            curves.offsets.push((curves.points.len() / 2) as i32);
        }
        curves
    }
}

/// Reads a text: `length` bytes of UTF-8 at `data`, without a terminating zero. They live as long as the handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_text_read(
    text: *const RototoonText,
    data: *mut *const u8,
    length: *mut usize,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract; out parameters are written only after `clear` accepted them.
    unsafe {
        entry(error, || {
            clear(data, std::ptr::null(), "data")?;
            clear(length, 0, "length")?;
            let text = handle(text, "text")?;
            data.write(text.0.as_ptr());
            length.write(text.0.len());
            Ok(())
        })
    }
}

/// Frees a text. Null is allowed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_text_free(text: *mut RototoonText) {
    // SAFETY: the crate's contract.
    unsafe { free(text) }
}

/// Reads the arrays of a track. They live as long as the handle.
///
/// - `frames`: `frame_count` frame numbers in rising order.
/// - `points`: `frame_count` × `point_count` × 2 coordinates, x and y in pixels, frame by frame.
/// - `confidence`: `frame_count` × `point_count` numbers from 0 to 1, frame by frame.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_track_read(
    track: *const RototoonTrack,
    frame_count: *mut usize,
    point_count: *mut usize,
    frames: *mut *const i32,
    points: *mut *const f64,
    confidence: *mut *const f64,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract; out parameters are written only after `clear` accepted them.
    unsafe {
        entry(error, || {
            clear(frame_count, 0, "frame_count")?;
            clear(point_count, 0, "point_count")?;
            clear(frames, std::ptr::null(), "frames")?;
            clear(points, std::ptr::null(), "points")?;
            clear(confidence, std::ptr::null(), "confidence")?;
            let track = handle(track, "track")?;
            frame_count.write(track.frames.len());
            point_count.write(track.point_count);
            frames.write(track.frames.as_ptr());
            points.write(track.points.as_ptr());
            confidence.write(track.confidence.as_ptr());
            Ok(())
        })
    }
}

/// Frees a track. Null is allowed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_track_free(track: *mut RototoonTrack) {
    // SAFETY: the crate's contract.
    unsafe { free(track) }
}

/// Reads the arrays of snapped paths. They live as long as the handle.
///
/// - `offsets`: `path_count` + 1 numbers. Path `i` has the points `offsets[i]` to `offsets[i + 1]` (excluded).
/// - `points`: two coordinates per point, x and y in pixels.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_curves_read(
    curves: *const RototoonCurves,
    path_count: *mut usize,
    offsets: *mut *const i32,
    points: *mut *const f64,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract; out parameters are written only after `clear` accepted them.
    unsafe {
        entry(error, || {
            clear(path_count, 0, "path_count")?;
            clear(offsets, std::ptr::null(), "offsets")?;
            clear(points, std::ptr::null(), "points")?;
            let curves = handle(curves, "curves")?;
            path_count.write(curves.offsets.len() - 1);
            offsets.write(curves.offsets.as_ptr());
            points.write(curves.points.as_ptr());
            Ok(())
        })
    }
}

/// Frees snapped paths. Null is allowed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_curves_free(curves: *mut RototoonCurves) {
    // SAFETY: the crate's contract.
    unsafe { free(curves) }
}
