//! How far drawn lines are from what a picture shows, both ways.
//!
//! 1. [`Shown`] finds the lines of the picture. Where the ink is lines, these are its middles (`thin`). Where most of the
//!    ink lies deep within blots, the picture is painted, and they are the edges between its colours (Canny 1986).
//! 2. The drawn lines are compared with them by distance maps ([`ink::distance`]): each drawn place has a distance to
//!    what is shown, and each shown place a distance to what is drawn. A line that is missing on either side counts.
//! 3. A distance counts up to [`MOST`], so that ink that nobody drew, such as a background, adds the same everywhere.
//!
//! **Limits.** The distance says how well two drawings lie on each other, not which line is which. Lines that lie close
//! together by chance look right. The edges of a painted picture are those of its luma.

use crate::ink::{self, Ink, distance};
use crate::stroke::Options;
use crate::thin;
use rototoon_base::geometry::{Point, polyline};
use rototoon_base::scene::{Colour, Raster};
use rototoon_image::canny::{CannyOptions, canny};
use rototoon_image::resize::reduce;
use std::borrow::Cow;

/// Distance in pixels of 540 lines from which on places are equally far.
const MOST: f64 = 24.0;
/// Lines of the picture above which it is made smaller: finer distances would say nothing more.
const LINES: f64 = 1080.0;
/// Depth in pixels of 540 lines that few drawn lines have.
const DEEP: f64 = 6.0;
/// The least such depth in pixels, for small pictures.
const LEAST_DEEP: f64 = 3.0;
/// The share of the ink so deep that makes a picture painted.
const PAINTED: f64 = 0.4;
/// Largest number of pixels along one drawn line.
const LONGEST: f64 = 1e6;

/// The mean distances between drawn lines and a picture, in pixels of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Apart {
    /// From the drawn lines to the shown ones.
    pub drawn: f64,
    /// From the shown lines to the drawn ones.
    pub shown: f64,
}

impl Apart {
    /// The mean of both ways.
    pub fn both(&self) -> f64 {
        0.5 * (self.drawn + self.shown)
    }
}

/// The distance from which on places are equally far, in pixels of a picture with a number of lines.
pub fn most(height: usize) -> f64 {
    MOST * height as f64 / 540.0
}

/// The lines of a picture, for comparisons.
pub struct Shown {
    /// Pixels on lines, with a margin on all sides.
    lines: Raster<bool>,
    /// Width and height without the margin.
    size: Point,
    /// Width of the margin.
    margin: usize,
    /// Pixels of the picture in one of `lines`.
    factor: f64,
}

impl Shown {
    /// Finds the lines of a picture.
    pub fn new(picture: &Raster<Colour>) -> Self {
        let factor = (picture.height() as f64 / LINES).max(1.0);
        let picture = if factor > 1.0 { Cow::Owned(reduce(picture, factor)) } else { Cow::Borrowed(picture) };
        let found = ink::measure(&picture, &Options::default());
        let unit = picture.height().max(1) as f64 / 540.0;
        let lines = if is_painted(&found, unit) {
            canny(&picture, &CannyOptions::default())
        } else {
            thin::thinned(&found.mask)
        };
        let margin = (MOST * unit).ceil() as usize + 1;
        let size = Point::new(lines.width() as f64, lines.height() as f64);
        Self { lines: padded(&lines, margin), size, margin, factor }
    }

    /// The distances between drawn lines and the picture's. Each line is its points, in pixels of the picture, and whether
    /// it is closed. What lies outside of the picture is not compared. `None` where the picture or the drawing shows
    /// nothing.
    pub fn apart<'a>(&self, drawn: impl IntoIterator<Item = (&'a [Point], bool)>) -> Option<Apart> {
        let inside = |p: &Point| p.cmpge(Point::ZERO).all() && p.cmplt(self.size).all();
        let places: Vec<Point> = drawn
            .into_iter()
            .flat_map(|(points, closed)| self.sampled(points, closed))
            .filter(inside)
            .map(|p| p + Point::splat(self.margin as f64))
            .collect();
        let mut mask = Raster::new(self.lines.width(), self.lines.height(), false);
        places.iter().for_each(|p| mask.set(p.x as usize, p.y as usize, true));
        let most = MOST * self.size.y / 540.0;
        let (to_shown, to_drawn) = (away_from(&self.lines), away_from(&mask));
        let far = |d: f32| f64::from(d).min(most) * self.factor;
        let drawn = mean(places.iter().map(|p| far(to_shown.get(p.x as usize, p.y as usize))))?;
        let on = self.lines.data().iter().zip(to_drawn.data()).filter(|(on, _)| **on);
        Some(Apart { drawn, shown: mean(on.map(|(_, &d)| far(d)))? })
    }

    /// Places along a line, about a pixel apart.
    fn sampled(&self, points: &[Point], closed: bool) -> Vec<Point> {
        let points: Vec<Point> = points.iter().map(|&p| p / self.factor).collect();
        let length = polyline::length(&points, closed);
        if points.len() < 2 || !length.is_finite() || length <= 0.0 {
            return points.first().filter(|p| p.is_finite()).copied().into_iter().collect();
        }
        polyline::resample(&points, closed, length.ceil().clamp(2.0, LONGEST) as usize)
    }
}

