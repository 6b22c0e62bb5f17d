//! Finds a part's centre on a frame between keys (Zhou & Xiao 2011, §2.2.1, "region term").
//!
//! The keys' polygons are blended linearly. The blended polygon is coloured from the first and from the last key
//! ([affine colouring](affine)). Each coloured polygon is moved over a window around its place on the frame. Its
//! candidate is the place with the least sum of squared colour differences, and the better candidate of the two keys
//! wins. Of equal places the one nearest to the blended place is taken, so that flat surroundings move nothing.
//!
//! **Fast and exact.** Places are visited from the middle outwards, and rows of the polygon in a scattered order. The
//! sum at a place stops as soon as it reaches the least sum so far. The second key starts with the first key's least
//! sum. Beyond the border the frame is continued by its outermost pixels.
//!
//! **Limits**, which are those of the paper: the search knows translations only, treats each frame by itself, reaches
//! 50 px from the blended place, and ignores occlusion. For parts larger than [`MAX_PIXELS`] only every second, third,
//! … row is compared.

pub mod affine;

use affine::{Run, Source};
use rototoon_base::geometry::{Point, polygon};
use rototoon_base::scene::{Colour, Raster};

/// Half the side of the search window in pixels. The paper's example is a window of 100 × 100 pixels.
pub const WINDOW: usize = 50;
/// Approximate number of a part's pixels that are compared. It limits the time on large frames.
pub const MAX_PIXELS: usize = 40_000;

/// The result of the search on a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// The part's centre (mean of the vertices), in pixels.
    pub center: Point,
    /// Root mean square colour difference per channel at this place, 0 to 1.
    pub difference: f64,
}

