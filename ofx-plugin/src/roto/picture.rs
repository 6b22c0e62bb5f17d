//! The picture of the parts, or of painted regions and strokes, at a time, in pixels with y turned down.
//!
//! Mattes and cutouts are made of layers, from the farthest part to the nearest, and parts of equal depth in the document's
//! order. Parts without settings and feather of their own are one layer, unless one between them is subtracted or intersected: their union is exact. In ids the parts share each
//! pixel by area, as in the command line's ids. If they are grown or feathered, nearer ones are laid over farther ones.

use super::edit::order;
use super::outlines::Lines;
use super::placement::Placement;
use super::settings::{Output, Settings};
use super::state::PartLook;
use crate::pixels::{CLEAR, Pixel};
use rototoon::geometry::Point;
use rototoon::render::composite::{Blend, Layer, LayerRows, Layers};
use rototoon::render::coverage::Window;
use rototoon::render::mask::{Bounds, Mask};
use rototoon::render::matte::feather_pieces;
use rototoon::render::motion::{outline_at, shutter_from};
use rototoon::render::paint::{self, Region, paint_in};
use rototoon::render::visible::Stack;
use rototoon::render::widths::Piece;
use rototoon::scene::{Falloff, Part, Raster, Scene, palette};

/// Something to draw.
#[derive(Clone, Debug)]
pub enum Picture {
    /// The previous pixels inside the layers, or outside of them if the flag is set.
    Cutout(Layers, bool),
    /// The coverage of the layers, or of what is outside of them if the flag is set.
    Matte(Layers, bool),
    /// The coverage of layers for red, green, blue and alpha.
    Mattes(Box<[Layers; 4]>, bool),
    /// The outlines at each instant, for ids.
    Ids(Vec<Stack>),
    /// Masks with their colours, the farthest first.
    SoftIds(Vec<(Mask, [f32; 3])>),
    /// Outlines over the previous pixels, the farthest first.
    Lines(Lines),
    /// Painted regions and strokes from back to front. If the flag is set, the source lies over them.
    Paint(Vec<Region>, bool),
}

impl Picture {
    /// The picture of the parts with these indices, or of painted regions and strokes. `selected` gives the indices of a list
    /// of names.
    pub fn new(
        scene: &Scene,
        parts: &[usize],
        selected: &dyn Fn(&str) -> Vec<usize>,
        drawn: Vec<Region>,
        settings: &Settings,
        placement: &Placement,
    ) -> Self {
        let drawing = Drawing { scene, settings, placement };
        let order = drawing.order(parts);
        match settings.output {
            Output::Cutout => Self::Cutout(drawing.layers(&order), settings.invert),
            Output::Matte => Self::Matte(drawing.layers(&order), settings.invert),
            Output::Mattes => {
                let of = |names: &String| {
                    let chosen = if names.trim().is_empty() { Vec::new() } else { drawing.order(&selected(names)) };
                    let chosen: Vec<usize> = chosen.into_iter().filter(|part| order.contains(part)).collect();
                    drawing.layers(&chosen)
                };
                Self::Mattes(Box::new(settings.channel_parts.each_ref().map(of)), settings.invert)
            }
            Output::Ids => drawing.ids(&order),
            Output::Overlay => Self::Lines(drawing.lines(&order)),
            Output::Painted => Self::Paint(drawn, true),
            Output::Paint | Output::Lines | Output::Cel => Self::Paint(drawn, false),
        }
    }

    /// Whether the picture changes no pixel of a window.
    pub fn changes_nothing(&self, window: Window) -> bool {
        match self {
            Self::Cutout(layers, true) => layers.misses(window),
            Self::Lines(lines) => lines.misses(window),
            Self::Paint(drawn, true) => paint::bounds(drawn).and_then(|all| all.common(window)).is_none(),
            _ => false,
        }
    }

