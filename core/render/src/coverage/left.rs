//! The winding numbers of polygons at a vertical line, as functions of the height within a row.
//!
//! A scan from left to right adds the sides that it has passed. A side changes the winding number at the heights that it
//! spans. Sides that follow each other cancel where they meet. So few steps are left: none for a polygon outside of
//! which the line is, and two for a polygon that covers the line in the whole row.

use super::edge::Edge;
use std::collections::BTreeSet;

/// Height, and change of the winding number from there downward.
pub type Step = (i64, i32);

/// What a polygon covers of the line in the row.
#[derive(Clone, Copy, PartialEq, Eq)]
enum State {
    Nothing,
    All,
    Some,
}

/// The winding numbers of all polygons at a line.
pub struct Left {
    steps: Vec<Vec<Step>>,
    /// Polygons with steps, each at least once.
    touched: Vec<usize>,
    /// Polygons that cover some of the line.
    partly: BTreeSet<usize>,
    /// Number of polygons that cover all of it.
    full: usize,
    rows: (i64, i64),
}

impl Left {
    /// For a number of polygons.
    pub fn new(polygons: usize) -> Self {
        Self { steps: vec![Vec::new(); polygons], touched: Vec::new(), partly: BTreeSet::new(), full: 0, rows: (0, 0) }
    }

    /// Moves the line to the left end of the row between two heights.
    pub fn begin(&mut self, top: i64, bottom: i64) {
        self.touched.drain(..).for_each(|polygon| self.steps[polygon].clear());
        self.partly.clear();
        self.full = 0;
        self.rows = (top, bottom);
    }

    /// Lets a polygon without steps cover the line in the whole row.
    pub fn cover(&mut self, polygon: usize, winding: i32) {
        self.steps[polygon].extend([(self.rows.0, winding), (self.rows.1, -winding)]);
        self.touched.push(polygon);
        self.full += 1;
    }

    /// Moves the line over a side.
    pub fn pass(&mut self, edge: &Edge) {
        let (top, bottom) = self.rows;
        let before = self.state(edge.polygon());
        let steps = &mut self.steps[edge.polygon()];
        if steps.is_empty() {
            self.touched.push(edge.polygon());
        }
        add(steps, edge.top.max(top), edge.winding);
        add(steps, edge.bottom.min(bottom), -edge.winding);
        let after = self.state(edge.polygon());
        self.full = self.full + usize::from(after == State::All) - usize::from(before == State::All);
        if after == State::Some {
            self.partly.insert(edge.polygon());
        } else if before == State::Some {
            self.partly.remove(&edge.polygon());
        }
    }

    fn state(&self, polygon: usize) -> State {
        let (top, bottom) = self.rows;
        match self.steps[polygon][..] {
            [] => State::Nothing,
            [(first, _), (last, _)] if (first, last) == (top, bottom) => State::All,
            _ => State::Some,
        }
    }

    /// Number of polygons that cover the line in the whole row.
    pub fn full(&self) -> usize {
        self.full
    }

    /// Whether a polygon covers the line in the whole row.
    pub fn is_full(&self, polygon: usize) -> bool {
        self.state(polygon) == State::All
    }

    /// The polygons that cover the line in some of the row.
    pub fn partly(&self) -> impl Iterator<Item = usize> + '_ {
        self.partly.iter().copied()
    }

    /// The changes of a polygon's winding number, from top to bottom.
    pub fn steps(&self, polygon: usize) -> &[Step] {
        &self.steps[polygon]
    }
}

fn add(steps: &mut Vec<Step>, height: i64, change: i32) {
    match steps.binary_search_by_key(&height, |step| step.0) {
        Ok(at) => {
            steps[at].1 += change;
            if steps[at].1 == 0 {
                steps.remove(at);
            }
        }
        Err(at) => steps.insert(at, (height, change)),
    }
}

#[cfg(test)]
mod tests {
    use super::super::edge::{Instant, ROW};
    use super::*;
    use rototoon_base::geometry::Point;

    #[test]
    fn sides_that_meet_cancel() {
        let corners = [(0.0, -1.0), (9.0, -1.0), (9.0, 2.0), (0.0, 2.0), (1.0, 0.25), (0.5, 0.5), (1.5, 0.75)];
        let points: Vec<Point> = corners.iter().map(|&(x, y)| Point::new(x, y)).collect();
        let instant = Instant::new(&[points]);
        let mut left = Left::new(1);
        left.begin(0, ROW);
        let passed: Vec<&Edge> =
            instant.edges.iter().filter(|edge| edge.bottom > 0 && edge.top < ROW && edge.at(edge.top) < 5.0).collect();
        assert!(passed.len() > 2);
        passed.iter().for_each(|edge| left.pass(edge));
        assert!(left.is_full(0) && left.full() == 1 && left.partly().count() == 0, "{:?}", left.steps(0));
        for edge in instant.edges.iter().filter(|edge| edge.at(edge.top) > 5.0) {
            left.pass(edge);
        }
        assert!(left.full() == 0 && left.steps(0).is_empty());
        left.pass(passed[0]);
        assert_eq!(left.partly().collect::<Vec<_>>(), [0]);
        left.begin(ROW, 2 * ROW);
        assert!(left.partly().count() == 0 && left.steps(0).is_empty());
    }
}
