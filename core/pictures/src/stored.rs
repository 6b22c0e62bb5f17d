//! A picture as its file has it: whole numbers stay whole numbers, so it takes a third or less of the memory of its
//! colours. What is made of it is the same, bit by bit, as what is made of the file.
//!
//! Floats that came from 16-bit floats, as nearly all OpenEXR files have them, are kept with 16 bits again if every one of
//! them stays what it was.

use half::f16;
use image::DynamicImage;
use rototoon_base::scene::Colour;
use rototoon_image::colour::{decode as to_light, encode};

/// A picture as its file has it.
#[derive(Debug)]
pub struct Stored {
    pixels: Pixels,
    /// Whether colours are multiplied by alpha.
    multiplied: bool,
}

#[derive(Debug)]
enum Pixels {
    Picture(DynamicImage),
    /// Red, green and blue.
    Half3(Vec<[f16; 3]>),
    /// Red, green, blue and alpha.
    Half4(Vec<[f16; 4]>),
}

impl Stored {
    /// What a decoder returned. `multiplied` says whether its colours are multiplied by alpha.
    pub fn new(picture: DynamicImage, multiplied: bool) -> Self {
        Self { pixels: Pixels::Picture(picture), multiplied }
    }

    /// The same picture in the least memory.
    pub fn compact(self) -> Self {
        let short = match &self.pixels {
            Pixels::Picture(DynamicImage::ImageRgb32F(p)) => short(p.as_raw()).map(Pixels::Half3),
            Pixels::Picture(DynamicImage::ImageRgba32F(p)) => short(p.as_raw()).map(Pixels::Half4),
            _ => None,
        };
        Self { pixels: short.unwrap_or(self.pixels), multiplied: self.multiplied }
    }

    /// Bytes of its pixels.
    pub fn bytes(&self) -> usize {
        match &self.pixels {
            Pixels::Picture(picture) => picture.as_bytes().len(),
            Pixels::Half3(pixels) => size_of_val(pixels.as_slice()),
            Pixels::Half4(pixels) => size_of_val(pixels.as_slice()),
        }
    }

    /// Whether pixels may be transparent.
    pub fn has_alpha(&self) -> bool {
        match &self.pixels {
            Pixels::Picture(picture) => picture.color().has_alpha(),
            Pixels::Half3(_) => false,
            Pixels::Half4(_) => true,
        }
    }

    /// The pixels as colours, blended with a grey, sRGB-encoded.
    pub fn colours(&self, backdrop: f32) -> Vec<Colour> {
        match &self.pixels {
            Pixels::Picture(picture) => colours(picture, self.multiplied, backdrop),
            Pixels::Half3(pixels) => pixels.iter().map(|p| p.map(|v| encoded(v.to_f32()))).collect(),
            Pixels::Half4(pixels) => {
                pixels.iter().map(|p| light_over(p.map(f16::to_f32), self.multiplied, backdrop)).collect()
            }
        }
    }

    /// The pixels as light multiplied by alpha, and alpha.
    pub fn layer(&self) -> Vec<[f32; 4]> {
        let multiplied = self.multiplied;
        match &self.pixels {
            Pixels::Picture(DynamicImage::ImageRgba32F(p)) => {
                p.pixels().map(|p| layer(p.0, true, multiplied)).collect()
            }
            Pixels::Picture(picture) => {
                let light = matches!(picture, DynamicImage::ImageRgb32F(_));
                picture.to_rgba32f().pixels().map(|p| layer(p.0, light, multiplied)).collect()
            }
            Pixels::Half3(pixels) => {
                let pixel = |p: &[f16; 3]| p.map(f16::to_f32);
                pixels.iter().map(pixel).map(|[r, g, b]| layer([r, g, b, 1.0], true, multiplied)).collect()
            }
            Pixels::Half4(pixels) => pixels.iter().map(|p| layer(p.map(f16::to_f32), true, multiplied)).collect(),
        }
    }
}

/// Floats with 16 bits, in groups of `N`; `None` if one of them would not stay what it is.
fn short<const N: usize>(values: &[f32]) -> Option<Vec<[f16; N]>> {
    let (pixels, _) = values.as_chunks::<N>();
    let one = |pixel: &[f32; N]| {
        let short = pixel.map(f16::from_f32);
        let same = short.iter().zip(pixel).all(|(short, v)| short.to_f32().to_bits() == v.to_bits());
        same.then_some(short)
    };
    pixels.iter().map(one).collect()
}

