//! Branches moved from the centres of pixels to the centre of the ink.
//!
//! At each point the darkness is read along the normal, as far as the ink is wide; its centre of gravity is the centre of
//! the line there. Offsets are smoothed along the line, so grain does not make it tremble. Where two lines lie close to
//! each other, offsets are limited to a pixel.

use crate::graph::Branch;
use rototoon_base::geometry::Point;
use rototoon_base::scene::Raster;

/// Standard deviation of the smoothing along the line, in points (about a pixel each).
const SMOOTH: f64 = 1.6;
/// Largest shift in pixels.
const FARTHEST: f64 = 1.0;
/// Distance between readings in pixels.
const STEP: f64 = 0.5;

/// Moves a branch onto the centre of the ink.
pub fn centred(branch: &mut Branch, darkness: &Raster<f32>) {
    let n = branch.points.len();
    if n < 3 {
        return;
    }
    let smooth = smoothed(&branch.points, branch.closed, SMOOTH);
    let normal = |i: usize| {
        let (a, b) =
            if branch.closed { ((i + n - 2) % n, (i + 2) % n) } else { (i.saturating_sub(2), (i + 2).min(n - 1)) };
        (smooth[b] - smooth[a]).normalize_or_zero().perp()
    };
    let offset = |i: usize| {
        let (across, reach) = (normal(i), branch.radii[i] + 1.0);
        let count = (reach / STEP).ceil() as i32;
        let (mut sum, mut moment) = (0.0, 0.0);
        for k in -count..=count {
            let at = f64::from(k) * STEP;
            let value = f64::from(read(darkness, smooth[i] + at * across));
            sum += value;
            moment += value * at;
        }
        if sum > 0.0 { across * (moment / sum).clamp(-FARTHEST, FARTHEST) } else { Point::ZERO }
    };
    let offsets: Vec<Point> = (0..n).map(offset).collect();
    let offsets = smoothed(&offsets, branch.closed, SMOOTH);
    branch.points = smooth.iter().zip(offsets).map(|(&p, d)| p + d).collect();
}

/// Values blurred along a line by a Gaussian. Both ends of an open line stay: the window shrinks towards them.
pub fn smoothed(values: &[Point], closed: bool, sigma: f64) -> Vec<Point> {
    let n = values.len();
    let radius = (3.0 * sigma).ceil() as usize;
    let weights: Vec<f64> = (0..=radius).map(|k| (-0.5 * (k as f64 / sigma).powi(2)).exp()).collect();
    let at = |i: usize| {
        let reach = if closed { radius.min((n - 1) / 2) } else { radius.min(i).min(n - 1 - i) };
        let mut sum = values[i] * weights[0];
        let mut total = weights[0];
        for k in 1..=reach {
            sum += weights[k] * (values[(i + n - k) % n] + values[(i + k) % n]);
            total += 2.0 * weights[k];
        }
        sum / total
    };
    (0..n).map(at).collect()
}

/// Bilinear reading; a pixel's centre is at +0.5.
pub fn read(raster: &Raster<f32>, p: Point) -> f32 {
    let (x, y) = (p.x - 0.5, p.y - 0.5);
    let (left, top) = (x.floor(), y.floor());
    let (u, v) = ((x - left) as f32, (y - top) as f32);
    let (left, top) = (left as isize, top as isize);
    let row = |y: isize| (1.0 - u) * raster.clamped(left, y) + u * raster.clamped(left + 1, y);
    (1.0 - v) * row(top) + v * row(top + 1)
}
