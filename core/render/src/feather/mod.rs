//! Soft borders: blurs a matte with a bell of finite width.
//!
//! The bell is the quadratic B-spline stretched over twice the radius and integrated over each pixel. Its width may be
//! any number of pixels and changes smoothly. Rows are blurred first, then columns. A straight border becomes a smooth
//! rise that begins a radius before it and ends a radius behind it.
//!
//! The time does not depend on the radius. The weights of the bell are pieces of parabolas, so their third differences
//! are zero except for four taps at each of the four places where pieces meet. The differences between neighbouring
//! pixels of a row are filtered with these taps and then summed four times. The result is the row filtered with the
//! complete bell. A matte changes only at borders, so most of it costs almost nothing.
//!
//! Running sums that round would drift, and pixels would depend on the start of their window. Here the sums are exact.
//! A third of the radius is approximated by a fraction P ∕ Q with even Q. Then all weights are integers over 48 P³, and
//! values are integer multiples of 2⁻²⁰. P is small enough that every sum is an integer below 2⁵³, which a 64-bit float
//! represents exactly. The fraction differs from the radius by less than 1/200 of it.
//!
//! [`varied()`] has a radius of its own for each pixel. [`Ramp`] makes other courses of the border from this one.
//!
//! Limits: for radii above about 800 pixels sums may round.
//!
//! Source: P. S. Heckbert: Filtering by repeated integration. SIGGRAPH, 1986.

mod bell;
mod columns;
mod ramp;
mod rows;
mod varied;

use bell::Bell;
use columns::Columns;
pub use ramp::Ramp;
use rototoon_base::scene::Raster;
use rows::Line;
pub use varied::varied;

/// A column at which a row changes, and its value from there on.
pub type Change = (usize, f32);

/// Reach of a blur on each side, in pixels.
pub fn reach(radius: f64) -> usize {
    if radius > 0.0 { (radius + 0.5).ceil() as usize } else { 0 }
}

/// Blurs a picture of values from 0 to 1 by a radius in pixels. The result is smaller by [`reach`] on each side,
/// because pixels nearer to the border are unknown. `None` if `go_on`, called for each row, returns false.
pub fn feathered(picture: &Raster<f32>, radius: f64, go_on: &mut dyn FnMut() -> bool) -> Option<Raster<f32>> {
    let margin = reach(radius);
    if margin == 0 {
        return Some(picture.clone());
    }
    let (width, height) = (picture.width(), picture.height());
    let mut result = Raster::new(width.saturating_sub(2 * margin), height.saturating_sub(2 * margin), 0.0f32);
    let mut feather = Feather::new(radius, width);
    for y in 0..height {
        if !go_on() {
            return None;
        }
        let mut before = 0.0;
        feather.changes.clear();
        for (column, &value) in picture.row(y).iter().enumerate() {
            if value != before {
                feather.changes.push((column, value));
                before = value;
            }
        }
        if let Some(row) = feather.take() {
            result.row_mut(y - 2 * margin).copy_from_slice(row);
        }
    }
    Some(result)
}

/// A blur like [`feathered`] that takes a picture row by row. The picture itself is never in memory.
pub struct Feather {
    bell: Bell,
    line: Line,
    columns: Columns,
    /// The changes of the next row, from left to right. Left of the first the row is 0.
    pub changes: Vec<Change>,
    row: Vec<f32>,
    width: usize,
    taken: usize,
}

impl Feather {
    /// For rows of `width` values. Those of the result have twice the [`reach`] less.
    pub fn new(radius: f64, width: usize) -> Self {
        let bell = Bell::new(radius);
        let inner = width.saturating_sub(2 * reach(radius));
        let (line, columns) = (Line::new(&bell, width), Columns::new(&bell, inner));
        let row = vec![0.0; columns.padded()];
        Self { bell, line, columns, changes: Vec::new(), row, width: inner, taken: 0 }
    }

    /// Takes the row of the changes. Returns a row of the result, once all rows that it needs were taken: from the first on
    /// twice the reach.
    pub fn take(&mut self) -> Option<&[f32]> {
        self.line.blur(&self.bell, &self.changes, &mut self.row[..self.width]);
        self.columns.next(&self.bell, &self.row);
        self.taken += 1;
        (self.taken > self.bell.last).then(|| &self.columns.shown()[..self.width])
    }
}

#[cfg(test)]
mod tests {
    use super::bell::{MOST_P, fraction};
    use super::*;
    use proptest::prelude::*;

    /// The share of each pixel under the bell, from one end to the other.
    fn weights(radius: f64) -> Vec<f32> {
        let margin = reach(radius) as f64;
        let until = |x: f64| integral(1.5 * x / radius);
        (0..=2 * reach(radius)).map(|k| k as f64 - margin).map(|x| (until(x + 0.5) - until(x - 0.5)) as f32).collect()
    }

