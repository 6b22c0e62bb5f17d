//! OpenEXR pictures whose colours are not in plain R, G and B channels.
//!
//! A renderer's file has channels such as `ViewLayer.Combined.R`: layer, pass and colour with points between. A mask or a depth has
//! one channel. What is read of such a file:
//!
//! 1. R, G and B with a common prefix, of the first part that has some. Among several prefixes that of Blender's complete picture, `Combined`,
//!    and else the first one. An A of that prefix is alpha.
//! 2. Else `Y` without the colours `RY` and `BY`, or the only channel of the first part, as grey; with `A` as alpha.
//!
//! Files with plain R, G and B are read by the package `image`. As there, dimensions are those of the display window; pixels
//! outside of it are left out, and pixels that the file lacks are transparent or black.

use super::error::DecodeError;
use exr::block::reader::Reader;
use exr::meta::header::Header;
use exr::prelude::{ReadChannels, ReadLayers, ReadSpecificChannel, Text, Vec2, read};
use image::error::{DecodingError, ImageFormatHint};
use image::{ColorType, ImageDecoder, ImageError, ImageFormat, ImageResult};
use std::io::{BufRead, Seek};

/// Number of channels that a message names.
const NAMED: usize = 12;

/// The channels of a picture.
#[derive(Clone, Debug, PartialEq)]
struct Channels {
    /// Red, green and blue, or one grey.
    colours: Vec<Text>,
    alpha: Option<Text>,
}

/// Decodes a picture whose channels have other names than R, G and B.
pub struct Layered<R> {
    reader: Reader<R>,
    header: usize,
    channels: Channels,
}

/// Whether a part of a file has plain colours.
pub fn is_plain(header: &Header) -> bool {
    let has = |name: &str| header.channels.list.iter().any(|channel| channel.name == *name);
    !header.deep && has("R") && has("G") && has("B")
}

impl<R: BufRead + Seek> Layered<R> {
    /// Reads the headers of a file and chooses its channels.
    ///
    /// # Errors
    ///
    /// Headers that cannot be read, and channels of which none is a picture.
    pub fn new(file: R) -> Result<Self, DecodeError> {
        let reader = exr::block::read(file, false).map_err(|error| DecodeError::unreadable(&error))?;
        let names = |header: &Header| -> Vec<String> {
            header.channels.list.iter().map(|channel| channel.name.to_string()).collect()
        };
        let flat: Vec<(usize, Vec<String>)> = reader
            .headers()
            .iter()
            .enumerate()
            .filter(|(_, header)| !header.deep)
            .map(|(k, h)| (k, names(h)))
            .collect();
        let found = |choose: fn(&[String]) -> Option<Channels>| {
            flat.iter().find_map(|(header, names)| Some((*header, choose(names)?)))
        };
        if let Some((header, channels)) = found(coloured).or_else(|| found(grey)) {
            return Ok(Self { reader, header, channels });
        }
        let found: Vec<String> = reader.headers().iter().flat_map(names).collect();
        let more = if found.len() > NAMED { format!(" and {} more", found.len() - NAMED) } else { String::new() };
        let listed = found.iter().take(NAMED).map(String::as_str).collect::<Vec<_>>().join(", ");
        let deep = if reader.headers().iter().any(|header| header.deep) { " (deep data is not read)" } else { "" };
        Err(DecodeError::Unreadable(format!(
            "found the OpenEXR channels {listed}{more}{deep}, expected R, G and B, alone or of a layer such as beauty.R, or one channel"
        )))
    }
}

/// The colours of a layer.
fn coloured(names: &[String]) -> Option<Channels> {
    let has = |name: &str| names.iter().any(|own| own == name);
    let whole = |prefix: &&str| ["G", "B"].iter().all(|colour| has(&format!("{prefix}{colour}")));
    let prefixes = || names.iter().filter_map(|name| name.strip_suffix('R')).filter(whole);
    let is_layer = |prefix: &&str| prefix.is_empty() || prefix.ends_with('.');
    let combined = |prefix: &&str| prefix.ends_with("Combined.");
    let prefix = prefixes().find(combined).or_else(|| prefixes().find(is_layer))?;
    let text = |colour: &str| Text::from(format!("{prefix}{colour}").as_str());
    let alpha = has(&format!("{prefix}A")).then(|| text("A"));
    Some(Channels { colours: ["R", "G", "B"].map(text).to_vec(), alpha })
}

