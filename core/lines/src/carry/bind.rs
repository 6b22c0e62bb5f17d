//! A drawing to which strokes came from several sides: one set of strokes for its ink.
//!
//! The sides come in the order of trust. All numbers of the first one are taken. A stroke of a later one is taken where
//! nobody before it has its number, and where the drawing has ink for it that no other stroke explains. So a stroke that
//! appears or vanishes between two keys is there as long as its ink is.
//!
//! Two sides may put a stroke on different ink. The line is taken that explains more of what is left when all strokes are there on which
//! the sides agree, times its confidence. The other line may be right too, and its number wrong: a stroke was taken for another one on a key. If it lies on
//! ink that nobody explains in the end, it is told [apart](Bound::apart).
//!
//! A stroke that comes from several sides is as long as the sides together: a part of it that is hidden on one key is
//! known from the other. What goes on from the end of the first side's line, on ink that nobody explains, lengthens it. It is
//! surer where the sides agree, and less sure where they do not.

use super::EXPLAINS;
use super::confidence::of_both;
use super::samples::{Cells, of_line};
use crate::drawing::Drawing;
use crate::stroke::{Stroke, Tracked};
use rototoon_base::geometry::{Point, polyline};
use std::collections::BTreeMap;

/// Share of a stroke that others explain, from which it is one of them.
const SAME: f64 = 0.5;
/// Length of the shortest piece that lengthens a stroke, in distances in which a stroke explains ink.
const LEAST: f64 = 1.0;
/// Distance of a piece from the end that it lengthens, in the same unit.
const JOINS: f64 = 2.0;

/// One set of strokes for the ink of a drawing.
#[derive(Debug, Default)]
pub struct Bound {
    /// The strokes.
    pub strokes: Vec<Tracked>,
    /// Lines on ink that none of the strokes explains, with the numbers of strokes that are elsewhere, and whether they are of the first side.
    pub apart: Vec<(bool, Tracked)>,
}

/// The strokes of the first side, and what the others know besides, on `drawing`.
pub fn bind(sides: impl IntoIterator<Item = Vec<Tracked>>, drawing: &Drawing) -> Bound {
    let mut sides = sides.into_iter();
    let first = sides.next().unwrap_or_default();
    let (mut same, mut more): (Vec<Option<Tracked>>, Vec<Tracked>) = (vec![None; first.len()], Vec::new());
    let place: BTreeMap<usize, usize> = first.iter().enumerate().map(|(k, stroke)| (stroke.track, k)).collect();
    for other in sides.flatten().filter(|s| s.stroke.points.len() > 1) {
        match place.get(&other.track).map(|&k| &mut same[k]) {
            Some(free @ None) => *free = Some(other),
            Some(_) => {}
            None => more.push(other),
        }
    }
    let mut binding = Binding::new(EXPLAINS * drawing.unit + 0.5 * drawing.width);
    let mut apart = binding.chosen(first, &mut same);
    for (at, other) in same.into_iter().enumerate() {
        other.iter().for_each(|other| binding.lengthen(at, &other.stroke));
    }
    for other in more {
        match binding.place.get(&other.track) {
            Some(&at) => binding.join(at, &other),
            None if binding.explained(&binding.dense(&other.stroke)) < SAME => binding.add(other),
            None => {}
        }
    }
    let reach = binding.reach;
    let is_long = |s: &Stroke| polyline::length(&s.points, s.closed) >= LEAST * reach;
    apart.retain(|(_, s)| is_long(&s.stroke) && binding.explained(&binding.dense(&s.stroke)) < SAME);
    Bound { strokes: binding.strokes, apart }
}

/// Strokes that are being bound.
struct Binding {
    strokes: Vec<Tracked>,
    /// The place of each number among them.
    place: BTreeMap<usize, usize>,
    /// Points along them.
    points: Vec<Point>,
    cells: Cells,
    /// Distance in which a stroke explains ink.
    reach: f64,
}

impl Binding {
    fn new(reach: f64) -> Self {
        let (strokes, place, points) = (Vec::new(), BTreeMap::new(), Vec::new());
        Self { strokes, place, points, cells: Cells::new(std::iter::empty(), reach), reach }
    }