    /// The integral of the quadratic B-spline with support from -1.5 to 1.5.
    fn integral(x: f64) -> f64 {
        let tail = |x: f64| x.powi(3) / 6.0;
        match x {
            x if x <= -1.5 => 0.0,
            x if x <= -0.5 => tail(x + 1.5),
            x if x <= 0.5 => 0.5 + 0.75 * x - x.powi(3) / 3.0,
            x if x <= 1.5 => 1.0 - tail(1.5 - x),
            _ => 1.0,
        }
    }

    /// Every pixel as the sum over all weights.
    fn naive(picture: &Raster<f32>, radius: f64) -> Raster<f32> {
        let (weights, margin) = (weights(radius), reach(radius));
        let (width, height) = (picture.width() - 2 * margin, picture.height() - 2 * margin);
        Raster::from_fn(width, height, |x, y| {
            let mut sum = 0.0;
            for (j, down) in weights.iter().enumerate() {
                for (i, across) in weights.iter().enumerate() {
                    sum += down * across * picture.get(x + i, y + j);
                }
            }
            sum
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        #[test]
        fn it_is_the_sum_over_all_weights(radius in 0.02f64..12.0, seed in any::<u32>()) {
            let size = 2 * reach(radius) + 7;
            let value = |x: usize, y: usize| {
                let hash = (x as u32 * 7919 + y as u32 * 104_729).wrapping_add(seed).wrapping_mul(0x9e37_79b9) >> 8;
                (hash % 5) as f32 / 4.0
            };
            let picture = Raster::from_fn(size, size, value);
            let (fast, slow) = (feathered(&picture, radius, &mut || true).unwrap(), naive(&picture, radius));
            for (fast, slow) in fast.data().iter().zip(slow.data()) {
                prop_assert!((fast - slow).abs() < 2e-3, "{radius}: {fast} {slow}");
            }
        }

        #[test]
        fn a_third_of_the_radius_is_nearly_its_fraction(radius in 0.3f64..800.0) {
            let (p, q) = fraction(radius / 3.0);
            prop_assert!(p <= MOST_P + 0.5 && q % 2.0 == 0.0);
            prop_assert!((3.0 * p / q / radius - 1.0).abs() < 5e-3, "{radius} {p} {q}");
            // The differences of the weights sum to zero, and so do their sums. Therefore nothing drifts.
            let bell = Bell::new(radius);
            let sums = |power: i32| bell.taps.iter().map(|(k, value)| (*k as f64).powi(power) * value).sum::<f64>();
            prop_assert_eq!([sums(0), sums(1), sums(2)], [0.0; 3]);
        }
    }

    #[test]
    fn the_sum_does_not_drift_over_a_long_row() {
        let wide = Raster::from_fn(5000, 25, |x, _| if x % 701 < 333 { 1.0 } else { 0.0 });
        let soft = feathered(&wide, 11.3, &mut || true).unwrap();
        assert_eq!(soft.get(200 - reach(11.3), 0), 1.0);
        assert_eq!(soft.get(701 * 7 - 20 - reach(11.3), 0), 0.0);
        let at = |x: usize| soft.get(x - reach(11.3), 0);
        for x in 690..720 {
            assert_eq!(at(x), at(x + 701 * 5));
        }
    }

    #[test]
    fn a_border_becomes_a_rise_of_twice_the_radius() {
        let border = Raster::from_fn(40, 31, |x, _| if x < 20 { 1.0 } else { 0.0 });
        let radius = 5.0;
        let soft = feathered(&border, radius, &mut || true).unwrap();
        let margin = reach(radius);
        assert_eq!((soft.width(), soft.height()), (40 - 2 * margin, 31 - 2 * margin));
        let row = soft.row(9);
        assert!(row.windows(2).all(|pair| pair[0] >= pair[1]));
        let at = |x: usize| row[x - margin];
        assert!((at(14) - 1.0).abs() < 1e-6 && at(26).abs() < 1e-6, "{row:?}");
        assert!((at(19) + at(20) - 1.0).abs() < 1e-5);
    }

    #[test]
    fn weights_sum_to_one_at_any_radius() {
        for radius in [0.01, 0.3, 0.5, 1.0, 2.7, 40.0] {
            let sum: f32 = weights(radius).iter().sum();
            assert!((sum - 1.0).abs() < 1e-5, "{radius} {sum}");
        }
    }

    #[test]
    fn no_radius_changes_nothing_and_it_ends_when_told() {
        let picture = Raster::from_fn(4, 3, |x, y| (x * y) as f32);
        assert_eq!(feathered(&picture, 0.0, &mut || true), Some(picture.clone()));
        assert_eq!(feathered(&picture, 1.0, &mut || false), None);
    }
}
