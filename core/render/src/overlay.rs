//! Contours, control points, keys and confidence, drawn over a frame.
//!
//! Each part has a colour of its own. A lost contour is red and twice as wide, because a pale one is missed on white
//! paper, and a lost one must not be. The opacity of any other segment shows the confidence of its less certain end. A
//! control point goes from red (uncertain) over yellow to green (certain). The artist's keys are white squares, pins are
//! white rings.
//!
//! Lines are drawn antialiased on a transparent layer, which is composited over the frame in floats. Pixels without
//! lines keep their exact colour.

use rototoon_base::geometry::Point;
use rototoon_base::scene::{Colour, FrameNumber, Part, Raster, Scene, Verdict};
use tiny_skia::{Color, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, Stroke, Transform};

/// Picture height for which widths are given. Widths grow with the picture.
const REFERENCE_LINES: f64 = 540.0;
/// Opacity of a segment with confidence 0.
const FAINTEST: f32 = 0.3;
/// Colour of a lost contour.
const LOST: Colour = [1.0, 0.0, 0.1];
/// Width of a lost contour, times that of others.
const LOST_WIDTH: f32 = 2.0;
/// Width of the dark border on each side of a line, as a share of the line's width.
const BORDER: f32 = 0.5;

/// Options of an overlay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OverlayOptions {
    /// Width of lines, in pixels at 540 lines.
    pub line_width: f64,
    /// Whether control points are drawn.
    pub points: bool,
    /// Whether colour and opacity show confidence.
    pub confidence: bool,
}

impl Default for OverlayOptions {
    fn default() -> Self {
        Self { line_width: 2.0, points: true, confidence: true }
    }
}

/// The picture of a frame with the contours of all parts, farther parts first. `parts` selects parts by index; `None`
/// takes all. A picture too large for the layer is returned unchanged.
pub fn overlay(
    scene: &Scene,
    frame: FrameNumber,
    picture: &Raster<Colour>,
    parts: Option<&[usize]>,
    options: &OverlayOptions,
) -> Raster<Colour> {
    let Some(mut layer) = Pixmap::new(picture.width() as u32, picture.height() as u32) else { return picture.clone() };
    let mut order: Vec<usize> =
        (0..scene.parts.len()).filter(|i| parts.is_none_or(|parts| parts.contains(i))).collect();
    order.sort_by(|&a, &b| scene.parts[a].depth_at(frame).total_cmp(&scene.parts[b].depth_at(frame)));
    let width = (options.line_width * (picture.height() as f64 / REFERENCE_LINES).max(0.5)) as f32;
    for index in order {
        let part = &scene.parts[index];
        let Some(points) = part.points_at(frame) else { continue };
        let lost = options.confidence && Verdict::on(part, frame) == Some(Verdict::Lost);
        let (colour, width) = if lost { (LOST, LOST_WIDTH * width) } else { (part.shown_colour(index), width) };
        let pen = Pen { part, frame, points, colour, lost, width, options };
        pen.segments(&mut layer);
        if options.points {
            pen.points(&mut layer);
        }
    }
    composite(picture, &layer)
}

fn composite(picture: &Raster<Colour>, layer: &Pixmap) -> Raster<Colour> {
    let mut result = picture.clone();
    for (pixel, over) in result.data_mut().iter_mut().zip(layer.pixels()) {
        let rest = 1.0 - f32::from(over.alpha()) / 255.0;
        let over = [over.red(), over.green(), over.blue()];
        for (c, o) in pixel.iter_mut().zip(over) {
            *c = f32::from(o) / 255.0 + rest * *c;
        }
    }
    result
}

/// Draws one part on one frame.
struct Pen<'a> {
    part: &'a Part,
    frame: FrameNumber,
    points: &'a [Point],
    colour: Colour,
    lost: bool,
    width: f32,
    options: &'a OverlayOptions,
}

impl Pen<'_> {
    fn confidence(&self, index: usize) -> f32 {
        let known = self.part.confidence.get(&self.frame).and_then(|values| values.get(index));
        if self.options.confidence { known.map_or(1.0, |value| value.clamp(0.0, 1.0) as f32) } else { 1.0 }
    }

    fn segments(&self, layer: &mut Pixmap) {
        let n = self.points.len();
        let curves = self.part.complete_curves(self.frame);
        let count = if self.part.closed && n > 1 { n } else { n.saturating_sub(1) };
        let paths: Vec<_> = (0..count)
            .filter_map(|i| {
                let ends = [self.points[i], self.points[(i + 1) % n]];
                let line = curves.and_then(|paths| paths.get(i)).map_or(&ends[..], Vec::as_slice);
                let sure = self.confidence(i).min(self.confidence((i + 1) % n));
                Some((polyline(line)?, if self.lost { 1.0 } else { FAINTEST + (1.0 - FAINTEST) * sure }))
            })
            .collect();
        // Borders are drawn first, so none covers a neighbouring line.
        for (path, alpha) in &paths {
            stroke(layer, path, [0.0; 3], 0.5 * alpha, self.width * (1.0 + 2.0 * BORDER));
        }
        for (path, alpha) in &paths {
            stroke(layer, path, self.colour, *alpha, self.width);
        }
    }

    fn points(&self, layer: &mut Pixmap) {
        let (key, pins) = (self.part.keys.contains_key(&self.frame), self.part.pins.get(&self.frame));
        let size = self.width * 1.1;
        for (index, &p) in self.points.iter().enumerate() {
            let (x, y) = (p.x as f32, p.y as f32);
            if key {
                let square = tiny_skia::Rect::from_xywh(x - size, y - size, 2.0 * size, 2.0 * size);
                if let Some(path) = square.map(PathBuilder::from_rect) {
                    stroke(layer, &path, [0.0; 3], 0.8, self.width * 0.8);
                    fill(layer, &path, [1.0; 3]);
                }
                continue;
            }
            let Some(dot) = PathBuilder::from_circle(x, y, size) else { continue };
            let shown = self.options.confidence && self.part.confidence.contains_key(&self.frame);
            stroke(layer, &dot, [0.0; 3], 0.8, self.width * 0.6);
            fill(layer, &dot, if shown { sureness(self.confidence(index)) } else { self.colour });
            let ring =
                pins.is_some_and(|pins| pins.contains_key(&index)).then(|| PathBuilder::from_circle(x, y, 2.2 * size));
            if let Some(ring) = ring.flatten() {
                stroke(layer, &ring, [1.0; 3], 1.0, self.width * 0.7);
            }
        }
    }
}

