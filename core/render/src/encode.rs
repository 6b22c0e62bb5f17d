//! Encodes pictures as bytes of PNG or OpenEXR files.
//!
//! PNG contains display colours with 8 bits for each channel; mattes have 16 bits. OpenEXR contains floats, of 32 bits if nothing
//! else is asked for ([`super::form`]). Its
//! colours are in linear light. Its mattes are white premultiplied by alpha, the form that compositors expect; its
//! cutouts are premultiplied too. The same picture gives the same bytes: OpenEXR is written by [`super::layers`], line
//! by line in their order. The parallel writer of the image library would write the blocks as they become ready.

use super::form::{Bits, Form, Packing};
use super::layers::{self, Channel};
use image::codecs::png::PngEncoder;
use image::{DynamicImage, ImageBuffer};
use rototoon_base::scene::{Colour, Raster};
use rototoon_image::colour;
use std::io::Cursor;
use std::path::Path;

/// A picture file format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Portable Network Graphics.
    Png,
    /// OpenEXR.
    Exr(Form),
}

impl Format {
    /// OpenEXR in its usual form.
    pub const EXR: Self = Self::Exr(Form { bits: Bits::Float, packing: Packing::Zip });

    /// The format for the extension of a file name; `None` for other extensions.
    pub fn of(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "png" => Some(Self::Png),
            "exr" => Some(Self::EXR),
            _ => None,
        }
    }
}

/// A picture could not be encoded.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("cannot encode a picture of {width}x{height} pixels: {reason}")]
pub struct EncodeError {
    /// Width of the picture in pixels.
    pub width: usize,
    /// Height of the picture in pixels.
    pub height: usize,
    /// The message of the encoder.
    pub reason: String,
}

/// Encodes a colour picture (sRGB-encoded, 0 to 1).
pub fn colours(picture: &Raster<Colour>, format: Format) -> Result<Vec<u8>, EncodeError> {
    let (width, height) = (picture.width() as u32, picture.height() as u32);
    match format {
        Format::Png => {
            let bytes = picture.data().iter().flatten().map(|c| (c.clamp(0.0, 1.0) * 255.0).round() as u8).collect();
            let image = ImageBuffer::from_raw(width, height, bytes).map(DynamicImage::ImageRgb8);
            png(image, picture.width(), picture.height())
        }
        Format::Exr(form) => exr(picture, ["R", "G", "B"], form, |pixel, channel| colour::decode(pixel[channel])),
    }
}

/// Encodes a picture with alpha as PNG. Its colours are sRGB-encoded and premultiplied.
pub fn premultiplied(picture: &Raster<[f32; 4]>) -> Result<Vec<u8>, EncodeError> {
    let byte = |value: f32| (value.clamp(0.0, 1.0) * 255.0).round() as u8;
    // Colours in PNG are not premultiplied.
    let straight = |&[r, g, b, a]: &[f32; 4]| {
        let whole = if a > 0.0 { a } else { 1.0 };
        [byte(r / whole), byte(g / whole), byte(b / whole), byte(a)]
    };
    let image = ImageBuffer::from_raw(
        picture.width() as u32,
        picture.height() as u32,
        picture.data().iter().flat_map(straight).collect(),
    );
    png(image.map(DynamicImage::ImageRgba8), picture.width(), picture.height())
}

/// Encodes linear light multiplied by alpha, and alpha.
pub fn layer(picture: &Raster<[f32; 4]>, format: Format) -> Result<Vec<u8>, EncodeError> {
    let (width, height) = (picture.width(), picture.height());
    match format {
        Format::Png => {
            let shown = Raster::from_fn(width, height, |x, y| displayed(picture.get(x, y)));
            premultiplied(&shown)
        }
        Format::Exr(form) => exr(picture, ["R", "G", "B", "A"], form, |pixel, channel| pixel[channel]),
    }
}

/// A pixel of linear light multiplied by alpha as display colours (sRGB) multiplied by alpha. Without alpha it is black.
pub fn displayed([r, g, b, alpha]: [f32; 4]) -> [f32; 4] {
    let whole = if alpha > 0.0 { alpha } else { 1.0 };
    let [r, g, b] = [r, g, b].map(|v| alpha * colour::encode(v / whole));
    [r, g, b, alpha]
}

