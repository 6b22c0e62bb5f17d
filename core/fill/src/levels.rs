//! How narrow the ways through a region are.
//!
//! The *depth* of a cell is its distance to ink. The *level* of a cell is the least depth on the way to it on which that is
//! greatest: half the width of the narrowest place that one must pass. It is found as shortest ways are, the deepest cell first
//! (the widest path problem).

use crate::regions::sides;
use rototoon_base::scene::Raster;
use std::collections::BinaryHeap;

/// Half the width of the widest gap, in pixels at 540 lines.
pub const GAP: f64 = 5.0;

/// For each cell the depth of the shallowest cell on the deepest way to it from a start; 0 where there is no way.
pub fn levels(depth: &Raster<f32>, start: usize) -> Vec<f32> {
    let (width, height) = (depth.width(), depth.height());
    let mut levels = vec![0.0f32; width * height];
    // Depths are ordered by their bits, since they are positive.
    let mut front = BinaryHeap::from([(depth.data()[start].to_bits(), start)]);
    while let Some((level, at)) = front.pop() {
        let level = f32::from_bits(level);
        if levels[at] >= level {
            continue;
        }
        levels[at] = level;
        for next in sides(at, width, height) {
            let way = level.min(depth.data()[next]);
            if way > levels[next] {
                front.push((way.to_bits(), next));
            }
        }
    }
    levels
}
