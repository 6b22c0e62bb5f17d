//! A picture from a file: PNG, JPEG, TIFF, BMP, WebP or OpenEXR. The content decides the format, not the name.
//!
//! Every picture becomes three channels, sRGB-encoded, 0 to 1:
//!
//! - **Integers** (1 to 16 bits per channel; grey, palette, colour, CMYK) are taken as sRGB-encoded.
//! - **Floats** (OpenEXR, float TIFF) are light. They are encoded and clamped to 0 to 1. NaN becomes black.
//! - **Transparent pixels** are blended with a mid grey, sRGB-encoded 0.5, or, behind lines alone, with the paper on which
//!   these stand out ([`super::backdrop`]). Integers are blended as encoded values, as painting programs blend their antialiased edges. OpenEXR has light multiplied by alpha and is blended as light. TIFF says whether
//!   its colours are multiplied by alpha (`tags`).
//! - **Animations** (PNG, WebP) give their first frame.
//!
//! A file that is cut anywhere is an error, unless all pixels are in what is left ([`super::open`]).
//!
//! Limits: colour profiles, gamma chunks and the orientation noted by cameras are ignored. TIFF
//! with a palette is refused, and OpenEXR with several channels but no R, G and B (`layered`). The pixels of a picture may use at most
//! 2 GiB while it is decoded. Damage inside of a JPEG scan is not found: the format has no checksums.

use super::backdrop;
use super::blocks;
use super::error::DecodeError;
use super::open::{check_size, decoder, open};
use super::stored::Stored;
use image::{ColorType, DynamicImage, ImageDecoder, ImageFormat};
use rototoon_base::scene::{Colour, Raster};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

/// Width and height of the picture in a file, in pixels. It reads the header of the file only.
///
/// # Errors
///
/// A file that does not exist or cannot be read as a picture.
pub fn probe(path: &Path) -> Result<(usize, usize), DecodeError> {
    guarded(|| {
        let (width, height) = decoder(open(path, false)?)?.0.dimensions();
        Ok((width as usize, height as usize))
    })
}

/// The picture in a file, sRGB-encoded, 0 to 1. `expected` is the width and height that it must have, if given.
///
/// # Errors
///
/// A file that does not exist or cannot be read as a picture; a picture of another size, which is not decoded.
pub fn decode(path: &Path, expected: Option<(usize, usize)>) -> Result<Raster<Colour>, DecodeError> {
    let (stored, size) = stored(path, expected, size_of::<Colour>())?;
    let backdrop = backdrop::of(&stored, size.0).unwrap_or(backdrop::GREY);
    raster(size, stored.colours(backdrop))
}

/// The picture in a file with its transparency: red, green and blue light multiplied by alpha, not clamped to 1,
/// followed by alpha. NaN becomes 0, infinity becomes the largest number.
///
/// # Errors
///
/// As for [`decode`].
pub fn decode_layer(path: &Path, expected: Option<(usize, usize)>) -> Result<Raster<[f32; 4]>, DecodeError> {
    let (stored, size) = stored(path, expected, size_of::<[f32; 4]>())?;
    raster(size, stored.layer())
}

/// What the header of an OpenEXR file says of its picture, beside its size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Described {
    /// Width of a pixel divided by its height; 1 if the file says nothing sensible.
    pub pixel_aspect: f32,
    /// The CIE x and y of red, green, blue and white.
    pub chromaticities: Option<[f32; 8]>,
    /// SMPTE 12M time code: time and flags, then user data, as in the file.
    pub time_code: Option<[u32; 2]>,
}

impl Default for Described {
    fn default() -> Self {
        Self { pixel_aspect: 1.0, chromaticities: None, time_code: None }
    }
}

/// What a file says of its picture; nothing for other files than OpenEXR. `None` for a file that cannot be read. It reads the header of
/// the file only.
pub fn described(path: &Path) -> Option<Described> {
    const SENSIBLE: std::ops::RangeInclusive<f32> = 0.01..=100.0;
    let read = || {
        let reader = open(path, false)?;
        if reader.format() != Some(ImageFormat::OpenExr) {
            return Ok(reader.format().map(|_| Described::default()));
        }
        let headers = blocks::headers(&mut reader.into_inner())?;
        let Some(header) = headers.first() else { return Ok(None) };
        let own = &header.shared_attributes;
        let places = own.chromaticities.map(|own| [own.red, own.green, own.blue, own.white]);
        let numbers = places
            .map(|places| std::array::from_fn(|k| if k % 2 == 0 { places[k / 2].x() } else { places[k / 2].y() }));
        let code =
            own.time_code.and_then(|code| Some([code.pack_time_as_tv60_u32().ok()?, code.pack_user_data_as_u32()]));
        Ok(Some(Described {
            pixel_aspect: Some(own.pixel_aspect).filter(|aspect| SENSIBLE.contains(aspect)).unwrap_or(1.0),
            chromaticities: numbers.filter(|all: &[f32; 8]| all.iter().all(|number| number.is_finite())),
            time_code: code,
        }))
    };
    guarded(read).ok().flatten()
}

