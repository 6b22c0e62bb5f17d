//! Drawings made of known lines.

#![allow(dead_code)] // The benchmark uses a part of it.

use rototoon_base::geometry::{Point, polyline};
use rototoon_base::scene::{Colour, Raster};
use std::sync::Arc;

/// A line to draw.
#[derive(Clone)]
pub struct Line {
    pub points: Vec<Point>,
    pub closed: bool,
    pub width: f64,
    pub colour: Colour,
}

/// A black line, 3 px wide.
pub fn line(points: &[(f64, f64)]) -> Line {
    Line { points: points.iter().map(|&p| p.into()).collect(), closed: false, width: 3.0, colour: [0.1; 3] }
}

/// A ring around `centre`.
pub fn ring(centre: Point, radius: f64) -> Line {
    let at = |k: u32| centre + radius * Point::from_angle(f64::from(k) * std::f64::consts::TAU / 90.0);
    Line { points: (0..90).map(at).collect(), closed: true, width: 3.0, colour: [0.1; 3] }
}

/// The lines on paper, drawn one over the other with soft edges.
pub fn draw(
    width: usize,
    height: usize,
    lines: &[Line],
    paper: impl Fn(usize, usize) -> Colour,
) -> Arc<Raster<Colour>> {
    let mut picture = Raster::from_fn(width, height, paper);
    for line in lines {
        draw_onto(&mut picture, line);
    }
    Arc::new(picture)
}

/// Draws a line over a picture.
pub fn draw_onto(picture: &mut Raster<Colour>, line: &Line) {
    let (width, height) = (picture.width(), picture.height());
    for (a, b) in polyline::segments(&line.points, line.closed) {
        let reach = 0.5 * line.width + 1.0;
        let (low, high) = (a.min(b) - reach, a.max(b) + reach);
        let range = |low: f64, high: f64, most: usize| {
            (low.max(0.0) as usize)..(high.max(-1.0) + 1.0).min(most as f64) as usize
        };
        for y in range(low.y, high.y, height) {
            for x in range(low.x, high.x, width) {
                let p = Point::new(x as f64 + 0.5, y as f64 + 0.5);
                let distance = p.distance(polyline::nearest_on_segment(p, a, b));
                let cover = (0.5 * line.width - distance + 0.5).clamp(0.0, 1.0) as f32;
                let under = picture.get(x, y);
                // What is darker stays, so that the joints of segments leave no trace.
                let mixed = [0, 1, 2].map(|c| under[c] + cover * (line.colour[c] - under[c]));
                let drawn = |c: usize| (mixed[c] - line.colour[c]).abs() < (under[c] - line.colour[c]).abs();
                if (0..3).any(drawn) {
                    picture.set(x, y, mixed);
                }
            }
        }
    }
}

/// White paper.
pub fn white(_: usize, _: usize) -> Colour {
    [1.0; 3]
}

/// The share of a line's length within `reach` of another line.
pub fn covered(line: &[Point], closed: bool, by: &[Point], by_closed: bool, reach: f64) -> f64 {
    let count = (polyline::length(line, closed) as usize).max(2);
    let points = polyline::resample(line, closed, count);
    points.iter().filter(|&&p| polyline::distance(p, by, by_closed) <= reach).count() as f64 / points.len() as f64
}
