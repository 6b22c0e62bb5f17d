//! Tests of the plugin in a host made with the official host library.
//!
//! - `common`: the bundle, documents and pictures for the tests
//! - `describing`: contexts, parameters, loading again
//! - `pixels`: the picture does not depend on depth, components, tiles, row order or threads
//! - `shapes`: the matte is the same as that of the command line, and near the truth
//! - `actions`: regions, identity, abort, keys, wrong documents
//! - `buttons`: load, save, track
//! - `live`: edits that are tracked at once, on frames in memory
//! - `overlay`: the pen in the viewer: drawing, selecting, correcting, undo
//! - `crops`: sources that are cropped to their drawing, or have frames without end
//! - `faults`: faults that were seen in real hosts
//! - `node`: settings of parts, channels, masks, regions, motion and export
//! - `feather`: the feather of control points
//! - `order`: parts nearer and farther
//! - `listing`: the menu of the parts, buttons that go from part to part, and their names
//! - `longer`: a source that gets longer
//! - `matrix`: what hosts do, with each output
//! - `cels`: painted regions and strokes, as the command line draws them
//! - `unpainted`: paint and strokes where there are none, cannot be read, or only some are wanted
//! - `looks`: the falloff of soft borders, and the colours of parts
//! - `lives`: instances on several threads, at other places and of other versions
//! - `paper`: sources with transparent paper
//! - `page`: the documentation lists the matrix's tests
//! - `standing`: lost, doubtful and hidden parts in the viewer and in the timeline
//! - `saving`: *Save* beside other programs
//! - `session`: the sample cartoon drawn, tracked and corrected in the host
//! - `undo`: undo that the host reports as changes by the user
//! - `lines`: the effect that shows the images that a tracker of edges uses

mod actions;
mod buttons;
mod cels;
mod common;
mod crops;
mod describing;
mod faults;
mod feather;
mod lines;
mod listing;
mod live;
mod lives;
mod longer;
mod looks;
mod matrix;
mod node;
mod order;
mod overlay;
mod page;
mod paper;
mod pixels;
mod saving;
mod session;
mod shapes;
mod standing;
mod undo;
mod unpainted;
