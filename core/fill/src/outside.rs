//! Clicks that leak: the way from a click to the edge of the picture leads through a gap.
//!
//! A region that reaches the edge of the picture is the paper, a sky, or a figure that the picture cuts off. All of them may be painted. It may also
//! be a coat that a gap in its hem joins to the paper. No other drawing is asked, since a model drawing has none to ask. So the form of the region decides.
//!
//! The *level* of a place is the least distance to ink on the widest way from the clicks to it. Where the level of the best way to the edge is l, the *own side* is
//! all that wider ways lead to from the clicks, and the *far side* all that wider ways lead to from the edge. The clicks leak if l is less than [`NARROW`] of the
//! greatest depth on both sides: from a room through a door into another room. In open paper, in a sky and in a coat that the picture cuts off the own side
//! is at the edge itself, and l is large.
//!
//! | what is found | what is done |
//! | --- | --- |
//! | l is at most [`GAP`] | the region is split there, as gap closing of a paint program does |
//! | the same, and the own side is hardly wider than the gap, but ink closes it but for [`OPEN`] of its border | the same: a cuff, an eye |
//! | l is larger | the click is taken as it is, and named |
//! | the own side is at the edge too, but a part of the region at the edge lies behind a gap, and the own side is at most [`SMALL`] of the region | split |
//!
//! The last row is the coat that is cut off by the picture and has a gap. A sky is not parted from its pieces between branches, unless it is the smaller part.
//!
//! The region goes on behind the edge of the picture as it is there. So a narrow strip of sky between a head and the edge is no gap.
//!
//! # Limits
//!
//! What has a gap as wide as half of itself is not known from a bay of the paper. Who clicks into a bay with a narrow mouth and means all of the paper
//! must click once more, into the paper: two clicks of one colour on both sides of a gap keep the region whole.

use crate::layout::Layout;
use crate::levels::{GAP, levels};
use crate::regions::{flood, sides, summit};
use rototoon_base::geometry::Point;
use rototoon_base::scene::Raster;
use rototoon_lines::ink::distance;

/// Depth of a gap, as a share of that of the shallower side: of any gap, and of one that ink closes nearly.
const NARROW: f32 = 0.5;
const NEARLY: f32 = 0.95;
/// Largest share of the border of what ink closes nearly that the gap takes.
const OPEN: f64 = 0.25;
/// Largest share of a region at the edge that a click means, if a gap parts it from the rest.
const SMALL: f64 = 0.25;
/// How far the region goes on behind the edge of the picture, in gaps.
const BEHIND: f64 = 4.0;

/// A gap between clicks and the edge of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// Where it is, in pixels.
    pub at: Point,
    /// How wide it is, in pixels.
    pub width: f64,
    /// The deepest place behind it, in pixels: what is there was not clicked.
    pub beyond: Point,
    /// Whether the region can be split there.
    pub closes: bool,
}

/// The gap through which clicks into a region leak; `None` if they do not, or the region is not at the edge.
pub fn leak(layout: &Layout, region: usize, clicks: &[Point]) -> Option<Gap> {
    let room = Room::new(layout, region);
    let starts = room.starts(clicks);
    let edge = room.edge();
    if starts.is_empty() || edge.is_empty() {
        return None;
    }
    let near = room.levels(&starts);
    let widest = edge.iter().copied().max_by(|&a, &b| near[a].total_cmp(&near[b]).then(b.cmp(&a)))?;
    let way = room.way(&near, widest);
    let gap = (GAP * layout.unit) as f32;
    if way.is_narrow(NARROW) || (way.level <= gap && way.is_narrow(NEARLY) && room.open(&starts, &way) <= OPEN) {
        return Some(room.gap(&starts, &way, way.level <= gap));
    }
    // The own side is at the edge: what lies there behind a gap?
    let behind = edge.iter().copied().filter(|&at| near[at] <= gap);
    let deepest = behind.max_by(|&a, &b| room.depth.data()[a].total_cmp(&room.depth.data()[b]).then(b.cmp(&a)))?;
    let way = room.way(&near, deepest);
    let is_small = way.own as f64 <= SMALL * room.size() as f64;
    (way.is_narrow(NARROW) && is_small).then(|| room.gap(&starts, &way, true))
}

/// A region with a margin around the picture, into which it goes on.
struct Room<'a> {
    layout: &'a Layout,
    margin: usize,
    depth: Raster<f32>,
}

/// The way from clicks to a place at the edge.
struct Way {
    /// The least depth on it.
    level: f32,
    /// The number of cells on the own side, and the greatest depth there.
    own: usize,
    near: f32,
    /// The deepest cell on the far side, and its depth.
    beyond: usize,
    far: f32,
}

impl Way {
    fn is_narrow(&self, share: f32) -> bool {
        self.level < share * self.near.min(self.far)
    }
}

