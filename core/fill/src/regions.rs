//! Regions: what the ink of a drawing encloses.
//!
//! A region is a set of pixels without ink that hang together by their sides. Specks are no regions. Each pixel of ink, and of
//! a speck, *belongs* to the region that is nearest by steps from pixel to pixel. So regions touch where their lines are,
//! and what borders on what can be counted.
//!
//! A line may have a gap, and what an artist sees as two areas is one region then. Where an artist clicks into it with two
//! colours, it is [split](Regions::split) at its narrowest place between the clicks: a flood from the clicks rises from the
//! deepest places, farthest from the ink, to the shallow ones (the watershed of the distance to the ink; Meyer 1994).

use rototoon_base::geometry::Point;
use rototoon_base::scene::Raster;
use rototoon_lines::ink::distance;
use std::cmp::Reverse;
use std::collections::{BinaryHeap, VecDeque};

/// Area of the smallest region in pixels at 540 lines.
const LEAST: f64 = 6.0;
/// Most regions of a drawing. Of more, which only grain and photographs have, the largest count.
const MOST: usize = 1500;
/// Steps into the ink, at 540 lines, up to which a place still counts as inside of its region.
const NEAR: f64 = 4.0;

/// The regions of a drawing. They are numbered from 1; 0 is no region.
#[derive(Clone, Debug)]
pub struct Regions {
    /// The region of each pixel; 0 is ink.
    pub inside: Raster<u32>,
    /// The region to which each pixel belongs, ink too; 0 only if there is no region.
    pub nearest: Raster<u32>,
    /// Steps from each pixel to its region.
    pub steps: Raster<u32>,
    /// The number of regions.
    pub count: usize,
    /// Size of a pixel of 540 lines.
    pub unit: f64,
}

impl Regions {
    /// The regions that a mask of ink leaves.
    pub fn new(ink: &Raster<bool>) -> Self {
        let unit = ink.height().max(1) as f64 / 540.0;
        let (mut inside, mut areas) = components(ink);
        let least = ((LEAST * unit * unit).max(1.0) as usize).max(least_of_largest(&areas));
        let mut count = 0;
        let numbers: Vec<u32> = areas
            .drain(..)
            .map(|area| {
                let kept = area >= least;
                count += u32::from(kept);
                if kept { count } else { 0 }
            })
            .collect();
        for label in inside.data_mut().iter_mut().filter(|label| **label > 0) {
            *label = numbers[*label as usize - 1];
        }
        Self::of(inside, count as usize)
    }

    /// From the region of each pixel.
    fn of(inside: Raster<u32>, count: usize) -> Self {
        let unit = inside.height().max(1) as f64 / 540.0;
        let (nearest, steps) = spread(&inside);
        Self { inside, nearest, steps, count, unit }
    }

    /// The regions in few numbers: row by row, the region of each run of pixels and its length.
    pub fn runs(&self) -> Vec<(u32, u32)> {
        let chunks = self.inside.data().chunk_by(|a, b| a == b);
        chunks.filter_map(|run| Some((*run.first()?, u32::try_from(run.len()).ok()?))).collect()
    }

    /// The regions of a picture of `width` × `height` pixels from their [runs](Self::runs). `None` if these are not runs of regions that [`Self::new`] finds
    /// in such a picture.
    pub fn from_runs(runs: &[(u32, u32)], width: usize, height: usize) -> Option<Self> {
        let all = width.checked_mul(height)?;
        let mut data = Vec::new();
        // They are numbered in the order of their first pixels.
        let mut count = 0;
        for &(region, length) in runs {
            if length == 0 || length as usize > all - data.len() || region > count + 1 {
                return None;
            }
            count = count.max(region);
            data.resize(data.len() + length as usize, region);
        }
        (count as usize <= MOST).then_some(())?;
        Some(Self::of(Raster::from_vec(width, height, data)?, count as usize))
    }

