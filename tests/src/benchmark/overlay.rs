//! A contact sheet of tracked and true contours over the footage.
//!
//! It shows evenly chosen frames between keys, always with the worst one, cropped to the contours. The footage is pale. The
//! true contour is a thin dark line. The tracked control points are joined by straight lines in the part's colour. A bad
//! point is a red dot with a line to its true position. Parts with a key on the frame are not drawn.

use super::run::{FrameErrors, Run};
use crate::measure::Row;
use crate::sheet;
use anyhow::{Context, Result};
use image::{Rgba, RgbaImage};
use rototoon::geometry::{Point, polygon};
use rototoon::scene::{Colour, FrameNumber, Raster, palette};
use std::collections::BTreeMap;
use tiny_skia::{Color, IntSize, LineJoin, Paint, PathBuilder, Pixmap, Stroke, Transform};

/// Most pictures on a sheet.
const PICTURES: usize = 12;
/// Share of the footage's contrast that is left.
const CONTRAST: f32 = 0.55;
/// Space around the contours, as a share of the footage's height.
const MARGIN: f64 = 0.04;
/// Largest ratio of a picture's height to its width.
const TALLEST: f64 = 1.25;
/// Widths of lines in pixels of the sheet.
const TRUE_WIDTH: f32 = 1.0;
const TRACKED_WIDTH: f32 = 1.8;
/// Radii of good and bad points in pixels of the sheet.
const GOOD_RADIUS: f32 = 1.8;
const BAD_RADIUS: f32 = 3.4;

/// The sheet of a run. It is an error if the run has no frame to show.
pub fn sheet(run: &Run) -> Result<RgbaImage> {
    let worst = worst(&run.outcome.frames).context("found no frame between keys")?;
    let shown = chosen(&run.outcome.frames, worst);
    let cut = cut(run, &shown);
    let cells = shown.into_iter().map(|errors| {
        let mark = if errors.frame == worst { " · worst" } else { "" };
        let caption = format!("frame {} · good {:.0} %{mark}", errors.frame, 100.0 * errors.good);
        sheet::captioned(&cell(run, errors.frame, cut)?, &caption)
    });
    sheet::arrange(&cells.collect::<Result<Vec<_>>>()?)
}

/// The frame with the smallest share of good points. Of equal ones it is that with the largest errors.
fn worst(frames: &[FrameErrors]) -> Option<FrameNumber> {
    let order = |a: &&FrameErrors, b: &&FrameErrors| a.good.total_cmp(&b.good).then(b.p90.total_cmp(&a.p90));
    frames.iter().min_by(order).map(|errors| errors.frame)
}

/// Up to [`PICTURES`] frames in even steps. The worst frame replaces the one nearest to it.
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

/// A rectangle of whole pixels of the footage: left, top, width, height.
type Cut = [u32; 4];

/// The rectangle of the tracked and true contours of the frames, with a margin, inside the picture and not too narrow.
fn cut(run: &Run, shown: &[FrameErrors]) -> Cut {
    let parts = run.tracked.parts.iter().zip(&run.truth.parts);
    let contours = parts.flat_map(|(part, truth)| {
        let of = |errors: &FrameErrors| [part.tracks.get(&errors.frame), truth.contour.get(&errors.frame)];
        shown.iter().flat_map(of).flatten().flatten().copied()
    });
    let size = (run.tracked.footage.width as f64, run.tracked.footage.height as f64).into();
    around(&contours.collect::<Vec<_>>(), size)
}

fn around(points: &[Point], size: Point) -> Cut {
    let (low, high) = polygon::bounds(points).unwrap_or((Point::ZERO, size));
    let margin = Point::splat(MARGIN * size.y);
    let (low, high) = ((low - margin).clamp(Point::ZERO, size), (high + margin).clamp(Point::ZERO, size));
    let width = (high.x - low.x).max((high.y - low.y) / TALLEST).min(size.x);
    let left = ((low.x + high.x - width) / 2.0).clamp(0.0, size.x - width);
    let start = |v: f64, most: f64| v.floor().clamp(0.0, most - 1.0) as u32;
    let (left, top) = (start(left, size.x), start(low.y, size.y));
    let end = |v: f64, from: u32, most: f64| (v.ceil().min(most) as u32).saturating_sub(from).max(1);
    [left, top, end(f64::from(left) + width, left, size.x), end(high.y, top, size.y)]
}