/// Searches on `frame` for the part, which has the polygon `blended` (pixels) between the keys. `sources` are the
/// prepared keys. `None` if the polygon has no pixel that could be coloured.
pub fn find_center(sources: &[Source<'_>], blended: &[Point], frame: &Raster<Colour>) -> Option<Found> {
    let offsets = offsets_outwards(WINDOW as isize);
    let mut best: Option<(f64, (isize, isize), usize)> = None;
    for source in sources {
        let template = Template::new(source.colour(blended, WINDOW));
        let Some(patch) = template.patch(frame) else { continue };
        for &offset in &offsets {
            let limit = best.map_or(f64::INFINITY, |best| best.0);
            if let Some(sum) = template.difference_below(&patch, offset, limit) {
                best = Some((sum, offset, template.values));
            }
        }
    }
    let (sum, (dx, dy), values) = best?;
    Some(Found {
        center: polygon::center(blended) + Point::new(dx as f64, dy as f64),
        difference: (sum / values as f64).sqrt(),
    })
}

/// All offsets of the window, nearest to the middle first. Offsets of equal distance are in row order.
fn offsets_outwards(reach: isize) -> Vec<(isize, isize)> {
    let mut offsets: Vec<_> = (-reach..=reach).flat_map(|dy| (-reach..=reach).map(move |dx| (dx, dy))).collect();
    offsets.sort_by_key(|&(dx, dy)| (dx * dx + dy * dy, dy, dx));
    offsets
}

/// A coloured polygon ready to be compared.
struct Template {
    /// Runs in the order of comparison.
    runs: Vec<Run>,
    /// Number of colour values that are compared.
    values: usize,
}

/// The frame's colours around the template, large enough for every offset.
struct Patch {
    left: isize,
    top: isize,
    colours: Raster<Colour>,
}

impl Template {
    fn new(runs: Vec<Run>) -> Self {
        let pixels = runs.iter().map(|run| run.colours.len() / 3).sum::<usize>();
        let stride = pixels.div_ceil(MAX_PIXELS).max(1) as isize;
        let thinned: Vec<Run> = runs.into_iter().filter(|run| run.y.rem_euclid(stride) == 0).collect();
        let order = scattered(thinned.len());
        let runs: Vec<Run> = order.into_iter().map(|k| thinned[k].clone()).collect();
        Self { values: runs.iter().map(|run| run.colours.len()).sum(), runs }
    }

    /// The frame's colours for this template. `None` if the template has no pixels.
    fn patch(&self, frame: &Raster<Colour>) -> Option<Patch> {
        let reach = WINDOW as isize;
        let left = self.runs.iter().map(|run| run.x).min()? - reach;
        let right = self.runs.iter().map(|run| run.x + (run.colours.len() / 3) as isize).max()? + reach;
        let top = self.runs.iter().map(|run| run.y).min()? - reach;
        let bottom = self.runs.iter().map(|run| run.y).max()? + 1 + reach;
        let colours = Raster::from_fn((right - left) as usize, (bottom - top) as usize, |x, y| {
            frame.clamped(left + x as isize, top + y as isize)
        });
        Some(Patch { left, top, colours })
    }

    /// Sum of squared differences at an offset, if it is below `limit`.
    fn difference_below(&self, patch: &Patch, (dx, dy): (isize, isize), limit: f64) -> Option<f64> {
        let mut sum = 0.0;
        for run in &self.runs {
            let row = patch.colours.row((run.y + dy - patch.top) as usize);
            let start = (run.x + dx - patch.left) as usize;
            let under = row[start..start + run.colours.len() / 3].as_flattened();
            sum += f64::from(squared_difference(&run.colours, under));
            if sum >= limit {
                return None;
            }
        }
        (sum < limit).then_some(sum)
    }
}

/// Σ (a − b)² in eight interleaved sums, which vector units can compute without a change of order.
fn squared_difference(a: &[f32], b: &[f32]) -> f32 {
    const LANES: usize = 8;
    let mut sums = [0.0f32; LANES];
    let (a_groups, b_groups) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let rest: f32 = a_groups.remainder().iter().zip(b_groups.remainder()).map(|(a, b)| (a - b) * (a - b)).sum();
    for (a, b) in a_groups.zip(b_groups) {
        for lane in 0..LANES {
            let d = a[lane] - b[lane];
            sums[lane] += d * d;
        }
    }
    sums.iter().sum::<f32>() + rest
}

/// The numbers 0 to `count` − 1 in an order in which each beginning of the list is spread over the range. The step is
/// that of the golden section, made coprime to `count`.
fn scattered(count: usize) -> Vec<usize> {
    let gcd = |mut a: usize, mut b: usize| {
        while b > 0 {
            (a, b) = (b, a % b);
        }
        a
    };
    let mut step = ((count as f64 * 0.618) as usize).max(1);
    while gcd(step, count.max(1)) != 1 {
        step += 1;
    }
    (0..count).map(|k| k * step % count).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A speckled disc of radius 9 on grey with its middle at (`x`, `y`).
    fn disc(x: f64, y: f64) -> Raster<Colour> {
        Raster::from_fn(120, 90, |px, py| {
            let (dx, dy) = (px as f64 + 0.5 - x, py as f64 + 0.5 - y);
            let shade = ((dx * 0.9).sin() * (dy * 0.7).cos()) as f32;
            if dx.hypot(dy) < 9.0 { [0.8, 0.3 + 0.2 * shade, 0.1] } else { [0.5; 3] }
        })
    }

    fn outline(x: f64, y: f64) -> Vec<Point> {
        (0..12).map(|k| Point::new(x, y) + 9.0 * Point::from_angle(k as f64 * std::f64::consts::TAU / 12.0)).collect()
    }

    #[test]
    fn a_part_off_the_straight_way_is_found() {
        let (first, last) = (disc(30.0, 40.0), disc(80.0, 40.0));
        let (a, b) = (outline(30.0, 40.0), outline(80.0, 40.0));
        let sources = [Source::new(&first, &a), Source::new(&last, &b)];
        let found = find_center(&sources, &outline(55.0, 40.0), &disc(48.0, 61.0)).unwrap();
        assert!(found.center.distance(Point::new(48.0, 61.0)) < 1e-9, "{found:?}");
        assert!(found.difference < 1e-3);
    }

    #[test]
    fn the_better_key_decides() {
        let (first, last) = (Raster::new(120, 90, [0.0; 3]), disc(80.0, 40.0));
        let (a, b) = (outline(30.0, 40.0), outline(80.0, 40.0));
        let sources = [Source::new(&first, &a), Source::new(&last, &b)];
        let found = find_center(&sources, &outline(55.0, 40.0), &disc(60.0, 44.0)).unwrap();
        assert!(found.center.distance(Point::new(60.0, 44.0)) < 1e-9, "{found:?}");
    }

    #[test]
    fn a_part_stays_if_all_places_are_equal() {
        let flat = Raster::new(60, 60, [0.25; 3]);
        let polygon = outline(30.3, 28.9);
        let found = find_center(&[Source::new(&flat, &polygon)], &polygon, &flat).unwrap();
        assert!(found.center.distance(polygon::center(&polygon)) < 1e-12);
        assert_eq!(found.difference, 0.0);
    }

    #[test]
    fn giving_up_early_changes_nothing() {
        let frame = disc(52.0, 47.0);
        let polygon = outline(40.0, 40.0);
        let template = Template::new(Source::new(&frame, &outline(52.0, 47.0)).colour(&polygon, WINDOW));
        let patch = template.patch(&frame).unwrap();
        let naive = offsets_outwards(WINDOW as isize)
            .into_iter()
            .map(|offset| (template.difference_below(&patch, offset, f64::INFINITY).unwrap(), offset))
            .reduce(|best, next| if next.0 < best.0 { next } else { best })
            .unwrap();
        let found = find_center(&[Source::new(&frame, &outline(52.0, 47.0))], &polygon, &frame).unwrap();
        let (dx, dy) = naive.1;
        assert!(found.center.distance(Point::new(40.0 + dx as f64, 40.0 + dy as f64)) < 1e-9);
    }

    #[test]
    fn rows_are_all_visited() {
        for count in [0, 1, 2, 3, 10, 97, 100] {
            let mut order = scattered(count);
            order.sort_unstable();
            assert_eq!(order, (0..count).collect::<Vec<_>>());
        }
    }

    #[test]
    fn a_part_without_pixels_is_not_found() {
        let flat = Raster::new(20, 20, [0.25; 3]);
        let line = [Point::new(2.0, 2.0), Point::new(9.0, 9.0)];
        assert_eq!(find_center(&[Source::new(&flat, &line)], &line, &flat), None);
    }
}