    /// The region at a place in pixels: the one that it lies in, or to whose line it is near.
    pub fn at(&self, place: Point) -> Option<usize> {
        let (width, height) = (self.inside.width(), self.inside.height());
        let (x, y) = (place.x.floor(), place.y.floor());
        if !(x >= 0.0 && y >= 0.0 && x < width as f64 && y < height as f64) {
            return None;
        }
        let (x, y) = (x as usize, y as usize);
        let near = f64::from(self.steps.get(x, y)) <= (NEAR * self.unit).max(1.0);
        Some(self.nearest.get(x, y) as usize).filter(|&region| region > 0 && near)
    }

    /// The middle of the pixel of a region that is farthest from what is not the region.
    pub fn deepest(&self, region: usize) -> Option<Point> {
        let own = self.inside.map(|label| label as usize == region);
        let depth = distance::inside(&own);
        let cells = 0..depth.data().len();
        // Of equal ones the first is taken.
        let at = cells.rev().max_by(|&a, &b| depth.data()[a].total_cmp(&depth.data()[b]))?;
        let place = Point::new((at % depth.width()) as f64 + 0.5, (at / depth.width()) as f64 + 0.5);
        (depth.data()[at] > 0.0).then_some(place)
    }

    /// Splits a region between places that lie in it. Each place gets a region of its own: the first one keeps the number.
    /// A flood begins where the way up from its place ends, so a place in a corner counts as much as one in the middle.
    /// Places whose ways end at one summit stay together: nothing is between them.
    pub fn split(&mut self, region: usize, places: &[Point]) {
        let own = self.inside.map(|label| label as usize == region);
        let depth = distance::inside(&own);
        let mut starts: Vec<usize> = Vec::new();
        for place in places {
            let Some(at) = nearest_of(&own, *place).map(|at| summit(&depth, at)) else { continue };
            if !starts.contains(&at) {
                starts.push(at);
            }
        }
        let first = self.count;
        self.count += starts.len().saturating_sub(1);
        for (label, number) in self.inside.data_mut().iter_mut().zip(flood(&depth, &starts)) {
            match number as usize {
                0 => {}
                1 => *label = region as u32,
                later => *label = (first + later - 1) as u32,
            }
        }
        (self.nearest, self.steps) = spread(&self.inside);
    }
}

/// Floods what has a depth from places, the deepest cells first: for each cell the number of its place, from 1, or 0.
pub(crate) fn flood(depth: &Raster<f32>, places: &[usize]) -> Vec<u32> {
    let (width, height) = (depth.width(), depth.height());
    let mut flooded = vec![0; width * height];
    // Depths are ordered as whole numbers, and equal ones by when they came.
    let key = |at: usize, level: u32| ((depth.data()[at] * 16.0) as u32).min(level);
    let mut front: BinaryHeap<(u32, Reverse<usize>, usize, u32)> = BinaryHeap::new();
    for (k, &at) in places.iter().enumerate() {
        front.push((key(at, u32::MAX), Reverse(k), at, k as u32 + 1));
    }
    let mut came = places.len();
    while let Some((level, _, at, number)) = front.pop() {
        if flooded[at] > 0 {
            continue;
        }
        flooded[at] = number;
        for next in sides(at, width, height) {
            if depth.data()[next] > 0.0 && flooded[next] == 0 {
                front.push((key(next, level), Reverse(came), next, number));
                came += 1;
            }
        }
    }
    flooded
}

/// The area from which on at most [`MOST`] areas are left; 0 if there are no more.
fn least_of_largest(areas: &[usize]) -> usize {
    let mut sorted = areas.to_vec();
    sorted.sort_unstable_by_key(|&area| std::cmp::Reverse(area));
    sorted.get(MOST).map_or(0, |area| area + 1)
}

/// The pixels beside a pixel.
pub(crate) fn sides(at: usize, width: usize, height: usize) -> impl Iterator<Item = usize> {
    let (x, y) = (at % width, at / width);
    let near = [
        (y > 0).then(|| at - width),
        (x > 0).then(|| at - 1),
        (x + 1 < width).then_some(at + 1),
        (y + 1 < height).then_some(at + width),
    ];
    near.into_iter().flatten()
}

