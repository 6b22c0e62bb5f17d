//! Values of a part that say how it looks.

use super::shape::{Context, List, Number, Scalar, Shape};
use rototoon_base::scene::FalloffCurve;
use serde::de::SeqAccess;

/// The id of a falloff's curve.
#[derive(Clone, Copy)]
pub(super) struct Curve;

impl Shape<'_> for Curve {
    type Value = FalloffCurve;
    const EXPECTED: &'static str = "\"smooth\", \"linear\", \"ease_in\" or \"ease_out\"";

    fn scalar(self, context: &mut Context, scalar: Scalar<'_>) -> Option<FalloffCurve> {
        let found = match scalar {
            Scalar::Text(text) => FalloffCurve::from_id(text),
            _ => None,
        };
        if found.is_none() {
            context.wrong(scalar, Self::EXPECTED);
        }
        found
    }
}

/// A colour `[red, green, blue]`, each from 0 to 1.
#[derive(Clone, Copy)]
pub(super) struct Shade;

impl<'de> Shape<'de> for Shade {
    type Value = [f64; 3];
    const EXPECTED: &'static str = "a colour [red, green, blue], each from 0 to 1";

    fn list<A: SeqAccess<'de>>(self, context: &mut Context, items: A) -> Result<Option<[f64; 3]>, A::Error> {
        let Some(values) = List(Number).list(context, items)? else { return Ok(None) };
        match values[..] {
            [r, g, b] if values.iter().all(|value| (0.0..=1.0).contains(value)) => Ok(Some([r, g, b])),
            _ => {
                let shown: Vec<String> = values.iter().take(4).map(f64::to_string).collect();
                context.wrong(format_args!("[{}]", shown.join(", ")), Self::EXPECTED);
                Ok(None)
            }
        }
    }
}
