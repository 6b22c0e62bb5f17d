//! The effect `org.rototoon.Lines`: shows the images that a tracker of edges uses.
//!
//! It shows the filtered colours (mean shift), the edges in them (Canny), or the distance to the nearest edge. Each has its
//! parameters. The defaults are those of the preset `zhou2011`. All three need the complete picture, so the effect does not
//! support tiles. The filter works on display colours, whatever colours the host has.

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

/// The effect's id. Old compositions contain it, so it never changes.
pub const ID: &CStr = c"org.rototoon.Lines";

/// Runs an action.
pub fn perform(action: &Action) -> Result<(), Failure> {
    let name = action.name;
    // Hosts show an effect's controls only if creating and destroying an instance succeed.
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
