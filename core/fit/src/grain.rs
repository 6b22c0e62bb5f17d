//! The grain of a line: how far its points may be off because of rounding or noise.
//!
//! **Rounding.** A bitmap tracer returns pixel centres or pixel corners. Such points share one fraction in x and one in y,
//! and neighbours are close. Each was rounded by up to half a pixel. A smooth curve through the places before rounding
//! cannot be nearer to the points than that. A tolerance below half a pixel would ask for the staircase itself. So below
//! one pixel the limit is the tolerance plus half a pixel, at most one pixel ([`Grain::limit`]). From one pixel on it is the
//! tolerance. The limit never falls when the tolerance rises.
//!
//! **Noise.** The jitter of a hand is estimated from third differences, which vanish on straight and evenly bent
//! stretches. The median is blind to corners. Limits: waves much longer than the spacing of the points count as shape.

use super::clean::Cleaned;
use rototoon_base::geometry::Point;

/// Largest error of rounding along an axis, in pixels.
const HALF: f64 = 0.5;
/// Noise that spoils directions as much as rounding does, in pixels. The steps of a staircase are regular, so they average
/// out sooner than independent errors of the same size (0.29 px) do.
const STAIRCASE: f64 = 0.17;
/// Largest error of rounding in the plane, with some room, in pixels.
const DIAGONAL: f64 = 0.75;
/// A limit below this many standard deviations of the noise is mostly noise.
const AUDIBLE: f64 = 2.5;
/// With this tolerance the staircase is within the limit anyway, in pixels.
const PIXEL: f64 = 1.0;
/// Points farther from the grid than this are not rounded, in pixels.
const OFF: f64 = 1e-6;
/// At least this many points show a grid.
const LEAST: usize = 16;
/// At least this share of the steps of a rounded line is shorter than [`STEP`] pixels.
const CLOSE: f64 = 0.75;
const STEP: f64 = 2.5;

/// The grain of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Grain {
    /// Whether the points are rounded to pixels.
    pub rounded: bool,
    /// Standard deviation of the noise of each coordinate, in pixels; for rounded points that of noise with like effect.
    pub noise: f64,
}

impl Grain {
    /// The grain of the points as given. `fine` is the same line with its gaps filled.
    pub fn of(points: &[Point], fine: &Cleaned) -> Self {
        let rounded = rounded(points);
        Self { rounded, noise: if rounded { STAIRCASE } else { noise(&fine.points) } }
    }

    /// Below this limit a fit follows the noise, in pixels.
    pub fn floor(&self) -> f64 {
        if self.rounded { DIAGONAL } else { AUDIBLE * self.noise }
    }

    /// The largest distance between points and curve with this tolerance, both in pixels.
    pub fn limit(&self, tolerance: f64) -> f64 {
        if self.rounded { tolerance.max((tolerance + HALF).min(PIXEL)) } else { tolerance }
    }
}

/// Whether the points are pixels along a line.
pub(super) fn rounded(points: &[Point]) -> bool {
    if points.len() < LEAST {
        return false;
    }
    let first = points[0];
    let on_grid = |p: &Point| {
        let off = *p - first;
        (off.x - off.x.round()).abs() <= OFF && (off.y - off.y.round()).abs() <= OFF
    };
    let close = points.windows(2).filter(|pair| pair[0].distance(pair[1]) < STEP).count();
    points.iter().all(on_grid) && close as f64 >= CLOSE * (points.len() - 1) as f64
}

/// Standard deviation of the noise of a coordinate, from the median of the third differences.
fn noise(points: &[Point]) -> f64 {
    let mut sizes: Vec<f64> = points
        .windows(4)
        .flat_map(|p| {
            let third = p[3] - p[0] + (p[1] - p[2]) * 3.0;
            [third.x.abs(), third.y.abs()]
        })
        .collect();
    if sizes.len() < 2 * LEAST {
        return 0.0;
    }
    let middle = sizes.len() / 2;
    let (_, median, _) = sizes.select_nth_unstable_by(middle, f64::total_cmp);
    // A normal distribution has the median 0.6745 σ; a third difference has the variance 1 + 9 + 9 + 1.
    *median / (0.6745 * 20.0f64.sqrt())
}

#[cfg(test)]
mod tests {
    use super::super::clean;
    use super::*;

    fn grain(points: &[Point]) -> Grain {
        Grain::of(points, &clean::filled(points, false))
    }

    fn wave(i: i32) -> Point {
        Point::new(f64::from(i), 40.0 * (f64::from(i) / 30.0).sin())
    }

    #[test]
    fn pixels_are_rounded_and_other_points_are_not() {
        let exact: Vec<Point> = (0..300).map(wave).collect();
        let pixels: Vec<Point> = exact.iter().map(|p| p.floor() + 0.5).collect();
        assert!(grain(&pixels).rounded && !grain(&exact).rounded);
        assert!(grain(&exact).noise < 0.01, "{}", grain(&exact).noise);
        // Vertices that somebody put on whole pixels are exact.
        let polygon: Vec<Point> = (0..40).map(|k| Point::new(f64::from(k) * 9.0, f64::from(k % 2) * 20.0)).collect();
        assert!(!grain(&polygon).rounded);
    }

    #[test]
    fn the_noise_is_estimated_and_corners_do_not_count() {
        let jitter = |k: i32| (f64::from(k) * 12.9898).sin() * 43758.5453;
        let uniform = |k: i32| 2.0 * (jitter(k) - jitter(k).floor()) - 1.0;
        let bent = |i: i32| if i < 200 { Point::new(f64::from(i), 0.0) } else { Point::new(200.0, f64::from(i - 200)) };
        let points: Vec<Point> = (0..400).map(|i| bent(i) + Point::new(uniform(i), uniform(i + 977)) * 0.3).collect();
        let truth = 0.3 / 3.0f64.sqrt();
        let found = grain(&points).noise;
        assert!((0.7 * truth..1.4 * truth).contains(&found), "{found} {truth}");
    }

    #[test]
    fn the_limit_rises_with_the_tolerance() {
        let pixels = Grain { rounded: true, noise: 0.3 };
        let limits: Vec<f64> = [0.05, 0.25, 0.5, 0.7, 1.0, 3.0].map(|t| pixels.limit(t)).into();
        assert_eq!(limits, [0.55, 0.75, 1.0, 1.0, 1.0, 3.0]);
        assert_eq!(Grain { rounded: false, noise: 0.3 }.limit(0.25), 0.25);
    }
}
