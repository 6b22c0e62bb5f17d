//! Strokes as they are handed out: fitted, with few even points, widths and colour.

use crate::stroke::Stroke;
use crate::strokes::Walked;
use crate::width;
use rototoon_base::geometry::{Point, polygon, polyline};
use rototoon_base::scene::{Colour, Raster};
use rototoon_fit::{Options, fit};

/// Tolerance of the fit in pixels, at 540 lines, and its least value in pixels.
const TOLERANCE: f64 = 0.6;
const LEAST_TOLERANCE: f64 = 0.45;
/// Distance between points in pixels, at 540 lines.
const SPACING: f64 = 2.0;

/// The stroke of a walked line. `unit` is the size of a pixel of 540 lines. `darkness` is that of each pixel and of the darkest ink; without it
/// the line keeps the radii with which it was walked.
pub fn finished(walked: &Walked, picture: &Raster<Colour>, unit: f64, darkness: Option<&(Raster<f32>, f32)>) -> Stroke {
    let points = curve(&walked.points, walked.closed, unit);
    if walked.fill {
        let colour = colour(&inside(&points, picture), picture);
        return Stroke { widths: Vec::new(), colour, points, closed: true, fill: true, fill_colour: None };
    }
    let widths = match darkness {
        Some((darkness, darkest)) => {
            let line = (&walked.points[..], walked.closed);
            let radii = width::measured(line, &walked.radii, darkness, f64::from(*darkest));
            widths(walked, &radii, &points)
        }
        None => widths(walked, &walked.radii, &points),
    };
    let (colour, closed) = (colour(&walked.points, picture), walked.closed);
    Stroke { widths, colour, points, closed, fill: false, fill_colour: None }
}

/// The centres of the pixels within an outline, and its own points if it is too thin for any.
fn inside(points: &[Point], picture: &Raster<Colour>) -> Vec<Point> {
    let mut found = Vec::new();
    polygon::for_each_span(points, picture.width(), picture.height(), |y, first, behind| {
        found.extend((first..behind).map(|x| Point::new(x as f64 + 0.5, y as f64 + 0.5)));
    });
    if found.is_empty() { points.to_vec() } else { found }
}

/// The line, fitted and resampled; corners stay.
fn curve(points: &[Point], closed: bool, unit: f64) -> Vec<Point> {
    let tolerance = (TOLERANCE * unit).max(LEAST_TOLERANCE);
    let Ok(fitted) = fit(points, closed, &Options::new(tolerance)) else { return points.to_vec() };
    let spline = fitted.spline;
    let per_piece = |length: f64| (length / (SPACING * unit.max(0.5))).ceil().max(1.0) as usize;
    let mut out: Vec<Point> = Vec::new();
    for piece in spline.pieces() {
        let count = per_piece(piece.length());
        out.extend((0..count).map(|k| piece.point(k as f64 / count as f64)));
    }
    if !closed && let Some(piece) = spline.pieces().last() {
        out.push(piece.point(1.0));
    }
    out.dedup_by(|a, b| a.distance(*b) < 1e-6);
    if out.len() < 2 { points.to_vec() } else { out }
}

/// The width at each point of the fitted line: that of the walked line at the same share of the length.
fn widths(walked: &Walked, radii: &[f64], points: &[Point]) -> Vec<f64> {
    let shares = |points: &[Point]| {
        let total = polyline::length(points, false).max(1e-9);
        let mut at = 0.0;
        let mut out = vec![0.0];
        for pair in points.windows(2) {
            at += pair[0].distance(pair[1]);
            out.push(at / total);
        }
        out
    };
    let radii: Vec<Point> = radii.iter().map(|&r| Point::new(2.0 * r, 0.0)).collect();
    let smooth = crate::centre::smoothed(&radii, walked.closed, 3.0);
    let known = shares(&walked.points);
    let mut k = 0;
    let at = |share: f64| {
        while k + 2 < known.len() && known[k + 1] < share {
            k += 1;
        }
        if known.len() < 2 {
            return smooth[0].x;
        }
        let t = ((share - known[k]) / (known[k + 1] - known[k]).max(1e-12)).clamp(0.0, 1.0);
        smooth[k].x + t * (smooth[k + 1].x - smooth[k].x)
    };
    shares(points).into_iter().map(at).collect()
}

/// The middle colour of the ink along the line, channel by channel.
pub fn colour(points: &[Point], picture: &Raster<Colour>) -> Colour {
    // An odd step does not meet the same column of a shape again and again.
    let step = (points.len() / 200).max(1) | 1;
    let read = |p: &Point| picture.clamped(p.x.floor() as isize, p.y.floor() as isize);
    let colours: Vec<Colour> = points.iter().step_by(step).map(read).collect();
    [0, 1, 2].map(|c| {
        let mut values: Vec<f32> = colours.iter().map(|colour| colour[c]).collect();
        values.sort_unstable_by(f32::total_cmp);
        values.get(values.len() / 2).copied().unwrap_or(0.0)
    })
}