/// Width of a pixel divided by its height ([`described`]).
pub fn pixel_aspect(path: &Path) -> f32 {
    described(path).unwrap_or_default().pixel_aspect
}

/// Bytes of the picture in a file as [`super::store`] keeps it. Of floats this is a guess: nearly all have 16 bits. It
/// reads the header of the file only.
///
/// # Errors
///
/// As for [`probe`].
pub fn kept_size(path: &Path) -> Result<u64, DecodeError> {
    guarded(|| {
        let (decoder, _) = decoder(open(path, false)?)?;
        let float = matches!(decoder.color_type(), ColorType::Rgb32F | ColorType::Rgba32F);
        Ok(decoder.total_bytes() / if float { 2 } else { 1 })
    })
}

/// A file's pixels as they are in it, with width and height. `pixel` is the number of bytes of a pixel that is made of them.
///
/// # Errors
///
/// As for [`decode`].
pub(super) fn stored(
    path: &Path,
    expected: Option<(usize, usize)>,
    pixel: usize,
) -> Result<(Stored, (usize, usize)), DecodeError> {
    guarded(|| {
        let (decoder, multiplied) = decoder(open(path, true)?)?;
        let (width, height) = decoder.dimensions();
        let (width, height) = (width as usize, height as usize);
        if expected.is_some_and(|size| size != (width, height)) {
            return Err(DecodeError::WrongSize { width, height });
        }
        check_size(&decoder, pixel)?;
        Ok((Stored::new(DynamicImage::from_decoder(decoder)?, multiplied), (width, height)))
    })
}

/// A raster of pixels that a decoder returned.
pub(super) fn raster<T: Copy>((width, height): (usize, usize), pixels: Vec<T>) -> Result<Raster<T>, DecodeError> {
    Raster::from_vec(width, height, pixels)
        .ok_or_else(|| DecodeError::Unreadable(format!("fewer pixels than {width}x{height}")))
}

