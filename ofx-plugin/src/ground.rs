//! What lies behind transparent pixels where the core sees a source.
//!
//! Trackers and filters know no transparency. On the transparent black of a cel, black lines could not be seen. So pictures are
//! laid over the paper on which their lines stand out, or over a mid grey, as the command line's are
//! ([`rototoon::pictures::backdrop`]). Pixels are blended as the host blends them: linear floats as light, other values as
//! they are encoded.
//!
//! Some hosts give a picture without alpha as one whose alpha is zero, and an alpha may have been put beside the colours of
//! another picture. There the colours do not go with the alpha, and nothing is blended.

use crate::encoding::Encoding;
use crate::pixels::Pixel;
use rototoon::image::colour::decode;
use rototoon::pictures::backdrop;
use rototoon::scene::{Colour, Raster};

/// Pixels with less alpha may show what lies behind them.
const OPAQUE: f32 = 0.5;
/// A colour that exceeds its alpha by more is not multiplied by it, or it is light that was added.
const BEYOND: f32 = 0.02;
/// So few pixels say nothing of a picture.
const FEW: usize = 64;

/// What lies behind transparent pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ground {
    /// Nothing: alpha says nothing of the colours.
    Unused,
    /// A grey, sRGB-encoded.
    Grey(f32),
}

impl Ground {
    /// The ground of premultiplied pixels; `None` if they show next to nothing, such as an empty cel.
    pub fn of(pixels: &Raster<Pixel>, encoding: Encoding) -> Option<Self> {
        if is_beside_alpha(pixels.data()) {
            return Some(Self::Unused);
        }
        let number = |value: f32| if value.is_nan() { 0.0 } else { value.clamp(f32::MIN, f32::MAX) };
        let light = |pixel: &Pixel| {
            let [r, g, b, alpha] = encoding.to_light(pixel.map(number));
            [r, g, b, alpha.clamp(0.0, 1.0)]
        };
        let light: Vec<Pixel> = pixels.data().iter().map(light).collect();
        backdrop::of_layer(&light, pixels.width()).map(Self::Grey)
    }

    /// The display colour of a premultiplied pixel over the ground.
    pub fn colour(self, pixel: Pixel, encoding: Encoding) -> Colour {
        let [r, g, b, alpha] = pixel;
        let behind = match self {
            Self::Grey(grey) if is_transparent(&pixel) => {
                let grey = if encoding.is_linear() { decode(grey) } else { grey };
                grey * (1.0 - if alpha.is_nan() { 0.0 } else { alpha.max(0.0) })
            }
            _ => 0.0,
        };
        [r, g, b].map(|value| encoding.shown(value + behind))
    }
}

/// Whether something behind a pixel shows.
pub fn is_transparent(pixel: &Pixel) -> bool {
    pixel[3].is_nan() || pixel[3] < 1.0
}

/// Whether colours are not multiplied by the alpha beside them: they exceed it on most of what is transparent, or wherever
/// they are, if nothing is opaque.
fn is_beside_alpha(pixels: &[Pixel]) -> bool {
    let clear = || pixels.iter().filter(|pixel| pixel[3].is_nan() || pixel[3] < OPAQUE);
    let brighter = |pixel: &&Pixel| pixel[..3].iter().any(|value| *value > pixel[3].max(0.0) + BEYOND);
    let (count, bright) = (clear().count(), clear().filter(brighter).count());
    bright >= FEW && (2 * bright > count || count == pixels.len())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pixels::Format;

    const SIDE: usize = 100;

    fn picture(of: impl Fn(usize, usize) -> Pixel) -> Raster<Pixel> {
        Raster::from_fn(SIDE, SIDE, of)
    }

    fn ring(x: usize, y: usize) -> bool {
        (28..30).contains(&x.abs_diff(50).max(y.abs_diff(50)))
    }

    #[test]
    fn lines_are_laid_on_the_paper_on_which_they_stand_out() {
        let encoding = Encoding::of(&Format::default());
        let lines = |ink: Pixel| Ground::of(&picture(|x, y| if ring(x, y) { ink } else { [0.0; 4] }), encoding);
        assert_eq!(lines([0.0, 0.0, 0.0, 1.0]), Some(Ground::Grey(1.0)));
        assert_eq!(lines([1.0; 4]), Some(Ground::Grey(0.0)));
        assert_eq!(lines([0.0; 4]), None);
        let painted =
            picture(|x, y| if x.abs_diff(50).max(y.abs_diff(50)) < 30 { [0.2, 0.4, 0.2, 1.0] } else { [0.0; 4] });
        assert_eq!(Ground::of(&painted, encoding), Some(Ground::Grey(backdrop::GREY)));
    }

    #[test]
    fn colours_beside_an_alpha_that_is_not_theirs_stay() {
        let encoding = Encoding::of(&Format::default());
        let plate = |alpha: fn(usize) -> f32| {
            picture(|x, y| if ring(x, y) { [0.0, 0.0, 0.0, alpha(x)] } else { [0.9, 0.8, 0.7, alpha(x)] })
        };
        for alpha in [|_| 0.0, |x| if x < 30 { 1.0 } else { 0.0 }] as [fn(usize) -> f32; 2] {
            assert_eq!(Ground::of(&plate(alpha), encoding), Some(Ground::Unused));
        }
        let on_black = picture(|x, y| if ring(x, y) { [0.9, 0.9, 0.9, 0.0] } else { [0.0; 4] });
        assert_eq!(Ground::of(&on_black, encoding), Some(Ground::Unused));
        assert_eq!(Ground::Unused.colour([0.3, 0.2, 0.1, 0.0], encoding), [0.3, 0.2, 0.1]);
    }

    #[test]
    fn pixels_are_blended_with_the_ground() {
        let encoding = Encoding::of(&Format::default());
        let over = |pixel| Ground::Grey(1.0).colour(pixel, encoding);
        assert_eq!(over([0.0, 0.1, 0.2, 0.5]), [0.5, 0.6, 0.7]);
        assert_eq!(over([0.0; 4]), [1.0; 3]);
        assert_eq!(over([0.3, 0.2, 0.1, 1.0]), [0.3, 0.2, 0.1]);
        assert_eq!(over([0.3, 0.2, 0.1, f32::NAN]), [1.3, 1.2, 1.1]);
    }
}
