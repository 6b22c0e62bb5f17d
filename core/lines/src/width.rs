//! The width of a line, measured in the darkness across it.
//!
//! **Why.** The distance of the skeleton from the nearest paper tells a width in whole pixels only: a line of two pixels seems as
//! wide as one of one pixel, and a line that is carried from another drawing has no skeleton of its own. But all the darkness
//! across a line is its width times the darkness of its ink, wherever the line lies between the pixels and however soft its
//! edges are.
//!
//! **How.** At each point the darkness is read along the normal, outwards from the line's middle to where it is gone or another
//! line begins. Its sum is the width times the ink's darkness D. The darkest reading is D only if the line is wide: a blur by
//! σ leaves a line of width w the share erf(w / (2 √2 σ)) of it. So one width for the whole line is found first that explains
//! the middle of its sums and of its peaks; that gives D, and D gives every point's own width. D is not more than the darkest ink
//! of the drawing, which matters for thin lines: they lose so much of their peak that it tells little.
//!
//! A reading is not used where the ink does not end within the reach, or ends much farther away than elsewhere on the line: in
//! junctions, and on solid shapes. Nor is it at the very ends of a line, where its ink fades. There the width goes evenly from the one beside it to the next.
//!
//! **Limits.** What is thinner than a pixel cannot be told from what is paler; it is given [`THINNEST`] or more. A line that gets
//! paler along its way gets thinner. Below two pixels the peak of a line that runs along the pixels depends on where it lies between
//! them, and its width may be 0.4 px off. A line that was sketched with several strokes has gaps in it; its width is left as the
//! skeleton told it. Measured in its filled ink, carried lines get too broad: they lie beside its middle, and their reading takes in what is filled next to it.

use crate::centre::{read, smoothed};
use rototoon_base::geometry::Point;
use rototoon_base::scene::Raster;
use std::ops::Range;

/// The least width in pixels.
const THINNEST: f64 = 0.7;
/// Distance between readings in pixels.
const STEP: f64 = 0.5;
/// Share of the peak below which the darkness is gone.
const GONE: f64 = 0.08;
/// Share of the peak by which darkness rises again where another line begins.
const RISES: f64 = 0.05;
/// Standard deviation in pixels of the edge of a hard line: the blur of the darkness, the pixel, and reading between pixels.
const EDGE: f64 = 0.75;
/// Distance in pixels from an end of the line, where its darkness fades, within which readings are not used.
const TIP: f64 = 2.0;
/// Extent of a reading, in extents of the middle reading of its line and pixels, from which on it is not used.
const WIDE: (f64, f64) = (1.5, 1.0);

/// What lies across a line at a point.
#[derive(Clone, Copy)]
struct Across {
    /// Sum of the darkness in pixels.
    sum: f64,
    peak: f64,
    /// How far the darkness reaches, in pixels.
    extent: f64,
}

/// Half the width of a line at each of its points, about a pixel apart. `radii` is half of what it is thought to be; it says how
/// far to look, and stays where nothing can be measured. `darkest` is the darkness of the darkest ink.
pub fn measured((points, closed): (&[Point], bool), radii: &[f64], darkness: &Raster<f32>, darkest: f64) -> Vec<f64> {
    let smooth = smoothed(points, closed, 1.6);
    let found: Vec<Option<Across>> =
        (0..points.len()).map(|i| across(&smooth, closed, (i, radii[i]), darkness)).collect();
    let Some(extent) = middle(found.iter().flatten().map(|own| own.extent)) else { return radii.to_vec() };
    let fits = |own: &Across| own.extent <= WIDE.0 * extent + WIDE.1;
    let inner = within(points, closed);
    let fits = |(i, own): (usize, Option<Across>)| own.filter(|own| inner.contains(&i) && fits(own));
    let used: Vec<Option<Across>> = found.into_iter().enumerate().map(fits).collect();
    let Some(ink) = ink(&used, darkest) else { return radii.to_vec() };
    let halves = used.iter().map(|own| own.map(|own| 0.5 * (own.sum / ink).max(THINNEST))).collect();
    filled(halves, points, closed)
}

/// The points that are not at an end of the line. All of them, if there are no others.
fn within(points: &[Point], closed: bool) -> Range<usize> {
    let near = |end: usize| points.iter().filter(move |p| p.distance(points[end]) < TIP).count();
    let range = near(0)..points.len() - near(points.len() - 1);
    if closed || range.is_empty() { 0..points.len() } else { range }
}

