//! Contours that an artist drew afresh, matched to the parts of an earlier key.
//!
//! Nothing is assumed of the order, direction, starting point or number of points of what was drawn. First it is decided
//! which contour is which part (`figure`: shape, size, place in the figure, colour, all at once), then where on it the part's
//! control points lie (`elastic`). What fits nothing stays without counterpart.
//!
//! An artist who drew a contour with as many points as the part has meant them: where the elastic map agrees with a plain
//! shift of the indices, the drawn points themselves are returned.
//!
//! Limits: contours are compared by their sight alone; two equal limbs that have changed places are told apart by nothing
//! but their neighbours and colours. A disc does not show its turn: it is taken to have turned with the figure.

mod elastic;
mod figure;
mod outline;

use crate::geometry::{Point, polyline};
use figure::{Chosen, Figures};
use outline::{Alignment, as_curve};

/// Share of the points that must lie nearest to the drawn point of the same shifted index for the drawn points to be taken.
const AGREEMENT: f64 = 0.6;

/// Ways to lay a part upon its counterpart that are tried point by point.
const WAYS: usize = 3;

/// Least distance, as a share of the length, of the starts of two ways: nearer ones lead to the same map.
const APART: f64 = 0.1;

/// A contour as it was drawn.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DrawnContour {
    /// Its points in pixels, in the order of drawing.
    pub points: Vec<Point>,
    /// Whether the last point joins the first.
    pub closed: bool,
    /// Its colour, sRGB-encoded, 0 to 1; compared where both contours have one.
    pub colour: Option<[f32; 3]>,
}

/// How to match.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MatchOptions {
    /// Cost from which on a part stays without counterpart. The cost has no unit: unequal shapes, a place wrong by 0.7 of
    /// the figure's radius, and a size wrong by 2.7 cost about 1 each. Parts that an artist drew in another perspective
    /// reach 2.
    pub max_cost: f64,
    /// Farthest turn of the whole figure, in radians.
    pub max_turn: f64,
    /// Greatest growth of the whole figure, and 1 over its greatest shrinking.
    pub max_scale: f64,
}

impl Default for MatchOptions {
    fn default() -> Self {
        Self { max_cost: 3.0, max_turn: 75f64.to_radians(), max_scale: 2.0 }
    }
}

/// The counterpart of a part.
#[derive(Clone, Debug, PartialEq)]
pub struct Match {
    /// Index of the drawn contour.
    pub drawn: usize,
    /// The part's control points on the drawn contour, in the part's order.
    pub points: Vec<Point>,
    /// How unlike the two are, 0 for equal ones that lie where they are expected.
    pub cost: f64,
}

/// Why contours were not matched.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CorrespondenceError {
    /// A point of a part is infinite or no number.
    #[error("part {part}: point {point} is not a pair of finite numbers")]
    PartPoint {
        /// Index of the part.
        part: usize,
        /// Index of the point.
        point: usize,
    },
    /// A point of a drawn contour is infinite or no number.
    #[error("drawn contour {drawn}: point {point} is not a pair of finite numbers")]
    DrawnPoint {
        /// Index of the drawn contour.
        drawn: usize,
        /// Index of the point.
        point: usize,
    },
}

/// The counterpart of each part among the drawn contours; each of these is taken at most once.
///
/// Contours without points match nothing.
///
/// # Errors
///
/// The first point that is not finite, by contour and index.
pub fn match_contours(
    parts: &[DrawnContour],
    drawn: &[DrawnContour],
    options: &MatchOptions,
) -> Result<Vec<Option<Match>>, CorrespondenceError> {
    if let Some((part, point)) = not_finite(parts) {
        return Err(CorrespondenceError::PartPoint { part, point });
    }
    if let Some((drawn, point)) = not_finite(drawn) {
        return Err(CorrespondenceError::DrawnPoint { drawn, point });
    }
    let figures = Figures::new(parts, drawn, options);
    let matched = figures.choose().into_iter().enumerate().map(|(i, chosen)| {
        let Chosen { drawn: j, cost, turn } = chosen?;
        let (ways, sizes) = figures.ways(i, j, turn);
        Some(Match { drawn: j, points: corresponding(&parts[i], &drawn[j], &ways, sizes), cost })
    });
    Ok(matched.collect())
}

