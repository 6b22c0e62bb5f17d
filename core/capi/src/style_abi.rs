//! Skeleton clips, their library, and drawings that follow them.

use crate::callback::{RototoonProgress, with_progress};
use crate::entry::{clear, entry, give, text};
use crate::status::RototoonStatus;
use crate::style;
use crate::text::RototoonText;
use std::ffi::c_void;
use std::ptr::null_mut;

/// Makes a skeleton clip of a document's tracked contours, by its limbs.
///
/// `document` is a project document as JSON, `options` JSON: `character`, `motion`, and `first` and `last` frame, which may be
/// left out. `made` is JSON: `{"clips": a file of clips, "first": the frame of the first posture, "guessed": {key point:
/// number of frames on which no contour tells it}}`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_capture_clip(
    document: *const u8,
    document_length: usize,
    options: *const u8,
    options_length: usize,
    made: *mut *mut RototoonText,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            clear(made, null_mut(), "made")?;
            let document = text(document, document_length, "document")?;
            let options = text(options, options_length, "options")?;
            give(made, RototoonText::new(style::capture(document, options)?));
            Ok(())
        })
    }
}

/// Makes a skeleton clip of motion capture, seen from one side.
///
/// `motion` is the text of a BVH file, `options` JSON: `character`, `motion`; and `view` ("auto", "front", "side", "three-quarter" or
/// degrees about the vertical, 0 front and 90 side), `up` ("auto", "y" or "z"), `joints` ({key point: joint, or list of joints}), `way`
/// (whether the pelvis goes its way), `first` and `last` frame from 0, and `fps`, which may be left out. `made` is JSON: `{"clips":
/// a file of clips, "yaw": degrees that it is seen from}`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_import_motion(
    motion: *const u8,
    motion_length: usize,
    options: *const u8,
    options_length: usize,
    made: *mut *mut RototoonText,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            clear(made, null_mut(), "made")?;
            let motion = text(motion, motion_length, "motion")?;
            let options = text(options, options_length, "options")?;
            give(made, RototoonText::new(style::import(motion, options)?));
            Ok(())
        })
    }
}

/// Re-makes a motion in another character's manner.
///
/// `clips` is a file of clips as JSON, `options` JSON: `style`, `motion`, `content`; and `preset`, `timing` ("content" or
/// "style"), `strength` (0 to 3), `limb_lengths`, `contacts`, `keys` (drawn poses as their files hold them) and `threads`, which
/// may be left out. `made` is a file of clips with the one that was made.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_translate_clip(
    clips: *const u8,
    clips_length: usize,
    options: *const u8,
    options_length: usize,
    progress: RototoonProgress,
    user: *mut c_void,
    made: *mut *mut RototoonText,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            clear(made, null_mut(), "made")?;
            let clips = text(clips, clips_length, "clips")?;
            let options = text(options, options_length, "options")?;
            let value = with_progress(progress, user, |go_on| style::translate(clips, options, go_on))?;
            give(made, RototoonText::new(value));
            Ok(())
        })
    }
}

/// Makes a drawing follow a clip: its contours and strokes on every frame.
///
/// `document` is a project document with limbs as JSON, `clips` a file of clips as JSON. `options` is JSON: `character` and
/// `motion` choose the clip where there are several; `rest`, the frame of the drawing; `sub_keys`, points of each limb between its
/// key points; `points`, by closed part further points [x, y] that follow it; `threads`; all may be left out. `made` is JSON:
/// `{"document": the document with tracks, depths and strokes on every frame, "given": [{"part", "from", "to"}] parts that no limb
/// carries with the one they follow, "rigid": names of parts that do not bend, "points": {part: by frame the places of its points}}`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_reshape(
    document: *const u8,
    document_length: usize,
    clips: *const u8,
    clips_length: usize,
    options: *const u8,
    options_length: usize,
    progress: RototoonProgress,
    user: *mut c_void,
    made: *mut *mut RototoonText,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            clear(made, null_mut(), "made")?;
            let document = text(document, document_length, "document")?;
            let clips = text(clips, clips_length, "clips")?;
            let options = text(options, options_length, "options")?;
            let value = with_progress(progress, user, |go_on| style::reshape(document, clips, options, go_on))?;
            give(made, RototoonText::new(value));
            Ok(())
        })
    }
}

/// Adds clips to the library of a folder, in place of those of the same character and motion. `clips` is a file of clips as JSON,
/// `source` says where they come from and may be empty.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_library_add(
    folder: *const u8,
    folder_length: usize,
    clips: *const u8,
    clips_length: usize,
    source: *const u8,
    source_length: usize,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            let folder = text(folder, folder_length, "folder")?;
            let clips = text(clips, clips_length, "clips")?;
            style::library_add(folder, clips, text(source, source_length, "source")?)
        })
    }
}

/// The clips of a library. `wanted` is JSON: words that `character` and `motion` must hold, and whether to `read` the clips; all
/// may be left out. `found` is JSON: `{"entries": [{"file", "character", "motion", "frames", "fps", "source"}], "troubles": [what
/// cannot be used], "clips": a file of clips or null}`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_library_find(
    folder: *const u8,
    folder_length: usize,
    wanted: *const u8,
    wanted_length: usize,
    found: *mut *mut RototoonText,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            clear(found, null_mut(), "found")?;
            let folder = text(folder, folder_length, "folder")?;
            let wanted = text(wanted, wanted_length, "wanted")?;
            give(found, RototoonText::new(style::library_find(folder, wanted)?));
            Ok(())
        })
    }
}
