//! What a file of shapes may ask for.
//!
//! A file of a hundred bytes can describe an arc that is as long as the sky is wide, and one of a megabyte can be
//! nested so deep that a walk through it fills the stack. These limits are far above what drawing programs write and far
//! below what hurts. Where one is passed, an error names the element, what was found, and the limit.

use super::ImportError;
use rototoon_base::geometry::Point;
use roxmltree::{Document, Node};

/// Greatest coordinate, radius or length, in units of the file and in pixels of the footage.
pub(super) const FARTHEST: f64 = 1e7;
/// Greatest depth of elements within each other.
pub(super) const DEEPEST: usize = 256;
/// Greatest number of nodes of an XML file. They take about 1 GB.
pub(super) const MOST_NODES: u32 = 10_000_000;
/// Greatest number of points of all contours of a file on all keys. They take about 1 GB.
pub(super) const MOST_POINTS: usize = 20_000_000;

/// The points that a file may still have.
pub(super) struct Points {
    left: usize,
}

impl Points {
    pub(super) fn all() -> Self {
        Self { left: MOST_POINTS }
    }

    /// Takes points for an element.
    pub(super) fn take(&mut self, count: usize, node: Node) -> Result<(), ImportError> {
        match self.left.checked_sub(count) {
            Some(left) => self.left = left,
            None => {
                let message = format!("found more than {MOST_POINTS} points up to here, expected fewer");
                return Err(ImportError::at(node, message));
            }
        }
        Ok(())
    }
}

/// Requires that a point is within [`FARTHEST`].
pub(super) fn near(p: Point, node: Node) -> Result<Point, ImportError> {
    if p.x.abs() <= FARTHEST && p.y.abs() <= FARTHEST {
        return Ok(p);
    }
    let message = format!("found a point at ({:e}, {:e}) pixels, expected at most {FARTHEST:e} from 0", p.x, p.y);
    Err(ImportError::at(node, message))
}

/// Requires that no element is deeper than [`DEEPEST`].
pub(super) fn shallow(document: &Document) -> Result<(), ImportError> {
    let mut depths: Vec<u32> = Vec::new();
    // A parent comes before its children, and ids count the nodes.
    for node in document.descendants() {
        let depth = node.parent().map_or(0, |parent| depths[parent.id().get_usize()] + 1);
        if depth as usize > DEEPEST {
            let message = format!("found elements nested {depth} deep, expected at most {DEEPEST}");
            return Err(ImportError::at(node, message));
        }
        depths.push(depth);
    }
    Ok(())
}
