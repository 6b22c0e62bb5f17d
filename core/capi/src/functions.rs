//! Functions that need no session.

use crate::entry::{clear, entry, give, text};
use crate::matching::answer;
use crate::status::RototoonStatus;
use crate::text::RototoonText;
use rototoon::scene::parameters;

/// Rises with every change that an old caller would not survive.
pub const ROTOTOON_ABI_VERSION: u32 = 1;

/// The header that callers of this build see.
const HEADER: &[u8] = include_bytes!("../include/rototoon.h");

/// FNV-1a, 64 bits (Fowler, Noll, Vo): short enough for a compile-time function. It guards against mix-ups alone.
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

/// `ROTOTOON_ABI_VERSION` as the library was built with it. Compare before any other call.
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
            give(version, RototoonText::new(env!("CARGO_PKG_VERSION")));
            Ok(())
        })
    }
}

/// Every parameter as a JSON list: `id`, `label`, `help`, `stage`, and what values it takes.
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

/// Finds which drawn contour is which known one, whatever their order, direction, start and number of points.
///
/// `request` is JSON: `{"references": [contour], "drawn": [contour]}`, a contour being `{"closed": bool, "points":
/// [[x, y]]}` in pixels, with its `"color": [r, g, b]` (sRGB, 0 to 1) where it has one. `matches` is JSON: `{"matches":
/// [{"reference": index, "drawn": index, "points": [[x, y]], "cost": number}]}`, rising by reference: `points` are the
/// reference's control points on the drawn line; the cost is 0 for equal contours. What has no counterpart is left out.
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
            give(matches, RototoonText::new(answer(request)?));
            Ok(())
        })
    }
}
