//! The numbers of strokes that were drawn on a frame to which others were carried.
//!
//! A drawn stroke has the number of the carried stroke with which it shares most of its length: the share of points of the
//! one near the other, both ways, is high. All pairs are chosen together (assignment). A drawn stroke without a counterpart
//! is new.

use super::samples::{Cells, of_line};
use crate::stroke::{Stroke, Tracked};
use rototoon_base::geometry::Point;
use rototoon_base::numeric::sparse_assignment::{Choice, assign_sparse};
use std::collections::BTreeSet;

/// Distance at which lines are the same, at 540 lines.
const NEAR: f64 = 6.0;
/// Least mean of both shares.
const SHARED: f64 = 0.4;

/// The drawn strokes with the numbers of `carried` ones, or with numbers from `next` on, which is raised. `unit` is the size of a pixel
/// of 540 lines.
pub fn identify(carried: &[Tracked], drawn: Vec<Stroke>, unit: f64, next: &mut usize) -> Vec<Tracked> {
    let reach = NEAR * unit;
    let dense = |stroke: &Stroke| -> Vec<Point> {
        of_line(&stroke.points, stroke.closed, 0.5 * reach).into_iter().map(|sample| sample.place).collect()
    };
    let own: Vec<Vec<Point>> = drawn.iter().map(dense).collect();
    let theirs: Vec<Vec<Point>> = carried.iter().map(|tracked| dense(&tracked.stroke)).collect();
    let all = |lines: &[Vec<Point>]| Cells::new(lines.iter().flatten().copied(), reach);
    let lines: Vec<usize> = theirs.iter().enumerate().flat_map(|(k, line)| line.iter().map(move |_| k)).collect();
    let (cells, flat): (Cells, Vec<Point>) = (all(&theirs), theirs.iter().flatten().copied().collect());
    let choices: Vec<Vec<Choice>> = own
        .iter()
        .map(|line| {
            let mut near: Vec<usize> = line
                .iter()
                .flat_map(|&p| cells.near(p, reach).map(move |k| (p, k)))
                .filter(|&(p, k)| flat[k].distance(p) <= reach)
                .map(|(_, k)| lines[k])
                .collect();
            near.sort_unstable();
            near.dedup();
            let cost = |k: usize| Choice {
                column: k,
                cost: 1.0 - 0.5 * (share(line, &theirs[k], reach) + share(&theirs[k], line, reach)),
            };
            near.into_iter().map(cost).collect()
        })
        .collect();
    let found = assign_sparse(&choices, &vec![1.0 - SHARED; own.len()], carried.len());
    let number = |found: Option<usize>| found.map_or_else(|| (*next, *next += 1).0, |k| carried[k].track);
    let numbers: Vec<usize> = found.into_iter().map(number).collect();
    numbers.into_iter().zip(drawn).map(|(track, stroke)| Tracked::sure(track, stroke)).collect()
}

/// As [`identify`], but `carried` strokes come after those that are `seen` on the drawing: of two on the same ink the hidden one is the wrong one.
pub fn identify_seen(
    seen: &[Tracked],
    carried: &[Tracked],
    drawn: Vec<Stroke>,
    unit: f64,
    next: &mut usize,
) -> Vec<Tracked> {
    let none = usize::MAX - drawn.len();
    let mut found = identify(seen, drawn, unit, &mut none.clone());
    let met: BTreeSet<usize> = found.iter().map(|stroke| stroke.track).collect();
    let left: Vec<Tracked> = carried.iter().filter(|stroke| !met.contains(&stroke.track)).cloned().collect();
    let open: Vec<&mut Tracked> = found.iter_mut().filter(|stroke| stroke.track >= none).collect();
    let lines = open.iter().map(|stroke| stroke.stroke.clone()).collect();
    for (stroke, named) in open.into_iter().zip(identify(&left, lines, unit, next)) {
        stroke.track = named.track;
    }
    found
}

/// The share of the points of `a` within `reach` of a point of `b`.
fn share(a: &[Point], b: &[Point], reach: f64) -> f64 {
    a.iter().filter(|p| b.iter().any(|q| q.distance(**p) <= reach)).count() as f64 / a.len().max(1) as f64
}
