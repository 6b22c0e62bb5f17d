//! The callback that long work reports to.

use crate::work::GoOn;
use std::ffi::c_void;

/// Told the finished share of the work (0 to 1, never falling) and the name of the step (UTF-8, not terminated),
/// about twenty times a second; returns 0 to go on, anything else to cancel. Null is allowed: nobody is told.
pub type RototoonProgress =
    Option<unsafe extern "C" fn(user: *mut c_void, fraction: f64, step: *const u8, step_length: usize) -> i32>;

/// Calls `body` with the caller's callback as a Rust one.
///
/// # Safety `progress` is null or may be called with `user` during the call.
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
