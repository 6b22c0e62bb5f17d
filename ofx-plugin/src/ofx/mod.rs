//! A thin safe layer over the C functions of an OpenFX host.
//!
//! - [`host`]: the suites that the host offers
//! - [`entry`]: actions in, statuses out; no panic leaves the plugin
//! - [`failure`]: why an action did not do its work
//! - [`property`]: typed access to properties
//! - [`effect`]: effects, their clips and what they say to the user
//! - [`image`]: images, released on every path
//! - [`interact`]: what is drawn over the viewer, and the pen there
//! - `log`: messages that the host cannot show
//! - [`param`]: parameters described, read and set
//! - [`progress`]: how far long work has come
//! - [`threads`]: work on the host's threads
//!
//! Handles are valid while the action runs that they came with; the types here borrow from the [`effect::Effect`] that the
//! entry point makes for an action, and so end with it.
#![allow(
    unsafe_code,
    reason = "handles and functions come from the host as raw pointers; each use says what makes it valid"
)]

pub mod effect;
pub mod entry;
pub mod failure;
pub mod host;
pub mod image;
pub mod interact;
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
