//! The exported functions that edit a session's document: parts, keys, pins, centres and absence.

use crate::edit;
use crate::entry::{entry, handle, slice, text};
use crate::session_abi::RototoonSession;
use crate::status::RototoonStatus;
use crate::text::RototoonText;
use rototoon::geometry::Point;

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
