//! The painted background: sky, clouds, hills, trees and a path, in soft dabs of a dry brush.
//!
//! The layers are painted from far to near. Each layer is a flat shape with about a thousand thin, transparent dabs in
//! similar colours, clipped to the shape, and slightly blurred. Nearer layers are blurred less. So the background has
//! texture and soft edges everywhere, but no ink, as in cel animation.

use super::ink::polygon_path;
use rototoon::geometry::Point;
use tiny_skia::{Color, FillRule, Mask, Paint, PathBuilder, Pixmap, PixmapPaint, Transform};

/// A small deterministic generator of uniform numbers (SplitMix64, Steele, Lea & Flood 2014).
struct Dice(u64);

impl Dice {
    /// The next number, from `low` to `high`.
    fn roll(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        low + (high - low) * ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// The brush of a layer.
struct Brush {
    /// Base colour.
    colour: [f64; 3],
    /// Colours of the dabs.
    dabs: [[f64; 3]; 2],
    /// Number of dabs.
    count: usize,
    /// Half length and half width of a dab in pixels.
    size: [f64; 2],
    /// Direction of the dabs in degrees, and how much it varies.
    turn: [f64; 2],
    /// Radius of the blur in pixels.
    blur: usize,
}

const FAR_HILLS: Brush = Brush {
    colour: [0.66, 0.80, 0.82],
    dabs: [[0.72, 0.85, 0.84], [0.58, 0.74, 0.80]],
    count: 900,
    size: [34.0, 4.0],
    turn: [-8.0, 18.0],
    blur: 3,
};
const HILLS: Brush = Brush {
    colour: [0.63, 0.79, 0.59],
    dabs: [[0.73, 0.85, 0.60], [0.51, 0.71, 0.58]],
    count: 1500,
    size: [30.0, 4.0],
    turn: [14.0, 26.0],
    blur: 2,
};
const MEADOW: Brush = Brush {
    colour: [0.67, 0.80, 0.46],
    dabs: [[0.78, 0.87, 0.50], [0.53, 0.71, 0.42]],
    count: 1800,
    size: [22.0, 3.4],
    turn: [-16.0, 34.0],
    blur: 1,
};
const PATH: Brush = Brush {
    colour: [0.90, 0.80, 0.61],
    dabs: [[0.96, 0.88, 0.70], [0.80, 0.68, 0.50]],
    count: 1500,
    size: [46.0, 2.6],
    turn: [0.0, 5.0],
    blur: 1,
};
const VERGE: Brush = Brush {
    colour: [0.57, 0.73, 0.38],
    dabs: [[0.69, 0.82, 0.43], [0.43, 0.62, 0.35]],
    count: 1400,
    size: [15.0, 2.2],
    turn: [-72.0, 30.0],
    blur: 1,
};

/// Paints the background.
pub fn paint(width: u32, height: u32) -> Option<Pixmap> {
    let mut canvas = Pixmap::new(width, height)?;
    let mut dice = Dice(20);
    sky(&mut canvas, &mut dice)?;
    for (x, y, size) in [(150.0, 92.0, 1.0), (520.0, 58.0, 0.72), (815.0, 118.0, 1.15)] {
        cloud(&mut canvas, &mut dice, x, y, size)?;
    }
    ridge(&mut canvas, &mut dice, 272.0, &[(26.0, 118.0, 0.6), (9.0, 41.0, 1.0)], &FAR_HILLS)?;
    ridge(&mut canvas, &mut dice, 330.0, &[(30.0, 160.0, 2.6), (7.0, 52.0, 0.3)], &HILLS)?;
    for (x, y, size) in
        [(62.0, 352.0, 0.62), (128.0, 340.0, 0.5), (560.0, 330.0, 0.46), (604.0, 338.0, 0.6), (905.0, 350.0, 0.7)]
    {
        tree(&mut canvas, &mut dice, x, y, size, 2)?;
    }
    ridge(&mut canvas, &mut dice, 402.0, &[(13.0, 210.0, 0.9), (4.0, 60.0, 2.0)], &MEADOW)?;
    for (x, y, size) in [(786.0, 420.0, 1.35), (20.0, 424.0, 1.2)] {
        tree(&mut canvas, &mut dice, x, y, size, 1)?;
    }
    ridge(&mut canvas, &mut dice, 446.0, &[(3.0, 90.0, 0.0), (2.0, 33.0, 1.0)], &PATH)?;
    ridge(&mut canvas, &mut dice, 512.0, &[(4.0, 70.0, 0.0), (3.0, 19.0, 1.0)], &VERGE)?;
    flowers(&mut canvas, &mut dice);
    Some(canvas)
}

fn sky(canvas: &mut Pixmap, dice: &mut Dice) -> Option<()> {
    let (w, h) = (f64::from(canvas.width()), f64::from(canvas.height()));
    for i in 0..54 {
        let t = f64::from(i) / 54.0;
        let band = [Point::new(0.0, t * h), Point::new(w, t * h), Point::new(w, h), Point::new(0.0, h)];
        fill(canvas, &band, mix([0.60, 0.83, 0.92], [0.98, 0.95, 0.84], (t * 1.7).min(1.0)), 1.0, None);
    }
    for _ in 0..900 {
        let (x, y) = (dice.roll(0.0, w), dice.roll(0.0, 330.0));
        let tone = mix([0.56, 0.81, 0.92], [1.0, 0.97, 0.87], (y / 330.0 + dice.roll(-0.18, 0.22)).clamp(0.0, 1.0));
        dab(canvas, Point::new(x, y), [70.0, 6.0], dice.roll(-7.0, 7.0), tone, 0.14, None);
    }
    blur(canvas, 4);
    Some(())
}

fn cloud(canvas: &mut Pixmap, dice: &mut Dice, x: f64, y: f64, size: f64) -> Option<()> {
    let mut sheet = Pixmap::new(canvas.width(), canvas.height())?;
    for step in 0..3 {
        let tone = [[0.86, 0.91, 0.94], [0.95, 0.96, 0.95], [1.0, 0.99, 0.96]][step];
        for _ in 0..26 {
            let u = dice.roll(-1.0, 1.0);
            let rise = (1.0 - u * u) * dice.roll(0.0, 1.0);
            let at = Point::new(x + 88.0 * size * u, y - size * (34.0 * rise + 5.0 * step as f64));
            let r = size * (26.0 - 11.0 * u.abs()) * (1.0 - 0.17 * step as f64);
            dab(&mut sheet, at, [r, 0.8 * r], 0.0, tone, 0.5, None);
        }
    }
    blur(&mut sheet, 3);
    lay(canvas, &sheet);
    Some(())
}

fn tree(canvas: &mut Pixmap, dice: &mut Dice, x: f64, y: f64, size: f64, softness: usize) -> Option<()> {
    let mut sheet = Pixmap::new(canvas.width(), canvas.height())?;
    let at = |dx: f64, dy: f64| Point::new(x + size * dx, y + size * dy);
    let trunk = [at(-13.0, 12.0), at(-6.0, -40.0), at(-10.0, -110.0), at(8.0, -110.0), at(7.0, -40.0), at(16.0, 12.0)];
    fill(&mut sheet, &trunk, [0.55, 0.43, 0.36], 1.0, None);
    for _ in 0..30 {
        dab(
            &mut sheet,
            at(dice.roll(-6.0, 6.0), dice.roll(-100.0, 5.0)),
            [size * 15.0, size * 1.4],
            dice.roll(80.0, 98.0),
            [0.68, 0.55, 0.44],
            0.35,
            None,
        );
    }
    for step in 0..3 {
        let tone = [[0.38, 0.58, 0.45], [0.50, 0.69, 0.45], [0.66, 0.80, 0.47]][step];
        let s = step as f64;
        for _ in 0..90 {
            let (angle, reach) = (dice.roll(0.0, 360.0).to_radians(), dice.roll(0.0, 1.0).sqrt() * (1.0 - 0.16 * s));
            let place = at(68.0 * reach * angle.cos() - 8.0 * s, -142.0 + 56.0 * reach * angle.sin() - 11.0 * s);
            let r = size * dice.roll(9.0, 19.0);
            dab(
                &mut sheet,
                place,
                [r, 0.62 * r],
                dice.roll(-50.0, 10.0),
                mix(tone, [0.74, 0.83, 0.52], dice.roll(0.0, 0.25)),
                0.75 - 0.12 * s,
                None,
            );
        }
    }
    for _ in 0..80 {
        let tone = mix([0.50, 0.69, 0.42], [0.70, 0.82, 0.48], dice.roll(0.0, 1.0));
        let place = at(dice.roll(-26.0, 28.0), dice.roll(9.0, 17.0));
        dab(&mut sheet, place, [size * 10.0, size * 2.2], dice.roll(-105.0, -65.0), tone, 0.8, None);
    }
    blur(&mut sheet, softness);
    lay(canvas, &sheet);
    Some(())
}

fn flowers(canvas: &mut Pixmap, dice: &mut Dice) {
    let w = f64::from(canvas.width());
    for _ in 0..46 {
        let at = Point::new(dice.roll(0.0, w), dice.roll(517.0, 536.0));
        let tone = [[0.98, 0.95, 0.86], [0.96, 0.80, 0.47], [0.90, 0.62, 0.60]][dice.roll(0.0, 2.999) as usize];
        for _ in 0..4 {
            dab(
                canvas,
                at + Point::new(dice.roll(-2.5, 2.5), dice.roll(-2.0, 2.0)),
                [2.4, 1.7],
                dice.roll(0.0, 180.0),
                tone,
                0.85,
                None,
            );
        }
    }
}

/// Paints everything below a wavy line. `waves` has the amplitude of each wave in pixels, the pixels in which its phase grows
/// by 1 radian, and its phase at the left in radians.
fn ridge(canvas: &mut Pixmap, dice: &mut Dice, base: f64, waves: &[(f64, f64, f64)], brush: &Brush) -> Option<()> {
    let (w, h) = (f64::from(canvas.width()), f64::from(canvas.height()));
    let top = |x: f64| base + waves.iter().map(|&(a, period, phase)| a * (x / period + phase).sin()).sum::<f64>();
    let xs = (0..=60).map(|i| w * f64::from(i) / 60.0);
    let mut shape: Vec<Point> = xs.map(|x| Point::new(x, top(x))).collect();
    shape.extend([Point::new(w, h), Point::new(0.0, h)]);
    layer(canvas, dice, &shape, brush)
}

/// Paints a shape with its dabs, blurs it and draws it over the canvas.
fn layer(canvas: &mut Pixmap, dice: &mut Dice, shape: &[Point], brush: &Brush) -> Option<()> {
    let mut sheet = Pixmap::new(canvas.width(), canvas.height())?;
    let mut mask = Mask::new(canvas.width(), canvas.height())?;
    mask.fill_path(&polygon_path(shape)?, FillRule::Winding, true, Transform::identity());
    fill(&mut sheet, shape, brush.colour, 1.0, None);
    let top = shape.iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
    let (w, h) = (f64::from(canvas.width()), f64::from(canvas.height()));
    for i in 0..brush.count {
        let at = Point::new(dice.roll(0.0, w), dice.roll(top, h.min(top + 160.0)));
        let long = dice.roll(0.5, 1.2);
        let turn = brush.turn[0] + dice.roll(-brush.turn[1], brush.turn[1]);
        let tone = mix(brush.dabs[i % 2], brush.colour, dice.roll(0.0, 0.5));
        dab(&mut sheet, at, [brush.size[0] * long, brush.size[1]], turn, tone, 0.3, Some(&mask));
    }
    blur(&mut sheet, brush.blur);
    lay(canvas, &sheet);
    Some(())
}

fn mix(a: [f64; 3], b: [f64; 3], t: f64) -> [f64; 3] {
    std::array::from_fn(|i| a[i] + t * (b[i] - a[i]))
}

fn fill(canvas: &mut Pixmap, line: &[Point], colour: [f64; 3], alpha: f64, mask: Option<&Mask>) {
    let Some(path) = polygon_path(line) else { return };
    canvas.fill_path(&path, &flat(colour, alpha), FillRule::Winding, Transform::identity(), mask);
}

fn dab(
    canvas: &mut Pixmap,
    at: Point,
    size: [f64; 2],
    degrees: f64,
    colour: [f64; 3],
    alpha: f64,
    mask: Option<&Mask>,
) {
    let [a, b] = size.map(|s| s as f32);
    let path = tiny_skia::Rect::from_ltrb(-a, -b, a, b).and_then(|oval| {
        let mut builder = PathBuilder::new();
        builder.push_oval(oval);
        builder.finish()
    });
    let place = Transform::from_rotate(degrees as f32).post_translate(at.x as f32, at.y as f32);
    if let Some(path) = path {
        canvas.fill_path(&path, &flat(colour, alpha), FillRule::Winding, place, mask);
    }
}

fn flat(colour: [f64; 3], alpha: f64) -> Paint<'static> {
    let [r, g, b] = colour.map(|c| c.clamp(0.0, 1.0) as f32);
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color(Color::from_rgba(r, g, b, alpha as f32).unwrap_or(Color::BLACK));
    paint
}

fn lay(canvas: &mut Pixmap, sheet: &Pixmap) {
    canvas.draw_pixmap(0, 0, sheet.as_ref(), &PixmapPaint::default(), Transform::identity(), None);
}

/// Applies two box blurs of the given radius along each axis, on premultiplied bytes. Border pixels are repeated outside.
fn blur(sheet: &mut Pixmap, radius: usize) {
    let (w, h) = (sheet.width() as usize, sheet.height() as usize);
    for _ in 0..2 {
        for y in 0..h {
            blur_line(sheet.data_mut(), y * w * 4, 4, w, radius);
        }
        for x in 0..w {
            blur_line(sheet.data_mut(), x * 4, w * 4, h, radius);
        }
    }
}

fn blur_line(data: &mut [u8], start: usize, step: usize, count: usize, radius: usize) {
    let size = 2 * radius as u32 + 1;
    for channel in 0..4 {
        let line: Vec<u32> = (0..count).map(|i| u32::from(data[start + i * step + channel])).collect();
        let read = |i: isize| line[i.clamp(0, count as isize - 1) as usize];
        let mut sum: u32 = (-(radius as isize)..=radius as isize).map(read).sum();
        for i in 0..count {
            data[start + i * step + channel] = ((sum + size / 2) / size) as u8;
            let i = i as isize;
            sum = sum + read(i + radius as isize + 1) - read(i - radius as isize);
        }
    }
}