/// The darkness across a line at point `i`. `None` where it does not end.
fn across(line: &[Point], closed: bool, (i, radius): (usize, f64), darkness: &Raster<f32>) -> Option<Across> {
    let n = line.len();
    let (a, b) = if closed { ((i + n - 2) % n, (i + 2) % n) } else { (i.saturating_sub(2), (i + 2).min(n - 1)) };
    let normal = (line[b] - line[a]).normalize_or_zero().perp();
    if normal == Point::ZERO {
        return None;
    }
    let at = |k: i32| f64::from(read(darkness, line[i] + f64::from(k) * STEP * normal));
    let (near, far) = (((0.5 * radius + 0.5) / STEP) as i32, ((2.5 * radius + 3.0) / STEP) as i32);
    let middle = (-near..=near).max_by(|&j, &k| at(j).total_cmp(&at(k)).then(k.abs().cmp(&j.abs())))?;
    let peak = at(middle);
    if peak <= 0.0 {
        return None;
    }
    let (mut sum, mut steps) = (peak, 1);
    for side in [-1, 1] {
        let (mut least, mut ended) = (peak, false);
        for k in 1..=far {
            let value = at(middle + side * k);
            ended = value < GONE * peak || least < 0.5 * peak && value > least + RISES * peak;
            if ended {
                break;
            }
            least = least.min(value);
            sum += value;
            steps += 1;
        }
        if !ended {
            return None;
        }
    }
    Some(Across { sum: sum * STEP, peak, extent: f64::from(steps) * STEP })
}

/// The darkness of a line's ink, which is at most `darkest`.
fn ink(used: &[Option<Across>], darkest: f64) -> Option<f64> {
    let sum = middle(used.iter().flatten().map(|own| own.sum))?;
    let peak = middle(used.iter().flatten().map(|own| own.peak))?;
    // The share of the peak that is left falls with the width, and the sum is the width times the ink.
    let left = |width: f64| libm::erf(width / (8f64.sqrt() * EDGE)) / width;
    let (mut low, mut high) = (THINNEST, 1e5);
    for _ in 0..60 {
        let half = (low * high).sqrt();
        if left(half) > peak / sum {
            low = half;
        } else {
            high = half;
        }
    }
    Some((sum / low).min(darkest))
}

/// Values for the points without one: evenly along the line between those beside them.
fn filled(values: Vec<Option<f64>>, points: &[Point], closed: bool) -> Vec<f64> {
    let n = values.len();
    let known: Vec<usize> = (0..n).filter(|&i| values[i].is_some()).collect();
    let mut lengths = vec![0.0];
    for k in 0..n {
        lengths.push(lengths[k] + points[k].distance(points[(k + 1) % n]));
    }
    let value = |i: usize| values[i].unwrap_or(0.5 * THINNEST);
    let at = |i: usize| {
        let next = known.partition_point(|&k| k < i);
        let (before, after) = (next.checked_sub(1).map(|k| known[k]), known.get(next).copied());
        let (a, b) = match (before, after) {
            (Some(a), Some(b)) => (a, b),
            (None, Some(b)) if !closed => return value(b),
            (Some(a), None) if !closed => return value(a),
            _ => (known[known.len() - 1], known[0]),
        };
        let way = |from: usize, to: usize| {
            let length = lengths[to] - lengths[from];
            if to >= from { length } else { length + lengths[n] }
        };
        value(a) + (value(b) - value(a)) * way(a, i) / way(a, b).max(1e-9)
    };
    (0..n).map(|i| values[i].unwrap_or_else(|| at(i))).collect()
}

