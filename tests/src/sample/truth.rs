//! Finds the scored control points of a drawing: those that are visible, and at which the picture shows the contour.

use super::outline::{Outline, Sample};
use rototoon::geometry::{Point, polygon};
use tiny_skia::Pixmap;

/// Distance in pixels from the ink's edge at which the colours on both sides of the contour are read.
const BESIDE: f64 = 1.5;
/// Least change of a channel across a contour that counts, of 255.
const CHANGE: i32 = 24;

/// For each part of a drawing (the farthest first) and each of its control points, whether the point is scored. A scored
/// point is in the picture, no nearer part covers it, and the picture's colour changes across the contour there.
pub fn scored(outlines: &[Outline], picture: &Pixmap) -> Vec<Vec<bool>> {
    let lines: Vec<Vec<Sample>> = outlines.iter().map(Outline::dense).collect();
    let shapes: Vec<Vec<Point>> = lines.iter().map(|l| l.iter().map(|s| s.at).collect()).collect();
    outlines
        .iter()
        .enumerate()
        .map(|(k, outline)| {
            let covered = |p: Point| (k + 1..outlines.len()).any(|n| covers(&shapes[n], &lines[n], p));
            (0..outline.points.len()).map(|i| !covered(outline.points[i]) && changes(outline, i, picture)).collect()
        })
        .collect()
}

/// Whether a part hides `p`, because `p` is inside the part or under its ink.
fn covers(shape: &[Point], line: &[Sample], p: Point) -> bool {
    polygon::contains(shape, p) || line.iter().any(|s| s.at.distance(p) < s.ink / 2.0)
}

/// Whether at a control point the colours on the contour and on both sides of its ink differ.
pub fn changes(outline: &Outline, i: usize, picture: &Pixmap) -> bool {
    let n = outline.points.len();
    let at = outline.points[i];
    let across = (outline.points[(i + 1) % n] - outline.points[(i + n - 1) % n]).normalize_or_zero().perp();
    let reach = outline.ink[i] / 2.0 + BESIDE;
    let Some(colours) = [at, at - reach * across, at + reach * across]
        .into_iter()
        .map(|p| colour(picture, p))
        .collect::<Option<Vec<_>>>()
    else {
        return false;
    };
    let differ = |a: [i32; 3], b: [i32; 3]| (0..3).any(|c| (a[c] - b[c]).abs() >= CHANGE);
    differ(colours[0], colours[1]) || differ(colours[0], colours[2]) || differ(colours[1], colours[2])
}

/// The colour of the pixel that contains `p`; `None` outside the picture.
fn colour(picture: &Pixmap, p: Point) -> Option<[i32; 3]> {
    if p.x < 0.0 || p.y < 0.0 {
        return None;
    }
    let c = picture.pixel(p.x as u32, p.y as u32)?;
    Some([c.red(), c.green(), c.blue()].map(i32::from))
}
