//! Actions in, statuses out; no panic leaves the plugin.

use super::effect::Effect;
use super::failure::Failure;
use super::host;
use super::log::log;
use super::property::Properties;
use openfx::sys::generic::core::{
    OfxPropertySetHandle, OfxStatus, kOfxActionDescribe, kOfxActionLoad, kOfxActionUnload, kOfxStatFailed, kOfxStatOK,
};
use openfx::sys::image_effect_v1::image_effect::kOfxImageEffectActionDescribeInContext;
use std::any::Any;
use std::ffi::{CStr, c_char, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// What an action came with.
pub struct Action<'a> {
    /// Its name, as OpenFX names it.
    pub name: &'a CStr,
    /// The effect that it is about.
    pub effect: Effect<'a>,
    /// What it asks.
    pub input: Properties<'a>,
    /// Where the answer goes.
    pub output: Properties<'a>,
}

/// What does an action.
pub type Perform = fn(&Action) -> Result<(), Failure>;

/// Does an action; the only way from a host into an effect.
///
/// # Safety
/// The arguments are those of a call by the host: a terminated name, and handles that are null or live for the call.
pub unsafe fn entry(
    action: *const c_char,
    handle: *const c_void,
    input: OfxPropertySetHandle,
    output: OfxPropertySetHandle,
    perform: Perform,
) -> OfxStatus {
    if action.is_null() {
        return kOfxStatFailed;
    }
    // SAFETY: a terminated name, as promised.
    let name = unsafe { CStr::from_ptr(action) };
    if name == kOfxActionUnload {
        return kOfxStatOK;
    }
    if name == kOfxActionLoad
        && let Err(failure) = host::load()
    {
        return failure.status();
    }
    let suites = match host::suites() {
        Ok(suites) => suites,
        Err(failure) => return failure.status(),
    };
    // SAFETY: the handles live for the call, and so for the action made of them here.
    let action = unsafe {
        Action {
            name,
            effect: Effect::new(handle, suites),
            input: Properties::new(input, suites.property),
            output: Properties::new(output, suites.property),
        }
    };
    match catch_unwind(AssertUnwindSafe(|| perform(&action))) {
        Ok(Ok(())) => kOfxStatOK,
        Ok(Err(failure)) => failure.status(),
        Err(panic) => {
            let text = format!("internal error in {}: {}", name.to_string_lossy(), said(panic.as_ref()));
            // The message itself must not take the host along.
            let _ = catch_unwind(AssertUnwindSafe(|| {
                // Messages are about instances, which descriptions are not.
                let described = [kOfxActionDescribe, kOfxImageEffectActionDescribeInContext].contains(&name);
                if handle.is_null() || described { log(&text) } else { action.effect.complain(&text) }
            }));
            // What a panic carries may panic when it is dropped.
            let _ = catch_unwind(AssertUnwindSafe(|| drop(panic)));
            kOfxStatFailed
        }
    }
}

fn said(panic: &(dyn Any + Send)) -> &str {
    match (panic.downcast_ref::<&str>(), panic.downcast_ref::<String>()) {
        (Some(text), _) => text,
        (_, Some(text)) => text,
        _ => "no message",
    }
}
