//! Limbs as quadratic Bézier splines in limb coordinates, and sub-key points that follow them (Liang et al. 2012,
//! section 5).
//!
//! A limb leads from key point p_j to p_{j+1} along B(λ) = (1−λ)² p_j + 2λ(1−λ) p_con + λ² p_{j+1} (eq. 9). Its control
//! point is stored relative to the limb: p_con = p_j + ω_x (p_{j+1} − p_j) + ω_y R (p_{j+1} − p_j), where R is the
//! rotation by +90° (eq. 10). A bend drawn in one pose then follows the limb into any other pose. Coordinates have x
//! right and y down; R turns x towards y.
//!
//! **Sub-key points** q_ij are mesh vertices near samples of the spline (eq. 11). From frame to frame each one moves
//! with both key points of its limb, and the nearer key point counts more (eq. 12). Then it moves to the nearest point
//! of the spline (eqs. 13, 14).
//!
//! Departures from the print: eq. 12 weights the move of p_j by ‖p_j − q‖, so the *farther* end counts more, which
//! contradicts the sentence beside it. Here the weights are inverse distances. The cubic of eq. 14 has up to three
//! roots, and its formula loses digits if the spline is nearly straight. [`Quadratic::nearest`] solves it within
//! brackets and also checks the ends.

use rototoon_base::curve::quadratic::Quadratic;
use rototoon_base::geometry::Point;

/// A limb's control point, relative to the limb.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bend {
    /// ω_x: position along the limb, 0 at its start and 1 at its end.
    pub along: f64,
    /// ω_y: offset across, in limb lengths.
    pub across: f64,
}

impl Bend {
    /// A straight limb.
    pub const STRAIGHT: Self = Self { along: 0.5, across: 0.0 };

    /// The bend of a limb drawn with this control point; straight if the limb has no length.
    pub fn of(start: Point, end: Point, control: Point) -> Self {
        let limb = end - start;
        let length = limb.length_squared();
        if !(length > 0.0 && length.is_finite() && control.is_finite()) {
            return Self::STRAIGHT;
        }
        let way = control - start;
        Self { along: limb.dot(way) / length, across: limb.perp_dot(way) / length }
    }

    /// The spline of a limb with this bend.
    pub fn spline(&self, start: Point, end: Point) -> Quadratic {
        let limb = end - start;
        Quadratic::new(start, start + limb * self.along + limb.perp() * self.across, end)
    }

    /// The bend between two keys, `share` of the way from the first to the second.
    pub fn between(&self, other: &Self, share: f64) -> Self {
        let mix = |a: f64, b: f64| a + share * (b - a);
        Self { along: mix(self.along, other.along), across: mix(self.across, other.across) }
    }
}

/// The bend at a frame, interpolated between bends drawn on keys (in ascending order of frames); straight without any.
pub fn bend_at(keys: &[(i32, Bend)], frame: i32) -> Bend {
    let after = keys.partition_point(|(key, _)| *key < frame);
    match (after.checked_sub(1).and_then(|k| keys.get(k)), keys.get(after)) {
        (Some((a, from)), Some((b, to))) => from.between(to, f64::from(frame - a) / f64::from(b - a)),
        (Some((_, bend)), None) | (None, Some((_, bend))) => *bend,
        (None, None) => Bend::STRAIGHT,
    }
}

/// `count` samples of a spline, evenly spaced in λ between the ends.
pub fn samples(spline: &Quadratic, count: usize) -> impl Iterator<Item = Point> {
    (1..=count).map(move |sample| spline.point(sample as f64 / (count + 1) as f64))
}

/// Indices of the vertices nearest to `count` [`samples`] of a spline (eq. 11). Each vertex appears once.
pub fn sub_keys(spline: &Quadratic, vertices: &[Point], count: usize) -> Vec<usize> {
    let mut found = Vec::new();
    for on in samples(spline, count) {
        let nearest =
            (0..vertices.len()).min_by(|&a, &b| vertices[a].distance(on).total_cmp(&vertices[b].distance(on)));
        found.extend(nearest.filter(|vertex| !found.contains(vertex)));
    }
    found
}

/// A sub-key point on the next frame: it moves with the key points (eq. 12), then onto the spline (eqs. 13, 14).
pub fn follow(point: Point, before: (Point, Point), after: (Point, Point), spline: &Quadratic) -> Point {
    let (near, far) = (before.0.distance(point), before.1.distance(point));
    let share = if near + far > 0.0 { near / (near + far) } else { 0.0 }; // inverse distances, normalised
    let moved = point + (after.0 - before.0) * (1.0 - share) + (after.1 - before.1) * share;
    spline.nearest(moved).point
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bend_goes_with_its_limb() {
        let (start, end, control) = (Point::new(1.0, 2.0), Point::new(5.0, 2.0), Point::new(2.0, 4.0));
        let bend = Bend::of(start, end, control);
        assert_eq!(bend, Bend { along: 0.25, across: 0.5 });
        assert_eq!(bend.spline(start, end).p1, control);
        let turn = Point::from_angle(1.1) * 2.0;
        let moved = |p: Point| turn.rotate(p) + Point::new(-3.0, 8.0);
        assert!(bend.spline(moved(start), moved(end)).p1.distance(moved(control)) < 1e-12);
        assert_eq!(Bend::of(start, start, control), Bend::STRAIGHT);
    }

    #[test]
    fn bends_are_interpolated_between_keys() {
        let (a, b) = (Bend { along: 0.5, across: 0.0 }, Bend { along: 0.7, across: 0.4 });
        let keys = [(0, a), (4, b)];
        assert_eq!((bend_at(&keys, -3), bend_at(&keys, 9)), (a, b));
        let middle = bend_at(&keys, 2);
        assert!((middle.along - 0.6).abs() < 1e-12 && (middle.across - 0.2).abs() < 1e-12);
        assert_eq!(bend_at(&[], 2), Bend::STRAIGHT);
    }

    #[test]
    fn the_nearer_end_counts_more() {
        let before = (Point::ZERO, Point::new(4.0, 0.0));
        let after = (Point::ZERO, Point::new(4.0, 4.0));
        let far = Quadratic::new(Point::new(-50.0, 1.0), Point::new(0.0, 1.0), Point::new(50.0, 1.0));
        assert_eq!(follow(Point::new(1.0, 0.0), before, after, &far).y, 1.0);
        let spline = Bend::STRAIGHT.spline(after.0, after.1);
        let quarter = follow(Point::new(1.0, 0.0), before, after, &spline);
        assert!(quarter.distance(Point::new(1.0, 1.0)) < 1e-12, "{quarter}");
    }

    #[test]
    fn a_sub_key_on_a_limb_without_length_stays_finite() {
        let spline = Bend::STRAIGHT.spline(Point::ONE, Point::ONE);
        assert_eq!(follow(Point::ONE, (Point::ONE, Point::ONE), (Point::ONE, Point::ONE), &spline), Point::ONE);
        assert_eq!(sub_keys(&spline, &[], 3), Vec::<usize>::new());
        let vertices = [Point::ZERO, Point::new(1.0, 0.1), Point::new(2.0, 0.0)];
        let limb = Bend::STRAIGHT.spline(Point::ZERO, Point::new(2.0, 0.0));
        assert_eq!(sub_keys(&limb, &vertices, 1), [1]);
        assert_eq!(sub_keys(&limb, &vertices, 5), [0, 1, 2]);
    }
}