impl<'a> Room<'a> {
    fn new(layout: &'a Layout, region: usize) -> Self {
        let margin = (BEHIND * GAP * layout.unit).ceil() as usize;
        let (width, height) = (layout.inside.width(), layout.inside.height());
        let within = |at: usize, length: usize| at.saturating_sub(margin).min(length - 1);
        let own = Raster::from_fn(width + 2 * margin, height + 2 * margin, |x, y| {
            layout.inside.get(within(x, width), within(y, height)) as usize == region
        });
        Self { layout, margin, depth: distance::inside(&own) }
    }

    /// The number of cells.
    fn size(&self) -> usize {
        self.depth.data().iter().filter(|&&depth| depth > 0.0).count()
    }

    /// The cells where floods from clicks begin.
    fn starts(&self, clicks: &[Point]) -> Vec<usize> {
        let (width, data) = (self.depth.width(), self.depth.data());
        let away = |at: usize, cell: Point| {
            Point::new((at % width) as f64 + 0.5, (at / width) as f64 + 0.5).distance_squared(cell)
        };
        let mut starts = Vec::new();
        for click in clicks {
            let cell = *click / self.layout.cell + self.margin as f64 * Point::ONE;
            let own = (0..data.len()).filter(|&at| data[at] > 0.0);
            let nearest = own.min_by(|&a, &b| away(a, cell).total_cmp(&away(b, cell)));
            starts.extend(nearest.map(|at| summit(&self.depth, at)));
        }
        // Clicks in one room need one look at it.
        starts.sort_unstable();
        starts.dedup();
        starts
    }

    /// The cells of the region at the edge of the picture.
    fn edge(&self) -> Vec<usize> {
        let (width, height) = (self.depth.width(), self.depth.height());
        let (right, bottom) = (width - self.margin - 1, height - self.margin - 1);
        let is_edge = |at: &usize| {
            let (x, y) = (at % width, at / width);
            let within = (self.margin..=right).contains(&x) && (self.margin..=bottom).contains(&y);
            within && (x == self.margin || x == right || y == self.margin || y == bottom)
        };
        (0..width * height).filter(is_edge).filter(|&at| self.depth.data()[at] > 0.0).collect()
    }

    /// The level of each cell, from the start with the widest way to it.
    fn levels(&self, starts: &[usize]) -> Vec<f32> {
        let each = starts.iter().map(|&start| levels(&self.depth, start));
        let most = |a: Vec<f32>, b: Vec<f32>| a.iter().zip(&b).map(|(a, b)| a.max(*b)).collect();
        each.reduce(most).unwrap_or_default()
    }

    fn way(&self, near: &[f32], to: usize) -> Way {
        let (level, data) = (near[to], self.depth.data());
        let far = levels(&self.depth, to);
        // The place itself may be as narrow as the way to it.
        let behind = |at: &usize| far[*at] > level || *at == to;
        let deepest = |a: &usize, b: &usize| data[*a].total_cmp(&data[*b]).then(b.cmp(a));
        let beyond = (0..data.len()).filter(behind).max_by(deepest).unwrap_or(to);
        let own = near.iter().zip(data).filter(|(near, _)| **near > level);
        let (own, depth) = own.fold((0, 0.0f32), |(count, most), (_, depth)| (count + 1, most.max(*depth)));
        Way { level, own, near: depth, beyond, far: data[beyond] }
    }

    /// The floods from the far side, 1, and from the clicks.
    fn flooded(&self, starts: &[usize], way: &Way) -> Vec<u32> {
        flood(&self.depth, &[&[summit(&self.depth, way.beyond)], starts].concat())
    }

    /// The share of the border of what the clicks flood that is no ink.
    fn open(&self, starts: &[usize], way: &Way) -> f64 {
        let (width, height) = (self.depth.width(), self.depth.height());
        let flooded = self.flooded(starts, way);
        let (mut border, mut open) = (0usize, 0usize);
        for at in (0..flooded.len()).filter(|&at| flooded[at] > 1) {
            border += sides(at, width, height).filter(|&next| flooded[next] < 2).count();
            open += sides(at, width, height).filter(|&next| flooded[next] == 1).count();
        }
        open as f64 / border.max(1) as f64
    }

    /// The gap where the floods meet.
    fn gap(&self, starts: &[usize], way: &Way, closes: bool) -> Gap {
        let (width, height) = (self.depth.width(), self.depth.height());
        let flooded = self.flooded(starts, way);
        let meets = |at: &usize| flooded[*at] > 1 && sides(*at, width, height).any(|next| flooded[next] == 1);
        let data = self.depth.data();
        let deepest = |a: &usize, b: &usize| data[*a].total_cmp(&data[*b]).then(b.cmp(a));
        let at = (0..flooded.len()).filter(meets).max_by(deepest).unwrap_or(way.beyond);
        let width = 2.0 * f64::from(way.level) * self.layout.cell;
        Gap { at: self.place(at), width, beyond: self.place(way.beyond), closes }
    }

