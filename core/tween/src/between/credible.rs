//! Whether the movement between two drawings can be believed.
//!
//! Where few strokes are matched surely (fragmented drawings, whose strokes all look alike), the movement may be wrong
//! throughout. Then the drawing half way is far from the ink of both keys: a true movement passes between them, so half
//! way it is about half as far from each as they are from each other. Where the drawing half way is hardly nearer to the keys
//! than they are to each other, drawing nothing new is better, and the earlier key is held.
//!
//! Only spans whose matching is mostly unsure are judged. A sure movement may leave the ink of both keys: a bar that turns by
//! half a turn lies on itself on both.

use super::super::grid::Grid;
use super::super::ink::{self, apart};
use super::super::stroke::Stroke;
use rototoon_base::geometry::Point;

/// Lines of points, each with whether it is closed.
pub(super) type Lines = Vec<(Vec<Point>, bool)>;

/// A matching with this share of its ink matched surely is believed.
pub(super) const SURE: f64 = 0.9;

/// A drawing half way that passes by this much or less can be believed. A true movement passes by about a half.
pub(super) const BELIEVED: f64 = 0.8;

/// How far a drawing half way passes from the keys, divided by how far they are from each other. `None` where there is
/// no ink to compare: nothing speaks against the movement.
pub(super) fn passing(first: &[Stroke], second: &[Stroke], half: &Lines) -> Option<f64> {
    let step = ink::step(first.iter().flat_map(|s| &s.points));
    let drawn = |strokes: &[Stroke]| ink::places(strokes.iter().map(|s| (&s.points[..], s.closed)), step);
    let (a, b) = (drawn(first), drawn(second));
    let between = ink::places(half.iter().map(|(points, closed)| (&points[..], *closed)), step);
    if a.is_empty() || b.is_empty() || between.is_empty() {
        return None;
    }
    let (on_a, on_b) = (Grid::new(&a), Grid::new(&b));
    let passing = apart(&between, &a, &on_a) + apart(&between, &b, &on_b);
    let keys = apart(&a, &b, &on_b) + apart(&b, &a, &on_a);
    Some(if passing > 0.0 { passing / keys } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(x: f64, y: f64) -> Vec<Stroke> {
        let bar = |k: i32| {
            Stroke::new((0..9).map(|i| Point::new(x + 3.0 * f64::from(i), y + 12.0 * f64::from(k))).collect(), false)
        };
        (0..4).map(bar).collect()
    }

    fn lines(strokes: &[Stroke]) -> Lines {
        strokes.iter().map(|s| (s.points.clone(), s.closed)).collect()
    }

    #[test]
    fn a_mess_between_the_keys_passes_far_from_them() {
        let (a, b) = (row(0.0, 0.0), row(16.0, 2.0));
        let (half, mess) = (lines(&row(8.0, 1.0)), lines(&row(60.0, -50.0)));
        assert!(passing(&a, &b, &half) < Some(0.7) && passing(&a, &b, &mess) > Some(1.0));
        assert_eq!(passing(&a, &a, &lines(&a)), Some(0.0), "nothing moves");
        assert_eq!([passing(&a, &[], &mess), passing(&a, &b, &Vec::new())], [None; 2]);
    }
}
