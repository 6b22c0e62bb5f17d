//! The functions by which the host calls the overlay of `org.rototoon.Roto`.
#![allow(unsafe_code, reason = "the host calls the functions with raw pointers")]

use super::overlay;
use crate::ofx::interact;
use openfx::sys::generic::core::{OfxPropertySetHandle, OfxStatus};
use std::ffi::{c_char, c_void};

type Main = unsafe extern "C" fn(*const c_char, *const c_void, OfxPropertySetHandle, OfxPropertySetHandle) -> OfxStatus;

/// The entry point of the overlay drawn by the DrawSuite or by OpenGL.
pub fn of_host(draw_suite: bool) -> *mut c_void {
    let entry: Main = if draw_suite { main_v2 } else { main_v1 };
    entry as *mut c_void
}

unsafe extern "C" fn main_v1(
    action: *const c_char,
    handle: *const c_void,
    input: OfxPropertySetHandle,
    _output: OfxPropertySetHandle,
) -> OfxStatus {
    // SAFETY: the host's own call.
    unsafe { interact::entry(action, handle, input, false, overlay::perform) }
}

unsafe extern "C" fn main_v2(
    action: *const c_char,
    handle: *const c_void,
    input: OfxPropertySetHandle,
    _output: OfxPropertySetHandle,
) -> OfxStatus {
    // SAFETY: the host's own call.
    unsafe { interact::entry(action, handle, input, true, overlay::perform) }
}
