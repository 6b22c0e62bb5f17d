//! The falloff of a soft border: other courses than that of the blur.
//!
//! A blurred border rises as the sum of the bell ([`super`]) from 0 to 1. The value of a pixel therefore says where it lies
//! between the two ends of the border, and leads to the value of another course there. Both are rising, so the order of values stays, 0
//! stays 0, and 1 stays 1. Where borders meet, as at a corner or in a thin limb, the blurred value counts in the same way.
//!
//! Values are taken from tables. Their places are even within each power of two of the value, or of what is missing to 1, since
//! courses are steep at their ends. Between two places values are linear.
//!
//! Limits: values of the blur are multiples of 2⁻²⁰. A course that is steep at its end begins there with a step.

use rototoon_base::scene::{Falloff, FalloffCurve};

/// Powers of two from the least place of a table to ½.
const OCTAVES: u32 = 20;
/// Places in each, as a power of two.
const PLACES: u32 = 6;
/// Number of a place's bits that lie between it and the next one.
const BETWEEN: u32 = f32::MANTISSA_DIGITS - 1 - PLACES;
/// The least place.
const LEAST: f32 = 1.0 / (1u32 << (OCTAVES + 1)) as f32;
/// Number of places, ½ included.
const COUNT: usize = (OCTAVES << PLACES) as usize + 1;

/// Values of a border for those of a blurred one.
#[derive(Clone, Debug, PartialEq)]
pub struct Ramp {
    /// For blurred values up to ½.
    low: Vec<f32>,
    /// For what higher ones lack to 1.
    high: Vec<f32>,
}

impl Ramp {
    /// The values of a falloff; `None` if it is that of the blur.
    pub fn new(falloff: Falloff) -> Option<Self> {
        if falloff.is_plain() || falloff.rate.is_nan() {
            return None;
        }
        let (rate, curve) = (falloff.rate.clamp(1e-3, 1e3), falloff.curve.unwrap_or_default());
        let places = (0..COUNT as u32).map(|k| f64::from(f32::from_bits(LEAST.to_bits() + (k << BETWEEN))));
        let low = places.clone().map(|below| risen(below, curve, rate) as f32).collect();
        let high = places.map(|lack| risen(1.0 - lack, curve, rate) as f32).collect();
        Some(Self { low, high })
    }

    /// The value for a blurred one.
    #[inline]
    pub fn value(&self, blurred: f32) -> f32 {
        if blurred <= 0.0 || blurred >= 1.0 {
            return blurred;
        }
        if blurred <= 0.5 { looked_up(&self.low, 0.0, blurred) } else { looked_up(&self.high, 1.0, 1.0 - blurred) }
    }

    /// Replaces blurred values.
    pub fn apply(&self, values: &mut [f32]) {
        values.iter_mut().for_each(|value| *value = self.value(*value));
    }
}

/// The value of a table at a place above 0, at which it has the value `end`.
#[inline]
fn looked_up(table: &[f32], end: f32, place: f32) -> f32 {
    let (from, to, share) = if place < LEAST {
        (end, table[0], place / LEAST)
    } else {
        let bits = place.to_bits() - LEAST.to_bits();
        let index = ((bits >> BETWEEN) as usize).min(COUNT - 1);
        let rest = bits & ((1 << BETWEEN) - 1);
        (table[index], table[(index + 1).min(COUNT - 1)], rest as f32 / (1u32 << BETWEEN) as f32)
    };
    // Rounding must not lead beyond the next place.
    (from + share * (to - from)).clamp(from.min(to), from.max(to))
}

/// The value of a border at the place at which a blurred one has a value.
fn risen(blurred: f64, curve: FalloffCurve, rate: f64) -> f64 {
    let value = match curve {
        FalloffCurve::Smooth => blurred,
        FalloffCurve::Linear => place(blurred),
        FalloffCurve::EaseIn => {
            let t = place(blurred);
            t * t * (2.0 - t)
        }
        FalloffCurve::EaseOut => {
            let t = place(blurred);
            t * (1.0 + t - t * t)
        }
    };
    value.clamp(0.0, 1.0).powf(rate)
}

