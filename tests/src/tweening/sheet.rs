//! A contact sheet of in-betweens: linear interpolation in red, Rototoon's in-betweens in blue, the truth in black.
//! Rototoon's strokes follow captured parts if [`Set::capture`] was called.

use super::Set;
use super::between::sequence;
use crate::sheet;
use anyhow::{Context, Result};
use image::RgbaImage;
use rototoon::geometry::{Point, polygon};
use rototoon::tween::between::Options;
use tiny_skia::{Color, LineJoin, Paint, PathBuilder, Pixmap, Stroke, Transform};

/// Most pictures on a sheet.
const PICTURES: usize = 12;
/// Size of a picture in pixels.
const SIZE: u32 = 440;
/// Space around the contours in pixels of the set.
const MARGIN: f64 = 12.0;

/// The sheet of a set's keys.
pub fn draw(set: &Set, frames: &[i32], options: &Options) -> Result<RgbaImage> {
    let (parts, ours) = sequence(set, frames, options)?;
    let ours = ours.following(set.captured.clone());
    let between: Vec<i32> = frames.windows(2).flat_map(|pair| pair[0] + 1..pair[1]).collect();
    let count = between.len().min(PICTURES);
    let all: Vec<Point> = parts.iter().flat_map(|&i| set.parts[i].points.values().flatten().copied()).collect();
    let (low, high) = polygon::bounds(&all).context("found no points")?;
    let scale = f64::from(SIZE) / (high - low + Point::splat(2.0 * MARGIN)).max_element();
    let place = move |p: Point| (p - low + Point::splat(MARGIN)) * scale;
    let cells = (0..count).map(|n| {
        let frame = between[n * between.len() / count];
        let k = frames.partition_point(|&key| key <= frame) - 1;
        let u = f64::from(frame - frames[k]) / f64::from(frames[k + 1] - frames[k]);
        let mut picture = Pixmap::new(SIZE, SIZE).context("no picture")?;
        picture.fill(Color::WHITE);
        for (drawn, &i) in ordered(ours.at(frame)).iter().zip(&parts) {
            let part = &set.parts[i];
            let (a, b) = (&part.points[&frames[k]], &part.points[&frames[k + 1]]);
            let linear: Vec<Point> = a.iter().zip(b).map(|(p, q)| place(p.lerp(*q, u))).collect();
            line(&mut picture, &linear, part.closed, [225, 90, 80], 1.0);
            if let Some(truth) = part.points.get(&frame) {
                line(&mut picture, &truth.iter().map(|&p| place(p)).collect::<Vec<_>>(), part.closed, [0, 0, 0], 1.0);
            }
            line(&mut picture, &drawn.iter().map(|&p| place(p)).collect::<Vec<_>>(), part.closed, [30, 80, 230], 1.8);
        }
        let pixels = picture.pixels().iter().flat_map(|p| [p.red(), p.green(), p.blue(), 255]).collect();
        let cell = RgbaImage::from_raw(SIZE, SIZE, pixels).context("no picture")?;
        sheet::captioned(&cell, &format!("frame {frame} · keys {}, {}", frames[k], frames[k + 1]))
    });
    sheet::arrange(&cells.collect::<Result<Vec<_>>>()?)
}

fn ordered(mut drawn: Vec<rototoon::tween::between::InBetween>) -> Vec<Vec<Point>> {
    drawn.sort_by_key(|d| d.track);
    drawn.into_iter().map(|d| d.stroke.points).collect()
}

fn line(picture: &mut Pixmap, points: &[Point], closed: bool, [r, g, b]: [u8; 3], width: f32) {
    let Some(first) = points.first() else { return };
    let mut path = PathBuilder::new();
    path.move_to(first.x as f32, first.y as f32);
    points[1..].iter().for_each(|p| path.line_to(p.x as f32, p.y as f32));
    if closed {
        path.close();
    }
    let Some(path) = path.finish() else { return };
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color_rgba8(r, g, b, 255);
    let stroke = Stroke { width, line_join: LineJoin::Round, ..Stroke::default() };
    picture.stroke_path(&path, &paint, &stroke, Transform::identity(), None);
}