/// Encodes a matte (0 to 1).
pub fn matte(picture: &Raster<f32>, format: Format) -> Result<Vec<u8>, EncodeError> {
    let (width, height) = (picture.width() as u32, picture.height() as u32);
    match format {
        Format::Png => {
            let values = picture.data().iter().map(|v| (v.clamp(0.0, 1.0) * 65535.0).round() as u16).collect();
            let image = ImageBuffer::from_raw(width, height, values).map(DynamicImage::ImageLuma16);
            png(image, picture.width(), picture.height())
        }
        Format::Exr(form) => exr(picture, ["R", "G", "B", "A"], form, |&coverage, _| coverage),
    }
}

/// Encodes as OpenEXR. `value` gives the value of a pixel in the channel of that index.
fn exr<T: Copy, const N: usize>(
    picture: &Raster<T>,
    names: [&str; N],
    form: Form,
    value: impl Fn(&T, usize) -> f32,
) -> Result<Vec<u8>, EncodeError> {
    let channel = |(index, name): (usize, &str)| Channel {
        name: name.to_owned(),
        values: picture.data().iter().map(|pixel| value(pixel, index)).collect(),
    };
    let channels = names.into_iter().enumerate().map(channel).collect();
    layers::encode((picture.width(), picture.height()), channels, &[], form)
}

fn png(image: Option<DynamicImage>, width: usize, height: usize) -> Result<Vec<u8>, EncodeError> {
    let failed = |reason: String| EncodeError { width, height, reason };
    let image = image.ok_or_else(|| failed("the size does not fit".to_owned()))?;
    let mut out = Cursor::new(Vec::new());
    // The encoder is named, because a call for any format would compile all encoders.
    image.write_with_encoder(PngEncoder::new(&mut out)).map_err(|error| failed(error.to_string()))?;
    Ok(out.into_inner())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_encoded_is_decoded() {
        let picture = Raster::from_fn(5, 3, |x, y| [x as f32 / 4.0, y as f32 / 2.0, 0.2]);
        for (format, exact) in [(Format::Png, 0.003), (Format::EXR, 1e-5)] {
            let image = image::load_from_memory(&colours(&picture, format).unwrap()).unwrap().to_rgb32f();
            for (pixel, colour) in image.pixels().zip(picture.data()) {
                let wanted = colour.map(|c| if format == Format::EXR { colour::decode(c) } else { c });
                assert!(
                    pixel.0.iter().zip(wanted).all(|(a, b)| (a - b).abs() < exact),
                    "{format:?} {pixel:?} {wanted:?}"
                );
            }
        }
    }

    #[test]
    fn mattes_keep_their_steps() {
        let picture = Raster::from_fn(300, 1, |x, _| x as f32 / 299.0);
        for format in [Format::Png, Format::EXR] {
            let image = image::load_from_memory(&matte(&picture, format).unwrap()).unwrap().to_rgba32f();
            for (pixel, value) in image.pixels().zip(picture.data()) {
                assert!((pixel.0[0] - value).abs() < 1e-4, "{format:?}");
            }
        }
    }

    #[test]
    fn the_same_picture_gives_the_same_bytes() {
        // Many blocks of lines, so that a parallel writer would finish them in changing order.
        let noise = |x: usize, y: usize| ((x * 7919 + y * 104_729) % 1013) as f32 / 1013.0;
        let colour = Raster::from_fn(200, 600, |x, y| [noise(x, y), noise(y, x), 0.5]);
        let first = colours(&colour, Format::EXR).unwrap();
        let shape = Raster::from_fn(200, 600, noise);
        let first_matte = matte(&shape, Format::EXR).unwrap();
        for _ in 0..12 {
            assert!(colours(&colour, Format::EXR).unwrap() == first);
            assert!(matte(&shape, Format::EXR).unwrap() == first_matte);
        }
    }

    #[test]
    fn the_name_gives_the_format() {
        assert_eq!(Format::of(Path::new("a.0001.EXR")), Some(Format::EXR));
        assert_eq!(Format::of(Path::new("a.jpg")), None);
        assert_eq!(Format::of(Path::new("png")), None);
    }
}