fn cell(run: &Run, frame: FrameNumber, [left, top, width, height]: Cut) -> Result<RgbaImage> {
    let footage = paled(&*run.frames.picture(frame)?);
    let small = sheet::shrunk(&image::imageops::crop_imm(&footage, left, top, width, height).to_image());
    let view = View {
        origin: Point::new(f64::from(left), f64::from(top)),
        scale: f64::from(small.width()) / f64::from(width),
    };
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
        let mut pen = Pen { picture: &mut picture, view };
        pen.line(points, part.closed, Color::from_rgba8(255, 255, 255, 190), TRACKED_WIDTH + 1.4);
        pen.line(points, part.closed, colour, TRACKED_WIDTH);
        pen.line(&truth.contour[&frame], part.closed, Color::from_rgba8(0, 0, 0, 220), TRUE_WIDTH);
        for (index, &point) in points.iter().enumerate() {
            if rows.get(&(k, index)).is_some_and(|row| row.bad(height)) {
                let red = Color::from_rgba8(215, 0, 40, 255);
                pen.line(&[point, truth.points[&frame][index]], false, red, 1.2);
                // The white rim distinguishes the dot from red contours.
                pen.dot(point, BAD_RADIUS + 1.4, Color::WHITE);
                pen.dot(point, BAD_RADIUS, red);
            } else {
                pen.dot(point, GOOD_RADIUS, colour);
            }
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

/// The part of the footage that a cell shows.
#[derive(Clone, Copy)]
struct View {
    origin: Point,
    scale: f64,
}

/// Draws on a picture, with positions in pixels of the footage.
struct Pen<'a> {
    picture: &'a mut Pixmap,
    view: View,
}

impl Pen<'_> {
    fn place(&self, p: Point) -> (f32, f32) {
        let p = (p - self.view.origin) * self.view.scale;
        (p.x as f32, p.y as f32)
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
    fn the_worst_of_many_frames_is_shown() {
        assert_eq!(numbers(23, 1), [1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23]);
        assert_eq!(numbers(23, 8), [1, 3, 5, 8, 9, 11, 13, 15, 17, 19, 21, 23]);
        for bad in 1..=40 {
            let shown = numbers(40, bad);
            assert!(shown.len() == 12 && shown.contains(&bad) && shown.windows(2).all(|w| w[0] < w[1]), "{shown:?}");
        }
    }

    #[test]
    fn the_crop_contains_the_contours_and_is_in_the_picture() {
        let size = Point::new(1000.0, 500.0);
        let of = |low: (f64, f64), high: (f64, f64)| around(&[low.into(), high.into()], size);
        assert_eq!(of((300.0, 200.0), (500.0, 300.0)), [280, 180, 240, 140]);
        assert_eq!(of((-50.0, 100.0), (2000.0, 900.0)), [0, 80, 1000, 420], "beyond the picture");
        assert_eq!(of((10.0, 20.0), (30.0, 480.0)), [0, 0, 400, 500], "as wide as its height needs");
        assert_eq!(around(&[], size), [0, 0, 1000, 500]);
        assert_eq!(of((3000.0, 3000.0), (3001.0, 3001.0)), [999, 499, 1, 1], "nothing is seen");
    }

    #[test]
    fn of_equally_bad_frames_that_with_larger_errors_is_worst() {
        let mut frames = frames(5, 9);
        frames[3].p90 = 7.0;
        assert_eq!(worst(&frames), Some(4));
        assert_eq!(worst(&[]), None);
    }
}