fn middle(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_unstable_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon_image::gaussian::{Border, blur};

    /// A straight line through (30, 20) at an angle, `width` wide at its middle and `grows` more at each pixel along it.
    fn line(angle: f64, shift: f64, (width, grows): (f64, f64), ink: f32) -> (Raster<f32>, Vec<Point>) {
        const FINE: usize = 8;
        let (way, start) = (Point::from_angle(angle), Point::new(30.0, 20.0 + shift));
        let inside = |p: Point| {
            let along = (p - start).dot(way);
            (p - start).perp_dot(way).abs() < 0.5 * (width + grows * along) && along.abs() < 18.0
        };
        let share = |x: usize, y: usize| {
            let at = |k: usize| (k as f64 + 0.5) / FINE as f64;
            let samples = (0..FINE * FINE).map(|k| Point::new(x as f64 + at(k % FINE), y as f64 + at(k / FINE)));
            samples.filter(|&p| inside(p)).count() as f32 / (FINE * FINE) as f32
        };
        let darkness = blur(&Raster::from_fn(60, 40, |x, y| ink * share(x, y)), 0.6, Border::Replicate);
        (darkness, (-14..=14).map(|k| start + f64::from(k) * way).collect())
    }

    #[test]
    fn widths_are_found_between_pixels() {
        for width in [1.5, 2.0, 2.5, 3.0, 5.5, 9.0] {
            for (angle, shift) in [(0.0, 0.0), (0.0, 0.5), (0.0, 0.3), (0.4, 0.0), (0.785, 0.2), (1.3, 0.0)] {
                for ink in [1.0, 0.3] {
                    let (darkness, points) = line(angle, shift, (width, 0.0), ink);
                    for radius in measured((&points, false), &[0.5 * width; 29], &darkness, f64::from(ink)) {
                        let (off, least) = ((2.0 * radius - width).abs(), if width < 2.0 { 0.45 } else { 0.25 });
                        assert!(off < least, "{width} px at {angle} + {shift}, ink {ink}: {}", 2.0 * radius);
                    }
                }
            }
        }
    }

    #[test]
    fn a_line_is_as_wide_at_its_ends() {
        // The ink ends 18 px from the middle.
        let (darkness, _) = line(0.0, 0.3, (3.0, 0.0), 1.0);
        let points: Vec<Point> = (-18..=18).map(|k| Point::new(30.0 + f64::from(k), 20.3)).collect();
        let radii = measured((&points, false), &[1.5; 37], &darkness, 1.0);
        assert!(radii.iter().all(|radius| (2.0 * radius - 3.0).abs() < 0.25), "{radii:?}");
    }

    #[test]
    fn a_line_that_grows_grows() {
        let (darkness, points) = line(0.3, 0.1, (4.0, 0.15), 0.8);
        let radii = measured((&points, false), &[2.0; 29], &darkness, 1.0);
        for (k, radius) in radii.iter().enumerate() {
            // At the ends nothing is measured.
            let truth = 4.0 + 0.15 * (k.clamp(2, 26) as f64 - 14.0);
            assert!((2.0 * radius - truth).abs() < 0.3, "{k}: {} for {truth}", 2.0 * radius);
        }
    }

    #[test]
    fn another_line_beside_it_or_across_it_does_not_count() {
        let (mut darkness, points) = line(0.0, 0.0, (2.0, 0.0), 1.0);
        for y in 0..40 {
            for x in 0..60 {
                let beside = (24..26).contains(&y);
                let across = (28..32).contains(&x);
                if beside || across {
                    darkness.set(x, y, 1.0);
                }
            }
        }
        let radii = measured((&points, false), &[1.0; 29], &darkness, 1.0);
        assert!(radii.iter().all(|radius| (2.0 * radius - 2.0).abs() < 0.4), "{radii:?}");
    }

    #[test]
    fn where_nothing_can_be_measured_widths_stay() {
        let points: Vec<Point> = (0..9).map(|k| Point::new(10.0 + f64::from(k), 10.0)).collect();
        for value in [0.0, 1.0] {
            let radii = measured((&points, false), &[1.5; 9], &Raster::new(30, 20, value), 1.0);
            assert_eq!(radii, [1.5; 9]);
        }
        assert_eq!(measured((&points[..1], false), &[1.5], &Raster::new(30, 20, 1.0), 1.0), [1.5]);
    }

    #[test]
    fn gaps_of_rings_are_filled_around_the_end() {
        let ring = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)].map(|(x, y)| Point::new(x, y));
        assert_eq!(filled(vec![None, Some(1.0), Some(4.0), None], &ring, true), [2.0, 1.0, 4.0, 3.0]);
        assert_eq!(filled(vec![None, Some(1.0), None, Some(4.0)], &ring, false), [1.0, 1.0, 2.5, 4.0]);
    }
}