/// Contour and point index of the first point that is not finite.
fn not_finite(contours: &[DrawnContour]) -> Option<(usize, usize)> {
    contours.iter().enumerate().find_map(|(i, c)| Some((i, c.points.iter().position(|p| !p.is_finite())?)))
}

/// The part's points on the drawn contour, by the best of the given ways (the most likely first).
fn corresponding(
    part: &DrawnContour,
    drawn: &DrawnContour,
    ways: &[(Alignment, f64)],
    sizes: (f64, f64),
) -> Vec<Point> {
    let count = part.points.len();
    let curve = as_curve(drawn, part.closed);
    let lengths = [polyline::length(&part.points, part.closed), polyline::length(&curve, part.closed)];
    if lengths.iter().any(|&length| length <= 0.0) {
        let all = |p: &Point| vec![*p; count];
        return if drawn.points.len() == count { drawn.points.clone() } else { all(&curve[0]) };
    }
    let mut best: Option<(f64, elastic::Placement, bool)> = None;
    for (way, doubt) in distinct(ways, part.closed) {
        let Some(placed) = elastic::place(&part.points, &curve, part.closed, way, sizes) else { continue };
        let cost = placed.cost + doubt;
        if best.as_ref().is_none_or(|(least, ..)| cost < *least) {
            best = Some((cost, placed, way.reversed));
        }
    }
    // No map within the allowed stretch: spread evenly.
    let Some((_, placed, reversed)) = best else { return polyline::resample(&curve, part.closed, count) };
    own_points(part, drawn, &placed.arcs, reversed).unwrap_or(placed.places)
}

/// The most likely ways whose starts or directions differ.
fn distinct(ways: &[(Alignment, f64)], closed: bool) -> Vec<&(Alignment, f64)> {
    let mut kept: Vec<&(Alignment, f64)> = Vec::new();
    for entry in ways {
        let way = &entry.0;
        let same = |(other, _): &&(Alignment, f64)| {
            let apart = way.start - other.start;
            way.reversed == other.reversed && (!closed || (apart - apart.round()).abs() < APART)
        };
        if !kept.iter().any(same) {
            kept.push(entry);
        }
        if kept.len() == WAYS {
            break;
        }
    }
    kept
}

/// The drawn points themselves in the part's order, where there are as many and they lie near the map's places.
fn own_points(part: &DrawnContour, drawn: &DrawnContour, arcs: &[f64], reversed: bool) -> Option<Vec<Point>> {
    let n = part.points.len();
    if drawn.points.len() != n || drawn.closed != part.closed {
        return None;
    }
    let mut at = vec![0.0];
    at.extend(polyline::segments(&drawn.points, part.closed).scan(0.0, |walked, (a, b)| {
        *walked += a.distance(b);
        Some(*walked)
    }));
    let length = at[at.len() - 1];
    let between = |s: f64, t: f64| {
        let d = (s - t).abs();
        if part.closed { d.min(length - d) } else { d }
    };
    let nearest = |s: f64| (0..n).min_by(|&a, &b| between(at[a], s).total_cmp(&between(at[b], s)));
    let mut votes = vec![0usize; n];
    for (k, &s) in arcs.iter().enumerate() {
        let v = nearest(s)?;
        votes[if reversed { v + k } else { v + n - k } % n] += 1;
    }
    let shift = (0..n).rev().max_by_key(|&shift| votes[shift])?;
    let ends_meet = part.closed || shift == if reversed { n - 1 } else { 0 };
    if !ends_meet || (votes[shift] as f64) < AGREEMENT * n as f64 {
        return None;
    }
    Some((0..n).map(|k| drawn.points[if reversed { shift + n - k } else { shift + k } % n]).collect())
}

#[cfg(test)]
mod tests;
