//! Rototoon as an OpenFX plugin.
//!
//! - [`ofx`]: a thin safe layer over the host's C functions
//! - [`pixels`]: reads and writes pixels of every depth and component
//! - [`parameters`]: describes the core's effect parameters to the host
//! - [`description`], [`encoding`], [`ground`]: code that the effects share
//! - [`lines`]: the effect `org.rototoon.Lines`, which shows the images that a tracker of edges uses
//! - [`roto`]: the effect `org.rototoon.Roto`, which draws parts as mattes, cutouts, lines and ids
//! - [`plugins`](mod@plugins): the list of effects that the host reads
//!
//! The core works in pixels, with y down from the upper left corner. OpenFX has y up. [`roto::placement`] converts between
//! them.

pub mod description;
pub mod encoding;
pub mod ground;
pub mod lines;
pub mod ofx;
pub mod parameters;
pub mod pixels;
pub mod plugins;
pub mod roto;
