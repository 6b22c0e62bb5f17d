//! Whether the movement between two drawings can be believed.
//!
//! Where few strokes are matched surely (fragmented drawings, whose strokes all look alike), the movement may be wrong
//! throughout. Then the drawing half way is far from the ink of both keys: a true movement passes between them, so half
//! way it is about half as far from each as they are from each other. Where the drawing half way is farther from the keys
//! than they are from each other, drawing nothing new is better, and the earlier key is held.
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
const SURE: f64 = 0.9;

/// Whether a drawing half way can be believed, given how surely the keys are matched. Each drawing is a list of lines.
pub(super) fn is_believed(sureness: f64, first: &[Stroke], second: &[Stroke], half: impl FnOnce() -> Lines) -> bool {
    if sureness >= SURE {
        return true;
    }
    let step = ink::step(first.iter().flat_map(|s| &s.points));
    let drawn = |strokes: &[Stroke]| ink::places(strokes.iter().map(|s| (&s.points[..], s.closed)), step);
    let (a, b) = (drawn(first), drawn(second));
    let half = half();
    let between = ink::places(half.iter().map(|(points, closed)| (&points[..], *closed)), step);
    if a.is_empty() || b.is_empty() || between.is_empty() {
        return true;
    }
    let (on_a, on_b) = (Grid::new(&a), Grid::new(&b));
    let passing = 0.5 * (apart(&between, &a, &on_a) + apart(&between, &b, &on_b));
    let keys = 0.5 * (apart(&a, &b, &on_b) + apart(&b, &a, &on_a));
    passing <= keys
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
    fn a_mess_between_the_keys_is_not_believed_unless_it_is_sure() {
        let (a, b) = (row(0.0, 0.0), row(16.0, 2.0));
        let (passing, mess) = (lines(&row(8.0, 1.0)), lines(&row(60.0, -50.0)));
        assert!(is_believed(0.1, &a, &b, || passing) && !is_believed(0.1, &a, &b, || mess.clone()));
        assert!(is_believed(0.9, &a, &b, || mess.clone()));
        assert!(is_believed(0.0, &a, &[], || mess) && is_believed(0.0, &[], &[], Vec::new));
    }
}
