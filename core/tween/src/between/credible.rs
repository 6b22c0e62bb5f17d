//! Whether the movement between two drawings can be believed.
//!
//! Where few strokes are matched surely (fragmented drawings, whose strokes all look alike), the movement may be wrong
//! throughout. Then the drawing half way tells, in three ways ([`Passing`]):
//!
//! - It is far from the ink of both keys. A true movement passes between them, so half way it is about half as far from each as
//!   they are from each other.
//! - It leaves ink of the keys behind: their ink is far from it. It has lost lines, or pulled them together.
//! - It bares still ink. Where ink of one key lies on ink of the other, most likely nothing moves. A wrong pair takes such ink
//!   away and brings other ink there.
//!
//! Where the drawing half way does not pass, drawing nothing new is better, and the earlier key is held.
//!
//! Only spans whose matching is not sure are judged. A sure movement may leave the ink of both keys: a bar that turns by
//! half a turn lies on itself on both.

use super::super::grid::Grid;
use super::super::ink::{self, apart};
use super::super::stroke::Stroke;
use rototoon_base::geometry::Point;

/// Lines of points, each with whether it is closed.
pub(super) type Lines = Vec<(Vec<Point>, bool)>;

/// A drawing half way.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Half {
    /// What moves.
    pub moving: Lines,
    /// What vanishes or appears, where it stands on its key. It shows no movement.
    pub leaving: Lines,
}

impl From<Lines> for Half {
    fn from(moving: Lines) -> Self {
        Self { moving, leaving: Lines::new() }
    }
}

/// A matching with this share of its ink matched surely is believed. Strokes that a person drew slide along themselves and lie on
/// each other's places by chance, so the drawing half way says nothing against such pairs.
pub(super) const SURE: f64 = 0.9;

/// A drawing half way that passes by this much or less can be believed. A true movement passes by about a half.
const BELIEVED: f64 = 0.8;
/// The same where the way from the keys to the drawing counts as well. A true movement passes by about one.
const BOTH_WAYS: f64 = 1.5;
/// Largest share of the still ink that a believed drawing half way by matched strokes bares.
pub(super) const BARED: f64 = 0.5;
/// Still ink lies on ink of the other key within this share of the drawing's size. It is bared where the drawing half way is
/// farther than twice that.
const ON: f64 = 0.006;

/// How a drawing half way passes two keys. Distances are divided by how far the keys are from each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Passing {
    /// How far what moves is from the keys.
    pub apart: f64,
    /// How far the drawing is from the keys, and the keys from the drawing.
    pub both_ways: f64,
    /// The share of the still ink that the drawing bares. 0 without still ink.
    pub bared: f64,
}

impl Passing {
    /// How a drawing half way passes. `None` where there is no ink to compare: nothing speaks against the movement.
    pub fn of(first: &[Stroke], second: &[Stroke], half: &Half) -> Option<Self> {
        let step = ink::step(first.iter().flat_map(|s| &s.points));
        let drawn = |strokes: &[Stroke]| ink::places(strokes.iter().map(|s| (&s.points[..], s.closed)), step);
        let (a, b) = (drawn(first), drawn(second));
        let lines = |lines: &Lines| ink::places(lines.iter().map(|(points, closed)| (&points[..], *closed)), step);
        let moving = lines(&half.moving);
        if a.is_empty() || b.is_empty() || moving.is_empty() {
            return None;
        }
        let between = [&moving[..], &lines(&half.leaving)].concat();
        let (on_a, on_b, on_half) = (Grid::new(&a), Grid::new(&b), Grid::new(&between));
        let keys = apart(&a, &b, &on_b) + apart(&b, &a, &on_a);
        let to_keys = |places: &[Point]| apart(places, &a, &on_a) + apart(places, &b, &on_b);
        let from_keys = apart(&a, &between, &on_half) + apart(&b, &between, &on_half);
        let of = |passing: f64| if passing > 0.0 { passing / keys } else { 0.0 };
        let on = ON * ink::size(a.iter().chain(&b));
        let far = |p: &Point, to: &[Point], grid: &Grid| {
            grid.nearest(*p, 1).first().map_or(f64::INFINITY, |&i| to[i].distance(*p))
        };
        let still = |from: &[Point], to: &[Point], grid: &Grid| {
            from.iter().copied().filter(|p| far(p, to, grid) <= on).collect::<Vec<Point>>()
        };
        let still = [still(&a, &b, &on_b), still(&b, &a, &on_a)].concat();
        let bared = still.iter().filter(|p| far(p, &between, &on_half) > 2.0 * on).count();
        let bared = bared as f64 / still.len().max(1) as f64;
        Some(Self { apart: of(to_keys(&moving)), both_ways: of(to_keys(&between) + from_keys), bared })
    }

    /// Whether the movement can be believed if it bares at most this share of the still ink.
    pub fn is_believed(&self, bared: f64) -> bool {
        self.apart <= BELIEVED && self.both_ways <= BOTH_WAYS && self.bared <= bared
    }

