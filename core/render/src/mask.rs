//! Contours as a mask: the mean over some instants of the union of polygons, grown or shrunk, then feathered. The feather
//! may have other widths along the contours, and another falloff than that of the blur.
//!
//! Such a falloff belongs to the border of each instant: the mean of the instants is taken behind it. So a mask that moves is
//! blurred once for each instant that differs from the one before.
//!
//! The value of a pixel does not depend on the window. A picture may therefore be computed in tiles and by several
//! threads.

use super::coverage::{Shape, Window};
use super::feather::{Feather, Ramp};
use super::rows::{MaskRows, Source};
use super::widths::{Piece, Widths};
use super::{feather, grow};
use rototoon_base::geometry::Point;
use rototoon_base::scene::{Falloff, Raster};
use std::sync::Arc;

/// Largest number of pixels by which a mask is grown, shrunk or feathered. A picture in a window needs the pixels within
/// this distance of it, so memory would have no limit without this one.
pub const MOST_REACH: f64 = 2048.0;

/// A mask, prepared for drawing.
#[derive(Clone, Debug)]
pub struct Mask {
    instants: Vec<Vec<Vec<Point>>>,
    shape: Shape,
    /// The bounds of all outlines.
    tight: Option<Bounds>,
    grow: f64,
    feather: f64,
    /// What is added to the feather along the contours, if it is not the same everywhere.
    widths: Option<Widths>,
    /// The falloff, if it is not that of the blur.
    ramp: Option<Arc<Ramp>>,
}

/// A rectangle that contains the mask.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Upper left corner, in pixels.
    pub least: Point,
    /// Lower right corner, in pixels.
    pub most: Point,
}

impl Bounds {
    /// The least rectangle that contains two.
    pub fn united(self, other: Self) -> Self {
        Self { least: self.least.min(other.least), most: self.most.max(other.most) }
    }

    /// The intersection of two rectangles; `None` if it has no area.
    pub fn shared(self, other: Self) -> Option<Self> {
        let both = Self { least: self.least.max(other.least), most: self.most.min(other.most) };
        both.least.cmplt(both.most).all().then_some(both)
    }

    /// Whether no pixel of a window touches the rectangle.
    pub fn misses(self, window: Window) -> bool {
        self.least.x >= window.right as f64
            || self.least.y >= window.bottom as f64
            || self.most.x <= window.left as f64
            || self.most.y <= window.top as f64
    }

    /// The pixels of a window that are in the rectangle; `None` if there are none.
    pub(super) fn pixels(&self, window: Window) -> Option<Window> {
        let both = Window {
            left: window.left.max(self.least.x.floor() as i64),
            top: window.top.max(self.least.y.floor() as i64),
            right: window.right.min(self.most.x.ceil() as i64),
            bottom: window.bottom.min(self.most.y.ceil() as i64),
        };
        (both.left < both.right && both.top < both.bottom).then_some(both)
    }
}

/// How far growing or feathering by some pixels reaches: half a pixel further out.
fn margin_of(by: f64) -> f64 {
    if by == 0.0 { 0.0 } else { by + 0.5 }
}

impl Mask {
    /// A mask of the closed polygons of each instant, grown by `grow` pixels (shrunk if negative), then feathered by a
    /// radius of `feather` pixels. Both count as [`MOST_REACH`] where they are larger, and as 0 if they are no number.
    pub fn new(instants: Vec<Vec<Vec<Point>>>, grow: f64, feather: f64) -> Self {
        let shape = Shape::new(&instants);
        let points = instants.iter().flatten().flatten().filter(|p| p.is_finite());
        let tight = points.map(|&p| Bounds { least: p, most: p }).reduce(Bounds::united);
        let number = |value: f64| if value.is_nan() { 0.0 } else { value };
        let (grow, feather) = (number(grow).clamp(-MOST_REACH, MOST_REACH), number(feather).clamp(0.0, MOST_REACH));
        Self { instants, shape, tight, grow, feather, widths: None, ramp: None }
    }

