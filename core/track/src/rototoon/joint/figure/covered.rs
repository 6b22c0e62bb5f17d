//! The blocks that the hypotheses of a contender cover.

use super::blocks::Blocks;
use crate::rototoon::joint::contender::Contender;
use crate::rototoon::pool::Hypothesis;

/// The blocks inside the contour of each hypothesis, by drawing.
pub type Covered = Vec<Vec<Blocks>>;

/// The blocks inside the contour of each hypothesis of a contender, in a picture of so many columns and rows of blocks.
pub fn covered(contender: &Contender, size: (usize, usize)) -> Covered {
    let of = |pool: &Vec<Hypothesis>| pool.iter().map(|h| Blocks::inside(&h.points, size)).collect();
    contender.pools.iter().map(of).collect()
}
