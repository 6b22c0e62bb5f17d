//! A drawing between two keys: the strokes that come from both of them.
//!
//! The nearer key knows better how the drawing looks, so its strokes are taken. A stroke that only the farther key has is
//! taken too, where the drawing has ink for it that no other stroke explains. So a stroke that appears or vanishes between
//! the keys is there as long as its ink is.

use super::EXPLAINS;
use super::samples::{Cells, of_line};
use crate::drawing::Drawing;
use crate::stroke::{Stroke, Tracked};
use rototoon_base::geometry::Point;

/// Share of a stroke that others explain, from which it is one of them.
const SAME: f64 = 0.5;

/// The strokes of `nearer` and those of `farther` that it lacks, on `drawing`. Numbers from `new` on are those that the
/// nearer key's strokes got on the way: they give way to strokes that the farther key knows.
pub fn bind(nearer: Vec<Tracked>, farther: &[Tracked], drawing: &Drawing, new: usize) -> Vec<Tracked> {
    let reach = EXPLAINS * drawing.unit + 0.5 * drawing.width;
    let dense = |stroke: &Stroke| -> Vec<Point> {
        of_line(&stroke.points, stroke.closed, 0.5 * reach).into_iter().map(|sample| sample.place).collect()
    };
    let (mut kept, fresh): (Vec<Tracked>, Vec<Tracked>) = nearer.into_iter().partition(|s| s.track < new);
    let mut explained: Vec<Point> = kept.iter().flat_map(|s| dense(&s.stroke)).collect();
    for more in farther.iter().cloned().chain(fresh) {
        let own = dense(&more.stroke);
        let cells = Cells::new(explained.iter().copied(), reach);
        let near = |p: &&Point| cells.near(**p, reach).any(|k| explained[k].distance(**p) <= reach);
        let shared = own.iter().filter(near).count() as f64;
        if kept.iter().all(|s| s.track != more.track) && shared < SAME * own.len() as f64 {
            explained.extend(own);
            kept.push(more);
        }
    }
    kept
}
