//! The layout of a drawing's regions on a coarse grid: their places, sizes and borders.
//!
//! The grid has about 540 lines, whatever the size of the picture, so the work does not grow with it.

use crate::regions::Regions;
use rototoon_base::geometry::Point;
use rototoon_base::scene::Raster;
use std::collections::BTreeMap;

/// Regions on a grid. Index 0 stands for no region, or for the edge of the picture among borders.
#[derive(Clone, Debug)]
pub struct Layout {
    /// The region of each cell; 0 is ink.
    pub inside: Raster<u32>,
    /// The region to which each cell belongs.
    pub nearest: Raster<u32>,
    /// Pixels along a cell's side.
    pub cell: f64,
    /// Size of a pixel of 540 lines, in cells.
    pub unit: f64,
    /// Each region's figure.
    pub figures: Vec<Figure>,
    /// What each region borders on, with its share of the border. Index 0 is the edge of the picture.
    pub borders: Vec<Vec<(usize, f32)>>,
}

/// The size and place of a region, with the ink that belongs to it, in cells.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Figure {
    /// Its area.
    pub area: f64,
    /// Its middle.
    pub middle: Point,
    /// How far it is spread: 1 for a disc, more for what is longer.
    pub spread: f64,
}

impl Layout {
    /// The layout of regions.
    pub fn new(regions: &Regions) -> Self {
        let cell = (regions.unit.round() as usize).max(1);
        let (width, height) = (regions.inside.width().div_ceil(cell), regions.inside.height().div_ceil(cell));
        let coarse = |labels: &Raster<u32>| {
            let middle = |at: usize, length: usize| (at * cell + cell / 2).min(length - 1);
            Raster::from_fn(width, height, |x, y| labels.get(middle(x, labels.width()), middle(y, labels.height())))
        };
        let (inside, nearest) = (coarse(&regions.inside), coarse(&regions.nearest));
        let figures = figures(&nearest, regions.count);
        let borders = borders(&nearest, regions.count);
        Self { inside, nearest, cell: cell as f64, unit: regions.unit / cell as f64, figures, borders }
    }

    /// The middle of a cell in pixels.
    pub fn place(&self, x: usize, y: usize) -> Point {
        Point::new(x as f64 + 0.5, y as f64 + 0.5) * self.cell
    }

    /// The region to which the cell at a place in pixels belongs. A place outside of the picture is moved to its edge.
    pub fn nearest_at(&self, place: Point) -> u32 {
        let at = place / self.cell;
        let within = |at: f64, length: usize| (at.max(0.0) as usize).min(length - 1);
        self.nearest.get(within(at.x, self.nearest.width()), within(at.y, self.nearest.height()))
    }
}

/// The figures of `count` regions and of 0, from the regions of all cells.
pub fn figures(labels: &Raster<u32>, count: usize) -> Vec<Figure> {
    let mut sums = vec![(0.0f64, Point::ZERO, 0.0f64); count + 1];
    for y in 0..labels.height() {
        for (x, &label) in labels.row(y).iter().enumerate() {
            let (area, middle, square) = &mut sums[label as usize];
            let place = Point::new(x as f64 + 0.5, y as f64 + 0.5);
            *area += 1.0;
            *middle += place;
            *square += place.length_squared();
        }
    }
    let figure = |(area, sum, square): (f64, Point, f64)| {
        let middle = sum / area.max(1.0);
        let variance = (square / area.max(1.0) - middle.length_squared()).max(0.0);
        // Of a disc of area A the variance is A ∕ 2π.
        let spread = (variance * 2.0 * std::f64::consts::PI / area.max(1.0)).sqrt();
        Figure { area, middle, spread }
    };
    sums.into_iter().map(figure).collect()
}

/// The box of each of `count` regions and of 0 in a picture of labels: left, top, right and bottom, the latter two not
/// within it.
pub fn boxes(labels: &Raster<u32>, count: usize) -> Vec<[usize; 4]> {
    let mut boxes = vec![[usize::MAX, usize::MAX, 0, 0]; count + 1];
    for y in 0..labels.height() {
        for (x, &label) in labels.row(y).iter().enumerate() {
            let own = &mut boxes[label as usize];
            *own = [own[0].min(x), own[1].min(y), own[2].max(x + 1), own[3].max(y + 1)];
        }
    }
    boxes
}

fn borders(labels: &Raster<u32>, count: usize) -> Vec<Vec<(usize, f32)>> {
    let (width, height) = (labels.width(), labels.height());
    let mut shared: Vec<BTreeMap<usize, usize>> = vec![BTreeMap::new(); count + 1];
    let mut meet = |a: u32, b: u32| {
        if a != b {
            *shared[a as usize].entry(b as usize).or_default() += 1;
            *shared[b as usize].entry(a as usize).or_default() += 1;
        }
    };
    for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
        let here = labels.get(x, y);
        let right = if x + 1 < width { labels.get(x + 1, y) } else { 0 };
        let below = if y + 1 < height { labels.get(x, y + 1) } else { 0 };
        meet(here, right);
        meet(here, below);
        if x == 0 {
            meet(here, 0);
        }
        if y == 0 {
            meet(here, 0);
        }
    }
    let shares = |own: BTreeMap<usize, usize>| {
        let total = own.values().sum::<usize>().max(1) as f32;
        own.into_iter().map(|(other, length)| (other, length as f32 / total)).collect()
    };
    let mut shares: Vec<Vec<(usize, f32)>> = shared.into_iter().map(shares).collect();
    shares[0].clear();
    shares
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon_base::scene::Raster;

    #[test]
    fn a_square_in_a_picture_borders_on_the_rest_which_borders_on_the_edge() {
        let line = |x: usize, y: usize| {
            let (u, v) = (x.abs_diff(20), y.abs_diff(20));
            u.max(v) == 10
        };
        let layout = Layout::new(&Regions::new(&Raster::from_fn(41, 41, line)));
        assert_eq!(layout.cell, 1.0);
        assert_eq!(layout.borders[2], [(1, 1.0)], "the square borders on the rest alone");
        let edge = layout.borders[1].iter().find(|own| own.0 == 0).unwrap().1;
        assert!((edge - 164.0 / (164.0 + 80.0)).abs() < 0.03, "{edge}");
        let square = layout.figures[2];
        assert!(square.middle.distance(Point::new(20.5, 20.5)) < 0.8);
        assert!((square.spread - 1.02).abs() < 0.02, "{}", square.spread);
    }
}