    /// The mask with widths along its contours, in pixels, that are added to its feather. The sum of both counts as
    /// [`MOST_REACH`] where it is larger.
    pub fn with_widths(mut self, pieces: &[Piece]) -> Self {
        let limited = |piece: &Piece| Piece { width: piece.width.clamp(0.0, MOST_REACH - self.feather), ..*piece };
        self.widths = Widths::new(&pieces.iter().map(limited).collect::<Vec<_>>());
        if let Some([least, most]) = self.widths.as_ref().map(|widths| widths.range)
            && least == most
        {
            self.feather += least;
            self.widths = None;
        }
        self
    }

    /// The mask with a falloff of its soft border.
    pub fn with_falloff(mut self, falloff: Falloff) -> Self {
        self.ramp = Ramp::new(falloff).map(Arc::new);
        self
    }

    /// The falloff if it changes anything: the border is soft.
    fn falloff(&self) -> Option<&Ramp> {
        self.ramp.as_deref().filter(|_| self.radii()[1] > 0.0)
    }

    /// Whether each instant needs a blur of its own.
    fn is_blurred_by_instants(&self) -> bool {
        self.falloff().is_some() && self.instants.windows(2).any(|pair| pair[0] != pair[1])
    }

    /// The least and the greatest radius of the feather.
    fn radii(&self) -> [f64; 2] {
        let [least, most] = self.widths.as_ref().map_or([0.0; 2], |widths| widths.range);
        [self.feather + least, self.feather + most]
    }

    /// A rectangle that contains the mask; `None` if the mask is empty.
    pub fn bounds(&self) -> Option<Bounds> {
        self.grown_bounds(margin_of(self.radii()[1]))
    }

    /// The bounds of the moved outlines, larger by `more` on each side.
    fn grown_bounds(&self, more: f64) -> Option<Bounds> {
        let tight = self.tight?;
        let margin = Point::splat(margin_of(self.grow) + more);
        let bounds = Bounds { least: tight.least - margin, most: tight.most + margin };
        bounds.least.cmple(bounds.most).all().then_some(bounds)
    }

    /// By how many pixels values reach beyond the hard mask, because of its feather.
    pub fn reach(&self) -> usize {
        feather::reach(self.radii()[1])
    }

    /// Whether the mask is drawn as a whole, not row by row: it is grown or shrunk, its feather has several widths, or its
    /// instants are blurred one by one.
    pub fn is_drawn_whole(&self) -> bool {
        self.grow != 0.0 || self.widths.is_some() || self.is_blurred_by_instants()
    }

    /// Number of values that the rows of a window keep, because of the feather.
    pub(super) fn kept(&self, window: Window) -> usize {
        let own = self.bounds().and_then(|bounds| bounds.pixels(window));
        own.map_or(0, |own| own.width().saturating_mul(2 * self.reach()))
    }

    /// Whether the mask is empty in a window.
    pub fn misses(&self, window: Window) -> bool {
        self.bounds().is_none_or(|bounds| bounds.misses(window))
    }

    /// Coverage, 0 to 1, of the pixels of a window. `None` if `go_on`, called for each row, returns false.
    pub fn draw(&self, window: Window, go_on: &mut dyn FnMut() -> bool) -> Option<Raster<f32>> {
        let mut picture = Raster::new(window.width(), window.height(), 0.0);
        let mut rows = self.rows(window, go_on)?;
        for y in 0..window.height() {
            rows.next_into(picture.row_mut(y), go_on)?;
        }
        Some(picture)
    }