fn colours(picture: &DynamicImage, multiplied: bool, backdrop: f32) -> Vec<Colour> {
    let ground = Ground { multiplied, backdrop };
    match picture {
        DynamicImage::ImageLuma8(p) => whole::<1, _>(p.as_raw(), ground, byte),
        DynamicImage::ImageLumaA8(p) => whole::<2, _>(p.as_raw(), ground, byte),
        DynamicImage::ImageRgb8(p) => whole::<3, _>(p.as_raw(), ground, byte),
        DynamicImage::ImageRgba8(p) => whole::<4, _>(p.as_raw(), ground, byte),
        DynamicImage::ImageLuma16(p) => whole::<1, _>(p.as_raw(), ground, word),
        DynamicImage::ImageLumaA16(p) => whole::<2, _>(p.as_raw(), ground, word),
        DynamicImage::ImageRgb16(p) => whole::<3, _>(p.as_raw(), ground, word),
        DynamicImage::ImageRgba16(p) => whole::<4, _>(p.as_raw(), ground, word),
        DynamicImage::ImageRgb32F(p) => p.pixels().map(|p| p.0.map(encoded)).collect(),
        other => other.to_rgba32f().pixels().map(|p| light_over(p.0, multiplied, backdrop)).collect(),
    }
}

/// Light multiplied by alpha, and alpha. `light` says whether the colours are light already.
fn layer(pixel: [f32; 4], light: bool, multiplied: bool) -> [f32; 4] {
    let number = |v: f32| if v.is_nan() { 0.0 } else { v.clamp(f32::MIN, f32::MAX) };
    let [r, g, b, alpha] = pixel.map(number);
    let alpha = alpha.clamp(0.0, 1.0);
    let straight = |v: f32| if multiplied && alpha > 0.0 { (v / alpha).min(1.0) } else { v };
    let [r, g, b] = [r, g, b].map(|v| match (light, multiplied) {
        (true, true) => v,
        (true, false) => alpha * v,
        // Whole numbers are multiplied as they are encoded.
        (false, _) => alpha * to_light(straight(v)),
    });
    [r, g, b, alpha]
}

fn byte(v: u8) -> f32 {
    v as f32 / 255.0
}

fn word(v: u16) -> f32 {
    v as f32 / 65535.0
}

/// How pixels lie on what is behind them.
#[derive(Clone, Copy)]
struct Ground {
    /// Whether colours are multiplied by alpha.
    multiplied: bool,
    /// The grey behind them, sRGB-encoded.
    backdrop: f32,
}

/// Encoded values in groups of `N`: grey, grey and alpha, colour, or colour and alpha.
fn whole<const N: usize, V: Copy>(values: &[V], ground: Ground, unit: impl Fn(V) -> f32) -> Vec<Colour> {
    let Ground { multiplied, backdrop } = ground;
    // An opaque pixel is bit by bit what it is without alpha: its picture is the same one.
    let over = |v: f32, alpha: f32| match multiplied {
        _ if alpha == 1.0 => v,
        true => backdrop + v.min(alpha) - alpha * backdrop,
        false => backdrop + alpha * (v - backdrop),
    };
    let (pixels, _) = values.as_chunks::<N>();
    let colour = |pixel: &[V; N]| {
        let v = pixel.map(&unit);
        match N {
            1 => [v[0]; 3],
            2 => [over(v[0], v[1]); 3],
            3 => [v[0], v[1], v[2]],
            _ => [0, 1, 2].map(|c| over(v[c], v[3])),
        }
    };
    pixels.iter().map(colour).collect()
}

/// Light with alpha, blended with the backdrop and encoded.
fn light_over([r, g, b, alpha]: [f32; 4], multiplied: bool, backdrop: f32) -> Colour {
    let alpha = if alpha.is_nan() { 0.0 } else { alpha.clamp(0.0, 1.0) };
    let own = if multiplied { 1.0 } else { alpha };
    [r, g, b].map(|v| if alpha == 1.0 { encoded(v) } else { encoded(own * v + (1.0 - alpha) * to_light(backdrop)) })
}

