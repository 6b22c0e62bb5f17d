//! Colours that distinguish parts.

use super::Colour;

/// The colour of part number `index`, sRGB-encoded, 0 to 1. Hues advance by the golden ratio of the circle, so
/// neighbouring indices differ. Saturation and lightness change with each index, so colours of similar hue differ too.
pub fn distinct(index: usize) -> Colour {
    const GOLDEN: f64 = 0.618_033_988_749_895;
    const START: f64 = 0.03;
    let hue = (START + index as f64 * GOLDEN).fract();
    let (saturation, value) = [(0.85, 1.0), (0.95, 0.85), (0.6, 1.0)][index % 3];
    [5.0, 3.0, 1.0].map(|n| {
        let k = (n + hue * 6.0) % 6.0;
        (value * (1.0 - saturation * k.min(4.0 - k).clamp(0.0, 1.0))) as f32
    })
}

/// A colour as `#rrggbb`.
pub fn hex(colour: Colour) -> String {
    let [r, g, b] = colour.map(|c| (c.clamp(0.0, 1.0) * 255.0).round() as u8);
    format!("#{r:02x}{g:02x}{b:02x}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fifty_parts_have_fifty_colours() {
        let colours: Vec<_> = (0..50).map(distinct).collect();
        for (i, a) in colours.iter().enumerate() {
            assert!(a.iter().all(|c| (0.0..=1.0).contains(c)));
            for b in &colours[..i] {
                let difference: f32 = a.iter().zip(b).map(|(x, y)| (x - y).abs()).sum();
                assert!(difference > 0.02, "{i}");
            }
        }
    }

    #[test]
    fn hexadecimal() {
        assert_eq!(hex([1.0, 0.0, 0.5]), "#ff0080");
    }
}
