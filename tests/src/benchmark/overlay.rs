//! Tracked and true contours over the footage, as a contact sheet.
//!
//! The frames between keys, evenly chosen, the worst one always among them. The footage is paled. The true contour is a
//! thin dark line; the tracked control points are joined by straight lines in the part's colour; a bad point is a red
//! ring with a line to its true place. Parts that are keyed on the frame are not drawn.

use super::run::{FrameErrors, Run};
use crate::measure::Row;
use crate::sheet;
use anyhow::{Context, Result};
use image::{Rgba, RgbaImage};
use rototoon::geometry::Point;
use rototoon::scene::{Colour, FrameNumber, Raster, palette};
use std::collections::BTreeMap;
use tiny_skia::{Color, IntSize, LineJoin, Paint, PathBuilder, Pixmap, Stroke, Transform};

/// Most pictures on a sheet.
const PICTURES: usize = 12;
/// How much of the footage's contrast is left.
const CONTRAST: f32 = 0.55;
/// Widths of lines in pixels of the sheet.
const TRUE_WIDTH: f32 = 1.0;
const TRACKED_WIDTH: f32 = 1.8;
/// Radii of good and bad points in pixels of the sheet.
const GOOD_RADIUS: f32 = 1.8;
const BAD_RADIUS: f32 = 4.5;

/// The sheet of a run; an error where it has no frame to show.
pub fn sheet(run: &Run) -> Result<RgbaImage> {
    let worst = worst(&run.outcome.frames).context("no frame between keys")?;
    let cells = chosen(&run.outcome.frames, worst).into_iter().map(|errors| {
        let mark = if errors.frame == worst { " · worst" } else { "" };
        let caption = format!("frame {} · good {:.0} %{mark}", errors.frame, 100.0 * errors.good);
        sheet::captioned(&cell(run, errors.frame)?, &caption)
    });
    sheet::arrange(&cells.collect::<Result<Vec<_>>>()?)
}

/// The frame with the smallest share of good points; of equal ones that with the largest errors.
fn worst(frames: &[FrameErrors]) -> Option<FrameNumber> {
    let order = |a: &&FrameErrors, b: &&FrameErrors| a.good.total_cmp(&b.good).then(b.p90.total_cmp(&a.p90));
    frames.iter().min_by(order).map(|errors| errors.frame)
}

/// Up to [`PICTURES`] frames in even steps; the nearest one makes room for the worst.
fn chosen(frames: &[FrameErrors], worst: FrameNumber) -> Vec<FrameErrors> {
    let count = frames.len().min(PICTURES);
    let steps = count.saturating_sub(1).max(1);
    let mut chosen: Vec<FrameErrors> =
        (0..count).map(|i| frames[(i * (frames.len() - 1) + steps / 2) / steps]).collect();
    let nearest = chosen.iter_mut().min_by_key(|errors| errors.frame.abs_diff(worst));
    if let (Some(place), Some(own)) = (nearest, frames.iter().find(|errors| errors.frame == worst)) {
        *place = *own;
    }
    chosen
}

fn cell(run: &Run, frame: FrameNumber) -> Result<RgbaImage> {
    let footage = run.frames.picture(frame)?;
    let small = sheet::shrunk(&paled(&footage));
    let scale = f64::from(small.width()) / footage.width() as f64;
    let size = IntSize::from_wh(small.width(), small.height()).context("an empty picture")?;
    let mut picture = Pixmap::from_vec(small.into_raw(), size).context("a picture of another size")?;
    let rows: BTreeMap<(usize, usize), &Row> =
        run.rows.iter().filter(|row| row.frame == frame).map(|row| ((row.part, row.index), row)).collect();
    let mut order: Vec<usize> = (0..run.tracked.parts.len()).collect();
    order.sort_by(|&a, &b| run.tracked.parts[a].depth.total_cmp(&run.tracked.parts[b].depth));
    let height = run.tracked.footage.height as f64;
    let drawn = |k: &&usize| rows.contains_key(&(**k, 0));
    for &k in order.iter().filter(drawn) {
        let (part, truth) = (&run.tracked.parts[k], &run.truth.parts[k]);
        let [r, g, b] = palette::distinct(k);
        let colour = Color::from_rgba(r, g, b, 1.0).unwrap_or(Color::BLACK);
        let points = &part.tracks[&frame];
        let mut pen = Pen { picture: &mut picture, scale };
        pen.line(points, part.closed, Color::from_rgba8(255, 255, 255, 190), TRACKED_WIDTH + 1.4);
        pen.line(points, part.closed, colour, TRACKED_WIDTH);
        pen.line(&truth.contour[&frame], part.closed, Color::from_rgba8(0, 0, 0, 220), TRUE_WIDTH);
        for (index, &point) in points.iter().enumerate() {
            let bad = rows.get(&(k, index)).is_some_and(|row| row.bad(height));
            if bad {
                let red = Color::from_rgba8(225, 0, 30, 255);
                pen.line(&[point, truth.points[&frame][index]], false, red, 1.2);
                pen.ring(point, BAD_RADIUS, red);
            }
            pen.dot(point, GOOD_RADIUS, colour);
        }
    }
    RgbaImage::from_raw(picture.width(), picture.height(), picture.take()).context("a picture of another size")
}

