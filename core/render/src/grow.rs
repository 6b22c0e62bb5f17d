//! Moves the outline of a union of polygons outward or inward.
//!
//! The signed distance of a pixel to the border of the union, positive inside, determines the moved border. Borders of
//! polygons inside the union do not count. The coverage of a pixel is ½ plus the amount plus the distance, clamped to 0
//! and 1. Parts that touch stay connected when they shrink. Corners become round when they grow, as in morphology with
//! a disc.
//!
//! The border comes from [`super::coverage`]. Sides steeper than 45° bound intervals of rows, the other sides intervals
//! of columns.

use super::coverage::{Edge, Shape, Side, Sink, Window, border, edges};
use super::line::Stretch;
use super::near::squared_distances;
use rototoon_base::geometry::Point;
use rototoon_base::scene::Raster;
use std::ops::Range;

/// More than the rounding of a distance to a 32-bit float.
const ROUNDING: f64 = 1e-3;

/// Coverage of the union of polygons in a window, grown by `amount` pixels (shrunk if negative). `None` if `go_on`,
/// called for each row, returns false.
pub fn grown(
    polygons: &[Vec<Point>],
    amount: f64,
    window: Window,
    go_on: &mut dyn FnMut() -> bool,
) -> Option<Raster<f32>> {
    let shape = Shape::new(&[polygons.to_vec()]);
    let mut result = shape.draw(window, go_on)?;
    if amount == 0.0 {
        return Some(result);
    }
    let reach = amount.abs() + 1.0;
    let near = window.grown(reach.ceil() as i64 + 1);
    let across: Vec<Vec<Point>> = polygons.iter().map(|points| points.iter().map(|p| p.yx()).collect()).collect();
    let mut border = steep(&shape, near);
    let level = steep(&Shape::new(&[across]), near.transposed());
    border.extend(level.into_iter().map(|piece| Stretch { ends: piece.ends.map(|p| p.yx()), ..piece }));
    let moved = |signed: f32| (0.5 + amount as f32 + signed).clamp(0.0, 1.0);
    let same = |least: f64, greatest: f64| {
        [1.0, -1.0].into_iter().all(|sign| {
            let ends = [least, greatest].map(|distance| 0.5 + amount + sign * distance);
            ends.iter().all(|end| *end > 1.0 + ROUNDING) || ends.iter().all(|end| *end < -ROUNDING)
        })
    };
    let distances = squared_distances(&border, window, &same, go_on)?;
    for (value, distance) in result.data_mut().iter_mut().zip(distances.data()) {
        let moved = moved(if *value >= 0.5 { distance.sqrt() } else { -distance.sqrt() });
        *value = if amount > 0.0 { value.max(moved) } else { value.min(moved) };
    }
    Some(result)
}

trait Exchanged {
    fn yx(&self) -> Point;
}

impl Exchanged for Point {
    fn yx(&self) -> Point {
        Point::new(self.y, self.x)
    }
}

/// The pieces of sides with a slope of at least 45° that bound the union.
fn steep(shape: &Shape, window: Window) -> Vec<Stretch> {
    let (edges, ends) = edges(shape);
    let mut found = Border { ends, last: vec![None; edges.len()], pieces: Vec::new() };
    border(shape, window, &mut found);
    let share = |edge: &Edge, height: i64| (height - edge.top) as f64 / (edge.bottom - edge.top) as f64;
    let stretch = |&(index, top, bottom): &(usize, i64, i64)| {
        let edge: &Edge = &edges[index];
        Stretch { ends: ends[index], from: share(edge, top), to: share(edge, bottom) }
    };
    found.pieces.iter().map(stretch).collect()
}

struct Border<'a> {
    /// The ends of each side.
    ends: &'a [[Point; 2]],
    /// Index of the latest piece of each side.
    last: Vec<Option<usize>>,
    /// Index of the side, and the heights where the piece begins and ends.
    pieces: Vec<(usize, i64, i64)>,
}

impl Sink for Border<'_> {
    fn begin(&mut self, _columns: Range<i64>) -> bool {
        true
    }

    fn inside(&mut self, _top: i64, _bottom: i64) {}

    fn side(&mut self, side: &Side, top: i64, bottom: i64, _enters: bool) {
        let index = side.edge;
        let [a, b] = self.ends[index];
        if (b.x - a.x).abs() > (b.y - a.y).abs() {
            return;
        }
        match self.last[index].map(|piece| &mut self.pieces[piece]) {
            Some(piece) if piece.2 == top => piece.2 = bottom,
            _ => {
                self.last[index] = Some(self.pieces.len());
                self.pieces.push((index, top, bottom));
            }
        }
    }

    fn end(&mut self) {}
}

#[cfg(test)]
mod tests {
    use super::*;

    const WINDOW: Window = Window { left: 0, top: 0, right: 24, bottom: 20 };

    fn rectangle(x0: f64, y0: f64, x1: f64, y1: f64) -> Vec<Point> {
        vec![Point::new(x0, y0), Point::new(x1, y0), Point::new(x1, y1), Point::new(x0, y1)]
    }

    fn area(polygons: &[Vec<Point>], amount: f64) -> f64 {
        let picture = grown(polygons, amount, WINDOW, &mut || true).unwrap();
        picture.data().iter().map(|value| f64::from(*value)).sum()
    }

    #[test]
    fn a_rectangle_grows_and_shrinks_by_the_amount() {
        let one = [rectangle(6.0, 6.0, 16.0, 13.0)];
        assert!((area(&one, 0.0) - 70.0).abs() < 1e-4);
        assert!((area(&one, -2.0) - 18.0).abs() < 0.1, "{}", area(&one, -2.0));
        let grown = 70.0 + 2.0 * 3.0 * 17.0 + std::f64::consts::PI * 9.0;
        assert!((area(&one, 3.0) - grown).abs() < 0.3, "{} {grown}", area(&one, 3.0));
    }

    #[test]
    fn parts_that_touch_shrink_as_one() {
        let two = [rectangle(4.0, 4.0, 10.5, 14.0), rectangle(10.5, 4.0, 20.0, 14.0), rectangle(8.0, 6.0, 13.0, 10.0)];
        let one = [rectangle(4.0, 4.0, 20.0, 14.0)];
        let shrunk = |polygons: &[Vec<Point>]| grown(polygons, -1.5, WINDOW, &mut || true).unwrap();
        assert_eq!(shrunk(&two), shrunk(&one));
    }

    #[test]
    fn any_window_has_the_same_values() {
        let shapes =
            [vec![Point::new(3.0, 2.0), Point::new(20.0, 9.0), Point::new(5.0, 18.0)], rectangle(8.0, 3.0, 12.0, 19.5)];
        for amount in [-1.7, 2.4] {
            let whole = grown(&shapes, amount, WINDOW, &mut || true).unwrap();
            let part = Window { left: 7, top: 5, right: 13, bottom: 12 };
            let piece = grown(&shapes, amount, part, &mut || true).unwrap();
            for y in 0..7 {
                for x in 0..6 {
                    assert_eq!(piece.get(x, y), whole.get(x + 7, y + 5), "{amount} {x} {y}");
                }
            }
        }
    }

    #[test]
    fn it_ends_when_told() {
        assert_eq!(grown(&[rectangle(0.0, 0.0, 5.0, 5.0)], 1.0, WINDOW, &mut || false), None);
    }
}
