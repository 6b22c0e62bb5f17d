//! Lengths in SVG documents.
//!
//! A length is a number of units of the element, a number with an absolute unit (96 px are an inch), or a share of what the nearest `svg` shows.
//! Sizes of fonts are not known here, so lengths in `em` and the like are none.
//!
//! Source: W3C, Scalable Vector Graphics (SVG) 2, chapter on coordinate systems, "Units".

use super::svg_view::View;
use std::str::FromStr;
use svgtypes::{Length, LengthUnit};

/// What a share refers to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Along {
    /// The width of the view.
    X,
    /// Its height.
    Y,
    /// Its diagonal, ∕ √2.
    Both,
}

/// A length in units of the element. `None` if the text is none, or is not finite.
pub(super) fn length(text: &str, view: &View, along: Along) -> Option<f64> {
    let size = match along {
        Along::X => view.width,
        Along::Y => view.height,
        Along::Both => (0.5 * (view.width * view.width + view.height * view.height)).sqrt(),
    };
    scaled(text, size)
}

/// A length of which a hundred per cent are `whole`.
pub(super) fn scaled(text: &str, whole: f64) -> Option<f64> {
    let Length { number, unit } = Length::from_str(&text.trim().to_ascii_lowercase()).ok()?;
    let unit = match unit {
        LengthUnit::None | LengthUnit::Px => 1.0,
        LengthUnit::In => 96.0,
        LengthUnit::Cm => 96.0 / 2.54,
        LengthUnit::Mm => 96.0 / 25.4,
        LengthUnit::Pt => 96.0 / 72.0,
        LengthUnit::Pc => 16.0,
        LengthUnit::Percent => whole / 100.0,
        LengthUnit::Em | LengthUnit::Ex => return None,
    };
    Some(number * unit).filter(|length| length.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_and_shares_are_pixels() {
        let view = View { width: 60.0, height: 80.0 };
        let x = |text: &str| length(text, &view, Along::X);
        for (text, found) in [
            ("12", 12.0),
            (" -1.5px ", -1.5),
            ("1in", 96.0),
            ("2.54cm", 96.0),
            ("25.4MM", 96.0),
            ("72pt", 96.0),
            ("6pc", 96.0),
            ("50%", 30.0),
            ("1e2", 100.0),
        ] {
            assert!((x(text).unwrap() - found).abs() < 1e-12, "{text}: {:?}", x(text));
        }
        for text in ["", "a", "12 px", "1em", "2ex", "NaN", "inf", "1e999", "calc(1px)", "auto", "3furlongs"] {
            assert_eq!(x(text), None, "{text}");
        }
        assert_eq!(length("50%", &view, Along::Y), Some(40.0));
        assert!((length("10%", &view, Along::Both).unwrap() - 50f64.sqrt()).abs() < 1e-12);
    }
}
