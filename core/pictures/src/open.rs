//! Opens a picture file within limits: a regular file, a known format, a complete file, a bounded amount of memory.
//!
//! Files come from anywhere. A small file may claim to be huge, hide a huge compressed colour profile, or end in the
//! middle. All of that is an error here, before memory is taken.

use super::error::DecodeError;
use super::layered::{self, Layered};
use super::{blocks, jpeg, tags};
use image::{ImageDecoder, ImageFormat, ImageReader, Limits};
use rototoon_base::file;
use rototoon_base::memory::{self, Bytes};
use std::fs::{self, File};
use std::io::{BufRead, BufReader, Cursor, Read, Seek};
use std::path::Path;

/// Largest number of bytes that the pixels of a picture may take, as decoded and as converted together.
pub const MOST_BYTES: u64 = 2 << 30;

/// Largest number of bytes that a PNG decoder may take beside the pixels: for a line, a colour profile, texts.
const MOST_EXTRA_BYTES: u64 = 32 << 20;

/// A file whose format is known.
pub type Reader = ImageReader<Box<dyn Source>>;

/// Bytes of a file.
pub trait Source: BufRead + Seek {}

impl<T: BufRead + Seek> Source for T {}

/// Opens a picture file and finds its format by its content. `complete` also checks a JPEG file for its end, which
/// reads all of it, and the blocks of an OpenEXR file.
///
/// # Errors
///
/// A [`DecodeError`] if there is no file, or no regular file (a folder, a pipe, a device), or its format is unknown, or
/// it is cut, or its blocks are too large.
pub fn open(path: &Path, complete: bool) -> Result<Reader, DecodeError> {
    let length = file::length(path)?;
    let file: Box<dyn Source> = Box::new(BufReader::new(file::Repeating(File::open(path)?)));
    let mut reader = ImageReader::new(file).with_guessed_format()?;
    if reader.format().is_none() {
        reader = big_tiff(reader)?;
    }
    let Some(format) = reader.format() else {
        return Err(DecodeError::Unreadable("not a PNG, JPEG, TIFF, BMP, WebP or OpenEXR picture".into()));
    };
    if !format.reading_enabled() {
        let found = format.to_mime_type().trim_start_matches("image/").to_uppercase();
        let message =
            format!("found a {found} picture, expected PNG, JPEG, TIFF, BMP, WebP or OpenEXR: save its frames as PNG");
        return Err(DecodeError::Unreadable(message));
    }
    if format == ImageFormat::Jpeg && complete {
        reader = whole_jpeg(path, length)?;
    }
    if format == ImageFormat::OpenExr && complete {
        let mut file = reader.into_inner();
        blocks::check(&mut file)?;
        file.rewind()?;
        reader = ImageReader::with_format(file, format);
    }
    Ok(limited(reader))
}

/// A file whose first bytes are those of BigTIFF, which has places for more than 4 GB, as TIFF. Any other file as it is.
fn big_tiff(reader: Reader) -> Result<Reader, DecodeError> {
    let (mut file, mut start) = (reader.into_inner(), Vec::new());
    file.by_ref().take(4).read_to_end(&mut start)?;
    file.rewind()?;
    Ok(match start.as_slice() {
        b"II+\0" | b"MM\0+" => ImageReader::with_format(file, ImageFormat::Tiff),
        _ => ImageReader::new(file),
    })
}

/// What decodes an opened file, and whether its colours are multiplied by alpha.
///
/// # Errors
///
/// A header that cannot be read, OpenEXR channels of which none is a picture, and TIFF files of whole numbers of 32 bits or of
/// reversed bits.
pub fn decoder(reader: Reader) -> Result<(Box<dyn ImageDecoder>, bool), DecodeError> {
    let (format, mut file) = match reader.format() {
        Some(format @ (ImageFormat::Tiff | ImageFormat::OpenExr)) => (format, reader.into_inner()),
        _ => return Ok((Box::new(reader.into_decoder()?), false)),
    };
    let is_exr = format == ImageFormat::OpenExr;
    let multiplied = is_exr || tags::multiplied(&mut file);
    if !is_exr {
        file.rewind()?;
        if tags::wide_whole_numbers(&mut file) {
            return Err(DecodeError::tiff("whole numbers of 32 bits", "8 or 16 bits, or floats"));
        }
        file.rewind()?;
        if tags::reversed_bits(&mut file) {
            return Err(DecodeError::tiff("reversed bits (FillOrder 2)", "the usual order"));
        }
    }
    let layered = is_exr && !blocks::headers(&mut file)?.iter().any(layered::is_plain);
    file.rewind()?;
    if layered {
        return Ok((Box::new(Layered::new(file)?), multiplied));
    }
    Ok((Box::new(limited(ImageReader::with_format(file, format)).into_decoder()?), multiplied))
}

/// A reader with the limits of its format.
fn limited(mut reader: Reader) -> Reader {
    let mut limits = Limits::default();
    limits.max_alloc = Some(if reader.format() == Some(ImageFormat::Png) { MOST_EXTRA_BYTES } else { MOST_BYTES });
    reader.limits(limits);
    reader
}

/// A JPEG file in memory, where its decoder would copy it anyway.
fn whole_jpeg(path: &Path, length: u64) -> Result<Reader, DecodeError> {
    memory_for(length, "the file needs")?;
    let bytes = fs::read(path)?;
    if !jpeg::complete(&bytes) {
        let reason = format!("the JPEG file is cut: its {} bytes end before the picture does", bytes.len());
        return Err(DecodeError::Unreadable(reason));
    }
    let source: Box<dyn Source> = Box::new(Cursor::new(bytes));
    Ok(ImageReader::with_format(source, ImageFormat::Jpeg))
}

/// An error if the pixels of a picture, as decoded and converted to `pixel` bytes each, take too much memory.
pub fn check_size(decoder: &impl ImageDecoder, pixel: usize) -> Result<(), DecodeError> {
    let (width, height) = decoder.dimensions();
    let converted = u64::from(width) * u64::from(height) * pixel as u64;
    let what = format!("{width}x{height} pixels need");
    let bytes = decoder.total_bytes().saturating_add(converted);
    memory_for(bytes, &what)?;
    // Some decoders keep a second copy while they work.
    ask(bytes.saturating_add(decoder.total_bytes()), &what)
}

/// An error if more than [`MOST_BYTES`] are needed, or more than the system grants.
fn memory_for(bytes: u64, what: &str) -> Result<(), DecodeError> {
    if bytes > MOST_BYTES {
        let reason = format!("{what} {} of memory, expected at most {}", Bytes(bytes), Bytes(MOST_BYTES));
        return Err(DecodeError::Unreadable(reason));
    }
    ask(bytes, what)
}

fn ask(bytes: u64, what: &str) -> Result<(), DecodeError> {
    memory::ask(bytes).map_err(|error| DecodeError::Unreadable(format!("{what} too much memory: {error}")))
}
