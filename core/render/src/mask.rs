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
mod tests;
