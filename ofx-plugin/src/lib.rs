//! Rototoon as an OpenFX plugin.
//!
//! - [`ofx`]: a thin safe layer over the host's C functions, the only place that is not safe
//! - [`pixels`]: pixels of every depth and component
//! - [`parameters`]: what parameters are made of
//! - [`description`], [`encoding`]: what the effects have in common
//! - [`lines`]: the effect `org.rototoon.Lines`: the footage as a tracker of edges sees it
//! - [`roto`]: the effect `org.rototoon.Roto`: parts as mattes, cutouts, lines and ids
//! - [`plugins`](mod@plugins): the list that the host asks for
//!
//! Core works in pixels with y down from the upper left corner; OpenFX has y up. [`roto::placement`] is where one becomes the
//! other.

pub mod description;
pub mod encoding;
pub mod lines;
pub mod ofx;
pub mod parameters;
pub mod pixels;
pub mod plugins;
pub mod roto;
