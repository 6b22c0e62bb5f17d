//! What a split would part from a region, and whether it is what has leaked.
//!
//! A region can be parted at any narrow place, and slivers lie along ink everywhere. So a gap that is nearly as wide as what leaks through it shows by
//! what lies behind it. The region is flooded (watershed; Meyer 1994) from the places between which it would be split, and the flood of the last one is the
//! *piece*. It has leaked if
//!
//! - the piece lies where the painted region comes to lie, and has its outline: intersection by union is at least [`ALIKE`], without any shift;
//! - ink closes it nearly: at most [`OPEN`] of its border is shared with the rest of the region.
//!
//! What vanished behind something has no outline there, and the flood runs past its place. Both are shares, so the width of the gap does not matter.
//!
//! # Limits
//!
//! A thing that moves by more than a few pixels beside its lines is not found. A fold that has just the form of what vanished there is taken for it.

use crate::layout::Layout;
use crate::regions::{flood, sides};
use rototoon_base::scene::Raster;

/// Least intersection by union.
const ALIKE: f64 = 0.85;
/// Largest share of the border that the gap takes.
const OPEN: f64 = 0.25;

/// Whether the last of the places in a region parts that from it which came from the region `source` of the painted drawing. `depth` is the depth of
/// each cell within the region, and `seen` the painted region that is seen in each cell of `to`.
pub fn has_leaked(source: usize, places: &[usize], depth: &Raster<f32>, to: &Layout, seen: &Raster<u32>) -> bool {
    let (width, height) = (depth.width(), depth.height());
    let flooded = flood(depth, places);
    let is_piece = |at: usize| flooded[at] as usize == places.len();
    let is_rest = |at: usize| flooded[at] > 0 && !is_piece(at);
    let came = |at: usize| seen.data()[at] as usize == source && to.inside.data()[at] > 0;
    let (mut both, mut any, mut border, mut open) = (0usize, 0usize, 0usize, 0usize);
    for at in 0..width * height {
        both += usize::from(is_piece(at) && came(at));
        any += usize::from(is_piece(at) || came(at));
        if is_piece(at) {
            border += sides(at, width, height).filter(|&next| !is_piece(next)).count();
            open += sides(at, width, height).filter(|&next| is_rest(next)).count();
        }
    }
    both as f64 >= ALIKE * any as f64 && open as f64 <= OPEN * border as f64
}
