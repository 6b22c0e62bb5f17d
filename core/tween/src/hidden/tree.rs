//! Search for boxes by place: a static binary tree of bounding boxes (a bounding volume hierarchy). Each node is split
//! at the median of its centres, along the longer side. Building costs n log² n. A query costs log n for each box that
//! it finds.

use rototoon_base::geometry::Point;

/// The smallest and the largest coordinates of a box.
pub(super) type Bounds = (Point, Point);

/// Largest number of boxes in a leaf.
const LEAF: usize = 4;

/// Whether two closed boxes share a point.
pub(super) fn meet(a: Bounds, b: Bounds) -> bool {
    a.0.cmple(b.1).all() && b.0.cmple(a.1).all()
}

/// The box around several boxes; an inverted box where there are none.
pub(super) fn around(boxes: impl IntoIterator<Item = Bounds>) -> Bounds {
    let nothing = (Point::INFINITY, Point::NEG_INFINITY);
    boxes.into_iter().fold(nothing, |(low, high), (l, h)| (low.min(l), high.max(h)))
}

struct Node {
    bounds: Bounds,
    /// The items of a leaf: a range of `order`. The left child of an inner node is the next node.
    items: (u32, u32),
    /// The right child; 0 for a leaf.
    right: u32,
}

/// The tree of boxes.
pub(super) struct Tree {
    nodes: Vec<Node>,
    order: Vec<u32>,
    boxes: Vec<Bounds>,
}

impl Tree {
    pub(super) fn new(boxes: Vec<Bounds>) -> Self {
        let mut tree = Self { nodes: Vec::new(), order: (0..boxes.len() as u32).collect(), boxes };
        if !tree.order.is_empty() {
            tree.build(0, tree.order.len());
        }
        tree
    }

    /// The box around all boxes.
    pub(super) fn bounds(&self) -> Bounds {
        self.nodes.first().map_or_else(|| around([]), |root| root.bounds)
    }

    fn build(&mut self, from: usize, to: usize) -> u32 {
        let boxes = &self.boxes;
        let bounds = around(self.order[from..to].iter().map(|&i| boxes[i as usize]));
        let node = self.nodes.len();
        self.nodes.push(Node { bounds, items: (from as u32, to as u32), right: 0 });
        if to - from > LEAF {
            let centre = |i: u32| boxes[i as usize].0 + boxes[i as usize].1;
            let spread = around(self.order[from..to].iter().map(|&i| (centre(i), centre(i))));
            let axis = usize::from((spread.1 - spread.0).y > (spread.1 - spread.0).x);
            let middle = (to - from) / 2;
            // The index breaks ties, so that the tree is the same on every machine.
            let key = |i: &u32, j: &u32| centre(*i)[axis].total_cmp(&centre(*j)[axis]).then(i.cmp(j));
            self.order[from..to].select_nth_unstable_by(middle, key);
            self.build(from, from + middle);
            self.nodes[node].right = self.build(from + middle, to);
        }
        node as u32
    }

    /// Calls `found` with the index of each box that meets `wanted`. The order depends on the boxes alone.
    pub(super) fn query(&self, wanted: Bounds, mut found: impl FnMut(usize)) {
        let mut open = [0u32; 64];
        let mut count = usize::from(!self.nodes.is_empty());
        while count > 0 {
            count -= 1;
            let at = open[count];
            let node = &self.nodes[at as usize];
            if !meet(node.bounds, wanted) {
                continue;
            }
            if node.right == 0 {
                let items = &self.order[node.items.0 as usize..node.items.1 as usize];
                items.iter().map(|&i| i as usize).filter(|&i| meet(self.boxes[i], wanted)).for_each(&mut found);
            } else {
                // Each level halves the items, so the depth never exceeds half of this array.
                open[count] = node.right;
                open[count + 1] = at + 1;
                count += 2;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn any_box() -> impl Strategy<Value = Bounds> {
        (-9.0f64..9.0, -9.0f64..9.0, 0.0f64..4.0, 0.0f64..4.0)
            .prop_map(|(x, y, w, h)| (Point::new(x, y), Point::new(x + w, y + h)))
    }

    proptest! {
        #[test]
        fn a_query_finds_exactly_the_boxes_that_meet(boxes in prop::collection::vec(any_box(), 0..60), wanted in any_box()) {
            let tree = Tree::new(boxes.clone());
            let mut found = Vec::new();
            tree.query(wanted, |i| found.push(i));
            found.sort_unstable();
            let naive: Vec<usize> = (0..boxes.len()).filter(|&i| meet(boxes[i], wanted)).collect();
            prop_assert_eq!(found, naive);
        }
    }

    #[test]
    fn equal_boxes_are_all_found() {
        let one = (Point::ZERO, Point::ONE);
        let mut found = 0;
        Tree::new(vec![one; 1000]).query(one, |_| found += 1);
        assert_eq!(found, 1000);
    }
}
