//! The outlines of painted regions.
//!
//! Paint goes under the line: a region reaches into its ink up to the middle of the line, where the region on the other side begins, and no further
//! than [`UNDER`]. So no gap shows beside a line, and none between two regions. An outline runs between the centres of
//! pixels, and is then thinned to the points that keep it within half a pixel of 540 lines (Ramer 1972; Douglas & Peucker
//! 1973).

use crate::layout::boxes;
use crate::page::{Page, Paint};
use crate::regions::Regions;
use rayon::prelude::{IntoParallelIterator, ParallelIterator};
use rototoon_base::geometry::{Point, polygon, polyline};
use rototoon_base::scene::Raster;
use rototoon_lines::outline::outlines;

/// Steps that a region reaches into its ink at most, at 540 lines.
const UNDER: f64 = 6.0;
/// Largest distance of a thinned outline, at 540 lines.
const THIN: f64 = 0.5;

/// A painted region of a drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct Fill {
    /// Its outline in pixels, closed.
    pub outline: Vec<Point>,
    /// The outlines of its holes.
    pub holes: Vec<Vec<Point>>,
    /// The number of its colour in the palette.
    pub colour: usize,
    /// Its number, the same on all drawings.
    pub track: usize,
    /// The probability that the colour is right, 0 to 1.
    pub confidence: f64,
}

/// The painted regions of a page, the largest first.
pub fn fills(page: &Page, paint: &Paint) -> Vec<Fill> {
    let regions = &page.regions;
    let under = (UNDER * regions.unit).max(1.0) as u32;
    let painted: Vec<(usize, usize, usize)> =
        (1..=regions.count).filter_map(|region| Some((region, paint.colour(region)?, paint.tracks[region]?))).collect();
    let boxes = boxes(&regions.nearest, regions.count);
    let mut fills: Vec<(f64, Fill)> = painted
        .into_par_iter()
        .filter_map(|(region, colour, track)| {
            let mut loops = loops(regions, region, boxes[region], under).into_iter();
            let (area, outline) = loops.next().filter(|own| own.0 > 0.0)?;
            let holes = loops.filter(|own| own.0 < 0.0).map(|own| own.1).collect();
            Some((area, Fill { outline, holes, colour, track, confidence: paint.confidence[region] }))
        })
        .collect();
    fills.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.track.cmp(&b.1.track)));
    fills.into_iter().map(|own| own.1).collect()
}

/// The loops around a region that reaches `under` steps into its ink, with their areas: the largest first, holes last.
fn loops(
    regions: &Regions,
    region: usize,
    [left, top, right, bottom]: [usize; 4],
    under: u32,
) -> Vec<(f64, Vec<Point>)> {
    // A border of one pixel around it, which is outside.
    let field = Raster::from_fn(right - left + 2, bottom - top + 2, |x, y| {
        let within = (left + x).checked_sub(1).zip((top + y).checked_sub(1));
        let within = within.filter(|&(x, y)| x < right && y < bottom && x >= left && y >= top);
        let own = |(x, y)| regions.nearest.get(x, y) as usize == region && regions.steps.get(x, y) <= under;
        if within.is_some_and(own) { 1.0 } else { -1.0 }
    });
    let corner = Point::new(left as f64, top as f64) - Point::ONE;
    let size = Point::new(regions.nearest.width() as f64, regions.nearest.height() as f64);
    let mut loops: Vec<(f64, Vec<Point>)> = outlines(&field)
        .into_iter()
        .map(|own| own.into_iter().map(|p| cornered(p + corner, size)).collect::<Vec<Point>>())
        .map(|own| (polygon::signed_area(&own), thinned(&own, THIN * regions.unit)))
        .collect();
    loops.sort_by(|a, b| b.0.total_cmp(&a.0));
    loops
}

/// A point of an outline in a picture of a size. Outlines cut corners by half a pixel; those of the picture are put back.
fn cornered(p: Point, size: Point) -> Point {
    let corner = Point::select(p.cmplt(0.5 * size), Point::ZERO, size);
    if (p - corner).abs().max_element() < 0.75 { corner } else { p }
}

