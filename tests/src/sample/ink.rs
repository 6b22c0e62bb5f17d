//! Paints outlines: flat fill, a second tone on the shadow side, and ink of varying width.

use super::outline::Outline;
use rototoon::geometry::{Point, polygon};
use tiny_skia::{Color, FillRule, Mask, Paint, Path, PathBuilder, Pixmap, Transform};

/// A picture on which outlines are painted, with antialiasing.
#[derive(Clone, Debug)]
pub struct Canvas {
    /// The pixels.
    pub pixels: Pixmap,
}

impl Canvas {
    /// Fills the inside of a closed outline (nonzero rule).
    pub fn fill(&mut self, outline: &Outline, colour: Color) {
        self.paint(polygon_path(&outline.line()), colour, None);
    }

    /// Paints two tones. `lit` fills the part of the shape that a copy moved towards the light (upper left) covers, `shade`
    /// the rest.
    pub fn shade(&mut self, outline: &Outline, lit: Color, shade: Color) {
        let line = outline.line();
        let Some((low, high)) = polygon::bounds(&line) else { return };
        let shift = (0.11 * (high - low).min_element()).clamp(3.0, 9.0) * Point::new(0.6, 0.8);
        let mask = self.mask(outline);
        self.paint(polygon_path(&line), shade, mask.as_ref());
        self.paint(polygon_path(&line.iter().map(|p| *p - shift).collect::<Vec<_>>()), lit, mask.as_ref());
    }

    /// Paints the outline's ink.
    pub fn ink(&mut self, outline: &Outline, colour: Color) {
        let samples: Vec<_> = outline.dense().iter().map(|s| (s.at, s.ink)).collect();
        self.paint(brush_path(&samples, outline.closed), colour, None);
    }

    /// Paints a line of even width, which is thinner at open ends. It is clipped to the inside of `clip`.
    pub fn line(&mut self, outline: &Outline, width: f64, colour: Color, clip: Option<&Outline>) {
        let line = outline.line();
        let n = line.len() as f64 - 1.0;
        let taper =
            |i: usize| if outline.closed { 1.0 } else { (0.55 + 4.0 * (i as f64 / n) * (1.0 - i as f64 / n)).min(1.0) };
        let samples: Vec<_> = line.iter().enumerate().map(|(i, &p)| (p, width * taper(i))).collect();
        let mask = clip.and_then(|c| self.mask(c));
        self.paint(brush_path(&samples, outline.closed), colour, mask.as_ref());
    }

    /// Paints a filled circle, clipped to the inside of `clip`.
    pub fn disc(&mut self, at: Point, radius: f64, colour: Color, clip: Option<&Outline>) {
        self.ellipse(at, Point::splat(radius), colour, clip);
    }

    /// Paints a filled ellipse with half-axes `size`, clipped to the inside of `clip`.
    pub fn ellipse(&mut self, at: Point, size: Point, colour: Color, clip: Option<&Outline>) {
        let line: Vec<Point> =
            (0..48).map(|i| at + size * Point::from_angle(f64::from(i) * std::f64::consts::TAU / 48.0)).collect();
        let mask = clip.and_then(|c| self.mask(c));
        self.paint(polygon_path(&line), colour, mask.as_ref());
    }

    fn mask(&self, outline: &Outline) -> Option<Mask> {
        let mut mask = Mask::new(self.pixels.width(), self.pixels.height())?;
        mask.fill_path(&polygon_path(&outline.line())?, FillRule::Winding, true, Transform::identity());
        Some(mask)
    }

    fn paint(&mut self, path: Option<Path>, colour: Color, mask: Option<&Mask>) {
        let Some(path) = path else { return };
        let mut paint = Paint { anti_alias: true, ..Paint::default() };
        paint.set_color(colour);
        self.pixels.fill_path(&path, &paint, FillRule::Winding, Transform::identity(), mask);
    }
}

/// A closed path through the points.
pub fn polygon_path(line: &[Point]) -> Option<Path> {
    let mut builder = PathBuilder::new();
    add_polygon(&mut builder, line);
    builder.finish()
}

fn add_polygon(builder: &mut PathBuilder, line: &[Point]) {
    for (i, p) in line.iter().enumerate() {
        let (x, y) = (p.x as f32, p.y as f32);
        if i == 0 { builder.move_to(x, y) } else { builder.line_to(x, y) }
    }
    builder.close();
}

/// The union of discs along a line, as one path for nonzero filling. All pieces have the same orientation.
fn brush_path(samples: &[(Point, f64)], closed: bool) -> Option<Path> {
    let mut builder = PathBuilder::new();
    let n = samples.len();
    for (i, &(a, wa)) in samples.iter().enumerate() {
        if wa > 0.05 {
            let disc: Vec<Point> = (0..12)
                .map(|k| a + wa / 2.0 * Point::from_angle(f64::from(k) * std::f64::consts::TAU / 12.0))
                .collect();
            add_polygon(&mut builder, &disc);
        }
        if i + 1 == n && !closed {
            break;
        }
        let (b, wb) = samples[(i + 1) % n];
        let across = (b - a).normalize_or_zero().perp();
        let quad = [a - wa / 2.0 * across, b - wb / 2.0 * across, b + wb / 2.0 * across, a + wa / 2.0 * across];
        if polygon::signed_area(&quad) > 0.0 {
            add_polygon(&mut builder, &quad);
        }
    }
    builder.finish()
}
