//! How well each region of a drawing meets each region of another one.
//!
//! The lines' [shifts](crate::shifts) from each drawing to the other carry one onto the other. With a the share of region j that comes from
//! region i, and b the share of i that goes into j, a pair meets by
//!
//! u = a b + 0.001 a + s + 0.03 exp(−½ (Δ log area ∕ 0.7)² − ½ (Δ log spread ∕ 0.5)² − ½ (distance ∕ 0.25 heights)²) + 0.003
//!
//! - a b is 1 where the regions cover each other. A thing that falls to pieces or loses a part still has some of it.
//! - s is for small and thin regions, which a shift that is a few pixels off moves beside themselves. It is the overlap
//!   (intersection ∕ union) after the middle of i was put on that of j, times exp(−(d ∕ r)²), with d the distance of the middles and r =
//!   12 px + half the root of the area; the mean of both ways of carrying. It is worked out where d is below 40 px
//!   plus half the root of the area, and the areas are within a factor of 3.
//! - The other terms let what was carried far off be found by its [neighbours](crate::relax).

use crate::layout::{Layout, boxes, figures};
use crate::shifts::Shifts;
use rayon::prelude::{IndexedParallelIterator, IntoParallelIterator, ParallelIterator};
use rototoon_base::geometry::Point;
use rototoon_base::scene::Raster;

/// Weight of a share alone.
const ALONE: f32 = 1e-3;
/// Reach of the overlap: pixels at 540 lines, and the share of the root of the area.
const NEAR: f64 = 12.0;
const FAR: f64 = 40.0;
const SIZE: f64 = 0.5;
/// Largest ratio of areas.
const RATIO: f64 = 3.0;
/// Weight of likeness, and its scales.
const ALIKE: f64 = 0.03;
const AREA: f64 = 0.7;
const SPREAD: f64 = 0.5;
const DISTANCE: f64 = 0.25;
/// What every pair has.
const ANY: f64 = 0.003;

/// A table with a row for each region of one drawing and a column for each of the other. Row and column 0 are no region.
pub type Table = Vec<Vec<f32>>;

/// u of each pair: rows are regions of `to`, columns those of `from`. `ahead` are the shifts from `from` to `to`, `back` those from `to` to `from`.
pub fn meeting(from: &Layout, to: &Layout, ahead: &Shifts, back: &Shifts) -> Table {
    let mut carried = covered(from, to, ahead, back);
    for (later, earlier, share) in moved(from, to, back) {
        carried[later][earlier] += 0.5 * share;
    }
    for (earlier, later, share) in moved(to, from, ahead) {
        carried[later][earlier] += 0.5 * share;
    }
    let height = to.nearest.height() as f64;
    let add = |(j, mut row): (usize, Vec<f32>)| {
        for (i, value) in row.iter_mut().enumerate().skip(1) {
            let (a, b) = (&from.figures[i], &to.figures[j]);
            let area = (b.area.max(1.0) / a.area.max(1.0)).ln() / AREA;
            let spread = (b.spread.max(1e-3) / a.spread.max(1e-3)).ln() / SPREAD;
            let away = a.middle.distance(b.middle) / height / DISTANCE;
            *value += (ALIKE * (-0.5 * (area * area + spread * spread + away * away)).exp() + ANY) as f32;
        }
        row
    };
    carried.into_par_iter().enumerate().map(add).collect()
}

/// a b + 0.001 a of each pair.
fn covered(from: &Layout, to: &Layout, ahead: &Shifts, back: &Shifts) -> Table {
    let (mut came, went) = (came(from, to, back), came(to, from, ahead));
    for (j, row) in came.iter_mut().enumerate() {
        for (i, a) in row.iter_mut().enumerate() {
            *a = *a * went[i][j] + ALONE * *a;
        }
    }
    came
}

/// The share of each region of `to` that comes from each of `from`.
pub(crate) fn came(from: &Layout, to: &Layout, back: &Shifts) -> Table {
    let mut came = vec![vec![0.0f32; from.figures.len()]; to.figures.len()];
    count(to, from, back, |j, i| came[j][i] += 1.0);
    for row in &mut came {
        let total = row.iter().sum::<f32>().max(1.0);
        row.iter_mut().for_each(|value| *value /= total);
    }
    came
}