/// Turns a panic of the decoder, on a broken file, into an error.
fn guarded<T>(work: impl FnOnce() -> Result<T, DecodeError>) -> Result<T, DecodeError> {
    let failed = |_| Err(DecodeError::Unreadable("the decoder panicked on this file".into()));
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(failed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{ExtendedColorType, ImageBuffer, Luma, LumaA, Rgb, Rgba};
    use rototoon_image::colour::{decode as to_light, encode};
    use std::path::PathBuf;
    use tempfile::TempDir;

    fn folder() -> TempDir {
        tempfile::tempdir().unwrap()
    }

    fn close(a: Colour, b: Colour, within: f32) -> bool {
        a.iter().zip(b).all(|(a, b)| (a - b).abs() <= within)
    }

    /// Writes a picture of 5 × 4 pixels and reads it back.
    fn there_and_back(name: &str, picture: impl Into<DynamicImage>) -> Raster<Colour> {
        let folder = folder();
        let path = folder.path().join(name);
        picture.into().save(&path).unwrap();
        assert_eq!(probe(&path), Ok((5, 4)));
        let read = decode(&path, Some((5, 4))).unwrap();
        assert_eq!((read.width(), read.height()), (5, 4));
        read
    }

    fn shade(x: u32, y: u32) -> [u8; 3] {
        [(x * 50) as u8, (y * 60) as u8, 130]
    }

    #[test]
    fn headers_describe_their_pictures() {
        use exr::meta::attribute::{Chromaticities, TimeCode};
        use exr::prelude::{Image, SpecificChannels, Vec2, WritableImage};
        let folder = folder();
        let path = folder.path().join("a.exr");
        let mut image = Image::from_channels((5, 4), SpecificChannels::rgb(|_| (0.5f32, 0.25f32, 0.125f32)));
        let own = &mut image.attributes;
        let at = |k: u8| Vec2(0.125 * f32::from(k), 0.0625 * f32::from(k));
        own.chromaticities = Some(Chromaticities { red: at(1), green: at(2), blue: at(3), white: at(4) });
        own.time_code = Some(TimeCode { hours: 1, minutes: 23, seconds: 45, frame: 16, ..TimeCode::default() });
        own.pixel_aspect = 2.0;
        image.write().to_file(&path).unwrap();
        let found = described(&path).unwrap();
        assert_eq!(found.pixel_aspect, 2.0);
        assert_eq!(found.chromaticities, Some([0.125, 0.0625, 0.25, 0.125, 0.375, 0.1875, 0.5, 0.25]));
        // Two decimal digits in each byte.
        assert_eq!(found.time_code, Some([0x0123_4516, 0]));
        std::fs::write(&path, "no picture").unwrap();
        assert_eq!(described(&path), None);
    }

    #[test]
    fn colours_of_every_8_bit_format() {
        let picture = || ImageBuffer::from_fn(5, 4, |x, y| Rgb(shade(x, y)));
        for name in ["a.png", "a.tiff", "a.tif", "a.bmp", "a.webp"] {
            let read = there_and_back(name, picture());
            for (x, y, p) in picture().enumerate_pixels() {
                assert_eq!(read.get(x as usize, y as usize), p.0.map(|v| v as f32 / 255.0), "{name}");
            }
        }
        let flat = there_and_back("a.jpg", ImageBuffer::from_pixel(5, 4, Rgb([200u8, 30, 90])));
        assert!(close(flat.get(2, 2), [200.0, 30.0, 90.0].map(|v| v / 255.0), 0.02), "{:?}", flat.get(2, 2));
    }

    #[test]
    fn grey_and_16_bits() {
        for name in ["a.png", "a.tiff"] {
            let grey = there_and_back(name, ImageBuffer::from_fn(5, 4, |x, _| Luma([(x * 9000) as u16])));
            assert_eq!(grey.get(3, 1), [27000.0 / 65535.0; 3], "{name}");
            let deep = there_and_back(name, ImageBuffer::from_fn(5, 4, |x, y| Rgb([x as u16, 65535, 256 * y as u16])));
            assert_eq!(deep.get(3, 1), [3.0 / 65535.0, 1.0, 256.0 / 65535.0], "{name}");
        }
        for name in ["a.png", "a.tiff", "a.bmp", "a.jpg"] {
            let grey = there_and_back(name, ImageBuffer::from_pixel(5, 4, Luma([77u8])));
            assert!(close(grey.get(4, 3), [77.0 / 255.0; 3], 0.01), "{name}");
        }
    }

    #[test]
    fn transparency_shows_the_backdrop() {
        let alphas = [0u8, 255, 51];
        for name in ["a.png", "a.tiff", "a.webp"] {
            let ink = |x: u32| Rgba([0, 255, 255, alphas[x as usize % 3]]);
            let read = there_and_back(name, ImageBuffer::from_fn(5, 4, |x, _| ink(x)));
            assert!(close(read.get(0, 0), [0.5; 3], 1e-6), "{name}");
            assert!(close(read.get(1, 0), [0.0, 1.0, 1.0], 1e-6), "{name}");
            assert!(close(read.get(2, 0), [0.4, 0.6, 0.6], 1e-6), "{name}");
        }
        let read = there_and_back("a.png", ImageBuffer::from_pixel(5, 4, LumaA([65535u16, 13107])));
        assert!(close(read.get(0, 0), [0.6; 3], 1e-6));
    }

    #[test]
    fn light_is_encoded() {
        let light = [0.0, 0.214_041_14, 7.0];
        for name in ["a.exr", "a.tiff"] {
            let read = there_and_back(name, ImageBuffer::from_pixel(5, 4, Rgb(light)));
            assert!(close(read.get(1, 1), [0.0, 0.5, 1.0], 1e-4), "{name}: {:?}", read.get(1, 1));
        }
        let read = there_and_back("a.exr", ImageBuffer::from_pixel(5, 4, Rgba([f32::NAN, f32::INFINITY, -1.0, 1.0])));
        assert_eq!(read.get(1, 1), [0.0, 1.0, 0.0]);
    }

    #[test]
    fn layers_keep_transparency_and_light_above_one() {
        let layer = |name: &str, image: DynamicImage| {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join(name);
            image.save(&path).unwrap();
            decode_layer(&path, Some((3, 1))).unwrap().data().to_vec()
        };
        let near = |pixels: &[[f32; 4]], wanted: [[f32; 4]; 3]| {
            let off = pixels.iter().flatten().zip(wanted.iter().flatten()).map(|(a, b)| (a - b).abs());
            assert!(off.fold(0.0, f32::max) < 1e-6, "{pixels:?} {wanted:?}");
        };
        let inks = [Rgba([0u8, 255, 51, 255]), Rgba([255, 255, 255, 51]), Rgba([255, 0, 0, 0])];
        let png = ImageBuffer::from_fn(3, 1, |x, _| inks[x as usize]);
        near(
            &layer("a.png", DynamicImage::ImageRgba8(png)),
            [[0.0, 1.0, to_light(0.2), 1.0], [0.2, 0.2, 0.2, 0.2], [0.0; 4]],
        );
        let lights = [Rgba([4.0f32, 0.5, f32::NAN, 1.0]), Rgba([0.25, 0.0, 0.0, 0.5]), Rgba([0.0; 4])];
        let exr = ImageBuffer::from_fn(3, 1, |x, _| lights[x as usize]);
        near(&layer("a.exr", DynamicImage::ImageRgba32F(exr)), [[4.0, 0.5, 0.0, 1.0], [0.25, 0.0, 0.0, 0.5], [0.0; 4]]);
    }

    #[test]
    fn exr_is_already_multiplied_by_alpha() {
        let half = to_light(0.5);
        let read = there_and_back("a.exr", ImageBuffer::from_pixel(5, 4, Rgba([0.5 * half, 0.0, 0.5, 0.5f32])));
        let want = [0.5, encode(0.5 * half), encode(0.5 + 0.5 * half)];
        assert!(close(read.get(1, 1), want, 1e-4), "{:?} {want:?}", read.get(1, 1));
        let clear = there_and_back("a.exr", ImageBuffer::from_pixel(5, 4, Rgba([0.0, 0.0, 0.0, 0.0f32])));
        assert!(close(clear.get(1, 1), [0.5; 3], 1e-4));
    }

    /// PNG's checksum of a chunk, bit by bit.
    fn crc(bytes: &[u8]) -> u32 {
        !bytes.iter().fold(!0u32, |sum, &byte| {
            (0..8).fold(sum ^ byte as u32, |s, _| if s & 1 == 1 { (s >> 1) ^ 0xEDB8_8320 } else { s >> 1 })
        })
    }

    fn chunk(kind: &[u8; 4], data: &[u8]) -> Vec<u8> {
        let body = [kind.as_slice(), data].concat();
        [&(data.len() as u32).to_be_bytes()[..], &body, &crc(&body).to_be_bytes()].concat()
    }

    /// A zlib stream that stores its bytes uncompressed.
    fn stored(bytes: &[u8]) -> Vec<u8> {
        let len = bytes.len() as u16;
        let (a, b) = bytes.iter().fold((1u32, 0u32), |(a, b), &v| {
            let a = (a + v as u32) % 65521;
            (a, (b + a) % 65521)
        });
        let head = [0x78, 0x01, 1];
        [&head[..], &len.to_le_bytes(), &(!len).to_le_bytes(), bytes, &((b << 16) | a).to_be_bytes()].concat()
    }

    /// A PNG file built by hand: each of `rows` is a filter byte and packed pixels; chunks go `before` and `after` the
    /// picture data.
    fn png(size: [u32; 2], bits: u8, kind: u8, before: &[Vec<u8>], rows: &[u8], after: &[Vec<u8>]) -> Vec<u8> {
        let header = [&size[0].to_be_bytes()[..], &size[1].to_be_bytes(), &[bits, kind, 0, 0, 0]].concat();
        let mut all = b"\x89PNG\r\n\x1a\n".to_vec();
        all.extend(chunk(b"IHDR", &header));
        all.extend(before.concat());
        all.extend(chunk(b"IDAT", &stored(rows)));
        all.extend(after.concat());
        all.extend(chunk(b"IEND", &[]));
        all
    }

    fn file(folder: &TempDir, name: &str, bytes: &[u8]) -> PathBuf {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    }

    #[test]
    fn one_bit_and_palette_png() {
        let folder = folder();
        let bits = png([10, 2], 1, 0, &[], &[0, 0b1010_0000, 0b0100_0000, 0, 0, 0], &[]);
        let read = decode(&file(&folder, "bits.png", &bits), Some((10, 2))).unwrap();
        let white: Vec<usize> = (0..10).filter(|&x| read.get(x, 0) == [1.0; 3]).collect();
        assert_eq!(white, [0, 2, 9]);
        assert!(read.row(1).iter().all(|&c| c == [0.0; 3]));

        // Two bits per pixel and four colours, the last one transparent.
        let palette = [chunk(b"PLTE", &[0, 0, 0, 255, 0, 0, 0, 255, 0, 9, 9, 9]), chunk(b"tRNS", &[255, 255, 255, 0])];
        let indexed = png([4, 1], 2, 3, &palette, &[0, 0b00_01_10_11], &[]);
        let read = decode(&file(&folder, "palette.png", &indexed), None).unwrap();
        assert_eq!(read.row(0), [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.5; 3]]);
    }

    #[test]
    fn first_frame_of_an_animated_png() {
        let control = |sequence: u32| {
            let size = [&sequence.to_be_bytes()[..], &2u32.to_be_bytes(), &1u32.to_be_bytes(), &[0; 8]].concat();
            chunk(b"fcTL", &[&size[..], &[0, 1, 0, 10, 0, 0]].concat())
        };
        let animation = chunk(b"acTL", &[0, 0, 0, 2, 0, 0, 0, 0]);
        let second = chunk(b"fdAT", &[&2u32.to_be_bytes()[..], &stored(&[0, 255, 255])].concat());
        let bytes = png([2, 1], 8, 0, &[animation, control(0)], &[0, 51, 102], &[control(1), second]);
        let folder = folder();
        let read = decode(&file(&folder, "a.png", &bytes), Some((2, 1))).unwrap();
        assert_eq!(read.row(0), [[0.2; 3], [0.4; 3]]);
    }

    #[test]
    fn first_frame_of_an_animated_webp() {
        let folder = folder();
        let still = |value: u8| {
            let mut bytes = Vec::new();
            let encoder = image::codecs::webp::WebPEncoder::new_lossless(&mut bytes);
            encoder.encode(&[value; 6], 2, 1, ExtendedColorType::Rgb8).unwrap();
            bytes[12..].to_vec()
        };
        let riff = |kind: &[u8; 4], data: &[u8]| [&kind[..], &(data.len() as u32).to_le_bytes(), data].concat();
        let frame =
            |value| riff(b"ANMF", &[&[0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 100, 0, 0, 0][..], &still(value)].concat());
        let head = riff(b"VP8X", &[2, 0, 0, 0, 1, 0, 0, 0, 0, 0]);
        let body = [b"WEBP".to_vec(), head, riff(b"ANIM", &[0; 6]), frame(51), frame(204)].concat();
        let read = decode(&file(&folder, "a.webp", &riff(b"RIFF", &body)), Some((2, 1))).unwrap();
        assert!(close(read.get(0, 0), [0.2; 3], 0.01), "{:?}", read.get(0, 0));
    }

    #[test]
    fn the_content_decides_the_format_not_the_name() {
        let folder = folder();
        let path = folder.path().join("a.png");
        let picture = ImageBuffer::from_pixel(1, 1, Rgb([255u8, 0, 0]));
        picture.save_with_format(&path, ImageFormat::Bmp).unwrap();
        assert_eq!(decode(&path, None).unwrap().data(), [[1.0, 0.0, 0.0]]);
    }

    #[test]
    fn errors_say_what_is_wrong() {
        let folder = folder();
        assert_eq!(probe(&folder.path().join("none.png")), Err(DecodeError::Missing));
        assert_eq!(decode(&folder.path().join("none.png"), None), Err(DecodeError::Missing));
        let reason = |bytes: &[u8]| match decode(&file(&folder, "a.png", bytes), None) {
            Err(DecodeError::Unreadable(reason)) => reason,
            other => panic!("{other:?}"),
        };
        assert!(reason(b"").contains("not a PNG"));
        assert!(reason(b"a text, not a picture").contains("not a PNG"));
        let gif = reason(b"GIF89a\x01\0\x01\0\0\0\0,\0\0\0\0\x01\0\x01\0\0\x02\0;");
        assert!(gif.contains("found a GIF picture, expected PNG,") && gif.contains("save its frames as PNG"), "{gif}");
        let whole = png([4, 1], 8, 0, &[], &[0, 1, 2, 3, 4], &[]);
        assert!(!reason(&whole[..30]).is_empty());
        assert!(!reason(&whole[..50]).is_empty());
        let path = file(&folder, "b.png", &whole);
        assert_eq!(decode(&path, Some((4, 2))), Err(DecodeError::WrongSize { width: 4, height: 1 }));
        assert!(matches!(decode(folder.path(), None), Err(DecodeError::Unreadable(_))));
    }

    #[test]
    fn a_small_file_that_claims_to_be_huge_is_refused() {
        let folder = folder();
        for (size, bits, kind) in [([60000, 60000], 16, 6), ([46000, 46000], 1, 0)] {
            let bytes = png(size, bits, kind, &[], &[0], &[]);
            let Err(DecodeError::Unreadable(reason)) = decode(&file(&folder, "a.png", &bytes), None) else { panic!() };
            assert!(reason.contains("expected at most 2.1 GB"), "{reason}");
        }
    }
}
