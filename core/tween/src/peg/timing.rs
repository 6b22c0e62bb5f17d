//! Timing: functions from time, 0 to 1, to the share of a movement that is done.

/// A timing function. It starts at 0 and ends at 1. [`Timing::Constant`] stays at 0 until the end; [`Timing::Custom`]
/// may give its own ends.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Timing {
    /// Stays, and jumps at the end: a hold.
    Constant,
    /// Constant speed.
    #[default]
    Linear,
    /// Starts from rest and becomes faster (quadratic).
    EaseIn,
    /// Becomes slower and ends at rest (quadratic).
    EaseOut,
    /// Starts and ends at rest (cubic).
    EaseInOut,
    /// Starts and ends at rest, half a cosine wave (Parke 1972, for faces).
    Cosine,
    /// A smooth curve through given places (time, share). Times are from 0 to 1; shares may leave that range. The curve
    /// does not overshoot the places (Fritsch & Carlson 1980). The ends (0, 0) and (1, 1) are added where they are
    /// missing.
    Custom(Vec<(f64, f64)>),
    /// Falls like a ball and bounces this many times, at most 30. Each bounce is a quarter as high as the one before.
    Bounce(u32),
}

/// The reason why a timing function is not valid.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum TimingError {
    /// A place of a custom curve has a time outside 0 to 1, or is not finite.
    #[error("place {index} of the curve is ({time}, {share}), expected a time from 0 to 1 and a finite share")]
    Place {
        /// Index of the place.
        index: usize,
        /// The time found.
        time: f64,
        /// The share found.
        share: f64,
    },
    /// The times of a custom curve do not rise.
    #[error("place {index} of the curve is at time {time}, expected a time after the previous")]
    Order {
        /// Index of the place.
        index: usize,
        /// The time found.
        time: f64,
    },
}

impl Timing {
    /// The share of the way at time `u`. Times outside 0 to 1 count as 0 or 1.
    pub fn at(&self, u: f64) -> f64 {
        let u = if u > 0.0 { u.min(1.0) } else { 0.0 };
        match self {
            Self::Constant => f64::from(u8::from(u >= 1.0)),
            Self::Linear => u,
            Self::EaseIn => u * u,
            Self::EaseOut => u * (2.0 - u),
            Self::EaseInOut => u * u * (3.0 - 2.0 * u),
            Self::Cosine => 0.5 - 0.5 * (std::f64::consts::PI * u).cos(),
            Self::Custom(places) => through(places, u),
            Self::Bounce(count) => bounced(*count, u),
        }
    }

    /// Checks the places of a custom curve.
    ///
    /// # Errors
    ///
    /// The first place that is outside the time, is not finite, or does not come after the one before it.
    pub fn check(&self) -> Result<(), TimingError> {
        let Self::Custom(places) = self else { return Ok(()) };
        for (index, &(time, share)) in places.iter().enumerate() {
            if !((0.0..=1.0).contains(&time) && share.is_finite()) {
                return Err(TimingError::Place { index, time, share });
            }
            if index > 0 && places[index - 1].0 >= time {
                return Err(TimingError::Order { index, time });
            }
        }
        Ok(())
    }

    /// The function with a name; `None` for an unknown name. `"bounce"` has three bounces.
    pub fn from_id(id: &str) -> Option<Self> {
        Some(match id {
            "constant" => Self::Constant,
            "linear" => Self::Linear,
            "ease_in" => Self::EaseIn,
            "ease_out" => Self::EaseOut,
            "ease_in_out" => Self::EaseInOut,
            "cosine" => Self::Cosine,
            "bounce" => Self::Bounce(3),
            _ => return None,
        })
    }

    /// The name of the function; `None` for a custom curve.
    pub fn id(&self) -> Option<&'static str> {
        Some(match self {
            Self::Constant => "constant",
            Self::Linear => "linear",
            Self::EaseIn => "ease_in",
            Self::EaseOut => "ease_out",
            Self::EaseInOut => "ease_in_out",
            Self::Cosine => "cosine",
            Self::Bounce(_) => "bounce",
            Self::Custom(_) => return None,
        })
    }
}

/// Slope at a place between two secants, steps `before` and `after` long, so that the curve overshoots neither (Fritsch
/// & Butland 1984): the weighted harmonic mean, 0 where they point apart.
pub(crate) fn monotone_slope(first: f64, second: f64, before: f64, after: f64) -> f64 {
    if first * second <= 0.0 {
        return 0.0;
    }
    let (w1, w2) = (2.0 * after + before, after + 2.0 * before);
    (w1 + w2) / (w1 / first + w2 / second)
}

