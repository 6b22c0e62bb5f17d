//! The outlines of painted regions.
//!
//! Paint goes under the line: a region reaches into its ink up to the middle of the line, where the region on the other side begins, and no further
//! than [`UNDER`]. So no gap shows beside a line, and none between two regions.
//!
//! An outline runs between the centres of pixels. Around the middle of four pixels it cuts off the corner of the pixel that differs
//! from the other three, and so does the outline of what is beyond. Where three regions or more meet there, or two of them
//! crosswise, that would leave a hole; there each outline goes through the middle. Such a place is a *junction*. Outlines are
//! then [thinned](crate::thin) between junctions. What two regions have as their border stays the same for both.

use crate::layout::boxes;
use crate::page::{Page, Paint};
use crate::regions::Regions;
use crate::thin::{Vertex, thinned};
use rayon::prelude::{IntoParallelIterator, ParallelIterator};
use rototoon_base::geometry::{Point, polygon};
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
    let painted: Vec<(usize, usize, usize)> = (1..=regions.count)
        .filter_map(|region| Some((region, paint.painted(region)?, paint.tracks[region]?)))
        .collect();
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
        let (x, y) = ((left + x) as i64 - 1, (top + y) as i64 - 1);
        if owner(regions, under, x, y) == Some(region) { 1.0 } else { -1.0 }
    });
    let corner = Point::new(left as f64, top as f64) - Point::ONE;
    let size = Point::new(regions.nearest.width() as f64, regions.nearest.height() as f64);
    let mut loops: Vec<(f64, Vec<Point>)> = outlines(&field)
        .into_iter()
        .map(|own| {
            let own: Vec<Point> = own.into_iter().map(|p| p + corner).collect();
            let mut own = with_junctions(&own, |middle| is_junction(regions, under, middle));
            own.iter_mut().for_each(|vertex| vertex.at = cornered(vertex.at, size));
            let thin = thinned(&own, THIN * regions.unit);
            (polygon::signed_area(&own.iter().map(|vertex| vertex.at).collect::<Vec<_>>()), thin)
        })
        .collect();
    loops.sort_by(|a, b| b.0.total_cmp(&a.0));
    loops
}

/// The region whose paint covers a pixel. `None` where none does, and outside of the picture.
fn owner(regions: &Regions, under: u32, x: i64, y: i64) -> Option<usize> {
    let (x, y) = (usize::try_from(x).ok()?, usize::try_from(y).ok()?);
    let within = x < regions.nearest.width() && y < regions.nearest.height();
    (within && regions.steps.get(x, y) <= under).then(|| regions.nearest.get(x, y) as usize)
}

/// Whether the middle of four pixels is a junction.
fn is_junction(regions: &Regions, under: u32, middle: Point) -> bool {
    let (x, y) = (middle.x as i64, middle.y as i64);
    let [a, b, c, d] = [(-1, -1), (0, -1), (0, 0), (-1, 0)].map(|(u, v)| owner(regions, under, x + u, y + v));
    // Going round, two regions that meet along one border change twice.
    [a != b, b != c, c != d, d != a].into_iter().filter(|change| *change).count() > 2
}

/// A closed outline whose points lie halfway between neighbouring pixels, with the junctions that it passes.
fn with_junctions(points: &[Point], is_junction: impl Fn(Point) -> bool) -> Vec<Vertex> {
    let mut found = Vec::with_capacity(points.len());
    for (k, &p) in points.iter().enumerate() {
        found.push(Vertex { at: p, fixed: false });
        let q = points[(k + 1) % points.len()];
        // Both lie on sides of one square between four centres. Its middle has whole coordinates.
        let whole = |p: f64, q: f64| if p.fract() == 0.0 { p } else { q };
        let middle =
            if p.x.fract() == q.x.fract() { p.midpoint(q) } else { Point::new(whole(p.x, q.x), whole(p.y, q.y)) };
        if is_junction(middle) {
            found.push(Vertex { at: middle, fixed: true });
        }
    }
    found
}

/// A point of an outline in a picture of a size. Outlines cut corners by half a pixel; those of the picture are put back.
fn cornered(p: Point, size: Point) -> Point {
    let corner = Point::select(p.cmplt(0.5 * size), Point::ZERO, size);
    if (p - corner).abs().max_element() < 0.75 { corner } else { p }
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
        let clicks: Vec<Click> =
            clicks.iter().enumerate().map(|(colour, &at)| Click { at, colour: Some(colour) }).collect();
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
    fn regions_cover_the_picture_once() {
        // A ring, and lines through its middle that cut it and the paper into six.
        let middle = Point::new(270.0, 270.0);
        let turned = [0.0, 1.1, 2.0].map(Point::from_angle);
        let ink = |x: usize, y: usize| {
            let p = Point::new(x as f64 + 0.5, y as f64 + 0.5) - middle;
            (p.length() - 100.0).abs() < 3.0 || turned.iter().any(|along| along.perp_dot(p).abs() < 1.2)
        };
        let picture = Raster::from_fn(540, 540, |x, y| if ink(x, y) { [0.0; 3] } else { [1.0; 3] });
        let mut page = Page::new(Arc::new(picture), &Options::default());
        let angles = [0.5, 1.5, 2.6, 3.6, 4.7, 5.7];
        let at = |distance: f64| angles.map(|angle| middle + distance * Point::from_angle(angle));
        let clicks = at(60.0).into_iter().chain(at(200.0)).enumerate();
        let clicks: Vec<Click> = clicks.map(|(colour, at)| Click { at, colour: Some(colour) }).collect();
        let (paint, missed) = page.painted(&clicks, 12, &mut 0);
        let painted = fills(&page, &paint);
        assert_eq!((painted.len(), missed.len()), (12, 0));
        let area: f64 = painted.iter().map(|own| polygon::signed_area(&own.outline)).sum();
        assert!((area - 540.0 * 540.0).abs() < 1e-6, "no gap and no overlap: {area}");
    }
}
