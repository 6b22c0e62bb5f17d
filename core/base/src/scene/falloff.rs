//! How a soft border falls off.
//!
//! Let `t` run from 0 where a border begins, outside, to 1 where it ends, inside. The coverage is a curve of `t`, raised to
//! the rate. A rate above 1 lets the border fall off faster, so that less of it shows; one below 1 lets it reach further.
//! The rates of a document, of a part's settings and of all parts are multiplied.

/// The course of a border with rate 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum FalloffCurve {
    /// Smooth at both ends: the blur of a sharp border.
    #[default]
    Smooth,
    /// Even: `t`.
    Linear,
    /// Smooth outside, even inside: `t² (2 − t)`.
    EaseIn,
    /// Even outside, smooth inside: `t (1 + t − t²)`.
    EaseOut,
}

impl FalloffCurve {
    /// All curves with their ids and labels.
    pub const ALL: [(Self, &str, &str); 4] = [
        (Self::Smooth, "smooth", "Smooth"),
        (Self::Linear, "linear", "Linear"),
        (Self::EaseIn, "ease_in", "Ease in"),
        (Self::EaseOut, "ease_out", "Ease out"),
    ];

    /// The curve with an id.
    pub fn from_id(id: &str) -> Option<Self> {
        Self::ALL.iter().find(|(_, known, _)| *known == id).map(|(curve, ..)| *curve)
    }

    /// Its id.
    pub fn id(self) -> &'static str {
        Self::ALL.iter().find(|(curve, ..)| *curve == self).map_or("", |(_, id, _)| *id)
    }
}

/// How the border of a part, or of all parts, falls off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Falloff {
    /// The power of the curve, from [`Falloff::LEAST`] to [`Falloff::MOST`].
    pub rate: f64,
    /// The curve; `None` leaves it to what is said of all parts.
    pub curve: Option<FalloffCurve>,
}

impl Default for Falloff {
    fn default() -> Self {
        Self { rate: 1.0, curve: None }
    }
}

impl Falloff {
    /// Least rate.
    pub const LEAST: f64 = 0.1;
    /// Greatest rate.
    pub const MOST: f64 = 10.0;

    /// Both together: rates are multiplied, and the own curve comes before that of `all`.
    #[must_use]
    pub fn within(self, all: Self) -> Self {
        Self { rate: self.rate * all.rate, curve: self.curve.or(all.curve) }
    }

    /// Whether a border is the blur of a sharp one.
    pub fn is_plain(self) -> bool {
        self.rate == 1.0 && self.curve.unwrap_or_default() == FalloffCurve::Smooth
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_lead_to_their_curves_and_the_own_curve_comes_first() {
        for (curve, id, _) in FalloffCurve::ALL {
            assert_eq!((FalloffCurve::from_id(id), curve.id()), (Some(curve), id));
        }
        assert_eq!(FalloffCurve::from_id("Linear"), None);
        let all = Falloff { rate: 2.0, curve: Some(FalloffCurve::Linear) };
        assert_eq!(Falloff { rate: 0.5, curve: None }.within(all), Falloff { rate: 1.0, ..all });
        let own = Falloff { rate: 0.5, curve: Some(FalloffCurve::Smooth) };
        assert!(own.within(all).is_plain() && Falloff::default().is_plain() && !all.is_plain());
    }
}
