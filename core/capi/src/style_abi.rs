//! The exported functions of skeleton clips, their library, and drawings that follow them.

use crate::callback::{RototoonProgress, with_progress};
use crate::entry::{clear, entry, give, text};
use crate::pool::install;
use crate::status::RototoonStatus;
use crate::style;
use crate::text::RototoonText;
use std::ffi::c_void;
use std::ptr::null_mut;

/// Makes a skeleton clip from a document's tracked contours. The document's limbs tell where the key points are.
///
/// `document` is a project document as JSON. `options` is a JSON object: `character` and `motion` are the names for the
/// clip, `first` and `last` its first and last frame. The frames may be left out.
///
/// `made` is JSON: `{"clips": a file of clips, "first": frame of the first posture, "guessed": {key point: number of
/// frames}, "doubts": [text]}`. `guessed` counts the frames on which no contour defines the key point, so that it was filled in.
/// `doubts` says of each part that limbs hang on where its contours are lost or doubtful.
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
            give(made, RototoonText::new(install(|| style::capture(document, options))?));
            Ok(())
        })
    }
}

/// The definition of a body, so that a program can show its key points and chains.
///
/// `skeleton` is JSON: the name of a built-in body ("human", "quadruped", "bird") as a string, or a definition.
///
/// `made` is JSON: the complete definition, `{"name", "points": [{"name", "parent", "at"}], "mirror", "chains": [{"name",
/// "points", "role"}]}`. A definition that does not fit together is an error that names the field.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_skeleton(
    skeleton: *const u8,
    skeleton_length: usize,
    made: *mut *mut RototoonText,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            clear(made, null_mut(), "made")?;
            let skeleton = text(skeleton, skeleton_length, "skeleton")?;
            give(made, RototoonText::new(style::skeleton(skeleton)?));
            Ok(())
        })
    }
}

/// How the body of a clip stands: to which side it looks, and on which frames it is in the air.
///
/// `clips` is a file of clips as JSON, with one clip.
///
/// `made` is JSON: `{"looks": "left", "right" or null where it cannot be told, "air": [true or false for each frame]}`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_clip_stance(
    clips: *const u8,
    clips_length: usize,
    made: *mut *mut RototoonText,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            clear(made, null_mut(), "made")?;
            let clips = text(clips, clips_length, "clips")?;
            give(made, RototoonText::new(install(|| style::stance(clips))?));
            Ok(())
        })
    }
}

/// Makes a skeleton clip from motion capture, seen from one direction.
///
/// `motion` is the text of a BVH file. `options` is a JSON object with the names `character` and `motion`. It may also
/// have:
///
/// - `view`: the direction, "auto", "front", "side", "three-quarter" or degrees about the vertical (0 front, 90 side).
///   "auto" shows most of the motion.
/// - `up`: the axis that points up, "auto", "y" or "z".
/// - `joints`: `{key point: joint or list of joints}`, for joints that are not recognised by their names.
/// - `way`: true to let the pelvis move through the picture. Otherwise it stays at the origin.
/// - `first`, `last`: the frames of the file, counted from 0. Give both or none.
/// - `fps`: frames per second of the clip.
///
/// `made` is JSON: `{"clips": a file of clips, "yaw": the direction in degrees, "notes": [text]}`. `notes` are what a person should
/// know: joints that were not taken by their names.
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
            give(made, RototoonText::new(install(|| style::import(motion, options))?));
            Ok(())
        })
    }
}

/// Makes a motion in the style of another character.
///
/// `clips` is a file of clips as JSON. `options` is a JSON object with three names: `style` (the character whose style
/// is used), `motion`, and `content` (the character whose motion is used). It may also have:
///
/// - `preset`: the method.
/// - `timing`: whose timing the result has, "content" or "style".
/// - `strength`: a number from 0 to 3, the factor on the change that the style makes. With 0 the result is the content's own motion.
/// - `limb_lengths`: whether limbs keep within the lengths of the style's clips.
/// - `contacts`: whether feet that stand in the content's clip stay where they stand.
/// - `keys`: drawn poses, in the form of a file of key poses.
/// - `threads`: number of threads, 0 for one per core.
/// - `notes`: true to get `{"clips", "notes": [text]}`, with what a person should know about the result.
///
/// `made` is a file of clips with one clip.
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