    /// The bounds of the drawn pixels. If the flag is true, pixels outside of them are drawn too.
    pub fn bounds(&self) -> (Option<Bounds>, bool) {
        let with = |(bounds, everywhere), invert| (bounds, everywhere || invert);
        match self {
            Self::Cutout(layers, invert) | Self::Matte(layers, invert) => with(layers.bounds(), *invert),
            Self::Mattes(mattes, invert) => {
                let all = mattes.iter().map(Layers::bounds);
                let joined =
                    all.reduce(|(a, all), (b, too)| ([a, b].into_iter().flatten().reduce(Bounds::united), all || too));
                with(joined.unwrap_or_default(), *invert)
            }
            Self::Ids(stacks) => (stacks.iter().filter_map(Stack::bounds).map(around).reduce(Bounds::united), false),
            Self::SoftIds(layers) => {
                (layers.iter().filter_map(|(mask, _)| mask.bounds()).reduce(Bounds::united), false)
            }
            Self::Paint(drawn, false) => (paint::bounds(drawn).map(around), false),
            Self::Lines(_) | Self::Paint(_, true) => (None, true),
        }
    }

    /// The greatest number of pixels by which something reaches beyond its outline because it is soft. Windows that are not
    /// much larger repeat work.
    pub fn reach(&self) -> usize {
        let most = |layers: &Layers| layers.0.iter().map(|layer| layer.mask.reach()).max().unwrap_or(0);
        match self {
            Self::Cutout(layers, _) | Self::Matte(layers, _) => most(layers),
            Self::Mattes(mattes, _) => mattes.iter().map(most).max().unwrap_or(0),
            Self::SoftIds(layers) => layers.iter().map(|(mask, _)| mask.reach()).max().unwrap_or(0),
            Self::Ids(_) | Self::Lines(_) | Self::Paint(..) => 0,
        }
    }

    /// Whether [`Self::painting`] makes the rows one by one and in little memory.
    pub fn is_made_of_rows(&self) -> bool {
        let still = |layers: &Layers| layers.0.iter().all(|layer| !layer.mask.is_drawn_whole());
        match self {
            Self::Cutout(layers, _) | Self::Matte(layers, _) => still(layers),
            Self::Mattes(mattes, _) => mattes.iter().all(still),
            Self::Ids(_) | Self::SoftIds(_) | Self::Lines(_) | Self::Paint(..) => false,
        }
    }

    /// Begins to draw a window over pixels. `below` writes a row of them, counted from the top. Calls `go_on` at each row,
    /// and returns `None` if it returns false.
    ///
    /// A cutout multiplies the pixels. A matte is in all four channels, ids are display colours times their alpha, and paint is
    /// linear light times its alpha.
    pub fn painting(
        &self,
        window: Window,
        below: &dyn Fn(usize, &mut [Pixel]),
        go_on: &mut dyn FnMut() -> bool,
    ) -> Option<Painting<'_>> {
        Some(match self {
            Self::Cutout(layers, invert) => Painting::Cutout(layers.rows(window, go_on)?, *invert),
            Self::Matte(layers, invert) => Painting::Matte(layers.rows(window, go_on)?, *invert),
            Self::Mattes(mattes, invert) => {
                let rows: Option<Vec<_>> = mattes.iter().map(|layers| layers.rows(window, go_on)).collect();
                Painting::Mattes(rows?, *invert)
            }
            Self::Paint(drawn, _) => Painting::Picture(paint_in(drawn, window, go_on)?),
            Self::Ids(_) | Self::SoftIds(_) | Self::Lines(_) => {
                let mut pixels = Raster::new(window.width(), window.height(), CLEAR);
                for y in 0..window.height() {
                    below(y, pixels.row_mut(y));
                }
                self.paint(window, &mut pixels, go_on)?;
                Painting::Picture(pixels)
            }
        })
    }

    /// Draws what is not made of rows over the pixels of a window.
    fn paint(&self, window: Window, pixels: &mut Raster<Pixel>, go_on: &mut dyn FnMut() -> bool) -> Option<()> {
        match self {
            Self::Cutout(..) | Self::Matte(..) | Self::Mattes(..) | Self::Paint(..) => {}
            Self::Ids(stacks) => {
                let share = 1.0 / stacks.len().max(1) as f32;
                for stack in stacks {
                    let shares = stack.shares(window, go_on)?;
                    for (pixel, shown) in pixels.data_mut().iter_mut().zip(shares) {
                        shown
                            .iter()
                            .for_each(|shown| add(pixel, palette::distinct(shown.part), share * shown.coverage));
                    }
                }
            }
            Self::SoftIds(layers) => {
                for (mask, colour) in layers.iter().filter(|(mask, _)| !mask.misses(window)) {
                    let mask = mask.draw(window, go_on)?;
                    each(pixels, &mask, |pixel, m| over(pixel, *colour, m));
                }
            }
            Self::Lines(lines) => lines.paint(window, pixels, go_on)?,
        }
        Some(())
    }
}