/// Where the steepest way up from a pixel ends.
pub(crate) fn summit(depth: &Raster<f32>, mut at: usize) -> usize {
    let (width, height) = (depth.width(), depth.height());
    loop {
        let (x, y) = (at % width, at / width);
        let around = (y.saturating_sub(1)..(y + 2).min(height))
            .flat_map(|v| (x.saturating_sub(1)..(x + 2).min(width)).map(move |u| v * width + u));
        let higher = around.filter(|&next| depth.data()[next] > depth.data()[at]);
        match higher.max_by(|&a, &b| depth.data()[a].total_cmp(&depth.data()[b]).then(b.cmp(&a))) {
            Some(next) => at = next,
            None => return at,
        }
    }
}

/// The pixel of a mask that is nearest to a place.
fn nearest_of(mask: &Raster<bool>, place: Point) -> Option<usize> {
    let width = mask.width();
    let away = |at: usize| Point::new((at % width) as f64 + 0.5, (at / width) as f64 + 0.5).distance_squared(place);
    let on = (0..mask.data().len()).filter(|&at| mask.data()[at]);
    on.min_by(|&a, &b| away(a).total_cmp(&away(b)))
}

/// The components of what is not ink, numbered from 1 in the order of their first pixels, and their areas.
fn components(ink: &Raster<bool>) -> (Raster<u32>, Vec<usize>) {
    let (width, height) = (ink.width(), ink.height());
    let mut labels: Raster<u32> = Raster::new(width, height, 0);
    let mut areas = Vec::new();
    let mut stack = Vec::new();
    for first in 0..width * height {
        if ink.data()[first] || labels.data()[first] > 0 {
            continue;
        }
        let number = areas.len() as u32 + 1;
        labels.data_mut()[first] = number;
        stack.push(first);
        let mut area = 0;
        while let Some(at) = stack.pop() {
            area += 1;
            for next in sides(at, width, height) {
                if !ink.data()[next] && labels.data()[next] == 0 {
                    labels.data_mut()[next] = number;
                    stack.push(next);
                }
            }
        }
        areas.push(area);
    }
    (labels, areas)
}