/// Red for 0, yellow for ½, green for 1.
fn sureness(confidence: f32) -> Colour {
    [(2.0 - 2.0 * confidence).min(1.0), (2.0 * confidence).min(1.0), 0.1]
}

fn polyline(points: &[Point]) -> Option<Path> {
    let mut builder = PathBuilder::new();
    for (i, p) in points.iter().enumerate() {
        if i == 0 {
            builder.move_to(p.x as f32, p.y as f32);
        } else {
            builder.line_to(p.x as f32, p.y as f32);
        }
    }
    builder.finish()
}

fn paint(colour: Colour, alpha: f32) -> Paint<'static> {
    let mut paint = Paint::default();
    let [r, g, b] = colour.map(|c| c.clamp(0.0, 1.0));
    paint.set_color(Color::from_rgba(r, g, b, alpha.clamp(0.0, 1.0)).unwrap_or(Color::BLACK));
    paint
}

fn stroke(layer: &mut Pixmap, path: &Path, colour: Colour, alpha: f32, width: f32) {
    let stroke = Stroke { width, line_cap: LineCap::Round, line_join: LineJoin::Round, ..Stroke::default() };
    layer.stroke_path(path, &paint(colour, alpha), &stroke, Transform::identity(), None);
}

fn fill(layer: &mut Pixmap, path: &Path, colour: Colour) {
    layer.fill_path(path, &paint(colour, 1.0), tiny_skia::FillRule::Winding, Transform::identity(), None);
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon_base::scene::Footage;
    use std::collections::BTreeMap;

    fn scene() -> Scene {
        let square: Vec<_> = [(8.0, 8.0), (32.0, 8.0), (32.0, 32.0), (8.0, 32.0)].map(Point::from).to_vec();
        let part = Part {
            name: "a".into(),
            closed: true,
            keys: BTreeMap::from([(0, square.clone())]),
            tracks: [0, 1, 3].map(|frame| (frame, square.clone())).into(),
            confidence: BTreeMap::from([(0, vec![1.0; 4]), (1, vec![0.55; 4]), (3, vec![0.0; 4])]),
            ..Part::default()
        };
        let footage =
            Footage { pattern: "%d".into(), first: 0, last: 3, fps: 12.0, width: 40, height: 40, held: false };
        Scene { footage, parts: vec![part] }
    }

    fn changed(frame: FrameNumber, options: &OverlayOptions) -> Raster<Colour> {
        overlay(&scene(), frame, &Raster::new(40, 40, [0.3; 3]), None, options)
    }

    #[test]
    fn only_the_contour_is_drawn_on() {
        let picture = changed(0, &OverlayOptions::default());
        for (x, y, drawn) in [(20, 8, true), (8, 20, true), (20, 20, false), (1, 1, false)] {
            assert_eq!(picture.get(x, y) != [0.3; 3], drawn, "{x} {y}");
        }
        assert_eq!(changed(2, &OverlayOptions::default()).data(), Raster::new(40, 40, [0.3; 3]).data());
    }

    #[test]
    fn what_is_not_sure_is_fainter() {
        let difference = |options: &OverlayOptions| {
            let [r, g, b] = changed(1, options).get(20, 8);
            (r - 0.3).abs() + (g - 0.3).abs() + (b - 0.3).abs()
        };
        let bold = OverlayOptions { line_width: 6.0, ..OverlayOptions::default() };
        assert!(difference(&bold) < 0.8 * difference(&OverlayOptions { confidence: false, ..bold }));
    }

    #[test]
    fn lost_contours_cannot_be_missed() {
        let options = OverlayOptions { points: false, ..OverlayOptions::default() };
        let on_paper = |frame| overlay(&scene(), frame, &Raster::new(40, 40, [1.0; 3]), None, &options);
        let [r, g, b] = on_paper(3).get(20, 8);
        assert!(r > 0.9 && g < 0.2 && b < 0.3, "{r} {g} {b}");
        let dark = |frame| on_paper(frame).data().iter().filter(|colour| colour[1] < 0.8).count();
        assert!(dark(3) > dark(0), "it is wider than a sure one");
    }

    #[test]
    fn keys_look_different_from_tracked_points() {
        let options = OverlayOptions { line_width: 4.0, ..OverlayOptions::default() };
        assert_ne!(changed(0, &options).get(8, 8), changed(1, &options).get(8, 8));
        assert_eq!(changed(0, &options).get(8, 8), [1.0; 3]);
    }
}