/// Makes a drawing follow a clip: moves its contours and strokes on every frame.
///
/// `document` is a project document with limbs, as JSON. `clips` is a file of clips, as JSON. `options` is a JSON
/// object, in which all fields may be left out:
///
/// - `character`, `motion`: the names of the clip. They are needed if the file has several clips.
/// - `rest`: the frame of the drawing.
/// - `sub_keys`: the number of points of each limb between its key points, 0 to 100.
/// - `mirror`: "auto", "on" or "off", whether the clip is mirrored. With "auto" it is if drawing and clip look to different
///   sides.
/// - `points`: `{closed part: [[x, y]]}`, further points in pixels that follow the part.
/// - `threads`: number of threads, 0 for one per core.
///
/// `made` is a JSON object:
///
/// - `document`: the document with tracks, depths and strokes on every frame.
/// - `given`: `[{"part", "follows"}]`, the parts that no limb carries and for which the document does not say what they
///   follow, each with what it follows, in words.
/// - `rigid`: the names of the parts that do not bend.
/// - `still`: the names of the chains that no chain of the clip moves.
/// - `mirrored`: whether the clip was mirrored.
/// - `looks`: `{"drawing", "clip"}`, the sides to which they look, "left", "right" or null where it cannot be told. It is null if they did
///   not decide whether the clip was mirrored.
/// - `notes`: what a person should know beside, in words: a clip of another frame rate, which is brought to the document's; parts that go
///   through the ground; strokes that lie on no part.
/// - `points`: `{part: [[[x, y]]]}`, for each frame the places of the further points.
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

/// Adds clips to the library in a folder, all or none: none if the library has a clip of the same character and motion.
/// `rototoon_library_add_files` can replace such clips. `clips` is a file of clips as JSON. `source` is a text that says
/// where the clips come from. It may be empty.
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
            let source = text(source, source_length, "source")?;
            install(|| style::library_add(folder, clips, source))
        })
    }
}

/// Adds files of clips to the library in a folder, all or none.
///
/// `files` is JSON: `[{"clips": a file of clips, "source": text}]`. The source says where the clips come from, and may be
/// left out. `options` is a JSON object or empty. Its field `replace` is whether to replace clips of the same character and
/// motion. Without it such a clip is an error, and nothing is added. Clips are looked for and added under one lock: of
/// two processes that add the same clip at once, one gets the error.
///
/// `added` is JSON: `{"replaced": entries, "aside": text}`. `replaced` are the entries of the replaced clips, as
/// `rototoon_library_find` has them. `aside` is the path of a damaged index that was set aside, or null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_library_add_files(
    folder: *const u8,
    folder_length: usize,
    files: *const u8,
    files_length: usize,
    options: *const u8,
    options_length: usize,
    added: *mut *mut RototoonText,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            clear(added, null_mut(), "added")?;
            let folder = text(folder, folder_length, "folder")?;
            let files = text(files, files_length, "files")?;
            let options = text(options, options_length, "options")?;
            give(added, RototoonText::new(install(|| style::library_add_files(folder, files, options))?));
            Ok(())
        })
    }
}

/// Finds clips in the library in a folder.
///
/// `wanted` is a JSON object, in which all fields may be left out: `character` and `motion` are words that the names
/// must contain, in upper or lower case; `exact` is whether they are the names themselves (an empty one is any); `read` is
/// whether to read the clips; `rate_of` is the character and the motion of a clip.
///
/// `found` is JSON: `{"entries": [{"file", "character", "motion", "frames", "fps", "source"}], "troubles": [text],
/// "clips": a file of clips or null}`. `troubles` are messages about files that cannot be used. The clips are brought to one
/// frame rate: that of the clip `rate_of`, else that which most of them have, and the highest of several such rates. With `read`
/// or `exact` the entries are as the files are; otherwise as the index says.
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
            give(found, RototoonText::new(install(|| style::library_find(folder, wanted))?));
            Ok(())
        })
    }
}