/// A picture that is drawn row by row from the top.
pub enum Painting<'a> {
    /// Rows that multiply the pixels.
    Cutout(LayerRows<'a>, bool),
    /// Rows of coverage for all channels.
    Matte(LayerRows<'a>, bool),
    /// Rows of coverage for each channel.
    Mattes(Vec<LayerRows<'a>>, bool),
    /// Pixels that were drawn before.
    Picture(Raster<Pixel>),
}

impl Painting<'_> {
    /// Draws row `y` over pixels. The rows must be asked for in their order. `None` if `go_on` returns false.
    pub fn row(&mut self, y: usize, pixels: &mut [Pixel], go_on: &mut dyn FnMut() -> bool) -> Option<()> {
        match self {
            Self::Cutout(rows, invert) => {
                for (pixel, m) in pixels.iter_mut().zip(rows.next(go_on)?) {
                    let m = inverted(*m, *invert);
                    *pixel = pixel.map(|value| value * m);
                }
            }
            Self::Matte(rows, invert) => {
                for (pixel, m) in pixels.iter_mut().zip(rows.next(go_on)?) {
                    *pixel = [inverted(*m, *invert); 4];
                }
            }
            Self::Mattes(channels, invert) => {
                for (channel, rows) in channels.iter_mut().enumerate() {
                    for (pixel, m) in pixels.iter_mut().zip(rows.next(go_on)?) {
                        pixel[channel] = inverted(*m, *invert);
                    }
                }
            }
            Self::Picture(picture) => pixels.copy_from_slice(picture.row(y)),
        }
        Some(())
    }
}

/// What pictures are made of.
struct Drawing<'a> {
    scene: &'a Scene,
    settings: &'a Settings,
    placement: &'a Placement,
}

