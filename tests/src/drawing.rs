//! A drawing as a list of marks, which is written as SVG or painted as PNG.
//!
//! A plotting crate would paint text with a font file or with the system's fonts, and have a dozen dependencies. This
//! repository has no font. The two writers below need only lines, dots and [`crate::lettering`].

use crate::lettering;
use anyhow::{Context, Result};
use std::fmt::Write;
use tiny_skia::{Color, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, Rect, Stroke, StrokeDash, Transform};

/// Red, green, blue, 0 to 255.
pub type Ink = [u8; 3];

/// Pixels of the PNG for one unit of the drawing.
const SCALE: f32 = 2.0;

/// The position of a text relative to its point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// The text begins at the point.
    Start,
    /// The middle of the text is at the point.
    Middle,
    /// The text ends at the point.
    End,
}

/// A mark of a drawing. Positions are in units from the top left corner.
#[derive(Clone, Debug, PartialEq)]
pub enum Mark {
    /// A polyline.
    Line {
        /// Its vertices.
        points: Vec<[f32; 2]>,
        /// Colour.
        ink: Ink,
        /// Width.
        width: f32,
        /// Lengths of dashes and gaps; `None` for a solid line.
        dash: Option<[f32; 2]>,
    },
    /// A filled circle.
    Dot {
        /// Centre.
        at: [f32; 2],
        /// Radius.
        radius: f32,
        /// Colour.
        ink: Ink,
    },
    /// A text on one line.
    Text {
        /// A point of the baseline.
        at: [f32; 2],
        /// Height of capitals.
        size: f32,
        /// Colour.
        ink: Ink,
        /// Which point of the text is at `at`.
        anchor: Anchor,
        /// Whether the text runs upwards.
        turned: bool,
        /// The text.
        text: String,
    },
}

/// Marks on a white ground.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawing {
    /// Width and height.
    pub size: [f32; 2],
    /// The marks. Later ones cover earlier ones.
    pub marks: Vec<Mark>,
}

impl Drawing {
    /// The drawing as SVG. Texts stay texts.
    pub fn svg(&self) -> String {
        let [w, h] = self.size;
        let mut out = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {w} {h}\" width=\"{w}\" height=\"{h}\" \
             font-family=\"sans-serif\">\n<rect width=\"{w}\" height=\"{h}\" fill=\"#fff\"/>\n"
        );
        for mark in &self.marks {
            // Writing to a string does not fail.
            let _ = write_mark(&mut out, mark);
        }
        out + "</svg>\n"
    }

    /// The drawing as PNG, with two pixels per unit.
    pub fn png(&self) -> Result<Vec<u8>> {
        let [w, h] = self.size.map(|s| (s * SCALE).ceil() as u32);
        let mut picture = Pixmap::new(w, h).with_context(|| format!("no picture of {w}x{h} pixels"))?;
        picture.fill(Color::WHITE);
        self.marks.iter().for_each(|mark| paint_mark(&mut picture, mark));
        Ok(picture.encode_png()?)
    }
}

fn hex([r, g, b]: Ink) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

fn write_mark(out: &mut String, mark: &Mark) -> std::fmt::Result {
    match mark {
        Mark::Line { points, ink, width, dash } => {
            let places: Vec<String> = points.iter().map(|[x, y]| format!("{x:.2},{y:.2}")).collect();
            let dash = dash.map_or(String::new(), |[on, off]| format!(" stroke-dasharray=\"{on} {off}\""));
            writeln!(
                out,
                "<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{width}\" stroke-linejoin=\"round\"{dash}/>",
                places.join(" "),
                hex(*ink)
            )
        }
        Mark::Dot { at: [x, y], radius, ink } => {
            writeln!(out, "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{radius}\" fill=\"{}\"/>", hex(*ink))
        }
        Mark::Text { at: [x, y], size, ink, anchor, turned, text } => {
            let anchor = match anchor {
                Anchor::Start => "start",
                Anchor::Middle => "middle",
                Anchor::End => "end",
            };
            let turn = if *turned { format!(" transform=\"rotate(-90 {x:.2} {y:.2})\"") } else { String::new() };
            // The height of capitals is about 0.72 of the font size in common sans-serif fonts.
            let size = size / 0.72;
            let text = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
            writeln!(
                out,
                "<text x=\"{x:.2}\" y=\"{y:.2}\" font-size=\"{size:.1}\" text-anchor=\"{anchor}\" fill=\"{}\"{turn}>{text}</text>",
                hex(*ink)
            )
        }
    }
}

