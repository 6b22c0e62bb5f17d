//! The weights of a blur, as differences that are exact integers.

use super::reach;

/// Greatest P: 48 P³ times the steps of a value stays below 2⁵³.
pub const MOST_P: f64 = 562.0;
/// Greatest Q.
const MOST_Q: i64 = 1024;

/// Number of taps of a group: at each place where pieces meet there are as many.
pub const GROUP: usize = 4;

/// The third differences of the weights of the bell.
pub struct Bell {
    /// Position and value of those that are not zero.
    pub taps: Vec<(usize, f64)>,
    /// The same in groups of neighbours: the position of the first, and the values.
    pub groups: Vec<(usize, [f64; GROUP])>,
    /// The inverse of the sum of the weights.
    share: f64,
    /// Number of weights minus one: twice the reach.
    pub last: usize,
}

impl Bell {
    pub fn new(radius: f64) -> Self {
        let (p, q) = fraction(radius / 3.0);
        let cube = |x: f64| x.max(0.0).powi(3);
        // The truncated powers that form a quadratic B-spline with knots at -3P, -P, P and 3P, in units of 1/Q pixel.
        let until = |x: f64| cube(x + 3.0 * p) - 3.0 * cube(x + p) + 3.0 * cube(x - p) - cube(x - 3.0 * p);
        let reach = reach(radius);
        let weight = |k: usize| {
            let x = (k as f64 - reach as f64) * q;
            until(x + 0.5 * q) - until(x - 0.5 * q)
        };
        let weights: Vec<f64> = (0..=2 * reach).map(weight).collect();
        let at = |k: usize, back: usize| k.checked_sub(back).and_then(|k| weights.get(k)).copied().unwrap_or(0.0);
        let difference = |k: usize| at(k, 0) - 3.0 * at(k, 1) + 3.0 * at(k, 2) - at(k, 3);
        let taps: Vec<(usize, f64)> =
            (0..=2 * reach + 3).map(|k| (k, difference(k))).filter(|(_, value)| *value != 0.0).collect();
        let mut groups: Vec<(usize, [f64; GROUP])> = Vec::new();
        for &(k, value) in &taps {
            match groups.last_mut() {
                Some((first, values)) if k < *first + GROUP => values[k - *first] = value,
                _ => groups.push((k, [value, 0.0, 0.0, 0.0])),
            }
        }
        Self { taps, groups, share: 1.0 / (48.0 * p.powi(3)), last: 2 * reach }
    }

    /// A sum of values times weights as an integer number of steps.
    #[inline(always)]
    pub fn rounded(&self, sum: f64) -> f32 {
        // A float this large has no bits below one, so the sum with it is rounded.
        const WHOLE: f64 = 3.0 * (1u64 << 51) as f64;
        ((sum * self.share + WHOLE) - WHOLE) as f32
    }
}

/// P and an even Q whose quotient is nearest to a number. Q is as large as possible within a factor of two.
pub fn fraction(number: f64) -> (f64, f64) {
    let most = ((MOST_P / number) as i64).clamp(2, MOST_Q) / 2;
    let off = |half: i64| {
        let q = 2.0 * half as f64;
        ((number * q).round().max(1.0) / q - number).abs()
    };
    let best = (most / 2 + 1..=most).min_by(|&a, &b| off(a).total_cmp(&off(b))).unwrap_or(most);
    let q = 2.0 * best as f64;
    ((number * q).round().max(1.0), q)
}
