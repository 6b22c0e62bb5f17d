//! Picture files that are cut, or that are no regular files.
//!
//! They are unit tests, although they need nothing private: a test program of their own would compile all writers of pictures
//! once more, which takes 9 s.

use crate::{DecodeError, decode};
use exr::prelude::{AnyChannel, AnyChannels, FlatSamples, Image, WritableImage};
use image::{DynamicImage, ImageBuffer, ImageFormat, Rgb};
use std::fs::File;
use std::io::Cursor;
use std::path::Path;

/// A small drawing in a format: dark lines on paper, so that wrong pixels are found.
fn drawing(format: ImageFormat) -> Vec<u8> {
    let ink = |x: u32, y: u32| if (x + 2 * y) % 7 < 2 { [20u8, 30, 40] } else { [240, 235, (x * 9 + y * 5) as u8] };
    let picture = DynamicImage::ImageRgb8(ImageBuffer::from_fn(23, 19, |x, y| Rgb(ink(x, y))));
    let picture = match format {
        ImageFormat::OpenExr => DynamicImage::ImageRgb32F(picture.to_rgb32f()),
        _ => picture,
    };
    let mut bytes = Vec::new();
    picture.write_to(&mut Cursor::new(&mut bytes), format).unwrap();
    bytes
}

fn decoded(path: &Path) -> Result<Vec<[f32; 3]>, DecodeError> {
    decode(path, Some((23, 19))).map(|picture| picture.data().to_vec())
}

/// The drawing as a layer of a renderer's OpenEXR file.
fn layered() -> Vec<u8> {
    let picture = image::load_from_memory(&drawing(ImageFormat::Png)).unwrap().to_rgb32f();
    let values = |colour: usize| FlatSamples::F32(picture.pixels().map(|pixel| pixel.0[colour]).collect());
    let channel = |(k, name): (usize, &str)| AnyChannel::new(format!("ViewLayer.Combined.{name}").as_str(), values(k));
    let channels = AnyChannels::sort(["R", "G", "B"].into_iter().enumerate().map(channel).collect());
    let mut bytes = Cursor::new(Vec::new());
    Image::from_channels((23, 19), channels).write().non_parallel().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

#[test]
fn a_file_cut_anywhere_gives_an_error_or_all_of_its_pixels() {
    use ImageFormat::{Bmp, Jpeg, OpenExr, Png, Tiff, WebP};
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frame");
    let plain = [Png, Jpeg, Tiff, Bmp, WebP, OpenExr].map(|format| (format!("{format:?}"), drawing(format)));
    for (format, whole) in plain.into_iter().chain([("layers of OpenEXR".to_owned(), layered())]) {
        std::fs::write(&path, &whole).unwrap();
        let pixels = decoded(&path).unwrap();
        let mut refused = 0;
        // The file is shortened byte by byte: a file that is written anew for each length waits for the disk.
        let file = File::options().write(true).open(&path).unwrap();
        for length in (0..whole.len()).rev() {
            file.set_len(length as u64).unwrap();
            match decoded(&path) {
                Ok(found) => assert!(found == pixels, "{format}: {length} of {} bytes give other pixels", whole.len()),
                Err(_) => refused += 1,
            }
        }
        assert!(refused * 10 >= whole.len() * 9, "{format}: refused {refused} of {} lengths", whole.len());
    }
}

#[test]
fn a_cut_jpeg_names_the_reason() {
    let folder = tempfile::tempdir().unwrap();
    let (path, whole) = (folder.path().join("frame.jpg"), drawing(ImageFormat::Jpeg));
    std::fs::write(&path, &whole[..whole.len() / 2]).unwrap();
    let error = decoded(&path).unwrap_err().to_string();
    assert!(error.starts_with("the JPEG file is cut: its "), "{error}");
}

#[test]
fn other_cut_files_say_so_too() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frame");
    for format in [ImageFormat::Bmp, ImageFormat::OpenExr] {
        let whole = drawing(format);
        std::fs::write(&path, &whole[..whole.len() / 2]).unwrap();
        let error = decoded(&path).unwrap_err().to_string();
        assert!(error.starts_with("the file is "), "{format:?}: {error}");
    }
}

#[cfg(unix)]
#[test]
fn pipes_and_devices_are_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("frame_1.png");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    for path in [&pipe, Path::new("/dev/zero")] {
        let error = decode(path, None).unwrap_err().to_string();
        assert_eq!(error, "it is a pipe or a device, expected a file");
    }
}