    /// The place of a cell in pixels. One in the margin is moved to the edge of the picture.
    fn place(&self, at: usize) -> Point {
        let (x, y) = (at % self.depth.width(), at / self.depth.width());
        let within = |at: usize, length: usize| at.saturating_sub(self.margin).min(length - 1);
        let inside = &self.layout.inside;
        self.layout.place(within(x, inside.width()), within(y, inside.height()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::regions::Regions;

    /// A picture of 540 lines, of which the last is the bottom.
    fn layout(ink: impl Fn(usize, usize) -> bool) -> Layout {
        Layout::new(&Regions::new(&Raster::from_fn(500, 540, ink)))
    }

    fn found(layout: &Layout, at: (f64, f64)) -> Option<Gap> {
        let at = Point::from(at);
        leak(layout, layout.nearest_at(at) as usize, &[at])
    }

    /// The outline of a box from (200, 200) to (300, 300), 2 px wide, with a gap of a width on its right.
    fn boxed(gap: usize) -> impl Fn(usize, usize) -> bool {
        move |x, y| {
            let (u, v) = (x.abs_diff(250), y.abs_diff(250));
            (49..=50).contains(&u.max(v)) && !(x > 280 && 2 * v < gap)
        }
    }

    #[test]
    fn a_click_behind_a_narrow_gap_is_parted_and_one_behind_a_wide_gap_is_named() {
        let gap = found(&layout(boxed(6)), (230.0, 260.0)).unwrap();
        assert!(gap.closes && (3.0..9.0).contains(&gap.width), "{gap:?}");
        assert!(gap.at.distance(Point::new(300.0, 250.0)) < 8.0, "{gap:?}");
        assert!((gap.beyond - Point::new(250.0, 250.0)).abs().max_element() > 50.0, "{gap:?}");
        let wide = found(&layout(boxed(30)), (230.0, 260.0)).unwrap();
        assert!(!wide.closes && (25.0..36.0).contains(&wide.width), "{wide:?}");
        assert_eq!(found(&layout(boxed(80)), (230.0, 260.0)), None, "an open bay");
        assert_eq!(found(&layout(boxed(0)), (230.0, 260.0)), None, "nothing leaks");
        assert_eq!(found(&layout(boxed(6)), (50.0, 50.0)), None, "the paper itself");
    }

    #[test]
    fn two_clicks_on_both_sides_of_a_gap_keep_the_region_whole() {
        let layout = layout(boxed(6));
        let clicks = [(230.0, 260.0), (40.0, 400.0)].map(Point::from);
        assert_eq!(leak(&layout, layout.nearest_at(clicks[0]) as usize, &clicks), None);
    }

    #[test]
    fn small_things_with_a_gap_nearly_as_wide_are_parted() {
        // A ring with an inner radius of 7 and a gap of 8.
        let layout = layout(|x, y| {
            let at = Point::new(x as f64 - 250.0, y as f64 - 250.0);
            (at.length() - 8.0).abs() < 1.2 && !(at.x > 0.0 && at.y.abs() < 4.0)
        });
        assert!(found(&layout, (250.0, 250.0)).is_some_and(|gap| gap.closes));
    }

    #[test]
    fn a_sky_and_a_figure_that_the_picture_cuts_off_are_no_leaks() {
        // A coat from the bottom edge, and a branch across the sky that leaves 40 px; a head 5 px below the top edge.
        let coat = layout(|x, y| y >= 300 && (x == 150 || x == 350) || y == 300 && (150..=350).contains(&x));
        assert_eq!(found(&coat, (250.0, 500.0)), None);
        assert_eq!(found(&coat, (50.0, 100.0)), None);
        let branch = layout(|x, y| (250..=252).contains(&x) && y > 40);
        assert_eq!(found(&branch, (50.0, 400.0)), None);
        let head = layout(|x, y| (248..=252).contains(&x) && y > 5);
        assert_eq!(found(&head, (50.0, 400.0)), None, "a strip at the edge is no gap");
    }

    #[test]
    fn a_figure_that_the_picture_cuts_off_is_parted_at_its_gap() {
        let coat = |x: usize, y: usize| {
            let side = (x == 180 || x == 320) && y >= 340;
            (side && !(x == 320 && (420..426).contains(&y))) || y == 340 && (180..=320).contains(&x)
        };
        let layout = layout(coat);
        let gap = found(&layout, (250.0, 500.0)).unwrap();
        assert!(gap.closes && gap.at.distance(Point::new(320.0, 423.0)) < 8.0, "{gap:?}");
        assert_eq!(found(&layout, (50.0, 100.0)), None, "the paper is the larger part");
    }
}
