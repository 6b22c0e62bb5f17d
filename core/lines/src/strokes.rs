//! Paired branches become strokes.
//!
//! A stroke is walked from an end that nothing follows on, branch by branch. Rings that have no such end are closed
//! strokes. Through a junction a stroke goes straight; at a corner it goes through the point where both sides would meet.
//! A stroke that ends at a junction goes on in its own direction up to the line that it meets.

use crate::direction::{End, outward, place};
use crate::graph::{Graph, Junction};
use crate::pairing::Pairing;
use rototoon_base::geometry::Point;

/// A line before it is fitted.
#[derive(Clone, Debug, Default)]
pub struct Walked {
    /// Points, about a pixel apart; farther apart in junctions and gaps.
    pub points: Vec<Point>,
    /// Half the width at each point.
    pub radii: Vec<f64>,
    /// Whether the last point joins the first.
    pub closed: bool,
    /// Whether each end is one of the ink, not a junction.
    pub free: [bool; 2],
    /// Whether it is the outline of a solid shape.
    pub fill: bool,
}

/// Cosine of the turn from which a passage through a junction is a corner.
const CORNER: f64 = 0.8;

/// All strokes of a graph.
pub fn walked(graph: &Graph, pairing: &Pairing) -> Vec<Walked> {
    let mut done: Vec<bool> = (0..graph.branches.len()).map(|k| pairing.is_shared(k)).collect();
    let mut strokes = Vec::new();
    for k in 0..graph.branches.len() {
        for side in 0..2 {
            if !done[k] && pairing.next((k, side)).is_none() {
                strokes.push(walk(graph, pairing, (k, side), &mut done));
            }
        }
    }
    for k in 0..graph.branches.len() {
        if !done[k] {
            strokes.push(walk(graph, pairing, (k, 0), &mut done));
        }
    }
    // Shapes are behind lines.
    strokes.sort_by_key(|stroke| !stroke.fill);
    strokes
}

/// The stroke that begins at an end and leads into its branch.
fn walk(graph: &Graph, pairing: &Pairing, start: End, done: &mut [bool]) -> Walked {
    let mut stroke = Walked::default();
    let junction = |(branch, side): End| graph.branches[branch].ends[side].map(|j| &graph.junctions[j]);
    let ring = graph.branches[start.0].closed;
    if pairing.next(start).is_none() && !ring {
        stroke.free[0] = junction(start).is_none();
        stroke.tip(graph, start, junction(start));
    }
    let mut at = start;
    loop {
        let (branch, side) = at;
        done[branch] = true;
        let own = &graph.branches[branch];
        stroke.fill = own.fill;
        let order: Vec<usize> =
            if side == 0 { (0..own.points.len()).collect() } else { (0..own.points.len()).rev().collect() };
        stroke.points.extend(order.iter().map(|&i| own.points[i]));
        stroke.radii.extend(order.iter().map(|&i| own.radii[i]));
        let end = (branch, 1 - side);
        match pairing.next(end) {
            None => {
                stroke.closed = ring;
                if !ring {
                    stroke.free[1] = junction(end).is_none();
                    stroke.tip(graph, end, junction(end));
                }
                return stroke;
            }
            Some(next) => {
                let between = pairing.between(end);
                stroke.points.extend(between.iter().map(|&(point, _)| point));
                stroke.radii.extend(between.iter().map(|&(_, radius)| radius));
                if between.is_empty() {
                    stroke.pass(graph, end, next);
                }
                if next == start || done[next.0] {
                    stroke.closed = next == start;
                    return stroke;
                }
                at = next;
            }
        }
    }
}

impl Walked {
    /// Length in pixels.
    pub fn length(&self) -> f64 {
        rototoon_base::geometry::polyline::length(&self.points, self.closed)
    }

    /// Goes on from an end to the line that it meets at a junction.
    fn tip(&mut self, graph: &Graph, end: End, junction: Option<&Junction>) {
        let Some(junction) = junction else { return };
        let (from, direction) = (place(graph, end), outward(graph, end));
        let ahead = (junction.place - from).dot(direction);
        if ahead > 0.0 {
            self.add(graph, end, from + ahead * direction);
        }
    }

    /// Goes through a junction or a gap.
    fn pass(&mut self, graph: &Graph, from: End, to: End) {
        let (a, b) = (place(graph, from), place(graph, to));
        let (u, v) = (outward(graph, from), outward(graph, to));
        if u.dot(-v) > CORNER {
            return;
        }
        // a + s u = b + t v
        let crossing = u.perp_dot(v);
        if crossing.abs() > 0.2 {
            let s = (b - a).perp_dot(v) / crossing;
            let t = (b - a).perp_dot(u) / crossing;
            let most = 1.5 * a.distance(b) + 1.0;
            if (0.0..most).contains(&s) && (0.0..most).contains(&t) {
                self.add(graph, from, a + s * u);
            }
        }
    }

    fn add(&mut self, graph: &Graph, (branch, side): End, point: Point) {
        let radii = &graph.branches[branch].radii;
        self.points.push(point);
        self.radii.push(if side == 0 { radii[0] } else { radii[radii.len() - 1] });
    }
}
