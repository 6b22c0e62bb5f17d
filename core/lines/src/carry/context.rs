//! What the drawing looks like around a point: shape contexts (Belongie, Malik & Puzicha 2002).
//!
//! The ink around a point is counted in cells of distance and angle, in two channels by the direction of the ink there
//! (along the ray from the point, or across it). Counts go to both neighbouring cells in proportion, so that a small
//! change of the drawing is a small change of the context. Distances are logarithmic: what is near counts in detail. The
//! square roots of the shares are compared (Hellinger), which one product of vectors does.

use super::samples::Sample;
use rototoon_base::geometry::Point;
use std::f64::consts::TAU;

const ANGLES: usize = 12;
const RINGS: usize = 6;
const CELLS: usize = ANGLES * RINGS * 2;
/// Radius of the innermost ring, as a share of the outermost.
const INNER: f64 = 0.06;

/// The context of a point.
pub type Context = [f32; CELLS];

/// The context of `at` in a drawing of the samples `ink`; `radius` is the largest distance that counts.
pub fn context(at: Point, ink: &[Sample], radius: f64) -> Context {
    let mut counts = [0.0f32; CELLS];
    let scale = (RINGS - 1) as f64 / INNER.recip().ln();
    for sample in ink {
        let way = sample.place - at;
        let squared = way.length_squared();
        if squared >= radius * radius || squared < 1e-6 {
            continue;
        }
        let distance = squared.sqrt();
        let ring = ((distance / (INNER * radius)).ln() * scale).max(0.0);
        let angle = (way.y.atan2(way.x) / TAU).rem_euclid(1.0) * ANGLES as f64;
        let across = (way.perp_dot(sample.along) / distance).powi(2) as f32;
        let (r, a) = ((ring as usize).min(RINGS - 2), angle as usize % ANGLES);
        let (u, v) = ((ring - r as f64).min(1.0) as f32, angle.fract() as f32);
        for (ring, share) in [(r, 1.0 - u), (r + 1, u)] {
            for (angle, part) in [(a, 1.0 - v), ((a + 1) % ANGLES, v)] {
                let cell = (ring * ANGLES + angle) * 2;
                counts[cell] += share * part * (1.0 - across);
                counts[cell + 1] += share * part * across;
            }
        }
    }
    let sum: f32 = counts.iter().sum();
    counts.map(|count| if sum > 0.0 { (count / sum).sqrt() } else { 0.0 })
}

/// How different two contexts are, 0 to 1.
pub fn difference(a: &Context, b: &Context) -> f32 {
    let mut sums = [0.0f32; 16];
    for (a, b) in a.chunks_exact(16).zip(b.chunks_exact(16)) {
        for k in 0..16 {
            sums[k] += a[k] * b[k];
        }
    }
    (1.0 - sums.iter().sum::<f32>()).max(0.0)
}
