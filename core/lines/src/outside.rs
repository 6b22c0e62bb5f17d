//! Paper around the drawing: what the picture's border reaches without crossing ink.
//!
//! Paper cannot lie in front of a figure. Where three lines meet, two of them go on in each other and bound one region
//! between them, and the third line separates two regions behind it. If the one region is the paper around the drawing,
//! the two lines are the outline of two parts that meet there, and more likely one part lies over the other.

use crate::direction::{End, outward, place};
use crate::graph::Graph;
use rototoon_base::geometry::Point;
use rototoon_base::scene::Raster;
use std::f64::consts::TAU;

/// Distance between readings in pixels.
const STEP: f64 = 0.5;

/// Pixels of paper that are joined to the border.
#[derive(Clone, Debug)]
pub struct Outside(Raster<Cell>);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Cell {
    Ink,
    Paper,
    Outside,
}

impl Outside {
    /// Finds the paper around the ink.
    pub fn new(ink: &Raster<bool>) -> Self {
        let (width, height) = (ink.width(), ink.height());
        let mut found = ink.map(|is_ink| if is_ink { Cell::Ink } else { Cell::Paper });
        let mut open: Vec<usize> = Vec::new();
        let rows = (0..width).flat_map(|x| [x, (height - 1) * width + x]);
        let columns = (0..height).flat_map(|y| [y * width, y * width + width - 1]);
        let border = rows.chain(columns).filter(|_| width > 0 && height > 0);
        for i in border {
            if found.data()[i] == Cell::Paper {
                found.data_mut()[i] = Cell::Outside;
                open.push(i);
            }
        }
        while let Some(i) = open.pop() {
            let (x, y) = (i % width, i / width);
            for (u, v) in [(x + 1, y), (x, y + 1), (x.wrapping_sub(1), y), (x, y.wrapping_sub(1))] {
                if u < width && v < height && found.get(u, v) == Cell::Paper {
                    found.set(u, v, Cell::Outside);
                    open.push(v * width + u);
                }
            }
        }
        Self(found)
    }

    /// Whether the ends `pair` of three have paper around the drawing on their side without the third, at most `reach`
    /// pixels away.
    pub fn is_beside(&self, graph: &Graph, ends: &[End; 3], pair: [usize; 2], reach: f64) -> bool {
        let middle = ends.iter().map(|&end| place(graph, end)).sum::<Point>() / 3.0;
        let angle = |k: usize| (-outward(graph, ends[k])).to_angle();
        let third = 3 - pair[0] - pair[1];
        let from = angle(pair[0]);
        let over = (angle(pair[1]) - from).rem_euclid(TAU);
        let way =
            if (angle(third) - from).rem_euclid(TAU) < over { from + 0.5 * (over + TAU) } else { from + 0.5 * over };
        let direction = STEP * Point::from_angle(way);
        let cell = |k: usize| {
            let p = middle + k as f64 * direction;
            let within = p.x >= 0.0 && p.y >= 0.0 && p.x < self.0.width() as f64 && p.y < self.0.height() as f64;
            if within { self.0.get(p.x as usize, p.y as usize) } else { Cell::Outside }
        };
        let first = (0..=(reach / STEP) as usize).map(cell).find(|&cell| cell != Cell::Ink);
        first == Some(Cell::Outside)
    }
}
