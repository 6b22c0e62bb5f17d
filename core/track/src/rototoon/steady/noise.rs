//! Tells noise from motion.
//!
//! Let x be a series of which each entry has independent noise of variance r, while the second differences of its motion are
//! independent of each other, with variance q. The second differences Δ of x then have the variance q + 6 r, and their sums by
//! neighbours, Δ + Δ', have 2 q + 4 r, since the noise of neighbours cancels in part. So both follow from two measured variances.
//! They are measured by medians of absolute values, because drawn changes are few and large.
//!
//! **Limits.** Even motion, whose second differences have the same sign for long, gives no noise at all: a lower bound.

use rototoon_base::numeric::median::median;

/// From a median of absolute values to a standard deviation.
const DEVIATION: f64 = 1.4826;

/// The variances of a kind of series, in square working pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Split {
    /// Of an entry's noise.
    pub noise: f64,
    /// Of the motion's second difference.
    pub motion: f64,
}

impl Split {
    /// Both variances, rounded to powers of two.
    pub fn in_steps(self) -> Self {
        let rounded = |x: f64| if x > 0.0 { 2f64.powi(x.log2().round() as i32) } else { x };
        Self { noise: rounded(self.noise), motion: rounded(self.motion) }
    }
}

/// Second differences of many series.
#[derive(Clone, Debug, Default)]
pub struct Differences {
    single: Vec<f64>,
    sums: Vec<f64>,
}

/// The weights of three drawings in the second difference around the middle one. At even times they are 1, −2, 1.
pub fn weights(times: &[f64]) -> [f64; 3] {
    let (before, after) = (1.0 / (times[1] - times[0]), 1.0 / (times[2] - times[1]));
    let both = before + after;
    [2.0 * before / both, -2.0, 2.0 * after / both]
}

/// The second differences of a series around all drawings but the first and the last.
pub fn second_differences(times: &[f64], series: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let around = |(times, three): (&[f64], &[Vec<f64>])| {
        let [a, b, c] = weights(times);
        (0..three[1].len()).map(|k| a * three[0][k] + b * three[1][k] + c * three[2][k]).collect()
    };
    times.windows(3).zip(series.windows(3)).map(around).collect()
}

impl Differences {
    /// Adds the second differences of a series.
    pub fn add(&mut self, times: &[f64], series: &[Vec<f64>]) {
        let found = second_differences(times, series);
        self.single.extend(found.iter().flatten().map(|x| x.abs()));
        let sum =
            |pair: &[Vec<f64>]| -> Vec<f64> { pair[0].iter().zip(&pair[1]).map(|(a, b)| (a + b).abs()).collect() };
        self.sums.extend(found.windows(2).flat_map(sum));
    }

    /// Noise and motion of all that was added.
    pub fn split(&self) -> Split {
        let (single, sums) = (variance(&self.single), variance(&self.sums));
        let noise = if self.sums.is_empty() { 0.0 } else { ((2.0 * single - sums) / 8.0).max(0.0) };
        Split { noise, motion: (single - 6.0 * noise).max(0.0) }
    }

    /// The variance of the second differences.
    pub fn variance(&self) -> f64 {
        variance(&self.single)
    }
}

/// The variance that absolute values have, by their median.
fn variance(values: &[f64]) -> f64 {
    (DEVIATION * median(values.to_vec())).powi(2)
}

#[cfg(test)]
mod tests {
    use super::super::tests::Random;
    use super::*;

    /// A series of two numbers whose second differences and noise have these variances.
    fn series(random: &mut Random, count: usize, split: Split) -> Vec<Vec<f64>> {
        let (mut place, mut speed) = ([0.0; 2], [0.0; 2]);
        let mut next = |_| {
            for k in 0..2 {
                speed[k] += random.normal() * split.motion.sqrt();
                place[k] += speed[k];
            }
            place.iter().map(|x| x + random.normal() * split.noise.sqrt()).collect()
        };
        (0..count).map(&mut next).collect()
    }

    #[test]
    fn noise_and_motion_are_told_apart() {
        let mut random = Random::new(1);
        for (noise, motion) in [(0.5, 2.0), (1.0, 0.2), (0.0, 3.0), (0.3, 0.3)] {
            let mut differences = Differences::default();
            let times: Vec<f64> = (0..30).map(f64::from).collect();
            for _ in 0..200 {
                differences.add(&times, &series(&mut random, 30, Split { noise, motion }));
            }
            let found = differences.split();
            assert!((found.noise - noise).abs() < 0.05 + 0.1 * noise, "{found:?} for {noise}, {motion}");
            assert!((found.motion - motion).abs() < 0.15 + 0.2 * motion, "{found:?} for {noise}, {motion}");
        }
    }

    #[test]
    fn few_large_changes_are_no_noise() {
        let mut differences = Differences::default();
        let times: Vec<f64> = (0..12).map(f64::from).collect();
        let jump = |d: usize| vec![if d < 6 { 0.0 } else { 40.0 }];
        differences.add(&times, &(0..12).map(jump).collect::<Vec<_>>());
        assert_eq!(differences.split(), Split::default());
    }

    #[test]
    fn even_motion_has_no_second_difference_at_uneven_times() {
        let times = [3.0, 4.0, 6.5, 7.0, 11.0];
        let line: Vec<Vec<f64>> = times.iter().map(|t| vec![2.0 * t - 1.0, -t]).collect();
        assert!(second_differences(&times, &line).iter().flatten().all(|x| x.abs() < 1e-12));
        assert_eq!(weights(&[0.0, 1.0, 2.0]), [1.0, -2.0, 1.0]);
    }

    #[test]
    fn variances_that_differ_little_are_the_same_step() {
        let split = |noise, motion| Split { noise, motion }.in_steps();
        assert_eq!(split(0.5, 2.2), Split { noise: 0.5, motion: 2.0 });
        assert_eq!(split(0.45, 1.9), split(0.55, 2.1));
        assert_ne!(split(0.5, 2.0).noise, split(1.0, 2.0).noise);
        assert_eq!(split(0.0, 0.0), Split::default());
    }

    #[test]
    fn too_few_drawings_have_no_noise() {
        let mut differences = Differences::default();
        differences.add(&[0.0, 1.0, 2.0], &[vec![0.0], vec![3.0], vec![0.0]]);
        assert_eq!(differences.split().noise, 0.0);
        assert_eq!(Differences::default().split(), Split::default());
    }
}
