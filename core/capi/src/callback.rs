//! The progress callback of long work.

use crate::work::GoOn;
use std::ffi::c_void;

/// Progress callback, called about twenty times a second. `fraction` is the finished share of the work, 0 to 1, and
/// never falls. `step` is the name of the present step: `step_length` bytes of UTF-8, without a terminating zero, valid
/// during the call. `user` is the pointer given with the callback. It returns 0 to go on, any other number to cancel.
/// A null callback is allowed.
pub type RototoonProgress =
    Option<unsafe extern "C" fn(user: *mut c_void, fraction: f64, step: *const u8, step_length: usize) -> i32>;

/// Calls `body` with the caller's callback wrapped as a Rust closure.
///
/// # Safety
/// `progress` is null, or may be called with `user` during the call.
pub(crate) unsafe fn with_progress<T>(
    progress: RototoonProgress,
    user: *mut c_void,
    body: impl FnOnce(GoOn<'_>) -> T,
) -> T {
    let Some(progress) = progress else { return body(None) };
    let mut go_on = |fraction: f64, step: &str| {
        // SAFETY: this function's contract; the text is alive during the call.
        unsafe { progress(user, fraction, step.as_ptr(), step.len()) == 0 }
    };
    body(Some(&mut go_on))
}
