//! What lies in front of what.

/// Place in the order of depth. Larger is nearer: first by layer, within a layer by stroke.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Depth {
    /// Of the layer, or of whatever is moved to the front or back as a whole.
    pub layer: i32,
    /// Of the stroke within it.
    pub stroke: i32,
}

/// A depth over time: constant but for the frames at which it changes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct DepthOrder {
    first: i32,
    /// Rising by frame.
    changes: Vec<(i32, i32)>,
}

impl DepthOrder {
    /// The same depth on all frames.
    pub fn constant(depth: i32) -> Self {
        Self { first: depth, changes: Vec::new() }
    }

    /// Another depth from `frame` on, until the next change; replaces a change at the same frame.
    pub fn change_at(&mut self, frame: i32, depth: i32) {
        match self.changes.binary_search_by_key(&frame, |change| change.0) {
            Ok(i) => self.changes[i].1 = depth,
            Err(i) => self.changes.insert(i, (frame, depth)),
        }
    }

    /// The depth on a frame.
    pub fn at(&self, frame: i32) -> i32 {
        let passed = self.changes.partition_point(|change| change.0 <= frame);
        if passed == 0 { self.first } else { self.changes[passed - 1].1 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depth_changes_at_its_frames() {
        let mut order = DepthOrder::constant(1);
        order.change_at(9, 4);
        order.change_at(5, -2);
        order.change_at(9, 3);
        assert_eq!([-100, 4, 5, 8, 9, 1000].map(|frame| order.at(frame)), [1, 1, -2, -2, 3, 3]);
        assert!(Depth { layer: 1, stroke: 0 } > Depth { layer: 0, stroke: 9 });
    }
}
