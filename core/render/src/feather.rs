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
//! Limits: for radii above about 800 pixels sums may round.
//!
//! Source: P. S. Heckbert: Filtering by repeated integration. SIGGRAPH, 1986.

use rototoon_base::numeric::vector::vectorised;
use rototoon_base::scene::Raster;
use std::collections::VecDeque;
use std::ops::Range;

/// Steps of a value from 0 to 1.
const STEPS: f32 = (1 << 20) as f32;
/// Greatest P: 48 P³ times the steps of a value stays below 2⁵³.
const MOST_P: f64 = 562.0;
/// Greatest Q.
const MOST_Q: i64 = 1024;
/// Number of columns that are checked together for changes.
const STRIP: usize = 32;

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
    let bell = Bell::new(radius);
    let width = picture.width().saturating_sub(2 * margin);
    let mut rows = Raster::new(width, picture.height(), 0.0f32);
    let mut line = Line::new(&bell, picture.width());
    for y in 0..picture.height() {
        if !go_on() {
            return None;
        }
        line.blur(&bell, picture.row(y), rows.row_mut(y));
    }
    let mut result = Raster::new(width, picture.height().saturating_sub(2 * margin), 0.0f32);
    columns(&bell, &rows, &mut result, go_on).then_some(result)
}

/// The third differences of the weights of the bell.
struct Bell {
    /// Position and value of those that are not zero.
    taps: Vec<(usize, f64)>,
    /// The inverse of the sum of the weights.
    share: f64,
    /// Number of weights minus one: twice the reach.
    last: usize,
}

impl Bell {
    fn new(radius: f64) -> Self {
        let (p, q) = fraction(radius / 3.0);
        let cube = |x: f64| x.max(0.0).powi(3);
        // The truncated powers that form a quadratic B-spline with knots at -3P, -P, P and 3P, in units of
        //         1/Q pixel.
        let until = |x: f64| cube(x + 3.0 * p) - 3.0 * cube(x + p) + 3.0 * cube(x - p) - cube(x - 3.0 * p);
        let reach = reach(radius);
        let weight = |k: usize| {
            let x = (k as f64 - reach as f64) * q;
            until(x + 0.5 * q) - until(x - 0.5 * q)
        };
        let weights: Vec<f64> = (0..=2 * reach).map(weight).collect();
        let at = |k: usize, back: usize| k.checked_sub(back).and_then(|k| weights.get(k)).copied().unwrap_or(0.0);
        let difference = |k: usize| at(k, 0) - 3.0 * at(k, 1) + 3.0 * at(k, 2) - at(k, 3);
        let taps = (0..=2 * reach + 3).map(|k| (k, difference(k))).filter(|(_, value)| *value != 0.0).collect();
        Self { taps, share: 1.0 / (48.0 * p.powi(3)), last: 2 * reach }
    }

    /// A sum of values times weights as an integer number of steps.
    #[inline(always)]
    fn rounded(&self, sum: f64) -> f32 {
        (sum * self.share + 0.5) as i32 as f32
    }
}

/// P and an even Q whose quotient is nearest to a number. Q is as large as possible within a factor of two.
fn fraction(number: f64) -> (f64, f64) {
    let most = ((MOST_P / number) as i64).clamp(2, MOST_Q) / 2;
    let off = |half: i64| {
        let q = 2.0 * half as f64;
        ((number * q).round().max(1.0) / q - number).abs()
    };
    let best = (most / 2 + 1..=most).min_by(|&a, &b| off(a).total_cmp(&off(b))).unwrap_or(most);
    let q = 2.0 * best as f64;
    ((number * q).round().max(1.0), q)
}

/// A value of at least 0 as an integer number of steps. Truncation is faster than rounding and gives the same result.
#[inline(always)]
fn in_steps(value: f32) -> f32 {
    (value * STEPS + 0.5) as i32 as f32
}

/// Buffers for one row.
struct Line {
    /// The differences of the row, filtered with the taps.
    filtered: Vec<f64>,
    /// The ranges in which they may differ from zero.
    stretches: Vec<Range<usize>>,
}

impl Line {
    fn new(bell: &Bell, width: usize) -> Self {
        Self { filtered: vec![0.0; width + bell.last + 4], stretches: Vec::new() }
    }

