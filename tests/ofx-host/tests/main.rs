//! The plugin in the official host library.
//!
//! - `common`: the bundle, documents and pictures to test with
//! - `describing`: contexts, parameters, loading again
//! - `pixels`: every depth, component, tile, row order, scale and number of threads draw the same
//! - `shapes`: the matte is that of the command line and of the truth
//! - `actions`: regions, identity, abort, keys, what is wrong with documents
//! - `buttons`: load, save, track
//! - `overlay`: contours over the viewer, control points that can be dragged
//! - `lines`: the effect that shows what a tracker of edges sees

mod actions;
mod buttons;
mod common;
mod describing;
mod lines;
mod overlay;
mod pixels;
mod shapes;
