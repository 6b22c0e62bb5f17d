//! Converts pixels of every depth and component to premultiplied RGBA floats, and back.

use half::f16;

/// The type of a value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Depth {
    /// 8 bits, 0 to 255.
    Byte,
    /// 16 bits, 0 to 65535.
    Short,
    /// 16-bit float.
    Half,
    /// 32-bit float.
    #[default]
    Float,
}

/// The values of a pixel, in order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Layout {
    /// Red, green, blue, opacity.
    #[default]
    Rgba,
    /// Red, green, blue.
    Rgb,
    /// Opacity.
    Alpha,
}

/// The relation of colours to opacity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Premultiplication {
    /// The opacity is 1, whatever the image contains.
    Opaque,
    /// Colours are multiplied by the opacity.
    #[default]
    Multiplied,
    /// Colours are not multiplied by the opacity.
    Separate,
}

/// The format of an image's pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Format {
    /// The type of a value.
    pub depth: Depth,
    /// The values of a pixel.
    pub layout: Layout,
    /// The relation of colours to opacity.
    pub premultiplication: Premultiplication,
}

/// Red, green and blue multiplied by opacity, and opacity.
pub type Pixel = [f32; 4];

/// A fully transparent pixel.
pub const CLEAR: Pixel = [0.0; 4];

impl Format {
    /// The number of bytes of a pixel.
    pub fn bytes(&self) -> usize {
        self.layout.values() * self.depth.bytes()
    }

    /// The format of values that are neither multiplied nor divided by alpha. The alpha of an opaque image stays 1.
    pub fn raw(&self) -> Self {
        let premultiplication = match self.premultiplication {
            Premultiplication::Opaque => Premultiplication::Opaque,
            _ => Premultiplication::Multiplied,
        };
        Self { premultiplication, ..*self }
    }

    /// Reads as many pixels as both slices have.
    pub fn read(&self, bytes: &[u8], pixels: &mut [Pixel]) {
        match self.depth {
            Depth::Byte => self.read_values(bytes, pixels, |b: [u8; 1]| f32::from(b[0]) / 255.0),
            Depth::Short => self.read_values(bytes, pixels, |b| f32::from(u16::from_ne_bytes(b)) / 65535.0),
            Depth::Half => self.read_values(bytes, pixels, |b| f16::from_ne_bytes(b).to_f32()),
            Depth::Float => self.read_values(bytes, pixels, f32::from_ne_bytes),
        }
    }

    fn read_values<const N: usize>(&self, bytes: &[u8], pixels: &mut [Pixel], value: impl Fn([u8; N]) -> f32) {
        let values = self.layout.values();
        for (from, to) in bytes.as_chunks::<N>().0.chunks_exact(values).zip(pixels) {
            let at = |index: usize| value(from[index]);
            *to = match self.layout {
                Layout::Rgba => [at(0), at(1), at(2), at(3)],
                Layout::Rgb => [at(0), at(1), at(2), 1.0],
                Layout::Alpha => [0.0, 0.0, 0.0, at(0)],
            };
            match self.premultiplication {
                _ if self.layout != Layout::Rgba => {}
                Premultiplication::Opaque => to[3] = 1.0,
                Premultiplication::Separate => {
                    to[..3].iter_mut().for_each(|colour| *colour *= from_alpha(from, &value))
                }
                Premultiplication::Multiplied => {}
            }
        }
    }

    /// Writes as many pixels as both slices have.
    pub fn write(&self, pixels: &[Pixel], bytes: &mut [u8]) {
        match self.depth {
            Depth::Byte => self.write_values(pixels, bytes, |v| [(v.clamp(0.0, 1.0) * 255.0 + 0.5) as u8]),
            Depth::Short => {
                self.write_values(pixels, bytes, |v| ((v.clamp(0.0, 1.0) * 65535.0 + 0.5) as u16).to_ne_bytes())
            }
            Depth::Half => self.write_values(pixels, bytes, |v| f16::from_f32(v).to_ne_bytes()),
            Depth::Float => self.write_values(pixels, bytes, f32::to_ne_bytes),
        }
    }

    fn write_values<const N: usize>(&self, pixels: &[Pixel], bytes: &mut [u8], value: impl Fn(f32) -> [u8; N]) {
        let values = self.layout.values();
        let separate = self.premultiplication == Premultiplication::Separate && self.layout == Layout::Rgba;
        for (to, from) in bytes.as_chunks_mut::<N>().0.chunks_exact_mut(values).zip(pixels) {
            let mut pixel = *from;
            if separate && pixel[3] > 0.0 {
                pixel[..3].iter_mut().for_each(|colour| *colour /= from[3]);
            }
            let wanted = if self.layout == Layout::Alpha { &pixel[3..] } else { &pixel[..values] };
            for (to, from) in to.iter_mut().zip(wanted) {
                *to = value(*from);
            }
        }
    }
}

fn from_alpha<const N: usize>(pixel: &[[u8; N]], value: &impl Fn([u8; N]) -> f32) -> f32 {
    pixel.get(3).map_or(1.0, |alpha| value(*alpha))
}

impl Layout {
    /// The number of values of a pixel.
    pub fn values(&self) -> usize {
        match self {
            Self::Rgba => 4,
            Self::Rgb => 3,
            Self::Alpha => 1,
        }
    }
}

impl Depth {
    /// The number of bytes of a value.
    pub fn bytes(&self) -> usize {
        match self {
            Self::Byte => 1,
            Self::Short | Self::Half => 2,
            Self::Float => 4,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DEPTHS: [Depth; 4] = [Depth::Byte, Depth::Short, Depth::Half, Depth::Float];
    const LAYOUTS: [Layout; 3] = [Layout::Rgba, Layout::Rgb, Layout::Alpha];

    #[test]
    fn written_pixels_are_read_back() {
        let pixels = [[0.2, 0.1, 0.4, 0.5], [0.0; 4], [1.0; 4], [0.05, 0.3, 0.0, 0.3]];
        for depth in DEPTHS {
            for layout in LAYOUTS {
                for premultiplication in [Premultiplication::Multiplied, Premultiplication::Separate] {
                    let format = Format { depth, layout, premultiplication };
                    let (mut bytes, mut read) = (vec![0; 4 * format.bytes()], [CLEAR; 4]);
                    format.write(&pixels, &mut bytes);
                    format.read(&bytes, &mut read);
                    for (wanted, found) in pixels.iter().zip(&read) {
                        let channels = match layout {
                            Layout::Rgba => 0..4,
                            Layout::Rgb => 0..3,
                            Layout::Alpha => 3..4,
                        };
                        for c in channels {
                            assert!((wanted[c] - found[c]).abs() < 0.004, "{format:?} {wanted:?} {found:?}");
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn opaque_images_have_opacity_one_and_bytes_are_clamped() {
        let opaque = Format { premultiplication: Premultiplication::Opaque, ..Format::default() };
        let mut bytes = vec![0; 16];
        opaque.write(&[[0.5, 0.25, 2.0, 0.1]], &mut bytes);
        let mut read = [CLEAR];
        opaque.read(&bytes, &mut read);
        assert_eq!(read, [[0.5, 0.25, 2.0, 1.0]]);
        let byte = Format { depth: Depth::Byte, ..Format::default() };
        byte.write(&[[-1.0, 2.0, f32::NAN, 0.999]], &mut bytes);
        assert_eq!(bytes[..4], [0, 255, 0, 255]);
    }
}
