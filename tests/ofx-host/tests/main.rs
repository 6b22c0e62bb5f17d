//! Tests of the plugin in a host made with the official host library.
//!
//! - `common`: the bundle, documents and pictures for the tests
//! - `describing`: contexts, parameters, loading again
//! - `pixels`: the picture does not depend on depth, components, tiles, row order or threads
//! - `shapes`: the matte is the same as that of the command line, and near the truth
//! - `actions`: regions, identity, abort, keys, wrong documents
//! - `buttons`: load, save, track
//! - `overlay`: contours over the viewer, control points that can be dragged
//! - `lines`: the effect that shows the images that a tracker of edges uses

mod actions;
mod buttons;
mod common;
mod describing;
mod lines;
mod overlay;
mod pixels;
mod shapes;
