//! A blur whose radius differs from pixel to pixel.
//!
//! The picture is blurred with a few radii, each at most [`RATIO`] times the one before. A pixel lies between two of them
//! and is mixed of the two. A radius that is one of them is exact, and pixels around which all is the same stay exactly
//! what they are. Each radius is applied only within the rectangle of the pixels that need it.
//!
//! Limits: beside a straight border a pixel is at most 0.005 away from the blur with its own radius, 0.02 where the radius is
//! below one pixel.

use super::{feathered, reach};
use rototoon_base::scene::Raster;

/// Largest quotient of neighbouring radii from one pixel on.
const RATIO: f64 = 1.25;
/// Radii below one pixel.
const SMALL: [f64; 4] = [0.25, 0.5, 0.75, 1.0];

/// The radii that are computed for radii from the least to the greatest.
fn radii([least, greatest]: [f64; 2]) -> Vec<f64> {
    let mut radii = vec![least];
    radii.extend(SMALL.into_iter().filter(|small| *small > least && *small < greatest));
    let start = radii[radii.len() - 1];
    let count = if start < 1.0 { 1.0 } else { ((greatest / start).ln() / RATIO.ln()).ceil().max(1.0) };
    let step = (greatest / start).powf(1.0 / count);
    radii.extend((1..count as usize).map(|k| start * step.powi(k as i32)));
    radii.push(greatest);
    radii
}

/// Columns and rows from the first to before the last.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Area {
    left: usize,
    top: usize,
    right: usize,
    bottom: usize,
}

impl Area {
    fn united(self, other: Self) -> Self {
        Self {
            left: self.left.min(other.left),
            top: self.top.min(other.top),
            right: self.right.max(other.right),
            bottom: self.bottom.max(other.bottom),
        }
    }
}

/// Blurs a picture. `radius` has the radius of each pixel of the result, all of them within `range`. The result is smaller
/// than the picture by the [`reach`] of the greatest radius of the range on each side. `None` if `go_on`, called for each
/// row, returns false.
pub fn varied(
    picture: &Raster<f32>,
    radius: &Raster<f32>,
    range: [f64; 2],
    go_on: &mut dyn FnMut() -> bool,
) -> Option<Raster<f32>> {
    let radii = radii(range);
    let margin = reach(range[1]);
    let interval = |r: f32| radii[1..radii.len() - 1].partition_point(|known| *known <= f64::from(r));
    let areas = areas(radius, radii.len() - 1, &interval);
    let mut result = Raster::new(radius.width(), radius.height(), 0.0f32);
    let mut below: Option<(Area, Raster<f32>)> = None;
    for k in 0..radii.len() {
        let [before, after] = [k.checked_sub(1).and_then(|k| areas[k]), areas.get(k).copied().flatten()];
        let Some(area) = [before, after].into_iter().flatten().reduce(Area::united) else {
            below = None;
            continue;
        };
        let blurred = feathered(&cut(picture, area, margin, reach(radii[k])), radii[k], go_on)?;
        if let (Some(own), Some((from, lower))) = (before, &below) {
            for y in own.top..own.bottom {
                let row = result.row_mut(y);
                for (x, mixed) in row.iter_mut().enumerate().take(own.right).skip(own.left) {
                    let r = radius.get(x, y);
                    if interval(r) == k - 1 {
                        let (a, b) = (lower.get(x - from.left, y - from.top), blurred.get(x - area.left, y - area.top));
                        let share = (f64::from(r) - radii[k - 1]) / (radii[k] - radii[k - 1]);
                        *mixed = a + share.clamp(0.0, 1.0) as f32 * (b - a);
                    }
                }
            }
        }
        below = Some((area, blurred));
    }
    Some(result)
}

/// For each interval between neighbouring radii the area of the pixels in it.
fn areas(radius: &Raster<f32>, count: usize, interval: &dyn Fn(f32) -> usize) -> Vec<Option<Area>> {
    let mut areas: Vec<Option<Area>> = vec![None; count];
    for y in 0..radius.height() {
        for (x, &r) in radius.row(y).iter().enumerate() {
            let own = Area { left: x, top: y, right: x + 1, bottom: y + 1 };
            let area = &mut areas[interval(r)];
            *area = Some(area.map_or(own, |area| area.united(own)));
        }
    }
    areas
}