fn is_painted(ink: &Ink, unit: f64) -> bool {
    let all = ink.mask.data().iter().filter(|&&on| on).count();
    let least = (DEEP * unit).max(LEAST_DEEP);
    let deep = ink.depth.data().iter().filter(|&&d| f64::from(d) > least).count();
    deep as f64 > PAINTED * all as f64
}

fn padded(mask: &Raster<bool>, margin: usize) -> Raster<bool> {
    let mut out = Raster::new(mask.width() + 2 * margin, mask.height() + 2 * margin, false);
    for y in 0..mask.height() {
        out.row_mut(y + margin)[margin..margin + mask.width()].copy_from_slice(mask.row(y));
    }
    out
}

/// The distance of each pixel from the nearest one of the mask.
fn away_from(mask: &Raster<bool>) -> Raster<f32> {
    distance::inside(&mask.map(|on| !on))
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.fold((0.0, 0usize), |(sum, count), value| (sum + value, count + 1));
    (count > 0).then(|| sum / count as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Paper with a horizontal line, 3 px broad, around a row; with `solid` a filled rectangle below it.
    fn picture(row: usize, solid: bool) -> Raster<Colour> {
        let dark = |x: usize, y: usize| {
            (100..300).contains(&x) && (y.abs_diff(row) <= 1 || solid && (row..row + 120).contains(&y))
        };
        Raster::from_fn(400, 270, |x, y| if dark(x, y) { [0.1; 3] } else { [1.0; 3] })
    }

    fn line(y: f64) -> Vec<Point> {
        vec![Point::new(100.5, y), Point::new(299.5, y)]
    }

    #[test]
    fn the_distance_is_that_of_the_lines_both_ways() {
        let shown = Shown::new(&picture(100, false));
        for off in [0.0, 3.0, 7.0] {
            let found = shown.apart([(&line(100.5 + off)[..], false)]).unwrap();
            assert!((found.both() - off).abs() < 0.3, "{off}: {found:?}");
        }
        // Distances count up to 24 px of 540 lines.
        assert_eq!(shown.apart([(&line(160.5)[..], false)]).unwrap(), Apart { drawn: 12.0, shown: 12.0 });
    }

    #[test]
    fn a_line_that_is_missing_on_one_side_counts() {
        let shown = Shown::new(&picture(100, false));
        let half = [Point::new(100.5, 100.5), Point::new(200.0, 100.5)];
        let found = shown.apart([(&half[..], false)]).unwrap();
        assert!(found.drawn < 0.3 && found.shown > 4.0, "{found:?}");
        let (right, wrong) = (line(100.5), line(40.0));
        let found = shown.apart([(&right[..], false), (&wrong[..], false)]).unwrap();
        assert!(found.drawn > 4.0 && found.shown < 0.3, "{found:?}");
    }

    #[test]
    fn a_painted_picture_is_compared_by_its_edges() {
        let shown = Shown::new(&picture(100, true));
        let outline = |off: f64| {
            [(100.0, 99.0), (300.0, 99.0), (300.0, 220.0), (100.0, 220.0)].map(|(x, y)| Point::new(x, y + off))
        };
        let (on, off) = (outline(0.0), outline(6.0));
        assert!(shown.apart([(&on[..], true)]).unwrap().both() < 1.2);
        assert!(shown.apart([(&off[..], true)]).unwrap().both() > 2.5);
    }

    #[test]
    fn nothing_is_compared_with_nothing() {
        let shown = Shown::new(&picture(100, false));
        assert_eq!(shown.apart([]), None);
        assert_eq!(shown.apart([(&[Point::new(-9.0, 4.0), Point::new(-2.0, 4.0)][..], false)]), None);
        assert_eq!(shown.apart([(&[Point::new(f64::NAN, 4.0)][..], false)]), None);
        assert_eq!(Shown::new(&Raster::new(40, 30, [1.0; 3])).apart([(&line(9.0)[..], false)]), None);
        assert_eq!(Shown::new(&Raster::new(0, 0, [1.0; 3])).apart([(&line(9.0)[..], false)]), None);
    }

    #[test]
    fn a_large_picture_has_distances_in_its_own_pixels() {
        let large = Raster::from_fn(600, 2160, |x, y| {
            if (100..500).contains(&x) && (1000..1008).contains(&y) { [0.0; 3] } else { [1.0; 3] }
        });
        let drawn = [Point::new(100.0, 1024.0), Point::new(500.0, 1024.0)];
        let found = Shown::new(&large).apart([(&drawn[..], false)]).unwrap();
        assert!((found.both() - 20.0).abs() < 1.6, "{found:?}");
    }
}
