//! The reasons why a file gives no picture.

use image::error::{ImageFormatHint, UnsupportedErrorKind};
use image::{ExtendedColorType, ImageError, ImageFormat};
use std::io;

/// The reason why a file gives no picture.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DecodeError {
    /// The file does not exist.
    #[error("no such file")]
    Missing,
    /// The file cannot be read as a picture. The text is the reason given by the decoder or the system.
    #[error("{0}")]
    Unreadable(String),
    /// The picture does not have the expected size.
    #[error("the picture is {width}x{height} pixels")]
    WrongSize {
        /// Width of the picture in the file.
        width: usize,
        /// Height of the picture in the file.
        height: usize,
    },
}

impl DecodeError {
    /// What a decoder says, in plain words where it says what happened inside of it.
    pub(crate) fn unreadable(error: &dyn std::fmt::Display) -> Self {
        let said = error.to_string();
        let has = |words: &[&str]| words.iter().any(|words| said.contains(words));
        let plain = if has(&["failed to fill whole buffer", "unexpected end of file", "reference to missing bytes"]) {
            Some("the file is cut: it ends before the picture does")
        } else if has(&["exceeds total size", "chunk offset table"]) {
            Some("the file is not whole: blocks of the picture are missing, as after a render that was stopped")
        } else if has(&["channel subsampling"]) {
            Some(
                "found OpenEXR channels of fewer pixels than the picture, expected all of its size: save it without them",
            )
        } else {
            None
        };
        Self::Unreadable(plain.map_or(said, str::to_owned))
    }

    /// A form of TIFF that is not read.
    pub(crate) fn tiff(found: &str, expected: &str) -> Self {
        Self::Unreadable(of_tiff(found, expected))
    }
}

impl From<io::Error> for DecodeError {
    fn from(error: io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::NotFound => Self::Missing,
            _ => Self::unreadable(&error),
        }
    }
}

impl From<ImageError> for DecodeError {
    fn from(error: ImageError) -> Self {
        unsupported_tiff(&error).map_or_else(|| Self::unreadable(&error), Self::Unreadable)
    }
}

/// The message for a form of TIFF that is not read: what was found, and what to do. `None` for any other error.
fn unsupported_tiff(error: &ImageError) -> Option<String> {
    let ImageError::Unsupported(unsupported) = error else { return None };
    const FORMS: &str = "8 or 16 bits of grey, colour or CMYK, or floats of colour";
    let is_tiff = unsupported.format_hint() == ImageFormatHint::Exact(ImageFormat::Tiff);
    let (found, expected) = match unsupported.kind() {
        UnsupportedErrorKind::Color(colour) => (form_of(colour), FORMS),
        UnsupportedErrorKind::GenericFeature(feature) => {
            match feature.strip_prefix("compression method ").and_then(|rest| rest.split(' ').next()) {
                Some(name) => (format!("the compression {name}"), "none, LZW, Deflate or PackBits"),
                None if feature.contains("RGBPalette") => ("a palette".to_owned(), FORMS),
                None => (feature.clone(), FORMS),
            }
        }
        _ => return None,
    };
    is_tiff.then(|| of_tiff(&found, expected))
}

/// What the bits of a pixel are.
fn form_of(colour: ExtendedColorType) -> String {
    let bits = colour.bits_per_pixel();
    match colour {
        ExtendedColorType::La8 | ExtendedColorType::La16 => format!("{bits} bits a pixel of grey with alpha"),
        // Floats of grey, YCbCr, Lab and others, which the library does not tell apart.
        ExtendedColorType::Unknown(_) => {
            format!("{bits} bits a pixel in another form, such as YCbCr or floats of grey")
        }
        _ => format!("{bits} bits a pixel ({colour:?})"),
    }
}

fn of_tiff(found: &str, expected: &str) -> String {
    format!("found a TIFF picture with {found}, expected {expected}: save its frames so, or as PNG")
}

#[cfg(test)]
mod tests {
    use crate::decode::probe;

    /// A TIFF file of 2x2 grey pixels with this photometric interpretation and compression.
    fn tiff(photometric: u16, compression: u16) -> Vec<u8> {
        let mut entries: Vec<(u16, u16, u32, u32)> =
            vec![(256, 3, 1, 2), (257, 3, 1, 2), (258, 3, 1, 8), (259, 3, 1, compression.into())];
        entries.extend([
            (262, 3, 1, photometric.into()),
            (273, 4, 1, 8),
            (277, 3, 1, 1),
            (278, 3, 1, 2),
            (279, 4, 1, 4),
        ]);
        let palette = 768;
        entries.extend((photometric == 3).then_some((320, 3, palette, 12)));
        let directory = 12 + 2 * palette;
        let mut file = [b"II*\0", &directory.to_le_bytes()[..], &[0, 1, 2, 3]].concat();
        file.resize(directory as usize, 0);
        file.extend((entries.len() as u16).to_le_bytes());
        for (tag, kind, count, value) in entries {
            file.extend(
                [&tag.to_le_bytes()[..], &kind.to_le_bytes(), &count.to_le_bytes(), &value.to_le_bytes()].concat(),
            );
        }
        file.extend([0; 4]);
        file
    }

    #[test]
    fn forms_of_tiff_that_are_not_read_say_what_to_do() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.tif");
        let told = |photometric, compression| {
            std::fs::write(&path, tiff(photometric, compression)).unwrap();
            probe(&path).and_then(|_| crate::decode::decode(&path, None)).map(drop).map_err(|error| error.to_string())
        };
        assert_eq!(told(1, 1), Ok(()));
        let said = |found: &str, expected: &str| {
            Err(format!("found a TIFF picture with {found}, expected {expected}: save its frames so, or as PNG"))
        };
        assert_eq!(told(3, 1), said("a palette", "8 or 16 bits of grey, colour or CMYK, or floats of colour"));
        assert_eq!(told(1, 50000), said("the compression ZSTD", "none, LZW, Deflate or PackBits"));
    }
}
