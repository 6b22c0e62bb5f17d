//! Outlines drawn as lines over the source.
//!
//! Nearer parts lie above farther ones. Lines have a dark border, as in the core's overlay. It shows which of two crossing
//! lines is in front.

use super::picture::{each, over};
use crate::pixels::Pixel;
use rototoon::geometry::Point;
use rototoon::render::coverage::Window;
use rototoon::render::line;
use rototoon::scene::Raster;

/// Width of a line's border on each side, as a share of the line's width.
const BORDER: f64 = 0.5;
/// Opacity of the border.
const BORDER_OPACITY: f32 = 0.5;

/// Outlines to draw as lines, the farthest first.
#[derive(Clone, Debug)]
pub struct Lines {
    /// For each outline its points, and whether the last point joins the first.
    outlines: Vec<(Vec<Point>, bool)>,
    width: f64,
    colour: [f32; 4],
}

impl Lines {
    /// Outlines with their width in pixels, and a colour with opacity.
    pub fn new(outlines: Vec<(Vec<Point>, bool)>, width: f64, colour: [f32; 4]) -> Self {
        Self { outlines, width, colour }
    }

    fn reach(&self) -> f64 {
        0.5 * self.width.max(1.0) * (1.0 + 2.0 * BORDER) + 0.5
    }

    fn visible(&self) -> bool {
        self.width > 0.0 && self.colour[3] > 0.0
    }

    fn near(&self, points: &[Point], window: Window) -> bool {
        let (least, most) = points.iter().fold((Point::MAX, Point::MIN), |(a, b), &p| (a.min(p), b.max(p)));
        let reach = self.reach();
        least.x - reach < window.right as f64
            && least.y - reach < window.bottom as f64
            && most.x + reach > window.left as f64
            && most.y + reach > window.top as f64
    }

    /// Whether no line is in a window.
    pub fn misses(&self, window: Window) -> bool {
        !self.visible() || !self.outlines.iter().any(|(points, _)| self.near(points, window))
    }

    /// Draws over the pixels of a window. Calls `go_on` at each row, and returns `None` if it returns false.
    pub fn paint(&self, window: Window, pixels: &mut Raster<Pixel>, go_on: &mut dyn FnMut() -> bool) -> Option<()> {
        if !self.visible() {
            return Some(());
        }
        let [r, g, b, a] = self.colour;
        for outline in self.outlines.iter().filter(|(points, _)| self.near(points, window)) {
            let one = std::slice::from_ref(outline);
            let border = line::lines(one, self.width * (1.0 + 2.0 * BORDER), window, go_on)?;
            each(pixels, &border, |pixel, m| over(pixel, [0.0; 3], BORDER_OPACITY * a * m));
            let line = line::lines(one, self.width, window, go_on)?;
            each(pixels, &line, |pixel, m| over(pixel, [r, g, b], a * m));
        }
        Some(())
    }
}