fn paled(footage: &Raster<Colour>) -> RgbaImage {
    RgbaImage::from_fn(footage.width() as u32, footage.height() as u32, |x, y| {
        let [r, g, b] = footage
            .get(x as usize, y as usize)
            .map(|c| (255.0 * (1.0 - CONTRAST * (1.0 - c.clamp(0.0, 1.0)))).round() as u8);
        Rgba([r, g, b, 255])
    })
}

/// Draws in pixels of the footage.
struct Pen<'a> {
    picture: &'a mut Pixmap,
    scale: f64,
}

impl Pen<'_> {
    fn place(&self, p: Point) -> (f32, f32) {
        ((p.x * self.scale) as f32, (p.y * self.scale) as f32)
    }

    fn line(&mut self, points: &[Point], closed: bool, colour: Color, width: f32) {
        let mut builder = PathBuilder::new();
        for (i, &p) in points.iter().enumerate() {
            let (x, y) = self.place(p);
            if i == 0 { builder.move_to(x, y) } else { builder.line_to(x, y) }
        }
        if closed {
            builder.close();
        }
        let Some(path) = builder.finish() else { return };
        let stroke = Stroke { width, line_join: LineJoin::Round, ..Stroke::default() };
        self.picture.stroke_path(&path, &paint(colour), &stroke, Transform::identity(), None);
    }

    fn ring(&mut self, at: Point, radius: f32, colour: Color) {
        let (x, y) = self.place(at);
        let Some(path) = PathBuilder::from_circle(x, y, radius) else { return };
        let stroke = Stroke { width: 1.8, ..Stroke::default() };
        self.picture.stroke_path(&path, &paint(colour), &stroke, Transform::identity(), None);
    }

    fn dot(&mut self, at: Point, radius: f32, colour: Color) {
        let (x, y) = self.place(at);
        let Some(path) = PathBuilder::from_circle(x, y, radius) else { return };
        self.picture.fill_path(&path, &paint(colour), tiny_skia::FillRule::Winding, Transform::identity(), None);
    }
}

fn paint(colour: Color) -> Paint<'static> {
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color(colour);
    paint
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frames(count: i32, bad: i32) -> Vec<FrameErrors> {
        let good = |frame: i32| if frame == bad { 0.25 } else { 1.0 };
        (1..=count).map(|frame| FrameErrors { frame, points: 4, median: 0.0, p90: 1.0, good: good(frame) }).collect()
    }

    fn numbers(count: i32, bad: i32) -> Vec<i32> {
        let frames = frames(count, bad);
        chosen(&frames, worst(&frames).unwrap()).iter().map(|errors| errors.frame).collect()
    }

    #[test]
    fn few_frames_are_all_shown() {
        assert_eq!(numbers(1, 1), [1]);
        assert_eq!(numbers(4, 2), [1, 2, 3, 4]);
        assert_eq!(numbers(12, 7), (1..=12).collect::<Vec<_>>());
    }

    #[test]
    fn of_many_the_worst_is_among_those_shown() {
        assert_eq!(numbers(23, 1), [1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23]);
        assert_eq!(numbers(23, 8), [1, 3, 5, 8, 9, 11, 13, 15, 17, 19, 21, 23]);
        for bad in 1..=40 {
            let shown = numbers(40, bad);
            assert!(shown.len() == 12 && shown.contains(&bad) && shown.windows(2).all(|w| w[0] < w[1]), "{shown:?}");
        }
    }

    #[test]
    fn of_equally_bad_frames_the_larger_errors_are_worst() {
        let mut frames = frames(5, 9);
        frames[3].p90 = 7.0;
        assert_eq!(worst(&frames), Some(4));
        assert_eq!(worst(&[]), None);
    }
}
