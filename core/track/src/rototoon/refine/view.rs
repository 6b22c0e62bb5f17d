//! What the refiner sees: the keys, and the frame to refine on.

use crate::rototoon::lattice::texture::Cover;
use crate::shared::features::Features;
use rototoon_base::geometry::Point;
use std::collections::BTreeMap;

/// One key as input of the refinement.
pub struct Key<'a> {
    /// Control points in working pixels.
    pub points: &'a [Point],
    /// The key's picture.
    pub picture: &'a Features,
    /// What hides the part at the key.
    pub cover: &'a Cover,
}

/// A frame as input of the refinement.
pub struct Frame<'a> {
    /// Its picture.
    pub picture: &'a Features,
    /// What hides the part.
    pub cover: &'a Cover,
    /// Share of the time from the first key to the second.
    pub share: f64,
    /// Control points that the artist fixed, by index, in working pixels.
    pub pins: BTreeMap<usize, Point>,
}