/// The points of a closed outline that keep it within a distance. The walk is from the first point to the one that is
/// farthest from it, and back.
fn thinned(points: &[Point], within: f64) -> Vec<Point> {
    let Some(&first) = points.first() else { return Vec::new() };
    let far = (0..points.len()).max_by(|&a, &b| {
        points[a].distance_squared(first).total_cmp(&points[b].distance_squared(first)).then(b.cmp(&a))
    });
    let far = far.unwrap_or(0);
    let mut round = points.to_vec();
    round.push(first);
    let mut kept = vec![false; round.len()];
    kept[0] = true;
    kept[far] = true;
    let mut spans = vec![(0, far), (far, round.len() - 1)];
    while let Some((from, to)) = spans.pop() {
        let away = |k: usize| {
            let (a, b) = (round[from], round[to]);
            round[k].distance(polyline::nearest_on_segment(round[k], a, b))
        };
        let worst = (from + 1..to).map(|k| (away(k), k)).max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
        if let Some((_, k)) = worst.filter(|worst| worst.0 > within) {
            kept[k] = true;
            spans.extend([(from, k), (k, to)]);
        }
    }
    let thin: Vec<Point> = points.iter().zip(kept).filter(|own| own.1).map(|own| *own.0).collect();
    // What is thinner than the tolerance stays as it is.
    if thin.len() > 2 { thin } else { points.to_vec() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::page::Click;
    use rototoon_lines::Options;
    use std::sync::Arc;

    #[test]
    fn paint_goes_under_the_line_and_meets_what_is_on_the_other_side() {
        // A ring with a line of 6 px.
        let middle = Point::new(270.0, 270.0);
        let away = |x: usize, y: usize| Point::new(x as f64 + 0.5, y as f64 + 0.5).distance(middle);
        let ink = |x: usize, y: usize| (away(x, y) - 100.0).abs() < 3.0;
        let picture = Raster::from_fn(540, 540, |x, y| if ink(x, y) { [0.0; 3] } else { [1.0; 3] });
        let mut page = Page::new(Arc::new(picture), &Options::default());
        let clicks = [Point::new(3.0, 3.0), middle];
        let clicks: Vec<Click> = clicks.iter().enumerate().map(|(colour, &at)| Click { at, colour }).collect();
        let (paint, _) = page.painted(&clicks, 2, &mut 0);
        let painted = fills(&page, &paint);
        let [paper, disc] = painted.as_slice() else { panic!("{painted:?}") };
        assert_eq!((paper.holes.len(), disc.holes.len()), (1, 0));
        for p in paper.holes[0].iter().chain(&disc.outline) {
            assert!((p.distance(middle) - 100.0).abs() < 2.0, "near the middle of the line: {}", p.distance(middle));
        }
        let areas = [&paper.outline, &paper.holes[0], &disc.outline].map(|own| polygon::signed_area(own).abs());
        assert!(areas[0] == 540.0 * 540.0 && (areas[1] - areas[2]).abs() < 100.0, "{areas:?}");
    }

    #[test]
    fn a_thinned_outline_keeps_its_corners() {
        let square: Vec<Point> = (0..40)
            .map(|k| match k / 10 {
                0 => Point::new(f64::from(k), 0.0),
                1 => Point::new(10.0, f64::from(k - 10)),
                2 => Point::new(f64::from(30 - k), 10.0),
                _ => Point::new(0.0, f64::from(40 - k)),
            })
            .collect();
        assert_eq!(thinned(&square, 0.5).len(), 4);
        let sliver: Vec<Point> =
            [(0.0, 0.0), (5.0, -0.2), (9.0, 0.0), (5.0, 0.2)].map(|(x, y)| Point::new(x, y)).to_vec();
        assert_eq!(thinned(&sliver, 0.5).len(), 4, "a sliver does not vanish");
    }
}
