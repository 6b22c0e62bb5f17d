//! Drawings made of closed shapes, in lines and in flat colours.
//!
//! What is in front covers what is behind, in lines and in colours alike. So the truth of a drawing can be read from its pictures, as
//! for other films ([`super::truth`]).

use crate::sample::HEIGHT;
use crate::sample::ink::Canvas;
use crate::sample::outline::Outline;
use anyhow::{Context, Result};
use rayon::prelude::{IndexedParallelIterator, IntoParallelRefIterator, ParallelIterator};
use rototoon::geometry::Point;
use std::path::Path;
use tiny_skia::{Color, Pixmap};

/// Lines of the films that the benchmark draws.
pub const LINES: u32 = HEIGHT;
/// The colour of what is white, 0xRRGGBB.
pub const WHITE: u32 = 0xffffff;

const INK: u32 = 0x1c1820;
/// Least width of a line in pixels at 540 lines.
const LINE: f64 = 2.4;

/// A drawing: its shapes, the farthest first, on paper of a colour.
#[derive(Clone, Debug)]
pub struct Picture {
    /// The shapes.
    pub shapes: Vec<Shape>,
    /// 0xRRGGBB.
    pub paper: u32,
    /// Width and height of the picture, in the unit of the shapes.
    pub size: [u32; 2],
}

/// A closed shape with one colour and a line around it.
#[derive(Clone, Debug)]
pub struct Shape {
    /// Its border.
    pub outline: Outline,
    /// 0xRRGGBB.
    pub colour: u32,
    /// Lines inside of it, which divide it without another colour.
    pub creases: Vec<Outline>,
    /// Gaps in its line: control point and length in pixels at 540 lines.
    pub gaps: Vec<(usize, f64)>,
}

impl Shape {
    /// A shape without creases and gaps.
    pub fn new(outline: Outline, colour: u32) -> Self {
        Self { outline, colour, creases: Vec::new(), gaps: Vec::new() }
    }
}

/// Writes drawings as `frames/frame_000.png` and so on, and the same names in `colour/`, into `folder`, and makes the folder if
/// needed. The pictures have `lines` rows.
///
/// # Errors
///
/// A folder or a file that cannot be written, and a size that no picture can have.
pub fn write(folder: &Path, lines: u32, drawings: &[Picture]) -> Result<()> {
    for name in ["frames", "colour"] {
        let made = folder.join(name);
        std::fs::create_dir_all(&made).with_context(|| format!("cannot make the folder {made:?}"))?;
    }
    drawings.par_iter().enumerate().try_for_each(|(k, drawing)| {
        for (name, coloured) in [("frames", false), ("colour", true)] {
            let path = folder.join(name).join(format!("frame_{k:03}.png"));
            let png = draw(drawing, lines, coloured)?.encode_png()?;
            std::fs::write(&path, png).with_context(|| format!("cannot write {path:?}"))?;
        }
        Ok(())
    })
}

/// Draws shapes in their colours, or white.
fn draw(drawing: &Picture, lines: u32, coloured: bool) -> Result<Pixmap> {
    let [width, height] = drawing.size;
    let scale = f64::from(lines) / f64::from(height);
    let width = lines * width / height;
    let mut pixels = Pixmap::new(width, lines).with_context(|| format!("no picture of {width}x{lines} pixels"))?;
    let tone = |colour: u32| rgb(if coloured { colour } else { WHITE });
    pixels.fill(tone(drawing.paper));
    let mut canvas = Canvas { pixels };
    for shape in &drawing.shapes {
        let outline = scaled(&shape.outline, scale);
        canvas.fill(&outline, tone(shape.colour));
        for crease in &shape.creases {
            canvas.line(&scaled(crease, scale), LINE * scale, rgb(INK), Some(&outline));
        }
        canvas.ink(&broken(outline, &shape.gaps, scale), rgb(INK));
    }
    Ok(canvas.pixels)
}

fn rgb(colour: u32) -> Color {
    let [_, r, g, b] = colour.to_be_bytes();
    Color::from_rgba8(r, g, b, 255)
}

/// An outline on a picture of another size, with a line all around.
fn scaled(outline: &Outline, scale: f64) -> Outline {
    let mut scaled = outline.clone();
    scaled.points.iter_mut().for_each(|point| *point = scale * *point);
    scaled.ink.iter_mut().for_each(|width| *width = scale * width.max(LINE));
    scaled
}

/// An outline whose line has gaps.
fn broken(outline: Outline, gaps: &[(usize, f64)], scale: f64) -> Outline {
    if gaps.is_empty() {
        return outline;
    }
    let dense = outline.dense();
    let open = |at: Point| gaps.iter().any(|&(k, length)| at.distance(outline.points[k]) < 0.5 * length * scale);
    let mut broken = Outline::closed(dense.iter().map(|sample| sample.at).collect());
    broken.ink = dense.iter().map(|sample| if open(sample.at) { 0.0 } else { sample.ink }).collect();
    broken.corners.fill(true);
    broken
}

/// A circle.
pub fn disc(at: Point, radius: f64) -> Outline {
    ellipse(at, Point::splat(radius))
}

/// An ellipse with half-axes `size`.
pub fn ellipse(at: Point, size: Point) -> Outline {
    let angle = |k: usize| std::f64::consts::TAU * k as f64 / 12.0;
    Outline::closed((0..12).map(|k| at + size * Point::from_angle(angle(k))).collect())
}