impl Drawing<'_> {
    fn look(&self, part: usize) -> PartLook {
        self.settings.look(&self.scene.parts[part].name)
    }

    /// Those of the parts that are drawn, the farthest first.
    fn order(&self, parts: &[usize]) -> Vec<usize> {
        let mut order: Vec<usize> = parts.iter().copied().filter(|&part| self.look(part).on).collect();
        order::sort_on(self.scene, self.settings.frame(), &mut order);
        if self.settings.shown { order } else { Vec::new() }
    }

    /// The layers of parts in order. Neighbours that are added give the same in any order, so those without settings are one mask: parts that touch have
    /// no seam, whatever part lies between them.
    fn layers(&self, order: &[usize]) -> Layers {
        let mut layers = Vec::new();
        let closed: Vec<usize> = order.iter().copied().filter(|&part| self.scene.parts[part].closed).collect();
        let is_added = |part: usize| self.look(part).blend == Blend::Add;
        for added in closed.chunk_by(|&a, &b| is_added(a) && is_added(b)) {
            let (plain, own): (Vec<usize>, Vec<usize>) = added.iter().partition(|&&part| self.is_plain(part));
            let masks = (!plain.is_empty()).then_some(&plain[..]).into_iter().chain(own.chunks(1));
            layers.extend(masks.map(|parts| {
                let (look, mask) = (self.look(parts[0]), self.mask(parts));
                Layer { mask, opacity: look.opacity as f32, invert: look.invert, blend: look.blend }
            }));
        }
        Layers(layers)
    }

    /// Whether a part is drawn like one without settings. Without a feather its falloff does not count.
    fn is_plain(&self, part: usize) -> bool {
        let (look, part) = (self.look(part), &self.scene.parts[part]);
        let soft = self.settings.feather + look.feather > 0.0;
        let falloff = if soft { look.falloff.within(part.falloff) } else { Falloff::default() };
        part.soft_widths().is_none() && PartLook { falloff, ..look }.is_plain()
    }

    /// The mask of parts that are drawn alike.
    fn mask(&self, parts: &[usize]) -> Mask {
        let PartLook { grow, feather, falloff, .. } = self.look(parts[0]);
        let falloff = falloff.within(self.scene.parts[parts[0]].falloff).within(self.settings.falloff);
        let length = |pixels| self.placement.length(pixels);
        let parts: Vec<&Part> = parts.iter().map(|&part| &self.scene.parts[part]).collect();
        let mask = Mask::new(
            self.instants(&parts),
            length(self.settings.grow + grow),
            length(self.settings.feather + feather),
        )
        .with_falloff(falloff);
        match parts[..] {
            [part] if part.soft_widths().is_some() => mask.with_widths(&self.feather_pieces(part)),
            _ => mask,
        }
    }

    /// The feather of a part along its contour, where it is at the frame's time: also under motion blur. Its widths are in pixels of the
    /// footage, and are stretched with it.
    fn feather_pieces(&self, part: &Part) -> Vec<Piece> {
        let (time, curves) = (self.settings.document_time, self.settings.curves);
        feather_pieces(part, time, curves, &|p| self.placement.place(p), self.placement.magnification())
    }

    fn ids(&self, order: &[usize]) -> Picture {
        let closed: Vec<usize> = order.iter().copied().filter(|&part| self.scene.parts[part].closed).collect();
        let look = |part| self.look(part);
        let soft = |part: usize| {
            look(part).grow != 0.0 || look(part).feather != 0.0 || self.scene.parts[part].soft_widths().is_some()
        };
        if self.settings.grow != 0.0 || self.settings.feather != 0.0 || closed.iter().any(|&part| soft(part)) {
            let mask = |&part: &usize| (self.mask(&[part]), palette::distinct(part));
            return Picture::SoftIds(closed.iter().map(mask).collect());
        }
        let time = self.settings.document_time;
        let parts: Vec<(usize, &Part)> = closed.iter().rev().map(|&part| (part, &self.scene.parts[part])).collect();
        let at = |t: f64| Stack::new(parts.iter().filter_map(|&(k, part)| Some((k, self.outline(part, time, t)?))));
        Picture::Ids(self.times().into_iter().map(at).collect())
    }

    fn lines(&self, order: &[usize]) -> Lines {
        let outline = |&part: &usize| {
            let part = &self.scene.parts[part];
            Some((self.outline(part, self.settings.document_time, self.settings.document_time)?, part.closed))
        };
        Lines::new(
            order.iter().filter_map(outline).collect(),
            self.placement.length(self.settings.line_width),
            self.settings.line_colour,
        )
    }

    /// The times while the shutter is open.
    fn times(&self) -> Vec<f64> {
        let settings = self.settings;
        let opens = settings.document_time + settings.phase * settings.shutter;
        shutter_from(opens, settings.shutter, settings.samples)
    }

    /// The outline of a part at a time. A part with an outline at the frame's time has one at all times: outside of its track
    /// it keeps that outline.
    fn outline(&self, part: &Part, frame: f64, time: f64) -> Option<Vec<Point>> {
        let at = |time| outline_at(part, time, self.settings.curves);
        let exists = time == frame || outline_at(part, frame, false).is_some();
        let points = if exists { at(time).or_else(|| at(frame)) } else { None }?;
        Some(points.into_iter().map(|p| self.placement.place(p)).collect())
    }

    /// The outlines of parts at the times while the shutter is open.
    fn instants(&self, parts: &[&Part]) -> Vec<Vec<Vec<Point>>> {
        let time = self.settings.document_time;
        let shown: Vec<&&Part> = parts.iter().filter(|part| outline_at(part, time, false).is_some()).collect();
        if shown.is_empty() {
            return Vec::new();
        }
        let at = |t| shown.iter().filter_map(|part| self.outline(part, time, t)).collect();
        self.times().into_iter().map(at).collect()
    }
}

/// A window as bounds.
fn around(window: Window) -> Bounds {
    Bounds {
        least: Point::new(window.left as f64, window.top as f64),
        most: Point::new(window.right as f64, window.bottom as f64),
    }
}

fn inverted(value: f32, invert: bool) -> f32 {
    if invert { 1.0 - value } else { value }
}

/// Calls `change` with each pixel and its value of a mask.
pub(super) fn each(pixels: &mut Raster<Pixel>, mask: &Raster<f32>, mut change: impl FnMut(&mut Pixel, f32)) {
    for (pixel, &m) in pixels.data_mut().iter_mut().zip(mask.data()) {
        change(pixel, m);
    }
}

fn add(pixel: &mut Pixel, [r, g, b]: [f32; 3], alpha: f32) {
    for (sum, value) in pixel.iter_mut().zip([r, g, b, 1.0]) {
        *sum += alpha * value;
    }
}

/// Composites a colour over a premultiplied pixel.
pub(super) fn over(pixel: &mut Pixel, colour: [f32; 3], alpha: f32) {
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