    /// The mean of two.
    pub fn mean(self, other: Self) -> Self {
        Self {
            apart: 0.5 * (self.apart + other.apart),
            both_ways: 0.5 * (self.both_ways + other.both_ways),
            bared: 0.5 * (self.bared + other.bared),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::collection::vec;
    use proptest::prelude::*;

    fn row(x: f64, y: f64) -> Vec<Stroke> {
        let bar = |k: i32| {
            Stroke::new((0..9).map(|i| Point::new(x + 3.0 * f64::from(i), y + 12.0 * f64::from(k))).collect(), false)
        };
        (0..4).map(bar).collect()
    }

    fn lines(strokes: &[Stroke]) -> Half {
        strokes.iter().map(|s| (s.points.clone(), s.closed)).collect::<Lines>().into()
    }

    #[test]
    fn a_mess_between_the_keys_passes_far_from_them() {
        let (a, b) = (row(0.0, 0.0), row(16.0, 2.0));
        let (half, mess) = (lines(&row(8.0, 1.0)), lines(&row(60.0, -50.0)));
        let of = |half: &Half| Passing::of(&a, &b, half).unwrap();
        assert!(of(&half).apart < 0.7 && of(&half).is_believed(0.5), "{:?}", of(&half));
        assert!(of(&mess).apart > 1.0 && !of(&mess).is_believed(1.0), "{:?}", of(&mess));
        let nothing = Passing { apart: 0.0, both_ways: 0.0, bared: 0.0 };
        assert_eq!(Passing::of(&a, &a, &lines(&a)), Some(nothing), "nothing moves");
        assert_eq!([Passing::of(&a, &[], &mess), Passing::of(&a, &b, &Half::default())], [None; 2]);
    }

    #[test]
    fn a_drawing_that_has_lost_lines_is_not_believed() {
        let (a, b) = (row(0.0, 0.0), row(16.0, 2.0));
        let lost = Passing::of(&a, &b, &lines(&row(8.0, 1.0)[..1])).unwrap();
        assert!(lost.apart < BELIEVED && lost.both_ways > BOTH_WAYS && !lost.is_believed(1.0), "{lost:?}");
    }

    #[test]
    fn still_ink_that_goes_away_is_bared() {
        let with = |x: f64| [row(0.0, 0.0), row(90.0 + x, 0.0)].concat();
        let (a, b) = (with(0.0), with(30.0));
        let half = Passing::of(&a, &b, &lines(&with(15.0))).unwrap();
        assert_eq!(half.bared, 0.0);
        let away = Passing::of(&a, &b, &lines(&[row(6.0, 5.0), row(105.0, 0.0)].concat())).unwrap();
        assert!(away.bared > 0.6 && !away.is_believed(BARED), "{away:?}");
    }

    #[test]
    fn what_appears_shows_no_movement_but_it_is_drawn() {
        let (a, b) = (row(0.0, 0.0), [row(0.0, 0.0), row(90.0, 0.0)].concat());
        let half = Half { leaving: lines(&row(90.0, 0.0)).moving, ..lines(&row(0.0, 0.0)) };
        let (drawn, left_out) = (Passing::of(&a, &b, &half).unwrap(), Passing::of(&a, &b, &lines(&a)).unwrap());
        assert_eq!((drawn.apart, left_out.apart), (0.0, 0.0));
        assert!(drawn.is_believed(BARED) && (left_out.both_ways - 1.0).abs() < 1e-9, "{drawn:?} {left_out:?}");
    }

    fn drawing() -> impl Strategy<Value = Vec<Stroke>> {
        let point = (0.0..300.0f64, 0.0..300.0f64).prop_map(Point::from);
        let stroke = (vec(point, 2..12), any::<bool>()).prop_map(|(points, closed)| Stroke::new(points, closed));
        vec(stroke, 1..5)
    }

    proptest! {
        #[test]
        fn a_held_key_is_as_far_from_the_keys_as_they_are_and_bares_nothing(a in drawing(), b in drawing()) {
            let held = Passing::of(&a, &b, &lines(&a)).unwrap();
            prop_assert!(held.bared == 0.0 && (held.both_ways - 1.0).abs() < 1e-9, "{held:?}");
            let later = Passing::of(&b, &a, &lines(&a)).unwrap();
            prop_assert!((0.0..=1.0).contains(&later.bared));
        }

        #[test]
        fn size_and_place_do_not_count(a in drawing(), b in drawing(), half in drawing(), size in 0.1..20.0f64) {
            let put = |strokes: &[Stroke]| -> Vec<Stroke> {
                let at = |p: &Point| *p * size + Point::new(700.0, -90.0);
                strokes.iter().map(|s| Stroke::new(s.points.iter().map(at).collect(), s.closed)).collect()
            };
            let (one, other) = (
                Passing::of(&a, &b, &lines(&half)).unwrap(),
                Passing::of(&put(&a), &put(&b), &lines(&put(&half))).unwrap(),
            );
            // A place at the limit may fall on either side of it, and a number of places may be rounded otherwise.
            prop_assert!((one.apart - other.apart).abs() < 0.02 * one.apart, "{one:?} {other:?}");
            prop_assert!((one.both_ways - other.both_ways).abs() < 0.02 * one.both_ways, "{one:?} {other:?}");
        }
    }
}
