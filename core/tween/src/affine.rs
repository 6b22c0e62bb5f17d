//! The affine map that lays one shape on another, taken apart: how much of the shape it leaves unexplained, how far it stretches, how far it turns.
//!
//! A similarity cannot flatten. To it an eye that closes looks like an eye that turns by a quarter turn: its long side then lies on the
//! long side. An affine map explains both, and its parts tell them apart: M = R S with a turn R and a symmetric S, whose values are the
//! growths in two directions. The logarithm of their ratio is the stretch.
//!
//! The map leads from the fatter shape to the thinner one: a line cannot be blown up to an eye by any map, but an eye can be flattened to a
//! line.

use rototoon_base::geometry::{Point, polygon};

/// A stretch beyond this one counts as this one: a shape that is flattened to a line.
const MOST_STRETCH: f64 = 3.0;
/// Share of the variance that points of equal number may leave and still be a copy that was changed.
pub(crate) const COPY: f64 = 0.01;
/// Least share of a shape's variance across its length.
const LEAST: f64 = 1e-6;

/// How one shape is laid on another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Affine {
    /// Share of the variance that stays unexplained, 0 to 1.
    pub residual: f64,
    /// Logarithm of the ratio of the growths along and across, 0 to 3.
    pub stretch: f64,
    /// Turn in radians, from x towards y.
    pub turn: f64,
}

/// Second moments of places about their middle.
#[derive(Clone, Copy, Debug)]
struct Moments {
    xx: f64,
    xy: f64,
    yy: f64,
}

impl Moments {
    fn of(places: &[Point]) -> Self {
        let sum = |of: fn(&Point) -> f64| places.iter().map(of).sum::<f64>();
        Self { xx: sum(|p| p.x * p.x), xy: sum(|p| p.x * p.y), yy: sum(|p| p.y * p.y) }
    }

    fn total(&self) -> f64 {
        self.xx + self.yy
    }

    /// How round the places lie, 0 for a line to 1/4 for a circle.
    fn roundness(&self) -> f64 {
        (self.xx * self.yy - self.xy * self.xy) / (self.total() * self.total()).max(f64::MIN_POSITIVE)
    }
}

impl Affine {
    /// The map that lays `from` on `to`, place by place. `None` where a shape has no size, or only a mirror image fits.
    pub fn fit(from: &[Point], to: &[Point]) -> Option<Self> {
        let centred = |places: &[Point]| -> Vec<Point> {
            let middle = polygon::center(places);
            places.iter().map(|p| *p - middle).collect()
        };
        let (p, q) = (centred(from), centred(to));
        let (on_p, on_q) = (Moments::of(&p), Moments::of(&q));
        if on_p.roundness() >= on_q.roundness() {
            Self::flattened((&p, on_p), (&q, on_q))
        } else {
            Self::flattened((&q, on_q), (&p, on_p)).map(|back| Self { turn: -back.turn, ..back })
        }
    }

    fn flattened((p, on_p): (&[Point], Moments), (q, on_q): (&[Point], Moments)) -> Option<Self> {
        if !(on_p.total() > 0.0 && on_q.total() > 0.0) {
            return None;
        }
        let (mut along_x, mut along_y) = (Point::ZERO, Point::ZERO);
        for (p, q) in p.iter().zip(q) {
            along_x += *q * p.x;
            along_y += *q * p.y;
        }
        let more = LEAST * on_p.total();
        let (xx, yy) = (on_p.xx + more, on_p.yy + more);
        let det = xx * yy - on_p.xy * on_p.xy;
        // The columns of the map.
        let x = (along_x * yy - along_y * on_p.xy) / det;
        let y = (along_y * xx - along_x * on_p.xy) / det;
        let explained = x.dot(along_x) + y.dot(along_y);
        // The part that turns and the part that mirrors: the growths are the sum and the difference of their lengths.
        let turning = Point::new(x.x + y.y, x.y - y.x) / 2.0;
        let (turned, mirrored) = (turning.length(), Point::new(x.x - y.y, x.y + y.x).length() / 2.0);
        (turned > mirrored * (1.0 - LEAST)).then(|| Self {
            residual: (1.0 - explained / on_q.total()).clamp(0.0, 1.0),
            stretch: ((turned + mirrored) / (turned - mirrored).max(f64::MIN_POSITIVE)).ln().min(MOST_STRETCH),
            turn: turning.to_angle(),
        })
    }
}

/// The stretch of a shape itself: the logarithm of the ratio of its sizes along and across.
pub(crate) fn elongation(places: &[Point]) -> f64 {
    let middle = polygon::center(places);
    let of = Moments::of(&places.iter().map(|p| *p - middle).collect::<Vec<_>>());
    let (mean, apart) = (of.total() / 2.0, Point::new((of.xx - of.yy) / 2.0, of.xy).length());
    (0.5 * ((mean + apart) / (mean - apart).max(f64::MIN_POSITIVE)).ln()).min(MOST_STRETCH)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn shape(along: Point, across: Point) -> Vec<Point> {
        (0..20)
            .map(|k| Point::from_angle(f64::from(k) * 0.3) * (1.0 + 0.2 * f64::from(k % 3)))
            .map(|p| along * p.x + across * p.y)
            .collect()
    }

    proptest! {
        #[test]
        fn a_map_is_taken_apart_into_its_turn_and_its_stretch(turn in -3.0f64..3.0, axis in 0.0f64..3.0, stretch in 0.05f64..2.0) {
            let axes = [Point::from_angle(axis), Point::from_angle(axis).perp()];
            let stretched = |p: Point| axes[0] * (axes[0].dot(p) * (stretch / 2.0).exp()) + axes[1] * (axes[1].dot(p) * (-stretch / 2.0).exp());
            let from = shape(Point::X, Point::Y);
            let to: Vec<Point> = from.iter().map(|p| Point::from_angle(turn).rotate(stretched(*p)) + Point::new(9.0, -4.0)).collect();
            for (way, found) in [(turn, Affine::fit(&from, &to)), (-turn, Affine::fit(&to, &from))] {
                let found = found.unwrap();
                prop_assert!(found.residual < 1e-4 && (found.stretch - stretch).abs() < 1e-2, "{found:?}");
                prop_assert!(crate::angle::wrap(found.turn - way).abs() < 1e-2, "{found:?}");
            }
        }
    }

    #[test]
    fn a_line_is_a_shape_that_was_flattened_and_a_mirror_image_is_no_way() {
        let (eye, line) = (shape(Point::X, Point::Y), shape(Point::X, Point::ZERO));
        for (from, to) in [(&eye, &line), (&line, &eye)] {
            let found = Affine::fit(from, to).unwrap();
            assert!(found.residual < 1e-3 && found.stretch == MOST_STRETCH && found.turn.abs() < 1e-3, "{found:?}");
        }
        assert_eq!(Affine::fit(&eye, &shape(Point::X, Point::NEG_Y)), None);
        assert_eq!(Affine::fit(&eye, &[Point::ONE; 20]), None);
        assert!(
            (elongation(&shape(Point::X * 3.0, Point::Y)) - elongation(&shape(Point::X, Point::Y * 3.0))).abs() < 0.3
        );
    }
}