/// The place between the ends of a blurred border, 0 to 1, at which it has a value: the inverse of the bell's sum.
fn place(value: f64) -> f64 {
    if value < 1.0 / 6.0 {
        (6.0 * value).cbrt() / 3.0
    } else if value > 5.0 / 6.0 {
        1.0 - (6.0 * (1.0 - value)).cbrt() / 3.0
    } else {
        // The middle piece is a cubic with three real roots; this one is between -½ and ½.
        let x = 3f64.sqrt() * ((4.0 / 3f64.sqrt() * (value - 0.5)).clamp(-1.0, 1.0).asin() / 3.0).sin();
        (x + 1.5) / 3.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The sum of the bell at a place between the ends of a border.
    fn bell(t: f64) -> f64 {
        let x = 3.0 * t - 1.5;
        if x < -0.5 {
            (x + 1.5).powi(3) / 6.0
        } else if x > 0.5 {
            1.0 - (1.5 - x).powi(3) / 6.0
        } else {
            0.5 + 0.75 * x - x.powi(3) / 3.0
        }
    }

    fn falloff(curve: usize, rate: f64) -> Falloff {
        Falloff { rate, curve: Some(FalloffCurve::ALL[curve].0) }
    }

    #[test]
    fn the_course_of_the_blur_needs_no_table() {
        assert_eq!(Ramp::new(Falloff::default()), None);
        assert_eq!(Ramp::new(falloff(0, 1.0)), None);
        assert_eq!(Ramp::new(falloff(1, f64::NAN)), None);
        assert!(Ramp::new(falloff(1, 1.0)).is_some() && Ramp::new(falloff(0, 1.1)).is_some());
    }

    #[test]
    fn the_ends_stay_and_the_middle_is_known() {
        for (curve, rate, middle) in [(1, 1.0, 0.5), (1, 2.0, 0.25), (0, 2.0, 0.25), (2, 1.0, 0.375), (3, 1.0, 0.625)] {
            let ramp = Ramp::new(falloff(curve, rate)).unwrap();
            assert_eq!([0.0, 1.0].map(|value| ramp.value(value)), [0.0, 1.0]);
            assert!((ramp.value(0.5) - middle).abs() < 1e-6, "{curve} {rate}: {}", ramp.value(0.5));
        }
    }

    proptest! {
        #[test]
        fn it_is_the_course_itself_and_never_falls(
            curve in 0usize..4, rate in 0.1f64..10.0, places in prop::collection::vec(0.0f64..=1.0, 40),
        ) {
            let Some(ramp) = Ramp::new(falloff(curve, rate)) else { return Ok(()) };
            let mut last = (0.0f32, 0.0f32);
            let mut blurred: Vec<f32> = places.iter().map(|t| bell(*t) as f32).collect();
            blurred.sort_by(f32::total_cmp);
            for value in blurred {
                let found = ramp.value(value);
                prop_assert!((0.0..=1.0).contains(&found) && found >= last.1, "{:?} {} {}", last, value, found);
                last = (value, found);
                // Steps of the blur's values.
                if (1e-6..1.0 - 1e-6).contains(&value) {
                    let wanted = risen(f64::from(value), FalloffCurve::ALL[curve].0, rate);
                    prop_assert!((f64::from(found) - wanted).abs() < 2e-4, "{} {} {}", value, found, wanted);
                }
            }
        }

        #[test]
        fn a_value_of_the_blur_says_where_it_lies(t in 0.0f64..=1.0) {
            prop_assert!((place(bell(t)) - t).abs() < 1e-5);
        }

        #[test]
        fn neighbouring_values_keep_their_order(curve in 0usize..4, rate in 0.1f64..10.0, start in 0u32..0x3f7f_0000) {
            let Some(ramp) = Ramp::new(falloff(curve, rate)) else { return Ok(()) };
            let mut last = ramp.value(f32::from_bits(start));
            for bits in start + 1..start + 2000 {
                let next = ramp.value(f32::from_bits(bits));
                prop_assert!(next >= last);
                last = next;
            }
        }
    }
}
