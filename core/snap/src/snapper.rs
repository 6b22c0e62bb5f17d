//! Intelligent scissors between the fixed control points of contours of one picture.
//!
//! For each segment the costs are computed in a strip around it, Dijkstra's search finds the chain of pixels, and the
//! chain is refined to sub-pixel places.

use super::centre::ink_centre;
use super::corridor::{Corridor, CorridorWidth};
use super::cost::{Feature, Features, Follow, Kind};
use super::live_wire::{NEIGHBOURS, shortest_path};
use super::subpixel::refine;
use rototoon_base::geometry::{Point, polyline};
use rototoon_base::scene::{Colour, Raster};

/// Weight of the zero crossing, Mortensen & Barrett 1995, §3.
const ZERO_CROSSING: f32 = 0.43;
/// Weight of the gradient magnitude, ibid.
const MAGNITUDE: f32 = 0.43;
/// Weight of the gradient direction, ibid.
const DIRECTION: f32 = 0.14;

/// Cost units per pixel of length at the highest local cost. It is fine enough that rounding has no visible effect.
const UNITS: f32 = 4096.0;

/// How much more a step costs at the strip's border than on the segment, as a share. It makes paths over flat areas
/// straight, and leaves the choice to the ink wherever there is some.
const REMOTENESS: f32 = 0.5;

/// Least share of a path's pixels that are on an edge or line. With fewer the straight segment is the better guess.
const LEAST_SUPPORT: f64 = 0.35;

/// A feature within this distance of a segment's end, in pixels, counts as the one that the end is on.
const END_RADIUS: f64 = 2.0;

/// Least strength that counts in full, as a share of the strip's strongest feature. Fainter features may be noise.
const LEAST_FULL: f32 = 0.15;

/// Search radius, in pixels at 540 lines, of the vote between edge and line.
const VOTE_RADIUS: f64 = 3.0;

/// How to snap.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SnapOptions {
    /// The kind of feature that the paths follow.
    pub follow: Follow,
    /// How far a path may go from its segment.
    pub corridor: CorridorWidth,
}

/// How far control points are from the nearest edges and from the nearest ink centres. Each is a sum over points, and
/// each distance is at most the search radius of 3 px. Add the votes of several contours or frames with
/// [`InkVote::and`].
///
/// The unit is the pixel at 540 lines; above 1080 lines the scale stays at that of 1080 lines.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InkVote {
    /// Sum of the distances to edges.
    pub edge: f64,
    /// Sum of the distances to ink centres.
    pub line: f64,
}

impl InkVote {
    /// The sum of both votes.
    pub fn and(self, other: Self) -> Self {
        Self { edge: self.edge + other.edge, line: self.line + other.line }
    }

    /// The kind that the points are nearer to; edges if both are equal.
    pub fn winner(self) -> Follow {
        if self.line < self.edge { Follow::Line } else { Follow::Edge }
    }
}

/// Snaps contours to one picture. It keeps the computed features for the next contour.
pub struct Snapper<'a> {
    features: Features<'a>,
}

impl<'a> Snapper<'a> {
    /// Prepares a picture. Features are computed later, near the contours that are snapped.
    pub fn new(picture: &'a Raster<Colour>) -> Self {
        Self { features: Features::new(picture) }
    }

    /// Snaps a contour. The result has one path per segment, in pixels, from its control point to the next one. The
    /// last segment of a closed contour goes to the first point.
    ///
    /// Each path begins and ends exactly at its control points and has at least two points. It is the straight segment
    /// where an end is outside the picture or NaN, where both ends coincide, or where too little ink connects them
    /// within the strip.
    pub fn snap(&self, contour: &[Point], closed: bool, options: &SnapOptions) -> Vec<Vec<Point>> {
        let follow = match options.follow {
            Follow::Auto => self.vote(contour).winner(),
            chosen => chosen,
        };
        let kind = if follow == Follow::Line { Kind::Line } else { Kind::Edge };
        polyline::segments(contour, closed).map(|(a, b)| self.path(a, b, kind, &options.corridor)).collect()
    }

