//! A thin safe layer over the C functions of an OpenFX host.
//!
//! - [`host`]: the host and its suites
//! - [`entry`]: the entry point of effects, which no panic leaves
//! - [`failure`]: the failures of actions
//! - [`property`]: typed access to properties
//! - [`effect`]: effects, their clips, and their messages to the user
//! - [`image`]: images of clips
//! - [`interact`]: overlays over the viewer
//! - [`letters`]: text as lines of pixels
//! - `log`: messages that the host cannot show
//! - [`param`]: parameters of effects
//! - [`progress`]: the progress display
//! - [`threads`]: work on the host's threads
//!
//! The handles of an action are valid while it runs. The types here borrow from the [`effect::Effect`] that the entry point
//! makes for the action, so they cannot outlive it.
#![allow(
    unsafe_code,
    reason = "handles and functions come from the host as raw pointers; each use says why it is valid"
)]

pub mod effect;
pub mod entry;
pub mod failure;
pub mod host;
pub mod image;
pub mod interact;
pub mod letters;
mod log;
pub mod param;
pub mod progress;
pub mod property;
pub mod threads;

pub use effect::{Clip, Effect};
pub use failure::Failure;
pub use image::{Bounds, Image};
pub use param::Parameters;
pub use property::Properties;
