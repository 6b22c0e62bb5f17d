//! Draws the outlines at a time into pixels.
//!
//! Parts are drawn from the farthest to the nearest, and parts of equal depth in the document's order. So ids and lines of
//! nearer parts cover those of farther ones. Lines have a dark border, as in the core's overlay. It shows which of two
//! crossing lines is in front.

use super::placement::Placement;
use super::settings::{Output, Settings};
use crate::pixels::Pixel;
use rototoon::geometry::Point;
use rototoon::render::coverage::Window;
use rototoon::render::line;
use rototoon::render::mask::{Bounds, Mask};
use rototoon::render::motion::{outline_at, shutter};
use rototoon::scene::{Part, Raster, Scene, palette};

/// Width of a line's border on each side, as a share of the line's width.
const BORDER: f64 = 0.5;
/// Opacity of the border.
const BORDER_OPACITY: f32 = 0.5;

/// Something to draw, in pixels with y turned down.
#[derive(Clone, Debug)]
pub enum Picture {
    /// The previous pixels inside the mask, or outside of it if the flag is set.
    Cutout(Mask, bool),
    /// White inside the mask, or outside of it if the flag is set.
    Matte(Mask, bool),
    /// Masks with their colours, the farthest first.
    Ids(Vec<(Mask, [f32; 3])>),
    /// Outlines over the previous pixels, the farthest first.
    Lines(Lines),
}

/// Outlines to draw as lines.
#[derive(Clone, Debug)]
pub struct Lines {
    /// For each outline its points, and whether the last point joins the first.
    outlines: Vec<(Vec<Point>, bool)>,
    width: f64,
    colour: [f32; 4],
}

impl Picture {
    /// The picture of the parts with these indices.
    pub fn new(scene: &Scene, parts: &[usize], settings: &Settings, placement: &Placement) -> Self {
        let mut order = parts.to_vec();
        order.sort_by(|&a, &b| scene.parts[a].depth.total_cmp(&scene.parts[b].depth));
        let (grow, feather) = (placement.length(settings.grow), placement.length(settings.feather));
        let mask = |parts: &[usize]| {
            let closed: Vec<&Part> =
                parts.iter().map(|&index| &scene.parts[index]).filter(|part| part.closed).collect();
            Mask::new(instants(&closed, settings, placement), grow, feather)
        };
        match settings.output {
            Output::Cutout => Self::Cutout(mask(&order), settings.invert),
            Output::Matte => Self::Matte(mask(&order), settings.invert),
            Output::Ids => Self::Ids(order.iter().map(|&index| (mask(&[index]), palette::distinct(index))).collect()),
            Output::Overlay => {
                let outline = |&index: &usize| {
                    let part = &scene.parts[index];
                    let points = outline_at(part, settings.document_time, settings.curves)?;
                    Some((points.into_iter().map(|p| placement.place(p)).collect(), part.closed))
                };
                Self::Lines(Lines {
                    outlines: order.iter().filter_map(outline).collect(),
                    width: placement.length(settings.line_width),
                    colour: settings.line_colour,
                })
            }
        }
    }

    /// Whether the picture changes no pixel of a window.
    pub fn changes_nothing(&self, window: Window) -> bool {
        match self {
            Self::Cutout(mask, true) => mask.misses(window),
            Self::Lines(lines) => lines.misses(window),
            _ => false,
        }
    }

    /// The bounds of the drawn pixels. If the flag is true, pixels outside of them are drawn too.
    pub fn bounds(&self) -> (Option<Bounds>, bool) {
        match self {
            Self::Cutout(mask, invert) | Self::Matte(mask, invert) => (mask.bounds(), *invert),
            Self::Ids(layers) => (layers.iter().filter_map(|(mask, _)| mask.bounds()).reduce(united), false),
            Self::Lines(_) => (None, true),
        }
    }

    /// Draws over the pixels of a window. Calls `go_on` at each row, and returns `None` if it returns false.
    pub fn paint(&self, window: Window, pixels: &mut Raster<Pixel>, go_on: &mut dyn FnMut() -> bool) -> Option<()> {
        match self {
            Self::Cutout(mask, invert) => {
                let mask = mask.draw(window, go_on)?;
                each(pixels, &mask, |pixel, m| {
                    let m = if *invert { 1.0 - m } else { m };
                    *pixel = pixel.map(|value| value * m);
                });
            }
            Self::Matte(mask, invert) => {
                let mask = mask.draw(window, go_on)?;
                each(pixels, &mask, |pixel, m| *pixel = [if *invert { 1.0 - m } else { m }; 4]);
            }
            Self::Ids(layers) => {
                for (mask, [r, g, b]) in layers.iter().filter(|(mask, _)| !mask.misses(window)) {
                    let mask = mask.draw(window, go_on)?;
                    each(pixels, &mask, |pixel, m| over(pixel, [*r, *g, *b], m));
                }
            }
            Self::Lines(lines) => lines.paint(window, pixels, go_on)?,
        }
        Some(())
    }
}

impl Lines {
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

    fn misses(&self, window: Window) -> bool {
        !self.visible() || !self.outlines.iter().any(|(points, _)| self.near(points, window))
    }

    fn paint(&self, window: Window, pixels: &mut Raster<Pixel>, go_on: &mut dyn FnMut() -> bool) -> Option<()> {
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

/// The outlines of closed parts at the times while the shutter is open. A part with an outline at the frame's time has one
/// at all of these times: outside of its track it keeps that outline.
fn instants(parts: &[&Part], settings: &Settings, placement: &Placement) -> Vec<Vec<Vec<Point>>> {
    let time = settings.document_time;
    let still: Vec<(&Part, Vec<Point>)> =
        parts.iter().filter_map(|part| Some((*part, outline_at(part, time, settings.curves)?))).collect();
    if still.is_empty() {
        return Vec::new();
    }
    let placed = |points: Vec<Point>| points.into_iter().map(|p| placement.place(p)).collect();
    shutter(time, settings.shutter, settings.samples)
        .into_iter()
        .map(|t| {
            let at = |(part, held): &(&Part, Vec<Point>)| {
                placed(outline_at(part, t, settings.curves).unwrap_or_else(|| held.clone()))
            };
            still.iter().map(at).collect()
        })
        .collect()
}

fn united(a: Bounds, b: Bounds) -> Bounds {
    Bounds { least: a.least.min(b.least), most: a.most.max(b.most) }
}

fn each(pixels: &mut Raster<Pixel>, mask: &Raster<f32>, mut change: impl FnMut(&mut Pixel, f32)) {
    for (pixel, &m) in pixels.data_mut().iter_mut().zip(mask.data()) {
        change(pixel, m);
    }
}

/// Composites a colour over a premultiplied pixel.
fn over(pixel: &mut Pixel, colour: [f32; 3], alpha: f32) {
    if alpha > 0.0 {
        let [r, g, b] = colour;
        let rest = 1.0 - alpha;
        *pixel = [
            r * alpha + pixel[0] * rest,
            g * alpha + pixel[1] * rest,
            b * alpha + pixel[2] * rest,
            alpha + pixel[3] * rest,
        ];
    }
}
