//! The order of depth, and its changes over time.

/// A place in the order of depth. Larger is nearer: the layer decides first, the stroke within a layer next.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Depth {
    /// Depth of the layer, or of anything that moves to the front or back as a unit.
    pub layer: i32,
    /// Depth of the stroke within it.
    pub stroke: i32,
}

/// A depth over time. It is constant except for the frames at which it changes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct DepthOrder {
    first: i32,
    /// Pairs of frame and depth, rising by frame.
    changes: Vec<(i32, i32)>,
}

impl DepthOrder {
    /// The same depth on all frames.
    pub fn constant(depth: i32) -> Self {
        Self { first: depth, changes: Vec::new() }
    }

    /// Sets another depth from `frame` on, until the next change. It replaces a change at the same frame.
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
