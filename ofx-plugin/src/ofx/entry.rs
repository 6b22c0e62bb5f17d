//! The entry point of an effect: runs an action and returns its status. No panic leaves the plugin.

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

/// An action of the host with its arguments.
pub struct Action<'a> {
    /// Its OpenFX name.
    pub name: &'a CStr,
    /// The effect that it is for.
    pub effect: Effect<'a>,
    /// The input arguments.
    pub input: Properties<'a>,
    /// The output arguments, which the effect sets.
    pub output: Properties<'a>,
}

/// A function that runs an action.
pub type Perform = fn(&Action) -> Result<(), Failure>;

/// Runs an action. Every call of the host to an effect goes through this function.
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
            // Hosts show messages of instances only, and a description is not an instance.
            let described = [kOfxActionDescribe, kOfxImageEffectActionDescribeInContext].contains(&name);
            tell(panic, &action, !handle.is_null() && !described);
            kOfxStatFailed
        }
    }
}

/// Tells of a panic: with the effect if it is an `instance`, otherwise in the log. Nothing here may panic into the host.
fn tell(panic: Box<dyn Any + Send>, action: &Action, instance: bool) {
    let text = format!("internal error in {}: {}", action.name.to_string_lossy(), said(panic.as_ref()));
    let _ = catch_unwind(AssertUnwindSafe(|| if instance { action.effect.complain(&text) } else { log(&text) }));
    // Dropping the panic's payload may panic too.
    let _ = catch_unwind(AssertUnwindSafe(|| drop(panic)));
}

fn said(panic: &(dyn Any + Send)) -> &str {
    match (panic.downcast_ref::<&str>(), panic.downcast_ref::<String>()) {
        (Some(text), _) => text,
        (_, Some(text)) => text,
        _ => "no message",
    }
}