/// The piece of a picture around an area that a blur of this reach needs. The picture is larger than what areas count in by
/// `margin` on each side.
fn cut(picture: &Raster<f32>, area: Area, margin: usize, reach: usize) -> Raster<f32> {
    let (left, top) = (area.left + margin - reach, area.top + margin - reach);
    let (width, height) = (area.right - area.left + 2 * reach, area.bottom - area.top + 2 * reach);
    Raster::from_fn(width, height, |x, y| picture.get(left + x, top + y))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn radii_begin_and_end_with_the_range_and_rise_slowly() {
        for range in [[0.0, 50.0], [0.0, 0.3], [0.6, 0.7], [0.9, 1.0], [1.0, 1.1], [3.0, 2000.0], [0.0, 1.0]] {
            let radii = radii(range);
            assert_eq!([radii[0], radii[radii.len() - 1]], range);
            assert!(radii.windows(2).all(|pair| pair[0] < pair[1]), "{radii:?}");
            let slow = |pair: &[f64]| pair[1] - pair[0] <= 0.25 + 1e-9 || pair[1] / pair[0] <= RATIO + 1e-9;
            assert!(radii.windows(2).all(slow), "{radii:?}");
            assert!(radii.len() < 45);
        }
    }

    /// Each pixel of the blur of the whole picture with the pixel's own radius.
    fn naive(picture: &Raster<f32>, radius: &Raster<f32>, margin: usize) -> Raster<f32> {
        Raster::from_fn(radius.width(), radius.height(), |x, y| {
            let r = f64::from(radius.get(x, y));
            feathered(picture, r, &mut || true).unwrap().get(x + margin - reach(r), y + margin - reach(r))
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        #[test]
        fn it_is_near_the_blur_with_each_pixels_own_radius(
            least in prop_oneof![Just(0.0), 0.0f64..6.0], more in 0.01f64..9.0,
            slant in -1.0f64..1.0, way in 0.0f64..1.0,
        ) {
            let range = [least, least + more];
            let margin = reach(range[1]);
            let (width, height) = (17, 9);
            // A straight border through the middle, antialiased; and radii that change along a direction.
            let border = Raster::from_fn(width + 2 * margin, height + 2 * margin, |x, y| {
                let (x, y) = (x as f64 - (margin + 8) as f64, y as f64 - (margin + 4) as f64);
                (0.5 - x - slant * y).clamp(0.0, 1.0) as f32
            });
            let radius = Raster::from_fn(width, height, |x, y| {
                let share = way * x as f64 / 16.0 + (1.0 - way) * y as f64 / 8.0;
                (range[0] + more * share) as f32
            });
            let (fast, slow) = (varied(&border, &radius, range, &mut || true).unwrap(), naive(&border, &radius, margin));
            for y in 0..height {
                for x in 0..width {
                    let (a, b, r) = (fast.get(x, y), slow.get(x, y), radius.get(x, y));
                    let most = if r < 1.0 { 0.02 } else { 0.005 };
                    prop_assert!((a - b).abs() < most, "{x} {y} {r}: {a} {b}");
                }
            }
        }
    }

    #[test]
    fn one_of_the_radii_is_exact_and_flat_areas_stay() {
        let picture = Raster::from_fn(60, 50, |x, y| if x < 30 && y > 11 { 1.0 } else { 0.0 });
        let range = [2.0, 6.0];
        let margin = reach(6.0);
        for r in range {
            let radius = Raster::new(60 - 2 * margin, 50 - 2 * margin, r as f32);
            let blurred = varied(&picture, &radius, range, &mut || true).unwrap();
            let whole = feathered(&picture, r, &mut || true).unwrap();
            let off = margin - reach(r);
            for y in 0..radius.height() {
                for x in 0..radius.width() {
                    assert_eq!(blurred.get(x, y), whole.get(x + off, y + off));
                }
            }
        }
        let ones = Raster::new(40, 40, 1.0f32);
        let radius = Raster::from_fn(40 - 2 * margin, 40 - 2 * margin, |x, y| 2.0 + (x + y) as f32 * 0.07);
        assert!(varied(&ones, &radius, range, &mut || true).unwrap().data().iter().all(|value| *value == 1.0));
        assert_eq!(varied(&picture, &Raster::new(2, 2, 3.0), range, &mut || false), None);
    }
}