/// The cubic from 0 to 1 with values and slopes at its ends.
pub(crate) fn hermite(from: f64, to: f64, slopes: (f64, f64), u: f64) -> f64 {
    let v = 1.0 - u;
    from * (1.0 + 2.0 * u) * v * v + to * u * u * (3.0 - 2.0 * u) + u * v * (v * slopes.0 - u * slopes.1)
}

fn through(places: &[(f64, f64)], u: f64) -> f64 {
    let mut all = Vec::with_capacity(places.len() + 2);
    if places.first().is_none_or(|p| p.0 > 0.0) {
        all.push((0.0, 0.0));
    }
    all.extend(places);
    if places.last().is_none_or(|p| p.0 < 1.0) {
        all.push((1.0, 1.0));
    }
    let k = all.partition_point(|p| p.0 <= u).clamp(1, all.len() - 1);
    let step = |k: usize| all[k].0 - all[k - 1].0;
    let secant = |k: usize| (all[k].1 - all[k - 1].1) / step(k);
    let slope = |k: usize| match k {
        0 => secant(1),
        k if k == all.len() - 1 => secant(k),
        k => monotone_slope(secant(k), secant(k + 1), step(k), step(k + 1)),
    };
    let h = step(k);
    hermite(all[k - 1].1, all[k].1, (h * slope(k - 1), h * slope(k)), (u - all[k - 1].0) / h)
}

/// A fall of duration 1, then bounces of durations 1, ½, ¼, …, all scaled to 0..1. A bounce of half the duration is a
/// quarter as high.
fn bounced(count: u32, u: f64) -> f64 {
    let count = count.min(30);
    let total: f64 = 1.0 + (0..count).map(|k| 0.5f64.powi(k as i32)).sum::<f64>();
    let mut time = u * total;
    if time <= 1.0 {
        return time * time;
    }
    time -= 1.0;
    for k in 0..count {
        let duration = 0.5f64.powi(k as i32);
        if time <= duration {
            let x = time / duration;
            return 1.0 - duration * duration * x * (1.0 - x);
        }
        time -= duration;
    }
    1.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn all() -> Vec<Timing> {
        let named = ["constant", "linear", "ease_in", "ease_out", "ease_in_out", "cosine", "bounce"];
        let mut all: Vec<Timing> = named.iter().filter_map(|id| Timing::from_id(id)).collect();
        assert!(all.iter().zip(named).all(|(t, id)| t.id() == Some(id)));
        all.extend([Timing::Bounce(0), Timing::Custom(vec![]), Timing::Custom(vec![(0.3, 0.8), (0.6, 0.7)])]);
        all
    }

    #[test]
    fn all_start_at_zero_and_end_at_one() {
        for timing in all() {
            for (u, expected) in [(-1.0, 0.0), (0.0, 0.0), (1.0, 1.0), (7.0, 1.0), (f64::NAN, 0.0)] {
                assert_eq!(timing.at(u), expected, "{timing:?} {u}");
            }
        }
    }

    #[test]
    fn known_values() {
        let at = |timing: Timing, u: f64| timing.at(u);
        assert_eq!(at(Timing::Constant, 0.99), 0.0);
        assert_eq!(at(Timing::EaseIn, 0.5), 0.25);
        assert_eq!(at(Timing::EaseOut, 0.5), 0.75);
        assert_eq!(at(Timing::EaseInOut, 0.25), 0.15625);
        assert!((at(Timing::Cosine, 1.0 / 3.0) - 0.25).abs() < 1e-15);
        assert_eq!(at(Timing::Custom(vec![(0.3, 0.8), (0.6, 0.7)]), 0.3), 0.8);
        // One bounce takes as long as the fall. It turns a quarter of the way up.
        assert_eq!(at(Timing::Bounce(1), 0.5), 1.0);
        assert_eq!(at(Timing::Bounce(1), 0.75), 0.75);
    }

    #[test]
    fn wrong_curves_are_named() {
        let said = |places: Vec<(f64, f64)>| Timing::Custom(places).check().unwrap_err().to_string();
        assert!(said(vec![(0.5, f64::NAN)]).starts_with("place 0 of the curve is (0.5, NaN)"));
        assert!(said(vec![(0.5, 0.1), (0.5, 0.2)]).starts_with("place 1 of the curve is at time 0.5"));
        assert!(said(vec![(1.5, 0.1)]).contains("expected a time from 0 to 1"));
    }

    proptest! {
        #[test]
        fn custom_curves_that_rise_stay_rising(shares in prop::collection::vec(0.0f64..1.0, 1..6), u in 0.0f64..1.0) {
            let mut shares = shares;
            shares.sort_by(f64::total_cmp);
            let count = shares.len() as f64 + 1.0;
            let curve = Timing::Custom(shares.iter().enumerate().map(|(k, &s)| ((k + 1) as f64 / count, s)).collect());
            prop_assert!(curve.at(u + 0.01) >= curve.at(u) - 1e-12);
        }
    }
}
