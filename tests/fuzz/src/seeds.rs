//! The inputs that a run starts with: files, and pictures that are made here.

use crate::given;
use crate::pictures::tiny;
use image::ImageFormat;
use rototoon::export::SvgOptions;
use rototoon::pipeline::{export_silhouette, export_svg};
use rototoon::project::Document;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// The largest seed in bytes.
pub const MOST_BYTES: usize = 4096;

/// The folder of a target's seed files.
pub fn folder(target: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("seeds").join(target)
}

/// The seed files of a target, each with its name. A target without a folder has none.
///
/// # Errors
///
/// A file that cannot be read.
pub fn files(target: &str) -> io::Result<Vec<(String, Vec<u8>)>> {
    let folder = folder(target);
    if !folder.is_dir() {
        return Ok(Vec::new());
    }
    let mut found = Vec::new();
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        found.push((entry.file_name().to_string_lossy().into_owned(), fs::read(entry.path())?));
    }
    found.sort();
    Ok(found)
}

/// All seeds of a target: its files, those made here, and bytes for the decoders.
///
/// # Errors
///
/// A file that cannot be read.
pub fn seeds(target: &str) -> io::Result<Vec<Vec<u8>>> {
    let mut found: Vec<Vec<u8>> = files(target)?.into_iter().map(|(_, bytes)| bytes).collect();
    found.extend(made(target));
    Ok(found)
}

fn made(target: &str) -> Vec<Vec<u8>> {
    let format = match target {
        "image_bmp" => ImageFormat::Bmp,
        "image_exr" => ImageFormat::OpenExr,
        "image_jpeg" => ImageFormat::Jpeg,
        "image_png" => ImageFormat::Png,
        "image_tiff" => ImageFormat::Tiff,
        "image_webp" => ImageFormat::WebP,
        "svg" => {
            return exported(|document| {
                export_svg(document, &SvgOptions::default()).expect("seeds have no traced strokes")
            });
        }
        "silhouette" => return exported(|document| export_silhouette(document, 2.0)),
        _ => return (1..=8).map(noise).collect(),
    };
    tiny(format)
}

/// The seed documents in the form of another program.
fn exported(export: impl Fn(&Document) -> String) -> Vec<Vec<u8>> {
    let texts = (1..=8).map(|k| given::text(&noise(k), "{", given::document::document).into_owned());
    let documents = texts.filter_map(|text| Document::parse(&text, "seed").ok());
    documents.map(|document| export(&document).into_bytes()).filter(|text| text.len() <= MOST_BYTES).collect()
}

/// Bytes without an order, the same on every run: something for a decoder to make a document of.
fn noise(number: u64) -> Vec<u8> {
    let mut bits = number.wrapping_mul(0x9E37_79B9_7F4A_7C15);
    let byte = || {
        bits ^= bits << 13;
        bits ^= bits >> 7;
        bits ^= bits << 17;
        (bits >> 32) as u8
    };
    std::iter::repeat_with(byte).take(1024).collect()
}
