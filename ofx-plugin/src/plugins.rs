//! The list of effects that the host reads.
#![allow(unsafe_code, reason = "the host looks the functions up by name and calls them with raw pointers")]
#![allow(non_snake_case, reason = "the names are those that OpenFX looks up")]

use crate::ofx::{entry, host};
use crate::{lines, roto};
use openfx::sys::generic::core::{OfxHost, OfxPlugin, OfxPropertySetHandle, OfxStatus};
use openfx::sys::image_effect_v1::image_effect::kOfxImageEffectPluginApi;
use std::ffi::{CStr, c_char, c_int, c_uint, c_void};

type Main = unsafe extern "C" fn(*const c_char, *const c_void, OfxPropertySetHandle, OfxPropertySetHandle) -> OfxStatus;

const fn plugin(id: &'static CStr, main: Main) -> OfxPlugin {
    OfxPlugin {
        pluginApi: kOfxImageEffectPluginApi.as_ptr(),
        apiVersion: 1,
        pluginIdentifier: id.as_ptr(),
        pluginVersionMajor: MAJOR,
        pluginVersionMinor: MINOR,
        setHost: Some(set_host),
        mainEntry: Some(main),
    }
}

/// Version of the effects. The major version changes when old compositions would look different.
const MAJOR: c_uint = 1;
const MINOR: c_uint = 0;

static PLUGINS: [OfxPlugin; 2] = [plugin(roto::ID, roto_main), plugin(lines::ID, lines_main)];

unsafe extern "C" fn set_host(host: *mut OfxHost) {
    host::set(host);
}

unsafe extern "C" fn roto_main(
    action: *const c_char,
    handle: *const c_void,
    input: OfxPropertySetHandle,
    output: OfxPropertySetHandle,
) -> OfxStatus {
    // SAFETY: the host's own call.
    unsafe { entry::entry(action, handle, input, output, roto::perform) }
}

unsafe extern "C" fn lines_main(
    action: *const c_char,
    handle: *const c_void,
    input: OfxPropertySetHandle,
    output: OfxPropertySetHandle,
) -> OfxStatus {
    // SAFETY: the host's own call.
    unsafe { entry::entry(action, handle, input, output, lines::perform) }
}

/// The number of effects.
#[unsafe(no_mangle)]
pub extern "C" fn OfxGetNumberOfPlugins() -> c_int {
    PLUGINS.len() as c_int
}

/// The effect of this index; null beyond the last one.
#[unsafe(no_mangle)]
pub extern "C" fn OfxGetPlugin(index: c_int) -> *const OfxPlugin {
    usize::try_from(index).ok().and_then(|index| PLUGINS.get(index)).map_or(std::ptr::null(), std::ptr::from_ref)
}

/// Sets the host, before it reads the effects.
#[unsafe(no_mangle)]
pub extern "C" fn OfxSetHost(host: *const OfxHost) -> OfxStatus {
    host::set(host.cast_mut());
    0
}