    /// Takes the strokes of the first side, each with the same stroke of another one. Where the two disagree, the better line is taken and the
    /// other one returned; `same` keeps those that agree.
    fn chosen(&mut self, mut first: Vec<Tracked>, same: &mut [Option<Tracked>]) -> Vec<(bool, Tracked)> {
        let mut open = Vec::new();
        for (k, own) in first.iter_mut().enumerate() {
            match &same[k] {
                Some(other) if !self.agree(&own.stroke, &other.stroke) => open.push(k),
                other => {
                    self.cover(self.dense(&own.stroke));
                    own.confidence =
                        other.as_ref().map_or(own.confidence, |o| of_both(own.confidence, o.confidence, true));
                }
            }
        }
        // The surest come first.
        let surest = |k: &usize| same[*k].as_ref().map_or(0.0, |other| other.confidence).max(first[*k].confidence);
        open.sort_by(|a, b| surest(b).total_cmp(&surest(a)).then(a.cmp(b)));
        let mut apart = Vec::new();
        for k in open {
            let Some(mut other) = same[k].take() else { continue };
            let own = &mut first[k];
            let better = self.worth(&other) > self.worth(own);
            if better {
                std::mem::swap(own, &mut other);
            }
            self.cover(self.dense(&own.stroke));
            own.confidence = of_both(own.confidence, other.confidence, false);
            apart.push((better, other));
        }
        self.place = first.iter().enumerate().map(|(k, stroke)| (stroke.track, k)).collect();
        self.strokes = first;
        apart
    }

    /// The length of ink that a stroke alone explains, times its confidence.
    fn worth(&self, tracked: &Tracked) -> f64 {
        let Tracked { stroke, confidence, .. } = tracked;
        let free = 1.0 - self.explained(&self.dense(stroke));
        confidence * free * polyline::length(&stroke.points, stroke.closed)
    }

    /// Whether most of a line lies on another one.
    fn agree(&self, own: &Stroke, other: &Stroke) -> bool {
        let near = |p: &&Point| polyline::distance(**p, &own.points, own.closed) <= self.reach;
        other.points.iter().filter(near).count() as f64 >= SAME * other.points.len() as f64
    }

    fn dense(&self, stroke: &Stroke) -> Vec<Point> {
        of_line(&stroke.points, stroke.closed, 0.5 * self.reach).into_iter().map(|sample| sample.place).collect()
    }

    fn add(&mut self, tracked: Tracked) {
        self.cover(self.dense(&tracked.stroke));
        self.place.insert(tracked.track, self.strokes.len());
        self.strokes.push(tracked);
    }

    fn cover(&mut self, own: Vec<Point>) {
        own.iter().enumerate().for_each(|(k, &p)| self.cells.add(self.points.len() + k, p));
        self.points.extend(own);
    }

    fn is_explained(&self, p: Point) -> bool {
        self.cells.near(p, self.reach).any(|k| self.points[k].distance(p) <= self.reach)
    }

    /// The share of points that strokes explain.
    fn explained(&self, points: &[Point]) -> f64 {
        points.iter().filter(|&&p| self.is_explained(p)).count() as f64 / points.len().max(1) as f64
    }

    /// Joins a stroke with the same stroke of another side.
    fn join(&mut self, at: usize, other: &Tracked) {
        let agree = self.agree(&self.strokes[at].stroke, &other.stroke);
        let own = &mut self.strokes[at];
        own.confidence = of_both(own.confidence, other.confidence, agree);
        self.lengthen(at, &other.stroke);
    }

    /// Adds to a stroke what `other`, the same stroke of another side, has beyond its ends.
    fn lengthen(&mut self, at: usize, other: &Stroke) {
        if self.strokes[at].stroke.closed || other.closed {
            return;
        }
        let free: Vec<bool> = other.points.iter().map(|&p| !self.is_explained(p)).collect();
        let places: Vec<usize> = (0..free.len()).collect();
        for run in places.chunk_by(|&a, &b| free[a] == free[b]).filter(|run| free[run[0]]) {
            let points = &other.points[run[0]..run[run.len() - 1] + 1];
            if polyline::length(points, false) < LEAST * self.reach {
                continue;
            }
            if extended(&mut self.strokes[at].stroke, other, run, JOINS * self.reach) {
                let own = of_line(points, false, 0.5 * self.reach).into_iter().map(|sample| sample.place).collect();
                self.cover(own);
            }
        }
    }
}