fn polyline(points: &[[f32; 2]]) -> Option<Path> {
    let mut builder = PathBuilder::new();
    for (i, [x, y]) in points.iter().enumerate() {
        if i == 0 { builder.move_to(*x, *y) } else { builder.line_to(*x, *y) }
    }
    builder.finish()
}

fn paint_mark(picture: &mut Pixmap, mark: &Mark) {
    let scale = Transform::from_scale(SCALE, SCALE);
    let colour = |[r, g, b]: Ink| Color::from_rgba8(r, g, b, 255);
    let paint = |ink: Ink| {
        let mut paint = Paint { anti_alias: true, ..Paint::default() };
        paint.set_color(colour(ink));
        paint
    };
    match mark {
        Mark::Line { points, ink, width, dash } => {
            let Some(path) = polyline(points) else { return };
            let dash = dash.and_then(|lengths| StrokeDash::new(lengths.to_vec(), 0.0));
            let stroke = Stroke {
                width: *width,
                line_cap: LineCap::Butt,
                line_join: LineJoin::Round,
                dash,
                ..Stroke::default()
            };
            picture.stroke_path(&path, &paint(*ink), &stroke, scale, None);
        }
        Mark::Dot { at: [x, y], radius, ink } => {
            let Some(rect) = Rect::from_xywh(x - radius, y - radius, 2.0 * radius, 2.0 * radius) else { return };
            let Some(path) = PathBuilder::from_oval(rect) else { return };
            picture.fill_path(&path, &paint(*ink), tiny_skia::FillRule::Winding, scale, None);
        }
        Mark::Text { at: [x, y], size, ink, anchor, turned, text } => {
            let back = lettering::width(text, *size)
                * match anchor {
                    Anchor::Start => 0.0,
                    Anchor::Middle => 0.5,
                    Anchor::End => 1.0,
                };
            let at = if *turned { [*x, y + back] } else { [x - back, *y] };
            lettering::draw(picture, text, at.map(|v| v * SCALE), size * SCALE, colour(*ink), *turned);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawing() -> Drawing {
        let line = Mark::Line { points: vec![[0.0, 5.0], [20.0, 5.0]], ink: [255, 0, 0], width: 2.0, dash: None };
        let dot = Mark::Dot { at: [10.0, 12.0], radius: 2.0, ink: [0, 0, 255] };
        let text = Mark::Text {
            at: [10.0, 19.0],
            size: 3.0,
            ink: [0, 0, 0],
            anchor: Anchor::Middle,
            turned: false,
            text: "a < b".into(),
        };
        Drawing { size: [20.0, 20.0], marks: vec![line, dot, text] }
    }

    #[test]
    fn svg_has_every_mark() {
        let svg = drawing().svg();
        assert!(
            svg.contains(r##"<polyline points="0.00,5.00 20.00,5.00" fill="none" stroke="#ff0000" stroke-width="2""##)
        );
        assert!(svg.contains(r##"<circle cx="10.00" cy="12.00" r="2" fill="#0000ff"/>"##));
        assert!(svg.contains(">a &lt; b</text>") && svg.contains("text-anchor=\"middle\""));
    }

    #[test]
    fn png_has_twice_the_size() {
        let picture = Pixmap::decode_png(&drawing().png().unwrap()).unwrap();
        assert_eq!((picture.width(), picture.height()), (40, 40));
        let at = |x: u32, y: u32| {
            let c = picture.pixel(x, y).unwrap();
            [c.red(), c.green(), c.blue()]
        };
        assert_eq!((at(20, 10), at(20, 24), at(2, 2)), ([255, 0, 0], [0, 0, 255], [255; 3]));
    }
}
