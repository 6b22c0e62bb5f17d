//! What is true of a drawing: where each part's control points lie, which of them are seen, and where the picture shows it.

use super::outline::{Outline, Sample};
use rototoon::geometry::{Point, polygon};
use tiny_skia::Pixmap;

/// How far beside the ink's edge, in pixels, the picture is read to see whether its colour changes there.
const BESIDE: f64 = 1.5;
/// The least change across a contour that counts, in steps of 255 of one channel.
const CHANGE: i32 = 24;

/// For each part of a drawing (farthest first) and each control point whether it is scored: the point lies in the picture,
/// no nearer part covers it, and the picture's colour changes across the contour there.
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

/// Whether a part hides `p`: `p` lies inside, or under the ink.
fn covers(shape: &[Point], line: &[Sample], p: Point) -> bool {
    polygon::contains(shape, p) || line.iter().any(|s| s.at.distance(p) < s.ink / 2.0)
}

/// Whether the colours on the contour and just beside its ink differ at a control point.
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

/// The colour of the pixel that holds `p`; `None` outside the picture.
fn colour(picture: &Pixmap, p: Point) -> Option<[i32; 3]> {
    if p.x < 0.0 || p.y < 0.0 {
        return None;
    }
    let c = picture.pixel(p.x as u32, p.y as u32)?;
    Some([c.red(), c.green(), c.blue()].map(i32::from))
}