/// Calls `found` with the region of each cell of `here` and the region of `there` to which it is carried.
fn count(here: &Layout, there: &Layout, shifts: &Shifts, mut found: impl FnMut(usize, usize)) {
    for y in 0..here.inside.height() {
        for (x, &own) in here.inside.row(y).iter().enumerate().filter(|cell| *cell.1 > 0) {
            found(own as usize, there.nearest_at(shifts.carry(here.place(x, y))) as usize);
        }
    }
}

/// s of one way of carrying: the regions of `there` are seen through the shifts from `here` to `there`, and compared with those of `here`.
/// Region of `here`, region of `there`, s.
fn moved(there: &Layout, here: &Layout, shifts: &Shifts) -> Vec<(usize, usize, f32)> {
    let (width, height) = (here.nearest.width(), here.nearest.height());
    let seen = Raster::from_fn(width, height, |x, y| there.nearest_at(shifts.carry(here.place(x, y))));
    let shapes = figures(&seen, there.figures.len() - 1);
    let boxes = boxes(&here.nearest, here.figures.len() - 1);
    (1..here.figures.len())
        .into_par_iter()
        .flat_map_iter(|j| {
            let own = here.figures[j];
            let reach = SIZE * own.area.sqrt();
            let near = |i: &usize| {
                let other = shapes[*i];
                let ratio = other.area / own.area.max(1.0);
                other.area > 0.0
                    && ratio < RATIO
                    && ratio > 1.0 / RATIO
                    && other.middle.distance(own.middle) < FAR * here.unit + reach
            };
            let overlap = |i: usize| {
                let away = shapes[i].middle - own.middle;
                let both = common(&here.nearest, j as u32, boxes[j], &seen, i as u32, away.round());
                let union = own.area + shapes[i].area - both as f64;
                let far = away.length() / (NEAR * here.unit + reach);
                (both as f64 / union * (-far * far).exp()) as f32
            };
            (1..shapes.len()).filter(near).map(|i| (j, i, overlap(i))).collect::<Vec<_>>()
        })
        .collect()
}

/// The number of cells of region `own` in a box that are cells of `other` after a shift.
fn common(labels: &Raster<u32>, own: u32, within: [usize; 4], seen: &Raster<u32>, other: u32, shift: Point) -> usize {
    let (dx, dy) = (shift.x as isize, shift.y as isize);
    let [left, top, right, bottom] = within;
    let mut both = 0;
    for y in top..bottom {
        let Some(v) = y.checked_add_signed(dy).filter(|&v| v < seen.height()) else { continue };
        let (mine, theirs) = (labels.row(y), seen.row(v));
        for x in left..right {
            let u = x.checked_add_signed(dx).filter(|&u| u < seen.width());
            both += usize::from(mine[x] == own && u.is_some_and(|u| theirs[u] == other));
        }
    }
    both
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::regions::Regions;

    /// Two discs of different size, moved.
    fn layout(shift: f64) -> Layout {
        let circle = |x: f64, y: f64, radius: f64, at: (usize, usize)| {
            (Point::new(at.0 as f64, at.1 as f64).distance(Point::new(x + shift, y)) - radius).abs() < 1.0
        };
        let ink = Raster::from_fn(120, 60, |x, y| circle(30.0, 30.0, 14.0, (x, y)) || circle(80.0, 30.0, 9.0, (x, y)));
        Layout::new(&Regions::new(&ink))
    }

    fn still() -> Shifts {
        Shifts::new(&[], 120, 60, 60.0 / 540.0)
    }

    #[test]
    fn a_drawing_meets_itself() {
        let own = layout(0.0);
        let meeting = meeting(&own, &own, &still(), &still());
        for j in 1..own.figures.len() {
            let row = &meeting[j];
            let best = (1..row.len()).max_by(|&a, &b| row[a].total_cmp(&row[b])).unwrap();
            assert_eq!(best, j);
            assert!(row[j] > 1.9, "covered and in shape: {}", row[j]);
        }
    }

    #[test]
    fn a_region_that_the_shifts_miss_by_a_few_pixels_is_found_by_its_shape() {
        let (before, after) = (layout(0.0), layout(6.0));
        let meeting = meeting(&before, &after, &still(), &still());
        for j in 2..=3 {
            let row = &meeting[j];
            let best = (2..row.len()).max_by(|&a, &b| row[a].total_cmp(&row[b])).unwrap();
            assert_eq!(best, j);
        }
    }
}