    /// The rows of a window. A mask that is grown is drawn first: `None` if `go_on`, called for each row, returns false.
    pub fn rows(&self, window: Window, go_on: &mut dyn FnMut() -> bool) -> Option<MaskRows<'_>> {
        let Some(own) = self.bounds().and_then(|bounds| bounds.pixels(window)) else {
            return Some(MaskRows::new(window, None));
        };
        if self.is_blurred_by_instants() {
            return Some(MaskRows::new(window, Some((own, Source::Picture(self.by_instants(own, go_on)?)))));
        }
        let wide = own.grown(self.reach() as i64);
        if let Some(widths) = &self.widths {
            let source = Source::Picture(self.varied(widths, own, wide, go_on)?);
            return Some(MaskRows::new(window, Some((own, source))).with_ramp(self.falloff()));
        }
        let source = match (self.grow == 0.0, self.feather == 0.0) {
            (true, true) => Source::Sides(self.shape.rows(own)),
            (true, false) => Source::Soft(Box::new(Feather::new(self.feather, wide.width())), self.shape.rows(wide)),
            (false, true) => Source::Picture(self.grown(own, go_on)?),
            (false, false) => Source::Picture(feather::feathered(&self.hard(wide, go_on)?, self.feather, go_on)?),
        };
        Some(MaskRows::new(window, Some((own, source))).with_ramp(self.falloff()))
    }

    /// Draws each instant with the falloff, and takes the mean.
    fn by_instants(&self, window: Window, go_on: &mut dyn FnMut() -> bool) -> Option<Raster<f32>> {
        let mut sum = Raster::new(window.width(), window.height(), 0.0f32);
        for same in self.instants.chunk_by(|a, b| a == b) {
            let one = Self {
                widths: self.widths.clone(),
                ramp: self.ramp.clone(),
                ..Self::new(vec![same[0].clone()], self.grow, self.feather)
            };
            let mut rows = one.rows(window, go_on)?;
            for y in 0..window.height() {
                rows.next(go_on)?;
                let drawn = rows.drawn();
                for (sum, value) in sum.row_mut(y)[drawn.clone()].iter_mut().zip(&rows.latest()[drawn]) {
                    *sum += same.len() as f32 * value;
                }
            }
        }
        // A quotient, since a number of ones times its inverse may not be 1.
        sum.data_mut().iter_mut().for_each(|sum| *sum /= self.instants.len() as f32);
        Some(sum)
    }

    /// Draws a mask whose feather has several widths.
    fn varied(
        &self,
        widths: &Widths,
        own: Window,
        wide: Window,
        go_on: &mut dyn FnMut() -> bool,
    ) -> Option<Raster<f32>> {
        let hard = if self.grow == 0.0 { self.shape.draw(wide, go_on)? } else { self.hard(wide, go_on)? };
        let mut radius = widths.raster(own, self.bounds()?, go_on)?;
        let range = self.radii();
        radius.data_mut().iter_mut().for_each(|width| *width = (f64::from(*width) + self.feather) as f32);
        feather::varied(&hard, &radius, range, go_on)
    }

    /// Draws the grown mask in a window without its feather.
    fn hard(&self, window: Window, go_on: &mut dyn FnMut() -> bool) -> Option<Raster<f32>> {
        let mut picture = Raster::new(window.width(), window.height(), 0.0);
        if let Some(own) = self.grown_bounds(0.0).and_then(|bounds| bounds.pixels(window)) {
            let grown = self.grown(own, go_on)?;
            let (left, top) = ((own.left - window.left) as usize, (own.top - window.top) as usize);
            for y in 0..own.height() {
                picture.row_mut(top + y)[left..left + own.width()].copy_from_slice(grown.row(y));
            }
        }
        Some(picture)
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
    use super::super::widths;
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

    fn paths(corners: &[Point]) -> Vec<Vec<Point>> {
        (0..corners.len()).map(|k| vec![corners[k], corners[(k + 1) % corners.len()]]).collect()
    }

    /// The share of a quadratic B-spline from -radius to radius that lies below x.
    fn rise(x: f64, radius: f64) -> f64 {
        let u = (1.5 * x / radius).clamp(-1.5, 1.5);
        let tail = |u: f64| (1.5 - u).powi(3) / 6.0;
        if u > 0.5 {
            1.0 - tail(u)
        } else if u < -0.5 {
            tail(-u)
        } else {
            0.5 + 0.75 * u - u.powi(3) / 3.0
        }
    }

    #[test]
    fn equal_widths_are_the_feather_itself() {
        let window = Window { left: 0, top: 0, right: 40, bottom: 36 };
        let corners = square(10.0, 9.0, 14.3);
        for (grow, feather, width) in [(0.0, 0.0, 4.2), (0.0, 1.5, 3.0), (2.0, 0.0, 3.3), (0.0, 2.0, 0.0)] {
            let mask = Mask::new(vec![vec![corners.clone()]], grow, feather);
            let soft = mask.with_widths(&widths::pieces(&paths(&corners), &[width; 4]));
            let plain = Mask::new(vec![vec![corners.clone()]], grow, feather + width);
            assert_eq!(soft.bounds(), plain.bounds());
            assert_eq!(soft.draw(window, &mut || true), plain.draw(window, &mut || true), "to the last bit");
        }
    }

    #[test]
    fn widths_that_rise_along_a_border_give_ramps_of_these_widths() {
        // A border at x = 60 from y = 0 to 200, whose width rises from 4 to 24. The other corners are far away.
        let corners: Vec<Point> =
            [(60.0, 0.0), (60.0, 200.0), (-300.0, 200.0), (-300.0, 0.0)].map(|(x, y)| Point::new(x, y)).into();
        let pieces = widths::pieces(&paths(&corners), &[4.0, 24.0, 24.0, 4.0]);
        let mask = Mask::new(vec![vec![corners]], 0.0, 2.0).with_widths(&pieces);
        assert!(mask.is_drawn_whole());
        let window = Window { left: 20, top: 50, right: 100, bottom: 150 };
        let drawn = mask.draw(window, &mut || true).unwrap();
        for (y, radius) in [(20, 2.0 + 4.0 + 7.05), (50, 2.0 + 4.0 + 10.05), (80, 2.0 + 4.0 + 13.05)] {
            for x in 0..80 {
                let wanted = 1.0 - rise(x as f64 + 20.5 - 60.0, radius);
                let found = f64::from(drawn.get(x, y));
                assert!((found - wanted).abs() < 0.01, "{x} {y}: {found} {wanted}");
            }
        }
    }

    #[test]
    fn with_widths_nothing_lies_beyond_the_bounds_and_windows_agree() {
        let corners = square(20.0, 19.0, 30.0);
        let pieces = widths::pieces(&paths(&corners), &[0.0, 12.0, 3.0, 0.0]);
        let all = Window { left: 0, top: 0, right: 70, bottom: 66 };
        let part = Window { left: 17, top: 13, right: 49, bottom: 41 };
        for (grow, feather) in [(0.0, 0.0), (2.5, 1.0)] {
            let mask = Mask::new(vec![vec![corners.clone()]], grow, feather).with_widths(&pieces);
            let [whole, piece] = [all, part].map(|window| mask.draw(window, &mut || true).unwrap());
            for y in 0..part.height() {
                for x in 0..part.width() {
                    assert_eq!(piece.get(x, y), whole.get(x + 17, y + 13), "{grow} {feather}");
                }
            }
            let bounds = mask.bounds().unwrap();
            assert!(bounds.least.x < 20.0 - 12.0 && whole.get(35, 34) == 1.0);
            for (k, value) in whole.data().iter().enumerate() {
                let (p, one) = (Point::new((k % 70) as f64, (k / 70) as f64), Point::ONE);
                let beyond = (p + one).cmple(bounds.least).any() || p.cmpge(bounds.most).any();
                assert!(!beyond || *value < 1e-6, "{p} {value}");
            }
        }
        let mask = Mask::new(vec![vec![corners]], 0.0, 0.0).with_widths(&pieces);
        assert_eq!(mask.draw(all, &mut || false), None);
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