/// The only channel beside alpha.
fn grey(names: &[String]) -> Option<Channels> {
    let has = |name: &str| names.iter().any(|own| own == name);
    let mut others = names.iter().filter(|name| *name != "A");
    let only = match (others.next(), others.next()) {
        (Some(only), None) => only,
        (None, _) => return has("A").then(|| Channels { colours: vec![Text::from("A")], alpha: None }),
        _ if has("Y") && !has("RY") && !has("BY") => "Y",
        _ => return None,
    };
    Some(Channels { colours: vec![Text::from(only as &str)], alpha: has("A").then(|| Text::from("A")) })
}

impl<R: BufRead + Seek> Layered<R> {
    /// The pixels of the display window, with alpha if the file has some.
    fn pixels(self) -> exr::error::Result<Vec<f32>> {
        let header = &self.reader.headers()[self.header];
        let window = header.shared_attributes.display_window;
        let offset = header.own_attributes.layer_position - window.position;
        let count = usize::from(self.color_type().channel_count());
        let create = move || vec![0f32; window.size.area() * count];
        let set = move |pixels: &mut Vec<f32>, at: Vec2<usize>, pixel: [f32; 4]| {
            let at = at.to_i32() + offset;
            let within = |at: i32, size: usize| usize::try_from(at).ok().filter(|at| *at < size);
            let place = (within(at.x(), window.size.width()), within(at.y(), window.size.height()));
            if let (Some(x), Some(y)) = place {
                let start = (y * window.size.width() + x) * count;
                pixels[start..start + count].copy_from_slice(&pixel[..count]);
            }
        };
        // A name that the file does not have gives the alpha of a picture without one.
        let alpha = self.channels.alpha.unwrap_or_else(|| Text::from("no alpha"));
        let file = read().no_deep_data().largest_resolution_level().specific_channels();
        match <[Text; 3]>::try_from(self.channels.colours) {
            Ok([r, g, b]) => {
                let file = file.required(r).required(g).required(b).optional(alpha, 1f32);
                let set = move |to: &mut _, at, (r, g, b, a): (f32, f32, f32, f32)| set(to, at, [r, g, b, a]);
                let image = file.collect_pixels(move |_, _| create(), set).first_valid_layer().all_attributes();
                Ok(image.from_chunks(self.reader)?.layer_data.channel_data.pixels)
            }
            Err(mut colours) => {
                let grey = colours.pop().unwrap_or_else(|| Text::from("Y"));
                let file = file.required(grey).optional(alpha, 1f32);
                let set = move |to: &mut _, at, (y, a): (f32, f32)| set(to, at, [y, y, y, a]);
                let image = file.collect_pixels(move |_, _| create(), set).first_valid_layer().all_attributes();
                Ok(image.from_chunks(self.reader)?.layer_data.channel_data.pixels)
            }
        }
    }
}

impl<R: BufRead + Seek> ImageDecoder for Layered<R> {
    fn dimensions(&self) -> (u32, u32) {
        let size = self.reader.headers()[self.header].shared_attributes.display_window.size;
        (size.width() as u32, size.height() as u32)
    }

    fn color_type(&self) -> ColorType {
        if self.channels.alpha.is_some() { ColorType::Rgba32F } else { ColorType::Rgb32F }
    }

    fn read_image(self, bytes: &mut [u8]) -> ImageResult<()> {
        let failed = |error: exr::error::Error| {
            ImageError::Decoding(DecodingError::new(ImageFormatHint::Exact(ImageFormat::OpenExr), error.to_string()))
        };
        let pixels = self.pixels().map_err(failed)?;
        let (places, _) = bytes.as_chunks_mut::<4>();
        places.iter_mut().zip(pixels).for_each(|(place, value)| *place = value.to_ne_bytes());
        Ok(())
    }

