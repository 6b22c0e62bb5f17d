//! Correspondence of places on a stroke and on its counterpart: proportional arc length (Yang et al. 1986, Appendix F)
//! between corresponding [`super::corners`].
//!
//! If an artist drew both strokes with the same number of points, the points themselves may correspond. They are used
//! where points of equal number have nearly equal shares of the length, or where an affine map leads each to its counterpart: an eye that
//! closes is a copy that was squashed, and the shares of its points change.

use super::super::line::{Line, vertex_shares};
use super::super::matching::Pair;
use super::super::stroke::Stroke;
use super::corners::Shares;
use crate::affine::{Affine, COPY};
use rototoon_base::geometry::Point;

/// Largest mean difference of shares at which points of equal number are taken.
const MEAN_OFF: f64 = 0.04;

/// Places of a stroke that are followed from drawing to drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct Places {
    /// Positions in pixels.
    pub points: Vec<Point>,
    /// The share of the stroke's length, from its first point forwards, at each place.
    pub shares: Vec<f64>,
    /// Indices of the stroke's own points, if the places are those points.
    pub own: Option<Vec<usize>>,
}

impl Places {
    /// All points of a stroke.
    pub(super) fn all(stroke: &Stroke) -> Self {
        let mut shares = vertex_shares(stroke);
        shares.truncate(stroke.points.len());
        Self { points: stroke.points.clone(), shares, own: Some((0..stroke.points.len()).collect()) }
    }

    /// Places on the part of a stroke between two shares of its length. `shares` are shares of that part.
    pub(super) fn part(stroke: &Stroke, from: f64, to: f64, shares: &[f64]) -> Self {
        let shares: Vec<f64> = shares.iter().map(|s| from + (to - from) * s).collect();
        let line = Line::new(stroke);
        Self { points: shares.iter().map(|&s| line.at(s)).collect(), shares, own: None }
    }

    /// The same places on the counterpart. If the counterpart has no points, the places stay where they are.
    pub(super) fn on(&self, stroke: &Stroke, other: &Stroke, pair: &Pair) -> Self {
        if other.points.is_empty() {
            let points = self.points.clone();
            return Self { points, shares: self.shares.clone(), own: None };
        }
        if let Some(own) = self.own_points(stroke, other, pair.reversed, pair.start) {
            let shares = vertex_shares(other);
            return Self {
                points: own.iter().map(|&i| other.points[i]).collect(),
                shares: own.iter().map(|&i| shares[i]).collect(),
                own: Some(own),
            };
        }
        let aligned = Shares::new(stroke, other, pair);
        let shares: Vec<f64> = self.shares.iter().map(|&s| aligned.at(s)).collect();
        let line = Line::new(other);
        Self { points: shares.iter().map(|&s| line.at(s)).collect(), shares, own: None }
    }

    /// For each place the indices of the two points of the stroke around it, and the weight of the second, 0 to 1.
    pub fn blends(&self, stroke: &Stroke) -> Vec<(usize, usize, f64)> {
        match &self.own {
            Some(own) => own.iter().map(|&i| (i, i, 0.0)).collect(),
            None if stroke.points.is_empty() => vec![(0, 0, 0.0); self.points.len()],
            None => {
                let line = Line::new(stroke);
                self.shares.iter().map(|&share| line.between(share)).collect()
            }
        }
    }

    /// The counterpart's own points, if there are as many and they have nearly the same shares, or are a changed copy.
    fn own_points(&self, stroke: &Stroke, other: &Stroke, reversed: bool, start: f64) -> Option<Vec<usize>> {
        let own = self.own.as_ref()?;
        let n = stroke.points.len();
        if other.points.len() != n || own.len() != n || stroke.closed != other.closed {
            return None;
        }
        let (here, there) = (vertex_shares(stroke), vertex_shares(other));
        let apart = |a: f64, b: f64| if other.closed { (a - b - (a - b).round()).abs() } else { (a - b).abs() };
        let nearest = (0..n).min_by(|&i, &j| apart(there[i], start).total_cmp(&apart(there[j], start)))?;
        let first = if other.closed {
            nearest
        } else if reversed {
            n - 1
        } else {
            0
        };
        let index = |i: usize| if reversed { (first + n - i) % n } else { (first + i) % n };
        let off = |i: usize| {
            let walked = if reversed { there[first] - there[index(i)] } else { there[index(i)] - there[first] };
            apart(here[i], walked)
        };
        let mean = (0..n).map(off).sum::<f64>() / n.max(1) as f64;
        let copied = || {
            let there: Vec<Point> = (0..n).map(|i| other.points[index(i)]).collect();
            Affine::fit(&stroke.points, &there).is_some_and(|affine| affine.residual <= COPY)
        };
        (mean <= MEAN_OFF || copied()).then(|| own.iter().map(|&i| index(i)).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pair(reversed: bool, start: f64) -> Pair {
        Pair { from: 0, to: 0, reversed, start, confidence: 1.0, by_hand: false }
    }

    fn stroke(points: &[(f64, f64)], closed: bool) -> Stroke {
        Stroke::new(points.iter().copied().map(Point::from).collect(), closed)
    }

    #[test]
    fn other_counts_go_by_proportional_length() {
        let a = stroke(&[(0.0, 0.0), (1.0, 0.0), (4.0, 0.0)], false);
        let b = stroke(&[(0.0, 8.0), (0.0, 2.0), (0.0, 0.0), (0.0, 0.0)], false);
        let on = Places::all(&a).on(&a, &b, &pair(true, 0.0));
        assert_eq!(on.points, [(0.0, 0.0), (0.0, 2.0), (0.0, 8.0)].map(Point::from));
        assert_eq!(on.shares, [1.0, 0.75, 0.0]);
        // Back again, although b has different points.
        assert_eq!(on.on(&b, &a, &pair(true, 0.0)).points, a.points);
    }

    #[test]
    fn own_points_are_taken_where_they_lie_alike() {
        let a = stroke(&[(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)], true);
        let b = stroke(&[(10.0, 11.0), (11.0, 0.0), (0.0, 0.5), (0.0, 10.0)], true);
        let on = Places::all(&a).on(&a, &b, &pair(true, 0.5));
        assert_eq!(on.own, Some(vec![2, 1, 0, 3]));
        let c = stroke(&[(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (0.0, 10.0)], true);
        assert_eq!(Places::all(&a).on(&a, &c, &pair(false, 0.0)).own, None);
    }

    #[test]
    fn points_and_nothing() {
        let (dot, none) = (stroke(&[(3.0, 4.0)], false), stroke(&[], true));
        let line = stroke(&[(0.0, 0.0), (8.0, 0.0), (8.0, 0.0)], false);
        assert_eq!(Places::all(&line).on(&line, &dot, &pair(false, 0.0)).points, [Point::new(3.0, 4.0); 3]);
        assert_eq!(Places::all(&dot).on(&dot, &line, &pair(false, 0.0)).points, [Point::ZERO]);
        assert_eq!(Places::all(&line).on(&line, &none, &pair(false, 0.0)).points, line.points);
        assert!(Places::all(&none).on(&none, &line, &pair(false, 0.0)).points.is_empty());
    }
}
