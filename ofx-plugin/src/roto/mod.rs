//! The effect `org.rototoon.Roto`: the parts of a project document as cutout, matte, overlay or ids.
//!
//! - [`describe`]: clips and parameters
//! - [`settings`]: what the parameters say at a time
//! - [`instance`]: what an instance keeps: its document, read once, and what the user was told
//! - [`stored`]: the document as the text that a host keeps
//! - [`placement`]: where the footage's pixels are in the host's picture
//! - [`parts`]: which parts are meant
//! - [`picture`]: what is drawn
//! - [`regions`]: where something is drawn, and what of the source that needs
//! - [`render`]: the pixels of a window
//! - [`overlay`]: contours over the viewer, control points that can be dragged; [`overlay_entry`]: how the host calls it
//! - [`buttons`]: load, save, track
//! - [`track`]: core's tracker on the source's frames

pub mod buttons;
pub mod describe;
pub mod instance;
pub mod overlay;
pub mod overlay_entry;
pub mod parts;
pub mod picture;
pub mod placement;
pub mod regions;
pub mod render;
pub mod settings;
pub mod stored;
pub mod track;

use crate::ofx::entry::{Action, Perform};
use crate::ofx::{Effect, Failure};
use instance::Instance;
use openfx::sys::generic::core::{
    kOfxActionCreateInstance, kOfxActionDescribe, kOfxActionDestroyInstance, kOfxActionInstanceChanged, kOfxActionLoad,
    kOfxActionPurgeCaches,
};
use openfx::sys::image_effect_v1::image_effect::{
    kOfxImageEffectActionDescribeInContext, kOfxImageEffectActionGetClipPreferences,
    kOfxImageEffectActionGetFramesNeeded, kOfxImageEffectActionGetRegionOfDefinition,
    kOfxImageEffectActionGetRegionsOfInterest, kOfxImageEffectActionIsIdentity, kOfxImageEffectActionRender,
};
use std::ffi::CStr;

/// The effect's id, fixed for ever.
pub const ID: &CStr = c"org.rototoon.Roto";

/// Does an action.
pub fn perform(action: &Action) -> Result<(), Failure> {
    let name = action.name;
    if name == kOfxActionLoad {
        return Ok(());
    }
    let known: [(&CStr, Perform); 11] = [
        (kOfxActionDescribe, describe::describe),
        (kOfxImageEffectActionDescribeInContext, describe::describe_in_context),
        (kOfxActionCreateInstance, create),
        (kOfxActionDestroyInstance, destroy),
        (kOfxActionPurgeCaches, purge),
        (kOfxActionInstanceChanged, buttons::changed),
        (kOfxImageEffectActionGetClipPreferences, regions::clip_preferences),
        (kOfxImageEffectActionGetRegionOfDefinition, regions::definition),
        (kOfxImageEffectActionGetRegionsOfInterest, regions::interest),
        (kOfxImageEffectActionGetFramesNeeded, regions::frames_needed),
        (kOfxImageEffectActionIsIdentity, regions::identity),
    ];
    if name == kOfxImageEffectActionRender {
        return render::render(action);
    }
    let perform = known.iter().find(|(known, _)| *known == name).ok_or(Failure::Default)?.1;
    perform(action)
}

#[allow(unsafe_code, reason = "the data of an instance is a pointer that the host keeps")]
fn instance<'a>(effect: &Effect<'a>) -> Result<&'a Instance, Failure> {
    // SAFETY: `create` ties this type to every instance of this effect.
    unsafe { effect.data::<Instance>() }
}

fn create(action: &Action) -> Result<(), Failure> {
    action.effect.set_data(Box::new(Instance::default()))
}

#[allow(unsafe_code, reason = "the data of an instance is a pointer that the host keeps")]
fn destroy(action: &Action) -> Result<(), Failure> {
    // SAFETY: as in `instance`; no other action of the instance runs now.
    unsafe { action.effect.take_data::<Instance>() }.map(drop)
}

fn purge(action: &Action) -> Result<(), Failure> {
    instance(&action.effect)?.forget();
    Ok(())
}
