//! The effect `org.rototoon.Roto`: draws the parts of a project document as cutout, matte, overlay or ids, and its painted
//! regions and strokes.
//!
//! - [`describe`]: describes clips and parameters
//! - [`settings`]: the parameters' values at a time
//! - [`instance`](mod@instance): the data of an instance: its document, and the messages that the user has seen
//! - [`stored`]: encodes the document as a text that the host stores
//! - [`placement`]: places the footage's pixels in the host's picture; [`rectangles`]: on which rectangle; [`shot`]: the frames of a shot
//! - [`parts`]: selects parts by name
//! - [`picture`]: draws the parts
//! - [`regions`]: the regions that are drawn, and the regions of the source that they need
//! - [`render`]: renders the pixels of a window
//! - [`outlines`]: draws outlines as lines; [`cels`]: painted regions and strokes
//! - [`mixing`]: what a picture does with the source
//! - [`measured`]: the scale at which a host really gives its pixels
//! - [`shared`]: documents that instances share
//! - [`overlay`]: events of the pen and the keyboard in the viewer; [`overlay_entry`]: how the host calls it; [`canvas`]: draws
//!   over the viewer, with a [`pen`]
//! - [`edit`]: what the pen does to a selection and a document, without a host
//! - [`edits`]: stores edits and selections in the host's parameters; [`fresh`]: the document of a new composition
//! - [`state`]: the settings of parts, and what tracks were made from; [`page`]: the settings of one part as parameters
//! - [`listing`]: the list of the parts; [`choosing`]: selects a part from it
//! - [`buttons`]: the buttons; [`saving`]: *Save*, which writes over nothing that another program wrote; [`footage`]: the path of the
//!   footage in files and in the composition
//! - [`standing`]: whether a part is lost, doubtful or hidden on a frame; [`marks`]: shows it in the host's timeline;
//!   [`visits`]: goes to such frames
//! - [`motion`]: the motion of a part; [`taking_out`]: takes motions and shapes out;
//!   [`id_files`]: writes ids as files for keyers; [`numbering`]: the composition's frames in these files
//! - [`track`]: the button Track; [`job`]: runs the core's tracker on the source's frames, which [`fetching`] gets from the host
//! - [`spans`]: which spans of parts wait for Track
//! - [`follow`]: tracks an edit at once, on the [`film`] that stays in memory; [`watch`]: compares rendered frames with it, by
//!   their [`sums`]; [`stale`]: tracks of a source that has changed

pub mod buttons;
pub mod canvas;
pub mod cels;
pub mod choosing;
pub mod describe;
pub mod edit;
pub mod edits;
pub mod fetching;
pub mod film;
pub mod follow;
pub mod footage;
pub mod fresh;
pub mod id_files;
pub mod instance;
pub mod interpolation;
pub mod job;
pub mod listing;
pub mod marks;
pub mod measured;
pub mod mixing;
pub mod motion;
pub mod numbering;
pub mod outlines;
pub mod overlay;
pub mod overlay_entry;
pub mod page;
pub mod parts;
pub mod pen;
pub mod picture;
pub mod placement;
pub mod reach;
pub mod rectangles;
pub mod regions;
pub mod render;
pub mod saving;
pub mod settings;
pub mod shared;
pub mod shot;
pub mod spans;
pub mod stale;
pub mod standing;
pub mod state;
pub mod stored;
pub mod sums;
pub mod taking_out;
pub mod track;
pub mod visits;
pub mod watch;

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

/// The effect's id. Old compositions contain it, so it never changes.
pub const ID: &CStr = c"org.rototoon.Roto";

/// Runs an action.
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
    // SAFETY: `create` attaches data of this type to every instance of this effect.
    unsafe { effect.data::<Instance>() }
}

fn create(action: &Action) -> Result<(), Failure> {
    action.effect.set_data(Box::new(Instance::default()))?;
    listing::refresh(&action.effect);
    Ok(())
}

#[allow(unsafe_code, reason = "the data of an instance is a pointer that the host keeps")]
fn destroy(action: &Action) -> Result<(), Failure> {
    // SAFETY: as in `instance`. No other action of the instance runs at the same time.
    unsafe { action.effect.take_data::<Instance>() }.map(drop)
}

fn purge(action: &Action) -> Result<(), Failure> {
    instance(&action.effect)?.forget();
    Ok(())
}
