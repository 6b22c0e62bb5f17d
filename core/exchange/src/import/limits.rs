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
    /// Whether more were asked for.
    pub spent: bool,
}

impl Points {
    pub(super) fn all() -> Self {
        Self { left: MOST_POINTS, spent: false }
    }

    /// Takes points for an element.
    pub(super) fn take(&mut self, count: usize, node: Node) -> Result<(), ImportError> {
        match self.left.checked_sub(count) {
            Some(left) => self.left = left,
            None => {
                self.spent = true;
                let message = format!("found more than {MOST_POINTS} points up to here, expected fewer");
                return Err(ImportError::at(node, message));
            }
        }
        Ok(())
    }
}

/// Says that a file of XML has more nodes than this crate reads; `None` if it does not. It counts elements and the texts between tags.
pub fn too_large(text: &str) -> Option<String> {
    too_many(text, MOST_NODES as usize)
}

fn too_many(text: &str, most: usize) -> Option<String> {
    let starts = |pair: &&[u8]| pair[0] == b'<' && !b"/!?".contains(&pair[1]);
    let texts = |pair: &&[u8]| pair[0] == b'>' && pair[1] != b'<';
    let count = text.as_bytes().windows(2).filter(|pair| starts(pair) || texts(pair)).count();
    let bytes = text.len() as f64 / 1e9;
    (count > most)
        .then(|| format!("the file has {count} elements and texts ({bytes:.1} GB): import reads at most {most}"))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_are_counted_as_the_parser_does() {
        let text = "<?xml version=\"1.0\"?><!-- c --><a b=\"1\"> <c>1</c><d/>\n</a>";
        let nodes = Document::parse(text).unwrap().descendants().filter(|n| n.is_element() || n.is_text()).count();
        assert_eq!(nodes, 6);
        assert_eq!(too_many(text, nodes), None);
        let told = too_many(text, nodes - 1).unwrap();
        assert!(told.contains("has 6 elements and texts") && told.contains("at most 5"), "{told}");
    }
}
