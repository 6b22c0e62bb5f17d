//! Contours as a mask: the mean over some instants of the union of polygons, grown or shrunk, then feathered.
//!
//! The value of a pixel does not depend on the window. A picture may therefore be computed in tiles and by several
//! threads.

use super::coverage::{Shape, Window};
use super::{feather, grow};
use rototoon_base::geometry::Point;
use rototoon_base::scene::Raster;

/// Largest number of pixels by which a mask is grown, shrunk or feathered. A picture in a window needs the pixels within
/// this distance of it, so memory would have no limit without this one.
pub const MOST_REACH: f64 = 2048.0;

/// A mask, prepared for drawing.
#[derive(Clone, Debug)]
pub struct Mask {
    instants: Vec<Vec<Vec<Point>>>,
    shape: Shape,
    grow: f64,
    feather: f64,
}

/// A rectangle that contains the mask.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Upper left corner, in pixels.
    pub least: Point,
    /// Lower right corner, in pixels.
    pub most: Point,
}

impl Mask {
    /// A mask of the closed polygons of each instant, grown by `grow` pixels (shrunk if negative), then feathered by a
    /// radius of `feather` pixels. Both count as [`MOST_REACH`] where they are larger, and as 0 if they are no number.
    pub fn new(instants: Vec<Vec<Vec<Point>>>, grow: f64, feather: f64) -> Self {
        let shape = Shape::new(&instants);
        let number = |value: f64| if value.is_nan() { 0.0 } else { value };
        let (grow, feather) = (number(grow).clamp(-MOST_REACH, MOST_REACH), number(feather).clamp(0.0, MOST_REACH));
        Self { instants, shape, grow, feather }
    }

    /// A rectangle that contains the mask; `None` if the mask is empty.
    pub fn bounds(&self) -> Option<Bounds> {
        let points = self.instants.iter().flatten().flatten().filter(|p| p.is_finite());
        let tight = points.fold(None, |bounds: Option<Bounds>, &p| {
            Some(bounds.map_or(Bounds { least: p, most: p }, |b| Bounds { least: b.least.min(p), most: b.most.max(p) }))
        })?;
        // Growing and feathering each end half a pixel further out.
        let more = |by: f64| if by == 0.0 { 0.0 } else { by + 0.5 };
        let margin = Point::splat(more(self.grow) + more(self.feather));
        let bounds = Bounds { least: tight.least - margin, most: tight.most + margin };
        bounds.least.cmple(bounds.most).all().then_some(bounds)
    }

    /// Whether the mask is empty in a window.
    pub fn misses(&self, window: Window) -> bool {
        self.bounds().is_none_or(|b| {
            b.least.x >= window.right as f64
                || b.least.y >= window.bottom as f64
                || b.most.x <= window.left as f64
                || b.most.y <= window.top as f64
        })
    }

    /// Coverage, 0 to 1, of the pixels of a window. `None` if `go_on`, called for each row, returns false.
    pub fn draw(&self, window: Window, go_on: &mut dyn FnMut() -> bool) -> Option<Raster<f32>> {
        if self.misses(window) {
            return Some(Raster::new(window.width(), window.height(), 0.0));
        }
        let wide = window.grown(feather::reach(self.feather) as i64);
        let hard = if self.grow == 0.0 { self.covered(wide, go_on)? } else { self.grown(wide, go_on)? };
        if self.feather > 0.0 { feather::feathered(&hard, self.feather, go_on) } else { Some(hard) }
    }

    fn covered(&self, window: Window, go_on: &mut dyn FnMut() -> bool) -> Option<Raster<f32>> {
        let mut values = Vec::with_capacity(window.width() * window.height());
        let whole = self.shape.rows(window, &mut |_, row| {
            values.extend_from_slice(row);
            go_on()
        });
        if whole { Raster::from_vec(window.width(), window.height(), values) } else { None }
    }

    fn grown(&self, window: Window, go_on: &mut dyn FnMut() -> bool) -> Option<Raster<f32>> {
        let mut sum = Raster::new(window.width(), window.height(), 0.0f32);
        let share = 1.0 / self.instants.len().max(1) as f32;
        for polygons in &self.instants {
            let one = grow::grown(polygons, self.grow, window, go_on)?;
            for (sum, value) in sum.data_mut().iter_mut().zip(one.data()) {
                *sum += share * value;
            }
        }
        Some(sum)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(x: f64, y: f64, size: f64) -> Vec<Point> {
        vec![Point::new(x, y), Point::new(x + size, y), Point::new(x + size, y + size), Point::new(x, y + size)]
    }

    #[test]
    fn nothing_lies_beyond_the_bounds_and_windows_agree() {
        let instants = vec![vec![square(10.0, 9.0, 8.0)], vec![square(12.3, 9.6, 8.0)]];
        let all = Window { left: 0, top: 0, right: 40, bottom: 36 };
        for (grow, feather) in [(0.0, 0.0), (2.5, 0.0), (-1.5, 3.0), (0.0, 4.2)] {
            let mask = Mask::new(instants.clone(), grow, feather);
            let bounds = mask.bounds().unwrap();
            let whole = mask.draw(all, &mut || true).unwrap();
            for y in 0..36 {
                for x in 0..40 {
                    let (p, q) = (Point::new(x as f64, y as f64), Point::new(x as f64 + 1.0, y as f64 + 1.0));
                    let beyond = q.cmple(bounds.least).any() || p.cmpge(bounds.most).any();
                    assert!(!beyond || whole.get(x, y) < 1e-6, "{grow} {feather} {x} {y} {}", whole.get(x, y));
                }
            }
            let part = Window { left: 11, top: 8, right: 19, bottom: 21 };
            let piece = mask.draw(part, &mut || true).unwrap();
            for y in 0..13 {
                for x in 0..8 {
                    assert_eq!(piece.get(x, y), whole.get(x + 11, y + 8), "{grow} {feather}");
                }
            }
        }
    }

    #[test]
    fn a_huge_reach_is_limited() {
        let window = Window { left: 0, top: 0, right: 3, bottom: 2 };
        let huge = |grow, feather| Mask::new(vec![vec![square(0.0, 0.0, 2.0)]], grow, feather);
        let limited = huge(0.0, MOST_REACH);
        let drawn = limited.draw(window, &mut || true).unwrap();
        assert!(drawn.data().iter().all(|value| (0.0..1.0).contains(value)), "{drawn:?}");
        for feather in [1e12, 1e300, f64::INFINITY] {
            assert_eq!(huge(0.0, feather).bounds(), limited.bounds());
            assert_eq!(huge(0.0, feather).draw(window, &mut || true).unwrap(), drawn);
        }
        assert_eq!(huge(f64::INFINITY, 0.0).draw(window, &mut || true).unwrap().data(), [1.0; 6]);
        assert_eq!(huge(f64::NAN, f64::NAN).draw(window, &mut || true).unwrap().data(), [1.0, 1.0, 0.0, 1.0, 1.0, 0.0]);
    }

    #[test]
    fn a_mask_of_nothing_has_no_bounds() {
        let window = Window { left: 0, top: 0, right: 3, bottom: 2 };
        for mask in [Mask::new(vec![], 0.0, 1.0), Mask::new(vec![vec![square(0.0, 0.0, 2.0)]], -9.0, 0.0)] {
            assert_eq!(mask.bounds(), None);
            assert_eq!(mask.draw(window, &mut || true).unwrap().data(), [0.0; 6]);
        }
    }
}