/// Light, encoded and clamped to 0 to 1.
fn encoded(light: f32) -> f32 {
    if light.is_nan() { 0.0 } else { encode(light).clamp(0.0, 1.0) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{ImageBuffer, Rgb, Rgba};

    #[test]
    fn floats_of_16_bits_take_half_of_the_memory_and_stay_the_same() {
        let values = [f32::NAN, f32::INFINITY, -0.0, 0.25, 2f32.powi(-24), 65504.0, -3.5, 1.0];
        let of = |k: u32| values[k as usize % values.len()];
        let four = DynamicImage::ImageRgba32F(ImageBuffer::from_fn(8, 1, |x, _| {
            Rgba([of(x), of(x + 1), of(x + 2), of(x + 5)])
        }));
        let three = DynamicImage::ImageRgb32F(ImageBuffer::from_fn(8, 1, |x, _| Rgb([of(x), of(x + 1), of(x + 3)])));
        for (picture, multiplied, bytes) in [(four.clone(), true, 64), (four, false, 64), (three, true, 48)] {
            let (plain, short) = (Stored::new(picture.clone(), multiplied), Stored::new(picture, multiplied).compact());
            assert_eq!((short.bytes(), plain.bytes()), (bytes, 2 * bytes));
            let bits = |pixels: &[Colour]| pixels.iter().flatten().map(|v| v.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&short.colours(0.5)), bits(&plain.colours(0.5)));
            let bits = |pixels: &[[f32; 4]]| pixels.iter().flatten().map(|v| v.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&short.layer()), bits(&plain.layer()));
        }
    }

    #[test]
    fn what_would_change_stays_long() {
        for value in [0.1f32, 70000.0, f32::MIN_POSITIVE] {
            let picture = DynamicImage::ImageRgb32F(ImageBuffer::from_pixel(2, 2, Rgb([0.5, value, 1.0])));
            assert_eq!(Stored::new(picture, false).compact().bytes(), 48, "{value}");
        }
    }

    #[test]
    fn an_opaque_picture_is_the_same_with_alpha_and_without() {
        use image::DynamicImage as Picture;
        let bits = |picture: Picture, multiplied: bool, backdrop: f32| -> Vec<u32> {
            let stored = Stored::new(picture, multiplied).compact();
            stored.colours(backdrop).iter().flatten().map(|v| v.to_bits()).collect()
        };
        let eight =
            Picture::ImageRgb8(ImageBuffer::from_fn(256, 1, |x, _| Rgb([x as u8, (x * 7 % 256) as u8, 255 - x as u8])));
        let sixteen = Picture::ImageRgb16(ImageBuffer::from_fn(4096, 1, |x, _| {
            Rgb([x as u16 * 16, x as u16 * 15 + 7, 65535 - x as u16])
        }));
        let light = |x: u32| (x as f32 - 8.0) / 50.0;
        let long = ImageBuffer::from_fn(100, 1, |x, _| Rgb([light(x), light(x * 2), light(100 - x)]));
        let short = ImageBuffer::from_fn(100, 1, |x, _| Rgb([x as f32 / 128.0, 0.25, -0.0]));
        let with_alpha = |picture: &Picture| match picture {
            Picture::ImageRgb8(_) => Picture::ImageRgba8(picture.to_rgba8()),
            Picture::ImageRgb16(_) => Picture::ImageRgba16(picture.to_rgba16()),
            _ => Picture::ImageRgba32F(picture.to_rgba32f()),
        };
        for picture in [eight.clone(), sixteen, Picture::ImageRgb32F(long), Picture::ImageRgb32F(short)] {
            for (multiplied, backdrop) in [(false, 0.5), (true, 0.5), (false, 1.0), (true, 0.0)] {
                let (plain, opaque) = (picture.clone(), with_alpha(&picture));
                assert_eq!(bits(plain, multiplied, backdrop), bits(opaque, multiplied, backdrop));
            }
        }
        let grey = Picture::ImageLuma8(eight.to_luma8());
        let opaque = Picture::ImageLumaA8(grey.to_luma_alpha8());
        assert_eq!(bits(grey, false, 0.5), bits(opaque, false, 0.5));
    }
}
