//! The painted regions of one frame as pixels.

use rototoon::geometry::Point;
use rototoon::project::fills::FilledRegion;
use rototoon::scene::Raster;

/// A painted pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pixel {
    /// Its colour, sRGB-encoded, 0 to 255.
    pub colour: [f32; 3],
    /// The probability that the colour is right, 0 to 1.
    pub confidence: f64,
}

/// The paint of each pixel: of the last region whose outline, without its holes, contains the pixel's centre.
pub fn pixels(regions: &[FilledRegion], (width, height): (usize, usize)) -> Raster<Option<Pixel>> {
    let mut canvas = Raster::new(width, height, None);
    for region in regions {
        let pixel = Pixel { colour: region.colour.map(|value| 255.0 * value), confidence: region.confidence };
        let rings = std::iter::once(&region.outline).chain(&region.holes);
        for (y, row) in crossings(rings, height).iter_mut().enumerate() {
            row.sort_by(f64::total_cmp);
            for pair in row.chunks_exact(2) {
                let [from, to] = [pair[0], pair[1]].map(|x| ((x - 0.5).ceil().max(0.0) as usize).min(width));
                canvas.row_mut(y)[from..to].fill(Some(pixel));
            }
        }
    }
    canvas
}

/// Where rings cross the middle of each row of pixels: their x. A row has an even number of them.
fn crossings<'a>(rings: impl Iterator<Item = &'a Vec<Point>>, height: usize) -> Vec<Vec<f64>> {
    let mut rows: Vec<Vec<f64>> = vec![Vec::new(); height];
    for ring in rings {
        for (k, &a) in ring.iter().enumerate() {
            let b = ring[(k + 1) % ring.len()];
            let (upper, lower) = if a.y <= b.y { (a, b) } else { (b, a) };
            // A row is crossed by the edges that begin at its middle, not by those that end there.
            let [first, end] = [upper.y, lower.y].map(|y| ((y - 0.5).ceil().max(0.0) as usize).min(height));
            for (y, row) in rows.iter_mut().enumerate().take(end).skip(first) {
                let share = (y as f64 + 0.5 - upper.y) / (lower.y - upper.y);
                row.push(upper.x + share * (lower.x - upper.x));
            }
        }
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring(from: f64, to: f64) -> Vec<Point> {
        [(from, from), (to, from), (to, to), (from, to)].map(|(x, y)| Point::new(x, y)).to_vec()
    }

    fn region(outline: Vec<Point>, holes: Vec<Vec<Point>>, red: f32) -> FilledRegion {
        FilledRegion { colour: [red, 0.0, 0.0], outline, holes, name: None, track: 0, confidence: f64::from(red) }
    }

    #[test]
    fn holes_stay_open_and_later_regions_lie_over_earlier_ones() {
        let regions = [region(ring(1.0, 9.0), vec![ring(3.0, 5.0)], 0.5), region(ring(7.0, 12.0), Vec::new(), 1.0)];
        let canvas = pixels(&regions, (10, 11));
        let red = |x: usize, y: usize| canvas.get(x, y).map(|pixel| pixel.colour[0]);
        assert_eq!(
            [red(0, 1), red(1, 1), red(3, 3), red(4, 4), red(5, 5)],
            [None, Some(127.5), None, None, Some(127.5)]
        );
        assert_eq!([red(6, 8), red(7, 8), red(9, 10), red(2, 9)], [Some(127.5), Some(255.0), Some(255.0), None]);
        assert_eq!(canvas.get(7, 8).map(|pixel| pixel.confidence), Some(1.0));
    }

    #[test]
    fn a_pixel_belongs_to_the_region_of_its_centre() {
        let slope = vec![Point::new(0.0, 0.0), Point::new(8.0, 0.0), Point::new(0.0, 8.0)];
        let canvas = pixels(&[region(slope, Vec::new(), 1.0)], (8, 8));
        for y in 0..8 {
            // The diagonal goes through the centres of pixels: there the end of a span does not count.
            assert_eq!(canvas.row(y).iter().filter(|pixel| pixel.is_some()).count(), 7 - y, "row {y}");
        }
    }
}
