//! What a picture does with the source: channels, alpha and the input Mask.
//!
//! A matte is coverage, not colour: it is written to its channels as it is, whether the host divides colours by alpha or
//! not. So are the source's channels beside it.

use super::settings::{Channels, Output, Settings, SourceAlpha};
use super::state::State;
use crate::encoding::Encoding;
use crate::ofx::{Failure, Parameters};
use crate::pixels::{Format, Pixel, Premultiplication};
use rototoon::render::paint::multiplied;

/// Less alpha is none: it is below a step of 16 bits.
const TRACE: f32 = 1.0 / 65536.0;

/// How a picture and the source become the output.
#[derive(Clone, Copy, Debug)]
pub struct Mixing {
    output: Output,
    channels: Channels,
    alpha: SourceAlpha,
    premultiply: bool,
    /// Whether the source's colours are multiplied by its alpha.
    is_multiplied: bool,
}

impl Mixing {
    /// As the settings say.
    pub fn of(settings: &Settings) -> Self {
        let Settings { output, channels, source_alpha: alpha, premultiply, .. } = *settings;
        Self { output, channels, alpha, premultiply, is_multiplied: false }
    }

    /// The same over a source of this format.
    pub fn over(self, source: &Format) -> Self {
        Self { is_multiplied: source.premultiplication == Premultiplication::Multiplied, ..self }
    }

    /// As the parameters say.
    pub fn read(parameters: &Parameters, time: f64) -> Result<Self, Failure> {
        Ok(Self::of(&Settings::read(parameters, time, &State::default())?))
    }

    /// Whether the source's pixels are needed after the picture is drawn.
    pub fn needs_source(&self) -> bool {
        let beside = self.channels != Channels::All || self.alpha != SourceAlpha::Ignore;
        self.output == Output::Painted || self.output == Output::Matte && beside
    }

    /// Whether values are written as they are, neither multiplied nor divided by alpha.
    pub fn is_raw(&self) -> bool {
        matches!(self.output, Output::Matte | Output::Mattes)
    }

    /// Makes the output of drawn pixels. `below` are the source's pixels if they are needed, `limit` the values of the input
    /// Mask.
    pub fn finish(&self, pixels: &mut [Pixel], below: Option<&[Pixel]>, limit: Option<&[f32]>, format: &Format) {
        if let Some(limit) = limit.filter(|_| self.is_raw() || self.output == Output::Cutout) {
            for (pixel, limit) in pixels.iter_mut().zip(limit) {
                pixel.iter_mut().for_each(|value| *value *= limit);
            }
        }
        if !self.output.shows_parts() {
            return show_paint(pixels, below, &Encoding::of(format));
        }
        if let Some(below) = below {
            for (pixel, below) in pixels.iter_mut().zip(below) {
                *pixel = self.matte(pixel[3], *below);
            }
        }
        if self.output == Output::Ids {
            let encoding = Encoding::of(format);
            if encoding.is_linear() {
                pixels.iter_mut().for_each(|pixel| *pixel = light(*pixel, &encoding));
            }
        }
    }

    /// A matte's value over a pixel of the source.
    fn matte(&self, value: f32, below: Pixel) -> Pixel {
        let value = match self.alpha {
            SourceAlpha::Ignore => value,
            SourceAlpha::Multiply => value * below[3],
            SourceAlpha::Add => value + below[3] - value * below[3],
        };
        let Channels::One(channel) = self.channels else { return [value; 4] };
        let mut pixel = below;
        pixel[channel] = value;
        if channel == 3 && self.premultiply {
            // Where the source's alpha is in the value, its colours must not have it a second time. Where it is ignored, it does not
            // count for the colours either.
            let has_own = self.alpha != SourceAlpha::Ignore && self.is_multiplied && below[3] > TRACE;
            let share = if has_own { value / below[3] } else { value };
            pixel[..3].iter_mut().for_each(|colour| *colour *= share);
        }
        pixel
    }
}

/// Turns paint, which is linear light times alpha, into pixels of the image. A drawing lies over it, as in the command line.
fn show_paint(pixels: &mut [Pixel], drawing: Option<&[Pixel]>, encoding: &Encoding) {
    for (at, pixel) in pixels.iter_mut().enumerate() {
        *pixel = match drawing.map(|drawing| drawing[at]) {
            // The drawing alone stays as it is, to the last bit.
            Some(drawing) if pixel[3] <= 0.0 => drawing,
            Some(drawing) => encoding.of_light(multiplied(encoding.to_light(drawing), *pixel)),
            None => encoding.of_light(*pixel),
        };
    }
}

/// Display colours times alpha as linear light times alpha.
fn light(pixel: Pixel, encoding: &Encoding) -> Pixel {
    let [r, g, b, alpha] = pixel;
    if alpha <= 0.0 {
        return pixel;
    }
    let [r, g, b] = [r, g, b].map(|value| encoding.held(value / alpha) * alpha);
    [r, g, b, alpha]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_premultiplied_and_a_straight_source_become_the_same_premultiplied_picture() {
        let [multiplied, straight] = [Premultiplication::Multiplied, Premultiplication::Separate]
            .map(|premultiplication| Format { premultiplication, ..Format::default() });
        for (alpha, inside, outside) in [
            (SourceAlpha::Multiply, [0.5, 0.25, 0.5, 0.5], [0.0; 4]),
            (SourceAlpha::Add, [1.0, 0.5, 1.0, 1.0], [0.5, 0.25, 0.5, 0.5]),
        ] {
            let mixing = Mixing {
                output: Output::Matte,
                channels: Channels::One(3),
                alpha,
                premultiply: true,
                is_multiplied: false,
            };
            for (value, wanted) in [(1.0, inside), (0.0, outside)] {
                assert_eq!(mixing.over(&multiplied).matte(value, [0.5, 0.25, 0.5, 0.5]), wanted, "{alpha:?}");
                assert_eq!(mixing.over(&straight).matte(value, [1.0, 0.5, 1.0, 0.5]), wanted, "{alpha:?}");
            }
            // Light without alpha is not divided by it.
            for trace in [0.0, 1e-40] {
                let light = mixing.over(&multiplied).matte(1.0, [0.5, 0.0, 0.0, trace]);
                assert!(light.iter().all(|value| (0.0..=1.0).contains(value)), "{light:?}");
            }
        }
        let ignoring = Mixing {
            output: Output::Matte,
            channels: Channels::One(3),
            alpha: SourceAlpha::Ignore,
            premultiply: true,
            is_multiplied: true,
        };
        assert_eq!(ignoring.matte(0.5, [0.5, 0.25, 0.5, 0.0]), [0.25, 0.125, 0.25, 0.5]);
    }
}
