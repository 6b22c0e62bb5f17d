//! The effect `org.rototoon.Lines`: the footage as a tracker of edges sees it.
//!
//! The filtered colours (mean shift), the edges in them (Canny), and the distance to the nearest edge, with the parameters of
//! each; the defaults are those of the preset `zhou2011`. All three look at the whole picture, so the effect does not work
//! in tiles. Colours are filtered as the screen shows them, whatever the host holds.

pub mod describe;
pub mod render;

use crate::ofx::Failure;
use crate::ofx::entry::{Action, Perform};
use openfx::sys::generic::core::{
    kOfxActionCreateInstance, kOfxActionDescribe, kOfxActionDestroyInstance, kOfxActionLoad,
};
use openfx::sys::image_effect_v1::image_effect::{
    kOfxImageEffectActionDescribeInContext, kOfxImageEffectActionGetClipPreferences, kOfxImageEffectActionRender,
};
use std::ffi::CStr;

/// The effect's id, fixed for ever.
pub const ID: &CStr = c"org.rototoon.Lines";

/// Does an action.
pub fn perform(action: &Action) -> Result<(), Failure> {
    let name = action.name;
    // Hosts show an effect's controls only where making and ending an instance succeed.
    if [kOfxActionLoad, kOfxActionCreateInstance, kOfxActionDestroyInstance].contains(&name) {
        return Ok(());
    }
    let known: [(&CStr, Perform); 4] = [
        (kOfxActionDescribe, describe::describe),
        (kOfxImageEffectActionDescribeInContext, describe::describe_in_context),
        (kOfxImageEffectActionGetClipPreferences, describe::clip_preferences),
        (kOfxImageEffectActionRender, render::render),
    ];
    let perform = known.iter().find(|(known, _)| *known == name).ok_or(Failure::Default)?.1;
    perform(action)
}
