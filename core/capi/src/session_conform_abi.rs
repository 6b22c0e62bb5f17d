//! The exported function that moves a session's document to footage that was delivered again.

use crate::callback::{RototoonProgress, with_progress};
use crate::entry::{clear, entry, give, handle, text};
use crate::session_abi::RototoonSession;
use crate::status::RototoonStatus;
use crate::text::RototoonText;
use crate::work::GoOn;
use std::ffi::c_void;
use std::ptr::null_mut;

/// Moves the document to footage that was delivered again: of another size, with other frame numbers, with drawings added, left out, held
/// longer or drawn again. The pictures of both footages are compared. `rototoon_session_document` then gives the conformed document, whose footage is the new
/// one.
///
/// `options` is a JSON object. `pattern` names the files of the new footage, with one `%d` or `%0Nd`, relative to the folder of the session. All other
/// fields may be left out: `frames`, a list of the first and the last frame of the new footage, by default those of all files; `fps`, its frames a
/// second, by default as before; `hold_gaps`, whether a frame without a file shows the picture before it, by default as before; `scale`, pixels of the new picture for each
/// pixel of the old one, and `shift`, two numbers, the place of the old picture's corner in the new one, by default found by the pictures;
/// `frame_offset`, what is added to the numbers of frames: then no pictures are compared, the old footage may be gone, the scale is that of the sizes
/// and the shift 0, unless they are given; `threads`, 0 for one per core, which does not change the result.
///
/// `report` is JSON: `{"scale": number, "shift": [x, y], "frames": {"new frame": shows}, "went": {"old frame": new frame}, "gone": [old frame],
/// "warnings": [text]}`.
///
/// - `shows` is `{"same": old frame}`, `{"redrawn": old frame}` where a drawing was drawn again, or `{"new": true}`.
/// - `went` has the frame to which the artist's work on an old frame has gone. Old frames whose drawing is gone are in `gone`.
/// - `warnings` name what did not simply go with its drawing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_session_conform(
    session: *const RototoonSession,
    options: *const u8,
    options_length: usize,
    progress: RototoonProgress,
    user: *mut c_void,
    report: *mut *mut RototoonText,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            clear(report, null_mut(), "report")?;
            let session = handle(session, "session")?;
            let options = text(options, options_length, "options")?;
            let conform = |go_on: GoOn<'_>| session.with(|session| session.conform(options, go_on));
            let value = RototoonText::new(with_progress(progress, user, conform)?);
            give(report, value);
            Ok(())
        })
    }
}