    /// How far the contour's points are from ink centres and from edges. Points outside the picture do not count.
    pub fn vote(&self, contour: &[Point]) -> InkVote {
        let points = contour.iter().filter(|&&p| self.holds(p));
        points.fold(InkVote::default(), |sum, &p| {
            sum.and(InkVote { edge: self.nearest(Kind::Edge, p), line: self.nearest(Kind::Line, p) })
        })
    }

    /// Distance from `p` to the nearest feature, at most the search radius. The unit is that of [`InkVote`].
    fn nearest(&self, kind: Kind, p: Point) -> f64 {
        let scale = self.features.scale().min(2.0);
        let reach = VOTE_RADIUS * scale;
        let area = Corridor::new(p, p, reach + 1.0, self.features.size());
        let mut nearest = reach;
        for i in 0..area.width * area.height {
            let (x, y) = area.pixel(i);
            if let Some(place) = self.place(kind, self.features.get(kind, x, y), x, y) {
                nearest = nearest.min(place.distance(p));
            }
        }
        nearest / scale
    }

    /// Sub-pixel place of the edge or line that passes through a pixel.
    fn place(&self, kind: Kind, feature: Feature, x: usize, y: usize) -> Option<Point> {
        match kind {
            _ if !feature.present => None,
            Kind::Edge => feature.place(x, y),
            Kind::Line => ink_centre(&self.features, feature, x, y),
        }
    }

    fn holds(&self, p: Point) -> bool {
        let (width, height) = self.features.size();
        let within = |v: f64, size: usize| v >= 0.0 && v <= size as f64 && size > 0;
        within(p.x, width) && within(p.y, height)
    }

    fn path(&self, a: Point, b: Point, kind: Kind, width: &CorridorWidth) -> Vec<Point> {
        if !self.holds(a) || !self.holds(b) || a == b {
            return vec![a, b];
        }
        let size = self.features.size();
        let corridor = Corridor::new(a, b, width.half_width(a.distance(b), size.1), size);
        self.wire(a, b, kind, &corridor).unwrap_or_else(|| vec![a, b])
    }

    /// The path within a strip. `None` where too few of its pixels are on a feature.
    fn wire(&self, a: Point, b: Point, kind: Kind, corridor: &Corridor) -> Option<Vec<Point>> {
        let features: Vec<Feature> = (0..corridor.width * corridor.height)
            .map(|i| {
                let (x, y) = corridor.pixel(i);
                if corridor.contains(i) { self.features.get(kind, x, y) } else { Feature::default() }
            })
            .collect();
        let full = full_strength(&features, corridor, [a, b])?;
        let signed = kind == Kind::Edge;
        let size = (corridor.width, corridor.height);
        let pixels = shortest_path(size, corridor.index(a), corridor.index(b), |from, to, k| {
            let ground = 1.0 + REMOTENESS * corridor.remoteness[to];
            let local = ground * local_cost(features[from], features[to], k, full, signed);
            let length = if k % 2 == 0 { 1.0 } else { std::f32::consts::SQRT_2 };
            corridor.contains(to).then(|| (UNITS * length * local).round() as u32 + 1)
        })?;
        let supported = pixels.iter().filter(|&&i| features[i].present).count();
        if (supported as f64) < LEAST_SUPPORT * pixels.len() as f64 {
            return None;
        }
        let place = |i| {
            let (x, y) = corridor.pixel(i);
            self.place(kind, features[i], x, y)
        };
        Some(refine(&pixels, corridor, place, a, b))
    }
}

/// The feature strength from which on f_G is 0, for a segment with these `ends`. It is the strength of the fainter of
/// the features at the ends, so that a stronger line nearby is no better than the one that was drawn on. The training
/// of f_G in Mortensen & Barrett 1995, §5, has the same purpose.
///
/// If neither end is on a feature it is the strength of the strongest one in the strip. `None` if the strip has no
/// feature.
fn full_strength(features: &[Feature], corridor: &Corridor, ends: [Point; 2]) -> Option<f32> {
    let strongest = features.iter().fold(0.0f32, |most, f| most.max(f.strength));
    let mut full = strongest;
    for end in ends {
        let mut at_end = 0.0f32;
        for (i, feature) in features.iter().enumerate().filter(|(_, f)| f.present) {
            let (x, y) = corridor.pixel(i);
            if Point::new(x as f64 + 0.5, y as f64 + 0.5).distance(end) <= END_RADIUS {
                at_end = at_end.max(feature.strength);
            }
        }
        if at_end > 0.0 {
            full = full.min(at_end);
        }
    }
    (strongest > 0.0).then(|| full.max(LEAST_FULL * strongest))
}

