//! Functions that need no session.

use crate::entry::{clear, entry, give, text};
use crate::matching::answer;
use crate::outcomes;
use crate::pool::{install, release};
use crate::status::RototoonStatus;
use crate::text::RototoonText;
use rototoon::scene::parameters;

/// Version of the ABI. It rises with every change that breaks older callers.
pub const ROTOTOON_ABI_VERSION: u32 = 1;

/// The header that belongs to this build.
const HEADER: &[u8] = include_bytes!("../include/rototoon.h");

/// FNV-1a, 64 bits (Fowler, Noll, Vo). It is short enough for a compile-time function, and it only has to detect a
/// library and a header that do not belong together.
const fn fnv_1a(bytes: &[u8]) -> u64 {
    let mut hash = 0xcbf2_9ce4_8422_2325;
    let mut index = 0;
    while index < bytes.len() {
        hash = (hash ^ bytes[index] as u64).wrapping_mul(0x0100_0000_01b3);
        index += 1;
    }
    hash
}

const HEADER_HASH: u64 = fnv_1a(HEADER);

/// The `ROTOTOON_ABI_VERSION` that the library was built with. Compare it with the header's before any other call.
#[unsafe(no_mangle)]
pub extern "C" fn rototoon_abi_version() -> u32 {
    ROTOTOON_ABI_VERSION
}

/// FNV-1a hash (64 bits) of the bytes of the `rototoon.h` that the library was built with.
#[unsafe(no_mangle)]
pub extern "C" fn rototoon_header_hash() -> u64 {
    HEADER_HASH
}

/// The version of Rototoon, such as "0.1.0".
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_version(
    version: *mut *mut RototoonText,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            clear(version, std::ptr::null_mut(), "version")?;
            give(version, RototoonText::new(rototoon::VERSION));
            Ok(())
        })
    }
}

/// Ends the threads that the library keeps, and waits for their ends. Call it before the library is taken out of memory.
/// The status is `Busy` while another call works. The library may be used again afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_release(error: *mut *mut RototoonText) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe { entry(error, release) }
}

/// Describes every parameter, as a JSON list of objects: `id`, `label`, `help`, `stage` ("run", "track", "snap",
/// "render" or "export"), `type` ("choice", "integer", "number" or "flag"), `default`, and the fields of that type:
/// `choices` of a choice, `min` and `max` of numbers, `unit` of a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_parameters(
    parameters: *mut *mut RototoonText,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            clear(parameters, std::ptr::null_mut(), "parameters")?;
            give(parameters, RototoonText::new(parameters::to_json()));
            Ok(())
        })
    }
}

/// Finds the drawn contour that corresponds to each reference contour. Their order, direction, first point and number
/// of points may differ.
///
/// `request` is JSON: `{"references": [contour], "drawn": [contour]}`. A contour is `{"closed": bool, "points":
/// [[x, y]], "color": [r, g, b], "labels": [text]}`, with points in pixels and the colour in sRGB from 0 to 1. Colour and
/// labels may be left out. Labels at the same place of two lists that differ, such as layer and material, make a match less likely.
///
/// `matches` is JSON: `{"matches": [{"reference": index, "drawn": index, "points": [[x, y]], "cost": number}]}`, in the
/// order of the references. `points` are the reference's control points, placed on the drawn contour. The cost is 0 for
/// equal contours. References without a counterpart are left out.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_match_contours(
    request: *const u8,
    request_length: usize,
    matches: *mut *mut RototoonText,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            clear(matches, std::ptr::null_mut(), "matches")?;
            let request = text(request, request_length, "request")?;
            give(matches, RototoonText::new(install(|| answer(request))?));
            Ok(())
        })
    }
}

/// Says what became of parts that the caller holds: which frames are sure, doubtful and lost, and where the next key
/// helps most. The command line and the reports use the same formula.
///
/// `request` is JSON: `{"parts": [{"keys": [frame], "confidence": {"frame": mean}, "wants_key": [frame]}], "exchanges":
/// [{"parts": [name, name], "frames": [frame]}]}`. The means are those of the confidence of the part's points on that
/// frame. `wants_key` are the frames just beyond a track on which the part was lost. `exchanges` are parts that may have
/// changed places, as `rototoon_session_track` found them. Both may be left out.
///
/// `outcomes` is JSON: `{"weakest": {"frame", "score"}, "parts": [{"sure": [frame], "doubtful": [frame], "lost":
/// [frame]}], "exchanges": [text]}`, in the order of the request. `weakest` is as of `rototoon_session_weakest_frame`.
/// The texts are what the command line says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_outcomes(
    request: *const u8,
    request_length: usize,
    outcomes: *mut *mut RototoonText,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            clear(outcomes, std::ptr::null_mut(), "outcomes")?;
            let request = text(request, request_length, "request")?;
            give(outcomes, RototoonText::new(outcomes::answer(request)?));
            Ok(())
        })
    }
}
