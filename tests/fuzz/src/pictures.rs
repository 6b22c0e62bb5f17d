//! Tiny pictures of every format, and reading of bytes as a picture file.

use image::{DynamicImage, ImageBuffer, ImageFormat, Rgb, Rgba};
use rototoon::pictures::DecodeError;
use rototoon::pictures::decode::{decode, decode_layer, probe};
use std::io::Cursor;
use std::path::PathBuf;
use std::sync::OnceLock;
use tempfile::TempDir;

/// The largest number of pixels that a target decodes. A footage says its size, and the product decodes no picture of
/// another size. So a small file that claims to be huge costs nothing.
const MOST_PIXELS: usize = 1 << 14;

/// The folder of this process for the files that targets read.
pub fn folder() -> &'static TempDir {
    static FOLDER: OnceLock<TempDir> = OnceLock::new();
    FOLDER.get_or_init(|| tempfile::tempdir().expect("a folder for temporary files"))
}

/// A path of this thread in [`folder`].
fn path() -> PathBuf {
    thread_local!(static NAME: String = format!("{:?}", std::thread::current().id()).replace(['(', ')'], ""));
    NAME.with(|name| folder().path().join(name))
}

/// Reads bytes as the product reads a picture file: its size, its colours, its transparency.
pub fn read(bytes: &[u8]) {
    let path = path();
    std::fs::write(&path, bytes).expect("a temporary file can be written");
    let size = probe(&path);
    match size {
        Ok((width, height)) if width.saturating_mul(height) <= MOST_PIXELS => {
            let colours = decode(&path, Some((width, height)));
            if let Ok(picture) = &colours {
                assert_eq!((picture.width(), picture.height()), (width, height));
                assert!(picture.data().iter().flatten().all(|v| (0.0..=1.0).contains(v)), "a colour is not in 0 to 1");
            }
            if let Ok(picture) = decode_layer(&path, Some((width, height))) {
                assert!(picture.data().iter().flatten().all(|v| v.is_finite()), "a value of a layer is not finite");
            }
        }
        Ok(size) => {
            let found = decode(&path, Some((4, 4)));
            let refused = matches!(found, Err(DecodeError::WrongSize { .. } | DecodeError::Unreadable(_)));
            assert!(refused, "a picture of {size:?} pixels was decoded as one of 4x4");
        }
        Err(_) => assert!(decode(&path, Some((4, 4))).is_err() || size.is_ok(), "a picture without a size was decoded"),
    }
}

/// Tiny pictures of a format.
pub fn tiny(format: ImageFormat) -> Vec<Vec<u8>> {
    let shade = |x: u32, y: u32| [(x * 60) as u8, (y * 60) as u8, 130];
    let colours = DynamicImage::ImageRgb8(ImageBuffer::from_fn(4, 4, |x, y| Rgb(shade(x, y))));
    let clear = DynamicImage::ImageRgba8(ImageBuffer::from_fn(4, 4, |x, y| {
        let [r, g, b] = shade(x, y);
        Rgba([r, g, b, (x * 80) as u8])
    }));
    let pictures: Vec<DynamicImage> = match format {
        ImageFormat::OpenExr => vec![colours.to_rgb32f().into(), clear.to_rgba32f().into()],
        ImageFormat::Jpeg => vec![colours.to_luma8().into(), colours],
        ImageFormat::Png => vec![colours.to_luma8().into(), clear.to_rgba16().into(), clear, colours],
        ImageFormat::Tiff => vec![colours.to_luma16().into(), clear.to_rgb32f().into(), clear, colours],
        _ => vec![clear, colours],
    };
    pictures.iter().map(|picture| encoded(picture, format)).collect()
}

fn encoded(picture: &DynamicImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Vec::new();
    picture.write_to(&mut Cursor::new(&mut bytes), format).expect("the encoder takes this kind of picture");
    bytes
}