/// The region nearest to each pixel, and the steps to it.
fn spread(inside: &Raster<u32>) -> (Raster<u32>, Raster<u32>) {
    let (width, height) = (inside.width(), inside.height());
    let mut nearest = inside.clone();
    let mut steps: Raster<u32> = Raster::new(width, height, 0);
    let mut queue: VecDeque<usize> = (0..width * height).filter(|&at| inside.data()[at] > 0).collect();
    while let Some(at) = queue.pop_front() {
        for next in sides(at, width, height) {
            if nearest.data()[next] == 0 {
                nearest.data_mut()[next] = nearest.data()[at];
                steps.data_mut()[next] = steps.data()[at] + 1;
                queue.push_back(next);
            }
        }
    }
    (nearest, steps)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    /// A picture of letters: `#` is ink.
    fn drawn(rows: &[&str]) -> Raster<bool> {
        Raster::from_fn(rows[0].len(), rows.len(), |x, y| rows[y].as_bytes()[x] == b'#')
    }

    #[test]
    fn ink_encloses_regions_and_belongs_to_the_nearest() {
        let regions = Regions::new(&drawn(&["....#...", "....#...", "#####...", "........"]));
        assert_eq!(regions.count, 2);
        assert_eq!(regions.at(Point::new(0.5, 0.5)), Some(1));
        assert_eq!(regions.at(Point::new(7.5, 0.5)), Some(2));
        assert!(regions.nearest.data().iter().all(|&label| label > 0), "ink belongs to a region too");
        assert_eq!(regions.at(Point::new(-0.5, 0.5)), None, "outside of the picture");
        assert_eq!(regions.at(Point::new(f64::NAN, 0.5)), None);
    }

    #[test]
    fn regions_come_back_from_their_runs_and_others_do_not() {
        let regions = Regions::new(&drawn(&["....#...", "....#...", "#####...", "........"]));
        let runs = regions.runs();
        assert_eq!(runs[..3], [(1, 4), (0, 1), (2, 3)]);
        let back = Regions::from_runs(&runs, 8, 4).unwrap();
        assert_eq!((&back.inside, back.count, back.unit), (&regions.inside, regions.count, regions.unit));
        assert_eq!((back.nearest, back.steps), (regions.nearest, regions.steps));
        assert!(Regions::from_runs(&runs, 8, 5).is_none() && Regions::from_runs(&runs, 8, 3).is_none(), "another size");
        let changed = |k: usize, run: (u32, u32)| {
            let mut runs = runs.clone();
            runs[k] = run;
            Regions::from_runs(&runs, 8, 4).is_none()
        };
        assert!(changed(2, (3, 3)), "no region 2");
        assert!(changed(0, (1, u32::MAX)) && changed(0, (1, 0)));
    }

    #[test]
    fn regions_that_touch_by_a_corner_are_apart() {
        assert_eq!(Regions::new(&drawn(&["..#", "..#", "##.", "##."])).count, 2);
    }

    #[test]
    fn a_region_is_split_at_its_narrowest_place() {
        // Two rooms, and a door in the wall between them, at column 6.
        let wall = |y: usize| !(4..=5).contains(&y);
        let ink = Raster::from_fn(15, 10, |x, y| x == 6 && wall(y));
        let mut regions = Regions::new(&ink);
        assert_eq!(regions.count, 1);
        // The places are not half way: the door decides, not the distance.
        regions.split(1, &[Point::new(0.5, 0.5), Point::new(8.5, 4.5)]);
        assert_eq!(regions.count, 2);
        let column = |x: usize| (0..10).map(|y| regions.inside.get(x, y)).collect::<Vec<u32>>();
        assert_eq!(column(4), [1; 10]);
        assert_eq!(column(9), [2; 10]);
        assert!(column(6).iter().enumerate().all(|(y, &label)| (label == 0) == wall(y)));
    }

    #[test]
    fn places_at_one_summit_stay_together() {
        let wall = |y: usize| !(4..=5).contains(&y);
        let mut regions = Regions::new(&Raster::from_fn(15, 10, |x, y| x == 6 && wall(y)));
        let places = [(1.5, 0.5), (0.5, 0.5), (1.5, 0.5), (9.5, 4.5), (9.5, 5.5)];
        regions.split(1, &places.map(|(x, y)| Point::new(x, y)));
        let found: BTreeSet<u32> = regions.inside.data().iter().copied().filter(|&label| label > 0).collect();
        let all: BTreeSet<u32> = (1..=regions.count as u32).collect();
        assert_eq!(found, all, "no region is without a pixel");
        assert!(regions.count < places.len(), "{}", regions.count);
    }

    #[test]
    fn of_very_many_regions_the_largest_count() {
        // A net of meshes, of which those in the first column are twice as large.
        let ink = Raster::from_fn(402, 400, |x, y| y % 4 == 3 || (x > 3 && x % 4 == 3));
        let regions = Regions::new(&ink);
        assert!(regions.count < MOST, "{}", regions.count);
        let few = Regions::new(&Raster::from_fn(42, 40, |x, y| y % 4 == 3 || x % 4 == 3));
        assert_eq!(few.count, 110, "all of a hundred and ten");
    }

    #[test]
    fn pictures_without_ink_or_without_anything_else_have_one_region_or_none() {
        assert_eq!(Regions::new(&Raster::new(9, 7, false)).count, 1);
        assert_eq!(Regions::new(&Raster::new(9, 7, true)).count, 0);
        assert_eq!(Regions::new(&Raster::new(0, 0, false)).count, 0);
    }
}