    fn read_image_boxed(self: Box<Self>, bytes: &mut [u8]) -> ImageResult<()> {
        (*self).read_image(bytes)
    }
}

#[cfg(test)]
mod tests {
    use crate::decode::{decode, decode_layer, probe};
    use crate::error::DecodeError;
    use exr::prelude::{AnyChannel, AnyChannels, FlatSamples, Image, WritableImage};
    use rototoon_image::colour::encode;
    use std::path::{Path, PathBuf};

    /// A file of 2 × 1 pixels. Each channel has the value at its name on the first pixel, and 0 on the second.
    fn file(folder: &Path, channels: &[(&str, f32)]) -> PathBuf {
        let channel = |(name, value): &(&str, f32)| AnyChannel::new(*name, FlatSamples::F32(vec![*value, 0.0]));
        let path = folder.join("a.exr");
        let channels = AnyChannels::sort(channels.iter().map(channel).collect());
        Image::from_channels((2, 1), channels).write().to_file(&path).unwrap();
        path
    }

    #[test]
    fn the_complete_picture_of_a_renderer_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let combined = [("R", 0.5), ("G", 0.25), ("B", 0.125), ("A", 0.5)];
        let names = combined.map(|(colour, value)| (format!("ViewLayer.Combined.{colour}"), value));
        let mut channels: Vec<(&str, f32)> = names.iter().map(|(name, value)| (name.as_str(), *value)).collect();
        channels.extend([("ViewLayer.Depth.Z", 9.0), ("ViewLayer.AO.R", 7.0), ("ViewLayer.AO.G", 7.0)]);
        channels.push(("ViewLayer.AO.B", 7.0));
        let path = file(folder.path(), &channels);
        assert_eq!(probe(&path), Ok((2, 1)));
        assert_eq!(decode_layer(&path, Some((2, 1))).unwrap().data(), [[0.5, 0.25, 0.125, 0.5], [0.0; 4]]);
        let path = file(folder.path(), &[("beauty.R", 0.5), ("beauty.G", 0.25), ("beauty.B", 0.0), ("Z", 9.0)]);
        assert_eq!(decode_layer(&path, None).unwrap().get(0, 0), [0.5, 0.25, 0.0, 1.0]);
    }

    #[test]
    fn one_channel_is_grey() {
        let folder = tempfile::tempdir().unwrap();
        for channels in [vec![("Y", 0.5)], vec![("matte", 0.5)], vec![("A", 0.5)], vec![("Y", 0.5), ("Z", 3.0)]] {
            let path = file(folder.path(), &channels);
            assert_eq!(decode(&path, None).unwrap().get(0, 0), [encode(0.5); 3], "{channels:?}");
        }
        let path = file(folder.path(), &[("Y", 0.25), ("A", 0.5)]);
        assert_eq!(decode_layer(&path, None).unwrap().get(0, 0), [0.25, 0.25, 0.25, 0.5]);
    }

    #[test]
    fn channels_that_are_no_picture_are_named() {
        let folder = tempfile::tempdir().unwrap();
        let said = |channels: &[(&str, f32)]| match decode(&file(folder.path(), channels), None) {
            Err(DecodeError::Unreadable(reason)) => reason,
            other => panic!("{other:?}"),
        };
        let reason = said(&[("motion.X", 1.0), ("motion.Y", 1.0)]);
        assert!(reason.contains("channels motion.X, motion.Y, expected R, G and B, alone or of a layer"), "{reason}");
        let names: Vec<String> = (0..20).map(|k| format!("u{k:02}")).collect();
        let many: Vec<(&str, f32)> = names.iter().map(|name| (name.as_str(), 1.0)).collect();
        assert!(said(&many).contains("u11 and 8 more, expected"));
    }
}
