//! What a joint choice leaves unexplained, as a guide for further hypotheses.

use super::blocks::{BLOCK, Blocks};
use super::canvas::Canvas;
use rototoon_base::geometry::Point;
use rototoon_base::scene::FrameNumber;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The blocks that each part covers where a joint choice puts it.
#[derive(Debug, PartialEq)]
pub struct Claims {
    pub(super) canvas: Arc<Canvas>,
    /// By name of the part and first frame of the drawing.
    pub(super) parts: BTreeMap<String, BTreeMap<FrameNumber, Blocks>>,
}

/// The figure near a part on a drawing that no other part covers.
#[derive(Clone, Debug, PartialEq)]
pub struct Unclaimed {
    rest: Blocks,
    size: (usize, usize),
}

impl Claims {
    /// What the other parts leave for a part on the drawing that begins at a frame, within a box of two corners (working
    /// pixels).
    pub fn unclaimed(&self, part: &str, frame: FrameNumber, (low, high): (Point, Point)) -> Option<Unclaimed> {
        let corners = [low, Point::new(high.x, low.y), high, Point::new(low.x, high.y)];
        let mut rest = Blocks::inside(&corners, self.canvas.size).common(self.canvas.at(frame)?);
        let others = self.parts.iter().filter(|(name, _)| *name != part).filter_map(|(_, on)| on.get(&frame));
        others.for_each(|blocks| rest.remove(blocks));
        Some(Unclaimed { rest, size: self.canvas.size })
    }
}

impl Unclaimed {
    /// How much of it a contour covers, as a share of an area in square working pixels.
    pub fn share(&self, contour: &[Point], area: f64) -> f64 {
        let covered = self.rest.shared(&Blocks::inside(contour, self.size));
        covered as f64 * BLOCK * BLOCK / area.max(super::LEAST_AREA)
    }
}
