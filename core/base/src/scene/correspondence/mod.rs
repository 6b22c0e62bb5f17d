//! Matching of freshly drawn contours to the parts of an earlier key.
//!
//! The order, direction, starting point and number of points of the drawn contours are arbitrary. First `figure`
//! decides which contour is which part, from shape, size, place in the figure, colour and labels together. Then `elastic` finds
//! the part's control points on the contour. A part that fits no contour stays without counterpart.
//!
//! If an artist drew a contour with as many points as the part has, the drawn points are probably meant. They are
//! returned themselves if the elastic map agrees with a plain shift of the indices.
//!
//! Limits: contours are compared by their appearance only. Two identical limbs that have changed places can be
//! distinguished only by their neighbours, colours and labels; where nothing tells them apart, by the order of drawing. A disc does not show its rotation; it is assumed to rotate with
//! the figure.

mod elastic;
mod figure;
mod outline;

use crate::geometry::{Point, polyline};
use figure::{Chosen, Figures};
use outline::{Alignment, as_curve};

/// Share of the points that must be nearest to the drawn point with the same shifted index, so that the drawn points
/// are returned.
const AGREEMENT: f64 = 0.6;

/// Number of alignments of a part with its counterpart that are tried point by point.
const WAYS: usize = 3;

/// Least difference of the starts of two alignments, as a share of the length. Closer starts lead to the same map.
const APART: f64 = 0.1;

/// A drawn contour.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DrawnContour {
    /// Its points in pixels, in the order of drawing.
    pub points: Vec<Point>,
    /// Whether the last point joins the first.
    pub closed: bool,
    /// Its colour, sRGB-encoded, 0 to 1. Colours are compared if both contours have one.
    pub colour: Option<[f32; 3]>,
    /// What the artist says of it, such as its layer and its material. Labels at the same place of both lists are compared.
    pub labels: Vec<String>,
}

/// Options of the matching.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MatchOptions {
    /// A part whose best cost is at least this stays without counterpart. The cost has no unit. Unequal shapes, a
    /// position wrong by 0.7 of the figure's radius, and a size wrong by a factor of 2.7 cost about 1 each. Parts drawn
    /// in another perspective reach 2.
    pub max_cost: f64,
    /// Greatest rotation of the figure, in radians.
    pub max_turn: f64,
    /// Greatest growth of the figure as a factor; its inverse limits the shrinking.
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
    /// Dissimilarity of the two: 0 for equal contours at the expected position.
    pub cost: f64,
}

/// Why contours cannot be matched.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CorrespondenceError {
    /// A coordinate of a part's point is not finite.
    #[error("part {part}: point {point} is not a pair of finite numbers")]
    PartPoint {
        /// Index of the part.
        part: usize,
        /// Index of the point.
        point: usize,
    },
    /// A coordinate of a drawn contour's point is not finite.
    #[error("drawn contour {drawn}: point {point} is not a pair of finite numbers")]
    DrawnPoint {
        /// Index of the drawn contour.
        drawn: usize,
        /// Index of the point.
        point: usize,
    },
}

/// Finds the counterpart of each part among the drawn contours. A drawn contour is the counterpart of at most one part.
///
/// Points are in pixels, in the frame of the picture. The result has an entry for each part. Contours without points
/// match nothing.
///
/// # Errors
///
/// A [`CorrespondenceError`] names the first point that is not finite, by contour and index.
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
        let cost = (cost - figure::order(i, parts.len(), j, drawn.len())).max(0.0);
        Some(Match { drawn: j, points: corresponding(&parts[i], &drawn[j], &ways, sizes), cost })
    });
    Ok(matched.collect())
}

/// Indices of the contour and of its first point that is not finite.
fn not_finite(contours: &[DrawnContour]) -> Option<(usize, usize)> {
    contours.iter().enumerate().find_map(|(i, c)| Some((i, c.points.iter().position(|p| !p.is_finite())?)))
}

/// The part's points on the drawn contour, by the best of the given alignments (most likely first).
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
    // No map within the allowed stretch: spread the points evenly.
    let Some((_, placed, reversed)) = best else { return polyline::resample(&curve, part.closed, count) };
    own_points(part, drawn, &placed.arcs, reversed).unwrap_or(placed.places)
}

/// The most likely alignments that differ in start or direction.
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

/// The drawn points themselves, in the part's order, if their number is the same and they agree with the map.
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