/// Cost per pixel of length of a step from `p` to `q` in direction `NEIGHBOURS[k]`, 0 to 1: Mortensen & Barrett 1995,
/// eq. 1.
fn local_cost(p: Feature, q: Feature, k: usize, full: f32, signed: bool) -> f32 {
    let zero_crossing = if q.present { 0.0 } else { 1.0 };
    let magnitude = 1.0 - (q.strength / full).min(1.0);
    ZERO_CROSSING * zero_crossing + MAGNITUDE * magnitude + DIRECTION * direction_cost(p, q, k, signed)
}

/// f_D, 0 to 1: how much the step and the edges at its two pixels differ in direction. Eq. 3 and 4 of Mortensen &
/// Barrett 1995 are (acos d_p + acos d_q)/π, with the step turned so that d_p ≥ 0. That expression reaches 3/2. So here
/// the divisor is 3π/2, as in the authors' later work (1998).
///
/// Angles are integer shares of a full turn, so their differences wrap around. A pixel without direction counts as a
/// right angle: the scalar product with the zero vector is 0.
fn direction_cost(p: Feature, q: Feature, k: usize, signed: bool) -> f32 {
    const QUARTER: u16 = 1 << 14;
    let step = (k * (65536 / NEIGHBOURS.len())) as u16 as i16;
    let away = |f: Feature, step: i16| {
        if f.strength > 0.0 { f.direction.wrapping_sub(step).unsigned_abs() } else { QUARTER }
    };
    let at_p = away(p, step);
    let (at_p, at_q) = if at_p <= QUARTER {
        (at_p, away(q, step))
    } else {
        let turned = step.wrapping_add(i16::MIN);
        (away(p, turned), away(q, turned))
    };
    // A line has no sense of direction: half a turn counts as no turn.
    let at_q = if signed { at_q } else { at_q.min(2 * QUARTER - at_q) };
    f32::from(at_p.min(QUARTER)) / (3.0 * f32::from(QUARTER)) + f32::from(at_q) / (3.0 * f32::from(QUARTER))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn feature(direction: i32) -> Feature {
        Feature { strength: 1.0, offset: 0.0, direction: direction as i16, present: true }
    }

    #[test]
    fn the_direction_cost_is_that_of_the_paper() {
        let angle = |turn: i32| f64::from(turn) * std::f64::consts::TAU / 65536.0;
        for tp in (0..65536).step_by(5003) {
            for tq in (0..65536).step_by(4001) {
                for k in 0..8 {
                    let (dp, dq) = (Point::from_angle(angle(tp)), Point::from_angle(angle(tq)));
                    let mut link = Point::from_angle(angle(k as i32 * 8192));
                    if dp.dot(link).abs() < 1e-9 {
                        continue; // Both senses of the step are equally good.
                    }
                    if dp.dot(link) < 0.0 {
                        link = -link;
                    }
                    let arcs = dp.dot(link).clamp(-1.0, 1.0).acos() + dq.dot(link).clamp(-1.0, 1.0).acos();
                    let expected = arcs * 2.0 / (3.0 * std::f64::consts::PI);
                    let found = f64::from(direction_cost(feature(tp), feature(tq), k, true));
                    assert!((found - expected).abs() < 1e-3, "{tp} {tq} {k}: {found} instead of {expected}");
                }
            }
        }
    }

    #[test]
    fn a_line_may_be_walked_either_way() {
        for k in 0..8 {
            let there = direction_cost(feature(0), feature(32768), k, false);
            assert!((there - direction_cost(feature(0), feature(0), k, false)).abs() < 1e-6);
        }
        assert_eq!(direction_cost(Feature::default(), Feature::default(), 0, true), 2.0 / 3.0);
    }

    #[test]
    fn costs_stay_between_zero_and_one() {
        assert_eq!(local_cost(feature(0), feature(0), 0, 1.0, true), 0.0);
        let nothing = Feature::default();
        assert!(local_cost(nothing, nothing, 3, 1.0, true) <= 1.0);
    }
}