/// Joins the points `run` of `other` to an end of a stroke, if one of theirs is within `reach` of it.
fn extended(stroke: &mut Stroke, other: &Stroke, run: &[usize], reach: f64) -> bool {
    let (first, last) = (run[0], run[run.len() - 1]);
    let ends = [stroke.points[0], stroke.points[stroke.points.len() - 1]];
    let gaps =
        [(0, first), (0, last), (1, first), (1, last)].map(|(end, k)| (ends[end].distance(other.points[k]), end, k));
    let Some(&(gap, end, joined)) = gaps.iter().min_by(|a, b| a.0.total_cmp(&b.0)) else { return false };
    if gap > reach {
        return false;
    }
    let mut order: Vec<usize> = run.to_vec();
    // At the stroke's start the joined point comes last, at its end first.
    if (joined == first) == (end == 0) {
        order.reverse();
    }
    let at = if end == 0 { 0 } else { stroke.points.len() };
    stroke.points.splice(at..at, order.iter().map(|&k| other.points[k]));
    if !stroke.widths.is_empty() {
        let own = if end == 0 { stroke.widths[0] } else { stroke.widths[stroke.widths.len() - 1] };
        stroke.widths.splice(at..at, order.iter().map(|&k| other.widths.get(k).copied().unwrap_or(own)));
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Options;
    use rototoon_base::scene::Raster;
    use std::sync::Arc;

    /// Lines at the heights 30 and 70.
    fn drawing() -> Drawing {
        let ink = |x: usize, y: usize| (10..110).contains(&x) && (y.abs_diff(30) < 2 || y.abs_diff(70) < 2);
        let picture = Raster::from_fn(120, 100, |x, y| if ink(x, y) { [0.05; 3] } else { [1.0; 3] });
        Drawing::new(Arc::new(picture), &Options::default())
    }

    fn line(track: usize, y: f64, confidence: f64) -> Tracked {
        let points = (0..34).map(|k| Point::new(10.5 + 3.0 * f64::from(k), y + 0.5)).collect();
        let stroke = Stroke { points, ..Stroke::default() };
        Tracked { track, stroke, confidence }
    }

    fn heights(strokes: &[Tracked]) -> Vec<(usize, f64)> {
        strokes.iter().map(|s| (s.track, s.stroke.points[0].y - 0.5)).collect()
    }

    #[test]
    fn of_two_lines_of_a_stroke_the_one_that_explains_more_ink_is_taken() {
        let near = vec![line(1, 30.0, 0.9), line(2, 30.0, 0.6)];
        let far = vec![line(1, 30.0, 0.9), line(2, 70.0, 0.5)];
        let bound = bind([near, far], &drawing());
        assert_eq!(heights(&bound.strokes), [(1, 30.0), (2, 70.0)]);
        assert!(bound.apart.is_empty(), "stroke 1 explains the other line");
        assert!(bound.strokes[0].confidence > 0.9, "both sides agree");
        assert!(bound.strokes[1].confidence < 0.5, "and here they do not");
    }

    #[test]
    fn both_lines_of_a_stroke_stay_where_nothing_else_explains_them() {
        let [sure, unsure] = [(30.0, 0.9), (70.0, 0.6)];
        for (near, far, first) in [(sure, unsure, false), (unsure, sure, true)] {
            let bound = bind([vec![line(1, near.0, near.1)], vec![line(1, far.0, far.1)]], &drawing());
            assert_eq!(heights(&bound.strokes), [(1, 30.0)]);
            assert_eq!((bound.apart[0].0, heights(&[bound.apart[0].1.clone()])), (first, vec![(1, 70.0)]));
        }
    }
}