    fn blur(&mut self, bell: &Bell, from: &[f32], to: &mut [f32]) {
        self.find(bell, from);
        let mut sums = [0.0; 4];
        let mut done = 0;
        for stretch in &self.stretches {
            let start = stretch.start.saturating_sub(bell.last).min(to.len());
            // Without changes the row stays constant.
            to[done.min(start)..start].fill(bell.rounded(sums[3]));
            for n in stretch.clone() {
                let sum = summed(&mut sums, std::mem::take(&mut self.filtered[n]));
                if let Some(to) = n.checked_sub(bell.last).and_then(|at| to.get_mut(at)) {
                    *to = bell.rounded(sum);
                }
            }
            done = stretch.end.saturating_sub(bell.last).min(to.len());
        }
        to[done..].fill(bell.rounded(sums[3]));
    }

    /// Filters the differences of a row.
    fn find(&mut self, bell: &Bell, from: &[f32]) {
        self.stretches.clear();
        let mut before = 0.0;
        let mut same = None;
        for (n, value) in from.iter().enumerate() {
            if same == Some(*value) {
                continue;
            }
            same = Some(*value);
            let step = in_steps(*value);
            let change = f64::from(step - before);
            before = step;
            bell.taps.iter().for_each(|&(ahead, weight)| self.filtered[n + ahead] += weight * change);
            let end = n + bell.last + 4;
            match self.stretches.last_mut() {
                Some(last) if last.end >= n => last.end = end,
                _ => self.stretches.push(n..end),
            }
        }
    }
}

#[inline(always)]
fn summed(sums: &mut [f64; 4], value: f64) -> f64 {
    sums[0] += value;
    sums[1] += sums[0];
    sums[2] += sums[1];
    sums[3] += sums[2];
    sums[3]
}

/// State of some neighbouring columns on the way down.
#[derive(Clone)]
struct Strip {
    /// For each column the filtered differences, summed one to four times.
    sums: [[f64; STRIP]; 4],
    /// Whether each row within the reach of the taps differs from the row before it; the latest row first.
    changed: VecDeque<bool>,
    /// Whether all sums but the last are zero, so that the last one stays constant.
    still: bool,
    /// The latest row of the result.
    shown: [f32; STRIP],
}

impl Strip {
    fn new(bell: &Bell) -> Self {
        Self {
            sums: [[0.0; STRIP]; 4],
            changed: VecDeque::from(vec![false; bell.last + 4]),
            still: true,
            shown: [0.0; STRIP],
        }
    }

    /// Adds the next row, `rows[at][columns]`.
    #[inline(always)]
    fn next(&mut self, bell: &Bell, rows: &Raster<f32>, at: usize, columns: &Range<usize>) {
        let row = |y: usize| &rows.row(y)[columns.clone()];
        let changed = if at == 0 { row(0).iter().any(|v| *v != 0.0) } else { row(at) != row(at - 1) };
        self.changed.pop_back();
        self.changed.push_front(changed);
        let mut filtered = [0.0; STRIP];
        for &(back, weight) in bell.taps.iter().filter(|(back, _)| self.changed[*back]) {
            self.still = false;
            let now = row(at - back).iter();
            if at == back {
                now.zip(&mut filtered).for_each(|(now, sum)| *sum += weight * f64::from(*now));
            } else {
                let pairs = now.zip(row(at - back - 1)).zip(&mut filtered);
                pairs.for_each(|((now, before), sum)| *sum += weight * f64::from(now - before));
            }
        }
        if self.still {
            return;
        }
        let [once, twice, thrice, whole] = &mut self.sums;
        let mut left = 0.0;
        for k in 0..STRIP {
            once[k] += filtered[k];
            twice[k] += once[k];
            thrice[k] += twice[k];
            whole[k] += thrice[k];
            left += once[k].abs() + twice[k].abs() + thrice[k].abs();
            self.shown[k] = bell.rounded(whole[k]) / STEPS;
        }
        self.still = left == 0.0;
    }
}

/// Blurs the columns of rows given in steps. Returns whether `go_on` never stopped it.
fn columns(bell: &Bell, rows: &Raster<f32>, result: &mut Raster<f32>, go_on: &mut dyn FnMut() -> bool) -> bool {
    let width = rows.width();
    let mut strips = vec![Strip::new(bell); width.div_ceil(STRIP)];
    for n in 0..rows.height() {
        if !go_on() {
            return false;
        }
        vectorised(|| {
            for (strip, left) in strips.iter_mut().zip((0..width).step_by(STRIP)) {
                let own = left..width.min(left + STRIP);
                strip.next(bell, rows, n, &own);
                if let Some(y) = n.checked_sub(bell.last) {
                    let count = own.len();
                    result.row_mut(y)[own].copy_from_slice(&strip.shown[..count]);
                }
            }
        });
    }
    true
}

#[cfg(test)]
mod tests {
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
                let hash = (x as u32 * 7919 + y as u32 * 104_729 + seed).wrapping_mul(0x9e37_79b9) >> 8;
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
